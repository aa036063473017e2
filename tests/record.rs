//! Contract of `homunculus record`: the film has the frames, size and length that were asked for, begins at rest and ends
//! warped; the same order gives the same bytes for any number of threads; what is stopped or cannot be written leaves nothing.
//!
//! Films are decoded by ffmpeg, which shares no code with the encoders. Tests say `skipped` where ffmpeg, a Vulkan driver or
//! the right to mount are absent.

#![cfg(all(feature = "cli", feature = "record"))]
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use image::RgbaImage;
use serde_json::Value;
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_homunculus");

/// A hand of few cells in few pixels, for half a second.
const HAND: &str =
    "record gallery:hand --resolution 24 --keys 2 --size 160x120 --fps 20 --seconds 0.5 --hold 0 --quiet";

fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(arguments.split_whitespace()).current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &str) -> Output {
    command(folder, arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn listing(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().to_string_lossy().into_owned();
    let mut names: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names
}

/// Records; `None`, said aloud, where nothing can draw.
fn record(folder: &Path, arguments: &str) -> Option<()> {
    let output = run(folder, arguments);
    let said = text(&output.stderr);
    if output.status.code() == Some(2) && said.contains("Vulkan") {
        eprintln!("skipped: no Vulkan driver");
        return None;
    }
    assert_eq!(output.status.code(), Some(0), "{arguments}: {said}");
    Some(())
}

fn has_ffmpeg() -> bool {
    let there = Command::new("ffprobe").arg("-version").output().is_ok_and(|o| o.status.success());
    if !there {
        eprintln!("skipped: no ffmpeg");
    }
    there
}

/// What ffprobe counts in a film: frames, width, height, seconds, pixel format, colour range.
fn probe(film: &Path) -> (usize, [u64; 2], f64, String, String) {
    let arguments = ["-v", "error", "-count_frames", "-show_streams", "-show_format", "-of", "json"];
    let output = Command::new("ffprobe").args(arguments).arg(film).output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let stream = &told["streams"][0];
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let seconds = word(&stream["duration"]).parse().or_else(|_| word(&told["format"]["duration"]).parse());
    (
        word(&stream["nb_read_frames"]).parse().unwrap(),
        [stream["width"].as_u64().unwrap(), stream["height"].as_u64().unwrap()],
        seconds.unwrap_or(f64::NAN),
        word(&stream["pix_fmt"]),
        word(&stream["color_range"]),
    )
}

/// All frames of a film.
fn decode(film: &Path) -> Vec<RgbaImage> {
    let folder = tempfile::tempdir().unwrap();
    let pictures = folder.path().join("%03d.png");
    let mut ffmpeg = Command::new("ffmpeg");
    let ffmpeg = ffmpeg.args(["-v", "error", "-i"]).arg(film).args(["-fps_mode", "passthrough"]).arg(pictures);
    let output = ffmpeg.output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    listing(folder.path()).iter().map(|name| picture(&folder.path().join(name))).collect()
}

fn picture(path: &Path) -> RgbaImage {
    image::open(path).unwrap().to_rgba8()
}

/// Mean difference of a channel, 0..=255.
fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let sum: f64 = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / a.as_raw().len() as f64
}

/// Whether a picture is all of one brightness, or nearly.
fn is_blank(picture: &RgbaImage) -> bool {
    let brightness = picture.pixels().map(|p| p.0[..3].iter().map(|&c| u32::from(c)).sum::<u32>());
    let (least, most) = brightness.fold((u32::MAX, 0), |(a, b), v| (a.min(v), b.max(v)));
    most - least < 60
}

fn sidecar(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join(name)).unwrap()).unwrap()
}

// ── what is in a film ──

#[test]
fn an_mp4_has_what_was_asked_for_and_shows_the_growth() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    if !has_ffmpeg() || record(folder.path(), &format!("{HAND} -o film.mp4")).is_none() {
        return;
    }
    for lambda in ["0", "1"] {
        record(folder.path(), &format!("{HAND} --still {lambda} -o still{lambda}.png"));
    }
    let (frames, size, seconds, pixels, range) = probe(&at("film.mp4"));
    assert_eq!((frames, size), (10, [160, 120]));
    assert!((seconds - 0.5).abs() <= 0.05, "{seconds}");
    assert_eq!((pixels.as_str(), range.as_str()), ("yuv420p", "tv"));
    let bytes = std::fs::read(at("film.mp4")).unwrap();
    let place = |name: &[u8]| bytes.windows(4).position(|window| window == name).unwrap();
    assert!(place(b"moov") < place(b"mdat"), "a browser would have to load all of it first");

    let film = decode(&at("film.mp4"));
    assert_eq!(film.len(), 10);
    assert!(film.iter().all(|frame| !is_blank(frame)));
    let [rest, warped] = ["still0.png", "still1.png"].map(|name| picture(&at(name)));
    let apart = difference(&rest, &warped);
    assert!(apart > 1.0, "the hand does not grow: {apart}");
    let (first, last) = (&film[0], &film[9]);
    let [begins, ends] = [difference(first, &rest), difference(last, &warped)];
    assert!(begins < 0.3 * apart && ends < 0.3 * apart, "{begins} and {ends} off, {apart} apart");
    // Sabotage: a film the other way round is seen.
    assert!(difference(first, &warped) > 0.7 * apart && difference(last, &rest) > 0.7 * apart);

    let told = sidecar(folder.path(), "film.json");
    assert_eq!(told["film"], "film.mp4");
    assert_eq!(told["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(told["scene"]["source"], "gallery:hand");
    let shown = told["recording"]["frames"].as_array().unwrap();
    assert_eq!(shown.len(), 10);
    assert!(shown.iter().all(|frame| frame["growth"]["certified"] == true && frame["growth"]["inverted"] == 0));
    assert_eq!((&shown[0]["lambda"], &shown[9]["lambda"]), (&0.0.into(), &1.0.into()));
    for rate in ["render_frames_per_second", "encode_frames_per_second"] {
        assert!(told["recording"][rate].as_f64().is_some_and(|rate| rate > 0.0), "{rate}");
    }
}

#[test]
fn how_fast_it_was_is_said_and_a_still_may_be_as_wide_as_8k() {
    let folder = tempfile::tempdir().unwrap();
    let told = |order: String| {
        let output = run(folder.path(), &order);
        let said = text(&output.stdout);
        match output.status.code() {
            Some(0) => Some(said),
            _ => {
                assert!(text(&output.stderr).contains("Vulkan"), "{}", text(&output.stderr));
                eprintln!("skipped: no Vulkan driver");
                None
            }
        }
    };
    let hand = HAND.replace("--quiet", "");
    let Some(said) = told(format!("{hand} -o film.apng")) else { return };
    assert!(said.contains("10 frames") && said.contains("drawn at") && said.contains("frames per second"), "{said}");
    let still = hand.replace("160x120", "7680x432");
    assert_ne!(still, hand);
    let said = told(format!("{still} --still 1 -o wide.png")).unwrap();
    assert!(said.contains("drawn in") && !said.contains("per second"), "{said}");
    let wide = picture(&folder.path().join("wide.png"));
    assert!(wide.dimensions() == (7680, 432) && !is_blank(&wide));
}

#[test]
fn sabotage_blank_frames_are_seen() {
    assert!(is_blank(&RgbaImage::from_pixel(8, 8, image::Rgba([200, 201, 202, 255]))));
    assert!(!is_blank(&RgbaImage::from_fn(8, 8, |x, _| image::Rgba([if x < 2 { 90 } else { 240 }; 4]))));
}

#[test]
fn the_same_order_gives_the_same_bytes_for_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let films =
        [("one", "--threads 1"), ("again", "--threads 1"), ("three", "--threads 3"), ("other", "--camera 60,8")];
    for (name, options) in films {
        if record(folder.path(), &format!("{HAND} --legend --title Hand {options} -o {name}.mp4")).is_none() {
            return;
        }
    }
    let [one, again, three, other] =
        films.map(|(name, _)| std::fs::read(folder.path().join(name).with_extension("mp4")).unwrap());
    assert!(one == again, "twice");
    assert!(one == three, "one thread and three");
    // Sabotage: another camera is another film.
    assert!(one != other);
}

#[test]
fn gif_apng_and_folders_hold_the_same_film() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    if record(folder.path(), &format!("{HAND} -o frames/")).is_none() {
        return;
    }
    let pictures: Vec<RgbaImage> =
        listing(&at("frames")).iter().map(|name| picture(&at("frames").join(name))).collect();
    assert_eq!(pictures.len(), 10);
    assert!(pictures.iter().all(|frame| !is_blank(frame) && frame.dimensions() == (160, 120)));
    assert_eq!(sidecar(folder.path(), "frames.json")["recording"]["frames"].as_array().unwrap().len(), 10);
    for (name, most) in [("film.gif", 6.0), ("film.apng", 0.0)] {
        record(folder.path(), &format!("{HAND} -o {name}"));
        if !has_ffmpeg() {
            continue;
        }
        let film = decode(&at(name));
        assert_eq!(film.len(), 10, "{name}");
        let worst = film.iter().zip(&pictures).map(|(a, b)| difference(a, b)).fold(0.0, f64::max);
        assert!(worst <= most, "{name}: {worst}");
        // Sabotage: frames in another order are seen.
        assert!(difference(&film[0], &pictures[9]) > 2.0 * worst.max(0.3), "{name}");
    }
}

#[test]
fn a_transparent_film_has_no_background() {
    let folder = tempfile::tempdir().unwrap();
    for (name, options) in [("clear", "--transparent"), ("opaque", "")] {
        if record(folder.path(), &format!("{HAND} {options} --still 1 -o {name}.png")).is_none() {
            return;
        }
    }
    let clear = picture(&folder.path().join("clear.png"));
    let alphas = || clear.pixels().map(|p| p.0[3]);
    assert_eq!(clear.get_pixel(0, 0).0[3], 0, "the corner");
    assert!(alphas().filter(|&a| a == 255).count() > 500, "the hand");
    let opaque = picture(&folder.path().join("opaque.png"));
    assert!(opaque.pixels().all(|p| p.0[3] == 255));
}

#[test]
fn the_classic_solution_is_shown_beside_the_growth_with_what_was_found() {
    let folder = tempfile::tempdir().unwrap();
    let order = format!("{HAND} --view compare --still 1 -o compare.png");
    if record(folder.path(), &order).is_none() {
        return;
    }
    let compare = picture(&folder.path().join("compare.png"));
    let half = |x: u32| image::imageops::crop_imm(&compare, x, 0, 80, 120).to_image();
    assert!(!is_blank(&half(0)) && !is_blank(&half(80)), "both halves show something");
    let told = sidecar(folder.path(), "compare.json");
    let frame = &told["recording"]["frames"][0];
    assert_eq!(frame["growth"]["certified"], true);
    assert!(frame["classic"]["certified"].is_boolean());
}

// ── through ffmpeg ──

#[test]
fn webm_goes_through_ffmpeg() {
    let folder = tempfile::tempdir().unwrap();
    if !has_ffmpeg() {
        return;
    }
    let output = run(folder.path(), &format!("{HAND} -o film.webm"));
    let said = text(&output.stderr);
    if said.contains("Vulkan") || said.contains("lacks") {
        eprintln!("skipped: {said}");
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{said}");
    let (frames, size, seconds, pixels, _) = probe(&folder.path().join("film.webm"));
    assert_eq!((frames, size, pixels.as_str()), (10, [160, 120], "yuv420p"));
    assert!((seconds - 0.5).abs() <= 0.05, "{seconds}");
}

#[test]
fn without_ffmpeg_a_sentence_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let output = command(folder.path(), &format!("{HAND} -o film.webm")).env("PATH", folder.path()).output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("ffmpeg") && said.contains(".mp4") && said.lines().count() == 1, "{said}");
    assert_eq!(listing(folder.path()), [""; 0]);
}

#[cfg(unix)]
#[test]
fn an_ffmpeg_that_breaks_off_leaves_nothing_and_is_quoted() {
    use std::os::unix::fs::PermissionsExt as _;
    let tools = tempfile::tempdir().unwrap();
    let script = "#!/bin/sh\ncase \"$*\" in *-encoders*) echo libvpx-vp9;; *) echo 'out of ideas' >&2; exit 1;; esac\n";
    let fake = tools.path().join("ffmpeg");
    std::fs::write(&fake, script).unwrap();
    std::fs::set_permissions(&fake, std::fs::Permissions::from_mode(0o755)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let output = command(folder.path(), &format!("{HAND} -o film.webm")).env("PATH", tools.path()).output().unwrap();
    let said = text(&output.stderr);
    if said.contains("Vulkan") {
        eprintln!("skipped: no Vulkan driver");
        return;
    }
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("film.webm: cannot write: ffmpeg says: out of ideas"), "{said}");
    assert_eq!(listing(folder.path()), [""; 0]);
}

// ── what goes wrong ──

#[test]
fn bad_orders_end_with_2_and_name_the_fault() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("full")).unwrap();
    std::fs::write(folder.path().join("full/note"), "mine").unwrap();
    let before = listing(folder.path());
    for (arguments, expected) in [
        ("-o film.txt", ".mp4"),
        ("-o film", ".mp4"),
        ("-o film.png", "--still"),
        ("-o film.mp4 --still 0.5", ".png"),
        ("-o film.png --still 1.5", "still 1.5"),
        ("-o film.mp4 --size 101x100", "--size 100x100"),
        ("-o film.mp4 --size 8192x4320", "3840x2160"),
        ("-o film.mp4 --size 4x4", "16 to 8192"),
        ("-o film.mp4 --size big", "1920x1080"),
        ("-o film.mp4 --transparent", "no transparency"),
        ("-o film.gif --fps 60", "--fps 30"),
        ("-o film.mp4 --fps 0", "fps 0"),
        ("-o film.mp4 --seconds 0", "seconds 0"),
        ("-o film.mp4 --seconds 1 --hold 0.6", "less hold"),
        ("-o film.mp4 --camera 1", "YAW,PITCH"),
        ("-o film.mp4 --camera 0,90", "pitch 90"),
        ("-o full/", "no empty folder"),
        ("-o nowhere/film.mp4", "nowhere does not exist"),
        ("-o nowhere/frames/", "nowhere does not exist"),
        ("-o film.mp4 --save-scene film.json", ".ron"),
        ("", "--output"),
    ] {
        let output = run(folder.path(), &format!("record gallery:hand {arguments}"));
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?} said {said:?}");
        assert!(said.contains(expected), "{arguments:?} said {said:?}, not {expected:?}");
    }
    assert_eq!(listing(folder.path()), before);
}

#[test]
fn without_a_driver_the_package_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = command(folder.path(), &format!("{HAND} -o film.mp4"));
    let nowhere = folder.path().join("none.json");
    let output = command.env("VK_ICD_FILENAMES", &nowhere).env("VK_DRIVER_FILES", &nowhere).output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("mesa-vulkan-drivers") && !said.contains("panicked"), "{said}");
    assert_eq!(listing(folder.path()), [""; 0]);
}

/// Starts a film and interrupts it, if asked to, once frames are drawn. The exit code and what lies there; `None` where
/// nothing can draw.
#[cfg(unix)]
fn interrupted(film: &str, interrupt: bool) -> Option<(Option<i32>, Vec<String>)> {
    let folder = tempfile::tempdir().unwrap();
    let order = HAND.replace("--quiet", "").replace("--seconds 0.5", "--seconds 2");
    let mut command = command(folder.path(), &format!("{order} -o {film}"));
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let Some(drawing) = lines.find(|line| line.contains("record: 1") || line.contains("Vulkan")) else {
        child.wait().unwrap();
        return None;
    };
    if drawing.contains("Vulkan") {
        child.wait().unwrap();
        eprintln!("skipped: no Vulkan driver");
        return None;
    }
    if interrupt {
        let kill = format!("kill -INT {}", child.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    }
    let rest: Vec<String> = lines.collect();
    let code = child.wait().unwrap().code();
    assert_eq!(rest.iter().any(|line| line.contains("stopped at your request")), interrupt, "{rest:?}");
    Some((code, listing(folder.path())))
}

#[cfg(unix)]
#[test]
fn an_interrupted_film_leaves_nothing() {
    for film in ["film.mp4", "film.gif", "frames/"] {
        let Some(left) = interrupted(film, true) else { return };
        assert_eq!(left, (Some(1), Vec::new()), "{film}");
    }
}

#[cfg(unix)]
#[test]
fn sabotage_one_that_is_not_interrupted_leaves_its_files() {
    let Some(left) = interrupted("film.mp4", false) else { return };
    assert_eq!(left, (Some(0), ["film.json", "film.mp4"].map(String::from).to_vec()));
}

/// A disk of few bytes, for as long as it lives.
#[cfg(target_os = "linux")]
struct SmallDisk(TempDir);

#[cfg(target_os = "linux")]
impl SmallDisk {
    fn new(size: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", &format!("size={size}"), "none"]).arg(folder.path());
        let mounted = mount.output().is_ok_and(|output| output.status.success());
        if !mounted {
            eprintln!("skipped: a small disk cannot be mounted here");
        }
        mounted.then_some(Self(folder))
    }
}

#[cfg(target_os = "linux")]
impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).output();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_no_half_film() {
    for film in ["film.mp4", "film.gif", "film.apng", "frames/"] {
        let Some(disk) = SmallDisk::new("4k") else { return };
        let path: PathBuf = disk.0.path().join(film);
        let work = tempfile::tempdir().unwrap();
        let output = run(work.path(), &format!("{HAND} -o {}", path.display()));
        let said = text(&output.stderr);
        if said.contains("Vulkan") {
            eprintln!("skipped: no Vulkan driver");
            return;
        }
        assert_eq!(output.status.code(), Some(1), "{film}: {said}");
        assert!(said.contains("cannot write"), "{film}: {said}");
        assert_eq!(listing(disk.0.path()), [""; 0], "{film}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn sabotage_a_disk_with_room_holds_the_film() {
    let Some(disk) = SmallDisk::new("4m") else { return };
    let film = disk.0.path().join("film.mp4");
    let work = tempfile::tempdir().unwrap();
    if record(work.path(), &format!("{HAND} -o {}", film.display())).is_some() {
        assert_eq!(listing(disk.0.path()), ["film.json", "film.mp4"]);
    }
}

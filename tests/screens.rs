//! Contract of the real window, where there is Xvfb and a Vulkan driver: it opens, a scenario paints, plays, opens a broken
//! file and saves, and what is seen is what was looked at and found good: small pictures in `tests/screens`, compared by
//! eye's measure. `BLESS=1 cargo test --test screens` writes them anew; look at each before keeping it.
#![cfg(feature = "window")]
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]
#![expect(clippy::print_stdout, reason = "skipping is said aloud")]

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use image::imageops::FilterType;
use image::{AnimationDecoder, DynamicImage, RgbImage};

/// A display of its own.
struct Display {
    server: Child,
    number: String,
}

impl Display {
    /// `None`, and a word, where the window cannot be shown.
    fn open() -> Option<Self> {
        let mut server = Command::new("Xvfb");
        server.args(["-displayfd", "1", "-screen", "0", "1920x1200x24", "-nolisten", "tcp"]);
        let Ok(mut server) = server.stdout(Stdio::piped()).stderr(Stdio::null()).spawn() else {
            println!("skipped: there is no Xvfb");
            return None;
        };
        let mut number = String::new();
        let _ = BufReader::new(server.stdout.take()?).read_line(&mut number);
        let display = Self { server, number: format!(":{}", number.trim()) };
        if let Err(error) = homunculus::view::adapter() {
            println!("skipped: {error}");
            return None;
        }
        Some(display)
    }

    /// Runs the program with its own memory in `folder`.
    fn play(&self, folder: &Path, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_homunculus"))
            .arg("play")
            .args(arguments)
            .current_dir(folder)
            .env("DISPLAY", &self.number)
            .env("XDG_DATA_HOME", folder)
            .env("XDG_RUNTIME_DIR", folder)
            .env_remove("WAYLAND_DISPLAY")
            .output()
            .unwrap()
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Width and height of what is kept: small, and still telling a missing label.
const KEPT: (u32, u32) = (480, 270);

/// What the eye tells apart: both are blurred to blocks of 4 pixels; then hardly any block may differ clearly, and all of
/// them together hardly at all. Levels of 255.
fn looks_like(a: &RgbImage, b: &RgbImage) -> Result<(), String> {
    let small = |picture: &RgbImage| image::imageops::resize(picture, KEPT.0 / 4, KEPT.1 / 4, FilterType::Triangle);
    let (a, b) = (small(a), small(b));
    let differences: Vec<f64> = a
        .pixels()
        .zip(b.pixels())
        .map(|(a, b)| a.0.iter().zip(b.0).map(|(a, b)| f64::from(a.abs_diff(b))).sum::<f64>() / 3.0)
        .collect();
    let mean = differences.iter().sum::<f64>() / differences.len() as f64;
    let clearly = differences.iter().filter(|d| **d > 30.0).count() as f64 / differences.len() as f64;
    if mean < 4.0 && clearly < 0.02 {
        Ok(())
    } else {
        Err(format!("mean {mean:.2}, clearly different {:.1} %", clearly * 100.0))
    }
}

fn shrunk(path: &Path) -> RgbImage {
    let picture = image::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    picture.resize_exact(KEPT.0, KEPT.1, FilterType::Triangle).to_rgb8()
}

fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/screens").join(name).with_extension("png")
}

const SCENE: &str = "(version: 1, source: \"gallery:hand\", resolution: 24, keys: 4)";

/// Pictures are taken a frame after they are asked for, and written on a thread.
const SCENARIO: &str = "
wait done
frames 6
shot done.png
frames 4
lambda 0.5
frames 3
expect lambda 0.5
shot half.png
frames 4
lambda 1
show beside
frames 2
wait done
key f
frames 4
shot beside.png
frames 4
show wipe
key f
wait done
frames 3
drag 640 500 860 500 4 left
frames 3
expect wipe 0.816
shot wipe.png
frames 4
show wipe
show sizes
key f
frames 4
shot sizes.png
frames 4
show sizes
key f
show record
frames 4
shot record.png
frames 3
film film.apng 96 64 0.5 8
wait preview
frames 2
shot filming.png
wait film
expect calm
show record
frames 3
key space
frames 4
key space
key home
frames 2
expect lambda 0
key end
key b
drag 600 330 603 330 1 left
frames 2
expect strokes 1
key z ctrl
expect strokes 0
key z ctrl shift
expect strokes 1
wait done
frames 4
shot painted.png
frames 4
open broken.obj
wait idle
frames 3
expect problem broken.obj
expect strokes 1
shot problem.png
frames 4
key escape
expect calm
save saved.ron
mesh out.glb
wait idle
frames 2
expect calm
key v
move 640 40
show help
frames 3
shot help.png
frames 4
show help
show export
frames 3
shot export.png
frames 4
show export
resize 1920 1080
frames 6
key f
frames 4
shot large.png
frames 6
quit
";

#[test]
fn the_window_opens_paints_plays_refuses_and_saves() {
    let Some(display) = Display::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("hand.ron", SCENE);
    write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    write("scenario.txt", SCENARIO);
    let output = display.play(folder.path(), &["hand.ron", "--script", "scenario.txt", "--size", "1280,720"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let saved = homunculus::scene::Scene::load(&folder.path().join("saved.ron")).unwrap();
    assert_eq!(saved.strokes.len(), 1);
    assert!(folder.path().join("out.glb").is_file());
    let film = std::fs::File::open(folder.path().join("film.apng")).unwrap();
    let film = image::codecs::png::PngDecoder::new(BufReader::new(film)).unwrap().apng().unwrap();
    assert_eq!(film.into_frames().count(), 4, "the film has every frame");

    let mut wrong = Vec::new();
    for name in ["done", "half", "beside", "wipe", "sizes", "record", "painted", "problem", "help", "export", "large"] {
        let now = shrunk(&folder.path().join(name).with_extension("png"));
        if std::env::var_os("BLESS").is_some() {
            DynamicImage::from(now.clone()).save(kept(name)).unwrap();
        }
        if !kept(name).is_file() {
            println!("skipped: there is no {}; look at what BLESS=1 writes", kept(name).display());
            continue;
        }
        if let Err(how) = looks_like(&now, &shrunk(&kept(name))) {
            let seen = std::env::temp_dir().join(format!("homunculus-screen-{name}.png"));
            std::fs::copy(folder.path().join(name).with_extension("png"), &seen).unwrap();
            wrong.push(format!("{name}: {how}; see {}", seen.display()));
        }
        let size = std::fs::metadata(kept(name)).unwrap().len();
        assert!(size <= 100_000, "{name} takes {size} bytes");
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A picture of two halves, painted in the middle.
const PICTURE_SCENARIO: &str = "
open halves.ron
wait done
frames 4
shot rest.png
frames 4
key b
drag 600 360 680 360 3 left
key v
wait done
expect strokes 1
expect calm
drag 640 300 680 320 2 left
save painted.ron
mesh warped.png
growth growth.gif
wait idle
frames 4
shot moved.png
frames 4
expect calm
quit
";

#[test]
fn a_picture_hangs_in_the_window_in_its_own_colours() {
    let Some(display) = Display::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let colours = [[220, 90, 60], [40, 130, 200]];
    let halves = RgbImage::from_fn(96, 96, |x, _| image::Rgb(colours[usize::from(x >= 48)]));
    halves.save(folder.path().join("halves.png")).unwrap();
    write("halves.ron", "(version: 1, source: \"halves.png\", resolution: 24, fidelity: 1.0, keys: 2)");
    write("scenario.txt", PICTURE_SCENARIO);
    let output = display.play(folder.path(), &["halves.png", "--script", "scenario.txt", "--size", "1280,720"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let open = |name: &str| image::open(folder.path().join(name)).unwrap().to_rgb8();
    let (rest, moved) = (open("rest.png"), open("moved.png"));
    let is = |picture: &RgbImage, x: u32, colour: [u8; 3]| {
        let found = picture.get_pixel(x, 360).0;
        (0..3).all(|c| found[c].abs_diff(colour[c]) <= 2)
    };
    for (x, colour) in [(500, colours[0]), (780, colours[1])] {
        assert!(is(&rest, x, colour), "{:?} at {x}", rest.get_pixel(x, 360));
    }
    // Where the halves meet has been dragged to the right. Sabotage: there the picture at rest has the other colour.
    assert!(is(&moved, 660, colours[0]) && !is(&rest, 660, colours[0]), "{:?}", moved.get_pixel(660, 360));
    let saved = homunculus::scene::Scene::load(&folder.path().join("painted.ron")).unwrap();
    assert_eq!(saved.strokes.len(), 1);
    assert!(open("warped.png").width() >= 96 && folder.path().join("growth.gif").is_file());
}

#[test]
fn sabotage_another_picture_is_seen() {
    let pairs = [
        ("done", "half"),
        ("done", "record"),
        ("done", "help"),
        ("done", "export"),
        ("done", "large"),
        ("done", "wipe"),
        ("beside", "wipe"),
    ];
    for (a, b) in pairs {
        if let Some(missing) = [a, b].into_iter().find(|name| !kept(name).is_file()) {
            println!("skipped: there is no picture of {missing} to compare with");
            continue;
        }
        assert!(looks_like(&shrunk(&kept(a)), &shrunk(&kept(b))).is_err(), "{a} and {b}");
        assert!(looks_like(&shrunk(&kept(a)), &shrunk(&kept(a))).is_ok());
    }
}

#[test]
fn without_a_display_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    if homunculus::view::adapter().is_err() {
        println!("skipped: there is no Vulkan driver, which is asked for first");
        return;
    }
    for display in [None, Some(":63")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_homunculus"));
        command.arg("play").env_remove("WAYLAND_DISPLAY").env_remove("DISPLAY").env("XDG_DATA_HOME", folder.path());
        // Without it the driver has something to say too.
        command.env("XDG_RUNTIME_DIR", folder.path());
        if let Some(display) = display {
            command.env("DISPLAY", display);
        }
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.lines().count() == 1 && said.contains("DISPLAY"), "{said}");
    }
}

#[test]
fn without_a_driver_it_names_the_package() {
    let folder = tempfile::tempdir().unwrap();
    // The Vulkan loader finds no driver where this names a file that is none.
    let nothing = folder.path().join("none.json");
    let output = Command::new(env!("CARGO_BIN_EXE_homunculus"))
        .arg("play")
        .env("VK_DRIVER_FILES", &nothing)
        .env("VK_ICD_FILENAMES", &nothing)
        .env("XDG_DATA_HOME", folder.path())
        .env("XDG_RUNTIME_DIR", folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.lines().count() == 1 && said.contains("mesa-vulkan-drivers"), "{said}");
}

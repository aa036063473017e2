//! Contract of the gallery's pictures. `homunculus gallery --render`: a folder that opens from the disk, with four pictures
//! of each scene, in which crossings are red where Eq. 1 alone crosses and nowhere else; faults are told on the page and by
//! the exit code. In the window: a thumbnail of each scene, and a click opens it.
#![cfg(all(feature = "cli", feature = "record"))]
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::path::Path;
use std::process::{Command, Output};

use image::RgbImage;

fn gallery(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_homunculus"))
        .arg("gallery")
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .env("XDG_RUNTIME_DIR", folder)
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Pixels as red as crossings are marked.
fn red(picture: &RgbImage) -> usize {
    picture.pixels().filter(|p| p.0[0] > 120 && p.0[1] < 60 && p.0[2] < 60).count()
}

#[test]
fn a_page_shows_what_was_asked_achieved_and_proven() {
    if let Err(error) = homunculus::view::adapter() {
        println!("skipped: {error}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let output = gallery(folder.path(), "--render page hand gallery:snake");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    for line in ["hand: certified", "snake: certified"] {
        assert!(said(&output).contains(line), "{}", said(&output));
    }
    let page = folder.path().join("page");
    let html = std::fs::read_to_string(page.join("index.html")).unwrap();
    assert!(html.contains("2 of 2") && html.contains("modelled here"), "{html}");
    for name in ["hand", "snake"] {
        let picture = |which: &str| {
            let file = format!("pictures/{name}-{which}.jpg");
            assert!(html.contains(&format!("src=\"{file}\"")), "{file}");
            image::open(page.join(file)).unwrap().to_rgb8()
        };
        let [rest, classic, ours] = ["rest", "classic", "ours"].map(picture);
        assert!(red(&classic) > red(&rest) + 20, "{name}: the crossings of Eq. 1 are seen");
        assert_ne!(rest, ours);
        let thumbnail = std::fs::metadata(page.join(format!("thumbnails/{name}.jpg"))).unwrap();
        assert!(thumbnail.len() <= 15_000, "{name}: {} bytes", thumbnail.len());
    }
    // What a page names lies beside it.
    let named: Vec<&str> = html.split("src=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert_eq!(named.len(), 8);
    assert!(named.iter().all(|file| page.join(file).is_file()) && !html.contains("://"));
    let sheet = image::open(page.join("contact-sheet.png")).unwrap().to_rgb8();
    assert!(sheet.width() > 1900 && red(&sheet) > 0);
    let ink = sheet.enumerate_pixels().filter(|(_, y, p)| *y < 70 && p.0[0] < 100).count();
    assert!(ink > 200, "the sheet has a title: {ink}");
}

#[test]
fn an_unknown_scene_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let output = gallery(folder.path(), "--render page hand cat");
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("`cat`") && said(&output).contains("crocodile"), "{}", said(&output));
    assert!(!folder.path().join("page").exists());
    let listed = gallery(folder.path(), "hand cat");
    assert_eq!(listed.status.code(), Some(2));
    let listed = gallery(folder.path(), "hand");
    assert_eq!(String::from_utf8_lossy(&listed.stdout).lines().count(), 1);
}

#[test]
fn every_scene_has_a_small_picture() {
    use homunculus::gallery::{everything, thumbnails::thumbnail};
    for entry in everything() {
        let bytes = thumbnail(entry.name).unwrap_or_else(|| panic!("{} has no thumbnail", entry.name));
        assert!(bytes.len() <= 15_000, "{}: {} bytes", entry.name, bytes.len());
        let picture = image::load_from_memory(bytes).unwrap().to_rgb8();
        assert!(picture.width() == picture.height() && picture.width() >= 128, "{}", entry.name);
        let darkest = picture.pixels().map(|p| p.0[1]).min().unwrap();
        assert!(darkest < 150, "{} is blank", entry.name);
    }
    assert!(thumbnail("cat").is_none());
}

#[cfg(feature = "window")]
mod window {
    use bevy_egui::egui::{Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, Vec2};
    use homunculus::gallery::everything;
    use homunculus::panel::{self, Choice, Facts, Wish, card_id};
    use homunculus::scene::Source;
    use homunculus::session::Snapshot;

    /// One frame of a window of 1280 × 720 with nothing open.
    fn frame(ctx: &Context, choice: &mut Choice, events: Vec<Event>) -> Vec<Wish> {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, Vec2::new(1280.0, 720.0)));
        let snapshot = Snapshot::default();
        let facts = Facts {
            title: "",
            file: None,
            is_changed: false,
            draft: None,
            painting: None,
            snapshot: &snapshot,
            legend: None,
            recent: &[],
            busy: None,
            problem: None,
            warnings: &[],
            can_restore: false,
            #[cfg(feature = "record")]
            filming: None,
            filmed: None,
            sizes: Vec::new(),
        };
        let mut wishes = Vec::new();
        let input = RawInput { screen_rect, events, ..RawInput::default() };
        let mut output = ctx.run_ui(input, |ui| {
            panel::draw(ui, &facts, choice, &mut wishes);
        });
        // Nobody draws: egui wants to be told that its textures are not wanted.
        output.textures_delta.clear();
        wishes
    }

    fn click(ctx: &Context, choice: &mut Choice, pos: Pos2) -> Vec<Wish> {
        let button =
            |pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE };
        let mut wishes = frame(ctx, choice, vec![Event::PointerMoved(pos)]);
        wishes.extend(frame(ctx, choice, vec![button(true)]));
        wishes.extend(frame(ctx, choice, vec![button(false)]));
        wishes
    }

    #[test]
    fn a_click_opens_the_scene_and_closes_the_gallery() {
        let ctx = Context::default();
        let mut choice = Choice { gallery: true, ..Choice::default() };
        // Windows are laid out in their first frames.
        for _ in 0..4 {
            assert!(frame(&ctx, &mut choice, Vec::new()).is_empty());
        }
        let place = |name: &str| ctx.read_response(card_id(name)).unwrap_or_else(|| panic!("no {name}")).rect;
        for entry in everything() {
            let rect = place(entry.name);
            assert!(rect.is_positive() && rect.max.x < 1280.0 && rect.max.y < 720.0, "{} at {rect:?}", entry.name);
        }
        let elephant = place("elephant").center();
        let wishes = click(&ctx, &mut choice, elephant);
        assert_eq!(wishes, [Wish::Open(Source::Gallery("elephant".into()))]);
        assert!(!choice.gallery);
        // Sabotage: where it is closed, the same click opens nothing.
        assert!(click(&ctx, &mut choice, elephant).is_empty());
    }
}

//! Panels say what is so: drawn without a window, and read.

use bevy_egui::egui::epaint::Shape;
use bevy_egui::egui::{Context, Event, Key, Modifiers, Pos2, RawInput, Rect, Vec2};
use homunculus::app::play::Sandbox;
use homunculus::importance::Offered;
use homunculus::panel::{self, Asked, Compare, Facts, Prompt, Tool, Wish, theme};
use homunculus::scene::Source;

use super::stage::Stage;

/// A text, where it stands, and what of the window it can be seen in.
struct Text {
    text: String,
    rect: Rect,
    clip: Rect,
}

/// All that the panels say, in the order it is drawn.
fn said(sandbox: &mut Sandbox) -> Vec<String> {
    drawn(sandbox, &[]).into_iter().map(|text| text.text).collect()
}

/// What is cut at its left or right.
fn cut(sandbox: &mut Sandbox, sizes: &[(Pos2, &'static str)]) -> Vec<String> {
    let is_cut = |t: &Text| t.rect.left() < t.clip.left() - 0.5 || t.rect.right() > t.clip.right() + 0.5;
    drawn(sandbox, sizes).into_iter().filter(is_cut).map(|text| text.text).collect()
}

/// What the panels write, with the names of reference shapes.
fn drawn(sandbox: &mut Sandbox, sizes: &[(Pos2, &'static str)]) -> Vec<Text> {
    let context = Context::default();
    theme::apply(&context);
    let mut texts = Vec::new();
    // Windows are laid out in the first frame and shown in the next.
    for _ in 0..3 {
        let (now, wishes) = frame(&context, sandbox, sizes, Vec::new());
        assert_eq!(wishes, [], "nobody has wished for anything");
        texts = now;
    }
    texts
}

/// One frame of a window of 1280 × 720: what is written in it, and what is wished for.
fn frame(
    context: &Context,
    sandbox: &mut Sandbox,
    sizes: &[(Pos2, &'static str)],
    events: Vec<Event>,
) -> (Vec<Text>, Vec<Wish>) {
    let (mut choice, mut wishes) = (sandbox.choice.clone(), Vec::new());
    let draft = sandbox.open.as_ref().map(|open| open.draft());
    let facts = Facts {
        title: "test",
        file: None,
        is_changed: false,
        draft: draft.as_ref(),
        painting: sandbox.open.as_ref().map(|open| &open.painting),
        snapshot: &sandbox.snapshot,
        legend: None,
        recent: &[],
        busy: sandbox.busy(),
        problem: sandbox.problem.as_deref(),
        warnings: &[],
        can_restore: false,
        #[cfg(feature = "record")]
        filming: None,
        filmed: None,
        sizes: sizes.to_vec(),
    };
    let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, Vec2::new(1280.0, 720.0)));
    let input = RawInput { screen_rect, events, ..RawInput::default() };
    let mut output = context.run_ui(input, |root| {
        panel::draw(root, &facts, &mut choice, &mut wishes);
    });
    // Nobody draws: egui wants to be told that its textures are not wanted.
    output.textures_delta.clear();
    let mut texts = Vec::new();
    output.shapes.iter().for_each(|clipped| read(&clipped.shape, clipped.clip_rect, &mut texts));
    sandbox.choice = choice;
    (texts, wishes)
}

fn read(shape: &Shape, clip: Rect, texts: &mut Vec<Text>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| read(shape, clip, texts)),
        Shape::Text(text) => {
            let rect = text.galley.rect.translate(text.pos.to_vec2());
            texts.push(Text { text: text.galley.text().to_owned(), rect, clip });
        }
        _ => {}
    }
}

fn says(texts: &[String], wanted: &str) -> bool {
    texts.iter().any(|text| text.contains(wanted))
}

#[test]
fn what_is_counted_is_said_of_the_state_it_was_counted_in() {
    let mut stage = Stage::hand();
    stage.solved();
    let counts = stage.sandbox().snapshot.outcome.as_ref().unwrap().classic.unwrap();
    let keyframes = stage.sandbox().snapshot.film.len();
    stage.sandbox().choice.compare = Compare::SideBySide;
    for lambda in [1.0, 0.3] {
        stage.sandbox().choice.player.scrub(lambda);
        let texts = said(&mut stage.sandbox());
        let classic = format!("at full growth: {} inverted elements, {} crossings", counts.inverted, counts.crossings);
        assert!(says(&texts, &classic), "{texts:?}");
        let certified = format!("0 inverted elements, 0 crossings in all {keyframes} keyframes");
        assert!(says(&texts, &certified), "{texts:?}");
    }
    stage.sandbox().choice.compare = Compare::Off;
    assert!(!says(&said(&mut stage.sandbox()), "at full growth"));
}

#[cfg(feature = "record")]
#[test]
fn a_picture_has_no_turntable_in_the_view_or_in_its_films() {
    let mut stage = Stage::hand();
    stage.sandbox().choice.record.is_open = true;
    let of_body = said(&mut stage.sandbox());
    let count = |texts: &[String]| texts.iter().filter(|text| text.contains("Turntable")).count();
    assert_eq!(count(&of_body), 2, "{of_body:?}");
    stage.wish(Wish::Open(Source::Gallery("magnet".into())));
    stage.wait("the magnet", |s| s.open.as_ref().is_some_and(|open| open.is_flat()));
    let of_picture = said(&mut stage.sandbox());
    assert!(says(&of_picture, "Growth") && count(&of_picture) == 0, "{of_picture:?}");
}

#[test]
fn where_there_is_no_dialog_the_window_says_so_and_asks_for_the_path() {
    let mut stage = Stage::hand();
    let before = said(&mut stage.sandbox());
    assert!(!says(&before, "xdg-desktop-portal"));
    stage.sandbox().choice.prompt = Some(Prompt::new(Asked::ExportMesh, "hand-warped.glb".into()));
    let asked = said(&mut stage.sandbox());
    assert!(says(&asked, "xdg-desktop-portal") && says(&asked, "hand-warped.glb"), "{asked:?}");
    stage.sandbox().choice.prompt = Some(Prompt::new(Asked::Layer(Offered::Regions), String::new()));
    let asked = said(&mut stage.sandbox());
    assert!(says(&asked, "Regions") && says(&asked, "Values"), "{asked:?}");
}

#[test]
fn a_path_is_typed_and_entered_without_the_mouse() {
    let mut stage = Stage::empty();
    stage.sandbox().choice.prompt = Some(Prompt::new(Asked::Open, String::new()));
    let context = Context::default();
    let key = |key| Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: Modifiers::NONE };
    let mut wished = Vec::new();
    let events = [Vec::new(), Vec::new(), vec![key(Key::Enter)], Vec::new(), vec![Event::Text("body.obj".into())]];
    for events in events.into_iter().chain([vec![key(Key::Enter)], Vec::new()]) {
        wished.extend(frame(&context, &mut stage.sandbox(), &[], events).1);
    }
    assert_eq!(wished, [Wish::Choose(Asked::Open, vec!["body.obj".into()])]);
    assert!(stage.sandbox().choice.prompt.is_none());
}

#[test]
fn nothing_is_cut_at_the_sides_of_its_panel() {
    let mut stage = Stage::hand();
    stage.solved();
    let open_all = |stage: &mut Stage| {
        let mut sandbox = stage.sandbox();
        let choice = &mut sandbox.choice;
        // With this tool the fills are open.
        (choice.tool, choice.compare) = (Tool::Fill, Compare::SideBySide);
        (choice.help, choice.export.is_open) = (true, true);
        #[cfg(feature = "record")]
        panel::open_record(choice, "hand.ron");
    };
    open_all(&mut stage);
    let texts = said(&mut stage.sandbox());
    assert!(says(&texts, "Along") && says(&texts, "Keys and mouse") && says(&texts, "Warped mesh"), "{texts:?}");
    assert_eq!(cut(&mut stage.sandbox(), &[]), [""; 0]);
    stage.wish(Wish::Open(Source::Gallery("magnet".into())));
    stage.wait("the magnet", |s| s.open.as_ref().is_some_and(|open| open.is_flat()));
    open_all(&mut stage);
    assert_eq!(cut(&mut stage.sandbox(), &[]), [""; 0]);
    // Sabotage: what reaches under a panel is seen to.
    assert_eq!(cut(&mut stage.sandbox(), &[(Pos2::new(292.0, 300.0), "×½")]), ["×½"]);
}

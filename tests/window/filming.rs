//! Films from the window: shot with the settings of its dialog, seen while they are, cancelled without a trace.

use std::fs::File;
use std::io::BufReader;

use homunculus::panel::{Asked, Compare, Wish};
use homunculus::record::View;
use image::{AnimationDecoder, RgbaImage, codecs::png::PngDecoder};

use super::stage::Stage;

/// The hand, solved, and a small film asked for; `None` where nothing can draw.
fn stage() -> Option<Stage> {
    if let Err(error) = homunculus::view::adapter() {
        eprintln!("skipped: {error}");
        return None;
    }
    let mut stage = Stage::hand();
    stage.solved();
    let mut sandbox = stage.sandbox();
    let draft = &mut sandbox.choice.record.draft;
    (draft.width, draft.height, draft.seconds, draft.fps, draft.hold) = (96, 64, 0.5, 8, 0.0);
    (draft.legend, draft.title) = (false, None);
    Some(stage)
}

fn frames(path: &std::path::Path) -> Vec<RgbaImage> {
    let decoder = PngDecoder::new(BufReader::new(File::open(path).unwrap())).unwrap();
    let frames = decoder.apng().unwrap().into_frames().collect_frames().unwrap();
    frames.into_iter().map(image::Frame::into_buffer).collect()
}

fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let sum: f64 = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / a.as_raw().len() as f64
}

#[test]
fn a_film_has_every_frame_and_is_seen_while_it_is_shot() {
    let Some(mut stage) = stage() else { return };
    let path = stage.path("film.apng");
    stage.wish(Wish::Export(Asked::ExportFilm, path.clone()));
    let filming = stage.sandbox().filming.as_ref().map(|film| (film.frames, film.path.clone()));
    assert_eq!(filming, Some((4, path.clone())), "{:?}", stage.sandbox().problem);
    assert!(!path.exists(), "it takes its name at the end");
    // Another one has to wait, and says so.
    let other = stage.path("other.apng");
    stage.wish(Wish::Export(Asked::ExportFilm, other.clone()));
    assert!(stage.sandbox().problem.take().is_some_and(|problem| problem.contains("film.apng")));
    let mut seen = Vec::new();
    let start = std::time::Instant::now();
    while stage.sandbox().filming.is_some() {
        let sandbox = stage.sandbox();
        if let Some((drawn, preview)) = sandbox.filming.as_ref().and_then(|film| Some((film.drawn(), film.preview()?)))
        {
            assert_eq!(preview.dimensions(), (96, 64));
            seen.push(drawn);
        }
        stage.app.update();
        std::thread::sleep(std::time::Duration::from_millis(1));
        assert!(start.elapsed() < super::PATIENCE);
    }
    assert!(stage.sandbox().problem.is_none(), "{:?}", stage.sandbox().problem);
    assert!(seen.is_sorted() && seen.first().is_some_and(|first| *first < 4), "{seen:?}");
    assert!(stage.sandbox().filmed.as_ref().is_some_and(|(told, certified)| *certified && told.contains("certified")));
    let shot = frames(&path);
    assert_eq!(shot.len(), 4, "no frame is dropped");
    assert!(shot.iter().all(|frame| frame.dimensions() == (96, 64)));
    assert!(difference(&shot[0], &shot[3]) > 1.0, "it grows");
    let beside: serde_json::Value = serde_json::from_slice(&std::fs::read(stage.path("film.json")).unwrap()).unwrap();
    assert_eq!(beside["recording"]["certified"], true);
    assert_eq!(beside["recording"]["frames"].as_array().unwrap().len(), 4);
    assert!(!other.exists());
}

#[test]
fn a_film_that_is_cancelled_leaves_nothing_and_the_next_can_be_shot() {
    let Some(mut stage) = stage() else { return };
    stage.sandbox().choice.record.draft.seconds = 60.0;
    let path = stage.path("long.apng");
    stage.wish(Wish::Export(Asked::ExportFilm, path.clone()));
    stage.wait("the first frame", |s| s.filming.as_ref().is_none_or(|film| film.drawn() > 0));
    stage.wish(Wish::StopFilm);
    stage.wait("the end", |s| s.filming.is_none());
    assert!(stage.sandbox().problem.is_none() && stage.sandbox().filmed.is_none());
    let left: Vec<_> = std::fs::read_dir(path.parent().unwrap()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| name == "hand.ron" || name == "memory"), "{left:?}");

    stage.sandbox().choice.record.draft.seconds = 0.3;
    stage.sandbox().choice.record.draft.view = View::Compare;
    let next = stage.path("next.apng");
    stage.wish(Wish::Export(Asked::ExportFilm, next.clone()));
    stage.wait("the film", |s| s.filming.is_none());
    assert_eq!(frames(&next).len(), 2, "{:?}", stage.sandbox().problem);
}

#[test]
fn a_film_that_cannot_be_is_refused_in_a_sentence() {
    let Some(mut stage) = stage() else { return };
    for (name, word) in [("film.xyz", "film.xyz"), ("nowhere/film.apng", "film.apng")] {
        let path = stage.path(name);
        stage.wish(Wish::Export(Asked::ExportFilm, path));
        stage.wait("the refusal", |s| s.filming.is_none());
        let problem = stage.sandbox().problem.take().unwrap();
        assert!(problem.contains(word) && !problem.contains('\n'), "{problem}");
    }
    stage.sandbox().choice.record.draft.fps = 0;
    let path = stage.path("film.apng");
    stage.wish(Wish::Export(Asked::ExportFilm, path));
    assert!(stage.sandbox().problem.as_ref().is_some_and(|problem| problem.contains("fps 0")));
}

#[test]
fn the_dialog_opens_with_what_the_window_shows() {
    let mut stage = Stage::hand();
    stage.sandbox().choice.compare = Compare::Wipe;
    stage.sandbox().choice.turntable = true;
    stage.control("r", false);
    let sandbox = stage.sandbox();
    let record = &sandbox.choice.record;
    assert!(record.is_open);
    assert_eq!((record.name.as_str(), record.draft.view, record.draft.turntable), ("hand.mp4", View::Compare, 1.0));
    stage.press(bevy::input::keyboard::Key::Escape);
    assert!(!stage.sandbox().choice.record.is_open);
}

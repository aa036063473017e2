//! What runs beside the window: a file that takes its time belongs to what it was read for, a change that is not solved yet
//! is not exported as if it were, Esc stops what is being written, and paths can be typed where there is no dialog.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use bevy::input::keyboard::Key;
use homunculus::app::play::Sandbox;
use homunculus::importance::Layer;
use homunculus::paint::Fill;
use homunculus::panel::{Asked, Prompt, Wish};
use homunculus::scene::Source;

use super::stage::Stage;

const TABLE: &str = "vertex,importance\n0,3\n";

/// A file that is read only when somebody has written it.
struct Slow(PathBuf);

impl Slow {
    fn new(path: PathBuf) -> Self {
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        Self(path)
    }

    /// What comes for whoever reads it now; from then on it is an ordinary file.
    fn write(self, text: &str) {
        // Opens when there is a reader.
        let mut now = std::fs::File::options().write(true).open(&self.0).unwrap();
        let then = self.0.with_extension("then");
        std::fs::write(&then, text).unwrap();
        std::fs::rename(&then, &self.0).unwrap();
        // Who only looked whether it is a file has gone, and comes again for the file.
        let _ = now.write_all(text.as_bytes());
    }
}

/// A tetrahedron from a file, open.
fn tetrahedron(stage: &mut Stage, name: &str) {
    let path = stage.path(name);
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n").unwrap();
    open(stage, path);
}

fn open(stage: &mut Stage, path: PathBuf) {
    stage.wish(Wish::OpenPath(path.clone()));
    let wanted = Source::File(path);
    stage.wait("the mesh", |s| s.open.as_ref().is_some_and(|open| *open.source() == wanted));
}

fn values(path: &Path) -> Wish {
    Wish::AddLayer(Layer::Values { path: path.into() })
}

fn layers(sandbox: &Sandbox) -> usize {
    sandbox.open.as_ref().unwrap().draft().layers.len()
}

#[test]
fn a_layer_that_comes_late_is_not_laid_over_something_else() {
    let mut stage = Stage::empty();
    tetrahedron(&mut stage, "first.obj");
    let slow = Slow::new(stage.path("slow.csv"));
    stage.wish(values(&slow.0));
    assert!(stage.sandbox().busy().is_some());
    tetrahedron(&mut stage, "second.obj");
    let before = stage.bits();
    slow.write(TABLE);
    stage.calm();
    assert_eq!(stage.sandbox().problem, None);
    assert_eq!((layers(&stage.sandbox()), stage.bits()), (0, before.clone()));
    // Sabotage: where nothing else was opened meanwhile, it comes.
    let slow = Slow::new(stage.path("slower.csv"));
    stage.wish(values(&slow.0));
    slow.write(TABLE);
    stage.calm();
    assert_eq!(layers(&stage.sandbox()), 1);
    assert_ne!(stage.bits(), before);
}

#[test]
fn of_two_things_to_be_opened_the_last_one_stays() {
    let mut stage = Stage::empty();
    let slow = Slow::new(stage.path("slow.obj"));
    stage.wish(Wish::OpenPath(slow.0.clone()));
    tetrahedron(&mut stage, "second.obj");
    slow.write("v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    stage.calm();
    let second = Source::File(stage.path("second.obj"));
    assert_eq!(stage.sandbox().problem, None);
    assert_eq!(*stage.sandbox().open.as_ref().unwrap().source(), second);
}

#[test]
fn layers_wished_for_while_another_is_read_come_too() {
    let mut stage = Stage::empty();
    tetrahedron(&mut stage, "first.obj");
    let slow = Slow::new(stage.path("slow.csv"));
    std::fs::write(stage.path("fast.csv"), "vertex,importance\n1,2\n").unwrap();
    stage.wish(values(&slow.0));
    stage.wish(values(&stage.path("fast.csv")));
    for base in [1.1, 1.2, 1.3] {
        stage.wish(Wish::SetBase(base));
    }
    assert_eq!(layers(&stage.sandbox()), 0);
    slow.write(TABLE);
    stage.calm();
    let draft = stage.sandbox().open.as_ref().unwrap().draft();
    assert_eq!((draft.layers.len(), draft.base), (2, 1.3), "{:?}", stage.sandbox().problem);
    // One step back each, the base in one.
    for expected in [(2, 1.0), (1, 1.0), (0, 1.0)] {
        stage.control("z", false);
        let draft = stage.sandbox().open.as_ref().unwrap().draft();
        assert_eq!((draft.layers.len(), draft.base), expected);
    }
}

#[test]
fn what_is_not_solved_yet_is_not_exported_as_if_it_were() {
    let mut stage = Stage::hand();
    stage.solved();
    let path = stage.path("report.json");
    // In one frame, and in the next, before the solver can have heard of it.
    for later in [false, true] {
        stage.sandbox().wishes.push(Wish::Fill(Fill::All { value: if later { 1.2 } else { 1.4 } }));
        if later {
            stage.app.update();
        }
        stage.wish(Wish::Export(Asked::ExportReport, path.clone()));
        let problem = stage.sandbox().problem.take().unwrap_or_default();
        assert!(problem.contains("wait until the solver is done") && !problem.contains('\n'), "{problem}");
        assert!(stage.sandbox().busy().is_none() && !path.exists());
    }
    // Sabotage: when it is solved it is.
    stage.solved();
    stage.wish(Wish::Export(Asked::ExportReport, path.clone()));
    stage.calm();
    assert_eq!(stage.sandbox().problem, None);
    let told: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    // All is ×1.2, where nothing is to be moved apart.
    assert_eq!(
        (told["classic"]["crossings"].as_u64(), told["certificate"]["certified"].as_bool()),
        (Some(0), Some(true))
    );
}

#[test]
fn escape_stops_a_growth_that_is_being_written() {
    let mut stage = Stage::hand();
    stage.solved();
    let path = stage.path("growth.glb");
    stage.sandbox().wishes.push(Wish::Export(Asked::ExportGrowth, path.clone()));
    stage.press(Key::Escape);
    stage.calm();
    assert_eq!(stage.sandbox().problem, None, "whoever stopped it knows");
    let left = std::fs::read_dir(stage.folder.path()).unwrap().map(|e| e.unwrap().file_name());
    let left: Vec<String> = left.map(|name| name.to_string_lossy().into_owned()).collect();
    assert!(left.iter().all(|name| !name.contains("growth") && !name.contains(".part")), "{left:?}");
    // Sabotage: unstopped it is there.
    stage.wish(Wish::Export(Asked::ExportGrowth, path.clone()));
    stage.calm();
    assert!(path.is_file());
}

#[test]
fn paths_typed_in_the_window_do_what_a_dialog_does() {
    let mut stage = Stage::hand();
    stage.sandbox().choice.prompt = Some(Prompt::new(Asked::SaveScene, "hand.ron".into()));
    stage.sandbox().choice.help = true;
    stage.press(Key::Escape);
    let sandbox = stage.sandbox();
    assert!(sandbox.choice.prompt.is_none() && sandbox.choice.help, "Esc closes what lies on top");
    let path = stage.path("typed.ron");
    stage.wish(Wish::Choose(Asked::SaveScene, vec![path.clone()]));
    stage.calm();
    stage.calm();
    assert!(path.is_file());
    assert_eq!(stage.sandbox().open.as_ref().unwrap().file, Some(path));
    stage.wish(Wish::Choose(Asked::Open, vec![stage.path("nowhere.obj")]));
    stage.wait("the sentence", |s| s.problem.is_some());
    // Nothing chosen is nothing done.
    stage.sandbox().problem = None;
    stage.wish(Wish::Choose(Asked::Open, Vec::new()));
    std::thread::sleep(Duration::from_millis(20));
    stage.calm();
    assert_eq!(stage.sandbox().problem, None);
}

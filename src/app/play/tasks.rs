//! What takes long, on threads of its own: reading, writing, the system's dialogs.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::mpsc;

use super::document::Document;
use super::marks::Found;
use crate::paint::Under;
use crate::panel::Asked;
use crate::{Error, Result};

/// What has come of a task.
pub(super) enum Done {
    /// A scene was read.
    Opened(Result<Box<Document>>),
    /// Layers were read.
    Layers(Result<Box<Under>>),
    /// The dialog was closed; without files it was cancelled.
    Chosen(Asked, Vec<PathBuf>),
    /// The scene was saved.
    Saved(Result<(PathBuf, (u64, u64))>),
    /// Something was written.
    Written(Result<PathBuf>),
    /// A film was recorded, and whether all it shows is certified.
    #[cfg(feature = "record")]
    Filmed(Result<(PathBuf, bool)>),
    /// A copy for the case of a crash was written.
    Kept(Result<()>),
    /// A picture of the window was written.
    Pictured(Result<()>),
    /// What crosses in Eq. 1's solution was found.
    Marked(Box<Found>),
}

/// Tasks that run.
pub(super) struct Tasks {
    results: Mutex<mpsc::Receiver<Done>>,
    sender: mpsc::Sender<Done>,
    /// What the running ones do, for a person; dialogs and copies are not told of.
    running: Vec<String>,
    /// Whether a dialog is open: the system shows one at a time.
    has_dialog: bool,
    quiet: usize,
}

impl Default for Tasks {
    fn default() -> Self {
        let (sender, results) = mpsc::channel();
        Self { results: Mutex::new(results), sender, running: Vec::new(), has_dialog: false, quiet: 0 }
    }
}

impl Tasks {
    /// Starts a task. `what` is shown meanwhile.
    pub fn start(&mut self, what: impl Into<String>, work: impl FnOnce() -> Done + Send + 'static) {
        self.running.push(what.into());
        self.spawn(work);
    }

    /// Starts a task nobody needs to know of.
    pub fn start_quietly(&mut self, work: impl FnOnce() -> Done + Send + 'static) {
        self.quiet += 1;
        self.spawn(work);
    }

    fn spawn(&self, work: impl FnOnce() -> Done + Send + 'static) {
        let sender = self.sender.clone();
        // Who has gone needs no result.
        let run = move || drop(sender.send(work()));
        if std::thread::Builder::new().name("task".into()).spawn(run).is_err() {
            let _ = self.sender.send(Done::Written(Err(Error::Fault("the system gives no thread".into()))));
        }
    }

    /// Opens the system's dialog, unless one is open.
    pub fn ask(&mut self, asked: Asked, proposed: &str) {
        if std::mem::replace(&mut self.has_dialog, true) {
            return;
        }
        let proposed = proposed.to_owned();
        self.spawn(move || Done::Chosen(asked, choose(asked, &proposed)));
    }

    /// What has come since.
    pub fn take(&mut self) -> Vec<Done> {
        let results = self.results.get_mut().unwrap_or_else(std::sync::PoisonError::into_inner);
        let done: Vec<Done> = results.try_iter().collect();
        for result in &done {
            match result {
                Done::Chosen(..) => self.has_dialog = false,
                Done::Kept(_) | Done::Pictured(_) | Done::Marked(_) => self.quiet = self.quiet.saturating_sub(1),
                #[cfg(feature = "record")]
                Done::Filmed(_) => self.quiet = self.quiet.saturating_sub(1),
                // Tasks of one kind end in the order they began, near enough for a line of text.
                Done::Opened(_) | Done::Layers(_) | Done::Saved(_) | Done::Written(_) => {
                    if !self.running.is_empty() {
                        self.running.remove(0);
                    }
                }
            }
        }
        done
    }

    /// What is being done.
    pub fn busy(&self) -> Option<&str> {
        self.running.first().map(String::as_str)
    }

    /// Whether anything runs whose result will be looked for.
    pub fn is_idle(&self) -> bool {
        self.running.is_empty() && !self.has_dialog && self.quiet == 0
    }
}

/// The system's dialog; waits for the user.
fn choose(asked: Asked, proposed: &str) -> Vec<PathBuf> {
    const MESHES: [&str; 6] = ["glb", "gltf", "obj", "ply", "stl", "off"];
    const PICTURES: [&str; 4] = ["png", "jpg", "jpeg", "webp"];
    let all: Vec<&str> = MESHES.into_iter().chain(PICTURES).chain(["ron"]).collect();
    let is_picture = PICTURES.iter().any(|extension| proposed.ends_with(extension));
    let dialog = rfd::FileDialog::new();
    let one = |dialog: rfd::FileDialog| dialog.pick_file().into_iter().collect();
    let to = |dialog: rfd::FileDialog, name: &str, extensions: &[&str]| -> Vec<PathBuf> {
        dialog.set_file_name(proposed).add_filter(name, extensions).save_file().into_iter().collect()
    };
    match asked {
        Asked::Open => one(dialog
            .set_title("Open")
            .add_filter("Everything that opens", &all)
            .add_filter("Scenes", &["ron"])
            .add_filter("Meshes", &MESHES)
            .add_filter("Pictures", &PICTURES)),
        Asked::Values => one(dialog.set_title("Importance of vertices or regions").add_filter("Table", &["csv"])),
        Asked::Image => one(dialog.set_title("Importance as a picture").add_filter("Pictures", &PICTURES)),
        Asked::Regions => {
            let title = |title: &str| rfd::FileDialog::new().set_title(title);
            let regions = if is_picture {
                title("Which pixel belongs to which region: ids as grey values").add_filter("Pictures", &PICTURES)
            } else {
                title("Which vertex belongs to which region").add_filter("Table", &["csv"])
            };
            let Some(regions) = regions.pick_file() else { return Vec::new() };
            let values = title("What each region is worth").add_filter("Table", &["csv"]).pick_file();
            values.map(|values| vec![regions, values]).unwrap_or_default()
        }
        Asked::SaveScene => to(dialog.set_title("Save the scene"), "Scene", &["ron"]),
        Asked::ExportMesh if is_picture => to(dialog.set_title("Save the warped picture"), "Picture", &["png"]),
        Asked::ExportGrowth if !proposed.ends_with(".glb") => {
            to(dialog.set_title("Save the growth"), "Animation", &["gif", "apng", "glb"])
        }
        Asked::ExportMesh => to(dialog.set_title("Save the warped mesh"), "Mesh", &crate::panel::MESH_FORMATS),
        Asked::ExportGrowth => to(dialog.set_title("Save the growth"), "glTF", &["glb"]),
        Asked::ExportReport => to(dialog.set_title("Save the report"), "Report", &["json"]),
        Asked::ExportFilm => {
            let formats = ["mp4", "gif", "apng", "webm", "mov", "mkv", "webp"];
            to(dialog.set_title("Where to record the film"), "Film", &formats)
        }
    }
}

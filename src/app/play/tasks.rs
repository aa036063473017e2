//! What takes long, on threads of its own: reading, writing, the system's dialogs.

use std::path::PathBuf;
use std::sync::mpsc;
use std::sync::{Arc, Mutex};

use super::dialog;
use super::document::Document;
use super::marks::Found;
use crate::format::Kind;
use crate::importance::Layer;
use crate::paint::Under;
use crate::panel::Asked;
use crate::subject::Subject;
use crate::{Error, Result};

/// What has come of a task.
pub(super) enum Done {
    /// A scene was read, for the wish of this number.
    Opened(u64, Result<Box<Document>>),
    /// Layers were read, for the document of this number.
    Layers(u64, Result<Box<Under<Arc<dyn Subject>>>>),
    /// Files were chosen, or none.
    Chosen(Asked, Result<Chosen>),
    /// The scene of the document of this number was saved: where, and in which edition.
    Saved(u64, Result<(PathBuf, (u64, u64))>),
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
    Marked(Result<Box<Found>>),
}

/// What was chosen in a dialog.
#[derive(Debug)]
pub(super) enum Chosen {
    /// Files; none if it was cancelled.
    Files(Vec<PathBuf>),
    /// The layer that they make.
    Layer(Layer),
    /// The system shows none.
    NoDialog,
}

/// Who is to know that a task runs.
#[derive(Debug, PartialEq)]
enum Audience {
    /// A person: what it does.
    Told(String),
    /// Nobody.
    Quiet,
    /// The system shows one dialog at a time.
    Dialog,
}

/// Tasks that run.
pub(super) struct Tasks {
    results: Mutex<mpsc::Receiver<(u64, Done)>>,
    sender: mpsc::Sender<(u64, Done)>,
    /// By the number of the task, in the order they began.
    running: Vec<(u64, Audience)>,
    begun: u64,
}

impl Default for Tasks {
    fn default() -> Self {
        let (sender, results) = mpsc::channel();
        Self { results: Mutex::new(results), sender, running: Vec::new(), begun: 0 }
    }
}

/// The word that a task gives: it says what has come of it, and a fault where the task ends without saying anything, be it
/// by a panic or for want of a thread.
struct Word<T, D: FnOnce(Result<T>) -> Done> {
    number: u64,
    what: String,
    done: Option<D>,
    sender: mpsc::Sender<(u64, Done)>,
    kind: std::marker::PhantomData<fn(T)>,
}

impl<T, D: FnOnce(Result<T>) -> Done> Word<T, D> {
    fn give(&mut self, result: Result<T>) {
        if let Some(done) = self.done.take() {
            // Who has gone needs no result.
            let _ = self.sender.send((self.number, done(result)));
        }
    }
}

impl<T, D: FnOnce(Result<T>) -> Done> Drop for Word<T, D> {
    fn drop(&mut self) {
        let sentence = format!("{} broke off", self.what);
        self.give(Err(Error::Fault(sentence)));
    }
}

impl Tasks {
    /// Starts a task. `what` is shown meanwhile; `done` makes of its result what comes back.
    pub fn start<T: 'static>(
        &mut self,
        what: impl Into<String>,
        done: impl FnOnce(Result<T>) -> Done + Send + 'static,
        work: impl FnOnce() -> Result<T> + Send + 'static,
    ) {
        let what = what.into();
        self.spawn(Audience::Told(what.clone()), what, done, work);
    }

    /// Starts a task nobody needs to know of, unless it breaks off.
    pub fn start_quietly<T: 'static>(
        &mut self,
        what: impl Into<String>,
        done: impl FnOnce(Result<T>) -> Done + Send + 'static,
        work: impl FnOnce() -> Result<T> + Send + 'static,
    ) {
        self.spawn(Audience::Quiet, what.into(), done, work);
    }

    fn spawn<T: 'static>(
        &mut self,
        audience: Audience,
        what: String,
        done: impl FnOnce(Result<T>) -> Done + Send + 'static,
        work: impl FnOnce() -> Result<T> + Send + 'static,
    ) {
        self.begun += 1;
        self.running.push((self.begun, audience));
        let (number, sender) = (self.begun, self.sender.clone());
        let mut word = Word { number, what, done: Some(done), sender, kind: std::marker::PhantomData };
        let run = move || {
            let result = work();
            word.give(result);
        };
        // Where there is no thread the word is dropped, which says so.
        let _ = std::thread::Builder::new().name("task".into()).spawn(run);
    }

    /// Opens the system's dialog, unless one is open.
    pub fn ask(&mut self, asked: Asked, proposed: &str, kind: Kind) {
        if self.running.iter().any(|(_, audience)| *audience == Audience::Dialog) {
            return;
        }
        let proposed = proposed.to_owned();
        let work = move || match dialog::choose(asked, &proposed, kind) {
            Some(files) => looked_at(asked, files, kind),
            None => Ok(Chosen::NoDialog),
        };
        self.spawn(Audience::Dialog, "the system's dialog".into(), move |chosen| Done::Chosen(asked, chosen), work);
    }

    /// Files that were chosen without a dialog.
    pub fn choose(&mut self, asked: Asked, files: Vec<PathBuf>, kind: Kind) {
        let work = move || looked_at(asked, files, kind);
        self.start("looking at the files", move |chosen| Done::Chosen(asked, chosen), work);
    }

    /// What has come since.
    pub fn take(&mut self) -> Vec<Done> {
        let results = self.results.get_mut().unwrap_or_else(std::sync::PoisonError::into_inner);
        let ended: Vec<(u64, Done)> = results.try_iter().collect();
        self.running.retain(|(number, _)| ended.iter().all(|(other, _)| other != number));
        ended.into_iter().map(|(_, done)| done).collect()
    }

    /// What is being done.
    pub fn busy(&self) -> Option<&str> {
        self.running.iter().find_map(|(_, audience)| match audience {
            Audience::Told(what) => Some(what.as_str()),
            _ => None,
        })
    }

    /// Whether nothing runs whose result will be looked for.
    pub fn is_idle(&self) -> bool {
        self.running.is_empty()
    }
}

/// Files, and the layer that they make, for which they may have to be read.
fn looked_at(asked: Asked, files: Vec<PathBuf>, kind: Kind) -> Result<Chosen> {
    let Asked::Layer(offered) = asked else { return Ok(Chosen::Files(files)) };
    let layer = offered.layer(kind, &files)?;
    Ok(layer.map_or(Chosen::Files(Vec::new()), Chosen::Layer))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn ended(tasks: &mut Tasks) -> Vec<Done> {
        let start = Instant::now();
        let mut done = Vec::new();
        while !tasks.is_idle() {
            assert!(start.elapsed() < Duration::from_secs(60), "a task never ended");
            done.extend(tasks.take());
            std::thread::sleep(Duration::from_millis(1));
        }
        done
    }

    #[test]
    fn a_task_that_panics_ends_with_a_sentence_and_the_others_go_on() {
        let mut tasks = Tasks::default();
        tasks.start("reading the moon", Done::Written, || panic!("on purpose"));
        tasks.start("writing b", Done::Written, || Ok("b".into()));
        assert_eq!(tasks.busy(), Some("reading the moon"));
        let mut broken = 0;
        for done in ended(&mut tasks) {
            match done {
                Done::Written(Ok(path)) => assert_eq!(path, PathBuf::from("b")),
                Done::Written(Err(error)) => {
                    assert!(error.to_string().contains("reading the moon broke off"), "{error}");
                    broken += 1;
                }
                _ => panic!("what was asked for"),
            }
        }
        assert_eq!((broken, tasks.busy()), (1, None));
    }
}

//! From a scene to what has come of it: files read, importance evaluated, warnings told, all of it solved.

use std::sync::Arc;

use super::options::SceneOptions;
use super::{cancel, note, progress};
use crate::export::report::Report;
use crate::format::Kind;
use crate::run::{self, Domain, Solved};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::subject::{self, Found, Grown, Subject};
use crate::{Error, Result};

/// What is to be warped, and how.
pub(super) struct Loaded {
    pub subject: Arc<dyn Subject>,
    pub settings: Settings,
    /// Told already, and for the report.
    warnings: Vec<String>,
    quiet: bool,
}

/// From here on Ctrl-C asks rather than kills, and as many threads work as were asked for. Comes before anything is read:
/// what is built in is decoded by threads as soon as it is found.
pub(super) fn begin(options: &SceneOptions) -> Result<()> {
    if let Some(threads) = options.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(|e| Error::Fault(format!("starting {threads} threads: {e}")))?;
    }
    cancel::listen();
    Ok(())
}

impl Loaded {
    /// Reads what a scene names.
    pub fn new(scene: &Scene, options: &SceneOptions, found: Box<dyn Found>) -> Result<Self> {
        let subject = subject::painted(found.open(scene)?, &scene.strokes)?;
        let mut warnings = subject.warnings();
        if subject::asks_for_nothing(scene) {
            warnings.push(subject.unchanged().into());
        }
        if !options.quiet {
            warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
        }
        let settings = Settings { reference: options.reference.map(Into::into), ..scene.settings() };
        Ok(Self { subject, settings, warnings, quiet: options.quiet })
    }

    /// Solves it, and shows how far it is.
    pub fn solve(&self) -> Result<Solved> {
        let watcher = progress::watcher(self.quiet);
        let domain = Domain { content: self.subject.content(), settings: self.settings.clone() };
        let solved = run::solve(domain, &watcher);
        watcher.finish();
        solved
    }

    /// What is told of it.
    pub fn report(&self, scene: &Scene, grown: &Grown) -> Report {
        subject::report(&*self.subject, scene, &self.settings, grown, self.warnings.clone())
    }
}

/// Refuses options that only pictures have.
pub(super) fn only_of_pictures(kind: Kind, options: &str, are_given: bool) -> Result<()> {
    if kind.is_flat() || !are_given {
        return Ok(());
    }
    let (are, them) = if options.contains(" and ") { ("are", "them") } else { ("is", "it") };
    let sentence = format!("{options} {are} for pictures, and this is a {}; leave {them} out", kind.word());
    Err(Error::input(sentence))
}

//! Files: which are asked for, what is made of those that were chosen, and what is saved, exported and recorded.

use std::path::{Path, PathBuf};

use super::super::document::Document;
use super::super::results;
use super::super::tasks::{Chosen, Done};
use super::Sandbox;
use crate::format::Use;
use crate::panel::{Asked, Prompt, Wish};
use crate::scene::Draft;
use crate::subject;
use crate::{Error, Result};

impl Sandbox {
    pub(super) fn chosen(&mut self, asked: Asked, chosen: Chosen) -> Result<()> {
        let files = match chosen {
            Chosen::Files(files) => files,
            Chosen::Layer(layer) => return self.fulfil(Wish::AddLayer(layer)),
            Chosen::NoDialog => {
                self.choice.prompt = Some(Prompt::new(asked, self.proposed_name(asked)));
                return Ok(());
            }
        };
        match (asked, &files[..]) {
            (_, []) => Ok(()),
            (Asked::Open, [path, ..]) => self.fulfil(Wish::OpenPath(path.clone())),
            #[cfg(feature = "record")]
            (Asked::ExportFilm, [path, ..]) => {
                self.choice.record.name = path.display().to_string();
                Ok(())
            }
            (Asked::SaveScene, [path, ..]) => self.fulfil(Wish::SaveTo(path.clone())),
            (_, [path, ..]) => self.fulfil(Wish::Export(asked, path.clone())),
        }
    }

    /// Asks for files in the system's dialog; where there is none, the window asks.
    pub(super) fn ask(&mut self, asked: Asked) {
        let proposed = self.proposed_name(asked);
        self.tasks.ask(asked, &proposed, self.kind());
    }

    pub(super) fn save(&mut self, path: PathBuf) -> Result<()> {
        let Some(open) = &mut self.open else { return Ok(()) };
        open.painting.end();
        let (scene, edition, number) = (open.scene()?, open.edition(), self.number);
        let done = move |saved| Done::Saved(number, saved);
        self.tasks
            .start(format!("saving {}", path.display()), done, move || scene.save(&path).map(|()| (path, edition)));
        Ok(())
    }

    /// Reads other layers; what is painted over them stays.
    pub(super) fn layers(&mut self, what: &str, change: impl FnOnce(&mut Draft)) -> Result<()> {
        let Some(open) = &self.open else { return Ok(()) };
        let scene = open.with_layers(change)?;
        let (known, number) = (open.painting.under().subject.clone(), self.number);
        let done = move |under| Done::Layers(number, under);
        self.tasks.start(what, done, move || subject::under(&scene, Some(&known)).map(Box::new));
        self.waiting = Some(Vec::new());
        Ok(())
    }

    pub(super) fn export(&mut self, asked: Asked, path: PathBuf) -> Result<()> {
        let order = self.order(asked, path)?;
        self.tasks.start(format!("writing {}", order.path.display()), Done::Written, move || results::write(&order));
        Ok(())
    }

    /// Records a film; one at a time.
    #[cfg(feature = "record")]
    pub(super) fn record(&mut self, path: PathBuf) -> Result<()> {
        if let Some(filming) = &self.filming {
            let sentence = format!("{} is being recorded; wait for its end or cancel it", filming.path.display());
            return Err(Error::input(sentence));
        }
        let order = self.order(Asked::ExportFilm, path)?;
        let (filming, shooting) = super::super::Filming::begin(order, &self.choice.record.draft)?;
        (self.filming, self.filmed) = (Some(filming), None);
        self.tasks.start_quietly("the recording", Done::Filmed, move || shooting.run());
        Ok(())
    }

    /// What is to be written, of all that is there now.
    pub(super) fn order(&self, asked: Asked, path: PathBuf) -> Result<results::Order> {
        let (Some(open), Some(outcome), Some(lattice)) = (&self.open, &self.snapshot.outcome, &self.snapshot.lattice)
        else {
            return Err(Error::input("there is nothing to export yet; wait until the solver is done"));
        };
        // Scene, paint and settings are those of now; so must be what was solved.
        if self.told_is_old() || !self.session.is_answered(&self.snapshot) {
            let sentence = "what was changed last is not solved yet; wait until the solver is done, then export again";
            return Err(Error::input(sentence));
        }
        Ok(results::Order {
            asked,
            path,
            scene: open.scene()?,
            subject: open.subject(),
            lattice: lattice.clone(),
            outcome: outcome.clone(),
            snapshot: self.snapshot.clone(),
            warnings: open.warnings.clone(),
            choice: self.choice.clone(),
            #[cfg(feature = "record")]
            seen_from: self.seen_from,
            stop: self.stop.clone(),
        })
    }

    pub(super) fn proposed_name(&self, asked: Asked) -> String {
        let title = self.open.as_ref().map_or_else(|| "scene".into(), Document::title);
        let stem = Path::new(&title).file_stem().map_or_else(|| title.clone(), |s| s.to_string_lossy().into_owned());
        let (kind, export) = (self.kind(), &self.choice.export);
        // The format that was chosen, where there is a choice.
        let ending = |what: Use, chosen: &'static str| {
            let known = what.extensions();
            if known.contains(&chosen) { chosen } else { known.first().copied().unwrap_or_default() }
        };
        match asked {
            Asked::SaveScene => format!("{stem}.ron"),
            Asked::ExportMesh => format!("{stem}-warped.{}", ending(Use::Result(kind), export.format)),
            Asked::ExportGrowth => format!("{stem}-growth.{}", ending(Use::Growth(kind), export.picture_growth)),
            Asked::ExportReport => format!("{stem}-report.json"),
            Asked::ExportFilm => format!("{stem}.mp4"),
            Asked::Open | Asked::Layer(_) => String::new(),
        }
    }
}

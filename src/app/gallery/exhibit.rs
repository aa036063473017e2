//! A scene as it is shown: four pictures, and what was found.

use std::sync::Arc;
use std::time::Instant;

use image::RgbImage;

use super::photographer::Photographer;
use crate::app::progress;
use crate::export::report::Report;
use crate::gallery::Entry;
use crate::run::{self, Domain};
use crate::scene::{Draft, Scene, Source};
use crate::subject::{self, Grown};
use crate::view::{Legend, Looks, Mode};
use crate::{Error, Result};

/// Side of a picture, pixels: four of them fill the width of a page on a laptop's sharp screen.
pub(super) const SIDE: u32 = 480;

/// A scene of the page.
pub(super) struct Exhibit {
    pub entry: Entry,
    /// What came of it, or why nothing did.
    pub found: std::result::Result<Found, String>,
}

/// What came of a scene.
pub(super) struct Found {
    /// At rest, its importance, Eq. 1 alone with its crossings in red, and the certified result: all from the same place.
    pub pictures: [RgbImage; 4],
    /// What the colours of importance mean.
    pub legend: Legend,
    pub report: Report,
    /// Wall time of the solve.
    pub seconds: f64,
}

/// What the four pictures are called, in files and captions.
pub(super) const NAMES: [(&str, &str); 4] =
    [("rest", "at rest"), ("importance", "importance"), ("classic", "Eq. 1 alone"), ("ours", "ours")];

/// Asked against achieved: the region that misses its size most.
pub(super) struct Worst<'a> {
    pub name: &'a str,
    pub asked: f64,
    pub achieved: f64,
    /// What the two are: a size factor, or pixels of area.
    pub is_area: bool,
}

impl Worst<'_> {
    /// How far off, as a part of what was asked; negative where it stayed too small.
    pub fn error(&self) -> f64 {
        self.achieved / self.asked - 1.0
    }
}

impl Found {
    /// Warps a scene at its own resolution and takes its pictures.
    ///
    /// # Errors
    /// What the engine or the driver refuses.
    pub fn of(entry: &Entry, photographer: &mut Photographer) -> Result<Self> {
        let scene = Scene::new(Draft::fresh(&Source::Gallery(entry.name.into())))?;
        let subject = subject::find(&scene.source)?.open(&scene)?;
        let start = Instant::now();
        let domain = Domain { content: subject.content(), settings: scene.settings() };
        let solved = run::solve(domain, &progress::watcher(true))?;
        let seconds = start.elapsed().as_secs_f64();

        let report = subject::report(&*subject, &scene, &scene.settings(), &Grown::from(&solved), Vec::new());
        let importance = Some(Arc::new(subject.asked(&solved.outcome)));
        let coloured = Looks { mode: Mode::Importance, importance, ..Looks::default() };
        let legend = coloured.legend().ok_or_else(|| Error::Fault("importance has no legend".into()))?;
        let pictures = match subject.portraits(&solved, SIDE, &|value| colour(&legend, value)) {
            Some(pictures) => pictures?,
            None => photographer.portraits(entry, solved, coloured)?,
        };
        Ok(Self { pictures, legend, report, seconds })
    }

    /// Crossings that Eq. 1 alone has.
    pub fn classic_crossings(&self) -> usize {
        self.report.classic.as_ref().map_or(0, |classic| classic.crossings)
    }

    /// Inverted elements that Eq. 1 alone has.
    pub fn classic_inverted(&self) -> usize {
        self.report.classic.as_ref().map_or(0, |classic| classic.inverted)
    }

    /// Crossings and inverted elements of the certified growth, in all frames: the most in one.
    pub fn faults(&self) -> usize {
        let certificate = &self.report.certificate;
        certificate.inverted + certificate.crossings + certificate.surface_crossings + certificate.enclosed
    }

    /// The region that misses most; nothing where there are no regions.
    pub fn worst(&self) -> Option<Worst<'_>> {
        if let Some(areas) = &self.report.areas {
            let name = &areas.worst.as_ref()?.name;
            let area = areas.regions.iter().find(|area| area.name == *name)?;
            return Some(Worst { name, asked: area.asked, achieved: area.achieved, is_area: true });
        }
        let regions = self.report.fidelity.regions.iter();
        let all = regions.map(|r| Worst { name: &r.name, asked: r.asked, achieved: r.achieved, is_area: false });
        all.max_by(|a, b| a.error().abs().total_cmp(&b.error().abs()))
    }
}

impl Exhibit {
    /// Whether it is what the gallery promises: certified in every frame.
    pub fn is_certified(&self) -> bool {
        self.found.as_ref().is_ok_and(|found| found.report.certified())
    }

    /// One line for who waits.
    pub fn line(&self) -> String {
        match &self.found {
            Ok(found) => format!(
                "{}: {}; Eq. 1 alone {} crossings, here {}; {}size error p95 {:.1} %; {:.1} s",
                self.entry.name,
                if found.report.certified() { "certified" } else { "NOT CERTIFIED" },
                found.classic_crossings(),
                found.faults(),
                found
                    .worst()
                    .map_or_else(String::new, |w| format!("worst region {:.1} % off, ", 100.0 * w.error().abs())),
                100.0 * found.report.fidelity.p95,
                found.seconds,
            ),
            Err(why) => format!("{}: FAILED: {why}", self.entry.name),
        }
    }
}

/// The colour that a legend gives a value; its stops are evenly spaced in the logarithm.
fn colour(legend: &Legend, value: f32) -> [u8; 3] {
    let at = legend.stops.partition_point(|(stop, _)| *stop < value);
    legend.stops.get(at).or(legend.stops.last()).map_or([0; 3], |(_, colour)| *colour)
}

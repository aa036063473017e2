//! Who runs the schedule: from a domain to what came of it.
//!
//! [`solve()`] runs one domain to its end; a [`Run`] goes on an iteration at a time and takes other importance, as a window
//! needs it; [`HomunculusPlugins`] are for a Bevy app of one's own, in which any number of domains are solved side by side.
//!
//! ```
//! use std::sync::Arc;
//!
//! use bevy::prelude::*;
//! use homunculus::{gallery, prelude::*};
//!
//! # fn main() -> Result<(), Error> {
//! let hand = gallery::open("hand")?;
//! let importance = Stack::of_vertices(&hand.importance, Vec::new(), 0);
//! let settings = Settings { resolution: 16, ..Settings::default() };
//! let domain = Domain::body(Arc::new(hand.model.boundary), Arc::new(importance), settings);
//!
//! let mut app = App::new();
//! app.add_plugins((MinimalPlugins, HomunculusPlugins));
//! let domain = domain.spawn(app.world_mut());
//! while !app.world().get::<Growing>(domain).is_some_and(|growing| growing.0.done()) {
//!     app.update();
//! }
//! // Components hold what the stages have made: the lattice, V', V'', the film of certified states.
//! let Reel(film) = app.world().get(domain).expect("a film");
//! assert!(film.keyframes().iter().all(|keyframe| keyframe.certificate.certified()));
//! # Ok(())
//! # }
//! ```

mod domain;
mod inspect;
mod outcome;
mod progress;

pub use domain::{Content, Domain};
pub use inspect::{inspect, inspect_picture};
pub use outcome::{Counts, DomainSummary, Frame, InputSummary, Outcome, Solved, domain_summary};
pub use progress::{Observer, Progress};

use std::sync::Arc;

use bevy::{app::PluginGroupBuilder, prelude::*};

use crate::{
    Error, Result,
    boundary::Boundary,
    certificate::{Surfaces, plugin::CertificatePlugin},
    collision::plugin::{CollisionPlugin, Growing, Start},
    diagnostics::Stopwatch,
    edge::plugin::{EdgePlugin, LinearSolution},
    film::plugin::{FilmPlugin, Reel},
    importance::{
        Stack,
        plugin::{Importance, ImportancePlugin},
    },
    reference::plugin::ReferencePlugin,
    schedule::{Failed, Interactive, Solve, SolveSchedulePlugin, Stage, Until},
    settings::{Reference, Settings},
    transfer::plugin::{Bound, TransferPlugin},
    voxel::plugin::{DomainBoundary, Lattice, VoxelPlugin},
};

/// The stages of the method, each a plugin of its own that can be left out or replaced.
///
/// They add the schedule [`Solve`] to an app. Running it is left to the app: once a frame, in slices, or on another thread.
pub struct SolvePlugins;

impl PluginGroup for SolvePlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(SolveSchedulePlugin)
            .add(VoxelPlugin)
            .add(TransferPlugin)
            .add(ImportancePlugin)
            .add(EdgePlugin)
            .add(CertificatePlugin)
            .add(CollisionPlugin::default())
            .add(FilmPlugin)
    }
}

/// [`SolvePlugins`], and all domains go one iteration further in each [`Update`].
pub struct HomunculusPlugins;

impl PluginGroup for HomunculusPlugins {
    fn build(self) -> PluginGroupBuilder {
        SolvePlugins.build().add(SolveInUpdate)
    }
}

struct SolveInUpdate;

impl Plugin for SolveInUpdate {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, |world: &mut World| rayon::scope(|_| world.run_schedule(Solve)));
    }
}

/// An app with the stages of the method, or of a reference solver in their place.
pub fn solver(reference: Option<Reference>) -> App {
    let mut app = App::new();
    match reference {
        None => app.add_plugins(SolvePlugins),
        Some(reference) => {
            let stages = SolvePlugins.build().disable::<CollisionPlugin>().disable::<FilmPlugin>();
            app.add_plugins(stages.add(ReferencePlugin(reference)))
        }
    };
    app.finish();
    app.cleanup();
    app
}

/// Warps a domain: runs [`Solve`] until λ = 1 has settled, and hands out the film with the states of the nodes.
///
/// # Errors
/// [`Error::Cancelled`] when the observer says so; [`Error::Input`] for a boundary without extent or a resolution out
/// of range.
pub fn solve(domain: Domain, observer: &dyn Observer) -> Result<Solved> {
    let mut run = Run::new(domain)?;
    loop {
        observer.progress(&run.progress());
        if observer.cancelled() {
            return Err(Error::Cancelled);
        }
        if run.step()? {
            return run.solved();
        }
    }
}

/// Warps a body: as [`solve()`], without the states of the nodes.
///
/// # Errors
/// As [`solve()`].
pub fn warp(boundary: &Boundary, importance: &Stack, settings: &Settings, observer: &dyn Observer) -> Result<Outcome> {
    let domain = Domain::body(Arc::new(boundary.clone()), Arc::new(importance.clone()), settings.clone());
    solve(domain, observer).map(|solved| solved.outcome)
}

/// One domain on its way, an iteration at a time.
pub struct Run {
    app: App,
    entity: Entity,
}

impl Run {
    /// A domain of which nothing is known yet.
    ///
    /// # Errors
    /// A resolution out of range.
    pub fn new(domain: Domain) -> Result<Self> {
        domain.check()?;
        let mut app = solver(domain.settings.reference);
        let entity = domain.spawn(app.world_mut());
        Ok(Self { app, entity })
    }

    /// One that will be asked for something else: what its stages prepare is kept.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn interactive(domain: Domain) -> Result<Self> {
        let mut run = Self::new(domain)?;
        run.app.world_mut().entity_mut(run.entity).insert(Interactive);
        Ok(run)
    }

    /// Runs [`Solve`] once. Whether λ = 1 has settled.
    ///
    /// # Errors
    /// What a stage refuses.
    pub fn step(&mut self) -> Result<bool> {
        self.step_until(Stage::Certify)?;
        Ok(self.get::<Growing>().is_some_and(|growing| growing.0.done()))
    }

    /// Runs the stages up to one: as far as [`Stage::EdgeSolve`] for the linear solution alone.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step_until(&mut self, last: Stage) -> Result<()> {
        let world = self.app.world_mut();
        world.insert_resource(Until(last));
        // Within rayon's pool: from outside, each of the many small loops would wait for another thread to wake.
        rayon::scope(|_| world.run_schedule(Solve));
        match world.entity_mut(self.entity).take::<Failed>() {
            Some(Failed(error)) => Err(error),
            None => Ok(()),
        }
    }

    /// Where it is; the stage named is the one about to run.
    pub fn progress(&self) -> Progress {
        progress::progress(self.app.world(), self.entity)
    }

    /// A component of the domain.
    pub fn get<C: Component>(&self) -> Option<&C> {
        self.app.world().get(self.entity)
    }

    /// Seconds per stage so far.
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        self.app.world().resource::<Stopwatch>().seconds()
    }

    /// Asks the same lattice for something else. Growth begins again where `start` says.
    pub fn ask(&mut self, content: Content, start: Start) {
        let entity = self.entity;
        content.insert(&mut self.app.world_mut().entity_mut(entity));
        self.begin(start);
    }

    /// Takes other settings but for the resolution. Growth begins again where `start` says.
    pub fn set(&mut self, settings: Settings, start: Start) {
        self.app.world_mut().entity_mut(self.entity).insert(settings);
        self.begin(start);
    }

    /// Begins to grow again.
    pub fn begin(&mut self, start: Start) {
        self.app.world_mut().entity_mut(self.entity).insert(start);
        if start == Start::Rest {
            *self.app.world_mut().resource_mut::<Stopwatch>() = Stopwatch::default();
        }
    }

    /// What came of it, once a [`step`](Self::step) has said that all is done. The film is mended.
    ///
    /// # Errors
    /// A fault, if it is not done.
    pub fn outcome(&mut self) -> Result<Outcome> {
        let (world, entity) = (self.app.world_mut(), self.entity);
        rayon::scope(|_| outcome::outcome(world, entity)).ok_or_else(unfinished)
    }

    /// The same with the states of the nodes.
    ///
    /// # Errors
    /// As [`outcome`](Self::outcome).
    pub fn solved(mut self) -> Result<Solved> {
        let outcome = self.outcome()?;
        let mut domain = self.app.world_mut().entity_mut(self.entity);
        let parts = (|| {
            let (DomainBoundary(boundary), Lattice(complex), Bound(binding)) = domain.take()?;
            let (surfaces, Reel(film)) = domain.take::<(Surfaces, Reel)>()?;
            let (LinearSolution(linear), Importance { nodes: importance, .. }) = domain.take()?;
            Some(Solved { boundary, complex, binding, surfaces, film, linear, importance, outcome })
        })();
        parts.ok_or_else(unfinished)
    }
}

fn unfinished() -> Error {
    Error::Fault("a solved domain lacks a component".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_systems_of_the_schedule_are_ambiguous() {
        for reference in [None, Some(Reference::Eq1), Some(Reference::Fig5)] {
            let mut app = solver(reference);
            app.world_mut().schedule_scope(Solve, |world, schedule| {
                schedule.initialize(world).expect("buildable");
                assert_eq!(schedule.graph().conflicting_systems().len(), 0, "{reference:?}");
            });
        }
    }
}

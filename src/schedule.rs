//! THE order of the method: one schedule and its stages, in words.
//!
//! ```text
//! Voxelize → Bind → Importance → EdgeSolve → Enclose → Reset → [ Grow → Local → Contact → Global → Guard → Certify ]*
//! ```
//!
//! A domain is an entity. Stages give it components (arrays over nodes, cells and edges of its lattice), and each run of
//! [`Solve`] takes it one iteration further. A stage does something where its input has changed since it ran last, so what
//! is set anew (importance, settings) sets off what depends on it and nothing else.
//!
//! Each stage is a plugin that can be replaced alone. Plugins know these words, and not who runs the schedule.

use bevy::{
    ecs::schedule::{LogLevel, ScheduleBuildSettings, ScheduleLabel, SingleThreadedExecutor},
    prelude::*,
};

use crate::{Error, Result, diagnostics::Stopwatch};

/// The schedule that takes every domain one iteration further.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
pub struct Solve;

/// Its stages, in this order.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// 3.2: boundary to lattice.
    Voxelize,
    /// 3.5: barycentric coordinates of the boundary, once.
    Bind,
    /// 3.2: importance onto nodes and edges.
    Importance,
    /// 3.3: Eq. 1.
    EdgeSolve,
    /// Which surfaces must not cross, and what of them crosses in the input.
    Enclose,
    /// From where growth begins when something else is asked for.
    Reset,
    /// 3.3: the next λ.
    Grow,
    /// 3.3: targets of the cells.
    Local,
    /// 3.3: pairs that are too close.
    Contact,
    /// 3.3: Eq. 2's linear solve.
    Global,
    /// What of the step stays injective.
    Guard,
    /// Keyframes and their certificates.
    Certify,
}

impl Stage {
    /// All of them, in their order.
    pub const ALL: [Self; 12] = [
        Self::Voxelize,
        Self::Bind,
        Self::Importance,
        Self::EdgeSolve,
        Self::Enclose,
        Self::Reset,
        Self::Grow,
        Self::Local,
        Self::Contact,
        Self::Global,
        Self::Guard,
        Self::Certify,
    ];
}

/// The last stage that runs: what comes after it waits, and finds all that has changed meanwhile when it runs again.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq)]
pub struct Until(pub Stage);

impl Default for Until {
    fn default() -> Self {
        Self(Stage::Certify)
    }
}

/// Marks domains that will be asked for something else: what stages have prepared for their lattice is kept for that.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct Interactive;

/// Why a domain is not solved any further. Other domains go on.
#[derive(Component, Debug)]
pub struct Failed(pub Error);

/// What a stage refuses, by domain.
#[derive(Debug, Default)]
pub struct Refused(Vec<(Entity, Error)>);

/// What a system that may refuse a domain returns; piped into [`note_failures`].
pub type StageResult = Result<(), Refused>;

impl Refused {
    /// The value, or `None` and a refusal of the domain.
    pub fn note<T>(&mut self, domain: Entity, result: Result<T>) -> Option<T> {
        result.map_err(|error| self.0.push((domain, error))).ok()
    }

    /// An error if there was any refusal.
    ///
    /// # Errors
    /// The refusals.
    pub fn into_result(self) -> StageResult {
        if self.0.is_empty() { Ok(()) } else { Err(self) }
    }
}

/// Marks the domains that a stage has refused as [`Failed`].
pub fn note_failures(In(result): In<StageResult>, mut commands: Commands) {
    for (domain, error) in result.err().into_iter().flat_map(|refused| refused.0) {
        commands.entity(domain).insert(Failed(error));
    }
}

/// Declares [`Solve`] and its order.
pub struct SolveSchedulePlugin;

impl Plugin for SolveSchedulePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Stopwatch>().init_resource::<Until>().init_schedule(Solve).edit_schedule(
            Solve,
            |schedule| {
                schedule
                    // Stages are parallel inside (rayon), one after the other outside.
                    .set_executor(SingleThreadedExecutor::new())
                    .set_build_settings(ScheduleBuildSettings { ambiguity_detection: LogLevel::Error, ..default() });
                for pair in Stage::ALL.windows(2) {
                    schedule.configure_sets(pair[0].before(pair[1]));
                }
                for stage in Stage::ALL {
                    schedule.configure_sets(stage.run_if(move |until: Res<Until>| stage <= until.0));
                }
            },
        );
    }
}

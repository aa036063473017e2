//! What most programs that use the engine need: `use homunculus::prelude::*;`.

pub use crate::{
    Error,
    boundary::{self, Boundary, Regions},
    certificate::{Certificate, Distortion, Fidelity, Surfaces},
    collision::plugin::{Growing, Start, Warped},
    edge::plugin::LinearSolution,
    film::{Film, Keyframe, plugin::Reel},
    importance::{Layer, Stack},
    run::{Content, Domain, Frame, HomunculusPlugins, Observer, Outcome, Progress, Run, SolvePlugins, Solved, solve},
    schedule::{Failed, Interactive, Solve, Stage},
    settings::{Reference, Settings},
    transfer::plugin::Bound,
    voxel::plugin::{DomainBoundary, Lattice},
    warp::Warp,
};

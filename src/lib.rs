//! `homunculus`: warp a body or a picture until local size is proportional to importance, and prove that it neither
//! folds nor passes through itself.
//!
//! An implementation of *Homunculus Warping: Conveying importance using self-intersection-free non-homogeneous mesh
//! deformation* (Reinert, Ritschel, Seidel 2012). The folders are the paper's sections, the names its symbols.
//!
//! In three lines: see [`warp`]. As plugins of a Bevy app: see [`run`].
//!
//! # The method on one page
//!
//! | symbol | what | here |
//! |---|---|---|
//! | B, B' | boundary, warped boundary | [`boundary::Boundary`], [`run::Frame::positions`] |
//! | C = (V, E), C_t = (V, T) | nodes, edges, tetrahedra of the voxelized inside; lattice of cell size h |
//! [`voxel::Complex`] |
//! | F, f | importance: linear size factor asked for, > 0 | [`importance::Stack`], [`importance::plugin::Importance`] |
//! | V' | linear solution (Eq. 1) | [`edge::plugin::LinearSolution`] |
//! | λ | growth, 0 = rest, 1 = all of it | [`collision::Growth`] |
//! | V'' | warped nodes (Eq. 2) | [`collision::plugin::Warped`] |
//! | r_i | contact radius | [`collision::Asked::radius`] |
//! | μ | fidelity: 0 keeps shape, 1 reaches the asked size | [`settings::Settings::fidelity`] |
//! | α β γ δ | barycentric weights of a boundary vertex | [`transfer::Binding`] |
//!
//! | stage | section | in | out |
//! |---|---|---|---|
//! | [`voxel`] | 3.2 | B, resolution | C, C_t |
//! | [`importance`] | 3.2 | layers over the surface | f of nodes and cells |
//! | [`edge`] | 3.3, Eq. 1 | C, f | V' |
//! | [`collision`] | 3.3, Eq. 2 | C, f, μ | V'' for λ from 0 to 1, never across |
//! | [`certificate`] | – | a state | counts of inverted elements and crossings, exact |
//! | [`film`] | – | certified states | what is played, exported, recorded |
//! | [`transfer`] | 3.5 | B, V'' | B' |
//!
//! Around it, [`subject`] is the one road from a source to its files for bodies and pictures alike, and
//! [`mod@format`] the one table of kinds of files.
//!
//! [`mod@reference`] keeps the paper's own scheme to compare with; [`schedule`] declares the order once, [`run`] runs it.
//!
//! # What is promised, and what carries it
//!
//! - A state is *certified* when every element is positively oriented, no two faces of the complex's skin cross, no
//!   body lies within another, and the surface that is written has no crossing the input had not. Signs are exact;
//!   touching counts as crossing. Blends between two keyframes are proven to be valid at every instant (see
//!   [`certificate`]).
//! - The collision optimization starts at rest, which is valid, and its [guard](collision::guard) lets a step through
//!   only where the next state is valid too.
//! - The same input gives the same bits for any number of threads: loops gather, sums go in fixed chunks.
//!
//! # Order of the folders
//!
//! From the bottom up: each folder uses only those before it. `tests/order.rs` reads this list and holds the sources against
//! it.
//!
//! ```text
//! error diagnostics file format settings schedule
//! boundary voxel multigrid transfer picture importance edge certificate collision film reference run
//! gallery paint scene export warp prelude subject session
//! view record panel app
//! ```
//!
//! # Layers
//!
//! Numerics are plain functions over slices. Each stage's `plugin` module is the thin Bevy layer: components that hold
//! arrays over nodes, cells and edges of a domain entity, and short systems in the [`schedule::Solve`] schedule.

#[cfg(feature = "cli")]
pub mod app;
pub mod boundary;
pub mod certificate;
pub mod collision;
pub mod diagnostics;
pub mod edge;
pub mod error;
pub mod export;
pub mod file;
pub mod film;
pub mod format;
pub mod gallery;
pub mod importance;
pub mod multigrid;
pub mod paint;
#[cfg(feature = "window")]
pub mod panel;
pub mod picture;
pub mod prelude;
#[cfg(feature = "record")]
pub mod record;
pub mod reference;
pub mod run;
pub mod scene;
pub mod schedule;
pub mod session;
pub mod settings;
pub mod subject;
pub mod transfer;
#[cfg(feature = "render")]
pub mod view;
pub mod voxel;
pub mod warp;

pub use error::{Error, Result};

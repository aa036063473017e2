//! The engine in three lines: arrays in, arrays and a certificate out.
//!
//! ```
//! use homunculus::prelude::*;
//!
//! # fn main() -> Result<(), Error> {
//! let corner = |k: usize| [(k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2 & 1) as f64];
//! let vertices: Vec<[f64; 3]> = (0..8).map(corner).collect();
//! let triangles = [
//!     [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
//!     [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
//! ];
//! // The side at x = 1 twice as large as the other.
//! let importance: Vec<f32> = vertices.iter().map(|v| 1.0 + v[0] as f32).collect();
//!
//! let grown = Warp::new(&vertices, triangles).importance(&importance).resolution(12).run()?;
//!
//! assert!(grown.certified());
//! let side = |a: usize, b: usize| (grown.positions()[a] - grown.positions()[b]).length();
//! assert!(side(1, 3) > 1.3 * side(0, 2));
//! println!("size error p95 {:.1} %", 100.0 * grown.outcome.fidelity.p95);
//! # Ok(())
//! # }
//! ```

use std::sync::Arc;

use glam::DVec3;

use crate::{
    Error, Result,
    boundary::Boundary,
    importance::Stack,
    run::{Domain, Observer, Solved, solve},
    settings::Settings,
};

/// What to warp and how, said piece by piece; [`run`](Self::run) does it.
#[derive(Debug, Clone)]
pub struct Warp {
    boundary: Boundary,
    importance: Asked,
    settings: Settings,
}

/// How importance was said.
#[derive(Debug, Clone)]
enum Asked {
    /// `[vertices]`.
    Vertices(Vec<f32>),
    /// By layers, or nothing.
    Layers(Stack),
}

impl Warp {
    /// Warps a surface of triangles; any soup of them will do, closed or not.
    ///
    /// `vertices`: `[vertices]` places, in any unit, as `[f64; 3]`, `DVec3` or the like. `triangles`: `[triangles]` corners.
    pub fn new<P: Copy + Into<DVec3>>(vertices: impl AsRef<[P]>, triangles: impl AsRef<[[u32; 3]]>) -> Self {
        let positions = vertices.as_ref().iter().map(|&p| p.into()).collect();
        Self::of(Boundary::from_triangles("the surface", positions, triangles.as_ref().to_vec()))
    }

    /// Warps a surface that [`boundary::read`](crate::boundary::read) has read.
    pub fn of(boundary: Boundary) -> Self {
        Self { boundary, importance: Asked::Layers(Stack::default()), settings: Settings::default() }
    }

    /// `[vertices]` importance: the linear size factor asked for, > 0; 1 keeps, 2 is twice as long.
    #[must_use]
    pub fn importance(mut self, importance: impl AsRef<[f32]>) -> Self {
        self.importance = Asked::Vertices(importance.as_ref().to_vec());
        self
    }

    /// Importance as [layers](crate::importance::Layer) that were loaded for this surface.
    #[must_use]
    pub fn layers(mut self, importance: Stack) -> Self {
        self.importance = Asked::Layers(importance);
        self
    }

    /// Cells along the longest axis, 8..=256. 64 where it is not said.
    #[must_use]
    pub fn resolution(mut self, cells: u32) -> Self {
        self.settings.resolution = cells;
        self
    }

    /// μ in 0..=1: 0 keeps shape, 1 reaches the size asked for. 0.5 where it is not said.
    #[must_use]
    pub fn fidelity(mut self, mu: f32) -> Self {
        self.settings.fidelity = mu;
        self
    }

    /// Keyframes of the growth after the rest shape, ≥ 1; there are more where a blend between two would not be valid. 8
    /// where it is not said.
    #[must_use]
    pub fn keys(mut self, keys: usize) -> Self {
        self.settings.keys = keys;
        self
    }

    /// Warps.
    ///
    /// # Errors
    /// [`Error::Input`], one sentence: a triangle without its vertices, a place that is not finite, importance that is not
    /// greater than 0 or not one for each vertex, settings out of range, a surface without extent.
    pub fn run(self) -> Result<Solved> {
        self.run_watched(&())
    }

    /// The same with an observer that sees how far it is and may stop it.
    ///
    /// # Errors
    /// As [`run`](Self::run), and [`Error::Cancelled`] when the observer says so.
    pub fn run_watched(self, observer: &dyn Observer) -> Result<Solved> {
        let Self { boundary, importance, settings } = self;
        check(&boundary)?;
        settings.check()?;
        let importance = match importance {
            Asked::Layers(stack) => stack,
            Asked::Vertices(values) => {
                check_importance(&values, boundary.positions.len())?;
                Stack::of_vertices(&values, Vec::new(), 0)
            }
        };
        solve(Domain::body(Arc::new(boundary), Arc::new(importance), settings), observer)
    }
}

fn check(boundary: &Boundary) -> Result<()> {
    let vertices = boundary.positions.len();
    if let Some(vertex) = boundary.positions.iter().position(|p| !p.is_finite()) {
        return Err(Error::input(format!("vertex {vertex} is not finite; leave it out or correct it")));
    }
    let beyond = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= vertices);
    match boundary.triangles.iter().position(beyond) {
        Some(triangle) => {
            let corners = boundary.triangles[triangle];
            let sentence =
                format!("triangle {triangle} has the corners {corners:?}, but there are {vertices} vertices");
            Err(Error::input(sentence))
        }
        None if boundary.triangles.is_empty() => Err(Error::input("there is no triangle to warp")),
        None => Ok(()),
    }
}

fn check_importance(values: &[f32], vertices: usize) -> Result<()> {
    if values.len() != vertices {
        let sentence =
            format!("there are {} values of importance for {vertices} vertices; give one each", values.len());
        return Err(Error::input(sentence));
    }
    match values.iter().position(|f| !(*f > 0.0 && f.is_finite())) {
        Some(vertex) => {
            let value = values[vertex];
            Err(Error::input(format!("importance {value} of vertex {vertex} is not greater than 0 and finite")))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(warp: Warp) -> String {
        warp.run().expect_err("refused").to_string()
    }

    #[test]
    fn what_cannot_be_warped_is_refused_in_one_sentence() {
        let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let warp = |triangles: &[[u32; 3]]| Warp::new(vertices, triangles).resolution(8);
        assert!(refusal(warp(&[[0, 1, 3]])).contains("triangle 0 has the corners [0, 1, 3]"));
        assert!(refusal(warp(&[])).contains("no triangle"));
        assert!(refusal(warp(&[[0, 1, 2]]).importance([1.0])).contains("1 values of importance for 3 vertices"));
        assert!(refusal(warp(&[[0, 1, 2]]).importance([1.0, 0.0, 1.0])).contains("importance 0 of vertex 1"));
        assert!(refusal(warp(&[[0, 1, 2]]).resolution(7)).contains("resolution 7"));
        assert!(refusal(warp(&[[0, 1, 2]]).fidelity(1.5)).contains("fidelity 1.5"));
        assert!(refusal(warp(&[[0, 1, 2]]).keys(0)).contains("keys 0"));
        let nowhere = [[f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert!(refusal(Warp::new(nowhere, [[0, 1, 2]])).contains("vertex 0 is not finite"));
        // Sabotage: nothing of this is refused where all is well.
        assert!(warp(&[[0, 1, 2]]).importance([1.0, 1.5, 1.0]).run().expect("a grown triangle").certified());
    }
}

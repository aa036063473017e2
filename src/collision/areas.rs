//! Areas of regions: what is asked of cells, corrected until regions have their size.
//!
//! A cell that lies in two regions has one size, and cells on a shared border give way to each other: the mean size of
//! cells may be right while a small region is several percent off. So at λ = 1 what a region asks for is multiplied by
//! `asked area / achieved area` every few iterations, until areas agree (cartogram methods repeat their flow for the same
//! reason, Gastner, Seguy and More 2018).

use bevy::prelude::Component;
use glam::{DVec2, DVec3, Vec3A};
use rayon::prelude::*;

use crate::{
    boundary::Boundary,
    picture::pieces,
    voxel::{Flat, Shares},
};

/// Iterations between two corrections: enough for the last one to be felt.
const PERIOD: u32 = 12;

/// Corrections at most.
const ROUNDS: u32 = 24;

/// No correction where the worst region is nearer to its area than this.
const GOOD_ENOUGH: f64 = 0.004;

/// Root mean square error from which on a flow leads a correction; below, it would only shake what is nearly there.
const FAR_OFF: f64 = 0.02;

/// A region's factor stays within this range and its inverse, of maps and of pictures with single parts that grow: what
/// cannot be reached is not asked for ever louder.
const MOST: [f64; 2] = [4.0, 2.0];

/// Corrections without a new best state after which it ends.
const PATIENCE: u32 = 6;

/// A state counts as a new best one if its error is less than this part of the last one's.
const BETTER: f64 = 0.98;

/// No region asks for more or less than this many times the area at once: a state that is still on its way would be asked
/// for what it is about to reach anyway.
const MOST_AT_ONCE: f64 = 1.15;

/// Regions smaller than this many cells are not corrected: they have no cell of their own to grow by, and would drive
/// their neighbours off.
pub const LEAST_CELLS: f64 = 2.0;

/// A region's areas, in pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Areas {
    /// At rest.
    pub rest: f64,
    /// Asked for.
    pub asked: f64,
    /// In the state looked at.
    pub achieved: f64,
}

/// What regions have of the triangles that a picture is drawn on: borders run through triangles as they do through cells.
#[derive(Debug, Clone, Default)]
pub struct Pieces {
    /// `[triangles + 1]` compressed rows.
    start: Vec<u32>,
    /// Region, and the part of the triangle's area it has.
    list: Vec<(u32, f32)>,
    /// `[regions]`, `achieved` left open.
    areas: Vec<Areas>,
}

impl Pieces {
    /// Cuts the triangles of a picture's flat mesh by pixels.
    pub fn new(picture: &Flat, mesh: &Boundary) -> Self {
        let Some(regions) = &picture.regions else { return Self::default() };
        let mut areas = vec![Areas::default(); regions.names.len()];
        let height = f64::from(picture.size.y);
        let of_triangle: Vec<Vec<(u32, f64, f64)>> = mesh
            .triangles
            .par_iter()
            .with_min_len(1024)
            .map(|triangle| {
                let at = triangle.map(|v| mesh.positions[v as usize]).map(|p| DVec2::new(p.x, height - p.y));
                let mut shares: Vec<(u32, f64, f64)> = Vec::new();
                pieces(at, picture.size, |pixel, area| {
                    let region = regions.of_vertex[pixel];
                    if region == u32::MAX || !picture.inside[pixel] {
                        return;
                    }
                    let asked = area * f64::from(picture.importance[pixel]).powi(2);
                    match shares.iter_mut().find(|s| s.0 == region) {
                        Some(share) => (share.1, share.2) = (share.1 + area, share.2 + asked),
                        None => shares.push((region, area, asked)),
                    }
                });
                shares
            })
            .collect();
        let (mut start, mut list) = (vec![0], Vec::new());
        for (triangle, shares) in mesh.triangles.iter().zip(of_triangle) {
            let whole = doubled_area(triangle.map(|v| mesh.positions[v as usize])) / 2.0;
            for (region, area, asked) in shares {
                areas[region as usize].rest += area;
                areas[region as usize].asked += asked;
                list.push((region, (area / whole) as f32));
            }
            start.push(list.len() as u32);
        }
        Self { start, list, areas }
    }

    /// `[regions]` areas with the mesh's vertices at these places, source units.
    pub fn areas(&self, mesh: &Boundary, places: &[DVec3]) -> Vec<Areas> {
        let mut areas = self.areas.clone();
        for (t, triangle) in mesh.triangles.iter().enumerate().take(self.start.len().saturating_sub(1)) {
            let shares = &self.list[self.start[t] as usize..self.start[t + 1] as usize];
            if shares.is_empty() {
                continue;
            }
            let whole = doubled_area(triangle.map(|v| places[v as usize])) / 2.0;
            for &(region, part) in shares {
                areas[region as usize].achieved += f64::from(part) * whole;
            }
        }
        areas
    }
}

/// Twice the area of a triangle of the plane.
fn doubled_area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).truncate().perp_dot((c - a).truncate())
}

/// The correction of one domain.
#[derive(Component, Debug, Clone)]
pub struct AreaCorrection {
    pieces: Pieces,
    /// `[regions]` what each asks for is multiplied by this, as area.
    factors: Vec<f32>,
    /// Their range.
    most: f64,
    rounds: u32,
    best: Option<Best>,
    finished: bool,
}

/// The best state so far.
#[derive(Debug, Clone)]
struct Best {
    round: u32,
    /// Root mean square over regions.
    error: f64,
    nodes: Vec<Vec3A>,
    factors: Vec<f32>,
}

/// What a correction came to.
#[derive(Debug)]
pub enum Corrected {
    /// `[cells]` importance to ask for from now on, and whether areas are so far off that a flow should lead there.
    Ask(Vec<f32>, bool),
    /// Areas were right from the first.
    Right,
    /// They are right now, or will not become better.
    Ended,
    /// They were best in an earlier state: its `[nodes]`, and the `[cells]` importance it was asked for.
    Return(Vec<Vec3A>, Vec<f32>),
}

impl AreaCorrection {
    /// For a picture and the mesh it is drawn on.
    pub fn new(picture: &Flat, mesh: &Boundary) -> Self {
        let pieces = Pieces::new(picture, mesh);
        let most = MOST[usize::from(!picture.is_map())];
        Self { factors: vec![1.0; pieces.areas.len()], pieces, most, rounds: 0, best: None, finished: false }
    }

    /// What regions have of the mesh's triangles.
    pub fn pieces(&self) -> &Pieces {
        &self.pieces
    }

    /// Whether it is time for a correction at this iteration of λ = 1, or the state would be kept.
    pub fn is_due(&self, iteration: u32, settled: bool) -> bool {
        !self.finished && (settled || iteration.is_multiple_of(PERIOD))
    }

    /// Corrects what regions ask for, until areas are right or do not become better.
    ///
    /// `nodes`: the present state; `places`: where the mesh's vertices are in it, source units; `cell`: the area of a cell
    /// in pixels.
    pub fn correct(
        &mut self,
        shares: &Shares,
        mesh: &Boundary,
        (nodes, places): (&[Vec3A], &[DVec3]),
        cell: f64,
    ) -> Corrected {
        let areas = self.pieces.areas(mesh, places);
        let is_resolved = |a: &Areas| a.rest >= LEAST_CELLS * cell && a.asked > 0.0;
        let off: Vec<f64> =
            areas.iter().filter(|a| is_resolved(a)).map(|a| (a.achieved / a.asked - 1.0).abs()).collect();
        let error = (off.iter().map(|e| e * e).sum::<f64>() / off.len().max(1) as f64).sqrt();
        if off.iter().all(|&e| e < GOOD_ENOUGH) {
            self.finished = true;
            return if self.rounds == 0 { Corrected::Right } else { Corrected::Ended };
        }
        if self.best.as_ref().is_none_or(|best| error < BETTER * best.error) {
            let (nodes, factors) = (nodes.to_vec(), self.factors.clone());
            self.best = Some(Best { round: self.rounds, error, nodes, factors });
        }
        let since = self.best.as_ref().map_or(0, |best| self.rounds - best.round);
        if since >= PATIENCE || self.rounds >= ROUNDS {
            self.finished = true;
            return match self.best.take().filter(|best| best.error < error) {
                Some(best) => Corrected::Return(best.nodes, shares.sizes(&best.factors)),
                None => Corrected::Ended,
            };
        }
        self.rounds += 1;
        for (factor, a) in self.factors.iter_mut().zip(&areas).filter(|(_, a)| is_resolved(a)) {
            let change = (a.asked / a.achieved.max(f64::MIN_POSITIVE)).clamp(1.0 / MOST_AT_ONCE, MOST_AT_ONCE);
            *factor = (f64::from(*factor) * change).clamp(1.0 / self.most, self.most) as f32;
        }
        Corrected::Ask(shares.sizes(&self.factors), error > FAR_OFF)
    }
}

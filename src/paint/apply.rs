//! Edits as functions on ln f at vertices. Every loop gathers: the same bits for any number of threads.

use glam::DVec3;
use rayon::prelude::*;

use super::{Action, Axis, Brush, Canvas, Dab, Edit, Fill};
use crate::importance::{CLAMP_MAX, CLAMP_MIN};

/// Vertices per parallel task.
const VERTICES_PER_TASK: usize = 4096;

/// Values below this weight are left alone: f would not change in its last bit.
const LEAST_WEIGHT: f64 = 1.0e-9;

/// A stroke that is being made.
#[derive(Debug, Clone)]
pub(super) struct Live {
    pub brush: Brush,
    pub dabs: Vec<Dab>,
    /// `[vertices]` ln f before the stroke.
    pub before: Vec<f64>,
    /// `[vertices]` greatest weight of the dabs so far.
    reach: Vec<f64>,
}

impl Live {
    /// Begins over `[vertices]` ln f.
    pub fn new(brush: Brush, ln: &[f64]) -> Self {
        Self { brush, dabs: Vec::new(), before: ln.to_vec(), reach: vec![0.0; ln.len()] }
    }

    /// Adds a dab. `under` is what the layers say.
    pub fn dab(&mut self, canvas: &Canvas, under: &[f64], ln: &mut [f64], dab: Dab) {
        self.dabs.push(dab);
        let images = canvas.images(DVec3::from_array(dab.centre), self.brush.mirror);
        let brush = self.brush;
        let weight = |p: DVec3| {
            let nearest = images.iter().map(|c| c.distance_squared(p)).fold(f64::INFINITY, f64::min);
            f64::from(brush.strength) * brush.falloff.weight(nearest.sqrt() / dab.radius)
        };
        if brush.action == Action::Smooth {
            smooth(canvas, ln, weight);
            return;
        }
        let value = f64::from(brush.value).ln();
        let before = &self.before;
        ln.par_iter_mut().zip(&mut self.reach).enumerate().with_min_len(VERTICES_PER_TASK).for_each(
            |(v, (ln, reach))| {
                let w = weight(canvas.positions()[v]);
                if w <= LEAST_WEIGHT || w <= *reach {
                    return;
                }
                *reach = w;
                let start = before[v];
                *ln = match brush.action {
                    Action::Set | Action::Smooth => start + w * (value - start),
                    Action::Add => within(start + w * value.abs(), start),
                    Action::Subtract => within(start - w * value.abs(), start),
                    Action::Erase => start + w * (under[v] - start),
                };
            },
        );
    }
}

/// What adding leads to stays where the method is good; what was beyond already is not drawn in.
fn within(ln: f64, start: f64) -> f64 {
    let (low, high) = (f64::from(CLAMP_MIN).ln(), f64::from(CLAMP_MAX).ln());
    ln.clamp(low.min(start), high.max(start))
}

/// Each vertex goes towards the mean of its neighbours.
fn smooth(canvas: &Canvas, ln: &mut [f64], weight: impl Fn(DVec3) -> f64 + Sync) {
    let smoothed: Vec<f64> = (0..ln.len())
        .into_par_iter()
        .with_min_len(VERTICES_PER_TASK)
        .map(|v| {
            let w = weight(canvas.positions()[v]);
            let around = canvas.around(canvas.first(v));
            if w <= LEAST_WEIGHT || around.is_empty() {
                return ln[v];
            }
            let mean = around.iter().map(|&n| ln[n as usize]).sum::<f64>() / around.len() as f64;
            ln[v] + w * (mean - ln[v])
        })
        .collect();
    ln.copy_from_slice(&smoothed);
}

/// Does a whole edit to `[vertices]` ln f.
pub(super) fn apply(canvas: &Canvas, under: &[f64], ln: &mut [f64], edit: &Edit) {
    match edit {
        Edit::Stroke { brush, dabs } => {
            let mut live = Live::new(*brush, ln);
            for &dab in dabs {
                live.dab(canvas, under, ln, dab);
            }
        }
        Edit::Fill(fill) => apply_fill(canvas, ln, fill),
    }
}

fn apply_fill(canvas: &Canvas, ln: &mut [f64], fill: &Fill) {
    let mut set = |value: f32, wanted: &dyn Fn(usize) -> bool| {
        let value = f64::from(value).ln();
        for (v, ln) in ln.iter_mut().enumerate().filter(|(v, _)| wanted(*v)) {
            debug_assert!(v < canvas.vertices());
            *ln = value;
        }
    };
    match fill {
        Fill::All { value } => set(*value, &|_| true),
        Fill::Region { name, value } => set(*value, &|v| canvas.is_in(v, name)),
        Fill::Connected { vertex, value } => set(*value, &|v| canvas.connected(v, *vertex as usize)),
        Fill::Gradient { axis, from, to } => {
            let axis = match axis {
                Axis::X => 0,
                Axis::Y => 1,
                Axis::Z => 2,
            };
            let (low, high) = canvas.bounds();
            let (from, to) = (f64::from(*from).ln(), f64::from(*to).ln());
            let length = high[axis] - low[axis];
            for (v, ln) in ln.iter_mut().enumerate() {
                let t = if length > 0.0 { (canvas.positions()[v][axis] - low[axis]) / length } else { 0.5 };
                *ln = from + t * (to - from);
            }
        }
    }
}

/// `[vertices]` ln f after all edits.
pub(super) fn replay(canvas: &Canvas, under: &[f64], edits: &[Edit]) -> Vec<f64> {
    let mut ln = under.to_vec();
    for edit in edits {
        apply(canvas, under, &mut ln, edit);
    }
    ln
}

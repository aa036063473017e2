//! The document that is painted: layers, edits over them, and the way back.

use std::sync::Arc;

use super::{
    Brush, Canvas, Dab, Edit,
    apply::{Live, apply, replay},
};
use crate::{
    boundary::Boundary,
    importance::{Layer, Stack},
};

/// The layers below all edits, as said and as read. `S` is what they were read for: it goes along through undo.
#[derive(Debug, Clone)]
pub struct Under<S = ()> {
    /// As a scene says them.
    pub layers: Vec<Layer>,
    /// Indices of the layers that are left out.
    pub hidden: Vec<usize>,
    /// Importance below all layers.
    pub base: f32,
    /// Whether values out of range are brought into it.
    pub clamp: bool,
    /// The surface that is painted on.
    pub boundary: Arc<Boundary>,
    /// What all of it says there, read and checked.
    pub stack: Arc<Stack>,
    /// What they were read for, with what they say of it.
    pub subject: S,
}

/// One step of undo.
#[derive(Debug, Clone)]
enum Change<S> {
    /// An edit and the values it changed: vertex, ln f before, ln f after.
    Edit(Edit, Vec<(u32, f64, f64)>),
    /// Other layers: before and after.
    Under(Box<[Under<S>; 2]>),
}

/// Steps of undo that are kept; a step holds what it changed, 20 bytes a vertex.
const MOST_UNDO: usize = 1000;

/// Importance that is being painted.
#[derive(Debug, Clone)]
pub struct Painting<S = ()> {
    canvas: Arc<Canvas>,
    under: Under<S>,
    /// `[vertices]` what the layers say, ln f.
    ln_under: Vec<f64>,
    edits: Vec<Edit>,
    /// `[vertices]` ln f.
    ln: Vec<f64>,
    undo: Vec<Change<S>>,
    redo: Vec<Change<S>>,
    stroke: Option<Live>,
    version: u64,
}

impl<S: Clone> Painting<S> {
    /// Opens layers with edits over them, which have been [checked](Edit::check).
    pub fn new(canvas: Arc<Canvas>, under: Under<S>, edits: Vec<Edit>) -> Self {
        let ln_under = logarithms(&under);
        let ln = replay(&canvas, &ln_under, &edits);
        Self { canvas, under, ln_under, edits, ln, undo: Vec::new(), redo: Vec::new(), stroke: None, version: 0 }
    }

    /// What is painted on.
    pub fn canvas(&self) -> &Arc<Canvas> {
        &self.canvas
    }

    /// The layers.
    pub fn under(&self) -> &Under<S> {
        &self.under
    }

    /// The edits over the layers, in order.
    pub fn edits(&self) -> &[Edit] {
        &self.edits
    }

    /// Rises with each change.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// `[vertices]` ln f.
    pub fn ln(&self) -> &[f64] {
        &self.ln
    }

    /// `[vertices]` importance.
    pub fn importance(&self) -> Vec<f32> {
        self.ln.iter().map(|ln| ln.exp() as f32).collect()
    }

    /// Importance as a function of the surface: the layers with what was painted over them.
    pub fn stack(&self) -> Stack {
        let stack = Stack::clone(&self.under.stack);
        match self.differences() {
            Some(differences) => stack.painted(differences),
            None => stack,
        }
    }

    /// `[vertices]` what was painted over the layers, in ln f; `None` if nothing was.
    pub fn differences(&self) -> Option<Vec<f64>> {
        let is_bare = self.edits.is_empty() && self.stroke.is_none();
        (!is_bare).then(|| self.ln.iter().zip(&self.ln_under).map(|(ln, under)| ln - under).collect())
    }

    /// Begins a stroke; one that was being made ends.
    pub fn begin(&mut self, brush: Brush) {
        self.end();
        self.stroke = Some(Live::new(brush, &self.ln));
    }

    /// Adds a dab to the stroke, if one is being made.
    pub fn dab(&mut self, dab: Dab) {
        if let Some(stroke) = &mut self.stroke {
            stroke.dab(&self.canvas, &self.ln_under, &mut self.ln, dab);
            self.version += 1;
        }
    }

    /// Whether a stroke is being made.
    pub fn is_painting(&self) -> bool {
        self.stroke.is_some()
    }

    /// The last dab of the stroke that is being made.
    pub fn last_dab(&self) -> Option<Dab> {
        self.stroke.as_ref()?.dabs.last().copied()
    }

    /// Ends the stroke: from here on it can be undone.
    pub fn end(&mut self) {
        if let Some(Live { brush, dabs, before, .. }) = self.stroke.take()
            && !dabs.is_empty()
        {
            self.keep(Edit::Stroke { brush, dabs }, &before);
        }
    }

    /// Takes back the stroke that is being made. Whether there was one.
    pub fn cancel(&mut self) -> bool {
        let Some(stroke) = self.stroke.take() else { return false };
        self.ln = stroke.before;
        self.version += 1;
        true
    }

    /// Does a whole edit.
    ///
    /// # Errors
    /// As [`Edit::check`]; nothing changes then.
    pub fn apply(&mut self, edit: Edit) -> crate::Result<()> {
        self.end();
        edit.check(self.edits.len(), &self.canvas)?;
        let before = self.ln.clone();
        apply(&self.canvas, &self.ln_under, &mut self.ln, &edit);
        self.keep(edit, &before);
        Ok(())
    }

    /// Puts other layers below the edits.
    pub fn set_under(&mut self, under: Under<S>) {
        self.end();
        let before = std::mem::replace(&mut self.under, under);
        self.note(Change::Under(Box::new([before, self.under.clone()])));
        self.repaint();
    }

    /// Takes the last change back. Whether there was one.
    pub fn undo(&mut self) -> bool {
        self.end();
        let Some(change) = self.undo.pop() else { return false };
        match &change {
            Change::Edit(_, changed) => {
                self.edits.pop();
                for &(v, before, _) in changed {
                    self.ln[v as usize] = before;
                }
                self.version += 1;
            }
            Change::Under(both) => {
                self.under = both[0].clone();
                self.repaint();
            }
        }
        self.redo.push(change);
        true
    }

    /// Does again what was undone last. Whether there was anything.
    pub fn redo(&mut self) -> bool {
        if self.stroke.is_some() {
            return false;
        }
        let Some(change) = self.redo.pop() else { return false };
        match &change {
            Change::Edit(edit, changed) => {
                self.edits.push(edit.clone());
                for &(v, _, after) in changed {
                    self.ln[v as usize] = after;
                }
                self.version += 1;
            }
            Change::Under(both) => {
                self.under = both[1].clone();
                self.repaint();
            }
        }
        self.undo.push(change);
        true
    }

    /// How many changes can be undone and redone.
    pub fn depth(&self) -> (usize, usize) {
        (self.undo.len(), self.redo.len())
    }

    fn keep(&mut self, edit: Edit, before: &[f64]) {
        let changed = before.iter().zip(&self.ln).enumerate().filter(|(_, (a, b))| a.to_bits() != b.to_bits());
        let changed = changed.map(|(v, (a, b))| (v as u32, *a, *b)).collect();
        self.edits.push(edit.clone());
        self.note(Change::Edit(edit, changed));
        self.version += 1;
    }

    fn note(&mut self, change: Change<S>) {
        self.redo.clear();
        self.undo.push(change);
        if self.undo.len() > MOST_UNDO {
            self.undo.remove(0);
        }
    }

    /// Everything anew from layers and edits.
    fn repaint(&mut self) {
        if self.under.boundary.positions.len() != self.canvas.vertices() {
            self.canvas = Arc::new(Canvas::new(&self.under.boundary));
        } else if !self.canvas.has_regions(self.under.boundary.regions.as_ref()) {
            self.canvas = Arc::new(self.canvas.with_regions(self.under.boundary.regions.as_ref()));
        }
        self.ln_under = logarithms(&self.under);
        self.ln = replay(&self.canvas, &self.ln_under, &self.edits);
        self.version += 1;
    }
}

fn logarithms<S>(under: &Under<S>) -> Vec<f64> {
    under.stack.at_vertices(&under.boundary).iter().map(|f| f64::from(*f).ln()).collect()
}

//! What crosses or is turned over in Eq. 1's solution, to be drawn red: found beside the window, where the film stands.

use std::sync::Arc;

use glam::Vec3A;

use crate::certificate::Places;
use crate::certificate::Surfaces;
use crate::session::Lattice;
use crate::transfer::Binding;
use crate::voxel::Complex;
use crate::voxel::blend;

/// λ is looked at in steps of one over this: finer ones are not told apart while the film plays.
const STEPS: usize = 20;

/// `[nodes]` in cells.
type State = Arc<Vec<Vec3A>>;

/// Triangles of the boundary, rising.
pub(super) type Faulty = Arc<Vec<u32>>;

/// What has been found of the present linear solution.
#[derive(Default)]
pub(super) struct Marks {
    tools: Option<Arc<Tools>>,
    /// V' that was looked at.
    linear: Option<State>,
    /// How the surface that was looked at follows it.
    binding: Option<Arc<Binding>>,
    /// By step of λ.
    found: Vec<Option<Faulty>>,
    is_looking: bool,
}

/// What the search needs of a lattice.
struct Tools {
    complex: Arc<Complex>,
    binding: Arc<Binding>,
    surfaces: Surfaces,
    places: Places,
}

/// A search that is to be done on a thread of its own.
pub(super) struct Search {
    lattice: Lattice,
    tools: Option<Arc<Tools>>,
    linear: State,
    step: usize,
}

/// What came of it.
pub(super) struct Found {
    tools: Arc<Tools>,
    linear: State,
    step: usize,
    faulty: Faulty,
}

fn step(lambda: f32) -> usize {
    (lambda.clamp(0.0, 1.0) * STEPS as f32).round() as usize
}

impl Marks {
    /// What to look for next so that λ can be marked, if anything.
    pub fn wanted(&mut self, lattice: &Lattice, linear: &State, lambda: f32) -> Option<Search> {
        let step = step(lambda);
        if self.is_looking || linear.len() != lattice.complex.nodes() {
            return None;
        }
        let is_known = self.linear.as_ref().is_some_and(|known| Arc::ptr_eq(known, linear))
            && self.binding.as_ref().is_some_and(|known| Arc::ptr_eq(known, &lattice.binding));
        if !is_known {
            self.linear = Some(linear.clone());
            self.binding = Some(lattice.binding.clone());
            self.found = vec![None; STEPS + 1];
        }
        if self.found[step].is_some() {
            return None;
        }
        self.is_looking = true;
        let tools = self.tools.clone().filter(|tools| {
            Arc::ptr_eq(&tools.complex, &lattice.complex) && Arc::ptr_eq(&tools.binding, &lattice.binding)
        });
        Some(Search { lattice: lattice.clone(), tools, linear: linear.clone(), step })
    }

    /// A search has ended.
    pub fn take(&mut self, found: Found) {
        self.is_looking = false;
        let is_asked = self.linear.as_ref().is_some_and(|known| Arc::ptr_eq(known, &found.linear))
            && self.binding.as_ref().is_some_and(|known| Arc::ptr_eq(known, &found.tools.binding));
        self.tools = Some(found.tools);
        if is_asked {
            self.found[found.step] = Some(found.faulty);
        }
    }

    /// A search broke off; the next one may begin.
    pub fn give_up(&mut self) {
        self.is_looking = false;
        // It would break off again.
        self.found.iter_mut().for_each(|found| *found = Some(found.take().unwrap_or_default()));
    }

    /// What to mark at λ: what was found nearest to it.
    pub fn at(&self, linear: Option<&State>, lambda: f32) -> Option<Faulty> {
        let is_known = self.linear.as_ref().zip(linear).is_some_and(|(a, b)| Arc::ptr_eq(a, b));
        let known = self.found.iter().enumerate().filter(|_| is_known);
        let known = known.filter_map(|(k, faulty)| Some((k.abs_diff(step(lambda)), faulty.as_ref()?)));
        known.min_by_key(|(distance, _)| *distance).map(|(_, faulty)| faulty.clone())
    }
}

impl Search {
    /// Looks.
    pub fn run(self) -> Found {
        let Self { lattice: Lattice { boundary, complex, binding, .. }, tools, linear, step } = self;
        let tools = tools.unwrap_or_else(|| {
            let surfaces = Surfaces::new(&boundary, binding.clone(), &complex);
            Arc::new(Tools { places: Places::new(&boundary, &complex), complex, binding, surfaces })
        });
        let state = blend(&tools.complex.rest, &linear, step as f32 / STEPS as f32);
        let faulty = Arc::new(tools.places.to_be_seen(&tools.complex, &tools.surfaces, &state));
        Found { tools, linear, step, faulty }
    }
}

//! A tree of boxes over a set of primitives (triangles, or pairs of them), ordered once by rest positions and fitted to
//! every state or motion.
//!
//! Warping keeps neighbours together, so the rest order stays good; fitting is one pass over the boxes.

use glam::{BVec3A, Vec3A};
use rayon::prelude::*;

/// Primitives per leaf: four boxes fit a cache line pair; more tests pairs in vain, fewer deepens the tree.
const LEAF: usize = 4;

/// Leaves per parallel task.
const LEAVES_PER_TASK: usize = 64;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Lowest corner.
    pub low: Vec3A,
    /// Highest corner.
    pub high: Vec3A,
}

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    /// The box of some points.
    pub fn of(points: impl IntoIterator<Item = Vec3A>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { low: b.low.min(p), high: b.high.max(p) })
    }

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Grown on every side.
    pub fn grown(self, margin: f32) -> Self {
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// Where a ray enters, in lengths of its direction, whose reciprocal is given; infinity where it misses.
    #[inline]
    fn entry(&self, origin: Vec3A, inverse: Vec3A) -> f32 {
        let (a, b) = ((self.low - origin) * inverse, (self.high - origin) * inverse);
        // A ray within a face of the box gives 0 · ∞; such an axis limits nothing.
        let (near, far) = (a.min(b), a.max(b));
        let clean = |v: Vec3A, otherwise: f32| Vec3A::select(v.is_nan_mask(), Vec3A::splat(otherwise), v);
        let (near, far) = (clean(near, f32::NEG_INFINITY).max_element(), clean(far, f32::INFINITY).min_element());
        if near.max(0.0) <= far { near.max(0.0) } else { f32::INFINITY }
    }

    /// Whether two closed boxes meet.
    #[inline]
    pub fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// The boxes of one primitive at the ends of a motion (one end: a state).
///
/// Where corners move along straight lines, two primitives whose boxes are apart along an axis at both ends, in the
/// same order, are apart along it at every instant: this says more than the boxes that hold whole motions, and moving
/// together brings nothing near.
pub(super) type Boxes<const ENDS: usize> = [Bounds; ENDS];

/// False only where an axis keeps two primitives apart at every instant.
#[inline]
pub(super) fn may_meet<const ENDS: usize>(a: &Boxes<ENDS>, b: &Boxes<ENDS>) -> bool {
    let (mut below, mut above) = (BVec3A::TRUE, BVec3A::TRUE);
    for (a, b) in a.iter().zip(b) {
        below &= a.high.cmplt(b.low);
        above &= b.high.cmplt(a.low);
    }
    !(below | above).any()
}

pub(super) fn union<const ENDS: usize>(a: &Boxes<ENDS>, b: &Boxes<ENDS>) -> Boxes<ENDS> {
    std::array::from_fn(|e| a[e].union(b[e]))
}

/// The boxes of a tree's nodes in one state.
#[derive(Debug, Clone, Default)]
pub struct Posed {
    heap: Vec<Bounds>,
}

/// The order of a complete binary tree over leaves of a few primitives.
#[derive(Debug, Clone)]
pub struct Tree {
    /// Primitive indices, leaf by leaf.
    order: Vec<u32>,
    leaves: usize,
}

impl Tree {
    /// A tree over primitives with the given centres, split at medians along the widest axis.
    pub fn new(centres: &[Vec3A]) -> Self {
        let leaves = centres.len().div_ceil(LEAF).next_power_of_two();
        let mut order: Vec<u32> = (0..centres.len() as u32).collect();
        split(&mut order, centres, leaves);
        Self { order, leaves }
    }

    /// Primitives of leaf `l`, as a range of `order`.
    fn leaf(&self, l: usize) -> std::ops::Range<usize> {
        // The same proportional cuts as `split`.
        let n = self.order.len();
        l * n / self.leaves..(l + 1) * n / self.leaves
    }

    /// The boxes of all nodes: node k has children 2k and 2k + 1; the last `leaves` are the leaves.
    fn heap<const ENDS: usize>(&self, boxes: &[Boxes<ENDS>]) -> Vec<Boxes<ENDS>> {
        let mut heap = vec![[Bounds::EMPTY; ENDS]; 2 * self.leaves];
        let (inner, leaves) = heap.split_at_mut(self.leaves);
        leaves.par_iter_mut().enumerate().with_min_len(1024).for_each(|(l, node)| {
            *node = boxes[self.leaf(l)].iter().fold([Bounds::EMPTY; ENDS], |a, b| union(&a, b));
        });
        for k in (1..self.leaves).rev() {
            let child = |c: usize| if c < self.leaves { inner[c] } else { leaves[c - self.leaves] };
            inner[k] = union(&child(2 * k), &child(2 * k + 1));
        }
        heap
    }

    /// The tree's boxes in one state, for rays. `bounds` gives the box of a primitive.
    pub fn posed(&self, bounds: impl Fn(u32) -> Bounds + Sync) -> Posed {
        let boxes: Vec<Boxes<1>> = self.order.par_iter().with_min_len(1024).map(|&p| [bounds(p)]).collect();
        Posed { heap: self.heap(&boxes).into_iter().map(|[b]| b).collect() }
    }

    /// The nearest primitive along a ray in a state: `hit` says how far along it a primitive is met, if it is, in
    /// lengths of `direction`. Returns the primitive and that distance; of two at the same distance the one met first.
    pub fn first_along(
        &self,
        posed: &Posed,
        origin: Vec3A,
        direction: Vec3A,
        mut hit: impl FnMut(u32) -> Option<f32>,
    ) -> Option<(u32, f32)> {
        let heap = &posed.heap;
        let inverse = direction.recip();
        let mut best: Option<(u32, f32)> = None;
        let mut stack = vec![1];
        while let Some(node) = stack.pop() {
            let limit = best.map_or(f32::INFINITY, |b| b.1);
            if heap[node].entry(origin, inverse) > limit {
                continue;
            }
            if node < self.leaves {
                let [left, right] = [2 * node, 2 * node + 1];
                let [a, b] = [left, right].map(|child| heap[child].entry(origin, inverse));
                // The nearer one is looked into first; boxes that are missed are infinitely far.
                let order = if a <= b { [(right, b), (left, a)] } else { [(left, a), (right, b)] };
                stack.extend(order.into_iter().filter(|(_, entry)| *entry < limit).map(|(child, _)| child));
                continue;
            }
            for &primitive in &self.order[self.leaf(node - self.leaves)] {
                if let Some(at) = hit(primitive).filter(|at| best.is_none_or(|b| *at < b.1)) {
                    best = Some((primitive, at));
                }
            }
        }
        best
    }

    /// Hands all pairs of primitives whose boxes meet to `take`, each once, which adds what it makes of them to its
    /// list; returns the lists, in an order that does not depend on threads. `bounds` gives the boxes of a primitive at
    /// each end of a motion: pairs are left out that an axis keeps apart at every instant.
    pub fn pairs<const ENDS: usize>(
        &self,
        bounds: impl Fn(u32) -> [Bounds; ENDS] + Sync,
        take: impl Fn(u32, u32, &mut Vec<(u32, u32)>) + Sync,
    ) -> Vec<(u32, u32)> {
        let boxes: Vec<Boxes<ENDS>> = self.order.par_iter().with_min_len(1024).map(|&p| bounds(p)).collect();
        let heap = self.heap(&boxes);
        let search = Search { tree: self, boxes, heap, take };
        let tasks: Vec<Vec<(u32, u32)>> = (0..self.leaves.div_ceil(LEAVES_PER_TASK))
            .into_par_iter()
            .map(|task| {
                let mut pairs = Vec::new();
                for l in task * LEAVES_PER_TASK..((task + 1) * LEAVES_PER_TASK).min(self.leaves) {
                    search.pairs_of_leaf(l, &mut pairs);
                }
                pairs
            })
            .collect();
        tasks.concat()
    }
}

/// A tree with the boxes of one motion.
struct Search<'a, const ENDS: usize, F> {
    tree: &'a Tree,
    /// Boxes of primitives, in the tree's order.
    boxes: Vec<Boxes<ENDS>>,
    heap: Vec<Boxes<ENDS>>,
    take: F,
}

impl<const ENDS: usize, F: Fn(u32, u32, &mut Vec<(u32, u32)>)> Search<'_, ENDS, F> {
    #[inline]
    fn take(&self, a: usize, b: usize, pairs: &mut Vec<(u32, u32)>) {
        if may_meet(&self.boxes[a], &self.boxes[b]) {
            (self.take)(self.tree.order[a], self.tree.order[b], pairs);
        }
    }

    fn pairs_of_leaf(&self, l: usize, pairs: &mut Vec<(u32, u32)>) {
        let range = self.tree.leaf(l);
        let own = &self.heap[self.tree.leaves + l];
        for a in range.clone() {
            for b in a + 1..range.end {
                self.take(a, b, pairs);
            }
        }
        // Leaves to the right of this one only: climb, and look into each right sibling.
        let mut node = self.tree.leaves + l;
        while node > 1 {
            if node & 1 == 0 {
                self.descend(node + 1, own, &range, pairs);
            }
            node /= 2;
        }
    }

    fn descend(&self, node: usize, own: &Boxes<ENDS>, range: &std::ops::Range<usize>, pairs: &mut Vec<(u32, u32)>) {
        if !may_meet(&self.heap[node], own) {
            return;
        }
        if node < self.tree.leaves {
            self.descend(2 * node, own, range, pairs);
            self.descend(2 * node + 1, own, range, pairs);
            return;
        }
        for b in self.tree.leaf(node - self.tree.leaves) {
            if !may_meet(&self.boxes[b], own) {
                continue;
            }
            for a in range.clone() {
                self.take(a, b, pairs);
            }
        }
    }
}

/// Orders `part` so that its proportional halves are apart along the widest axis, down to `leaves` parts.
///
/// Cuts must match [`Tree::leaf`]: `leaf` cuts the whole at `l n / leaves`, so the recursion carries leaf numbers.
fn split(order: &mut [u32], centres: &[Vec3A], leaves: usize) {
    let n = order.len();
    split_range(order, 0, centres, n, 0, leaves, leaves);
}

fn split_range(part: &mut [u32], offset: usize, centres: &[Vec3A], n: usize, first: usize, last: usize, leaves: usize) {
    if last - first <= 1 || part.len() <= 1 {
        return;
    }
    let middle = (first + last) / 2;
    let cut = middle * n / leaves - offset;
    let bounds = Bounds::of(part.iter().map(|&p| centres[p as usize]));
    let extent = bounds.high - bounds.low;
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    if cut > 0 && cut < part.len() {
        part.select_nth_unstable_by(cut, |&a, &b| {
            centres[a as usize][axis].total_cmp(&centres[b as usize][axis]).then(a.cmp(&b))
        });
    }
    let (left, right) = part.split_at_mut(cut.min(part.len()));
    let (left_offset, right_offset) = (offset, offset + left.len());
    rayon::join(
        || split_range(left, left_offset, centres, n, first, middle, leaves),
        || split_range(right, right_offset, centres, n, middle, last, leaves),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn pairs_are_those_of_brute_force(points in prop::collection::vec((0.0_f32..10.0, 0.0_f32..10.0, 0.0_f32..10.0, 0.1_f32..2.0), 0..120)) {
            let bounds: Vec<Bounds> = points.iter().map(|&(x, y, z, r)| Bounds { low: Vec3A::new(x, y, z), high: Vec3A::new(x, y, z) + r }).collect();
            let centres: Vec<Vec3A> = bounds.iter().map(|b| (b.low + b.high) * 0.5).collect();
            let tree = Tree::new(&centres);
            let mut found: Vec<(u32, u32)> =
                tree.pairs(|p| [bounds[p as usize]], |a, b, pairs| pairs.push((a, b))).into_iter().map(|(a, b)| (a.min(b), a.max(b))).collect();
            found.sort_unstable();
            let n = bounds.len() as u32;
            let expected: Vec<(u32, u32)> = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b)))
                .filter(|&(a, b)| bounds[a as usize].meets(&bounds[b as usize])).collect();
            prop_assert_eq!(found, expected);
        }
    }
}

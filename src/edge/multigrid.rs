//! Geometric multigrid on nested lattices: one V-cycle as preconditioner.
//!
//! # Theory
//! A coarse cell is inside where one of its eight children is. The Kuhn subdivision is nested: a fine node is either a
//! coarse node or the middle of one coarse edge, so prolongation P has at most two entries a row and is exact for
//! piecewise linear functions. The coarse operator `Pᵀ A P` (Galerkin) has the same fifteen-point pattern, because both
//! ends of a fine edge lie in one coarse tetrahedron.
//!
//! # Practice
//! Smoother: two damped Jacobi sweeps with Chebyshev weights, the same before and (reversed) after, so that the cycle is
//! symmetric. Every loop gathers, none scatters: the result has the same bits for any number of threads.

use glam::{IVec3, Vec3A};
use rayon::prelude::*;

use super::CHUNK;
use crate::voxel::{Complex, DIRECTIONS, NEIGHBOURS, opposite};

/// Which Laplacian of C.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// Every edge weighs 1 (Eq. 1).
    Unit,
    /// Every edge weighs the number of cells around it (the global step of the collision optimization).
    Cells,
}

/// The hierarchy.
#[derive(Debug, Clone)]
pub struct Multigrid {
    pub(super) levels: Vec<Level>,
}

/// One lattice: a symmetric matrix with fifteen-point rows.
#[derive(Debug, Clone)]
pub(super) struct Level {
    /// `[rows]` columns of the off-diagonal entries.
    pub neighbours: Vec<[u32; NEIGHBOURS]>,
    /// `[rows]` off-diagonal entries (negative for a Laplacian).
    pub off_diagonal: Vec<[f32; NEIGHBOURS]>,
    /// `[rows]` diagonal entries, > 0, mass included.
    pub diagonal: Vec<f32>,
    /// `[rows]` what the row sums to: zero for a Laplacian, then empty.
    mass: Vec<f32>,
    /// `[rows]` the two coarse nodes a node is the middle of (the same twice where it is one).
    parents: Vec<[u32; 2]>,
    /// `[coarse rows]` fine nodes that a coarse node is a parent of, in compressed rows.
    children_start: Vec<u32>,
    children: Vec<u32>,
}

/// Levels stop at this many nodes; the coarsest is then smoothed until it is solved well enough.
const COARSEST: usize = 200;

/// Sweeps on the coarsest level.
const COARSEST_SWEEPS: usize = 24;

/// Chebyshev weights of two Jacobi sweeps for eigenvalues of D⁻¹A in [0.5, 2]: 2 is Gershgorin's bound, and what lies
/// below a quarter of it is the coarse level's work.
const SWEEPS: [f32; 2] = [0.561_694, 1.389_526];

impl Level {
    /// `y = A x`.
    pub fn apply(&self, x: &[Vec3A], y: &mut Vec<Vec3A>) {
        (0..x.len()).into_par_iter().with_min_len(CHUNK).map(|i| self.row(x, i)).collect_into_vec(y);
    }

    #[inline]
    fn row(&self, x: &[Vec3A], i: usize) -> Vec3A {
        // In differences: what rounding leaves of a Laplacian then still sums to zero over all rows.
        let own = x[i];
        let mut sum = if self.mass.is_empty() { Vec3A::ZERO } else { self.mass[i] * own };
        for (&j, &a) in self.neighbours[i].iter().zip(&self.off_diagonal[i]) {
            sum += a * (x[j as usize] - own);
        }
        sum
    }

    /// `out = x + ω D⁻¹ (b − A x)`.
    fn sweep(&self, weight: f32, b: &[Vec3A], x: &[Vec3A], out: &mut Vec<Vec3A>) {
        (0..x.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| x[i] + (weight / self.diagonal[i]) * (b[i] - self.row(x, i)))
            .collect_into_vec(out);
    }
}

/// Vectors of one level, kept between cycles.
#[derive(Debug, Clone, Default)]
struct Workspace {
    x: Vec<Vec3A>,
    b: Vec<Vec3A>,
    spare: Vec<Vec3A>,
}

/// Reusable memory of the cycle.
#[derive(Debug, Clone, Default)]
pub struct CycleMemory {
    levels: Vec<Workspace>,
}

impl Multigrid {
    /// Builds all levels of the Laplacian.
    pub fn new(complex: &Complex, weights: Weights) -> Self {
        Self::with_mass(complex, weights, Vec::new())
    }

    /// Builds all levels of Laplacian + diagonal; `mass` is `[nodes]`, ≥ 0, or empty for none.
    pub fn with_mass(complex: &Complex, weights: Weights, mass: Vec<f32>) -> Self {
        let mut off_diagonal = vec![[0.0_f32; NEIGHBOURS]; complex.nodes()];
        let mut diagonal = vec![0.0_f32; complex.nodes()];
        for i in 0..complex.nodes() {
            for (entry, &m) in off_diagonal[i].iter_mut().zip(&complex.multiplicity[i]) {
                let w = if weights == Weights::Unit { f32::from(m.min(1)) } else { f32::from(m) };
                *entry = -w;
                diagonal[i] += w;
            }
            diagonal[i] += mass.get(i).copied().unwrap_or(0.0);
        }
        Self::of_finest(complex, off_diagonal, diagonal, mass)
    }

    /// Builds all levels of the Laplacian in which every edge weighs the sum of `[cells]` weights > 0 around it.
    pub fn of_cells(complex: &Complex, weights: &[f32]) -> Self {
        Self::of_edges(complex, Vec::new(), |cell, _, _| weights[cell])
    }

    /// Builds all levels of Laplacian + diagonal. Every edge weighs the sum of what the cells around it give: `weight` is
    /// asked for the cell, the corner where the edge begins, and its direction as corner bits. `mass` as in
    /// [`with_mass`](Self::with_mass).
    pub fn of_edges(complex: &Complex, mass: Vec<f32>, weight: impl Fn(usize, usize, usize) -> f32) -> Self {
        let mut off_diagonal = vec![[0.0_f32; NEIGHBOURS]; complex.nodes()];
        let mut diagonal = vec![0.0_f32; complex.nodes()];
        let count = complex.dimension.corners();
        for (cell, corners) in complex.corners.iter().enumerate() {
            for corner in 0..count {
                for direction in (1..count).filter(|direction| corner & direction == 0) {
                    let [i, j] = [corner, corner | direction].map(|k| corners[k] as usize);
                    let weight = weight(cell, corner, direction);
                    for (node, slot) in [(i, direction - 1), (j, direction + 6)] {
                        off_diagonal[node][slot] -= weight;
                        diagonal[node] += weight;
                    }
                }
            }
        }
        for (diagonal, mass) in diagonal.iter_mut().zip(&mass) {
            *diagonal += mass;
        }
        Self::of_finest(complex, off_diagonal, diagonal, mass)
    }

    fn of_finest(complex: &Complex, off_diagonal: Vec<[f32; NEIGHBOURS]>, diagonal: Vec<f32>, mass: Vec<f32>) -> Self {
        let mut levels = vec![Level {
            neighbours: complex.neighbours.clone(),
            off_diagonal,
            diagonal,
            mass,
            parents: Vec::new(),
            children_start: Vec::new(),
            children: Vec::new(),
        }];
        let mut positions: Vec<IVec3> = complex.rest.iter().map(|p| p.as_ivec3()).collect();
        while levels.last().is_some_and(|l| l.diagonal.len() > COARSEST) {
            let Some(fine) = levels.last_mut() else { break };
            let (coarse, coarse_positions) = coarsen(fine, &positions);
            if coarse.diagonal.len() * 10 > fine.diagonal.len() * 9 {
                // Scattered single cells do not coarsen; smoothing alone serves them.
                fine.parents.clear();
                break;
            }
            levels.push(coarse);
            positions = coarse_positions;
        }
        Self { levels }
    }

    /// The operator itself: `y = A x`.
    pub fn apply(&self, x: &[Vec3A], y: &mut Vec<Vec3A>) {
        self.levels[0].apply(x, y);
    }

    /// `[nodes]` diagonal of the operator.
    pub fn diagonal(&self) -> &[f32] {
        &self.levels[0].diagonal
    }

    /// One symmetric V-cycle from zero: `x ≈ A⁻¹ b`.
    pub fn cycle(&self, b: &[Vec3A], x: &mut Vec<Vec3A>, memory: &mut CycleMemory) {
        memory.levels.resize_with(self.levels.len(), Workspace::default);
        memory.levels[0].b.clear();
        memory.levels[0].b.extend_from_slice(b);
        self.descend(0, &mut memory.levels);
        x.clone_from(&memory.levels[0].x);
    }

    fn descend(&self, depth: usize, memory: &mut [Workspace]) {
        let level = &self.levels[depth];
        let Some((work, below)) = memory.split_first_mut() else { return };
        let b = &work.b;
        // The first sweep starts from zero and needs no product with A.
        (0..b.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| (SWEEPS[0] / level.diagonal[i]) * b[i])
            .collect_into_vec(&mut work.x);
        if depth + 1 == self.levels.len() {
            for k in 1..COARSEST_SWEEPS {
                // Palindromic order of weights keeps the coarsest solve symmetric.
                let weight = SWEEPS[usize::from(k % 4 == 1 || k % 4 == 2)];
                level.sweep(weight, b, &work.x, &mut work.spare);
                std::mem::swap(&mut work.x, &mut work.spare);
            }
            return;
        }
        level.sweep(SWEEPS[1], b, &work.x, &mut work.spare);
        std::mem::swap(&mut work.x, &mut work.spare);

        let x = &work.x;
        (0..b.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| b[i] - level.row(x, i))
            .collect_into_vec(&mut work.spare);
        let residual = &work.spare;
        (0..level.children_start.len() - 1)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|c| {
                let mut sum = Vec3A::ZERO;
                for &i in &level.children[level.children_start[c] as usize..level.children_start[c + 1] as usize] {
                    let [p, q] = level.parents[i as usize];
                    sum += if p == q { residual[i as usize] } else { 0.5 * residual[i as usize] };
                }
                sum
            })
            .collect_into_vec(&mut below[0].b);
        self.descend(depth + 1, below);

        let coarse = &below[0].x;
        work.x.par_iter_mut().zip(&level.parents).with_min_len(CHUNK).for_each(|(x, &[p, q])| {
            *x += 0.5 * (coarse[p as usize] + coarse[q as usize]);
        });
        for &weight in SWEEPS.iter().rev() {
            level.sweep(weight, b, &work.x, &mut work.spare);
            std::mem::swap(&mut work.x, &mut work.spare);
        }
    }
}

/// Builds the next lattice and links `fine` to it.
fn coarsen(fine: &mut Level, positions: &[IVec3]) -> (Level, Vec<IVec3>) {
    let halves = |p: IVec3| {
        let parity = p & 1;
        [(p - parity) / 2, (p + parity) / 2]
    };
    let size = positions.iter().fold(IVec3::ZERO, |m, &p| m.max(halves(p)[1])) + 1;
    let key = |p: IVec3| ((p.z as usize) * size.y as usize + p.y as usize) * size.x as usize + p.x as usize;
    // Only corners that are parents become unknowns: others would have empty rows.
    let mut index = vec![u32::MAX; size.x as usize * size.y as usize * size.z as usize];
    for p in positions.iter().flat_map(|&p| halves(p)) {
        index[key(p)] = 0;
    }
    let mut coarse_positions = Vec::new();
    for z in 0..size.z {
        for y in 0..size.y {
            for x in 0..size.x {
                let slot = &mut index[key(IVec3::new(x, y, z))];
                if *slot == 0 {
                    *slot = coarse_positions.len() as u32;
                    coarse_positions.push(IVec3::new(x, y, z));
                }
            }
        }
    }
    fine.parents = positions.par_iter().map(|&p| halves(p).map(|half| index[key(half)])).collect();

    let n = coarse_positions.len();
    let mut counts = vec![0_u32; n + 1];
    for &[p, q] in &fine.parents {
        counts[p as usize + 1] += 1;
        if q != p {
            counts[q as usize + 1] += 1;
        }
    }
    for i in 0..n {
        counts[i + 1] += counts[i];
    }
    let mut cursor = counts.clone();
    let mut children = vec![0_u32; counts[n] as usize];
    for (i, &[p, q]) in fine.parents.iter().enumerate() {
        for parent in std::iter::once(p).chain((q != p).then_some(q)) {
            children[cursor[parent as usize] as usize] = i as u32;
            cursor[parent as usize] += 1;
        }
    }
    fine.children_start = counts;
    fine.children = children;

    let mut coarse = Level {
        neighbours: (0..n as u32).map(|i| [i; NEIGHBOURS]).collect(),
        off_diagonal: vec![[0.0; NEIGHBOURS]; n],
        diagonal: vec![0.0; n],
        mass: Vec::new(),
        parents: Vec::new(),
        children_start: Vec::new(),
        children: Vec::new(),
    };
    galerkin(fine, &coarse_positions, &mut coarse);
    (coarse, coarse_positions)
}

/// `Pᵀ A P`, row by row from the children of each coarse node.
fn galerkin(fine: &Level, coarse_positions: &[IVec3], coarse: &mut Level) {
    let rows: Vec<([u32; NEIGHBOURS], [f32; NEIGHBOURS], f32)> = (0..coarse_positions.len())
        .into_par_iter()
        .with_min_len(CHUNK / 8)
        .map(|row| {
            let mut columns = [row as u32; NEIGHBOURS];
            let mut entries = [0.0_f32; NEIGHBOURS];
            let mut diagonal = 0.0_f32;
            let mut add = |column: u32, value: f32| {
                if column as usize == row {
                    diagonal += value;
                    return;
                }
                let slot = slot_of(coarse_positions[column as usize] - coarse_positions[row]);
                columns[slot] = column;
                entries[slot] += value;
            };
            for &child in &fine.children[fine.children_start[row] as usize..fine.children_start[row + 1] as usize] {
                let child = child as usize;
                let left = weight_of(fine, child as u32, row);
                let mut spread = |node: usize, value: f32| {
                    let [p, q] = fine.parents[node];
                    if p == q {
                        add(p, left * value);
                    } else {
                        add(p, 0.5 * left * value);
                        add(q, 0.5 * left * value);
                    }
                };
                // Without the mass, which is lumped below.
                spread(child, fine.diagonal[child] - fine.mass.get(child).copied().unwrap_or(0.0));
                for slot in 0..NEIGHBOURS {
                    let value = fine.off_diagonal[child][slot];
                    if value != 0.0 {
                        spread(fine.neighbours[child][slot] as usize, value);
                    }
                }
            }
            (columns, entries, diagonal)
        })
        .collect();
    for (row, (columns, entries, diagonal)) in rows.into_iter().enumerate() {
        coarse.neighbours[row] = columns;
        coarse.off_diagonal[row] = entries;
        coarse.diagonal[row] = diagonal.max(f32::MIN_POSITIVE);
    }
    if !fine.mass.is_empty() {
        // Lumped: the row sums of Pᵀ M P, since P keeps constants.
        coarse.mass = (0..coarse.diagonal.len())
            .map(|row| {
                let children = &fine.children[fine.children_start[row] as usize..fine.children_start[row + 1] as usize];
                children.iter().map(|&c| weight_of(fine, c, row) * fine.mass[c as usize]).sum()
            })
            .collect();
        for (diagonal, mass) in coarse.diagonal.iter_mut().zip(&coarse.mass) {
            *diagonal += mass;
        }
    }
}

/// The entry of P for a child and one of its parents.
fn weight_of(fine: &Level, child: u32, parent: usize) -> f32 {
    if fine.parents[child as usize] == [parent as u32; 2] { 1.0 } else { 0.5 }
}

/// The neighbour slot of a lattice offset, which is a Kuhn direction or the opposite of one.
fn slot_of(offset: IVec3) -> usize {
    let forward = offset.max_element() > 0;
    let d = offset.abs();
    let slot = (d.x | d.y << 1 | d.z << 2) as usize - 1;
    debug_assert_eq!(if forward { DIRECTIONS[slot] } else { -DIRECTIONS[slot] }, offset);
    if forward { slot } else { opposite(slot) }
}

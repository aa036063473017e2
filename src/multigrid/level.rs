//! One lattice of the multigrid hierarchy: a symmetric matrix whose rows have an entry for each direction and its opposite.

use glam::{IVec3, Vec3A};
use rayon::prelude::*;

use super::Weights;
use crate::voxel::{CHUNK, Complex, DIRECTIONS, Dimension, NEIGHBOURS, opposite};

/// Directions of the flat lattice: x, y and the diagonal. Its rows have these and their opposites.
const FLAT: usize = 3;

/// The off-diagonal entries of the rows, N of them in each.
#[derive(Debug, Clone)]
struct Stencil<const N: usize> {
    /// `[rows]` columns; the row itself where there is no entry.
    neighbours: Vec<[u32; N]>,
    /// `[rows]` entries (negative for a Laplacian).
    off_diagonal: Vec<[f32; N]>,
}

impl<const N: usize> Stencil<N> {
    fn new(rows: usize) -> Self {
        let neighbours = (0..rows as u32).map(|i| [i; N]).collect();
        Self { neighbours, off_diagonal: vec![[0.0; N]; rows] }
    }

    /// `start + Σ_j a_ij (x_j − x_i)`: in differences, so that what rounding leaves of a Laplacian still sums to zero over
    /// all rows.
    #[inline]
    fn row(&self, start: Vec3A, x: &[Vec3A], i: usize) -> Vec3A {
        let own = x[i];
        let mut sum = start;
        for (&j, &a) in self.neighbours[i].iter().zip(&self.off_diagonal[i]) {
            sum += a * (x[j as usize] - own);
        }
        sum
    }
}

/// Rows in space or in the plane.
#[derive(Debug, Clone)]
enum Rows {
    Space(Stencil<NEIGHBOURS>),
    Plane(Stencil<{ 2 * FLAT }>),
}

/// One lattice.
#[derive(Debug, Clone)]
pub(super) struct Level {
    rows: Rows,
    /// `[rows]` diagonal entries, > 0, mass included.
    pub diagonal: Vec<f32>,
    /// `[rows]` what the row sums to: zero for a Laplacian, then empty.
    mass: Vec<f32>,
    /// `[rows]` the two coarse nodes a node is the middle of (the same twice where it is one).
    pub parents: Vec<[u32; 2]>,
    /// `[coarse rows]` fine nodes that a coarse node is a parent of, in compressed rows.
    pub children_start: Vec<u32>,
    pub children: Vec<u32>,
    /// `[rows]` in the plane: the coarse node where the coarse edge begins that each forward edge lies on or beside.
    lifted: Vec<[u32; FLAT]>,
}

impl Level {
    /// The complex's own lattice, and where its nodes are.
    pub fn finest(complex: &Complex, weights: Weights, mass: Vec<f32>) -> (Self, Vec<IVec3>) {
        let weight = |m: u8| if weights == Weights::Unit { f32::from(m.min(1)) } else { f32::from(m) };
        let rows = match complex.dimension {
            Dimension::Three => Rows::Space(Stencil {
                neighbours: complex.neighbours.clone(),
                off_diagonal: complex.multiplicity.iter().map(|row| row.map(|m| -weight(m))).collect(),
            }),
            Dimension::Two => {
                let slots = |k: usize| if k < FLAT { k } else { opposite(k - FLAT) };
                Rows::Plane(Stencil {
                    neighbours: complex.neighbours.iter().map(|row| std::array::from_fn(|k| row[slots(k)])).collect(),
                    off_diagonal: complex
                        .multiplicity
                        .iter()
                        .map(|row| std::array::from_fn(|k| -weight(row[slots(k)])))
                        .collect(),
                })
            }
        };
        let positions = complex.rest.iter().map(|p| p.as_ivec3()).collect();
        let sums = complex.multiplicity.iter().map(|row| row.iter().map(|&m| weight(m)).sum::<f32>());
        let diagonal = sums.enumerate().map(|(i, sum)| sum + mass.get(i).copied().unwrap_or(0.0)).collect();
        (Self::new(rows, diagonal, mass), positions)
    }

    fn new(rows: Rows, diagonal: Vec<f32>, mass: Vec<f32>) -> Self {
        let (parents, children_start, children, lifted) = Default::default();
        Self { rows, diagonal, mass, parents, children_start, children, lifted }
    }

    /// `out_i = f(i, (A x)_i)`.
    #[inline]
    pub fn map_rows(&self, x: &[Vec3A], out: &mut Vec<Vec3A>, f: impl Fn(usize, Vec3A) -> Vec3A + Sync + Send) {
        let rows = (0..x.len()).into_par_iter().with_min_len(CHUNK);
        let of_mass = |i: usize| if self.mass.is_empty() { Vec3A::ZERO } else { self.mass[i] * x[i] };
        match &self.rows {
            Rows::Space(stencil) => rows.map(|i| f(i, stencil.row(of_mass(i), x, i))).collect_into_vec(out),
            Rows::Plane(stencil) => rows.map(|i| f(i, stencil.row(of_mass(i), x, i))).collect_into_vec(out),
        }
    }

    /// `y = A x`.
    pub fn apply(&self, x: &[Vec3A], y: &mut Vec<Vec3A>) {
        self.map_rows(x, y, |_, ax| ax);
    }

    /// `out = x + ω D⁻¹ (b − A x)`.
    pub fn sweep(&self, weight: f32, b: &[Vec3A], x: &[Vec3A], out: &mut Vec<Vec3A>) {
        self.map_rows(x, out, |i, ax| x[i] + (weight / self.diagonal[i]) * (b[i] - ax));
    }

    /// Builds the next lattice and links this one to it; `None` where that would hardly be smaller: scattered single cells
    /// do not coarsen, smoothing alone serves them.
    pub fn coarsen(&mut self, positions: &[IVec3]) -> Option<(Self, Vec<IVec3>)> {
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
        let n = coarse_positions.len();
        if n * 10 > positions.len() * 9 {
            return None;
        }
        self.parents = positions.par_iter().map(|&p| halves(p).map(|half| index[key(half)])).collect();
        self.link_children(n);
        let coarse = match &self.rows {
            Rows::Space(stencil) => self.galerkin(stencil, &coarse_positions),
            Rows::Plane(stencil) => {
                let (lifted, coarse) = self.galerkin_flat(stencil, n);
                self.lifted = lifted;
                coarse
            }
        };
        Some((coarse, coarse_positions))
    }

    fn link_children(&mut self, coarse: usize) {
        let mut counts = vec![0_u32; coarse + 1];
        for &[p, q] in &self.parents {
            counts[p as usize + 1] += 1;
            if q != p {
                counts[q as usize + 1] += 1;
            }
        }
        for i in 0..coarse {
            counts[i + 1] += counts[i];
        }
        let mut cursor = counts.clone();
        let mut children = vec![0_u32; counts[coarse] as usize];
        for (i, &[p, q]) in self.parents.iter().enumerate() {
            for parent in std::iter::once(p).chain((q != p).then_some(q)) {
                children[cursor[parent as usize] as usize] = i as u32;
                cursor[parent as usize] += 1;
            }
        }
        self.children_start = counts;
        self.children = children;
    }

    /// `[coarse rows]` the fine nodes a coarse node is a parent of.
    fn children(&self, row: usize) -> &[u32] {
        &self.children[self.children_start[row] as usize..self.children_start[row + 1] as usize]
    }

    /// The entry of P for a child and one of its parents.
    fn weight_of(&self, child: u32, parent: usize) -> f32 {
        if self.parents[child as usize] == [parent as u32; 2] { 1.0 } else { 0.5 }
    }

    /// `[coarse rows]` the lumped mass: the row sums of `Pᵀ M P`, since P keeps constants. Empty for none.
    fn lumped(&self) -> Vec<f32> {
        if self.mass.is_empty() {
            return Vec::new();
        }
        let of_row =
            |row: usize| self.children(row).iter().map(|&c| self.weight_of(c, row) * self.mass[c as usize]).sum();
        (0..self.children_start.len() - 1).map(of_row).collect()
    }

    /// `Pᵀ A P` in space, row by row from the children of each coarse node.
    fn galerkin(&self, fine: &Stencil<NEIGHBOURS>, coarse_positions: &[IVec3]) -> Self {
        let row_of = |row: usize| {
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
            for &child in self.children(row) {
                let left = self.weight_of(child, row);
                let child = child as usize;
                let mut spread = |node: usize, value: f32| {
                    let [p, q] = self.parents[node];
                    if p == q {
                        add(p, left * value);
                    } else {
                        add(p, 0.5 * left * value);
                        add(q, 0.5 * left * value);
                    }
                };
                // Without the mass, which is lumped.
                spread(child, self.diagonal[child] - self.mass.get(child).copied().unwrap_or(0.0));
                for slot in 0..NEIGHBOURS {
                    let value = fine.off_diagonal[child][slot];
                    if value != 0.0 {
                        spread(fine.neighbours[child][slot] as usize, value);
                    }
                }
            }
            (columns, entries, diagonal)
        };
        let rows: Vec<_> = (0..coarse_positions.len()).into_par_iter().with_min_len(CHUNK / 8).map(row_of).collect();
        let (mut stencil, mut diagonal) = (Stencil::new(rows.len()), vec![0.0; rows.len()]);
        for (row, (columns, entries, own)) in rows.into_iter().enumerate() {
            stencil.neighbours[row] = columns;
            stencil.off_diagonal[row] = entries;
            diagonal[row] = own.max(f32::MIN_POSITIVE);
        }
        let mass = self.lumped();
        for (diagonal, mass) in diagonal.iter_mut().zip(&mass) {
            *diagonal += mass;
        }
        Self::new(Rows::Space(stencil), diagonal, mass)
    }

    /// `Pᵀ A P` in the plane, and where each fine edge goes.
    ///
    /// Both ends of a fine edge have a corner of one coarse triangle in common: `P_i − P_j = ½ (e_a − e_b)` for the coarse
    /// edge from a to b that the fine one lies on or beside. So a coarse edge weighs a quarter of what those fine edges do.
    fn galerkin_flat(&self, fine: &Stencil<{ 2 * FLAT }>, coarse: usize) -> (Vec<[u32; FLAT]>, Self) {
        let mut stencil = Stencil::new(coarse);
        let mut forward = vec![[0.0; FLAT]; coarse];
        let mut lifted = vec![[0; FLAT]; fine.neighbours.len()];
        for (i, neighbours) in fine.neighbours.iter().enumerate() {
            for slot in (0..FLAT).filter(|&slot| neighbours[slot] as usize != i) {
                let ([p, q], [r, s]) = (self.parents[i], self.parents[neighbours[slot] as usize]);
                let (a, b) = match () {
                    () if p == r => (q, s),
                    () if p == s => (q, r),
                    () if q == r => (p, s),
                    () => (p, r),
                };
                stencil.neighbours[a as usize][slot] = b;
                stencil.neighbours[b as usize][slot + FLAT] = a;
                lifted[i][slot] = a;
                forward[a as usize][slot] -= 0.25 * fine.off_diagonal[i][slot];
            }
        }
        let mut level = Self::new(Rows::Plane(stencil), vec![0.0; coarse], self.lumped());
        level.reweigh(&forward);
        (lifted, level)
    }

    /// Gives the forward edges of a flat lattice these weights, `[rows]` by direction, ≥ 0.
    pub fn reweigh(&mut self, forward: &[[f32; FLAT]]) {
        let Rows::Plane(stencil) = &mut self.rows else { return };
        let Stencil { neighbours, off_diagonal } = stencil;
        let rows = off_diagonal.par_iter_mut().zip(&mut self.diagonal).zip(neighbours).enumerate();
        let mass = &self.mass;
        rows.with_min_len(CHUNK).for_each(|(i, ((entries, diagonal), neighbours))| {
            for slot in 0..FLAT {
                entries[slot] = -forward[i][slot];
                let before = neighbours[slot + FLAT] as usize;
                entries[slot + FLAT] = if before == i { 0.0 } else { -forward[before][slot] };
            }
            let own = -entries.iter().sum::<f32>();
            *diagonal = own.max(f32::MIN_POSITIVE) + mass.get(i).copied().unwrap_or(0.0);
        });
    }

    /// The weights of the forward edges of the next lattice, from those of this one.
    pub fn lift(&self, forward: &[[f32; FLAT]], coarse: &Self) -> Vec<[f32; FLAT]> {
        let mut lifted = vec![[0.0; FLAT]; coarse.diagonal.len()];
        for (forward, to) in forward.iter().zip(&self.lifted) {
            for slot in 0..FLAT {
                lifted[to[slot] as usize][slot] += 0.25 * forward[slot];
            }
        }
        lifted
    }
}

/// The neighbour slot of a lattice offset, which is a Kuhn direction or the opposite of one.
fn slot_of(offset: IVec3) -> usize {
    let forward = offset.max_element() > 0;
    let d = offset.abs();
    let slot = (d.x | d.y << 1 | d.z << 2) as usize - 1;
    debug_assert_eq!(if forward { DIRECTIONS[slot] } else { -DIRECTIONS[slot] }, offset);
    if forward { slot } else { opposite(slot) }
}

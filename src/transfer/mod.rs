//! 3.5  Deformation transfer: `B' = B + h Σ (α, β, γ, δ) (V'' − V)`.
//!
//! # Changes from the paper
//! The paper sets `B' = Σ (α, β, γ, δ) V''`; in exact arithmetic that is the same, in floating point the form with the
//! displacement gives back the input's own digits where nothing moved. And V'' is first refined by one smooth halving of
//! the lattice ([`Refinement`]), so that a fine surface does not show the lattice it was carried by.

mod flat_mesh;
pub mod plugin;
mod refine;

pub use flat_mesh::flat_boundary;
pub use refine::{Refined, Refinement};

use glam::{DVec3, IVec3, Vec3A};
use rayon::prelude::*;

use crate::{
    boundary::{Boundary, precision::rounded},
    voxel::{Complex, Grid},
};

/// Barycentric coordinates of every boundary vertex in its element, computed once.
#[derive(Debug, Clone)]
pub struct Binding {
    /// `[vertices]` the four nodes of its element in the halved lattice, of which those that carry a vertex are kept.
    pub nodes: Vec<[u32; 4]>,
    /// `[vertices]` α β γ δ, each in 0..=1, summing to 1; all zero for a vertex outside the complex (one that no triangle
    /// uses), which stays where it is.
    pub weights: Vec<[f32; 4]>,
    /// B in source units.
    rest: Vec<DVec3>,
    refined: Refined,
    /// V, refined.
    rest_nodes: Vec<Vec3A>,
    grid: Grid,
    /// What files of single precision hold places relative to: zero near the origin.
    origin: DVec3,
    /// Whether results are rounded to f32, relative to `origin`, as files hold them.
    single: bool,
}

/// Vertices per parallel task.
const VERTICES_PER_TASK: usize = 2048;

/// Looks up cells by position.
pub(crate) struct CellIndex<'a> {
    complex: &'a Complex,
    index: Vec<u32>,
}

impl<'a> CellIndex<'a> {
    pub(crate) fn new(complex: &'a Complex) -> Self {
        let n = complex.grid.cells.as_usizevec3();
        let mut index = vec![u32::MAX; n.x * n.y * n.z];
        for (k, c) in complex.cells.iter().enumerate() {
            let c = c.as_usizevec3();
            index[(c.z * n.y + c.y) * n.x + c.x] = k as u32;
        }
        Self { complex, index }
    }

    fn at(&self, c: IVec3) -> Option<u32> {
        let n = self.complex.grid.cells.as_ivec3();
        if c.cmplt(IVec3::ZERO).any() || c.cmpge(n).any() {
            return None;
        }
        let k = self.index[((c.z * n.y + c.y) * n.x + c.x) as usize];
        (k != u32::MAX).then_some(k)
    }

    /// The inside cell that holds `p` (in cells), allowing for rounding at the faces.
    pub(crate) fn locate(&self, p: DVec3) -> Option<u32> {
        const SLACK: f64 = 1.0e-6;
        self.at(p.floor().as_ivec3()).or_else(|| {
            (0..8).find_map(|k| {
                let off = DVec3::new(
                    if k & 1 == 0 { -SLACK } else { SLACK },
                    if k & 2 == 0 { -SLACK } else { SLACK },
                    if k & 4 == 0 { -SLACK } else { SLACK },
                );
                self.at((p + off).floor().as_ivec3())
            })
        })
    }

    /// Element nodes and barycentric weights of `p` (in cells) in the cell found by [`locate`](Self::locate).
    pub(crate) fn barycentric(&self, cell: u32, p: DVec3) -> ([u32; 4], [f32; 4]) {
        let corners = &self.complex.corners[cell as usize];
        let local = (p - self.complex.cells[cell as usize].as_dvec3()).clamp(DVec3::ZERO, DVec3::ONE);
        let (path, weights) = kuhn(local);
        (path.map(|k: usize| corners[k]), weights)
    }
}

/// The Kuhn element of the unit cell that holds a point, as corner bits, and the point's barycentric weights: coordinates
/// sorted as the element's path walks the axes.
fn kuhn(local: DVec3) -> ([usize; 4], [f32; 4]) {
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| local[b].total_cmp(&local[a]));
    let [a, b, c] = axes;
    let weights = [1.0 - local[a], local[a] - local[b], local[b] - local[c], local[c]];
    ([0, 1 << a, 1 << a | 1 << b, 7], weights.map(|w| w as f32))
}

impl Binding {
    /// Binds every vertex of the boundary to the complex made from it.
    pub fn new(boundary: &Boundary, complex: &Complex) -> Self {
        let cells = CellIndex::new(complex);
        let refinement = Refinement::new(complex);
        let bind = |cell: u32, p: DVec3| {
            let local = 2.0 * (p - complex.cells[cell as usize].as_dvec3()).clamp(DVec3::ZERO, DVec3::ONE);
            let octant = local.floor().min(DVec3::ONE);
            let (path, weights) = kuhn(local - octant);
            let corners = &complex.corners[cell as usize];
            let at = |k: usize| std::array::from_fn(|a| octant[a] as usize + (k >> a & 1));
            (path.map(|k| refinement.node_in_cell(corners, at(k))), weights)
        };
        let bound: Vec<([u32; 4], [f32; 4])> = boundary
            .positions
            .par_iter()
            .with_min_len(VERTICES_PER_TASK)
            .map(|&p| {
                let p = complex.grid.lattice_from_source(p);
                cells.locate(p).map_or(([0; 4], [0.0; 4]), |cell| bind(cell, p))
            })
            .collect();
        let (mut nodes, weights): (Vec<[u32; 4]>, Vec<_>) = bound.into_iter().unzip();
        let refined = refinement.reduced(&mut nodes);
        let grid = complex.grid;
        let extent = grid.cells.as_dvec3() * grid.cell_size;
        let origin = boundary.origin();
        let representable = extent.max_element() > 1.0e-30 && extent.max_element() < 1.0e30;
        Self {
            nodes,
            weights,
            // Far out, what does not move is written relative to that origin as well.
            rest: if origin == DVec3::ZERO {
                boundary.positions.clone()
            } else {
                boundary.rounded(&boundary.positions)
            },
            rest_nodes: refined.apply(&complex.rest),
            refined,
            grid,
            origin,
            single: representable,
        }
    }

    /// Invariant: weights are barycentric. Returns the first vertex for which they are not.
    pub fn is_inside(&self) -> Result<(), usize> {
        let fine = |w: &[f32; 4]| {
            w.iter().all(|&x| x >= 0.0) && ((w.iter().sum::<f32>() - 1.0).abs() < 1e-5 || w.iter().all(|&x| x == 0.0))
        };
        self.weights.iter().position(|w| !fine(w)).map_or(Ok(()), Err)
    }

    /// The first vertex of a triangle that is bound to nothing. There is none: the lattice covers the surface.
    pub fn unbound(&self, boundary: &Boundary) -> Option<u32> {
        boundary.triangles.iter().flatten().copied().find(|&v| self.weights[v as usize] == [0.0; 4])
    }

    /// B' of a state, in source units, rounded as it will be written.
    pub fn apply(&self, nodes: &[Vec3A]) -> Vec<DVec3> {
        let refined = self.refined.apply(nodes);
        let vertices = (0..self.nodes.len()).into_par_iter().with_min_len(VERTICES_PER_TASK);
        vertices.map(|v| self.vertex(v, &refined)).collect()
    }

    fn vertex(&self, v: usize, refined: &[Vec3A]) -> DVec3 {
        let mut moved = DVec3::ZERO;
        for (&i, &w) in self.nodes[v].iter().zip(&self.weights[v]) {
            let i = i as usize;
            moved += f64::from(w) * (refined[i].as_dvec3() - self.rest_nodes[i].as_dvec3());
        }
        if moved == DVec3::ZERO {
            return self.rest[v];
        }
        let p = self.rest[v] + self.grid.cell_size * moved;
        if self.single { rounded(p, self.origin) } else { p }
    }

    /// B' of a state for comparing its triangles: source units, relative to what files hold f32 relative to; cells where f32 has
    /// no such numbers.
    pub fn apply_for_check(&self, nodes: &[Vec3A]) -> Vec<Vec3A> {
        let refined = self.refined.apply(nodes);
        (0..self.nodes.len())
            .into_par_iter()
            .with_min_len(VERTICES_PER_TASK)
            .map(|v| {
                let p = self.vertex(v, &refined);
                if self.single { (p - self.origin).as_vec3a() } else { self.grid.lattice_from_source(p).as_vec3a() }
            })
            .collect()
    }

    /// h in the units of [`apply_for_check`](Self::apply_for_check).
    pub(crate) fn check_cell_size(&self) -> f32 {
        if self.single { self.grid.cell_size as f32 } else { 1.0 }
    }

    /// Bounds of B' in cells for every state that takes each node anywhere between two: lowest and highest corners.
    pub(crate) fn bounds_between(&self, a: &[Vec3A], b: &[Vec3A]) -> [Vec<Vec3A>; 2] {
        let low: Vec<Vec3A> = a.iter().zip(b).map(|(a, b)| a.min(*b)).collect();
        let high: Vec<Vec3A> = a.iter().zip(b).map(|(a, b)| a.max(*b)).collect();
        [self.refined.extreme(&low, &high), self.refined.extreme(&high, &low)].map(|nodes| {
            (0..self.nodes.len())
                .into_par_iter()
                .with_min_len(VERTICES_PER_TASK)
                .map(|v| self.nodes[v].iter().zip(&self.weights[v]).map(|(&i, &w)| w * nodes[i as usize]).sum())
                .collect()
        })
    }

    /// Lets vertices follow the straight middles of edges instead of the four-point rule, in every state: see
    /// [`Refined`]. Returns the vertices that now are elsewhere in states other than rest.
    pub fn straighten(&mut self, vertices: impl Iterator<Item = u32>) -> Vec<u32> {
        let nodes = &self.nodes;
        let straightened = self.refined.straighten(vertices.flat_map(|v| nodes[v as usize]));
        if straightened.is_empty() {
            return Vec::new();
        }
        let mut is_straightened = vec![false; self.rest_nodes.len()];
        for node in straightened {
            is_straightened[node as usize] = true;
        }
        let follows = |v: &usize| {
            nodes[*v].iter().zip(&self.weights[*v]).any(|(&node, &w)| w > 0.0 && is_straightened[node as usize])
        };
        (0..nodes.len()).filter(follows).map(|v| v as u32).collect()
    }

    /// Whether vertices follow the same nodes with the same weights, for two bindings of one boundary to one complex.
    pub fn follows_as(&self, other: &Self) -> bool {
        self.refined == other.refined
    }

    /// `[vertices]` means of a quantity of the complex's nodes, by the weights of each vertex's halved element.
    pub fn of_nodes(&self, values: &[f32]) -> Vec<f32> {
        let node = |i: u32| self.refined.mean(i, values);
        let vertex = |v: usize| self.nodes[v].iter().zip(&self.weights[v]).map(|(&i, &w)| w * node(i)).sum();
        (0..self.nodes.len()).into_par_iter().with_min_len(VERTICES_PER_TASK).map(vertex).collect()
    }

    /// `[nodes of the halved lattice that carry a vertex]` how far each is from its rest position in a state, in cells: what
    /// [`nodes`](Self::nodes) and [`weights`](Self::weights) are summed over.
    pub fn displacements(&self, nodes: &[Vec3A]) -> Vec<Vec3A> {
        let mut refined = self.refined.apply(nodes);
        refined.par_iter_mut().zip(&self.rest_nodes).with_min_len(VERTICES_PER_TASK).for_each(|(p, rest)| *p -= *rest);
        refined
    }

    /// The nodes of the complex that carry a node of the halved lattice: of a middle, first the two ends of its edge.
    pub fn ends(&self, node: u32) -> [u32; 4] {
        self.refined.carriers(node)
    }

    /// The complex's nodes that carry a vertex; some come more than once.
    pub fn carriers(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.nodes[vertex as usize].iter().flat_map(|&node| self.refined.carriers(node))
    }
}

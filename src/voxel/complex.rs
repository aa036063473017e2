//! C = (V, E) and C_t = (V, T): nodes, edges and tetrahedra of the inside cells.

use glam::{IVec3, Vec3A};

use super::Grid;

/// The seven edge directions of the Kuhn subdivision as corner bits (x = 1, y = 2, z = 4); slot `d − 1` of a node's
/// neighbour table is the neighbour along `d`, slot `d + 6` the one against it.
pub const DIRECTIONS: [IVec3; 7] = [
    IVec3::new(1, 0, 0),
    IVec3::new(0, 1, 0),
    IVec3::new(1, 1, 0),
    IVec3::new(0, 0, 1),
    IVec3::new(1, 0, 1),
    IVec3::new(0, 1, 1),
    IVec3::new(1, 1, 1),
];

/// Neighbour slots of a node: seven directions, both ways.
pub const NEIGHBOURS: usize = 14;

/// The slot that leads back.
pub const fn opposite(slot: usize) -> usize {
    (slot + 7) % NEIGHBOURS
}

/// The six tetrahedra of a cell as corner bits, each a path from corner 0 to corner 7, positively oriented at rest:
/// `det[b − a, c − a, d − a] = 1`.
pub const KUHN: [[usize; 4]; 6] = [[0, 1, 3, 7], [0, 5, 1, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 6, 4, 7]];

/// The simplicial complex of a voxelized domain.
///
/// Topology only speaks of node indices: two nodes may share a grid position (a split cell), nothing here forbids it.
#[derive(Debug, Clone)]
pub struct Complex {
    /// Where the lattice lies in source space.
    pub grid: Grid,
    /// `[cells]` lowest corner of each inside cell, in cells.
    pub cells: Vec<IVec3>,
    /// `[cells]` its eight nodes by corner bits.
    pub corners: Vec<[u32; 8]>,
    /// `[nodes]` V, rest position in cells (whole numbers).
    pub rest: Vec<Vec3A>,
    /// `[nodes]` neighbours by slot; a missing neighbour is the node itself.
    pub neighbours: Vec<[u32; NEIGHBOURS]>,
    /// `[nodes]` number of cells around the edge to each neighbour; 0 where it is missing.
    pub multiplicity: Vec<[u8; NEIGHBOURS]>,
    /// `[faces]` boundary triangles, outward.
    pub faces: Vec<[u32; 3]>,
    /// `[nodes]` whether a node lies on the boundary.
    pub on_boundary: Vec<bool>,
    /// `[nodes]` index of the body (connected component of C) it belongs to.
    pub body: Vec<u32>,
    /// Number of bodies.
    pub bodies: u32,
    /// `[nodes]` the cell positions around each node, for gathering: `cells_around[node][corner]` is the cell of which
    /// the node is that corner, `u32::MAX` if there is none.
    pub cells_around: Vec<[u32; 8]>,
}

impl Complex {
    /// The complex of the `inside` cells of `grid` (x fastest).
    ///
    /// Nodes are numbered in slabs along the longest axis, so that the fourteen neighbours of a node are near in memory.
    pub fn from_cells(grid: Grid, inside: &[bool]) -> Self {
        let n = grid.cells.as_ivec3();
        let is_inside = |c: IVec3| {
            c.cmpge(IVec3::ZERO).all() && c.cmplt(n).all() && inside[((c.z * n.y + c.y) * n.x + c.x) as usize]
        };
        // Axes from slowest to fastest: longest first.
        let mut order = [0, 1, 2];
        order.sort_by_key(|&a| std::cmp::Reverse(n[a]));
        let mut cells = Vec::new();
        for a in 0..n[order[0]] {
            for b in 0..n[order[1]] {
                for c in 0..n[order[2]] {
                    let mut cell = IVec3::ZERO;
                    (cell[order[0]], cell[order[1]], cell[order[2]]) = (a, b, c);
                    if is_inside(cell) {
                        cells.push(cell);
                    }
                }
            }
        }

        let stride = n + 1;
        let key = |p: IVec3| {
            (p[order[0]] as usize * stride[order[1]] as usize + p[order[1]] as usize) * stride[order[2]] as usize
                + p[order[2]] as usize
        };
        let mut node_at = vec![u32::MAX; (stride.x * stride.y) as usize * stride.z as usize];
        for &cell in &cells {
            for corner in 0..8 {
                node_at[key(cell + corner_offset(corner))] = 0;
            }
        }
        let mut rest = Vec::new();
        let mut position = vec![];
        for a in 0..stride[order[0]] {
            for b in 0..stride[order[1]] {
                for c in 0..stride[order[2]] {
                    let mut p = IVec3::ZERO;
                    (p[order[0]], p[order[1]], p[order[2]]) = (a, b, c);
                    let slot = &mut node_at[key(p)];
                    if *slot == 0 {
                        *slot = rest.len() as u32;
                        rest.push(p.as_vec3a());
                        position.push(p);
                    }
                }
            }
        }
        let corners: Vec<[u32; 8]> =
            cells.iter().map(|&cell| std::array::from_fn(|k| node_at[key(cell + corner_offset(k))])).collect();
        let mut complex = Self {
            grid,
            cells,
            corners,
            neighbours: (0..rest.len() as u32).map(|i| [i; NEIGHBOURS]).collect(),
            multiplicity: vec![[0; NEIGHBOURS]; rest.len()],
            faces: Vec::new(),
            on_boundary: vec![false; rest.len()],
            body: Vec::new(),
            bodies: 0,
            cells_around: vec![[u32::MAX; 8]; rest.len()],
            rest,
        };
        complex.link();
        complex.skin(is_inside);
        complex.label_bodies();
        complex
    }

    /// Fills the neighbour tables from the cells.
    fn link(&mut self) {
        for (cell, corners) in self.corners.iter().enumerate() {
            for (corner, &node) in corners.iter().enumerate() {
                self.cells_around[node as usize][corner] = cell as u32;
                for direction in 1..8 {
                    if corner & direction != 0 {
                        continue;
                    }
                    let other = corners[corner | direction];
                    self.neighbours[node as usize][direction - 1] = other;
                    self.multiplicity[node as usize][direction - 1] += 1;
                    self.neighbours[other as usize][direction + 6] = node;
                    self.multiplicity[other as usize][direction + 6] += 1;
                }
            }
        }
    }

    /// Collects the boundary triangles: faces of cells with no inside cell behind them.
    fn skin(&mut self, is_inside: impl Fn(IVec3) -> bool) {
        for (&cell, corners) in self.cells.iter().zip(&self.corners) {
            for axis in 0..3 {
                // (axis, u, v) is right-handed.
                let (bit, u, v) = (1 << axis, 1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
                for (side, base) in [(-1, 0), (1, bit)] {
                    let mut behind = cell;
                    behind[axis] += side;
                    if is_inside(behind) {
                        continue;
                    }
                    let at = |c: usize| corners[base | c];
                    let (a, b, c, d) = (at(0), at(u), at(u | v), at(v));
                    if side > 0 {
                        self.faces.extend([[a, b, c], [a, c, d]]);
                    } else {
                        self.faces.extend([[a, c, b], [a, d, c]]);
                    }
                }
            }
        }
        for &node in self.faces.iter().flatten() {
            self.on_boundary[node as usize] = true;
        }
    }

    fn label_bodies(&mut self) {
        self.body = vec![u32::MAX; self.rest.len()];
        let mut stack = Vec::new();
        for seed in 0..self.rest.len() {
            if self.body[seed] != u32::MAX {
                continue;
            }
            self.body[seed] = self.bodies;
            stack.push(seed as u32);
            while let Some(i) = stack.pop() {
                for &j in &self.neighbours[i as usize] {
                    if self.body[j as usize] == u32::MAX {
                        self.body[j as usize] = self.bodies;
                        stack.push(j);
                    }
                }
            }
            self.bodies += 1;
        }
    }

    /// Number of nodes, |V|.
    pub fn nodes(&self) -> usize {
        self.rest.len()
    }

    /// Number of edges, |E|.
    pub fn edges(&self) -> usize {
        self.multiplicity.iter().map(|m| m[..7].iter().filter(|&&k| k > 0).count()).sum()
    }

    /// Number of tetrahedra, |T|.
    pub fn elements(&self) -> usize {
        self.cells.len() * KUHN.len()
    }

    /// The four nodes of element `t`: `t / 6` is its cell.
    pub fn element(&self, t: usize) -> [u32; 4] {
        KUHN[t % 6].map(|corner| self.corners[t / 6][corner])
    }

    /// Invariant: neighbour tables are symmetric, faces use boundary nodes, every boundary edge has an even number of
    /// faces. Returns what is broken.
    pub fn is_conforming(&self) -> Result<(), String> {
        for i in 0..self.nodes() {
            for slot in 0..NEIGHBOURS {
                let j = self.neighbours[i][slot] as usize;
                let (there, back) = (self.multiplicity[i][slot], opposite(slot));
                if (there == 0) != (j == i) {
                    return Err(format!("node {i} slot {slot}: multiplicity {there} but neighbour {j}"));
                }
                if there > 0 && (self.neighbours[j][back] as usize != i || self.multiplicity[j][back] != there) {
                    return Err(format!("edge {i}–{j} does not lead back"));
                }
            }
        }
        let mut directed: Vec<(u32, u32)> = self.faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        directed.sort_unstable();
        let mut reversed: Vec<(u32, u32)> = directed.iter().map(|&(a, b)| (b, a)).collect();
        reversed.sort_unstable();
        if directed != reversed {
            return Err("the boundary faces are not closed".into());
        }
        Ok(())
    }
}

/// Corner bits to lattice offset.
pub(crate) fn corner_offset(corner: usize) -> IVec3 {
    IVec3::new((corner & 1) as i32, (corner >> 1 & 1) as i32, (corner >> 2 & 1) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, UVec3};

    #[test]
    fn kuhn_elements_are_positive_and_fill_the_cell() {
        for [a, b, c, d] in KUHN {
            let p = |k| corner_offset(k).as_dvec3();
            let det = (p(b) - p(a)).dot((p(c) - p(a)).cross(p(d) - p(a)));
            assert_eq!(det, 1.0);
        }
    }

    fn block() -> Complex {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(3, 4, 5) };
        Complex::from_cells(grid, &[true; 60])
    }

    #[test]
    fn a_block_conforms() {
        let c = block();
        assert_eq!((c.nodes(), c.elements(), c.bodies), (4 * 5 * 6, 360, 1));
        assert_eq!(c.faces.len(), 2 * 2 * (12 + 15 + 20));
        c.is_conforming().expect("conforming");
    }

    #[test]
    fn sabotage_conforming() {
        let mut c = block();
        c.faces.pop();
        assert!(c.is_conforming().is_err());
        let mut c = block();
        c.neighbours[7][0] = 0;
        assert!(c.is_conforming().is_err());
    }
}

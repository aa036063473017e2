//! C = (V, E) and C_t = (V, T): nodes, edges and elements (tetrahedra, in the plane triangles) of the inside cells.

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

/// The two triangles of a flat cell as corner bits, counter-clockwise at rest; the last corner stands twice, so that an
/// element has four in both dimensions.
pub const KUHN_FLAT: [[usize; 4]; 2] = [[0, 1, 3, 3], [0, 3, 2, 2]];

/// Of what the domain is a part: of the plane (pictures) or of space (bodies).
///
/// Flat complexes lie in the layer z = 0. They are the same arrays with one layer of nodes, so that every stage is the
/// same; only orientation, crossing and the projection of area ask for the dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Cells are squares, elements triangles, faces edges.
    Two,
    /// Cells are cubes, elements tetrahedra, faces triangles.
    Three,
}

impl Dimension {
    /// Corners of a cell.
    pub const fn corners(self) -> usize {
        match self {
            Self::Two => 4,
            Self::Three => 8,
        }
    }

    /// The elements of a cell as corner bits.
    pub const fn elements(self) -> &'static [[usize; 4]] {
        match self {
            Self::Two => &KUHN_FLAT,
            Self::Three => &KUHN,
        }
    }

    /// Area or volume of a size: its square or cube.
    #[inline]
    pub fn measure(self, size: f32) -> f32 {
        match self {
            Self::Two => size * size,
            Self::Three => size * size * size,
        }
    }

    /// The size of an area or volume ≥ 0: its square or cube root.
    #[inline]
    pub fn size(self, measure: f64) -> f64 {
        match self {
            Self::Two => measure.sqrt(),
            Self::Three => measure.cbrt(),
        }
    }
}

/// The simplicial complex of a voxelized domain.
///
/// Topology only speaks of node indices, so two nodes could share a grid position (a cell that was split into two). Nothing
/// here forbids it; [multigrid](crate::multigrid) does, which finds the parents of a node by its position.
#[derive(Debug, Clone)]
pub struct Complex {
    /// Plane or space.
    pub dimension: Dimension,
    /// Where the lattice lies in source space.
    pub grid: Grid,
    /// `[cells]` lowest corner of each inside cell, in cells.
    pub cells: Vec<IVec3>,
    /// `[cells]` its eight nodes by corner bits; in the plane four, each of them twice.
    pub corners: Vec<[u32; 8]>,
    /// `[nodes]` V, rest position in cells (whole numbers).
    pub rest: Vec<Vec3A>,
    /// `[nodes]` neighbours by slot; a missing neighbour is the node itself.
    pub neighbours: Vec<[u32; NEIGHBOURS]>,
    /// `[nodes]` number of cells around the edge to each neighbour; 0 where it is missing.
    pub multiplicity: Vec<[u8; NEIGHBOURS]>,
    /// `[faces]` boundary triangles, outward; in the plane boundary edges with the inside on their left, the second node
    /// twice.
    pub faces: Vec<[u32; 3]>,
    /// `[faces]` the cell a face belongs to.
    pub cell_of_face: Vec<u32>,
    /// `[faces]` in the plane, which of the closed lines of the outline each belongs to; empty in space.
    pub outline_of_face: Vec<u32>,
    /// `[cells]` index of the solid (part of C that hangs together by faces, not by nodes or edges alone) it belongs to.
    pub solid: Vec<u32>,
    /// Number of solids.
    pub solids: u32,
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
        Self::new(Dimension::Three, grid, inside)
    }

    /// The flat complex of the `inside` cells of a grid with one layer of cells.
    pub fn from_flat_cells(grid: Grid, inside: &[bool]) -> Self {
        debug_assert_eq!(grid.cells.z, 1);
        Self::new(Dimension::Two, grid, inside)
    }

    fn new(dimension: Dimension, grid: Grid, inside: &[bool]) -> Self {
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

        let stride = match dimension {
            Dimension::Two => IVec3::new(n.x + 1, n.y + 1, 1),
            Dimension::Three => n + 1,
        };
        let key = |p: IVec3| {
            (p[order[0]] as usize * stride[order[1]] as usize + p[order[1]] as usize) * stride[order[2]] as usize
                + p[order[2]] as usize
        };
        let mut node_at = vec![u32::MAX; (stride.x * stride.y) as usize * stride.z as usize];
        for &cell in &cells {
            for corner in 0..dimension.corners() {
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
        let corners: Vec<[u32; 8]> = cells
            .iter()
            .map(|&cell| std::array::from_fn(|k| node_at[key(cell + corner_offset(k % dimension.corners()))]))
            .collect();
        let mut complex = Self {
            dimension,
            grid,
            cells,
            corners,
            neighbours: (0..rest.len() as u32).map(|i| [i; NEIGHBOURS]).collect(),
            multiplicity: vec![[0; NEIGHBOURS]; rest.len()],
            faces: Vec::new(),
            cell_of_face: Vec::new(),
            outline_of_face: Vec::new(),
            solid: Vec::new(),
            solids: 0,
            on_boundary: vec![false; rest.len()],
            body: Vec::new(),
            bodies: 0,
            cells_around: vec![[u32::MAX; 8]; rest.len()],
            rest,
        };
        complex.link();
        match dimension {
            Dimension::Two => {
                complex.outline(is_inside);
                complex.label_outlines();
            }
            Dimension::Three => complex.skin(is_inside),
        }
        for &node in complex.faces.iter().flatten() {
            complex.on_boundary[node as usize] = true;
        }
        complex.label_bodies();
        complex.label_solids();
        complex
    }

    /// Fills the neighbour tables from the cells.
    fn link(&mut self) {
        let count = self.dimension.corners();
        for (cell, corners) in self.corners.iter().enumerate() {
            for (corner, &node) in corners[..count].iter().enumerate() {
                self.cells_around[node as usize][corner] = cell as u32;
                for direction in 1..count {
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
        for (k, (&cell, corners)) in self.cells.iter().zip(&self.corners).enumerate() {
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
                    self.cell_of_face.extend([k as u32; 2]);
                }
            }
        }
    }

    /// Collects the boundary edges of a flat complex: sides of cells with no inside cell behind them.
    fn outline(&mut self, is_inside: impl Fn(IVec3) -> bool) {
        // Outward direction, and the side's corners in counter-clockwise order.
        const SIDES: [(IVec3, [usize; 2]); 4] =
            [(IVec3::X, [1, 3]), (IVec3::NEG_X, [2, 0]), (IVec3::Y, [3, 2]), (IVec3::NEG_Y, [0, 1])];
        for (k, (&cell, corners)) in self.cells.iter().zip(&self.corners).enumerate() {
            for (outward, [from, to]) in SIDES {
                if !is_inside(cell + outward) {
                    self.faces.push([corners[from], corners[to], corners[to]]);
                    self.cell_of_face.push(k as u32);
                }
            }
        }
    }

    /// Labels the closed lines that boundary edges make: at a node each goes on along the cells that hang together there, so
    /// that parts that only touch at it keep lines of their own.
    fn label_outlines(&mut self) {
        let mut starting: Vec<(u32, u32)> = self.faces.iter().zip(0..).map(|(face, k)| (face[0], k)).collect();
        starting.sort_unstable();
        let after = |face: u32| {
            let node = self.faces[face as usize][1];
            let around = &self.cells_around[node as usize];
            let corner_of = |face: u32| (0..4).find(|&k| around[k] == self.cell_of_face[face as usize]);
            let mut fan = [false; 4];
            let mut stack: Vec<usize> = corner_of(face).into_iter().collect();
            while let Some(corner) = stack.pop() {
                if !std::mem::replace(&mut fan[corner], true) {
                    stack.extend([corner ^ 1, corner ^ 2].into_iter().filter(|&next| around[next] != u32::MAX));
                }
            }
            let first = starting.partition_point(|&(from, _)| from < node);
            let here = starting[first..].iter().take_while(|(from, _)| *from == node).map(|&(_, face)| face);
            here.into_iter().find(|&next| corner_of(next).is_some_and(|corner| fan[corner]))
        };
        let mut label = vec![u32::MAX; self.faces.len()];
        let mut lines = 0;
        for seed in 0..self.faces.len() as u32 {
            let mut face = seed;
            while label[face as usize] == u32::MAX {
                label[face as usize] = lines;
                let Some(next) = after(face) else { break };
                face = next;
            }
            lines += u32::from(label[seed as usize] == lines);
        }
        self.outline_of_face = label;
    }

    /// Labels what hangs together by faces.
    fn label_solids(&mut self) {
        let count = self.dimension.corners();
        self.solid = vec![u32::MAX; self.cells.len()];
        let mut stack = Vec::new();
        for seed in 0..self.cells.len() {
            if self.solid[seed] != u32::MAX {
                continue;
            }
            self.solid[seed] = self.solids;
            stack.push(seed as u32);
            while let Some(cell) = stack.pop() {
                let corners = &self.corners[cell as usize];
                // Behind a face lies the cell that has this cell's corner of the face as its own opposite corner.
                for bit in (0..3).map(|axis| 1 << axis).filter(|&bit| bit < count) {
                    for (corner, seen_from) in [(0, bit), (bit, 0)] {
                        let other = self.cells_around[corners[corner] as usize][seen_from];
                        if other != u32::MAX && self.solid[other as usize] == u32::MAX {
                            self.solid[other as usize] = self.solids;
                            stack.push(other);
                        }
                    }
                }
            }
            self.solids += 1;
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

    /// Number of tetrahedra or triangles, |T|.
    pub fn elements(&self) -> usize {
        self.cells.len() * self.dimension.elements().len()
    }

    /// The nodes of element `t`, cell by cell; in the plane the last one stands twice.
    pub fn element(&self, t: usize) -> [u32; 4] {
        let elements = self.dimension.elements();
        elements[t % elements.len()].map(|corner| self.corners[t / elements.len()][corner])
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
        if self.dimension == Dimension::Two {
            let mut balance = vec![0_i32; self.nodes()];
            for &[from, to, _] in &self.faces {
                balance[from as usize] += 1;
                balance[to as usize] -= 1;
            }
            return match balance.iter().all(|&b| b == 0) {
                true => Ok(()),
                false => Err("the boundary edges are not closed".into()),
            };
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
    fn a_flat_ring_conforms() {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(3, 3, 1) };
        let mut inside = [true; 9];
        inside[4] = false;
        let c = Complex::from_flat_cells(grid, &inside);
        assert_eq!((c.nodes(), c.elements(), c.bodies, c.solids, c.faces.len()), (16, 16, 1, 1, 16));
        assert_eq!(c.edges(), 24 + 8);
        c.is_conforming().expect("conforming");
        for t in 0..c.elements() {
            let [a, b, d, _] = c.element(t).map(|i| c.rest[i as usize]);
            assert_eq!((b - a).cross(d - a).z, 1.0);
        }
        let mut c = c;
        c.faces.pop();
        assert!(c.is_conforming().is_err());
    }

    #[test]
    fn outlines_that_touch_at_a_node_are_lines_of_their_own() {
        let lengths = |columns: u32, rows: u32, inside: &[bool]| {
            let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(columns, rows, 1) };
            let c = Complex::from_flat_cells(grid, inside);
            let lines = c.outline_of_face.iter().max().map_or(0, |most| most + 1);
            let mut lengths: Vec<usize> =
                (0..lines).map(|line| c.outline_of_face.iter().filter(|&&l| l == line).count()).collect();
            lengths.sort_unstable();
            lengths
        };
        assert_eq!(lengths(3, 3, &[true, true, true, true, false, true, true, true, true]), [4, 12]);
        // Two cells that share a corner alone.
        assert_eq!(lengths(2, 2, &[true, false, false, true]), [4, 4]);
        // A ring that bites its tail at a corner: the cells there hang together around two ways, and so does its line.
        assert_eq!(lengths(3, 3, &[true, true, false, true, false, true, true, true, true]), [16]);
    }

    #[test]
    fn cells_that_share_no_face_are_solids_of_their_own() {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(2, 2, 1) };
        let c = Complex::from_flat_cells(grid, &[true, false, false, true]);
        assert_eq!((c.bodies, c.solids), (1, 2));
        let c = Complex::from_cells(grid, &[true, false, true, true]);
        assert_eq!((c.bodies, c.solids), (1, 1));
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

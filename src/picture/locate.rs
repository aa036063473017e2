//! Which triangle of the plane a point lies in, without cracks: signs are exact, so a point on an edge is in both.

use glam::{DMat2, DVec2};
use robust::{Coord, orient2d};

use super::FlatMesh;

/// Most entries of a grid's lists; beyond, its cells grow. 4 bytes each.
const MAX_ENTRIES: usize = 20_000_000;

/// Boxes sorted into square cells.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    low: DVec2,
    cell: f64,
    columns: usize,
    rows: usize,
    /// `[cells + 1]` where each cell's items begin.
    starts: Vec<u32>,
    /// Indices of boxes, rising within a cell.
    items: Vec<u32>,
}

impl Grid {
    /// Sorts boxes (low, high) into cells over the rectangle `low..high`; what lies outside of it is not found.
    pub fn new(boxes: &[(DVec2, DVec2)], low: DVec2, high: DVec2) -> Self {
        let extent = (high - low).max(DVec2::splat(1e-9));
        let mut cell = (extent.x * extent.y / boxes.len().max(1) as f64).sqrt().max(extent.max_element() / 4096.0);
        loop {
            let columns = (extent.x / cell).floor() as usize + 1;
            let rows = (extent.y / cell).floor() as usize + 1;
            let mut grid = Self { low, cell, columns, rows, starts: vec![0; columns * rows + 1], items: Vec::new() };
            let mut total = 0;
            for bounds in boxes {
                grid.cells(bounds).for_each(|at| {
                    grid.starts[at + 1] += 1;
                    total += 1;
                });
                if total > MAX_ENTRIES {
                    break;
                }
            }
            if total > MAX_ENTRIES {
                cell *= 2.0;
                continue;
            }
            (1..grid.starts.len()).for_each(|i| grid.starts[i] += grid.starts[i - 1]);
            let mut next = grid.starts.clone();
            grid.items = vec![0; total];
            for (index, bounds) in boxes.iter().enumerate() {
                for at in grid.cells(bounds) {
                    grid.items[next[at] as usize] = index as u32;
                    next[at] += 1;
                }
            }
            return grid;
        }
    }

    /// The boxes that may hold `point`, rising.
    pub fn near(&self, point: DVec2) -> &[u32] {
        let at = (point - self.low) / self.cell;
        if !(at.x >= 0.0 && at.y >= 0.0 && at.x < self.columns as f64 && at.y < self.rows as f64) {
            return &[];
        }
        let cell = at.y as usize * self.columns + at.x as usize;
        &self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// The cells that a box touches; none for one that is empty or no place.
    fn cells(&self, &(low, high): &(DVec2, DVec2)) -> impl Iterator<Item = usize> + use<> {
        let (first, last) = ((low - self.low) / self.cell, (high - self.low) / self.cell);
        let span = |first: f64, last: f64, count: usize| {
            let is_apart = !(last >= 0.0 && first < count as f64);
            if is_apart { 0..0 } else { first.max(0.0) as usize..(last as usize).min(count - 1) + 1 }
        };
        let (columns, rows) = (span(first.x, last.x, self.columns), span(first.y, last.y, self.rows));
        let width = self.columns;
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}

/// Triangles found by place.
#[derive(Debug, Clone)]
pub(super) struct Locator<'a> {
    places: &'a [DVec2],
    triangles: &'a [[u32; 3]],
    grid: Grid,
}

impl<'a> Locator<'a> {
    /// `places`: `[vertices]`. Points outside the triangles' bounds enlarged by `margin` are not found.
    pub fn new(places: &'a [DVec2], triangles: &'a [[u32; 3]], margin: f64) -> Self {
        let (low, high) = bounds(places.iter().copied());
        let margin = DVec2::splat(margin);
        let boxes: Vec<_> = triangles
            .iter()
            .map(|corners| {
                let (low, high) = bounds(corners.iter().map(|&v| places[v as usize]));
                (low - margin, high + margin)
            })
            .collect();
        Self { places, triangles, grid: Grid::new(&boxes, low - margin, high + margin) }
    }

    /// The first triangle that holds the point, its edges included; triangles without area hold none.
    pub fn find(&self, point: DVec2) -> Option<usize> {
        self.grid.near(point).iter().map(|&t| t as usize).find(|&t| self.holds(t, point))
    }

    /// Whether any triangle comes within the margin of the point; sometimes also when none does.
    pub fn is_near(&self, point: DVec2) -> bool {
        !self.grid.near(point).is_empty()
    }

    fn holds(&self, triangle: usize, point: DVec2) -> bool {
        let [a, b, c] = self.triangles[triangle];
        let places = self.places;
        let side = |from: u32, to: u32| {
            // Each edge is asked in one direction, so that both of its triangles get the same answer.
            let (low, high) = (from.min(to) as usize, from.max(to) as usize);
            let sign = orient(places[low], places[high], point);
            if from < to { sign } else { -sign }
        };
        let (ab, bc, ca) = (side(a, b), side(b, c), side(c, a));
        let has_area = ab != 0.0 || bc != 0.0 || ca != 0.0;
        has_area && ((ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0))
    }
}

/// Sign (exact) and about twice the area of the triangle a, b, c; > 0 where it turns from x towards y.
fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// An affine map of the plane: p ↦ `to` + `linear` · (p − `from`).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Affine {
    pub from: DVec2,
    pub to: DVec2,
    pub linear: DMat2,
}

impl Affine {
    /// The map that takes one triangle to another, `None` where the first has no area.
    pub fn between(from: [DVec2; 3], to: [DVec2; 3]) -> Option<Self> {
        let edges = |[a, b, c]: [DVec2; 3]| DMat2::from_cols(b - a, c - a);
        let source = edges(from);
        if source.determinant() == 0.0 {
            return None;
        }
        let linear = edges(to) * source.inverse();
        linear.is_finite().then_some(Self { from: from[0], to: to[0], linear })
    }

    pub fn at(&self, point: DVec2) -> DVec2 {
        self.to + self.linear * (point - self.from)
    }
}

impl FlatMesh {
    /// The corners' places of a triangle.
    pub(super) fn corners(&self, places: &[DVec2], triangle: usize) -> [DVec2; 3] {
        self.triangles[triangle].map(|v| places[v as usize])
    }

    /// Edges of one triangle only: its two vertices and that triangle, in order of the triangles.
    pub(super) fn boundary_edges(&self) -> Vec<([u32; 2], u32)> {
        let mut edges: Vec<(u32, u32, u32)> = Vec::with_capacity(self.triangles.len() * 3);
        for (index, &[a, b, c]) in self.triangles.iter().enumerate() {
            edges.extend([(a, b), (b, c), (c, a)].map(|(i, j)| (i.min(j), i.max(j), index as u32)));
        }
        edges.sort_unstable();
        let mut single: Vec<_> = edges
            .chunk_by(|a, b| (a.0, a.1) == (b.0, b.1))
            .filter(|group| group.len() == 1)
            .map(|group| ([group[0].0, group[0].1], group[0].2))
            .collect();
        single.sort_unstable_by_key(|&(edge, triangle)| (triangle, edge));
        single
    }
}

/// Least and greatest coordinates; (0, 0) of nothing.
pub(super) fn bounds(points: impl Iterator<Item = DVec2>) -> (DVec2, DVec2) {
    let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = points.fold(start, |(low, high), p| (low.min(p), high.max(p)));
    if low.x <= high.x { (low, high) } else { (DVec2::ZERO, DVec2::ZERO) }
}

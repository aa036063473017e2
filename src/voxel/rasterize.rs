//! Conservative rasterization of triangles into cells, and the flood fill of the outside.

use glam::{DVec3, IVec3, UVec3};
use rayon::prelude::*;

use super::Grid;
use crate::boundary::Boundary;

/// Cells grow by this much on every side in the overlap test, so that rounding never loses a touched cell.
const SLACK: f64 = 1.0e-7;

/// Triangles per task of the parallel rasterization; the union of marked cells does not depend on it.
const TRIANGLES_PER_TASK: usize = 4096;

const EMPTY: u8 = 0;
const SURFACE: u8 = 1;
const OUTSIDE: u8 = 2;

/// `[cells]` whether each cell of `grid` is inside, x fastest, then y, then z.
pub fn rasterize(boundary: &Boundary, grid: &Grid) -> Vec<bool> {
    // One cell of padding on each side: the flood fill starts there and reaches all around the shape.
    let padded = grid.cells + UVec3::splat(2);
    let index =
        |c: IVec3| ((c.z as usize + 1) * padded.y as usize + c.y as usize + 1) * padded.x as usize + c.x as usize + 1;
    let mut state = vec![EMPTY; padded.x as usize * padded.y as usize * padded.z as usize];

    let touched: Vec<Vec<IVec3>> = boundary
        .triangles
        .par_chunks(TRIANGLES_PER_TASK)
        .map(|triangles| {
            let mut cells = Vec::new();
            for triangle in triangles {
                let corners = triangle.map(|v| grid.lattice_from_source(boundary.positions[v as usize]));
                touched_cells(corners, grid.cells, &mut |c| cells.push(c));
            }
            cells.sort_unstable_by_key(|c| (c.z, c.y, c.x));
            cells.dedup();
            cells
        })
        .collect();
    for cell in touched.into_iter().flatten() {
        state[index(cell)] = SURFACE;
    }
    flood(&mut state, padded);

    let mut inside = Vec::with_capacity((grid.cells.x * grid.cells.y) as usize * grid.cells.z as usize);
    for z in 0..grid.cells.z as i32 {
        for y in 0..grid.cells.y as i32 {
            let row = index(IVec3::new(0, y, z));
            inside.extend(state[row..row + grid.cells.x as usize].iter().map(|&s| s != OUTSIDE));
        }
    }
    inside
}

/// Calls `mark` for each cell that the closed triangle touches: the box of the triangle is halved until cells remain.
pub(super) fn touched_cells(corners: [DVec3; 3], cells: UVec3, mark: &mut impl FnMut(IVec3)) {
    let low = corners[0].min(corners[1]).min(corners[2]) - SLACK;
    let high = corners[0].max(corners[1]).max(corners[2]) + SLACK;
    let last = cells.as_ivec3() - 1;
    let first = low.floor().as_ivec3().clamp(IVec3::ZERO, last);
    let end = high.floor().as_ivec3().clamp(IVec3::ZERO, last);
    halve(&corners, first, end + 1, mark);
}

/// `first..end` is a box of cells; recursion depth is at most the sum of the logarithms of its sides.
fn halve(corners: &[DVec3; 3], first: IVec3, end: IVec3, mark: &mut impl FnMut(IVec3)) {
    let size = end - first;
    let half = size.as_dvec3() * 0.5;
    if !overlaps(corners, first.as_dvec3() + half, half + SLACK) {
        return;
    }
    if size == IVec3::ONE {
        mark(first);
        return;
    }
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let middle = first[axis] + size[axis] / 2;
    let mut end_low = end;
    end_low[axis] = middle;
    let mut first_high = first;
    first_high[axis] = middle;
    halve(corners, first, end_low, mark);
    halve(corners, first_high, end, mark);
}

/// Separating-axis test of a triangle and an axis-aligned box (Akenine-Möller 2001), closed on both sides.
fn overlaps(corners: &[DVec3; 3], centre: DVec3, half: DVec3) -> bool {
    let v = corners.map(|c| c - centre);
    if (v[0].min(v[1]).min(v[2]) - half).max_element() > 0.0 || (-v[0].max(v[1]).max(v[2]) - half).max_element() > 0.0 {
        return false;
    }
    let edges = [v[1] - v[0], v[2] - v[1], v[0] - v[2]];
    let separates = |axis: DVec3| {
        let p = v.map(|c| c.dot(axis));
        let radius = half.dot(axis.abs());
        let low = p[0].min(p[1]).min(p[2]);
        let high = p[0].max(p[1]).max(p[2]);
        low > radius || high < -radius
    };
    if separates(edges[0].cross(edges[1])) {
        return false;
    }
    !edges.iter().any(|e| [DVec3::X, DVec3::Y, DVec3::Z].iter().any(|a| separates(a.cross(*e))))
}

/// Marks as `OUTSIDE` what the padded grid's corner reaches through faces of `EMPTY` cells.
fn flood(state: &mut [u8], size: UVec3) {
    let (row, slab) = (size.x as usize, (size.x * size.y) as usize);
    let mut stack = vec![0_usize];
    state[0] = OUTSIDE;
    while let Some(i) = stack.pop() {
        let (x, y, z) = (i % row, (i / row) % size.y as usize, i / slab);
        let mut visit = |j: usize| {
            if state[j] == EMPTY {
                state[j] = OUTSIDE;
                stack.push(j);
            }
        };
        if x > 0 {
            visit(i - 1);
        }
        if x + 1 < row {
            visit(i + 1);
        }
        if y > 0 {
            visit(i - row);
        }
        if y + 1 < size.y as usize {
            visit(i + row);
        }
        if z > 0 {
            visit(i - slab);
        }
        if z + 1 < size.z as usize {
            visit(i + slab);
        }
    }
}

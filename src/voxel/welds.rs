//! Cells that may glue two sheets of the surface: a *false weld*.

use glam::{DVec3, IVec3};

use super::{Complex, rasterize::touched_cells};
use crate::boundary::{Boundary, Sets};

/// Number of cells that hold two pieces of surface facing each other across a gap, and so join what is apart.
///
/// Pieces are triangles of the cell that hang together by vertices within it; two of them face each other when the
/// outside lies between them, judged by their normals where they come nearest to the cell's centre. A thin wall, whose
/// sheets face away from each other, is no weld. `welded` is [`Boundary::welded`].
pub fn suspected_welds(boundary: &Boundary, welded: &[u32], complex: &Complex) -> usize {
    let corners = |t: u32| boundary.triangles[t as usize];
    let mut touching: Vec<([i32; 3], u32)> = Vec::new();
    for t in 0..boundary.triangles.len() as u32 {
        let at = corners(t).map(|v| complex.grid.lattice_from_source(boundary.positions[v as usize]));
        touched_cells(at, complex.grid.cells, &mut |c: IVec3| touching.push((c.to_array(), t)));
    }
    touching.sort_unstable();
    touching
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|cell| {
            let centre = IVec3::from_array(cell[0].0).as_dvec3() + 0.5;
            let mut sets = Sets::new(cell.len());
            let mut owners: Vec<(u32, u32)> = cell
                .iter()
                .enumerate()
                .flat_map(|(k, &(_, t))| corners(t).map(|v| (welded[v as usize], k as u32)))
                .collect();
            owners.sort_unstable();
            for pair in owners.windows(2) {
                if pair[0].0 == pair[1].0 {
                    sets.join(pair[0].1, pair[1].1);
                }
            }
            // The nearest point of each piece, with the normal there.
            let mut pieces: Vec<(u32, DVec3, DVec3)> = Vec::new();
            for (k, &(_, t)) in cell.iter().enumerate() {
                let at = corners(t).map(|v| complex.grid.lattice_from_source(boundary.positions[v as usize]));
                let normal = (at[1] - at[0]).cross(at[2] - at[0]);
                let nearest = nearest_point(centre, at);
                let root = sets.find(k as u32);
                match pieces.iter_mut().find(|p| p.0 == root) {
                    Some(piece) if (nearest - centre).length_squared() < (piece.1 - centre).length_squared() => {
                        *piece = (root, nearest, normal);
                    }
                    Some(_) => {}
                    None => pieces.push((root, nearest, normal)),
                }
            }
            pieces
                .iter()
                .enumerate()
                .any(|(k, a)| pieces[..k].iter().any(|b| a.2.dot(b.1 - a.1) > 0.0 && b.2.dot(a.1 - b.1) > 0.0))
        })
        .count()
}

/// The point of a triangle nearest to `p` (Ericson, Real-Time Collision Detection, 5.1.5).
fn nearest_point(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    if sum == 0.0 { a } else { a + ab * (vb / sum) + ac * (vc / sum) }
}

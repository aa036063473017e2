//! A triangle cut by the pixels it overlaps.

use glam::{DVec2, UVec2};

use super::locate::bounds;

/// Gives each pixel that a triangle overlaps, and the area of the overlap.
pub(crate) fn pieces(triangle: [DVec2; 3], size: UVec2, mut give: impl FnMut(usize, f64)) {
    let (low, high) = bounds(triangle.into_iter());
    let first = low.floor().max(DVec2::ZERO).as_uvec2();
    let last = high.ceil().max(DVec2::ZERO).as_uvec2().min(size);
    let mut row_piece = Vec::new();
    let mut piece = Vec::new();
    for y in first.y..last.y {
        // A strip of one pixel's height, then its squares.
        row_piece.clear();
        row_piece.extend(triangle);
        clip(&mut row_piece, |p| p.y - f64::from(y));
        clip(&mut row_piece, |p| f64::from(y + 1) - p.y);
        for x in first.x..last.x {
            piece.clear();
            piece.extend(&row_piece);
            clip(&mut piece, |p| p.x - f64::from(x));
            clip(&mut piece, |p| f64::from(x + 1) - p.x);
            let area = area(&piece);
            if area > 0.0 {
                give((y * size.x + x) as usize, area);
            }
        }
    }
}

/// Keeps the part of a convex polygon where `side` ≥ 0 (Sutherland & Hodgman 1974); `side` is affine.
fn clip(polygon: &mut Vec<DVec2>, side: impl Fn(DVec2) -> f64) {
    let count = polygon.len();
    for i in 0..count {
        let (a, b) = (polygon[i], polygon[(i + 1) % count]);
        let (sa, sb) = (side(a), side(b));
        if sa >= 0.0 {
            polygon.push(a);
        }
        if (sa > 0.0 && sb < 0.0) || (sa < 0.0 && sb > 0.0) {
            polygon.push(a.lerp(b, sa / (sa - sb)));
        }
    }
    polygon.drain(..count);
}

/// Area of a convex polygon of either orientation.
fn area(polygon: &[DVec2]) -> f64 {
    let Some(&origin) = polygon.first() else { return 0.0 };
    let doubled: f64 = polygon.windows(2).map(|e| (e[0] - origin).perp_dot(e[1] - origin)).sum();
    doubled.abs() / 2.0
}

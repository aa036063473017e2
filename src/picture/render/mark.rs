//! Lines over a drawn picture.

use glam::DVec2;
use image::Rgba;

use super::{Canvas, Pixels};

/// Draws segments (pixels of the picture) in a colour over a drawn picture, `width` output pixels thick with round ends,
/// smoothed: where an uncertified state crosses itself is seen at a glance.
pub fn mark(drawn: &mut Pixels, canvas: &Canvas, segments: &[(DVec2, DVec2)], width: f64, colour: Rgba<u8>) {
    let size = drawn.size();
    let reach = width / 2.0 + 1.0;
    for &(a, b) in segments {
        let (a, b) = (canvas.from_plane(a), canvas.from_plane(b));
        if !(a.is_finite() && b.is_finite()) {
            continue;
        }
        let low = (a.min(b) - reach).max(DVec2::ZERO).as_uvec2();
        let high = (a.max(b) + reach).max(DVec2::ZERO).as_uvec2().min(size);
        for (x, y) in (low.y..high.y).flat_map(|y| (low.x..high.x).map(move |x| (x, y))) {
            let centre = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let length = (b - a).length_squared();
            let along = if length > 0.0 { ((centre - a).dot(b - a) / length).clamp(0.0, 1.0) } else { 0.0 };
            let covered = (width / 2.0 + 0.5 - centre.distance(a.lerp(b, along))).clamp(0.0, 1.0);
            if covered > 0.0 {
                let index = (y * size.x + x) as usize;
                drawn.set_wide(index, over(drawn.wide(index), colour, covered * f64::from(colour.0[3]) / 255.0));
            }
        }
    }
}

/// Straight alpha, source over destination (Porter & Duff 1984).
fn over(below: [u16; 4], colour: Rgba<u8>, opacity: f64) -> [u16; 4] {
    let below_alpha = f64::from(below[3]) / 65535.0 * (1.0 - opacity);
    let alpha = opacity + below_alpha;
    let channel = |c: usize| {
        let (top, bottom) = (f64::from(colour.0[c]) * 257.0, f64::from(below[c]));
        ((top * opacity + bottom * below_alpha) / alpha).round() as u16
    };
    [channel(0), channel(1), channel(2), (alpha * 65535.0).round() as u16]
}

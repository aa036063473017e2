//! Growth of a picture as an animated picture: APNG with all its colours and soft edges, GIF where nothing else is shown.
//!
//! Both take finished frames of one size, one after the other, so that only one is in memory; a file's length is exact to
//! its unit (a thousandth and a hundredth of a second): what rounding one frame's end leaves over goes to the next.

mod apng;
mod gif;
mod palette;

use std::io;
use std::time::Duration;

use image::RgbaImage;

pub use apng::apng;
pub use gif::{SHORTEST_GIF_FRAME, gif};
pub use palette::Palette;

/// One frame.
#[derive(Debug, Clone)]
pub struct Frame {
    /// sRGB with straight alpha; all frames of a film have the same size.
    pub pixels: RgbaImage,
    /// How long it is shown.
    pub delay: Duration,
}

/// Delays in whole units whose ends are nowhere more than half a unit off.
#[derive(Debug)]
struct Clock {
    units_per_second: u32,
    elapsed: Duration,
    shown: u128,
}

impl Clock {
    fn new(units_per_second: u32) -> Self {
        Self { units_per_second, elapsed: Duration::ZERO, shown: 0 }
    }

    /// The delay of the next frame, in units.
    fn next(&mut self, delay: Duration) -> u16 {
        self.elapsed += delay;
        let nanos = self.elapsed.as_nanos() * u128::from(self.units_per_second);
        let end = (nanos + 500_000_000) / 1_000_000_000;
        let units = u16::try_from(end.saturating_sub(self.shown)).unwrap_or(u16::MAX);
        self.shown += u128::from(units);
        units
    }
}

/// The smallest rectangle `[x, y, width, height]` outside of which two pictures of one size agree; one pixel where they agree
/// everywhere, as formats want at least that.
pub(crate) fn changed(before: &RgbaImage, after: &RgbaImage) -> [u32; 4] {
    let (width, height) = after.dimensions();
    let row = |image: &'_ RgbaImage, y: u32| -> std::ops::Range<usize> {
        let stride = image.width() as usize * 4;
        y as usize * stride..(y as usize + 1) * stride
    };
    let differs = |y: &u32| before.as_raw()[row(before, *y)] != after.as_raw()[row(after, *y)];
    let Some(top) = (0..height).find(differs) else { return [0, 0, 1, 1] };
    let bottom = (0..height).rev().find(differs).unwrap_or(top);
    let (mut left, mut right) = (width - 1, 0);
    for y in top..=bottom {
        let (b, a) = (&before.as_raw()[row(before, y)], &after.as_raw()[row(after, y)]);
        let differing = |x: &u32| b[*x as usize * 4..][..4] != a[*x as usize * 4..][..4];
        if let Some(x) = (0..left).find(differing) {
            left = x;
        }
        if let Some(x) = (right..width).rev().find(differing) {
            right = x;
        }
    }
    [left.min(right), top, right.max(left) - left.min(right) + 1, bottom - top + 1]
}

/// What only a fault of the caller could break.
fn check_size(first: (u32, u32), frame: &RgbaImage) -> io::Result<()> {
    if frame.dimensions() == first {
        return Ok(());
    }
    Err(io::Error::other(format!("a frame of {:?} pixels among frames of {first:?}", frame.dimensions())))
}

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

/// The rectangle (left, top, width, height) in which two frames differ, at least one pixel.
fn changed(before: &RgbaImage, after: &RgbaImage) -> (u32, u32, u32, u32) {
    let (width, height) = after.dimensions();
    let row = |image: &'_ RgbaImage, y: u32| -> std::ops::Range<usize> {
        let start = (y * image.width() * 4) as usize;
        start..start + (image.width() * 4) as usize
    };
    let is_row_changed = |y: &u32| before.as_raw()[row(before, *y)] != after.as_raw()[row(after, *y)];
    let Some(top) = (0..height).find(is_row_changed) else { return (0, 0, 1, 1) };
    let bottom = (top..height).rev().find(is_row_changed).unwrap_or(top);
    let is_column_changed = |x: &u32| (top..=bottom).any(|y| before.get_pixel(*x, y) != after.get_pixel(*x, y));
    let left = (0..width).find(is_column_changed).unwrap_or(0);
    let right = (left..width).rev().find(is_column_changed).unwrap_or(left);
    (left, top, right - left + 1, bottom - top + 1)
}

/// What only a fault of the caller could break.
fn check_size(first: (u32, u32), frame: &RgbaImage) -> io::Result<()> {
    if frame.dimensions() == first {
        return Ok(());
    }
    Err(io::Error::other(format!("a frame of {:?} pixels among frames of {first:?}", frame.dimensions())))
}

//! Where a picture hangs: looked at straight on, as large as fits beside what is written, the same for the whole film.

use bevy::math::{Vec2, Vec3};

use super::lens::Lens;
use super::overlay;
use crate::view::FIELD_OF_VIEW;

/// Share of the free room that the picture in its largest state fills.
const FILLED: f32 = 0.94;

/// What is around a picture.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Wall {
    /// Width and height of the frame, pixels.
    pub size: [u32; 2],
    /// Whether there is a title.
    pub title: bool,
    /// Whether there is a legend.
    pub legend: bool,
    /// How many pictures hang side by side, with a caption each where there is more than one.
    pub pictures: usize,
}

impl Wall {
    /// From where pictures that reach from `low` to `high` are seen, view units, and how far apart their middles are.
    pub fn hang(&self, low: Vec3, high: Vec3) -> (Lens, f32) {
        let size = Vec2::from(self.size.map(|side| side as f32));
        let extent = (high - low).truncate().max(Vec2::splat(1.0e-3));
        let column = size.x / self.pictures.max(1) as f32;
        let written = overlay::taken(size, self.title, self.legend, self.pictures > 1);
        // Upper left and lower right corner of the room in one column, of each way to leave the legend its place.
        let rooms = written.into_iter().map(|[left, top, bottom]| {
            let room = Vec2::new(column - left, size.y - top - bottom).max(Vec2::splat(1.0));
            let scale = FILLED * (room / extent).min_element();
            let middle = Vec2::new(left + 0.5 * (column - left) - 0.5 * column, top + 0.5 * (room.y - size.y));
            (scale, middle)
        });
        let (scale, middle) = rooms.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((1.0, Vec2::ZERO));
        let off = Vec3::new(middle.x, -middle.y, 0.0) / scale;
        let distance = size.y / scale / (2.0 * (0.5 * FIELD_OF_VIEW).tan());
        let apart = if self.pictures > 1 { column / scale } else { 0.0 };
        (Lens { target: 0.5 * (low + high) - off, distance }, apart)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of the picture in pixels, y down.
    fn seen(wall: &Wall, low: Vec3, high: Vec3) -> [Vec2; 2] {
        let (lens, apart) = wall.hang(low, high);
        let size = Vec2::from(wall.size.map(|side| side as f32));
        let scale = size.y / (2.0 * lens.distance * (0.5 * FIELD_OF_VIEW).tan());
        let at = |p: Vec3| {
            let p = (p - lens.target - Vec3::X * 0.5 * apart) * scale;
            0.5 * size + Vec2::new(p.x, -p.y)
        };
        let (a, b) = (at(low), at(high));
        [a.min(b), a.max(b)]
    }

    #[test]
    fn pictures_fill_the_room_and_leave_what_is_written_its_place() {
        let size = [1280, 720];
        for (low, high) in [(Vec3::new(-1.0, -0.5, 0.0), Vec3::new(1.4, 0.6, 0.0)), (Vec3::NEG_ONE, Vec3::ONE)] {
            let bare = Wall { size, pictures: 1, ..Wall::default() };
            let [least, most] = seen(&bare, low, high);
            assert!(least.min_element() > 0.0 && most.x < 1280.0 && most.y < 720.0, "{least} {most}");
            assert!((most - least).max_element() > 0.9 * 720.0);
            let full = Wall { title: true, legend: true, ..bare };
            let [least, most] = seen(&full, low, high);
            assert!(least.y > 62.0 && (least.x > 316.0 || most.y < 720.0 - 94.0), "{least} {most}");
            let both = Wall { pictures: 2, ..bare };
            let [least, most] = seen(&both, low, high);
            assert!(least.x > 0.0 && most.x < 640.0 && least.y > 125.0, "{least} {most}");
        }
        // Sabotage: without room for the title it lies under it.
        let bare = Wall { size, pictures: 1, ..Wall::default() };
        assert!(seen(&bare, Vec3::NEG_ONE, Vec3::ONE)[0].y < 62.0);
    }
}

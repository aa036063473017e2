//! A row of reference shapes on the floor: what ×½, ×1, ×2, ×4 look like.

use bevy::prelude::*;

/// A row of cubes (discs for a flat body) whose sides are ½, 1, 2 and 4 times `unit`. Spawn it on an entity of its own.
#[derive(Component, Debug, Clone, Copy, PartialEq)]
#[require(Transform, Visibility)]
pub struct SizeLegend {
    /// Side of the cube that stands for ×1, view units.
    pub unit: f32,
    /// Whether to show discs in the plane z = 0.
    pub is_flat: bool,
    /// Middle of the row, on the floor, view space.
    pub at: Vec3,
}

impl SizeLegend {
    /// The size factors, in order from left to right.
    pub const FACTORS: [f32; 4] = [0.5, 1.0, 2.0, 4.0];

    /// Where the labels go: the foot of each shape in view space, and what to write there.
    pub fn labels(&self) -> [(Vec3, &'static str); 4] {
        let names = ["×½", "×1", "×2", "×4"];
        let centres = self.centres();
        std::array::from_fn(|k| (centres[k], names[k]))
    }

    /// The foot of each shape, view space.
    pub fn centres(&self) -> [Vec3; 4] {
        // A gap of the width of ×1 between neighbours.
        let mut x = -0.5 * self.unit * (Self::FACTORS.iter().sum::<f32>() + 3.0);
        Self::FACTORS.map(|factor| {
            let centre = x + 0.5 * factor * self.unit;
            x += (factor + 1.0) * self.unit;
            self.at + Vec3::X * centre
        })
    }
}

//! A row of reference shapes on the floor: what ×½, ×1, ×2, ×4 look like.

use bevy::{camera::visibility::NoFrustumCulling, prelude::*, render::storage::ShaderBuffer};

use super::{
    Extent, Quality, ViewSystems,
    material::{SurfaceMaterial, still},
};

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

/// Shows the rows.
pub(super) fn build(app: &mut App) {
    app.add_systems(PostUpdate, present.in_set(ViewSystems::Present));
}

fn present(
    mut commands: Commands,
    legends: Query<(Entity, &SizeLegend, Option<&Children>), Changed<SizeLegend>>,
    quality: Res<Quality>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<SurfaceMaterial>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
) {
    for (entity, legend, children) in &legends {
        for &child in children.into_iter().flatten() {
            commands.entity(child).despawn();
        }
        let material = materials.add(still(&mut buffers, *quality));
        for (foot, factor) in legend.centres().into_iter().zip(SizeLegend::FACTORS) {
            let side = factor * legend.unit;
            let (mesh, lift) = if legend.is_flat {
                (Circle::new(0.5 * side).mesh().resolution(96).build(), Vec3::ZERO)
            } else {
                (Cuboid::from_length(side).mesh().build(), Vec3::Y * 0.5 * side)
            };
            let at = Transform::from_translation(foot + lift);
            commands.spawn((
                Mesh3d(meshes.add(mesh)),
                MeshMaterial3d(material.clone()),
                at,
                NoFrustumCulling,
                ChildOf(entity),
            ));
        }
    }
}

/// Between neighbours, in widths of ×1: room for their names.
const GAP: f32 = 1.7;

impl SizeLegend {
    /// Width of the row, in widths of ×1.
    pub const WIDTH: f32 = Self::FACTORS[0] + Self::FACTORS[1] + Self::FACTORS[2] + Self::FACTORS[3] + 3.0 * GAP;

    /// The size factors, in order from left to right.
    pub const FACTORS: [f32; 4] = [0.5, 1.0, 2.0, 4.0];

    /// Where the labels go: the top of each shape in view space, and what to write above it.
    pub fn labels(&self) -> [(Vec3, &'static str); 4] {
        let names = ["×½", "×1", "×2", "×4"];
        let centres = self.centres();
        // Cubes stand on their centres' foot, discs lie around theirs.
        let height = if self.is_flat { 0.5 } else { 1.0 };
        std::array::from_fn(|k| (centres[k] + Vec3::Y * height * Self::FACTORS[k] * self.unit, names[k]))
    }

    /// The box around the row, view space.
    pub fn extent(&self) -> Extent {
        let half = 0.5 * Self::FACTORS[3] * self.unit;
        let width = 0.5 * self.unit * Self::WIDTH;
        let below = if self.is_flat { half } else { 0.0 };
        let depth = if self.is_flat { 0.0 } else { half };
        Extent {
            low: self.at - Vec3::new(width, below, depth),
            high: self.at + Vec3::new(width, 2.0 * half - below, depth),
        }
    }

    /// The foot of each shape, view space.
    pub fn centres(&self) -> [Vec3; 4] {
        let mut x = -0.5 * self.unit * Self::WIDTH;
        Self::FACTORS.map(|factor| {
            let centre = x + 0.5 * factor * self.unit;
            x += (factor + GAP) * self.unit;
            self.at + Vec3::X * centre
        })
    }
}

//! Meshes the gallery's implicit models into `assets/gallery/*.glb`: `cargo run --release --example bake_gallery`.
//!
//! With arguments it only draws a piece for the modeller's eye: `bake_gallery PIECE CELL_METRES OUT.obj`, where PIECE
//! is body, head, hand, foot or human (remeshed).

use std::fmt::Write as _;
use std::path::Path;

use glam::Vec3;
use homunculus::gallery::baked::to_glb;
use homunculus::gallery::human::Human;
use homunculus::gallery::implicit::{Mesh, Remesh, cut, polygonize, remesh};

/// Cells of the first net, metres: smaller than half of the thinnest feature that must not be lost (an ear's rim).
const CELL: f32 = 0.0028;
/// How far a vertex may travel to the surface in one round, metres: about one cell.
const REACH: f32 = 0.003;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let human = Human::default();
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [piece, cell, out] = &arguments[..] {
        let mesh = if piece == "human" { bake_human(&human) } else { bare(&human, piece, cell.parse()?) };
        return Ok(std::fs::write(out, obj(&mesh))?);
    }
    let folder = Path::new("assets/gallery");
    for (name, mesh) in [("hand", bake_hand(&human)), ("human", bake_human(&human))] {
        std::fs::write(folder.join(name).with_extension("glb"), to_glb(&mesh))?;
        eprintln!("{name}: {} vertices, {} triangles", mesh.positions.len(), mesh.triangles.len());
    }
    Ok(())
}

fn bake_human(human: &Human) -> Mesh {
    let field = |p: Vec3| human.distance(p);
    let mut net = polygonize(&field, Human::LOW, Human::HIGH, CELL);
    net.keep_largest();
    remesh(&net, &field, &|p| human.edge_length(p), Remesh { rounds: 6, reach: REACH })
}

/// The left hand in its own frame, cut off below the wrist.
fn bake_hand(human: &Human) -> Mesh {
    let frame = human.arm.hand.frame;
    let field = |p: Vec3| cut(human.arm.distance(frame.world(p)), p.y + 0.10, 0.016);
    let mut net = polygonize(&field, Vec3::new(-0.18, -0.13, -0.08), Vec3::new(0.18, 0.28, 0.12), CELL);
    net.keep_largest();
    remesh(&net, &field, &|p| human.edge_length(frame.world(p)).min(0.0038), Remesh { rounds: 6, reach: REACH })
}

fn bare(human: &Human, piece: &str, cell: f32) -> Mesh {
    let field = |p: Vec3| human.distance(p);
    let (low, high) = match piece {
        "head" => (Vec3::new(-0.11, 1.47, -0.12), Vec3::new(0.11, 1.78, 0.16)),
        "hand" => (Vec3::new(0.45, 0.70, -0.10), Vec3::new(0.75, 1.05, 0.14)),
        "foot" => (Vec3::new(0.05, -0.02, -0.12), Vec3::new(0.35, 0.25, 0.26)),
        _ => (Human::LOW, Human::HIGH),
    };
    let mut net = polygonize(&field, low, high, cell);
    net.keep_largest();
    net.project(&field, 0..3, cell);
    net
}

fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for p in &mesh.positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for t in &mesh.triangles {
        let _ = writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    text
}

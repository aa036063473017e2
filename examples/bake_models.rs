//! Meshes the scenes of Fig. 7 into `assets/gallery/models/*.glb`: `cargo run --release --example bake_models [NAME…]`.

use std::path::Path;

use homunculus::gallery::baked::to_glb;
use homunculus::gallery::models::figures;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let folder = Path::new("assets/gallery/models");
    for figure in figures().iter().filter(|f| wanted.is_empty() || wanted.iter().any(|name| name == f.name)) {
        let mesh = (figure.solid)().mesh(figure.cell);
        std::fs::write(folder.join(figure.name).with_extension("glb"), to_glb(&mesh))?;
        eprintln!("{}: {} vertices, {} triangles", figure.name, mesh.positions.len(), mesh.triangles.len());
    }
    Ok(())
}

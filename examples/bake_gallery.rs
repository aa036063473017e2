//! Meshes the gallery's implicit models.
use homunculus::gallery::human::Human;
use homunculus::gallery::implicit::{polygonize, remesh, Remesh, Mesh};
use glam::Vec3;
fn save(mesh: &Mesh, path: &str) {
    let mut s = String::new();
    for p in &mesh.positions { s += &format!("v {} {} {}\n", p.x, p.y, p.z); }
    for t in &mesh.triangles { s += &format!("f {} {} {}\n", t[0]+1, t[1]+1, t[2]+1); }
    std::fs::write(path, s).unwrap();
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let cell: f32 = a[1].parse().unwrap();
    let h = Human::default();
    let field = |p: Vec3| h.distance(p);
    let t = std::time::Instant::now();
    let (lo, hi) = match a.get(3).map(String::as_str) {
        Some("head") => (Vec3::new(-0.11, 1.47, -0.12), Vec3::new(0.11, 1.78, 0.16)),
        Some("hand") => (Vec3::new(0.45, 0.70, -0.1), Vec3::new(0.75, 1.05, 0.14)),
        Some("foot") => (Vec3::new(0.05, -0.02, -0.12), Vec3::new(0.35, 0.25, 0.26)),
        _ => (Human::LOW, Human::HIGH),
    };
    let mut m = polygonize(&field, lo, hi, cell);
    eprintln!("net {} {:?}", m.triangles.len(), t.elapsed());
    m.keep_largest();
    m.project(&field, 0..3, 0.8*cell);
    if a.get(3).map(String::as_str) == Some("full") {
        m = remesh(&m, &field, &|p| h.edge_length(p), Remesh { rounds: 5, reach: 0.003 });
    }
    eprintln!("{} tris {} verts {:?} vol {}", m.triangles.len(), m.positions.len(), t.elapsed(), m.signed_volume()/6.0);
    save(&m, &a[2]);
}

//! What several contracts need.
#![allow(dead_code, clippy::print_stdout, reason = "each test file uses its own part; skipping is said aloud")]

use std::path::{Path, PathBuf};
use std::process::Command;

use glam::{DVec3, IVec3, Vec3A};
use homunculus::{
    Result,
    boundary::{Boundary, Regions},
    importance::{Field, Layer, Stack},
    picture::{self, Cut, Picture},
    run::{self, Observer, Outcome, Progress},
    settings::Settings,
    voxel::{Complex, Flat, Grid},
};

/// The folder of real inputs beside the checkout, or `None` with a word where it is not.
pub fn shared(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(folder);
    if !path.is_dir() {
        println!("skipped: no {} beside the checkout", path.display());
        return None;
    }
    Some(path)
}

/// All files of a folder that a reader could take, in order of their names.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("readable folder")
        .map(|entry| entry.expect("entry").path())
        .filter(|p| p.extension().is_some_and(|e| ["obj", "ply", "stl", "off", "glb", "gltf"].iter().any(|x| e == *x)))
        .collect();
    files.sort();
    files
}

/// A number from the environment, or the default.
pub fn number<T: std::str::FromStr>(name: &str, default: T) -> T {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

/// Triangles that pass through others, counted by an independent program; `None` where it is not installed.
pub fn self_intersections(boundary: &Boundary) -> Option<usize> {
    let folder = tempfile::tempdir().ok()?;
    let path = folder.path().join("surface.obj");
    let mut text: String = boundary.positions.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
    text.extend(boundary.triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1)));
    std::fs::write(&path, text).ok()?;
    let script =
        "import sys, meshlib.mrmeshpy as m\nprint(m.findSelfCollidingTrianglesBS(m.loadMesh(sys.argv[1])).count())";
    let output = Command::new("python3").args(["-c", script]).arg(&path).output().ok()?;
    String::from_utf8(output.stdout).ok()?.trim().parse().ok()
}

/// Watches nothing, stops never.
pub struct Quiet;

impl Observer for Quiet {
    fn progress(&self, _: &Progress) {}
    fn cancelled(&self) -> bool {
        false
    }
}

/// SplitMix64, so that a seed means the same field for ever.
pub struct Random(pub u64);

impl Random {
    /// In 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Spheres on the surface with values spread evenly in the logarithm over `low..=high`.
    pub fn layers(&mut self, boundary: &Boundary, count: usize, low: f64, high: f64) -> Vec<Layer> {
        let (min, max) = boundary.bounds().expect("bounds");
        let longest = (max - min).max_element();
        (0..count)
            .map(|_| {
                let triangle = boundary.triangles[(self.unit() * boundary.triangles.len() as f64) as usize];
                let centre: DVec3 = boundary.positions[triangle[0] as usize];
                Layer::Sphere {
                    centre: centre.to_array(),
                    radius: longest * (0.15 + 0.35 * self.unit()),
                    value: (low.ln() + (high / low).ln() * self.unit()).exp() as f32,
                }
            })
            .collect()
    }
}

/// Warps with layers over importance 1.
pub fn warp(boundary: &Boundary, layers: &[Layer], resolution: u32, fidelity: f32) -> Result<Outcome> {
    let stack = Stack::load(layers, 1.0, false, boundary, Path::new(""))?;
    let settings = Settings { resolution, fidelity, keys: 8, reference: None };
    run::warp(boundary, &stack, &settings, &Quiet)
}

/// A closed box.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let at = |k: usize| DVec3::from_array(std::array::from_fn(|a| if k >> a & 1 == 0 { low[a] } else { high[a] }));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(at).collect(), triangles)
}

/// Several closed boxes as one boundary.
pub fn cuboids(name: &str, boxes: &[([f64; 3], [f64; 3])]) -> Boundary {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for &(low, high) in boxes {
        let (p, t) = cuboid(low, high);
        let first = positions.len() as u32;
        positions.extend(p);
        triangles.extend(t.iter().map(|t| t.map(|v| v + first)));
    }
    Boundary::from_triangles(name, positions, triangles)
}

/// The map of the states of the USA, whose population shall become area, if it is there.
pub fn states() -> Option<(Picture, Field)> {
    let [images, facts] = ["images", "facts"].map(shared);
    let [map, ids, facts] =
        [images.as_ref()?.join("us_states.png"), images?.join("us_states_id.png"), facts?.join("us_states.csv")];
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("population.csv");
    let text = std::fs::read_to_string(facts).expect("a table");
    let rows = text.lines().filter(|line| line.chars().next().is_some_and(|c| c.is_ascii_digit()));
    let rows = rows.map(|line| line.split(',').take(3).collect::<Vec<_>>().join(","));
    std::fs::write(&table, format!("region,name,value\n{}\n", rows.collect::<Vec<_>>().join("\n"))).expect("written");

    let picture = picture::read(&map, &Cut::default()).expect("a picture");
    let layer = Layer::Regions { regions: ids, values: table, per_area: true };
    let field = Field::load(&[layer], 1.0, false, &picture, Path::new("")).expect("a field");
    Some((picture, field))
}

/// A picture as the solver takes it.
pub fn flat(picture: &Picture, field: &Field) -> Flat {
    let regions = field.regions.as_ref();
    Flat {
        name: "test".into(),
        size: picture.size,
        inside: picture.domain.clone(),
        importance: field.values.clone(),
        regions: regions.map(|r| Regions { names: r.names.clone(), of_vertex: r.of_pixel.clone() }),
    }
}

/// The complex of the cells for which `inside` holds.
pub fn complex(size: IVec3, inside: impl Fn(IVec3) -> bool) -> Complex {
    let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: size.as_uvec3() };
    let cell = |k: i32| IVec3::new(k % size.x, k / size.x % size.y, k / size.x / size.y);
    let cells: Vec<bool> = (0..size.element_product()).map(|k| inside(cell(k))).collect();
    Complex::from_cells(grid, &cells)
}

/// A body of one cell, shrunk to a tenth, just below a box two cells thick.
pub fn mote() -> (Complex, Vec<Vec3A>) {
    let complex = complex(IVec3::new(3, 3, 4), |c| c.z >= 2 || c == IVec3::new(1, 1, 0));
    let positions = complex.rest.iter().zip(&complex.body).map(|(p, &body)| {
        if body == complex.body[0] { (*p - Vec3A::new(1.5, 1.5, 0.0)) * 0.1 + Vec3A::new(1.5, 1.5, 1.85) } else { *p }
    });
    let positions = positions.collect();
    (complex, positions)
}

/// The mote moved up by so many cells.
pub fn lifted(complex: &Complex, positions: &[Vec3A], by: f32) -> Vec<Vec3A> {
    let up = |body: u32| if body == complex.body[0] { Vec3A::Z * by } else { Vec3A::ZERO };
    positions.iter().zip(&complex.body).map(|(p, &body)| *p + up(body)).collect()
}

//! What the benches measure on: a human with growing hands and head.
#![allow(dead_code, reason = "each bench uses its own part")]

use std::path::Path;

use glam::DVec3;
use homunculus::{
    boundary::{self, Boundary},
    importance::{Layer, Sampling, Stack},
    voxel::Complex,
};

/// Cells along the longest axis, where the command line names no others.
pub const RESOLUTIONS: [u32; 3] = [32, 64, 128];

/// Radius of the spheres at the hands and at the head, in heights of the figure.
const RADII: [f64; 2] = [0.22, 0.15];

/// Importance at the hands and at the head.
const VALUES: [f32; 2] = [2.5, 2.0];

/// Who is warped, and how.
pub struct Subject {
    /// The surface.
    pub boundary: Boundary,
    /// Both hands and the head.
    pub layers: Vec<Layer>,
}

impl Subject {
    /// The human beside the checkout, or where there is none a figure of boxes. Says which on stderr.
    pub fn new() -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/meshes/smpl_human_man.obj");
        let boundary = if path.is_file() {
            boundary::read(&path).expect("a readable mesh")
        } else {
            eprintln!("no {} beside the checkout: a figure of boxes instead", path.display());
            block_figure()
        };
        eprintln!("subject: {}, {} triangles", boundary.name, boundary.triangles.len());
        let layers = hands_and_head(&boundary);
        Self { boundary, layers }
    }

    /// Importance of the subject with `more` layers on top.
    pub fn importance(&self, more: &[Layer]) -> Stack {
        let layers = [&self.layers, more].concat();
        Stack::load(&layers, 1.0, false, &self.boundary, Path::new("")).expect("importance")
    }

    /// `[nodes]` importance with `more` layers on top.
    pub fn node_importance(&self, complex: &Complex, more: &[Layer]) -> Vec<f32> {
        let sampling = Sampling::new(&self.boundary, complex);
        sampling.spread(complex, &self.importance(more).evaluate(&self.boundary, &sampling.samples))
    }

    /// What a brush adds in one place: a small dab on a foot.
    pub fn dab(&self) -> Layer {
        sphere(lowest(&self.boundary, DVec3::Y), 0.05 * height(&self.boundary), 1.5)
    }
}

fn hands_and_head(boundary: &Boundary) -> Vec<Layer> {
    let height = height(boundary);
    let at = |direction, part: usize| sphere(lowest(boundary, direction), RADII[part] * height, VALUES[part]);
    vec![at(DVec3::X, 0), at(-DVec3::X, 0), at(-DVec3::Y, 1)]
}

fn sphere(centre: DVec3, radius: f64, value: f32) -> Layer {
    Layer::Sphere { centre: centre.to_array(), radius, value }
}

fn height(boundary: &Boundary) -> f64 {
    let (low, high) = boundary.bounds().expect("bounds");
    high.y - low.y
}

/// The vertex that lies least far along `direction`.
fn lowest(boundary: &Boundary, direction: DVec3) -> DVec3 {
    let along = |p: &DVec3| p.dot(direction);
    boundary.positions.iter().copied().min_by(|a, b| along(a).total_cmp(&along(b))).expect("vertices")
}

/// Nine boxes that overlap, arms held out: [low, high] in a height of 1.8.
fn block_figure() -> Boundary {
    let boxes = [
        ([-0.18, 0.85, -0.10], [0.18, 1.45, 0.10]),
        ([-0.05, 1.40, -0.05], [0.05, 1.58, 0.05]),
        ([-0.09, 1.55, -0.11], [0.09, 1.80, 0.11]),
        ([0.15, 1.34, -0.05], [0.72, 1.44, 0.05]),
        ([-0.72, 1.34, -0.05], [-0.15, 1.44, 0.05]),
        ([0.70, 1.36, -0.06], [0.90, 1.42, 0.06]),
        ([-0.90, 1.36, -0.06], [-0.70, 1.42, 0.06]),
        ([0.04, 0.00, -0.08], [0.17, 0.90, 0.08]),
        ([-0.17, 0.00, -0.08], [-0.04, 0.90, 0.08]),
    ];
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (low, high) in boxes {
        let first = positions.len() as u32;
        positions.extend((0..8_usize).map(|k| {
            DVec3::from_array(std::array::from_fn(|axis| if k >> axis & 1 == 0 { low[axis] } else { high[axis] }))
        }));
        for quad in quads {
            let [a, b, c, d] = quad.map(|corner: u32| first + corner);
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Boundary::from_triangles("block_figure", positions, triangles)
}

/// Resolutions named on the command line, or all.
pub fn resolutions() -> Vec<u32> {
    let named: Vec<u32> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    if named.is_empty() { RESOLUTIONS.to_vec() } else { named }
}

/// Seconds as people say them.
pub fn human_seconds(seconds: f64) -> String {
    match seconds {
        s if s >= 100.0 => format!("{s:.0} s"),
        s if s >= 1.0 => format!("{s:.2} s"),
        s if s >= 1.0e-3 => format!("{:.1} ms", 1.0e3 * s),
        s => format!("{:.1} µs", 1.0e6 * s),
    }
}

/// Rows with a name, columns right-aligned under their heads.
pub struct Table {
    rows: Vec<(String, Vec<String>)>,
}

impl Table {
    /// A table with these heads over its columns.
    pub fn new(name: &str, heads: impl IntoIterator<Item = String>) -> Self {
        Self { rows: vec![(name.into(), heads.into_iter().collect())] }
    }

    /// Adds a row.
    pub fn row(&mut self, name: &str, columns: impl IntoIterator<Item = String>) {
        self.rows.push((name.into(), columns.into_iter().collect()));
    }
}

impl std::fmt::Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = self.rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        for (head, columns) in &self.rows {
            write!(f, "{head:name$}")?;
            for column in columns {
                write!(f, " {column:>12}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

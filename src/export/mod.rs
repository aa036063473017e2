//! Results out: the boundary with other positions, in any mesh format; its growth as a film in one GLB.
//!
//! # What is kept
//!
//! Vertices and faces keep their order; polygons stay polygons where the format has them. Texture coordinates, colours,
//! materials, textures and named attributes go along as far as the format can hold them. A file written in the format it was
//! read from is the same file with other numbers: an OBJ line by line, a PLY property by property.
//!
//! Normals are computed anew from the warped triangles, with hard edges where the input had them.
//!
//! # What is not
//!
//! glTF scenes come out flat: world positions below nodes without transform, no skins, cameras, lights or animations. Only shapes
//! far from the origin, which single precision cannot tell there, have a translation at their nodes.
//!
//! # What comes after the input's
//!
//! Where long triangles are in pieces ([`crate::boundary::split_long`]) each format has the vertices of the input first, and the
//! pieces of a face where that stood. An STL has no vertices but corners; in a GLB with several objects each has its own, first
//! those of the input.

mod glb;
mod growth;
mod library;
pub(crate) mod normals;
mod obj;
mod obj_pieces;
mod off;
mod off_pieces;
mod ply;
mod ply_pieces;
mod precision;
pub mod report;
mod stl;
pub(crate) mod table;

use std::io::Write as _;
use std::path::Path;

use glam::DVec3;

use crate::boundary::Boundary;
use crate::boundary::source::srgb_from_linear;
use crate::error::{Error, Result};
use crate::file::write_atomically;
use crate::format::{Kind, Use};
pub use growth::{GrowthFrame, growth};

/// What the writers of all formats are given.
pub(crate) struct Surface<'a> {
    /// As it was read.
    pub boundary: &'a Boundary,
    /// `[vertices]` where its vertices are now, source units.
    pub positions: &'a [DVec3],
    /// `[vertices]` linear RGB which replaces the colours and materials of the input.
    pub colours: Option<&'a [[f32; 3]]>,
}

/// Writes the boundary with other positions, in the format that the extension of `path` names: glb, obj, ply, stl or off.
///
/// `positions`: `[vertices]`, finite, source units. `colours`: `[vertices]` linear RGB in 0..=1, shown instead of the colours
/// and materials of the input; STL has no colours and leaves them out.
///
/// An OBJ brings its material library and textures along, beside it.
///
/// # Errors
///
/// [`Error::Input`] for another extension, or positions that the format cannot hold; [`Error::File`] where the system refuses.
/// Nothing is left under the final name then.
pub fn mesh(boundary: &Boundary, positions: &[DVec3], colours: Option<&[[f32; 3]]>, path: &Path) -> Result<()> {
    let surface = Surface { boundary, positions, colours };
    surface.check()?;
    let what = Use::Result(Kind::Body);
    let bytes = match what.of(path) {
        Some("glb") => glb::write(&surface, path)?,
        Some("obj") => obj::write(&surface, path)?,
        Some("ply") => ply::write(&surface),
        Some("stl") => stl::write(&surface, path)?,
        Some("off") => off::write(&surface),
        _ => {
            let sentence = format!("meshes are written as {}; choose one of these", what.listed());
            return Err(Error::in_file(path, sentence));
        }
    };
    write_atomically(path, |file| file.write_all(&bytes))
}

impl Surface<'_> {
    /// What only a fault of this program could break.
    fn check(&self) -> Result<()> {
        let count = self.boundary.positions.len();
        if self.positions.len() != count || self.colours.is_some_and(|c| c.len() != count) {
            return Err(Error::Fault(format!("{} positions to write for {count} vertices", self.positions.len())));
        }
        match self.positions.iter().position(|p| !p.is_finite()) {
            Some(vertex) => Err(Error::Fault(format!("vertex {vertex} to write is no place"))),
            None => Ok(()),
        }
    }

    /// `[vertices]` linear RGBA to be shown, if any.
    fn tints(&self) -> Option<Vec<[f32; 4]>> {
        match self.colours {
            Some(colours) => Some(colours.iter().map(|&[r, g, b]| [r, g, b, 1.0].map(unit)).collect()),
            None => self.boundary.base_colours(),
        }
    }

    /// Polygons as in the file; the triangles where there are none.
    fn polygons(&self) -> impl Iterator<Item = &[u32]> {
        let polygons = &self.boundary.source.polygons;
        let triangles: &[[u32; 3]] = if polygons.len() == 0 { &self.boundary.triangles } else { &[] };
        (0..polygons.len())
            .map(|i| &polygons.corners[polygons.range(i)])
            .chain(triangles.iter().map(<[u32; 3]>::as_slice))
    }
}

/// Into 0..=1; 1 for what is not a number.
fn unit(value: f32) -> f32 {
    if value.is_nan() { 1.0 } else { value.clamp(0.0, 1.0) }
}

/// Linear RGBA in 0..=1 as sRGB.
fn srgb(colour: [f32; 4]) -> [f32; 4] {
    let [r, g, b, a] = colour;
    [srgb_from_linear(r), srgb_from_linear(g), srgb_from_linear(b), a]
}

/// 0..=1 as a byte.
fn byte(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

/// The shortest text that reads back as the same number: of a single where the value is one exactly, else of the double.
/// Very large and small ones have an exponent, which every reader takes.
pub(crate) fn number(value: f64) -> String {
    let single = value as f32;
    let is_plain = value == 0.0 || (1e-7..1e16).contains(&value.abs());
    match (f64::from(single) == value, is_plain) {
        (true, true) => format!("{single}"),
        (true, false) => format!("{single:e}"),
        (false, true) => format!("{value}"),
        (false, false) => format!("{value:e}"),
    }
}

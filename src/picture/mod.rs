//! Pictures around the method: decoding, what of a picture is the body, importance per pixel, and the warped picture drawn.
//!
//! Everything here is in pixels, x to the right, y **down**; pixel (i, j) covers the square [i, i+1] × [j, j+1]. Nothing
//! here knows how a mesh is warped: [`FlatMesh`] and a place for each of its vertices are all that is asked for.
//!
//! | part | section | what |
//! |---|---|---|
//! | [`read()`] | 3.2 | a file becomes a [`Picture`]: its pixels, and its domain by alpha or by a background cut out |
//! | [`render`] | 3.5 | the inverse map, filtered: the warped picture |
//! | [`animate`] | – | growth as APNG or GIF |

pub mod animate;
mod cut;
mod locate;
mod pieces;
mod pixels;
pub(crate) mod read;
pub mod render;

use glam::{DVec2, UVec2};

pub use cut::{Background, Cut};
pub(crate) use locate::Affine;
pub(crate) use pieces::pieces;
pub use pixels::Pixels;
pub use read::{MAX_PIXELS, is_picture, read, read_bytes};

/// A picture and what of it is the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// For messages: the file's name, or the scene's.
    pub name: String,
    /// Width and height in pixels, each at least 2.
    pub size: UVec2,
    /// `[height × width]` row by row from the top.
    pub pixels: Pixels,
    /// `[height × width]` whether the pixel belongs to the body (3.2): opaque enough, and not cut out.
    pub domain: Vec<bool>,
    /// The file's ICC profile, which goes along into what is written.
    pub profile: Option<Vec<u8>>,
    /// Sentences for the user about what was taken otherwise than it stands in the file.
    pub warnings: Vec<String>,
}

/// A triangulation of the plane: the lattice's cells as triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FlatMesh {
    /// `[vertices]` places at rest, pixels.
    pub rest: Vec<DVec2>,
    /// `[triangles]` corners; either orientation.
    pub triangles: Vec<[u32; 3]>,
}

impl Picture {
    /// What is drawn of the picture: the body with its smoothed rim, all else transparent.
    pub fn body_pixels(&self) -> Pixels {
        let mut pixels = self.pixels.clone();
        let seen = render::seen(&self.domain, self.size);
        (0..seen.len()).filter(|&index| !seen[index]).for_each(|index| pixels.set_wide(index, [0; 4]));
        pixels
    }

    /// [`Self::body_pixels`] as a PNG, for the mesh that the picture is drawn on.
    ///
    /// # Errors
    /// A fault where the encoder refuses.
    pub fn body_png(&self) -> crate::Result<Vec<u8>> {
        let mut png = Vec::new();
        let written = self.body_pixels().write_png(&mut png, self.profile.as_deref());
        written.map_err(|e| crate::Error::Fault(format!("{}: as a texture: {e}", self.name)))?;
        Ok(png)
    }

    /// The pixels of the body.
    pub fn domain_area(&self) -> usize {
        self.domain.iter().filter(|inside| **inside).count()
    }
}

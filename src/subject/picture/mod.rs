//! Pictures, in the plane.

mod drawn;
mod portrait;

use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use image::RgbImage;

use super::{Colouring, Found, Grown, Inspected, Look, Stopped, Subject};
use crate::boundary::Boundary;
use crate::export;
use crate::export::report::{AreaReport, PictureReport};
use crate::format::{Kind, Use};
use crate::gallery::{self, picture::PictureScene};
use crate::importance::{Field, Stack};
use crate::paint::{Ground, PaintedPicture};
use crate::picture::{self, Cut, Picture, Pixels};
use crate::run::{self, Content, Outcome, Solved};
use crate::scene::{Scene, Source};
use crate::voxel::{Flat, check_flat_resolution};
use crate::{Error, Result};
use drawn::{Drawn, crossings};

/// A picture that is not read yet.
struct Unread {
    /// As the source is written.
    name: String,
    content: Unopened,
}

enum Unopened {
    /// A file's bytes.
    Bytes(Vec<u8>),
    /// A built-in one.
    BuiltIn(Box<PictureScene>),
}

/// By so many bytes a picture is recognised.
const MAGIC_BYTES: u64 = 64;

/// The picture a source is, if it is one; a file is told by its content.
pub(super) fn find(source: &Source) -> Result<Option<Box<dyn Found>>> {
    let content = match source {
        Source::Gallery(_) if source.kind() != Kind::Picture => return Ok(None),
        Source::Gallery(name) => Unopened::BuiltIn(Box::new(gallery::picture::open(name)?)),
        // What cannot be read is told by the reader of meshes, which knows more about it.
        Source::File(path) if !begins_as_picture(path) => return Ok(None),
        Source::File(path) => Unopened::Bytes(std::fs::read(path).map_err(|e| Error::reading(path, e))?),
    };
    Ok(Some(Box::new(Unread { name: source.to_string(), content })))
}

fn begins_as_picture(path: &Path) -> bool {
    let file = File::open(path).and_then(|file| match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(ErrorKind::IsADirectory.into()),
    });
    let mut start = Vec::new();
    file.is_ok_and(|file| file.take(MAGIC_BYTES).read_to_end(&mut start).is_ok()) && picture::is_picture(&start)
}

impl Unread {
    /// The picture, cut out of its background (`COLOUR,TOLERANCE`), and the importance a built-in one brings.
    fn read(self, background: Option<&str>) -> Result<(Picture, Option<Field>)> {
        let background = background.map(str::parse).transpose();
        let background = background.map_err(|sentence: String| Error::input(format!("--background: {sentence}")))?;
        Ok(match self.content {
            Unopened::Bytes(bytes) => {
                (picture::read_bytes(&self.name, &bytes, &Cut { background, ..Cut::default() })?, None)
            }
            Unopened::BuiltIn(built_in) => (built_in.picture, Some(built_in.field)),
        })
    }
}

impl Found for Unread {
    fn kind(&self) -> Kind {
        Kind::Picture
    }

    fn open(self: Box<Self>, scene: &Scene) -> Result<Arc<dyn Subject>> {
        let name = self.name.clone();
        let (picture, own) = self.read(scene.background.as_deref())?;
        let field = field(scene, &picture, own.as_ref())?;
        let ground = Ground::new(&name, picture, own.map(Arc::new), field)?;
        Ok(Arc::new(PaintedPicture { ground, differences: Vec::new() }))
    }

    fn inspect(self: Box<Self>, background: Option<&str>, resolution: u32) -> Result<Inspected> {
        check_flat_resolution(resolution)?;
        let name = self.name.clone();
        let (picture, own) = self.read(background)?;
        let flat = Flat { name, size: picture.size, inside: picture.domain.clone(), ..Flat::default() };
        let (boundary, input, domain) = run::inspect_picture(&flat, resolution)?;
        let report = PictureReport {
            width: picture.size.x,
            height: picture.size.y,
            bits: if matches!(picture.pixels, Pixels::Sixteen(_)) { 16 } else { 8 },
            domain_pixels: picture.domain_area(),
            has_profile: picture.profile.is_some(),
            regions: own.and_then(|field| field.regions).map_or_else(Vec::new, |regions| regions.names),
        };
        Ok(Inspected { boundary, input, domain, picture: Some(report), warnings: picture.warnings })
    }
}

/// What a scene's layers say of a picture. Importance that is given takes the place of a built-in picture's own.
fn field(scene: &Scene, picture: &Picture, own: Option<&Field>) -> Result<Field> {
    let layers = scene.shown_layers();
    match own.filter(|_| layers.is_empty()) {
        Some(field) => Ok(field.clone()),
        None => Field::load(&layers, scene.base, scene.clamp, picture, Path::new("")),
    }
}

impl Subject for PaintedPicture {
    fn kind(&self) -> Kind {
        Kind::Picture
    }

    fn warnings(&self) -> Vec<String> {
        [&self.ground.picture.warnings[..], &self.ground.field.warnings].concat()
    }

    fn clamped(&self) -> usize {
        self.ground.field.clamped
    }

    fn unchanged(&self) -> &'static str {
        "no importance was given, so the picture stays as it is; see --sphere and --regions"
    }

    fn content(&self) -> Content {
        Content::Picture(self.flat())
    }

    fn surface(&self) -> &Arc<Boundary> {
        &self.ground.mesh
    }

    fn stack(&self) -> Arc<Stack> {
        Arc::new(self.ground.stack())
    }

    fn painted(&self, differences: Vec<f64>) -> Arc<dyn Subject> {
        Arc::new(Self { ground: self.ground.clone(), differences })
    }

    fn with_layers(&self, scene: &Scene) -> Result<Arc<dyn Subject>> {
        let field = field(scene, &self.ground.picture, self.ground.own.as_deref())?;
        Ok(Arc::new(Self { ground: self.ground.with_field(field), differences: Vec::new() }))
    }

    fn carried(&self, values: &[f64], to: &Boundary) -> Option<Vec<f64>> {
        Some(self.ground.carried(values, to))
    }

    fn vertex_at(&self, place: DVec3) -> Option<u32> {
        Some(self.ground.vertex_at(place))
    }

    fn drawn(&self, boundary: &Arc<Boundary>) -> Result<Arc<Boundary>> {
        let (name, texture) = (&self.ground.picture.name, self.ground.texture()?.to_vec());
        Ok(Arc::new(Boundary::clone(boundary).with_texture(name, texture)))
    }

    fn asked(&self, _: &Outcome) -> Vec<f32> {
        let flat = self.flat();
        flat.importance.iter().zip(&flat.inside).filter(|(_, inside)| **inside).map(|(f, _)| *f).collect()
    }

    fn areas(&self, grown: &Grown) -> Option<AreaReport> {
        Drawn::new(&self.ground.picture, grown).areas(&self.field(), grown.complex.grid.cell_size)
    }

    fn write_result(&self, grown: &Grown, look: &Look, path: &Path) -> Result<()> {
        check(path, Use::Result(Kind::Picture), "a warped picture")?;
        let picture = &self.ground.picture;
        let crossings = crossings(grown.complex, grown.last, f64::from(picture.size.y));
        Drawn::new(picture, grown).write_picture(path, look.scale, &crossings)
    }

    fn write_growth(&self, grown: &Grown, look: &Look, path: &Path, stopped: Stopped) -> Result<()> {
        match check(path, Use::Growth(Kind::Picture), "the growth of a picture")? {
            "glb" => {
                // Colours would hide the picture: the growth is the picture's own.
                let colours = grown.colours(look.coloured.unwrap_or(false));
                let boundary = self.drawn(grown.boundary)?;
                export::growth(&boundary, &grown.frames(), colours.as_deref(), look.seconds, path, stopped)
            }
            format => {
                let drawn = Drawn::new(&self.ground.picture, grown);
                drawn.write_animation(path, format == "gif", look.scale, look.seconds, stopped)
            }
        }
    }

    fn portraits(&self, solved: &Solved, side: u32, colour: Colouring) -> Option<Result<[RgbImage; 4]>> {
        Some(portrait::all(self, solved, side, colour))
    }
}

/// The format of a name that is such a file's.
fn check(path: &Path, what: Use, words: &str) -> Result<&'static str> {
    what.of(path).ok_or_else(|| Error::in_file(path, format!("{words} is written as {}", what.listed())))
}

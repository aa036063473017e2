//! Built-in pictures in the spirit of the paper's Fig. 6, drawn here by `examples/draw_gallery`.
//!
//! In each, what grows would run into its neighbours if it were only scaled or smoothly deformed.

use std::path::Path;

use super::Entry;
use crate::error::{Error, Result};
use crate::format::Kind;
use crate::importance::{Field, Layer};
use crate::picture::{Cut, Picture, read_bytes};

/// A picture ready to be warped.
#[derive(Debug, Clone)]
pub struct PictureScene {
    /// Its pixels and its body.
    pub picture: Picture,
    /// Importance of each pixel, and the regions it came from.
    pub field: Field,
    /// What the list says of it, with the suggested resolution and fidelity.
    pub entry: Entry,
}

/// Where importance comes from.
enum Source {
    /// A picture of region ids and a table; whether its values shall become area.
    Regions { ids: &'static [u8], table: &'static [u8], per_area: bool },
    /// Centre and radius in pixels, and importance in the middle.
    Discs(&'static [([f64; 2], f64, f32)]),
}

/// A scene as it is kept.
struct Kept {
    entry: Entry,
    picture: &'static [u8],
    /// Importance of all else.
    base: f32,
    source: Source,
}

macro_rules! asset {
    ($name:literal) => {
        include_bytes!(concat!("../../../assets/gallery/picture/", $name))
    };
}

static SCENES: [Kept; 4] = [
    Kept {
        entry: Entry {
            name: "africa",
            kind: Kind::Picture,
            one_line: "a map of Africa whose countries have the area of their population",
            reference: "importance ∝ (population / area)^(1/2), so that area becomes population; population 2014: World Bank, World Development Indicators, SP.POP.TOTL (no figure for Eritrea and Western \
                        Sahara, which keep their size); outlines after Natural Earth 1:110m, public domain",
            resolution: 160,
            fidelity: 1.0,
            camera: [0.0, 0.0],
        },
        picture: asset!("africa.png"),
        base: 1.0,
        source: Source::Regions {
            ids: asset!("africa_id.png"),
            table: asset!("africa_population_2014.csv"),
            per_area: false,
        },
    },
    Kept {
        entry: Entry {
            name: "magnet",
            kind: Kind::Picture,
            one_line: "a horseshoe magnet whose steel tips grow until they meet",
            reference: "after the magnet in Fig. 6 of the paper; drawn here",
            resolution: 192,
            fidelity: 1.0,
            camera: [0.0, 0.0],
        },
        picture: asset!("magnet.png"),
        base: 0.9,
        source: Source::Discs(&[([190.0, 752.0], 190.0, 3.6), ([570.0, 752.0], 190.0, 3.6)]),
    },
    Kept {
        entry: Entry {
            name: "crocodile",
            kind: Kind::Picture,
            one_line: "a crocodile whose teeth grow until they fill its open jaws",
            reference: "after the crocodile in Fig. 6 of the paper; drawn here",
            resolution: 384,
            fidelity: 1.0,
            camera: [0.0, 0.0],
        },
        picture: asset!("crocodile.png"),
        base: 0.95,
        source: Source::Regions {
            ids: asset!("crocodile_id.png"),
            table: b"region,name,importance\n1,teeth,2.6\n",
            per_area: false,
        },
    },
    Kept {
        entry: Entry {
            name: "snake",
            kind: Kind::Picture,
            one_line: "a coiled snake whose swallowed prey grows between the turns of its body",
            reference: "after the snake in Fig. 6 of the paper; drawn here",
            resolution: 192,
            fidelity: 1.0,
            camera: [0.0, 0.0],
        },
        picture: asset!("snake.png"),
        base: 0.95,
        source: Source::Discs(&[([371.0, 349.0], 150.0, 2.8)]),
    },
];

/// The built-in pictures.
pub fn list() -> impl Iterator<Item = Entry> {
    SCENES.iter().map(|scene| scene.entry)
}

/// Opens a picture by name.
///
/// # Errors
/// An unknown name: the sentence lists the known ones. A fault of this program when a baked file is damaged.
pub fn open(name: &str) -> Result<PictureScene> {
    let Some(scene) = SCENES.iter().find(|scene| scene.entry.name == name) else {
        let names: Vec<&str> = list().map(|entry| entry.name).collect();
        return Err(Error::input(format!("the gallery has no picture `{name}`; it has {}", names.join(", "))));
    };
    let damaged = |error: Error| Error::Fault(format!("the built-in picture `{name}` cannot be opened: {error}"));
    let picture = read_bytes(name, scene.picture, &Cut::default()).map_err(damaged)?;
    let field = match &scene.source {
        Source::Regions { ids, table, per_area } => {
            Field::of_regions(&picture, scene.base, ("its regions", ids), ("its table", table), *per_area)
        }
        Source::Discs(discs) => {
            let disc =
                |&([x, y], radius, value): &([f64; 2], f64, f32)| Layer::Sphere { centre: [x, y, 0.0], radius, value };
            let layers: Vec<Layer> = discs.iter().map(disc).collect();
            Field::load(&layers, scene.base, false, &picture, Path::new(""))
        }
    };
    Ok(PictureScene { field: field.map_err(damaged)?, picture, entry: scene.entry })
}

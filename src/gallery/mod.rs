//! Built-in scenes, modelled here: no download, no foreign mesh.
//!
//! [`list`] names them, [`open`] gives a scene ready to be warped, [`with_values`] gives a model's importance from a
//! user's own table. The surfaces are baked in `assets/gallery`; [`human`], [`models`] and [`implicit`]
//! made them.

pub mod baked;
pub mod human;
pub mod implicit;
pub mod models;
pub mod picture;
pub mod thumbnails;

use std::sync::OnceLock;

use glam::Vec3;
use rayon::prelude::*;

use crate::boundary::{Boundary, Regions};
use crate::error::{Error, Result};
use crate::format::Kind;
use implicit::Mesh;

/// A model of the gallery: its surface and which vertex belongs how much to which region.
#[derive(Debug, Clone)]
pub struct Model {
    /// The surface, metres, Y up; `regions` holds each vertex's largest membership.
    pub boundary: Boundary,
    /// `[vertices]` region and weight, in rising order of the region; the weights of a vertex sum to 1.
    pub memberships: Vec<Vec<(u16, f32)>>,
    /// Names of the regions.
    pub region_names: Vec<String>,
}

/// A line of the gallery's list.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// What to ask for.
    pub name: &'static str,
    /// What it is warped as.
    pub kind: Kind,
    /// What it is.
    pub one_line: &'static str,
    /// Where its numbers or its idea come from.
    pub reference: &'static str,
    /// Suggested number of cells along the longest side: fingers must not share cells.
    pub resolution: u32,
    /// Suggested μ in 0..=1.
    pub fidelity: f32,
    /// Degrees to the side (0 from the front, 90 from +X) and from above from where it is best seen; a picture is seen
    /// from the front.
    pub camera: [f32; 2],
}

/// A scene ready to be warped.
#[derive(Debug, Clone)]
pub struct GalleryScene {
    /// The model.
    pub model: Model,
    /// `[vertices]` importance: the linear size factor asked for, > 0.
    pub importance: Vec<f32>,
}

/// The bodies.
pub fn list() -> &'static [Entry] {
    static LIST: OnceLock<Vec<Entry>> = OnceLock::new();
    LIST.get_or_init(|| {
        let homunculi = human::scenes().iter().map(|s| Entry {
            name: s.scene,
            kind: Kind::Body,
            one_line: s.one_line,
            reference: s.reference,
            resolution: 96,
            fidelity: 0.8,
            camera: [20.0, 8.0],
        });
        let hand = Entry {
            name: "hand",
            kind: Kind::Body,
            one_line: "a spread hand whose fingertips ask for three times their size: a quick demonstration",
            reference: "modelled here",
            resolution: 64,
            fidelity: 0.8,
            camera: [20.0, 8.0],
        };
        let figures = models::figures().iter().map(|f| Entry {
            name: f.name,
            kind: Kind::Body,
            one_line: f.one_line,
            reference: f.reference,
            resolution: f.resolution,
            fidelity: f.fidelity,
            camera: f.camera,
        });
        homunculi.chain([hand]).chain(figures).collect()
    })
}

/// Bodies, then pictures.
pub fn everything() -> impl Iterator<Item = Entry> {
    list().iter().copied().chain(picture::list())
}

/// Opens a scene by name.
///
/// # Errors
/// An unknown name: the sentence lists the known ones.
pub fn open(name: &str) -> Result<GalleryScene> {
    if name == "hand" {
        let model = hand_model()?.clone();
        let values = hand_values(&model);
        let importance = with_values(&model, &values)?;
        return Ok(GalleryScene { model, importance });
    }
    if let Some(figure) = models::figures().iter().find(|f| f.name == name) {
        let model = figure.model()?;
        let importance = with_values(&model, &figure.values()?)?;
        return Ok(GalleryScene { model, importance });
    }
    let Some(table) = human::scenes().iter().find(|s| s.scene == name) else {
        let names: Vec<&str> = list().iter().map(|e| e.name).collect();
        return Err(Error::input(format!("the gallery has no scene `{name}`; it has {}", names.join(", "))));
    };
    let mut model = human_model()?.clone();
    model.boundary.name = name.into();
    let importance = with_values(&model, &table.values()?)?;
    Ok(GalleryScene { model, importance })
}

/// `[vertices]` importance of a model from `(region, importance)` rows: exp(Σ weight · ln importance), so that the
/// transition between two regions is even in ratio.
///
/// # Errors
/// One sentence for a region that the model does not have, one that is missing or twice, or a value that is not > 0.
pub fn with_values(model: &Model, values: &[(String, f64)]) -> Result<Vec<f32>> {
    let names = &model.region_names;
    let mut logs: Vec<Option<f64>> = vec![None; names.len()];
    for (region, value) in values {
        let Some(k) = names.iter().position(|n| n == region) else {
            return Err(Error::input(format!("there is no region `{region}`; the regions are {}", names.join(", "))));
        };
        if !(value.is_finite() && *value > 0.0) {
            return Err(Error::input(format!("the importance of `{region}` is {value}; it must be a number above 0")));
        }
        if logs[k].replace(value.ln()).is_some() {
            return Err(Error::input(format!("region `{region}` has two values; keep one")));
        }
    }
    let missing: Vec<&str> = names.iter().zip(&logs).filter(|(_, l)| l.is_none()).map(|(n, _)| n.as_str()).collect();
    if !missing.is_empty() {
        return Err(Error::input(format!("no value for {}; each region needs one row", missing.join(", "))));
    }
    let log = |k: u16| logs[k as usize].unwrap_or(0.0);
    let blend = |m: &Vec<(u16, f32)>| m.iter().map(|&(k, w)| f64::from(w) * log(k)).sum::<f64>().exp() as f32;
    Ok(model.memberships.iter().map(blend).collect())
}

/// The human, read and labelled once.
///
/// # Errors
/// A fault of this program when the baked asset is damaged.
pub fn human_model() -> Result<&'static Model> {
    static MODEL: OnceLock<Model> = OnceLock::new();
    remember(&MODEL, || {
        let mesh = baked::from_glb("human", include_bytes!("../../assets/gallery/human.glb"))?;
        let human = human::Human::default();
        Ok(label("human", &mesh, &human::NAMES, |p| human::memberships(&human, p)))
    })
}

/// A hand on a stump of forearm, read and labelled once. The hand's own frame: y to the fingers, z out of the palm.
///
/// # Errors
/// A fault of this program when the baked asset is damaged.
pub fn hand_model() -> Result<&'static Model> {
    static MODEL: OnceLock<Model> = OnceLock::new();
    remember(&MODEL, || {
        let mesh = baked::from_glb("hand", include_bytes!("../../assets/gallery/hand.glb"))?;
        let human = human::Human::default();
        let frame = human.arm.hand.frame;
        let all = label("hand", &mesh, &human::NAMES, |p| human::memberships(&human, frame.world(p)));
        Ok(only_used_regions(all))
    })
}

fn remember(cell: &'static OnceLock<Model>, make: impl FnOnce() -> Result<Model>) -> Result<&'static Model> {
    if let Some(model) = cell.get() {
        return Ok(model);
    }
    let model = make()?;
    Ok(cell.get_or_init(|| model))
}

fn label(
    name: &str,
    mesh: &Mesh,
    names: &[impl AsRef<str>],
    memberships: impl Fn(Vec3) -> Vec<(u16, f32)> + Sync,
) -> Model {
    let memberships: Vec<_> = mesh.positions.par_iter().map(|&p| memberships(p)).collect();
    let positions = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
    let mut boundary = Boundary::from_triangles(name, positions, mesh.triangles.clone());
    let region_names: Vec<String> = names.iter().map(|n| n.as_ref().to_owned()).collect();
    let largest =
        |m: &Vec<(u16, f32)>| m.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(u32::MAX, |k| u32::from(k.0));
    boundary.regions =
        Some(Regions { names: region_names.clone(), of_vertex: memberships.iter().map(largest).collect() });
    Model { boundary, memberships, region_names }
}

/// Drops the regions that no vertex belongs to.
fn only_used_regions(mut model: Model) -> Model {
    let used: Vec<u16> = (0..model.region_names.len() as u16)
        .filter(|k| model.memberships.iter().flatten().any(|m| m.0 == *k))
        .collect();
    let index = |k: u16| used.binary_search(&k).unwrap_or(0) as u16;
    model.memberships.iter_mut().flatten().for_each(|m| m.0 = index(m.0));
    model.region_names = used.iter().map(|&k| human::NAMES[k as usize].to_owned()).collect();
    if let Some(regions) = &mut model.boundary.regions {
        regions.names = model.region_names.clone();
        regions.of_vertex.iter_mut().for_each(|k| *k = u32::from(index(*k as u16)));
    }
    model
}

/// Fingertips 3, fingers 1, palm and wrist a little less: the contrast of the demonstration.
fn hand_values(model: &Model) -> Vec<(String, f64)> {
    let value = |name: &str| match name {
        n if n.ends_with("tip") => 3.0,
        n if n == "thumb" || n.ends_with("_finger") => 1.0,
        "palm" | "back_of_hand" => 0.9,
        _ => 0.8,
    };
    model.region_names.iter().map(|n| (n.clone(), value(n))).collect()
}

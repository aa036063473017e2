//! Contract of the gallery as a whole: every scene, body or picture, is certified in every frame at a low resolution, and at
//! its own resolution Eq. 1 alone makes it cross itself, which is what it is there to show. The scenes of Fig. 7 have more
//! said of them in `models.rs`.

mod common;

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use homunculus::boundary::{Attribute, Regions};
use homunculus::gallery::{self, Entry, models};
use homunculus::importance::{Layer, Stack};
use homunculus::voxel::Flat;
use homunculus::{
    run::{Domain, Outcome, solve},
    settings::{Reference, Settings},
};

/// Cells along the longest side, coarse: all of them together take half a minute.
const COARSE_BODY: u32 = 32;
const COARSE_PICTURE: u32 = 64;

fn is_picture(entry: &Entry) -> bool {
    gallery::picture::list().any(|picture| picture.name == entry.name)
}

/// The scene as the program warps it; `flatten` makes all of it keep its size.
fn domain(entry: &Entry, settings: Settings, flatten: bool) -> Domain {
    if is_picture(entry) {
        let scene = gallery::picture::open(entry.name).expect("a listed picture opens");
        let regions = scene.field.regions;
        let mut importance = scene.field.values;
        if flatten {
            importance.fill(1.0);
        }
        let flat = Flat {
            name: entry.name.into(),
            size: scene.picture.size,
            inside: scene.picture.domain,
            importance,
            regions: regions.filter(|_| !flatten).map(|r| Regions { names: r.names, of_vertex: r.of_pixel }),
        };
        return Domain::picture(Arc::new(flat), settings);
    }
    let scene = gallery::open(entry.name).expect("a listed scene opens");
    let mut boundary = scene.model.boundary;
    let values = if flatten { vec![1.0; scene.importance.len()] } else { scene.importance };
    boundary.attributes.push(Attribute { name: "importance".into(), values });
    let layers = [Layer::Attribute { name: "importance".into(), range: None }];
    let stack = Stack::load(&layers, 1.0, false, &boundary, Path::new("")).expect("the attribute is there");
    Domain::body(Arc::new(boundary), Arc::new(stack), settings)
}

fn warp(entry: &Entry, resolution: u32, reference: Option<Reference>, flatten: bool) -> Outcome {
    let settings = Settings { resolution, fidelity: entry.fidelity, keys: 3, reference };
    solve(domain(entry, settings, flatten), &common::Quiet).expect("it can be warped").outcome
}

/// What `models.rs` does not look at.
fn others() -> impl Iterator<Item = Entry> {
    gallery::everything().filter(|entry| models::figures().iter().all(|figure| figure.name != entry.name))
}

#[test]
fn all_scenes_are_here() {
    let names: Vec<&str> = gallery::everything().map(|entry| entry.name).collect();
    assert_eq!(names.len(), 17);
    assert_eq!(others().count(), 8);
    for (k, name) in names.iter().enumerate() {
        assert!(!names[..k].contains(name), "{name} is there twice");
    }
    for entry in gallery::everything() {
        let said = [entry.one_line, entry.reference];
        assert!(said.iter().all(|text| !text.is_empty() && !text.contains('\n')), "{}", entry.name);
        assert!(entry.camera[0].abs() <= 180.0 && entry.camera[1].abs() <= 89.0, "{}", entry.name);
    }
}

#[test]
fn each_scene_is_certified_in_every_frame() {
    for entry in others() {
        let start = Instant::now();
        let resolution = if is_picture(&entry) { COARSE_PICTURE } else { COARSE_BODY };
        let outcome = warp(&entry, resolution, None, false);
        assert!(outcome.frames.len() > 3, "{}", entry.name);
        for frame in &outcome.frames {
            assert!(frame.certificate.certified(), "{} at λ = {}: {:?}", entry.name, frame.lambda, frame.certificate);
        }
        println!("{}: {} frames, {:.1} s", entry.name, outcome.frames.len(), start.elapsed().as_secs_f64());
    }
}

#[test]
fn classic_deformation_crosses_itself_in_each_scene() {
    for entry in others() {
        let crossings = |flatten| warp(&entry, entry.resolution, Some(Reference::Eq1), flatten).certificate.crossings();
        let count = crossings(false);
        println!("{}: {count} crossings", entry.name);
        assert!(count > 0, "{}", entry.name);
        if ["hand", "magnet"].contains(&entry.name) {
            assert_eq!(crossings(true), 0, "sabotage: where all keeps its size, nothing may be counted");
        }
    }
}

//! The growth as a film in one GLB, for any glTF viewer.
//!
//! The first frame is the mesh, each further one a morph target. A linear animation of the weights shows frame k alone at its
//! time and blends exactly two frames in between. It grows, holds, shrinks back and holds, so that it can loop.

use std::path::Path;

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::Surface;
use super::glb::Scene;
use crate::boundary::Boundary;
use crate::error::{Error, Result};
use crate::file::write_atomically;
use std::io::Write as _;

/// The rests at both ends, as a part of the growing time.
const HOLD: f32 = 0.25;

/// Bytes that are written between two looks at whether to stop.
const CHUNK: usize = 1 << 22;

/// One certified state on the way.
#[derive(Debug, Clone, Copy)]
pub struct GrowthFrame<'a> {
    /// How far it has grown, 0..=1, rising from frame to frame; time is in proportion to it.
    pub lambda: f32,
    /// `[vertices]` positions, source units.
    pub positions: &'a [DVec3],
}

/// Writes the growth: one self-contained GLB that plays in any glTF viewer. Asks `stopped` now and then, and ends when it says
/// so.
///
/// `frames`: at least two, the first at rest. `colours`: `[vertices]` linear RGB of the importance on neutral white, or `None`
/// for the materials and colours of the input. `seconds`: how long it grows, > 0; it holds, shrinks and holds again after that.
///
/// # Errors
///
/// [`Error::Input`] where there is nothing to play or a position is out of the range of single precision; [`Error::File`] where
/// the system refuses; [`Error::Cancelled`] if it was stopped. Nothing is left under the final name then.
pub fn growth(
    boundary: &Boundary,
    frames: &[GrowthFrame],
    colours: Option<&[[f32; 3]]>,
    seconds: f32,
    path: &Path,
    stopped: &dyn Fn() -> bool,
) -> Result<()> {
    let [rest, grown @ ..] = frames else {
        return Err(Error::in_file(path, "a growth needs a frame at rest; record some frames first"));
    };
    if grown.is_empty() {
        return Err(Error::in_file(path, "a growth needs a second frame; record more frames"));
    }
    if !(seconds > 0.0 && seconds.is_finite()) {
        return Err(Error::in_file(path, format!("a growth cannot last {seconds} s; choose a time above 0")));
    }
    for frame in frames {
        let surface = Surface { boundary, positions: frame.positions, colours };
        surface.check()?;
        surface.check_single(boundary.origin(), path)?;
    }
    let surface = Surface { boundary, positions: rest.positions, colours };
    let mut scene = Scene::new(&surface);
    let (places, normals) = scene.moment(rest.positions);
    let differences = |now: &[Vec3], rest: &[Vec3]| {
        now.iter().zip(rest).flat_map(|(n, r)| (*n - *r).to_array()).collect::<Vec<f32>>()
    };
    let mut targets = Vec::with_capacity(grown.len());
    let go_on = || if stopped() { Err(Error::Cancelled) } else { Ok(()) };
    for frame in grown {
        go_on()?;
        let (moved, turned) = scene.moment(frame.positions);
        let positions = scene.glb.column(differences(&moved, &places), 3, true);
        let normals = scene.glb.column(differences(&turned, &normals), 3, true);
        targets.push((positions, normals));
    }
    let mut windows = std::collections::HashMap::new();
    let names: Vec<String> = grown.iter().map(|frame| format!("λ {:.3}", frame.lambda)).collect();
    let mut members = scene.nodes(
        |glb, window, primitive| {
            let targets = windows.entry(window.clone()).or_insert_with(|| {
                let target =
                    |(p, n): &(_, _)| json!({ "POSITION": glb.window(p, window), "NORMAL": glb.window(n, window) });
                targets.iter().map(target).collect::<Vec<Value>>()
            });
            primitive["targets"] = json!(targets);
        },
        |mesh| {
            mesh["weights"] = json!(vec![0.0; names.len()]);
            mesh["extras"] = json!({ "targetNames": names });
        },
    );
    let (times, weights) = keys(frames, seconds);
    let (input, output) = (scene.glb.scalars(&times), scene.glb.scalars(&weights));
    let count = members.get("nodes").and_then(Value::as_array).map_or(0, Vec::len);
    let channels: Vec<Value> =
        (0..count).map(|node| json!({ "sampler": 0, "target": { "node": node, "path": "weights" } })).collect();
    let sampler = json!({ "input": input, "output": output, "interpolation": "LINEAR" });
    members.insert("animations".into(), json!([{ "name": "growth", "channels": channels, "samplers": [sampler] }]));
    scene.glb.root.extend(members);
    go_on()?;
    let bytes = scene.glb.finish(path)?;
    let written = write_atomically(path, |file| {
        bytes.chunks(CHUNK).try_for_each(|chunk| match stopped() {
            true => Err(std::io::ErrorKind::Interrupted.into()),
            false => file.write_all(chunk),
        })
    });
    match written {
        Err(_) if stopped() => Err(Error::Cancelled),
        written => written,
    }
}

/// Times in seconds, and all weights at each: up, hold, down, hold.
fn keys(frames: &[GrowthFrame], seconds: f32) -> (Vec<f32>, Vec<f32>) {
    let last = frames.len() - 1;
    let moments = moments(frames, seconds);
    let hold = HOLD * seconds;
    let up = (0..=last).map(|k| (moments[k], k));
    let down = (0..=last).rev().map(|k| (2.0 * seconds + hold - moments[k], k));
    let end = [(2.0 * seconds + 2.0 * hold, 0)];
    let mut times = Vec::new();
    let mut weights = Vec::new();
    for (time, frame) in up.chain(down).chain(end) {
        times.push(time);
        weights.extend((1..=last).map(|k| if k == frame { 1.0 } else { 0.0 }));
    }
    (times, weights)
}

/// `[frames]` when each is shown, seconds: in proportion to λ; evenly where λ does not rise.
fn moments(frames: &[GrowthFrame], seconds: f32) -> Vec<f32> {
    let (first, last) = (frames[0].lambda, frames[frames.len() - 1].lambda);
    let by_lambda: Vec<f32> = frames.iter().map(|frame| seconds * ((frame.lambda - first) / (last - first))).collect();
    let rises = by_lambda.windows(2).all(|pair| pair[0] < pair[1]) && by_lambda.iter().all(|t| t.is_finite());
    let steps = (frames.len() - 1) as f32;
    if rises { by_lambda } else { (0..frames.len()).map(|k| seconds * k as f32 / steps).collect() }
}

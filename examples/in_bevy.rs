//! The stages in an app of one's own: a box whose one end grows, an iteration in each frame, its surface placed from the
//! components of its domain. `cargo run --release --example in_bevy`.
#![allow(clippy::print_stdout, reason = "an example says what it found")]

use std::sync::Arc;

use bevy::prelude::*;
use glam::DVec3;
use homunculus::prelude::*;

fn main() {
    App::new()
        .add_plugins((MinimalPlugins, HomunculusPlugins))
        .add_systems(Startup, spawn_box)
        .add_systems(PostUpdate, show)
        .run();
}

fn spawn_box(mut commands: Commands) {
    let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), 3.0 * f64::from(k >> 2));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let boundary = Boundary::from_triangles("box", (0..8).map(corner).collect(), triangles);
    let importance: Vec<f32> = boundary.positions.iter().map(|p| if p.z > 1.5 { 2.0 } else { 1.0 }).collect();
    let importance = Stack::of_vertices(&importance, Vec::new(), 0);
    let settings = Settings { resolution: 24, ..Settings::default() };
    Domain::body(Arc::new(boundary), Arc::new(importance), settings).spawn_later(&mut commands);
}

/// A renderer would upload the places here; this one tells how long the box is.
fn show(domains: Query<(&Growing, &Warped, &Bound, &Reel)>, mut exit: MessageWriter<AppExit>) {
    for (Growing(growth), Warped(nodes), Bound(binding), Reel(film)) in &domains {
        let places = binding.apply(nodes);
        let length = places[4].z - places[0].z;
        println!("λ {:.2}: {length:.2} long, {} certified keyframes", growth.lambda(), film.keyframes().len());
        if growth.done() {
            exit.write(AppExit::Success);
        }
    }
}

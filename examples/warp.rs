//! Warps a body so that everything above its middle becomes twice as large: `cargo run --release --example warp BODY.obj`.
#![allow(clippy::print_stdout, reason = "an example says what it found")]

use homunculus::prelude::*;

fn main() -> Result<(), Error> {
    let path = std::env::args().nth(1).ok_or_else(|| Error::input("give a mesh: warp BODY.obj"))?;
    let body = boundary::read(path.as_ref())?;
    let (low, high) = body.bounds().unwrap_or_default();
    let middle = 0.5 * (low.y + high.y);
    let importance: Vec<f32> = body.positions.iter().map(|p| if p.y > middle { 2.0 } else { 1.0 }).collect();

    let grown = Warp::of(body).importance(importance).resolution(64).fidelity(0.8).run()?;

    let Outcome { fidelity, frames, .. } = &grown.outcome;
    println!("certified: {} in {} frames", grown.certified(), frames.len());
    println!("size error: median {:.1} %, p95 {:.1} %", 100.0 * fidelity.median, 100.0 * fidelity.p95);
    homunculus::export::mesh(&grown.boundary, grown.positions(), None, "grown.glb".as_ref())
}

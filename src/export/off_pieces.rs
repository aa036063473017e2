//! The lines of an OFF again, with more vertices and faces than it had: long triangles are in pieces.

use std::fmt::Write as _;

use super::{Surface, number};
use crate::boundary::{OffText, off_content};

/// The file: new counts, the added vertices after those of the file, the pieces of a face where it stood with what came after its
/// corners.
pub(super) fn again(surface: &Surface, original: &OffText) -> Vec<u8> {
    let source = &surface.boundary.source;
    let normals = original.normals.then(|| surface.vertex_normals());
    let skipped = if original.normals { 6 } else { 3 };
    let extras = Extras::new(surface, original, skipped);
    let ranges = source.added.ranges();
    let faces = original.faces + source.polygons.len() - ranges.len();
    let counts = format!("{} {faces} 0", surface.positions.len());

    let mut out = String::with_capacity(original.text.len());
    let put_vertex = |out: &mut String, vertex: usize| {
        let [x, y, z] = surface.positions[vertex].to_array().map(number);
        let _ = write!(out, "{x} {y} {z}");
        if let Some(normal) = normals.as_ref().map(|normals| normals[vertex]) {
            let _ = write!(out, " {} {} {}", normal.x, normal.y, normal.z);
        }
        let _ = writeln!(out, "{}", extras.text(vertex));
    };
    let (mut seen, mut face) = (0, 0);
    for line in original.text.lines() {
        let words = off_content(line);
        if words.is_empty() {
            out.push_str(line);
            out.push('\n');
            continue;
        }
        let at = seen;
        seen += 1;
        if at < original.before {
            // The counts are the last line before the vertices, or the rest of the first.
            let keyword = words.find("OFF").map_or("", |start| &words[..start + 3]);
            let _ = match (at + 1 == original.before, keyword) {
                (false, _) => writeln!(out, "{words}"),
                (true, "") => writeln!(out, "{counts}"),
                (true, keyword) => writeln!(out, "{keyword} {counts}"),
            };
            continue;
        }
        let vertex = at - original.before;
        if vertex < original.vertices {
            put_vertex(&mut out, vertex);
            if vertex + 1 == original.vertices {
                (original.vertices..surface.positions.len()).for_each(|added| put_vertex(&mut out, added));
            }
            continue;
        }
        let sides = words.split_whitespace().next().and_then(|word| word.parse::<usize>().ok()).unwrap_or(0);
        let is_face = vertex - original.vertices < original.faces && sides >= 3;
        let pieces = ranges.get(face).filter(|_| is_face).cloned().unwrap_or_default();
        face += usize::from(is_face);
        if pieces.len() < 2 {
            out.push_str(line);
            out.push('\n');
            continue;
        }
        let rest: String = words.split_whitespace().skip(1 + sides).map(|word| format!(" {word}")).collect();
        for polygon in pieces {
            let corners = &source.polygons.corners[source.polygons.range(polygon)];
            let _ = write!(out, "{}", corners.len());
            corners.iter().for_each(|vertex| {
                let _ = write!(out, " {vertex}");
            });
            let _ = writeln!(out, "{rest}");
        }
    }
    out.into_bytes()
}

/// What comes after the coordinates of vertices.
struct Extras {
    /// `[vertices of the file]` as it is.
    texts: Vec<String>,
    /// `[vertices]` as numbers.
    numbers: Vec<Vec<f64>>,
    /// Whether they are colours in bytes, whose means are whole numbers too.
    whole: bool,
}

impl Extras {
    fn new(surface: &Surface, original: &OffText, skipped: usize) -> Self {
        let lines = original.text.lines().map(off_content).filter(|words| !words.is_empty());
        let words =
            |line: &str| -> String { line.split_whitespace().skip(skipped).map(|word| format!(" {word}")).collect() };
        let texts: Vec<String> = lines.skip(original.before).take(original.vertices).map(words).collect();
        let parse = |text: &String| text.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let mut numbers: Vec<Vec<f64>> = texts.iter().map(parse).collect();
        let all = || numbers.iter().flatten();
        let whole = all().all(|value| value.fract() == 0.0) && all().any(|&value| value > 1.0);
        for ends in &surface.boundary.source.added.ends {
            let [a, b] = ends.map(|end| numbers.get(end as usize).map_or(&[][..], Vec::as_slice));
            let mean = |(a, b): (&f64, &f64)| if whole { (0.5 * (a + b)).round() } else { 0.5 * (a + b) };
            let mean = a.iter().zip(b).map(mean).collect();
            numbers.push(mean);
        }
        Self { texts, numbers, whole }
    }

    fn text(&self, vertex: usize) -> String {
        if let Some(text) = self.texts.get(vertex) {
            return text.clone();
        }
        let Some(numbers) = self.numbers.get(vertex) else { return String::new() };
        numbers
            .iter()
            .map(|&value| format!(" {}", if self.whole { format!("{value}") } else { number(value) }))
            .collect()
    }
}

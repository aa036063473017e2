//! `homunculus inspect`: what is in a file, and what would be voxelized.

use glam::DVec3;
use serde::Serialize;

use super::load::only_of_pictures;
use super::options::InspectOptions;
use super::{Verdict, say};
use crate::boundary::{Attribute, Boundary};
use crate::diagnostics::human_bytes;
use crate::export::report::{DomainReport, InputReport, PictureReport};
use crate::scene::Source;
use crate::subject::{self, Inspected};
use crate::{Error, Result};

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Inspection {
    source: String,
    input: InputReport,
    extents: Extents,
    /// Of a picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<PictureReport>,
    attributes: Vec<AttributeRange>,
    /// Whether it has texture coordinates; a picture's are the mesh's that it is drawn on.
    uv: bool,
    /// Whether it has vertex colours.
    colours: bool,
    domain: DomainReport,
    warnings: Vec<String>,
    version: &'static str,
}

/// The box around the vertices, in source units.
#[derive(Debug, Serialize)]
struct Extents {
    min: [f64; 3],
    max: [f64; 3],
}

/// An attribute's name and its finite values' range.
#[derive(Debug, PartialEq, Serialize)]
struct AttributeRange {
    name: String,
    min: Option<f32>,
    max: Option<f32>,
    /// How many vertices have a value that is not finite.
    not_finite: usize,
}

/// Looks and tells.
pub(super) fn run(options: &InspectOptions) -> Result<Verdict> {
    let found = subject::find(&options.source)?;
    only_of_pictures(found.kind(), "--background", options.background.is_some())?;
    let resolution = options.resolution.unwrap_or(found.kind().usual().0);
    let inspection = Inspection::of(&options.source, found.inspect(options.background.as_deref(), resolution)?);
    let text = if options.json {
        serde_json::to_string_pretty(&inspection).map_err(|e| Error::Fault(format!("inspection to JSON: {e}")))?
    } else {
        inspection.to_lines().join("\n")
    };
    say(&text);
    Ok(Verdict::Done)
}

impl Inspection {
    fn of(source: &Source, Inspected { boundary, input, domain, picture, warnings }: Inspected) -> Self {
        Self {
            source: source.to_string(),
            input: (&input).into(),
            extents: Extents::of(&boundary),
            picture,
            attributes: boundary.attributes.iter().map(AttributeRange::of).collect(),
            uv: boundary.vertex_uvs().is_some_and(|uvs| uvs.iter().any(Option::is_some)),
            colours: boundary.base_colours().is_some(),
            domain: (&domain).into(),
            warnings,
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    fn to_lines(&self) -> Vec<String> {
        let (input, domain) = (&self.input, &self.domain);
        let yes = |is: bool| if is { "yes" } else { "no" };
        let line = |label: &str, text: String| format!("{label:<22}{text}");
        let (min, max) = (self.extents.min, self.extents.max);
        let extents = [0, 1, 2].map(|i| short(max[i] - min[i])).join(" × ");
        let [from, to] = [min, max].map(|corner| corner.map(short).join(", "));
        let mut lines = vec![self.source.clone()];
        if let Some(picture) = &self.picture {
            let all = f64::from(picture.width) * f64::from(picture.height);
            let share = 100.0 * picture.domain_pixels as f64 / all;
            lines.extend([
                line("  pixels", format!("{} × {}, {} bits a channel", picture.width, picture.height, picture.bits)),
                line("  body", format!("{} pixels, {} % of all", picture.domain_pixels, short(share))),
                line("  components", input.components.to_string()),
                line("  outlines", input.boundary_loops.to_string()),
                line("  colour profile", yes(picture.has_profile).into()),
            ]);
            let regions = match &picture.regions[..] {
                [] => "none".into(),
                names => format!("{}: {}", names.len(), names.join(", ")),
            };
            lines.push(line("  regions", regions));
        } else {
            lines.extend([
                line("  vertices", input.vertices.to_string()),
                line("  triangles", input.triangles.to_string()),
                line("  components", input.components.to_string()),
                line("  boundary loops", input.boundary_loops.to_string()),
                line("  self-intersections", input.self_intersections.to_string()),
                line("  extents", format!("{extents}, from ({from}) to ({to})")),
                line("  texture coords", yes(self.uv).into()),
                line("  vertex colours", yes(self.colours).into()),
                line("  attributes", if self.attributes.is_empty() { "none".into() } else { String::new() }),
            ]);
            lines.extend(self.attributes.iter().map(|attribute| format!("    {attribute}")));
        }
        let unit = if self.picture.is_some() { " pixels" } else { "" };
        lines.push(format!("voxelized at {} cells along the longest axis", domain.resolution));
        lines.extend([
            line("  cell size", format!("{}{unit}", short(domain.cell_size))),
            line("  cells", domain.cells.to_string()),
            line("  nodes", domain.nodes.to_string()),
            line("  edges", domain.edges.to_string()),
            line("  elements", domain.elements.to_string()),
        ]);
        if self.picture.is_none() {
            lines.push(line("  suspected welds", domain.suspected_welds.to_string()));
        }
        lines.extend([line("  memory to warp", format!("about {}", human_bytes(domain.memory_estimate_bytes as f64)))]);
        lines.extend(self.warnings.iter().map(|warning| format!("warning: {warning}")));
        lines
    }
}

/// Six significant digits, without trailing zeros.
fn short(number: f64) -> String {
    let magnitude = if number == 0.0 { 0.0 } else { number.abs().log10().floor() };
    if !(-5.0..=9.0).contains(&magnitude) {
        return format!("{number:.5e}");
    }
    let text = format!("{number:.*}", (5.0 - magnitude).max(0.0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

impl Extents {
    fn of(boundary: &Boundary) -> Self {
        let least = boundary.positions.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let greatest = boundary.positions.iter().copied().reduce(DVec3::max).unwrap_or_default();
        Self { min: least.to_array(), max: greatest.to_array() }
    }
}

impl AttributeRange {
    fn of(attribute: &Attribute) -> Self {
        let finite = || attribute.values.iter().copied().filter(|value| value.is_finite());
        Self {
            name: attribute.name.clone(),
            min: finite().reduce(f32::min),
            max: finite().reduce(f32::max),
            not_finite: attribute.values.len() - finite().count(),
        }
    }
}

impl std::fmt::Display for AttributeRange {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match (self.min, self.max) {
            (Some(min), Some(max)) => write!(f, "{}  {min}..{max}", self.name)?,
            _ => write!(f, "{}  no values", self.name)?,
        }
        if self.not_finite > 0 {
            write!(f, ", {} not finite", self.not_finite)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, expected) in [
            (0.0, "0"),
            (1.654_783_98, "1.65478"),
            (-0.5, "-0.5"),
            (120.0, "120"),
            (1_234_567.8, "1234568"),
            (1e-9, "1.00000e-9"),
            (2e12, "2.00000e12"),
        ] {
            assert_eq!(short(number), expected);
        }
    }
}

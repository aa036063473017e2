//! Importance from a vertex attribute of the file.

use super::stack::{OfVertices, Surface};
use super::{Range, field};
use crate::{Error, Result};

/// The attribute's values as importance, or its least and greatest value mapped to a range.
pub(super) fn on_surface(name: &str, range: Option<Range>, surface: &mut Surface) -> Result<OfVertices> {
    let Surface { boundary, reading, .. } = surface;
    let Some(attribute) = boundary.attributes.iter().find(|a| a.name == name) else {
        let names: Vec<_> = boundary.attributes.iter().map(|a| format!("`{}`", a.name)).collect();
        let known = if names.is_empty() { "it has none".into() } else { format!("it has {}", names.join(", ")) };
        return Err(Error::input(format!("{} has no vertex attribute `{name}` ({known})", boundary.name)));
    };
    let place = |vertex: usize| format!("attribute `{name}`: vertex {vertex}");
    let values = attribute.values.iter().enumerate();
    let Some(range) = range else {
        let admit =
            |(vertex, value): (usize, &f32)| reading.admission.admit(*value, &value.to_string(), || place(vertex));
        return values.map(admit).collect::<Result<Vec<_>>>().map(OfVertices::new);
    };
    let (low, high) = reading.admit_range(range, || format!("attribute `{name}`"))?;
    let finite = || attribute.values.iter().copied().filter(|v| v.is_finite()).map(f64::from);
    let (least, greatest) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    if least >= greatest {
        reading.warnings.push(format!("attribute `{name}` is {least} everywhere: taken as the middle of the range"));
    }
    let mapped = |value: f64| {
        let t = if least < greatest { (value - least) / (greatest - least) } else { 0.5 };
        (low + t * (high - low)) as f32
    };
    let admit = |(vertex, value): (usize, &f32)| match value.is_finite() {
        true => Ok(Some(mapped(f64::from(*value)))),
        // NaN and infinities have no place in the range: refused, or left out and counted.
        false => reading.admission.admit(f32::NAN, &value.to_string(), || place(vertex)),
    };
    values.map(admit).collect::<Result<Vec<_>>>().map(OfVertices::new)
}

/// Pictures have no vertices.
pub(super) fn on_pixels() -> Result<()> {
    Err(field::no_vertices())
}

//! Importance of named regions: of vertices by two tables, of pixels by a picture of ids and a table.

mod pixels;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::field::{self, Pixels};
use super::stack::{OfVertices, Surface};
use super::table::{has_column, importance_of, rows, vertex_of};
use super::{Ask, Layer, Offer};
use crate::boundary::Regions;
use crate::format::{Kind, Use};
use crate::picture::{self, read};
use crate::{Error, Result};

/// The regions of the first table, with the importance which the second gives to each.
pub(super) fn on_surface(
    regions_path: &Path,
    values_path: &Path,
    per_area: bool,
    surface: &mut Surface,
) -> Result<OfVertices> {
    if per_area {
        return Err(Error::input("--per-area is for pictures, and this is a mesh; leave it out"));
    }
    let vertices = surface.boundary.positions.len();
    let mut regions = Regions { names: Vec::new(), of_vertex: vec![u32::MAX; vertices] };
    let mut index_of = HashMap::new();
    let mut named_at = Vec::new();
    let mut first_row = vec![0; vertices];
    for row in rows(regions_path, "vertex", "region")? {
        let vertex = vertex_of(regions_path, &row, &mut first_row)?;
        let next = regions.names.len() as u32;
        let region = *index_of.entry(row.value.clone()).or_insert(next);
        if region == next {
            regions.names.push(row.value);
            named_at.push(row.number);
        }
        regions.of_vertex[vertex] = region;
    }

    let mut worth: Vec<Option<(u64, Option<f32>)>> = vec![None; regions.names.len()];
    for row in rows(values_path, "region", "importance")? {
        let Some(&region) = index_of.get(&row.key) else {
            let sentence = format!(
                "row {}: unknown region `{}`: {} has no vertex of that region; correct the name or remove the row",
                row.number,
                row.key,
                regions_path.display()
            );
            return Err(Error::in_file(values_path, sentence));
        };
        let place = &mut worth[region as usize];
        if let Some((first, _)) = place {
            let sentence = format!(
                "row {}: region `{}` was already given on row {first}; keep one of the two",
                row.number, row.key
            );
            return Err(Error::in_file(values_path, sentence));
        }
        *place = Some((row.number, importance_of(values_path, &row, &mut surface.reading.admission)?));
    }
    if let Some(orphan) = worth.iter().position(Option::is_none) {
        let sentence = format!(
            "region `{}` has no value, but {} uses it on row {}; add a row for it",
            regions.names[orphan],
            regions_path.display(),
            named_at[orphan]
        );
        return Err(Error::in_file(values_path, sentence));
    }
    let value_of = |region: &u32| worth.get(*region as usize).copied().flatten().and_then(|(_, value)| value);
    let found = OfVertices::new(regions.of_vertex.iter().map(value_of));
    surface.regions = Some(regions);
    Ok(found)
}

/// The regions of a picture of ids, with what the table says of each.
pub(super) fn on_pixels(ids: &Path, values: &Path, per_area: bool, pixels: &mut Pixels) -> Result<()> {
    let decoded = read::decode(ids, &read::file(ids)?)?;
    let text = std::fs::read(values).map_err(|e| Error::reading(values, e))?;
    set(pixels, (ids, &decoded.pixels), (values, &text), per_area)
}

/// The same of what is in memory.
pub(super) fn set(
    pixels: &mut Pixels,
    (ids, found): (&Path, &picture::Pixels),
    (table, text): (&Path, &[u8]),
    per_area: bool,
) -> Result<()> {
    pixels.check_size(ids, found.size())?;
    let domain = &pixels.picture.domain;
    let joined = pixels::join(ids, found, domain, table, text, per_area, &mut pixels.reading.admission)?;
    pixels.blend(|index, below| {
        let region = joined.regions.of_pixel[index];
        let value = joined.importance.get(region as usize).copied().flatten();
        value.map_or(below, |value| f64::from(value).ln())
    });
    pixels.reading.warnings.extend(joined.warnings);
    pixels.regions = Some(joined.regions);
    Ok(())
}

const WORTH: Ask = Ask { name: "Values", title: "What each region is worth", of: Use::Table };

/// In the window, of a body.
pub(super) const OF_BODY: Offer = Offer {
    name: "Tables of regions…",
    hint: "CSV: vertex,region, then CSV: region,importance",
    title: "Regions and what they are worth",
    files: &[Ask { name: "Regions", title: "Which vertex belongs to which region", of: Use::Table }, WORTH],
};

/// In the window, of a picture.
pub(super) const OF_PICTURE: Offer = Offer {
    name: "Regions…",
    hint: "A picture of ids as grey values, then CSV: region,importance, or region,value to become area",
    title: "Regions and what they are worth",
    files: &[
        Ask {
            name: "Regions",
            title: "Which pixel belongs to which region: ids as grey values",
            of: Use::Source(Kind::Picture),
        },
        WORTH,
    ],
};

/// The layer of two files that were chosen. A statistic of a flat subject's regions becomes area: its table has a column
/// `value` and not `importance`.
pub(super) fn chosen(kind: Kind, regions: PathBuf, values: PathBuf) -> Result<Layer> {
    let per_area = kind.is_flat() && has_column(&values, "value")? && !has_column(&values, "importance")?;
    Ok(Layer::Regions { regions, values, per_area })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_regions_are_worth_is_told_by_the_column() {
        let folder = tempfile::tempdir().unwrap();
        let per_area = |kind: Kind, text: &str| {
            let path = folder.path().join("t.csv");
            std::fs::write(&path, text).unwrap();
            matches!(chosen(kind, "r".into(), path).unwrap(), Layer::Regions { per_area: true, .. })
        };
        assert!(per_area(Kind::Picture, "region,value\n1,2\n"));
        assert!(!per_area(Kind::Picture, "region,importance\n1,2\n"));
        assert!(!per_area(Kind::Picture, "region,value,importance\n1,2,3\n"));
        assert!(!per_area(Kind::Body, "region,value\n1,2\n"));
        assert!(chosen(Kind::Picture, "r".into(), "/nowhere/t.csv".into()).is_err());
    }
}

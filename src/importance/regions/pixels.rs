//! A picture of region ids joined with a table of values.

use std::collections::BTreeMap;
use std::path::Path;

use super::field::Regions;
use crate::importance::admission::Admission;
use crate::picture::Pixels;
use crate::{Error, Result};

/// What a table's numbers mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Values {
    /// Importance as it stands.
    Importance,
    /// A quantity that shall become area.
    PerArea,
}

/// Regions, and what each is worth.
pub(super) struct Joined {
    pub regions: Regions,
    /// `[regions]` importance, `None` where what is below stays.
    pub importance: Vec<Option<f32>>,
    pub warnings: Vec<String>,
}

/// One row of the table.
struct Row {
    /// As an editor counts, the header is 1.
    number: u64,
    value: f64,
    /// As written.
    text: String,
    name: Option<String>,
}

/// Joins the ids with the table; the importance of a region is its value, or with `per_area` the root of value over area,
/// scaled so that Σ f² = Σ 1 over the pixels of the regions in the domain.
pub(super) fn join(
    ids_path: &Path,
    pixels: &Pixels,
    domain: &[bool],
    table_path: &Path,
    text: &[u8],
    per_area: bool,
    admission: &mut Admission,
) -> Result<Joined> {
    let meaning = if per_area { Values::PerArea } else { Values::Importance };
    let rows = rows(table_path, text, meaning)?;
    let ids = ids(ids_path, pixels)?;
    let mut areas: BTreeMap<u32, u64> = BTreeMap::new();
    for (pixel, &id) in ids.iter().enumerate() {
        if id != 0 || rows.contains_key(&0) {
            *areas.entry(id).or_default() += u64::from(domain[pixel]);
        }
    }
    if let Some((id, row)) = rows.iter().find(|(id, _)| !areas.contains_key(id)) {
        let (first, last) = (areas.keys().next(), areas.keys().next_back());
        let known = match (first, last) {
            (Some(first), Some(last)) => format!("its ids are {} from {first} to {last}", areas.len()),
            _ => "all of it is 0, which is no region".into(),
        };
        let sentence = format!(
            "row {}: unknown region {id}: {} has no pixel of that value ({known}); correct the id or remove the row",
            row.number,
            ids_path.display()
        );
        return Err(Error::in_file(table_path, sentence));
    }
    let missing: Vec<u32> = areas.keys().copied().filter(|id| !rows.contains_key(id)).collect();
    if !missing.is_empty() {
        let shown = missing.iter().take(12).map(u32::to_string).collect::<Vec<_>>().join(", ");
        let (noun, more) = (
            if missing.len() == 1 { "region" } else { "regions" },
            if missing.len() > 12 { format!(" and {} more", missing.len() - 12) } else { String::new() },
        );
        let sentence = format!("no row for {noun} {shown}{more} of {}; add the rows", ids_path.display());
        return Err(Error::in_file(table_path, sentence));
    }

    let mut warnings = Vec::new();
    let unseen: Vec<&str> =
        rows.iter().filter(|(id, _)| areas[id] == 0).map(|(_, row)| row.name.as_deref().unwrap_or("unnamed")).collect();
    if !unseen.is_empty() {
        warnings.push(format!("{}: outside the picture's body lies all of {}", ids_path.display(), unseen.join(", ")));
    }
    let importance = importances(table_path, &rows, &areas, meaning, admission)?;
    let index: BTreeMap<u32, u32> = areas.keys().zip(0..).map(|(&id, index)| (id, index)).collect();
    let regions = Regions {
        ids: areas.keys().copied().collect(),
        names: rows.iter().map(|(id, row)| row.name.clone().unwrap_or_else(|| id.to_string())).collect(),
        of_pixel: ids.iter().map(|id| index.get(id).copied().unwrap_or(u32::MAX)).collect(),
    };
    Ok(Joined { regions, importance, warnings })
}

/// `[regions]` importance in order of the ids.
fn importances(
    path: &Path,
    rows: &BTreeMap<u32, Row>,
    areas: &BTreeMap<u32, u64>,
    meaning: Values,
    admission: &mut Admission,
) -> Result<Vec<Option<f32>>> {
    // Of values > 0: others are refused below, or left to --clamp.
    let counts = |id: &u32, row: &Row| areas[id] > 0 && row.value > 0.0 && row.value.is_finite();
    let value: f64 = rows.iter().filter(|(id, row)| counts(id, row)).map(|(_, row)| row.value).sum();
    let area: u64 = rows.iter().filter(|(id, row)| counts(id, row)).map(|(id, _)| areas[id]).sum();
    let per_pixel = value / area as f64;
    let importance = |(id, row): (&u32, &Row)| {
        let place = || format!("{}: row {}", path.display(), row.number);
        let factor = match meaning {
            Values::Importance => row.value,
            Values::PerArea if row.value > 0.0 && areas[id] == 0 => return Ok(None),
            Values::PerArea if row.value > 0.0 => (row.value / areas[id] as f64 / per_pixel).sqrt(),
            // Refused, or moved to the least importance, as it stands.
            Values::PerArea => row.value,
        };
        admission.admit(factor as f32, &row.text, place)
    };
    rows.iter().map(importance).collect()
}

/// The value of each pixel, 0 where it is transparent.
fn ids(path: &Path, pixels: &Pixels) -> Result<Vec<u32>> {
    let size = pixels.size();
    let step = if matches!(pixels, Pixels::Eight(_)) { 257 } else { 1 };
    let id = |index: usize| {
        let [r, g, b, a] = pixels.wide(index);
        if a == 0 {
            return Ok(0);
        }
        if r != g || g != b {
            let (x, y) = (index as u32 % size.x, index as u32 / size.x);
            let sentence = format!(
                "the pixel at column {x}, row {y} is coloured; a picture of regions is grey, its value the region's id"
            );
            return Err(Error::in_file(path, sentence));
        }
        Ok(u32::from(r / step))
    };
    (0..(size.x * size.y) as usize).map(id).collect()
}

/// The rows by id.
fn rows(path: &Path, text: &[u8], meaning: Values) -> Result<BTreeMap<u32, Row>> {
    let unreadable =
        |e: csv::Error| Error::in_file(path, format!("not a table that can be read ({e}); write CSV in UTF-8"));
    let refuse = |number: u64, problem: String| Err(Error::in_file(path, format!("row {number}: {problem}")));
    let mut reader = csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(text);
    let headers = reader.headers().map_err(unreadable)?.clone();
    let find = |name: &str| headers.iter().position(|h| h.trim_start_matches('\u{feff}').eq_ignore_ascii_case(name));
    let wanted = match meaning {
        Values::Importance => "importance",
        Values::PerArea => "value",
    };
    let column = |name: &str| {
        find(name).ok_or_else(|| {
            let present = headers.iter().map(|h| format!("`{h}`")).collect::<Vec<_>>().join(", ");
            let present = if present.is_empty() { "the file is empty".into() } else { format!("it has {present}") };
            let hint = if name == "importance" && find("value").is_some() {
                "pass --per-area to make the column `value` area".into()
            } else {
                format!("begin the file with the line `region,{wanted}`")
            };
            Error::in_file(path, format!("row 1: the column `{name}` is missing ({present}); {hint}"))
        })
    };
    let (region_column, value_column, name_column) = (column("region")?, column(wanted)?, find("name"));

    let mut rows = BTreeMap::new();
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        let number = record.position().map_or(0, csv::Position::line);
        let field = |column: usize| record.get(column).unwrap_or_default();
        let (region, text) = (field(region_column), field(value_column));
        let Ok(id) = region.parse::<u32>() else {
            let problem = format!("region `{region}` is no whole number; write the value that its pixels have");
            return refuse(number, problem);
        };
        let Ok(value) = text.parse::<f64>() else {
            return refuse(number, format!("{wanted} `{text}` is no number; write it as in 1.5"));
        };
        let name = name_column.map(field).filter(|name| !name.is_empty()).map(str::to_owned);
        let row = Row { number, value, text: text.to_owned(), name };
        if let Some(first) = rows.insert(id, row) {
            return refuse(
                number,
                format!("region {id} was already given on row {}; keep one of the two", first.number),
            );
        }
    }
    if rows.is_empty() {
        return Err(Error::in_file(path, format!("there is no row below the header; add rows `region,{wanted}`")));
    }
    Ok(rows)
}

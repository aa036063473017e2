//! Importance from CSV tables: `vertex,importance`, or `vertex,region` with `region,importance`.
//!
//! The first row names the columns; others are ignored. Vertices are numbered from 0 in the order of the mesh file.
//! Rows are counted as an editor or a spreadsheet shows them: the header is row 1.

use std::collections::HashMap;
use std::path::Path;

use super::admission::Admission;
use crate::boundary::Regions;
use crate::{Error, Result};

/// One row of a two-column table.
struct Row {
    /// As an editor counts, the header is 1.
    number: u64,
    key: String,
    value: String,
}

/// `[vertices]` importance, `None` where the table lists no value.
pub(super) fn values(path: &Path, vertices: usize, admission: &mut Admission) -> Result<Vec<Option<f32>>> {
    let mut found = vec![None; vertices];
    let mut first_row = vec![0; vertices];
    for row in rows(path, "vertex", "importance")? {
        let vertex = vertex_of(path, &row, &mut first_row)?;
        found[vertex] = importance_of(path, &row, admission)?;
    }
    Ok(found)
}

/// The regions of the first table, and `[vertices]` the importance which the second gives to each vertex's region.
pub(super) fn regions(
    regions_path: &Path,
    values_path: &Path,
    vertices: usize,
    admission: &mut Admission,
) -> Result<(Regions, Vec<Option<f32>>)> {
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
        *place = Some((row.number, importance_of(values_path, &row, admission)?));
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
    let found = regions.of_vertex.iter().map(value_of).collect();
    Ok((regions, found))
}

/// The rows of a table, by the names of two columns.
fn rows(path: &Path, key: &str, value: &str) -> Result<Vec<Row>> {
    let file = std::fs::File::open(path).map_err(|e| Error::reading(path, e))?;
    let mut reader = csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(file);
    let headers = reader.headers().map_err(|e| unreadable(path, e))?.clone();
    let column = |name: &str| {
        let is_it = |header: &str| header.trim_start_matches('\u{feff}').eq_ignore_ascii_case(name);
        headers.iter().position(is_it).ok_or_else(|| {
            let present = headers.iter().map(|h| format!("`{h}`")).collect::<Vec<_>>().join(", ");
            let present = if present.is_empty() { "the file is empty".into() } else { format!("it has {present}") };
            let sentence = format!(
                "row 1: the column `{name}` is missing ({present}); begin the file with the line `{key},{value}`"
            );
            Error::in_file(path, sentence)
        })
    };
    let (key_column, value_column) = (column(key)?, column(value)?);

    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| unreadable(path, e))?;
        let number = record.position().map_or(0, csv::Position::line);
        let field = |column: usize, name: &str| match record.get(column) {
            Some(text) if !text.is_empty() => Ok(text.to_owned()),
            _ => Err(Error::in_file(path, format!("row {number}: `{name}` is missing; fill it in or remove the row"))),
        };
        rows.push(Row { number, key: field(key_column, key)?, value: field(value_column, value)? });
    }
    if rows.is_empty() {
        return Err(Error::in_file(path, format!("there is no row below the header; add rows `{key},{value}`")));
    }
    Ok(rows)
}

/// The vertex a row is about, which no row before it was about.
fn vertex_of(path: &Path, row: &Row, first_row: &mut [u64]) -> Result<usize> {
    let refuse = |problem: String| Err(Error::in_file(path, format!("row {}: {problem}", row.number)));
    let Ok(vertex) = row.key.parse::<usize>() else {
        return refuse(format!("vertex `{}` is not a whole number; vertices are counted from 0", row.key));
    };
    let vertices = first_row.len();
    match first_row.get_mut(vertex) {
        None => refuse(format!(
            "unknown vertex {vertex}: the mesh has {vertices} vertices, counted from 0; correct or remove the row"
        )),
        Some(0) => {
            first_row[vertex] = row.number;
            Ok(vertex)
        }
        Some(first) => refuse(format!("vertex {vertex} was already given on row {first}; keep one of the two")),
    }
}

fn importance_of(path: &Path, row: &Row, admission: &mut Admission) -> Result<Option<f32>> {
    let place = || format!("{}: row {}", path.display(), row.number);
    match row.value.parse() {
        Ok(value) => admission.admit(value, &row.value, place),
        Err(_) => {
            Err(Error::input(format!("{}: importance `{}` is not a number; write it as 1.5", place(), row.value)))
        }
    }
}

fn unreadable(path: &Path, error: csv::Error) -> Error {
    let row = error.position().map(|p| format!("row {}: ", p.line())).unwrap_or_default();
    match error.into_kind() {
        csv::ErrorKind::Io(error) => Error::reading(path, error),
        csv::ErrorKind::Utf8 { .. } => {
            Error::in_file(path, format!("{row}not UTF-8 text; save the table as UTF-8 CSV"))
        }
        other => Error::in_file(path, format!("{row}not a CSV table ({other:?}); save it as comma-separated text")),
    }
}

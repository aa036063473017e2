//! CSV tables of two columns: `vertex,importance`, `vertex,region`, `region,importance`.
//!
//! The first row names the columns; others are ignored. Vertices are numbered from 0 in the order of the mesh file.
//! Rows are counted as an editor or a spreadsheet shows them: the header is row 1.

use std::path::Path;

use super::admission::Admission;
use crate::{Error, Result};

/// One row of a two-column table.
pub(super) struct Row {
    /// As an editor counts, the header is 1.
    pub number: u64,
    pub key: String,
    pub value: String,
}

/// The rows of a table, by the names of two columns.
pub(super) fn rows(path: &Path, key: &str, value: &str) -> Result<Vec<Row>> {
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
pub(super) fn vertex_of(path: &Path, row: &Row, first_row: &mut [u64]) -> Result<usize> {
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

pub(super) fn importance_of(path: &Path, row: &Row, admission: &mut Admission) -> Result<Option<f32>> {
    let place = || format!("{}: row {}", path.display(), row.number);
    match row.value.parse() {
        Ok(value) => admission.admit(value, &row.value, place),
        Err(_) => {
            Err(Error::input(format!("{}: importance `{}` is not a number; write it as 1.5", place(), row.value)))
        }
    }
}

/// Whether the first line of a table that is no comment names a column.
///
/// # Errors
/// If it cannot be read.
pub(super) fn has_column(path: &Path, name: &str) -> Result<bool> {
    let text = std::fs::read(path).map_err(|e| Error::reading(path, e))?;
    let text = String::from_utf8_lossy(&text);
    let header = text.lines().find(|line| !line.starts_with('#')).unwrap_or_default();
    Ok(header.split(',').any(|column| column.trim().trim_start_matches('\u{feff}') == name))
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

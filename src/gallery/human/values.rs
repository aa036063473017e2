//! Published values per region: the tables in `assets/gallery`, each row with its citation and an honest status.

use crate::error::{Error, Result};

/// A table of importances.
#[derive(Debug, Clone, Copy)]
pub struct Table {
    /// The scene that shows it.
    pub scene: &'static str,
    /// One line for a list of scenes.
    pub one_line: &'static str,
    /// Where the numbers come from.
    pub reference: &'static str,
    /// Its name below `assets/gallery`.
    pub file: &'static str,
    text: &'static str,
}

static SCENES: [Table; 3] = [
    Table {
        scene: "homunculus",
        one_line: "a human as large as touch is sharp: importance from two-point thresholds",
        reference: "Weinstein 1968; Nolan 1982, 1983",
        file: "two_point.csv",
        text: include_str!("../../../assets/gallery/two_point.csv"),
    },
    Table {
        scene: "homunculus-innervation",
        one_line: "a human as large as its skin is innervated: importance from densities of touch fibres",
        reference: "Corniani and Saal 2020; Johansson and Vallbo 1979",
        file: "innervation.csv",
        text: include_str!("../../../assets/gallery/innervation.csv"),
    },
    Table {
        scene: "homunculus-motor",
        one_line: "a human as large as its motor cortex, schematic after Penfield's drawing",
        reference: "Penfield and Boldrey 1937; Penfield and Rasmussen 1950",
        file: "motor.csv",
        text: include_str!("../../../assets/gallery/motor.csv"),
    },
];

/// The three homunculi.
pub fn scenes() -> &'static [Table] {
    &SCENES
}

impl Table {
    /// The table's text: CSV with `#` comment lines that state the formula.
    pub fn text(&self) -> &'static str {
        self.text
    }

    /// `(region, importance)` in the table's order.
    ///
    /// # Errors
    /// As [`read_values`]; a shipped table has none (the tests read them all).
    pub fn values(&self) -> Result<Vec<(String, f64)>> {
        read_values(self.file, self.text)
    }
}

/// Reads `region,importance` rows (further columns are ignored, `#` starts a comment) from the text of the file `name`.
///
/// # Errors
/// One sentence that names the file, the line and the bad value.
pub fn read_values(name: &str, text: &str) -> Result<Vec<(String, f64)>> {
    let bad = |line: u64, what: String| Error::input(format!("{name}: line {line}: {what}"));
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|e| Error::input(format!("{name}: {e}")))?.clone();
    let column = |wanted: &str| {
        headers.iter().position(|h| h == wanted).ok_or_else(|| {
            Error::input(format!("{name}: there is no column `{wanted}`; the first line must be `region,importance`"))
        })
    };
    let (region, importance) = (column("region")?, column("importance")?);
    let mut values = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|e| Error::input(format!("{name}: {e}")))?;
        let line = row.position().map_or(0, csv::Position::line);
        let key = row.get(region).unwrap_or_default();
        let text = row.get(importance).unwrap_or_default();
        let value: f64 =
            text.parse().map_err(|_| bad(line, format!("the importance of `{key}` is `{text}`, not a number")))?;
        values.push((key.to_owned(), value));
    }
    Ok(values)
}

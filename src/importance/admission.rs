//! The door: which values may be importance.

use super::Range;
use super::layer::{CLAMP_MAX, CLAMP_MIN};
use crate::{Error, Result};

/// Checks each value that comes in, and counts what it had to change.
#[derive(Debug, Clone, Default)]
pub(crate) struct Admission {
    /// Move values to `CLAMP_MIN..=CLAMP_MAX` rather than refuse them.
    pub clamp: bool,
    /// How many values were moved or left out.
    pub clamped: usize,
    /// How many values lie beyond what the method is good for, and the greatest factor.
    pub extreme: usize,
    pub extremest: f32,
}

impl Admission {
    /// `value` if it may be importance. `text` is how it was written, `place` says where.
    ///
    /// With `clamp`, NaN is left out (`None`: what is below stays), all else is moved into the range.
    pub fn admit(&mut self, value: f32, text: &str, place: impl FnOnce() -> String) -> Result<Option<f32>> {
        if self.clamp {
            let moved = (!value.is_nan()).then(|| value.clamp(CLAMP_MIN, CLAMP_MAX));
            self.clamped += usize::from(moved != Some(value));
            return Ok(moved);
        }
        if !(value > 0.0 && value.is_finite()) {
            let problem = if value.is_finite() { "is not greater than 0" } else { "is not finite" };
            return Err(Error::input(format!(
                "{}: importance {text} {problem}; correct it, or pass --clamp to bring it into {CLAMP_MIN}..{CLAMP_MAX}",
                place()
            )));
        }
        let factor = value.max(value.recip());
        if factor > CLAMP_MAX {
            self.extreme += 1;
            self.extremest = self.extremest.max(factor);
        }
        Ok(Some(value))
    }

    /// What the user should know about the values let in.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.clamped > 0 {
            let sentence = format!("importance clamped to {CLAMP_MIN}..{CLAMP_MAX}: {}", count(self.clamped, "value"));
            warnings.push(sentence);
        }
        if self.extreme > 0 {
            warnings.push(format!(
                "importance changes size more than {CLAMP_MAX}-fold at {} (up to {}-fold): expect a coarse result, or pass --clamp",
                count(self.extreme, "value"),
                self.extremest
            ));
        }
        warnings
    }
}

/// What reading layers has found so far, on surfaces and in pictures alike.
#[derive(Debug)]
pub(super) struct Reading {
    pub admission: Admission,
    /// Sentences for the user.
    pub warnings: Vec<String>,
}

impl Reading {
    /// Begins with the importance below all layers; the second is its logarithm.
    pub fn new(base: f32, clamp: bool) -> Result<(Self, f64)> {
        let mut reading = Self { admission: Admission { clamp, ..Admission::default() }, warnings: Vec::new() };
        let base = reading.admit(base, || "base".into())?;
        Ok((reading, f64::from(base).ln()))
    }

    /// Admits a value that was written by hand; NaN keeps.
    pub fn admit(&mut self, value: f32, place: impl FnOnce() -> String) -> Result<f32> {
        Ok(self.admission.admit(value, &value.to_string(), place)?.unwrap_or(1.0))
    }

    /// The same of both ends of a range.
    pub fn admit_range(&mut self, (low, high): Range, place: impl Fn() -> String) -> Result<(f64, f64)> {
        Ok((f64::from(self.admit(low, &place)?), f64::from(self.admit(high, &place)?)))
    }

    /// What is to be told, and how many values were moved or left out.
    pub fn finish(mut self) -> (Vec<String>, usize) {
        self.warnings.extend(self.admission.warnings());
        (self.warnings, self.admission.clamped)
    }
}

/// `1 value`, `2 values`.
fn count(n: usize, noun: &str) -> String {
    if n == 1 { format!("1 {noun}") } else { format!("{n} {noun}s") }
}

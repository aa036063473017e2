//! `homunculus gallery`: what is built in, a line each.

use super::{Verdict, say};
use crate::Result;
use crate::gallery;

/// Lists bodies, then pictures.
pub(super) fn run() -> Result<Verdict> {
    let entries: Vec<_> = gallery::list().iter().copied().chain(gallery::picture::list()).collect();
    let width = entries.iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    for entry in entries {
        say(&format!("gallery:{:<width$}  {}", entry.name, entry.one_line));
    }
    Ok(Verdict::Done)
}

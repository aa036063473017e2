//! STUB of the export; `report` is real.

pub mod report;

use crate::boundary::Boundary;
use crate::{Error, Result};
use glam::DVec3;
use std::path::Path;

/// STUB
#[derive(Debug, Clone, Copy)]
pub struct GrowthFrame<'a> {
    /// λ
    pub lambda: f32,
    /// B'
    pub positions: &'a [DVec3],
}

/// STUB
///
/// # Errors
/// Writing.
pub fn mesh(b: &Boundary, positions: &[DVec3], _colours: Option<&[[f32; 3]]>, path: &Path) -> Result<()> {
    use std::fmt::Write as _;
    let mut text = String::new();
    for p in positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for t in &b.triangles {
        let _ = writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    use std::io::Write as _;
    write_atomically(path, |file| file.write_all(text.as_bytes()))
}

/// STUB
///
/// # Errors
/// Writing.
pub fn growth(
    b: &Boundary,
    frames: &[GrowthFrame],
    colours: Option<&[[f32; 3]]>,
    _seconds: f32,
    path: &Path,
) -> Result<()> {
    mesh(b, frames[0].positions, colours, path)
}

/// STUB
///
/// # Errors
/// Writing.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut std::io::BufWriter<&mut std::fs::File>) -> std::io::Result<()>,
) -> Result<()> {
    use std::io::Write as _;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut temporary = tempfile::NamedTempFile::new_in(folder).map_err(|e| Error::writing(path, e))?;
    let mut buffered = std::io::BufWriter::new(temporary.as_file_mut());
    write(&mut buffered).and_then(|()| buffered.flush()).map_err(|e| Error::writing(path, e))?;
    drop(buffered);
    temporary.persist(path).map_err(|e| Error::writing(path, e.error))?;
    Ok(())
}

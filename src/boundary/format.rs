//! Which format a file is in, by its content first; and its bytes and text, with every surprise said in words.

use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};
use crate::format::{self, Use};

/// Largest file that is read, bytes. A mesh of this size has tens of millions of vertices, ten times what a solve can hold;
/// lower would refuse scans that can be decimated here, higher would take more memory than a workstation has.
const MAX_FILE: u64 = 2 << 30;

/// A mesh format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// glTF 2.0, as JSON or GLB.
    Gltf,
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY.
    Ply,
    /// STL, text or binary.
    Stl,
    /// Geomview OFF.
    Off,
}

impl Kind {
    /// By the extension of a path, in any case.
    pub fn of_extension(path: &Path) -> Option<Self> {
        match Use::Source(format::Kind::Body).of(path)? {
            "glb" | "gltf" => Some(Self::Gltf),
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "off" => Some(Self::Off),
            _ => None,
        }
    }
}

/// The bytes of a regular file.
pub(crate) fn load(path: &Path) -> Result<Vec<u8>> {
    let cannot_read = |source| Error::File { path: path.to_path_buf(), what: "cannot read", source };
    let about = std::fs::metadata(path).map_err(cannot_read)?;
    if about.is_dir() {
        return Err(Error::in_file(path, "this is a folder; name the mesh file in it"));
    }
    if !about.is_file() {
        return Err(Error::in_file(path, "this is no regular file; copy its content to one first"));
    }
    if about.len() > MAX_FILE {
        let sentence =
            format!("it has {} bytes, more than the {MAX_FILE} that are read; decimate the mesh first", about.len());
        return Err(Error::in_file(path, sentence));
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path).map_err(cannot_read)?.take(MAX_FILE).read_to_end(&mut bytes).map_err(cannot_read)?;
    if bytes.is_empty() {
        return Err(Error::in_file(path, "the file is empty; export or download it again"));
    }
    Ok(bytes)
}

/// The format of a file, by content, then by extension.
pub(crate) fn recognise(path: &Path, bytes: &[u8]) -> Result<Kind> {
    if bytes.starts_with(b"glTF") {
        return Ok(Kind::Gltf);
    }
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        return Ok(Kind::Ply);
    }
    if is_binary_stl(bytes) {
        return Ok(Kind::Stl);
    }
    let head = text(&bytes[..bytes.len().min(4096) & !1]).into_owned();
    let head = head.trim_start();
    if head.starts_with('{') && (head.contains("\"asset\"") || Kind::of_extension(path).is_none()) {
        return Ok(Kind::Gltf);
    }
    let first = head.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#')).unwrap_or("");
    let word = first.split_whitespace().next().unwrap_or("");
    if word.len() <= 7 && word.ends_with("OFF") {
        return Ok(Kind::Off);
    }
    let by_extension = Kind::of_extension(path);
    if word.eq_ignore_ascii_case("solid") && by_extension != Some(Kind::Obj) {
        return Ok(Kind::Stl);
    }
    by_extension.or_else(|| looks_like_obj(head).then_some(Kind::Obj)).ok_or_else(|| {
        Error::in_file(path, "neither its content nor its name says which format it is; give a .glb, .gltf, .obj, .ply, .stl or .off file")
    })
}

/// Whether the length is exactly that of a binary STL with as many triangles as it says. Some start with "solid" all the same.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let Some(count) = bytes.get(80..84) else { return false };
    let count = u64::from(u32::from_le_bytes([count[0], count[1], count[2], count[3]]));
    bytes.len() as u64 == 84 + 50 * count
}

/// Whether some line places a vertex as OBJ does.
fn looks_like_obj(head: &str) -> bool {
    head.lines().any(|line| {
        let mut words = line.split_whitespace();
        matches!(words.next(), Some("v")) && words.filter(|word| word.parse::<f64>().is_ok()).count() >= 3
    })
}

/// A text in any of the encodings that editors write: UTF-8, UTF-16 with its mark; other bytes become U+FFFD.
pub(crate) fn text(bytes: &[u8]) -> Cow<'_, str> {
    let wide = |pair: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes[2..].chunks_exact(2).map(|c| pair([c[0], c[1]])).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    match bytes {
        [0xFE, 0xFF, ..] => wide(u16::from_be_bytes),
        [0xFF, 0xFE, ..] => wide(u16::from_le_bytes),
        [0xEF, 0xBB, 0xBF, rest @ ..] => String::from_utf8_lossy(rest),
        _ => String::from_utf8_lossy(bytes),
    }
}

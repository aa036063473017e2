//! Material libraries beside an OBJ: those of the input brought along, or new ones for materials from glTF.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use serde_json::Value;

use super::obj::one_line;
use super::srgb;
use crate::boundary::Boundary;
use crate::boundary::format::{load, text};
use crate::boundary::mtl::{find, map_file};
use crate::error::Result;
use crate::file::write_atomically;

/// Copies the library of an input OBJ, and the textures it names, beside the output; the name for its `mtllib` line.
///
/// Where the output lies in the input's folder nothing needs a copy. Nothing of another content is overwritten: the copy gets
/// the output's name before its own then. A library that is missing keeps its line.
pub(super) fn bring_along(boundary: &Boundary, name: &str, obj: &Path) -> Result<String> {
    let Some(folder) = &boundary.source.folder else { return Ok(name.to_owned()) };
    let Some(library) = find(folder, name) else { return Ok(name.to_owned()) };
    let Ok(bytes) = load(&library) else { return Ok(name.to_owned()) };
    if is_same_folder(folder, obj) {
        return Ok(name.to_owned());
    }
    let textures = library.parent().unwrap_or(folder);
    let mut out = String::new();
    for line in text(&bytes).lines() {
        let keyword = line.split_whitespace().next().unwrap_or("");
        let is_map = keyword.starts_with("map_") || ["bump", "disp", "decal", "refl", "norm"].contains(&keyword);
        let file = if is_map { map_file(line.trim_start()[keyword.len()..].trim()) } else { "" };
        match find(textures, file).filter(|_| !file.is_empty()).and_then(|path| Some((load(&path).ok()?, path))) {
            Some((image, path)) => {
                let wanted = path.file_name().map_or_else(|| "texture".into(), |n| n.to_string_lossy().into_owned());
                let placed = place(obj, &wanted, &image)?;
                let _ = writeln!(out, "{}{placed}", &line.trim_end()[..line.trim_end().len() - file.len()]);
            }
            None => {
                let _ = writeln!(out, "{line}");
            }
        }
    }
    let wanted = library.file_name().map_or_else(|| name.to_owned(), |n| n.to_string_lossy().into_owned());
    place(obj, &wanted, out.as_bytes())
}

/// A new library for the materials of another format: colours, opacity, base colour textures. Its name, and those of the
/// materials; `None` without materials.
pub(super) fn write(boundary: &Boundary, obj: &Path) -> Result<Option<(String, Vec<String>)>> {
    let materials = &boundary.source.materials;
    if materials.materials.is_empty() {
        return Ok(None);
    }
    let stem = obj.file_stem().map_or_else(|| "mesh".into(), |s| s.to_string_lossy().into_owned());
    let mut out = String::new();
    let mut names: Vec<String> = Vec::new();
    for (index, material) in materials.materials.iter().enumerate() {
        let given = material
            .get("name")
            .and_then(Value::as_str)
            .map(|name| one_line(name).replace(' ', "_"))
            .filter(|name| !name.is_empty());
        let name = given.filter(|name| !names.contains(name)).unwrap_or_else(|| format!("material_{index}"));
        let pbr = &material["pbrMetallicRoughness"];
        let factor = |i: usize| pbr["baseColorFactor"][i].as_f64().map_or(1.0, |v| v.clamp(0.0, 1.0) as f32);
        let [r, g, b, opacity] = srgb([factor(0), factor(1), factor(2), factor(3)]);
        let _ = writeln!(out, "newmtl {name}\nKd {r} {g} {b}\nd {opacity}");
        let image = pbr["baseColorTexture"]["index"]
            .as_u64()
            .and_then(|t| materials.textures.get(t as usize))
            .and_then(|t| t["source"].as_u64());
        if let Some((index, image)) = image.and_then(|i| Some((i, materials.images.get(i as usize)?))) {
            let extension = image.mime.rsplit('/').next().unwrap_or("png").replace("jpeg", "jpg");
            let file = place(obj, &format!("{stem}_texture_{index}.{extension}"), &image.bytes)?;
            let _ = writeln!(out, "map_Kd {file}");
        }
        names.push(name);
    }
    let library = place(obj, &format!("{stem}.mtl"), out.as_bytes())?;
    Ok(Some((library, names)))
}

/// Writes a file beside the output, under the wanted name or, where another content has it, with the output's name before it.
fn place(obj: &Path, wanted: &str, bytes: &[u8]) -> Result<String> {
    let is_free = |name: &str| {
        let path = obj.with_file_name(name);
        !path.exists() || std::fs::read(&path).is_ok_and(|there| there == bytes)
    };
    let stem = obj.file_stem().map_or_else(|| "mesh".into(), |s| s.to_string_lossy().into_owned());
    let name =
        if is_free(wanted) || wanted.starts_with(&stem) { wanted.to_owned() } else { format!("{stem}_{wanted}") };
    write_atomically(&obj.with_file_name(&name), |file| file.write_all(bytes))?;
    Ok(name)
}

/// Whether the output lies in a folder, by its real path.
fn is_same_folder(folder: &Path, obj: &Path) -> bool {
    let real =
        |path: &Path| std::fs::canonicalize(if path.as_os_str().is_empty() { Path::new(".") } else { path }).ok();
    let target = obj.parent().and_then(real);
    target.is_some() && real(folder) == target
}

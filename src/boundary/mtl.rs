//! Material libraries of OBJ files, translated to glTF materials; their images.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::format;
use super::source::{Image, Materials};

/// A white pixel, PNG: stands for an image that cannot be found, so that indices stay valid.
const WHITE_PIXEL: &[u8] = &[
    0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00,
    0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3A, 0x7E, 0x9B, 0x55, 0x00, 0x00, 0x00, 0x0A, 0x49,
    0x44, 0x41, 0x54, 0x78, 0xDA, 0x63, 0xF8, 0x0F, 0x00, 0x01, 0x01, 0x01, 0x00, 0x1C, 0xB0, 0x8C, 0x99, 0x00, 0x00,
    0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82,
];

/// What a library says of one material, as far as glTF can say it.
#[derive(Debug, Default, Clone)]
struct Entry {
    diffuse: Option<[f32; 3]>,
    opacity: Option<f32>,
    texture: Option<String>,
}

/// One glTF material for each name, in that order, from the libraries beside the OBJ that can be read.
pub(super) fn materials(obj: &Path, libraries: &[String], names: &[String], warnings: &mut Vec<String>) -> Materials {
    let folder = obj.parent().unwrap_or(Path::new(""));
    let mut entries: HashMap<String, Entry> = HashMap::new();
    let mut texture_folder = folder.to_path_buf();
    for library in libraries {
        let Some(path) = find(folder, library) else {
            warnings.push(format!("the material library {library} is missing, so materials are plain"));
            continue;
        };
        if let Ok(bytes) = format::load(&path) {
            texture_folder = path.parent().unwrap_or(folder).to_path_buf();
            parse(&format::text(&bytes), &mut entries);
        }
    }
    let mut result = Materials::default();
    let mut texture_of: HashMap<String, usize> = HashMap::new();
    for name in names {
        let entry = entries.get(name).cloned().unwrap_or_default();
        let [r, g, b] = if entry.texture.is_some() { [1.0; 3] } else { entry.diffuse.unwrap_or([0.8; 3]) };
        let opacity = entry.opacity.unwrap_or(1.0).clamp(0.0, 1.0);
        let factor = [r, g, b].map(|v| v.clamp(0.0, 1.0));
        let mut pbr = json!({ "baseColorFactor": [factor[0], factor[1], factor[2], opacity], "metallicFactor": 0.0, "roughnessFactor": 0.8 });
        if let Some(file) = entry.texture {
            let texture = *texture_of.entry(file.clone()).or_insert_with(|| {
                result.images.push(load_image(&texture_folder, &file, warnings));
                result.textures.push(json!({ "source": result.images.len() - 1 }));
                result.textures.len() - 1
            });
            pbr["baseColorTexture"] = json!({ "index": texture });
        }
        let mut material = json!({ "name": name, "pbrMetallicRoughness": pbr, "doubleSided": true });
        if opacity < 1.0 {
            material["alphaMode"] = Value::from("BLEND");
        }
        result.materials.push(material);
    }
    result
}

fn parse(text: &str, entries: &mut HashMap<String, Entry>) {
    let mut current = String::new();
    for line in text.lines() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let numbers: Vec<f32> =
            rest.split_whitespace().map_while(|w| w.parse().ok()).filter(|v: &f32| v.is_finite()).collect();
        if keyword == "newmtl" {
            current = rest.to_owned();
        }
        let entry = entries.entry(current.clone()).or_default();
        match (keyword, numbers.as_slice()) {
            ("Kd", &[r, g, b, ..]) => entry.diffuse = Some([r, g, b]),
            ("d", &[opacity, ..]) => entry.opacity = Some(opacity),
            ("Tr", &[transparency, ..]) => entry.opacity = Some(1.0 - transparency),
            ("map_Kd", _) => entry.texture = Some(map_file(rest).to_owned()),
            _ => {}
        }
    }
}

/// The file of a `map_…` line, after its options (`-s 1 1 1`, `-clamp on`, …). File names may hold spaces.
pub(crate) fn map_file(rest: &str) -> &str {
    let mut rest = rest.trim();
    while rest.starts_with('-') {
        let (_, mut after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        loop {
            after = after.trim_start();
            let (word, next) = after.split_once(char::is_whitespace).unwrap_or((after, ""));
            if next.is_empty() || !(word.parse::<f64>().is_ok() || word == "on" || word == "off") {
                break;
            }
            after = next;
        }
        if after.len() >= rest.len() {
            break;
        }
        rest = after;
    }
    rest
}

/// A file named in another, relative to a folder; with either slash, and as a bare name where its path is another machine's.
pub(crate) fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    let name = name.trim().trim_matches('"');
    let slashes = name.replace('\\', "/");
    let bare = slashes.rsplit('/').next().unwrap_or(&slashes);
    [name, &slashes, bare].iter().map(|n| folder.join(n)).find(|p| p.is_file())
}

/// The image a file names; a white pixel, and a warning, where it is missing or in a format that glTF cannot hold.
pub(crate) fn load_image(folder: &Path, file: &str, warnings: &mut Vec<String>) -> Image {
    let bytes = find(folder, file).and_then(|path| format::load(&path).ok());
    match bytes.as_deref().and_then(mime_of) {
        Some(mime) => Image { name: file.into(), mime: mime.into(), bytes: bytes.unwrap_or_default() },
        None => {
            let why = if bytes.is_some() { "neither PNG nor JPEG" } else { "missing" };
            warnings.push(format!("the texture {file} is {why}, so it is white"));
            white(file)
        }
    }
}

/// A white pixel under the name of an image.
pub(crate) fn white(name: &str) -> Image {
    Image { name: name.into(), mime: "image/png".into(), bytes: WHITE_PIXEL.into() }
}

/// Media type by the first bytes.
pub(crate) fn mime_of(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xFF, 0xD8, 0xFF, ..] => Some("image/jpeg"),
        _ => None,
    }
}

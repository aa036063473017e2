//! Materials, textures, samplers and images, word for word; images with their bytes.

use std::collections::BTreeSet;

use gltf::json::Image as ImageFile;
use serde_json::Value;

use super::accessor::{Buffers, percent_decoded};
use super::no_such;
use crate::boundary::mtl;
use crate::boundary::source::{Image, Materials};

/// Takes the materials out of a JSON; their images are still to come.
pub(super) fn take(root: &mut Value) -> Materials {
    let mut array = |key: &str| match root.as_object_mut().and_then(|root| root.remove(key)) {
        Some(Value::Array(items)) => items,
        _ => Vec::new(),
    };
    let mut result = Materials {
        materials: array("materials"),
        textures: array("textures"),
        samplers: array("samplers"),
        ..Materials::default()
    };
    let mut used = BTreeSet::new();
    for value in result.materials.iter().chain(&result.textures).chain(&result.samplers) {
        extensions(value, &mut used);
    }
    if let Some(variants) = root.pointer("/extensions/KHR_materials_variants") {
        result.root_extensions.insert("KHR_materials_variants".into(), variants.clone());
        used.insert("KHR_materials_variants".into());
    }
    let required = root.get("extensionsRequired").and_then(Value::as_array).into_iter().flatten();
    let required = required.filter_map(|name| name.as_str().map(str::to_owned));
    result.extensions_required = required.filter(|name| used.contains(name)).collect();
    result.extensions_used = used.into_iter().collect();
    result
}

/// Names of all extensions within a JSON value.
fn extensions(value: &Value, names: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            if let Some(found) = map.get("extensions").and_then(Value::as_object) {
                names.extend(found.keys().cloned());
            }
            map.iter().filter(|(key, _)| *key != "extras").for_each(|(_, inner)| extensions(inner, names));
        }
        Value::Array(list) => list.iter().for_each(|inner| extensions(inner, names)),
        _ => {}
    }
}

/// The images of a document.
pub(super) fn images<'a>(
    document: &'a gltf::Document,
    buffers: &mut Buffers<'a>,
    warnings: &mut Vec<String>,
) -> Vec<Image> {
    let files = document.as_json().images.iter().enumerate();
    files.map(|(index, file)| image(index, file, document, buffers, warnings)).collect()
}

fn image<'a>(
    index: usize,
    file: &'a ImageFile,
    document: &'a gltf::Document,
    buffers: &mut Buffers<'a>,
    warnings: &mut Vec<String>,
) -> Image {
    let by_uri = file.uri.as_deref().filter(|uri| !uri.starts_with("data:")).map(percent_decoded);
    let name = file.name.clone().or(by_uri).unwrap_or_else(|| format!("image {index}"));
    match bytes(file, document, buffers) {
        Ok(bytes) => {
            let said = || file.mime_type.as_ref().map_or_else(|| "image/png".into(), |mime| mime.0.clone());
            let mime = mtl::mime_of(&bytes).map_or_else(said, str::to_owned);
            Image { name, mime, bytes }
        }
        Err(why) => {
            warnings.push(format!("the image {name} is left white: {why}"));
            mtl::white(&name)
        }
    }
}

fn bytes<'a>(file: &'a ImageFile, document: &'a gltf::Document, buffers: &mut Buffers<'a>) -> Result<Vec<u8>, String> {
    let bytes = match (&file.uri, file.buffer_view) {
        (Some(uri), _) => buffers.resource(uri)?.to_vec(),
        (None, Some(view)) => {
            let count = document.views().len();
            let view = document.views().nth(view.value()).ok_or_else(|| no_such("buffer view", view.value(), count))?;
            buffers.view(&view)?.to_vec()
        }
        (None, None) => return Err("it has no content".into()),
    };
    buffers.spend(bytes.len())?;
    Ok(bytes)
}

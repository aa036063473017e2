//! Materials, textures, samplers and images, word for word; images with their bytes.

use std::collections::BTreeSet;

use serde_json::Value;

use super::Document;
use super::accessor::{Buffers, percent_decoded};
use crate::boundary::mtl;
use crate::boundary::source::{Image, Materials};

/// Takes the materials of a document.
pub(super) fn read<'a>(
    root: &Value,
    document: &'a Document,
    buffers: &mut Buffers<'a>,
    warnings: &mut Vec<String>,
) -> Materials {
    let array = |key: &str| root.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    let strings = |key: &str| array(key).iter().filter_map(|v| v.as_str().map(str::to_owned)).collect::<Vec<_>>();
    let mut result = Materials {
        materials: array("materials"),
        textures: array("textures"),
        samplers: array("samplers"),
        ..Materials::default()
    };
    for index in 0..document.images.len() {
        result.images.push(image(index, document, buffers, warnings));
    }
    let mut used = BTreeSet::new();
    for value in result.materials.iter().chain(&result.textures).chain(&result.samplers) {
        extensions(value, &mut used);
    }
    let variants = root.get("extensions").and_then(|e| e.get("KHR_materials_variants"));
    if let Some(variants) = variants {
        result.root_extensions.insert("KHR_materials_variants".into(), variants.clone());
        used.insert("KHR_materials_variants".into());
    }
    result.extensions_required = strings("extensionsRequired").into_iter().filter(|name| used.contains(name)).collect();
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

fn image<'a>(index: usize, document: &'a Document, buffers: &mut Buffers<'a>, warnings: &mut Vec<String>) -> Image {
    let file = &document.images[index];
    let by_uri = file.uri.as_deref().filter(|uri| !uri.starts_with("data:")).map(percent_decoded);
    let name = file.name.clone().or(by_uri).unwrap_or_else(|| format!("image {index}"));
    let bytes = match (&file.uri, file.buffer_view) {
        (Some(uri), _) => buffers.resource(uri).and_then(|bytes| buffers.spend(bytes.len()).map(|()| bytes.to_vec())),
        (None, Some(view)) => buffers.view(view).and_then(|bytes| buffers.spend(bytes.len()).map(|()| bytes.to_vec())),
        (None, None) => Err("it has no content".into()),
    };
    match bytes {
        Ok(bytes) => {
            let mime = mtl::mime_of(&bytes)
                .map(str::to_owned)
                .or_else(|| file.mime_type.clone())
                .unwrap_or_else(|| "image/png".into());
            Image { name, mime, bytes }
        }
        Err(why) => {
            warnings.push(format!("the image {name} is left white: {why}"));
            mtl::white(&name)
        }
    }
}

//! The document in the types of the `gltf` crate, with every index in range: from here on none of its calls can panic, save those
//! for accessors, which [`super::accessor`] checks.
//!
//! The crate's own validation is no help against broken files: it panics where POSITION refers to an accessor that is not there,
//! and refuses what viewers show (bounds left out, extensions that it does not know).

use gltf::json::mesh::Mode;
use gltf::json::validation::Checked;
use gltf::json::{Index, Material, Root};
use serde::Deserialize as _;
use serde_json::{Value, json};

use super::{malformed, no_such};

/// The document of a JSON from which the materials, so many, were taken.
pub(super) fn document(mut root: Value, materials: usize) -> Result<gltf::Document, String> {
    // Nobody asks for these; what extensions make of them would be refused for nothing.
    if let Some(root) = root.as_object_mut() {
        root.retain(|key, _| key != "animations" && key != "cameras");
    }
    complete(&mut root, "/scenes", "", ("nodes", json!([])));
    complete(&mut root, "/meshes", "/primitives", ("attributes", json!({})));
    let mut root = Root::deserialize(root).map_err(|why| malformed(&why))?;
    // Stand-ins: only their index is asked for.
    root.materials = vec![Material::default(); materials];
    repair(&mut root);
    check(&root)?;
    Ok(gltf::Document::from_json_without_validation(root))
}

/// Gives a member that the crate insists on to each object of a list, or of the lists within its objects.
fn complete(root: &mut Value, list: &str, inner: &str, (key, default): (&str, Value)) {
    let objects = root.pointer_mut(list).and_then(Value::as_array_mut).into_iter().flatten();
    let lists = objects.filter_map(|object| object.pointer_mut(inner));
    let complete_one = |object: &mut Value| {
        if let Some(object) = object.as_object_mut() {
            object.entry(key).or_insert_with(|| default.clone());
        }
    };
    for item in lists {
        match item {
            Value::Array(objects) => objects.iter_mut().for_each(complete_one),
            object => complete_one(object),
        }
    }
}

/// Takes away what cannot be used and does no harm.
fn repair(root: &mut Root) {
    let (scenes, materials) = (root.scenes.len(), root.materials.len());
    root.scene = root.scene.filter(|scene| scene.value() < scenes);
    for primitive in root.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        primitive.attributes.retain(|semantic, _| matches!(semantic, Checked::Valid(_)));
        primitive.material = primitive.material.filter(|material| material.value() < materials);
        if matches!(primitive.mode, Checked::Invalid) {
            // Left out, like points.
            primitive.mode = Checked::Valid(Mode::Points);
        }
    }
    for accessor in &mut root.accessors {
        accessor.sparse.take_if(|sparse| sparse.count.0 == 0);
    }
}

fn check(root: &Root) -> Result<(), String> {
    let nodes = |index: &Index<_>| below("node", index, root.nodes.len());
    let accessors = |index: &Index<_>| below("accessor", index, root.accessors.len());
    let views = |index: &Index<_>| below("buffer view", index, root.buffer_views.len());
    root.scenes.iter().flat_map(|scene| &scene.nodes).try_for_each(nodes)?;
    for node in &root.nodes {
        node.children.iter().flatten().try_for_each(nodes)?;
        node.mesh.iter().try_for_each(|mesh| below("mesh", mesh, root.meshes.len()))?;
        node.skin.iter().try_for_each(|skin| below("skin", skin, root.skins.len()))?;
    }
    for skin in &root.skins {
        skin.joints.iter().try_for_each(nodes)?;
        skin.inverse_bind_matrices.iter().try_for_each(accessors)?;
    }
    for primitive in root.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        primitive.attributes.values().chain(&primitive.indices).try_for_each(accessors)?;
        for target in primitive.targets.iter().flatten() {
            target.positions.iter().chain(&target.normals).chain(&target.tangents).try_for_each(accessors)?;
        }
    }
    for accessor in &root.accessors {
        accessor.buffer_view.iter().try_for_each(views)?;
        if let Some(sparse) = &accessor.sparse {
            [&sparse.indices.buffer_view, &sparse.values.buffer_view].into_iter().try_for_each(views)?;
        }
    }
    root.buffer_views.iter().try_for_each(|view| below("buffer", &view.buffer, root.buffers.len()))
}

fn below<T>(what: &str, index: &Index<T>, count: usize) -> Result<(), String> {
    if index.value() < count { Ok(()) } else { Err(no_such(what, index.value(), count)) }
}

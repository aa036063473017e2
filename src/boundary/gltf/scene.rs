//! The scene's nodes: who is whose parent, where each stands, and what hangs there.

use glam::{DMat4, DQuat, DVec3, DVec4};

use super::accessor::{Buffers, no_such};
use super::primitive::Gatherer;
use super::{Document, Node};
use crate::boundary::Boundary;

/// Gathers the meshes of the default scene.
pub(super) fn read<'a>(document: &'a Document, buffers: &mut Buffers<'a>) -> Result<Boundary, String> {
    let world = world_from_nodes(document)?;
    let mut gatherer = Gatherer::default();
    let mut waiting = scene_roots(document);
    waiting.reverse();
    let mut seen = vec![false; document.nodes.len()];
    while let Some(index) = waiting.pop() {
        let node = document.nodes.get(index).ok_or_else(|| no_such("node", index, document.nodes.len()))?;
        if std::mem::replace(&mut seen[index], true) {
            continue;
        }
        waiting.extend(node.children.iter().rev());
        let Some(mesh) = node.mesh else { continue };
        let mesh = document.meshes.get(mesh).ok_or_else(|| no_such("mesh", mesh, document.meshes.len()))?;
        let joints = joints(document, node, &world, buffers)?;
        gatherer
            .node(node, mesh, world[index], &joints, buffers)
            .map_err(|sentence| format!("node {index}: {sentence}"))?;
    }
    Ok(gatherer.finish())
}

/// Roots of the default scene; of the first where none is; every root where there is no scene.
fn scene_roots(document: &Document) -> Vec<usize> {
    if let Some(scene) = document.scenes.get(document.scene.unwrap_or(0)).or(document.scenes.first()) {
        return scene.nodes.clone();
    }
    let mut is_child = vec![false; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|node| &node.children) {
        is_child[child] = true;
    }
    (0..document.nodes.len()).filter(|&i| !is_child[i]).collect()
}

/// `[nodes]` where each stands in the world.
///
/// # Errors
///
/// A node that is its own ancestor, or has two parents: glTF allows trees only.
fn world_from_nodes(document: &Document) -> Result<Vec<DMat4>, String> {
    let count = document.nodes.len();
    let mut parent = vec![None; count];
    for (index, node) in document.nodes.iter().enumerate() {
        for &child in &node.children {
            let slot = parent.get_mut(child).ok_or_else(|| no_such("node", child, count))?;
            if slot.replace(index).is_some() {
                return Err(format!("node {child} has two parents; give each parent its own copy"));
            }
        }
    }
    let mut world = vec![DMat4::IDENTITY; count];
    let mut reached = vec![false; count];
    let mut waiting: Vec<usize> = (0..count).filter(|&i| parent[i].is_none()).collect();
    while let Some(index) = waiting.pop() {
        reached[index] = true;
        let own = local(&document.nodes[index]);
        world[index] = parent[index].map_or(own, |p| world[p] * own);
        waiting.extend(&document.nodes[index].children);
    }
    match reached.iter().position(|&r| !r) {
        Some(node) => Err(format!("node {node} is its own ancestor; take it out of its children")),
        None => Ok(world),
    }
}

fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    let rotation = node
        .rotation
        .map(DQuat::from_array)
        .filter(|q| q.length_squared() > 0.0)
        .map_or(DQuat::IDENTITY, DQuat::normalize);
    let (scale, translation) =
        (node.scale.map_or(DVec3::ONE, DVec3::from_array), node.translation.map_or(DVec3::ZERO, DVec3::from_array));
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}

/// A joint: what it does to a vertex of the skin, and its name.
pub(super) struct Joint {
    /// World from the mesh's own space, by way of the bind pose.
    pub world_from_mesh: DMat4,
    /// The name of its node, may be empty.
    pub name: String,
}

/// The joints of the node's skin (glTF 2.0, Sec. 3.7.3.3): jointMatrix = world_from_joint · inverseBindMatrix. The node's own
/// transform has no part in it.
fn joints(document: &Document, node: &Node, world: &[DMat4], buffers: &mut Buffers) -> Result<Vec<Joint>, String> {
    let Some(index) = node.skin else { return Ok(Vec::new()) };
    let skin = document.skins.get(index).ok_or_else(|| no_such("skin", index, document.skins.len()))?;
    buffers.spend(16 * skin.joints.len())?;
    let inverse_bind = skin.inverse_bind_matrices.map(|accessor| buffers.numbers(accessor)).transpose()?;
    if inverse_bind.as_ref().is_some_and(|m| m.width != 16 || m.count() < skin.joints.len()) {
        return Err(format!("skin {index} has fewer inverse bind matrices than joints; export the scene again"));
    }
    let matrix = |joint: usize| {
        inverse_bind
            .as_ref()
            .map_or(DMat4::IDENTITY, |m| DMat4::from_cols_slice(&m.values[16 * joint..16 * joint + 16]))
    };
    let joint = |(i, &node): (usize, &usize)| {
        let world = world.get(node).ok_or_else(|| no_such("node", node, world.len()))?;
        Ok(Joint { world_from_mesh: *world * matrix(i), name: document.nodes[node].name.clone().unwrap_or_default() })
    };
    skin.joints.iter().enumerate().map(joint).collect()
}

/// A point moved by a matrix, without a perspective that no node has.
pub(super) fn moved(matrix: &DMat4, point: DVec3) -> DVec3 {
    let moved: DVec4 = *matrix * point.extend(1.0);
    moved.truncate()
}

//! The scene's nodes: who is whose parent, where each stands, and what hangs there.

use glam::{DMat4, DQuat, DVec3, DVec4, Mat4, Quat, Vec3};

use gltf::scene::Transform;
use gltf::{Document, Node};

use super::accessor::Buffers;
use super::primitive::Gatherer;
use crate::boundary::Boundary;

/// Gathers the meshes of the default scene.
pub(super) fn read<'a>(document: &'a Document, buffers: &mut Buffers<'a>) -> Result<Boundary, String> {
    let world = world_from_nodes(document)?;
    let mut gatherer = Gatherer::default();
    let mut waiting = scene_roots(document);
    waiting.reverse();
    let mut seen = vec![false; document.nodes().len()];
    while let Some(node) = waiting.pop() {
        let index = node.index();
        if std::mem::replace(&mut seen[index], true) {
            continue;
        }
        let first_child = waiting.len();
        waiting.extend(node.children());
        waiting[first_child..].reverse();
        let Some(mesh) = node.mesh() else { continue };
        let joints = joints(&node, &world, buffers)?;
        gatherer
            .node(&node, &mesh, world[index], &joints, buffers)
            .map_err(|sentence| format!("node {index}: {sentence}"))?;
    }
    Ok(gatherer.finish())
}

/// Roots of the default scene; of the first where none is; every root where there is no scene.
fn scene_roots(document: &Document) -> Vec<Node<'_>> {
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        return scene.nodes().collect();
    }
    let mut is_child = vec![false; document.nodes().len()];
    for child in document.nodes().flat_map(|node| node.children()) {
        is_child[child.index()] = true;
    }
    document.nodes().filter(|node| !is_child[node.index()]).collect()
}

/// `[nodes]` where each stands in the world.
///
/// # Errors
///
/// A node that is its own ancestor, or has two parents: glTF allows trees only.
fn world_from_nodes(document: &Document) -> Result<Vec<DMat4>, String> {
    let count = document.nodes().len();
    let mut parent = vec![None; count];
    for node in document.nodes() {
        for child in node.children().map(|child| child.index()) {
            if parent[child].replace(node.index()).is_some() {
                return Err(format!("node {child} has two parents; give each parent its own copy"));
            }
        }
    }
    let mut world = vec![DMat4::IDENTITY; count];
    let mut reached = vec![false; count];
    let mut waiting: Vec<Node> = document.nodes().filter(|node| parent[node.index()].is_none()).collect();
    while let Some(node) = waiting.pop() {
        let index = node.index();
        reached[index] = true;
        let own = local(node.transform());
        world[index] = parent[index].map_or(own, |p| world[p] * own);
        waiting.extend(node.children());
    }
    match reached.iter().position(|&r| !r) {
        Some(node) => Err(format!("node {node} is its own ancestor; take it out of its children")),
        None => Ok(world),
    }
}

fn local(transform: Transform) -> DMat4 {
    match transform {
        Transform::Matrix { matrix } => Mat4::from_cols_array_2d(&matrix).as_dmat4(),
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = Quat::from_array(rotation).as_dquat();
            let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
            let [scale, translation] = [scale, translation].map(|v| Vec3::from_array(v).as_dvec3());
            DMat4::from_scale_rotation_translation(scale, rotation, translation)
        }
    }
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
fn joints<'a>(node: &Node<'a>, world: &[DMat4], buffers: &mut Buffers<'a>) -> Result<Vec<Joint>, String> {
    let Some(skin) = node.skin() else { return Ok(Vec::new()) };
    let count = skin.joints().len();
    buffers.spend(16 * count)?;
    let inverse_bind = skin.inverse_bind_matrices().map(|accessor| buffers.numbers(&accessor)).transpose()?;
    if inverse_bind.as_ref().is_some_and(|m| m.width != 16 || m.count() < count) {
        return Err(format!(
            "skin {} has fewer inverse bind matrices than joints; export the scene again",
            skin.index()
        ));
    }
    let matrix = |joint: usize| {
        inverse_bind
            .as_ref()
            .map_or(DMat4::IDENTITY, |m| DMat4::from_cols_slice(&m.values[16 * joint..16 * joint + 16]))
    };
    let joint = |(i, node): (usize, Node)| Joint {
        world_from_mesh: world[node.index()] * matrix(i),
        name: node.name().unwrap_or_default().to_owned(),
    };
    Ok(skin.joints().enumerate().map(joint).collect())
}

/// A point moved by a matrix, without a perspective that no node has.
pub(super) fn moved(matrix: &DMat4, point: DVec3) -> DVec3 {
    let moved: DVec4 = *matrix * point.extend(1.0);
    moved.truncate()
}

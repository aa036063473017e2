//! The system's dialogs for files.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::panel::Asked;

/// Nobody closes a dialog as soon as this after it was asked for: then there was none.
const UNSEEN: Duration = Duration::from_millis(250);

/// Files chosen in the system's dialog; none in it where it was cancelled, `None` where the system shows no dialog. Waits
/// for the user.
pub(super) fn choose(asked: Asked, proposed: &str) -> Option<Vec<PathBuf>> {
    let start = Instant::now();
    let files = shown(asked, proposed);
    (!files.is_empty() || start.elapsed() > UNSEEN).then_some(files)
}

fn shown(asked: Asked, proposed: &str) -> Vec<PathBuf> {
    const MESHES: [&str; 6] = ["glb", "gltf", "obj", "ply", "stl", "off"];
    const PICTURES: [&str; 4] = ["png", "jpg", "jpeg", "webp"];
    let all: Vec<&str> = MESHES.into_iter().chain(PICTURES).chain(["ron"]).collect();
    let is_picture = PICTURES.iter().any(|extension| proposed.ends_with(extension));
    let dialog = rfd::FileDialog::new();
    let one = |dialog: rfd::FileDialog| dialog.pick_file().into_iter().collect();
    let to = |dialog: rfd::FileDialog, name: &str, extensions: &[&str]| -> Vec<PathBuf> {
        dialog.set_file_name(proposed).add_filter(name, extensions).save_file().into_iter().collect()
    };
    match asked {
        Asked::Open => one(dialog
            .set_title("Open")
            .add_filter("Everything that opens", &all)
            .add_filter("Scenes", &["ron"])
            .add_filter("Meshes", &MESHES)
            .add_filter("Pictures", &PICTURES)),
        Asked::Values => one(dialog.set_title("Importance of vertices or regions").add_filter("Table", &["csv"])),
        Asked::Image => one(dialog.set_title("Importance as a picture").add_filter("Pictures", &PICTURES)),
        Asked::Regions => {
            let title = |title: &str| rfd::FileDialog::new().set_title(title);
            let regions = if is_picture {
                title("Which pixel belongs to which region: ids as grey values").add_filter("Pictures", &PICTURES)
            } else {
                title("Which vertex belongs to which region").add_filter("Table", &["csv"])
            };
            let Some(regions) = regions.pick_file() else { return Vec::new() };
            let values = title("What each region is worth").add_filter("Table", &["csv"]).pick_file();
            values.map(|values| vec![regions, values]).unwrap_or_default()
        }
        Asked::SaveScene => to(dialog.set_title("Save the scene"), "Scene", &["ron"]),
        Asked::ExportMesh if is_picture => to(dialog.set_title("Save the warped picture"), "Picture", &["png"]),
        Asked::ExportGrowth if !proposed.ends_with(".glb") => {
            to(dialog.set_title("Save the growth"), "Animation", &["gif", "apng", "glb"])
        }
        Asked::ExportMesh => to(dialog.set_title("Save the warped mesh"), "Mesh", &crate::panel::MESH_FORMATS),
        Asked::ExportGrowth => to(dialog.set_title("Save the growth"), "glTF", &["glb"]),
        Asked::ExportReport => to(dialog.set_title("Save the report"), "Report", &["json"]),
        Asked::ExportFilm => {
            let formats = ["mp4", "gif", "apng", "webm", "mov", "mkv", "webp"];
            to(dialog.set_title("Where to record the film"), "Film", &formats)
        }
    }
}

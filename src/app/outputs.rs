//! Where results go: decided and checked before the work begins.

use std::path::{Path, PathBuf};

use super::options::WarpOptions;
use crate::export::report::{self, Report};
use crate::scene::{Scene, Source};
use crate::{Error, Result};

/// Formats a mesh can be written in.
const MESH_EXTENSIONS: [&str; 5] = ["glb", "obj", "ply", "stl", "off"];

/// Formats the growth of a picture can be written in.
const FLAT_GROWTH_EXTENSIONS: [&str; 4] = ["glb", "apng", "png", "gif"];

/// The files to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Outputs {
    /// The warped mesh or picture.
    pub mesh: Option<PathBuf>,
    pub growth: Option<PathBuf>,
    pub report: Option<PathBuf>,
    pub scene: Option<PathBuf>,
}

impl Outputs {
    /// The files that the options name; a warped mesh beside the user where they name none.
    ///
    /// # Errors
    /// If a file could not be written at the end, or would overwrite an input or another output.
    pub fn of(options: &WarpOptions, scene: &Scene, is_picture: bool) -> Result<Self> {
        let nothing_named = options.output.is_none() && options.growth.is_none() && options.report.is_none();
        let outputs = Self {
            mesh: options.output.clone().or_else(|| nothing_named.then(|| default_result(&scene.source, is_picture))),
            growth: options.growth.clone(),
            report: options.report.clone(),
            scene: options.scene.save_scene.clone(),
        };
        check_extension(&outputs.mesh, "-o", if is_picture { &["png"] } else { &MESH_EXTENSIONS })?;
        check_extension(&outputs.growth, "--growth", if is_picture { &FLAT_GROWTH_EXTENSIONS } else { &["glb"] })?;
        check_extension(&outputs.report, "--report", &["json"])?;
        check_extension(&outputs.scene, "--save-scene", &["ron"])?;

        check_places(scene, outputs.all())?;
        Ok(outputs)
    }

    /// A report is due for a result that is not certified: where it was ordered, else beside the result.
    pub fn report_beside(&self) -> Option<PathBuf> {
        let beside = || self.mesh.as_ref().or(self.growth.as_ref()).map(|path| path.with_extension("report.json"));
        self.report.clone().or_else(beside)
    }

    /// Writes report and scene where they are due: the same for bodies and pictures. Returns where.
    ///
    /// # Errors
    /// If one cannot be written.
    pub fn write_accounts(&self, scene: &Scene, report: &Report) -> Result<Vec<PathBuf>> {
        let mut written = Vec::new();
        let report_path = if report.certified() { self.report.clone() } else { self.report_beside() };
        if let Some(path) = report_path {
            report::write(report, &path)?;
            written.push(path);
        }
        if let Some(path) = &self.scene {
            scene.save(path)?;
            written.push(path.clone());
        }
        Ok(written)
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        [&self.mesh, &self.growth, &self.report, &self.scene].into_iter().flatten().map(PathBuf::as_path)
    }
}

/// Whether these files can come to lie where they are wanted, and are neither inputs of the scene nor each other.
pub(super) fn check_places<'a>(scene: &Scene, paths: impl Iterator<Item = &'a Path>) -> Result<()> {
    let mut taken: Vec<PathBuf> = scene.files().into_iter().map(identity).collect();
    for path in paths {
        check_place(path)?;
        let identity = identity(path);
        if taken.contains(&identity) {
            let sentence = "it is an input or another output of this run; give the result another name";
            return Err(Error::in_file(path, sentence));
        }
        taken.push(identity);
    }
    Ok(())
}

/// `NAME-warped.EXT` in the working directory, in the input's format where it can be written; of a picture PNG.
fn default_result(source: &Source, is_picture: bool) -> PathBuf {
    let (name, extension) = match source {
        Source::Gallery(name) => (name.clone(), None),
        Source::File(path) => {
            let name = path.file_stem().map_or_else(|| "mesh".into(), |stem| stem.to_string_lossy().into_owned());
            (name, extension(path))
        }
    };
    let written = extension.filter(|e| MESH_EXTENSIONS.contains(&e.as_str())).unwrap_or_else(|| "glb".into());
    let extension = if is_picture { "png".into() } else { written };
    // A gallery name comes from the user: only its last part may become a file name.
    let name = name.rsplit(['/', '\\']).next().unwrap_or("mesh").to_owned();
    PathBuf::from(format!("{name}-warped.{extension}"))
}

fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

pub(super) fn check_extension(path: &Option<PathBuf>, option: &str, known: &[&str]) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    if extension(path).is_some_and(|e| known.contains(&e.as_str())) {
        return Ok(());
    }
    let known = known.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ");
    Err(Error::in_file(path, format!("{option} wants a file that ends in {known}")))
}

/// Whether a file can come to lie there.
fn check_place(path: &Path) -> Result<()> {
    if path.is_dir() {
        return Err(Error::in_file(path, "it is a directory; give a file"));
    }
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            Err(Error::in_file(path, format!("the directory {} does not exist; create it first", folder.display())))
        }
        _ => Ok(()),
    }
}

/// The same path for the same file, whether it exists or not.
fn identity(path: &Path) -> PathBuf {
    if let Ok(real) = path.canonicalize() {
        return real;
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.into(),
    }
}

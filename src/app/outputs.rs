//! Where results go: decided and checked before the work begins.

use std::path::{Path, PathBuf};

use super::cancel;
use super::options::WarpOptions;
use crate::export::report::{self, Report};
use crate::format::{Kind, Use};
use crate::scene::{Scene, Source};
use crate::subject::{Grown, Look, Subject};
use crate::{Error, Result};

/// The files to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Outputs {
    /// The warped mesh or picture.
    result: Option<PathBuf>,
    growth: Option<PathBuf>,
    report: Option<PathBuf>,
    scene: Option<PathBuf>,
}

impl Outputs {
    /// The files that the options name; the result beside the user where they name none.
    ///
    /// # Errors
    /// If a file could not be written at the end, or would overwrite an input or another output.
    pub fn of(options: &WarpOptions, scene: &Scene, kind: Kind) -> Result<Self> {
        let nothing_named = options.output.is_none() && options.growth.is_none() && options.report.is_none();
        let outputs = Self {
            result: options.output.clone().or_else(|| nothing_named.then(|| default_result(&scene.source, kind))),
            growth: options.growth.clone(),
            report: options.report.clone(),
            scene: options.scene.save_scene.clone(),
        };
        check_extension(&outputs.result, "-o", Use::Result(kind))?;
        check_extension(&outputs.growth, "--growth", Use::Growth(kind))?;
        check_extension(&outputs.report, "--report", Use::Report)?;
        check_extension(&outputs.scene, "--save-scene", Use::Scene)?;
        check_places(scene, outputs.all())?;
        Ok(outputs)
    }

    /// Writes what was ordered, each file whole or not at all; a report also where the result is not certified, beside it.
    /// Returns where.
    ///
    /// # Errors
    /// If one cannot be written, or the user stops it.
    pub fn write(
        &self,
        subject: &dyn Subject,
        grown: &Grown,
        look: &Look,
        scene: &Scene,
        report: &Report,
    ) -> Result<Vec<PathBuf>> {
        let beside = || self.result.as_ref().or(self.growth.as_ref()).map(|path| path.with_extension("report.json"));
        let due = self.report.clone().or_else(|| if report.certified() { None } else { beside() });
        if let Some(path) = &self.result {
            subject.write_result(grown, look, path)?;
        }
        if let Some(path) = &self.growth {
            subject.write_growth(grown, look, path, &cancel::asked)?;
        }
        if let Some(path) = &due {
            report::write(report, path)?;
        }
        if let Some(path) = &self.scene {
            scene.save(path)?;
        }
        Ok([&self.result, &self.growth, &due, &self.scene].into_iter().flatten().cloned().collect())
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        [&self.result, &self.growth, &self.report, &self.scene].into_iter().flatten().map(PathBuf::as_path)
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

/// `NAME-warped.EXT` in the working directory, in the input's format where it can be written.
fn default_result(source: &Source, kind: Kind) -> PathBuf {
    let written = Use::Result(kind).extensions();
    let (name, extension) = match source {
        Source::Gallery(name) => (name.clone(), None),
        Source::File(path) => {
            let name = path.file_stem().map_or_else(|| "mesh".into(), |stem| stem.to_string_lossy().into_owned());
            let is_it = |known: &&&str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(known));
            (name, written.iter().find(is_it))
        }
    };
    let extension = extension.or(written.first()).copied().unwrap_or_default();
    // A gallery name comes from the user: only its last part may become a file name.
    let name = name.rsplit(['/', '\\']).next().unwrap_or("mesh");
    PathBuf::from(format!("{name}-warped.{extension}"))
}

/// Whether the file's name says that it is for this use.
pub(super) fn check_extension(path: &Option<PathBuf>, option: &str, what: Use) -> Result<()> {
    match path {
        Some(path) if what.of(path).is_none() => {
            Err(Error::in_file(path, format!("{option} wants a file that ends in {}", what.listed())))
        }
        _ => Ok(()),
    }
}

/// One line for a person.
pub(super) fn summary(report: &Report, written: &[PathBuf]) -> String {
    let certificate = &report.certificate;
    let verdict = if certificate.certified { "certified" } else { "NOT CERTIFIED" };
    let files = written.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    format!(
        "{verdict}: {} inverted, {} crossings in {} frames; size error p95 {:.1} %; written: {files}",
        certificate.inverted,
        certificate.crossings,
        certificate.frames.len(),
        report.fidelity.p95 * 100.0,
    )
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

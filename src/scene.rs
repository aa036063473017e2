//! What to warp and how: one validated struct, read from RON, command line and panels alike.
//!
//! A scene file:
//! ```ron
//! (
//!     version: 1,
//!     source: "body.obj",        // relative to this file, or "gallery:NAME"
//!     base: 1.0,
//!     layers: [
//!         Sphere(centre: (0.7, 1.4, 0.0), radius: 0.2, value: 2.5),
//!         Values(path: "importance.csv"),
//!     ],
//!     resolution: 96,
//! )
//! ```
//! All but `version` and `source` may be left out. Layers apply in the order given.

use std::fmt;
use std::io::Write as _;
use std::ops::Deref;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::file::write_atomically;
use crate::format::Kind;
use crate::gallery;
use crate::importance::Layer;
use crate::paint::Edit;
use crate::settings::Settings;
use crate::voxel::{check_flat_resolution, check_resolution};
use crate::{Error, Result};

/// The version of scene files this program writes and reads.
pub const VERSION: u32 = 1;

/// Where the boundary comes from, written `gallery:NAME` or as a path.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum Source {
    /// A mesh file.
    File(PathBuf),
    /// A built-in model.
    Gallery(String),
}

impl Source {
    /// What its name says it is; a picture by another name has the resolution of a body as its limit.
    pub fn kind(&self) -> Kind {
        match self {
            Self::File(path) => Kind::of_name(path),
            Self::Gallery(_) => self.entry().map_or(Kind::Body, |entry| entry.kind),
        }
    }

    /// Its line in the gallery's list, if it is there.
    fn entry(&self) -> Option<gallery::Entry> {
        match self {
            Self::File(_) => None,
            Self::Gallery(name) => gallery::everything().find(|entry| entry.name == name),
        }
    }
}

impl From<String> for Source {
    fn from(text: String) -> Self {
        match text.strip_prefix("gallery:") {
            Some(name) => Self::Gallery(name.into()),
            None => Self::File(text.into()),
        }
    }
}

impl From<Source> for String {
    fn from(source: Source) -> Self {
        source.to_string()
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Gallery(name) => write!(f, "gallery:{name}"),
        }
    }
}

/// A scene as written, not yet checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub struct Draft {
    /// Version of the format.
    pub version: u32,
    /// What to warp.
    pub source: Source,
    /// Importance below all layers, > 0.
    #[serde(default = "defaults::base")]
    pub base: f32,
    /// Bring importance that is out of range into it, rather than refuse it.
    #[serde(default)]
    pub clamp: bool,
    /// Importance, from the bottom up.
    #[serde(default)]
    pub layers: Vec<Layer>,
    /// Indices of layers that are left out for now.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hidden: Vec<usize>,
    /// What was painted over the layers, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub strokes: Vec<Edit>,
    /// Cells along the longest axis, [`MIN_RESOLUTION`](crate::voxel::MIN_RESOLUTION)`..=`[`MAX_RESOLUTION`](crate::voxel::MAX_RESOLUTION).
    #[serde(default = "defaults::resolution")]
    pub resolution: u32,
    /// μ in 0..=1: 0 keeps shape, 1 reaches the size asked for.
    #[serde(default = "defaults::fidelity")]
    pub fidelity: f32,
    /// Keyframes of the growth, 1..=[`MAX_KEYS`](crate::settings::MAX_KEYS).
    #[serde(default = "defaults::keys")]
    pub keys: usize,
    /// Of a picture: the colour and tolerance of its background, `COLOUR,TOLERANCE`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub background: Option<String>,
}

mod defaults {
    pub(super) fn base() -> f32 {
        1.0
    }
    pub(super) fn resolution() -> u32 {
        64
    }
    pub(super) fn fidelity() -> f32 {
        0.5
    }
    pub(super) fn keys() -> usize {
        8
    }
}

impl Draft {
    /// A scene with nothing but a source.
    pub fn of(source: Source) -> Self {
        Self {
            version: VERSION,
            source,
            base: defaults::base(),
            clamp: false,
            layers: Vec::new(),
            hidden: Vec::new(),
            strokes: Vec::new(),
            resolution: defaults::resolution(),
            fidelity: defaults::fidelity(),
            keys: defaults::keys(),
            background: None,
        }
    }

    /// The same with settings that suit it: those suggested of a built-in scene, else those that are usual for its kind.
    pub fn fresh(source: &Source) -> Self {
        let (resolution, fidelity) =
            source.entry().map_or_else(|| source.kind().usual(), |entry| (entry.resolution, entry.fidelity));
        Self { resolution, fidelity, ..Self::of(source.clone()) }
    }
}

/// A scene that has been checked. It reads like its [`Draft`]; to change it, change a draft and check again.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene(Draft);

impl Deref for Scene {
    type Target = Draft;

    fn deref(&self) -> &Draft {
        &self.0
    }
}

impl Scene {
    /// Checks a draft. This is the only way to make a scene.
    ///
    /// # Errors
    /// One sentence with the field, its value and its range.
    pub fn new(draft: Draft) -> Result<Self> {
        if draft.version != VERSION {
            let sentence = format!("scene version {} is not known; this program reads {VERSION}", draft.version);
            return Err(Error::input(sentence));
        }
        if draft.source.kind().is_flat() {
            check_flat_resolution(draft.resolution)?;
        } else {
            check_resolution(draft.resolution)?;
        }
        draft.settings().check()?;
        let base_may_be = draft.base > 0.0 && draft.base.is_finite();
        if !(base_may_be || draft.clamp) {
            return Err(Error::input(format!("base {} is not greater than 0 and finite", draft.base)));
        }
        match &draft.source {
            Source::File(path) if path.as_os_str().is_empty() => {
                Err(Error::input("the source is empty; give a mesh file or gallery:NAME"))
            }
            _ => Ok(Self(draft)),
        }
    }

    /// Reads a scene file; its paths come out relative to the working directory.
    ///
    /// # Errors
    /// Names the file, the line and what is wrong there.
    pub fn load(path: &Path) -> Result<Self> {
        /// What every version has.
        #[derive(Deserialize)]
        struct Versioned {
            version: u32,
        }
        let text = std::fs::read_to_string(path).map_err(|e| Error::reading(path, e))?;
        let misread = |e: ron::error::SpannedError| {
            Error::in_file(path, format!("line {}: {}; correct the scene there", e.span.start.line, e.code))
        };
        let version = format().from_str::<Versioned>(&text).map_err(misread)?.version;
        if version != VERSION {
            let sentence = format!("scene version {version} is not known; this program reads {VERSION}");
            return Err(Error::in_file(path, sentence));
        }
        let draft = format().from_str(&text).map_err(misread)?;
        let Self(mut draft) = Self::new(draft).map_err(|e| Error::in_file(path, e))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        draft.map_files(|file| folder.join(file));
        Ok(Self(draft))
    }

    /// Writes a scene file; its paths are written relative to it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        let mut draft = self.0.clone();
        let folder = path.parent().unwrap_or(Path::new(""));
        draft.map_files(|file| relative(file, folder));
        let pretty = ron::ser::PrettyConfig::new();
        let text = format().to_string_pretty(&draft, pretty).map_err(|e| Error::Fault(format!("scene to RON: {e}")))?;
        write_atomically(path, |file| writeln!(file, "{text}"))
    }

    /// The layers that are not left out.
    pub fn shown_layers(&self) -> Vec<Layer> {
        let layers = self.layers.iter().enumerate();
        layers.filter(|(index, _)| !self.hidden.contains(index)).map(|(_, layer)| layer.clone()).collect()
    }

    /// Every file the scene reads.
    pub fn files(&self) -> Vec<&Path> {
        let source = match &self.source {
            Source::File(path) => Some(path.as_path()),
            Source::Gallery(_) => None,
        };
        source.into_iter().chain(self.layers.iter().flat_map(Layer::files)).collect()
    }

    /// The draft to change.
    pub fn into_draft(self) -> Draft {
        self.0
    }
}

impl Draft {
    /// How it is solved, by the method itself.
    pub fn settings(&self) -> Settings {
        Settings { resolution: self.resolution, fidelity: self.fidelity, keys: self.keys, reference: None }
    }

    fn map_files(&mut self, f: impl Fn(&Path) -> PathBuf) {
        if let Source::File(path) = &mut self.source {
            *path = f(path);
        }
        self.layers = std::mem::take(&mut self.layers).into_iter().map(|layer| layer.map_files(&f)).collect();
    }
}

/// RON in which `range: (0.5, 2.0)` need not be written `Some((0.5, 2.0))`.
fn format() -> ron::Options {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}

/// `file` as seen from `folder`; absolute where there is no relative way.
fn relative(file: &Path, folder: &Path) -> PathBuf {
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let full = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path));
    let (Ok(file_at), Ok(folder_at)) = (full(file), full(here)) else {
        return file.into();
    };
    let common = file_at.components().zip(folder_at.components()).take_while(|(a, b)| a == b).count();
    let below_root = file_at.components().take(common).any(|c| matches!(c, Component::Normal(_)));
    if !below_root {
        return file_at;
    }
    let up = folder_at.components().skip(common).map(|_| Component::ParentDir);
    up.chain(file_at.components().skip(common)).collect()
}

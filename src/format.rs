//! Kinds of files by the endings of their names: the one place that says what is read, written and offered.
//!
//! Readers go by content where it tells; names matter where a file is yet to be written, and in dialogs.

use std::path::Path;

use Use::{Film, Growth, Report, Result, Scene, Source, Table};

/// What can be warped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A mesh, in space.
    Body,
    /// A picture, in the plane.
    Picture,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Body, Self::Picture];

    /// What a user calls such a file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Body => "mesh",
            Self::Picture => "picture",
        }
    }

    /// Whether it lies in the plane: it is looked at straight on, and the third axis means nothing.
    pub fn is_flat(self) -> bool {
        match self {
            Self::Body => false,
            Self::Picture => true,
        }
    }

    /// Cells along the longest side and μ where nothing is said. A picture's cells are about as fine as its detail, in a
    /// second or two.
    pub fn usual(self) -> (u32, f32) {
        match self {
            Self::Body => (64, 0.5),
            Self::Picture => (128, 1.0),
        }
    }

    /// The kind that a file's name tells; a body where it tells none.
    pub fn of_name(path: &Path) -> Self {
        Self::ALL.into_iter().find(|kind| Source(*kind).of(path).is_some()).unwrap_or(Self::Body)
    }
}

/// What a file is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// Read, to be warped.
    Source(Kind),
    /// Read: values of importance.
    Table,
    /// Read and written: a scene.
    Scene,
    /// Written: what was warped.
    Result(Kind),
    /// Written: its growth.
    Growth(Kind),
    /// Written: what was asked, achieved and proven.
    Report,
    /// Written: a film of the growth.
    Film,
}

/// A kind of file.
struct Format {
    /// What names end in, small letters.
    extension: &'static str,
    /// Other endings that stand for the same. They are taken, not offered.
    also: &'static [&'static str],
    uses: &'static [Use],
}

const fn format(extension: &'static str, uses: &'static [Use]) -> Format {
    Format { extension, also: &[], uses }
}

const BODY: Kind = Kind::Body;
const PICTURE: Kind = Kind::Picture;

/// All of them, in the order in which they are offered.
static FORMATS: [Format; 19] = [
    format("mp4", &[Film]),
    format("gif", &[Growth(PICTURE), Film]),
    Format { also: &["png"], ..format("apng", &[Growth(PICTURE), Film]) },
    format("glb", &[Source(BODY), Result(BODY), Growth(BODY), Growth(PICTURE)]),
    format("gltf", &[Source(BODY)]),
    format("obj", &[Source(BODY), Result(BODY)]),
    format("ply", &[Source(BODY), Result(BODY)]),
    format("stl", &[Source(BODY), Result(BODY)]),
    Format { also: &["coff", "noff"], ..format("off", &[Source(BODY), Result(BODY)]) },
    format("png", &[Source(PICTURE), Result(PICTURE)]),
    format("jpg", &[Source(PICTURE)]),
    format("jpeg", &[Source(PICTURE)]),
    format("webp", &[Source(PICTURE), Film]),
    format("webm", &[Film]),
    format("mov", &[Film]),
    format("mkv", &[Film]),
    format("ron", &[Scene]),
    format("csv", &[Table]),
    format("json", &[Report]),
];

impl Use {
    fn formats(self) -> impl Iterator<Item = &'static Format> {
        FORMATS.iter().filter(move |format| format.uses.contains(&self))
    }

    /// The endings of such files, in the order in which they are offered.
    pub fn extensions(self) -> Vec<&'static str> {
        self.formats().map(|format| format.extension).collect()
    }

    /// The ending by which the format is known, where the name is that of such a file: `off` for `a.COFF`.
    pub fn of(self, path: &Path) -> Option<&'static str> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        let is_it = |format: &&Format| format.extension == ending || format.also.contains(&ending.as_str());
        self.formats().find(is_it).map(|format| format.extension)
    }

    /// `.a, .b or .c`, for sentences.
    pub fn listed(self) -> String {
        let endings: Vec<String> = self.extensions().iter().map(|extension| format!(".{extension}")).collect();
        match &endings[..] {
            [all @ .., last] if !all.is_empty() => format!("{} or {last}", all.join(", ")),
            few => few.concat(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_what_files_are_for() {
        let of = |what: Use, name: &str| what.of(Path::new(name));
        assert_eq!(of(Result(BODY), "a/b.GLB"), Some("glb"));
        assert_eq!(of(Result(BODY), "b.gltf"), None, "read and not written");
        assert_eq!(of(Source(BODY), "b.coff"), Some("off"));
        assert_eq!(of(Growth(PICTURE), "b.png"), Some("apng"));
        assert_eq!(of(Growth(BODY), "b.gif"), None);
        assert_eq!(of(Report, "json"), None);
        assert_eq!(Kind::of_name(Path::new("b.JPEG")), PICTURE);
        assert_eq!(Kind::of_name(Path::new("b")), BODY);
        assert_eq!(Result(BODY).listed(), ".glb, .obj, .ply, .stl or .off");
        assert_eq!(Result(PICTURE).listed(), ".png");
    }

    #[test]
    fn no_ending_has_two_meanings_in_one_use() {
        let uses: Vec<Use> = FORMATS.iter().flat_map(|format| format.uses).copied().collect();
        for what in uses {
            let mut all: Vec<&str> = what.formats().flat_map(|f| f.also.iter().copied().chain([f.extension])).collect();
            let count = all.len();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), count, "{what:?}");
        }
    }
}

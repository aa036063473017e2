//! One error type. Each message is one sentence: what is wrong, where, and what to do about it.

use std::path::{Path, PathBuf};

/// The library's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong between a file and its warped copy.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input or an option is bad; the sentence says which element and what to do. Exit code 2.
    #[error("{0}")]
    Input(String),
    /// A file could not be read or written. Exit code 2 when reading, 1 when writing.
    #[error("{}: {what}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What was tried: "cannot read", "cannot write".
        what: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The user asked to stop. Nothing was written. Exit code 1.
    #[error("stopped at your request; nothing was written")]
    Cancelled,
    /// A promise of our own is broken: a fault of this program, not of the input. Exit code 1.
    #[error("internal fault: {0}; please report it with the input")]
    Fault(String),
}

impl Error {
    /// A bad input, as one sentence.
    pub fn input(sentence: impl Into<String>) -> Self {
        Self::Input(sentence.into())
    }

    /// A file that cannot be read.
    pub fn reading(path: &Path, source: std::io::Error) -> Self {
        Self::File { path: path.into(), what: "cannot read", source }
    }

    /// A file that cannot be written.
    pub fn writing(path: &Path, source: std::io::Error) -> Self {
        Self::File { path: path.into(), what: "cannot write", source }
    }

    /// A bad input in a file, as `file: sentence`.
    pub fn in_file(path: &Path, sentence: impl std::fmt::Display) -> Self {
        Self::Input(format!("{}: {sentence}", path.display()))
    }
}

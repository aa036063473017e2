//! A file on its way to its name.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use crate::export::beside;
use crate::{Error, Result};

/// Where a file is written until it is whole. Dropped before that, it is gone.
pub(super) struct Target {
    path: PathBuf,
    temporary: TempPath,
}

/// What encoders write to.
pub(super) type Sink = BufWriter<std::fs::File>;

impl Target {
    /// A temporary file beside `path`, and where to write.
    pub fn new(path: &Path) -> Result<(Self, Sink)> {
        let (folder, builder) = beside(path);
        let temporary = builder.tempfile_in(folder).map_err(|e| Error::writing(path, e))?;
        let (file, temporary) = NamedTempFile::into_parts(temporary);
        Ok((Self { path: path.into(), temporary }, BufWriter::new(file)))
    }

    /// The temporary file.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// The error that writing met.
    pub fn failed(&self, source: impl Into<io::Error>) -> Error {
        Error::writing(&self.path, source.into())
    }

    /// Writes out what is left, and gives the file its name.
    pub fn finish(self, mut sink: Sink) -> Result<()> {
        sink.flush().map_err(|e| self.failed(e))?;
        drop(sink);
        self.name()
    }

    /// Gives the file, written by someone else, its name.
    pub fn name(self) -> Result<()> {
        self.temporary.persist(&self.path).map_err(|e| Error::writing(&self.path, e.error))
    }
}

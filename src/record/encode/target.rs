//! Files on their way to their names.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempDir, TempPath};

use crate::file::beside;
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

    /// Writes out what is left.
    pub fn finish(self, mut sink: Sink) -> Result<Whole> {
        sink.flush().map_err(|e| self.failed(e))?;
        Ok(self.whole())
    }

    /// The file, all of it written by someone else.
    pub fn whole(self) -> Whole {
        Whole { path: self.path, temporary: Temporary::File(self.temporary) }
    }
}

/// A file or folder that is complete and waits for its name. Dropped without, it is gone.
pub struct Whole {
    path: PathBuf,
    temporary: Temporary,
}

enum Temporary {
    File(TempPath),
    Folder(TempDir),
}

impl Whole {
    /// A folder.
    pub(super) fn folder(path: PathBuf, temporary: TempDir) -> Self {
        Self { path, temporary: Temporary::Folder(temporary) }
    }

    /// Bytes on the disk.
    pub fn bytes(&self) -> u64 {
        let size = |path: &Path| std::fs::metadata(path).map_or(0, |m| m.len());
        match &self.temporary {
            Temporary::File(file) => size(file),
            Temporary::Folder(folder) => {
                let entries = std::fs::read_dir(folder.path()).into_iter().flatten().flatten();
                entries.map(|entry| size(&entry.path())).sum()
            }
        }
    }

    /// Gives it its name.
    ///
    /// # Errors
    /// [`Error::File`] where the system refuses; it is gone then.
    pub fn name(self) -> Result<()> {
        let Self { path, temporary } = self;
        match temporary {
            Temporary::File(file) => file.persist(&path).map_err(|e| Error::writing(&path, e.error)),
            Temporary::Folder(folder) => {
                // An empty folder of that name gives way.
                std::fs::rename(folder.path(), &path).map_err(|e| Error::writing(&path, e))?;
                // It has another name now, and stays.
                let _ = folder.keep();
                Ok(())
            }
        }
    }
}

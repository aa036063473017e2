//! What is remembered between sessions: files opened lately, and a copy of unsaved work for the case of a crash.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::file::write_atomically;
use crate::scene::Scene;
use crate::{Error, Result};

/// Files that are remembered.
const MOST_RECENT: usize = 12;

/// Where the program keeps its own files.
#[derive(Debug, Clone)]
pub struct Memory {
    /// `None` where the system has no place for them: nothing is remembered then.
    folder: Option<PathBuf>,
    recent: Vec<PathBuf>,
    can_restore: bool,
}

impl Memory {
    /// Reads what is remembered in the folder, or in the user's own if none is given.
    pub fn open(folder: Option<PathBuf>) -> Self {
        let own = || Some(directories::ProjectDirs::from("", "", "homunculus")?.data_local_dir().to_owned());
        let folder = folder.or_else(own).filter(|folder| std::fs::create_dir_all(folder).is_ok());
        let mut memory = Self { folder, recent: Vec::new(), can_restore: false };
        memory.can_restore = memory.autosave().is_some_and(|path| path.is_file());
        if let Some(text) = memory.path("recent.ron").and_then(|path| std::fs::read_to_string(path).ok()) {
            // A list that cannot be read is an empty one.
            memory.recent = ron::from_str(&text).unwrap_or_default();
        }
        memory
    }

    fn path(&self, name: &str) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(name))
    }

    /// Where unsaved work is kept.
    pub fn autosave(&self) -> Option<PathBuf> {
        self.path("autosave.ron")
    }

    /// Files opened lately that are still there, the last first.
    pub fn recent(&self) -> &[PathBuf] {
        &self.recent
    }

    /// Remembers a file.
    pub fn note(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.into());
        self.recent.retain(|other| *other != path && other.exists());
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
        if let (Some(file), Ok(text)) = (self.path("recent.ron"), ron::to_string(&self.recent)) {
            // A list that cannot be written is only shorter next time.
            let _ = write_atomically(&file, |file| writeln!(file, "{text}"));
        }
    }

    /// Whether the session before ended without being closed.
    pub fn can_restore(&self) -> bool {
        self.can_restore
    }

    /// That session is of no interest any more, or has been restored.
    pub fn forget(&mut self) {
        self.can_restore = false;
    }

    /// The program is being closed: nothing is to be restored, unless what could be was not asked for yet.
    pub fn close(&self) {
        if let Some(path) = self.autosave().filter(|_| !self.can_restore) {
            // What is not there needs not go.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Keeps a copy of unsaved work.
///
/// # Errors
/// If it cannot be written.
pub fn keep(scene: &Result<Scene>, path: &Path) -> Result<()> {
    match scene {
        Ok(scene) => scene.save(path),
        Err(error) => Err(Error::in_file(path, error)),
    }
}

//! Files that hold either all of their new content or what they held before.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use crate::{Error, Result};

/// Writes a file so that its name holds either the whole new content or what it held before.
///
/// The content goes to a temporary file in the same folder, which takes the name at the end.
///
/// # Errors
///
/// [`Error::File`] where the system refuses or `write` fails.
pub fn write_atomically(path: &Path, write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>) -> Result<()> {
    let cannot_write = |source| Error::File { path: path.to_path_buf(), what: "cannot write", source };
    let (folder, builder) = beside(path);
    let mut temporary = builder.tempfile_in(folder).map_err(cannot_write)?;
    let mut buffered = BufWriter::new(temporary.as_file_mut());
    write(&mut buffered).and_then(|()| buffered.flush()).map_err(cannot_write)?;
    drop(buffered);
    temporary.persist(path).map_err(|error| cannot_write(error.error))?;
    Ok(())
}

/// Where a temporary file lies that is to take the name `path`, and what makes it.
pub(crate) fn beside(path: &Path) -> (&Path, tempfile::Builder<'static, 'static>) {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".homunculus-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // As any new file: the user's mask narrows it.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    (folder, builder)
}

//! Whether there is a display to open a window on, asked before the windowing library is, which would only panic.

use std::env;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// Looks for a display server that answers.
///
/// # Errors
/// One sentence that says what to set.
pub(super) fn check() -> Result<()> {
    let variable = |name: &str| env::var_os(name).filter(|value| !value.is_empty());
    let wayland = variable("WAYLAND_DISPLAY").map(|name| match variable("XDG_RUNTIME_DIR") {
        Some(folder) => Path::new(&folder).join(name),
        None => PathBuf::from(name),
    });
    if wayland.is_some_and(|socket| UnixStream::connect(socket).is_ok()) {
        return Ok(());
    }
    let Some(display) = variable("DISPLAY").map(|display| display.to_string_lossy().into_owned()) else {
        return Err(Error::input(
            "there is no display to open a window on: run it in a desktop session, or set DISPLAY or WAYLAND_DISPLAY",
        ));
    };
    match local_number(&display) {
        Some(number) if UnixStream::connect(format!("/tmp/.X11-unix/X{number}")).is_err() => {
            let sentence =
                format!("no display server answers at DISPLAY={display}: start one there, or correct DISPLAY");
            Err(Error::input(sentence))
        }
        // A display on another machine is the windowing library's to reach.
        _ => Ok(()),
    }
}

/// The number of a display on this machine: `:0`, `:0.1`, `unix:0`.
fn local_number(display: &str) -> Option<u32> {
    let (host, rest) = display.split_once(':')?;
    if !host.is_empty() && host != "unix" {
        return None;
    }
    rest.split('.').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::local_number;

    #[test]
    fn displays_on_this_machine_are_told_from_others() {
        assert_eq!(local_number(":0"), Some(0));
        assert_eq!(local_number(":99.0"), Some(99));
        assert_eq!(local_number("unix:1"), Some(1));
        assert_eq!(local_number("host:0"), None);
        assert_eq!(local_number("nonsense"), None);
    }
}

//! Ctrl-C: asks the engine to stop, so that files are whole or not there.

use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// From here on Ctrl-C (and being told to terminate) asks rather than kills.
pub(super) fn listen() {
    // Fails only where a handler is set already, which then is this one.
    let _ = ctrlc::set_handler(|| ASKED.store(true, Ordering::Relaxed));
}

/// Whether the user has asked to stop.
pub(super) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

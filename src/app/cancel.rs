//! Ctrl-C: asks the engine to stop, so that files are whole or not there. A second one ends the program at once: what it was
//! writing stays under a temporary name.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use super::note;

/// As for whoever waits for the first one to be heard.
const ENDED: i32 = 1;

static ASKED: AtomicBool = AtomicBool::new(false);

/// From here on Ctrl-C (and being told to terminate) asks rather than kills.
pub(super) fn listen() {
    // Fails only where a handler is set already, which then is this one.
    let _ = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::Relaxed) {
            note("ended at once; a file that was being written may be left as .homunculus-*.part");
            process::exit(ENDED);
        }
    });
}

/// Whether the user has asked to stop.
pub(super) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

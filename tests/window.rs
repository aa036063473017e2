//! Contract of the window.
#![cfg(feature = "window")]

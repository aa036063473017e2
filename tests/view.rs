//! Contract of the view.
#![cfg(feature = "render")]

#[test]
fn placeholder() {}

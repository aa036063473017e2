//! Contract of memory: every input that once broke a promise is kept, and keeps it now. Each test says in a sentence
//! which promise it broke and when that was mended. An input is never taken away from here.

#[path = "../common/mod.rs"]
mod common;

mod blends;
mod files;
mod numbers;
mod states;

use common::complex;

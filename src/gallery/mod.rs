//! Built-in scenes, modelled here.

pub mod human;
pub mod implicit;

//! 3.3  Collision optimization (Eq. 2).
pub mod contact;
pub mod guard;
pub mod local;

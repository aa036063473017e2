//! The surfaces of a domain that must not cross, by their names.

use std::sync::Arc;

use bevy::prelude::Component;
use glam::Vec3A;

use super::Shell;
use crate::{boundary::Boundary, transfer::Binding, voxel::Complex};

/// The surfaces of a domain that must not cross themselves.
#[derive(Component, Debug, Clone)]
pub struct Surfaces {
    /// The boundary of the complex.
    pub skin: Shell,
    /// B as it will be written, bound to the complex; `None` where only the complex is of interest.
    pub written: Option<Shell>,
}

/// The surfaces that a check looks at.
#[derive(Debug, Clone, Copy)]
pub struct Checked<'a> {
    /// The boundary of the complex.
    pub skin: &'a Shell,
    /// B as it will be written.
    pub written: Option<&'a Shell>,
}

/// One of something for each surface.
#[derive(Debug, Clone, Default)]
pub(crate) struct BySurface<T> {
    pub skin: T,
    pub written: Option<T>,
}

impl Surfaces {
    /// Those of a bound boundary.
    pub fn new(boundary: &Boundary, binding: Arc<Binding>, complex: &Complex) -> Self {
        Self { written: Some(Shell::boundary(boundary, binding, complex)), ..Self::skin_of(complex) }
    }

    /// The skin of a complex that carries nothing.
    pub fn skin_of(complex: &Complex) -> Self {
        Self { skin: Shell::skin(complex), written: None }
    }

    /// The skin alone, to be checked.
    pub fn skin_alone(&self) -> Checked<'_> {
        Checked { skin: &self.skin, written: None }
    }

    /// All of them; where `all` is not true the skin alone.
    pub fn all_if(&self, all: bool) -> Checked<'_> {
        if all { self.into() } else { self.skin_alone() }
    }

    /// How the written surface follows the nodes.
    pub fn binding(&self) -> Option<&Arc<Binding>> {
        self.written.as_ref()?.binding()
    }

    /// As [`Shell::straighten`] of the written surface.
    pub fn straighten(&mut self, motion: [&[Vec3A]; 2]) -> Vec<u32> {
        self.written.as_mut().map_or_else(Vec::new, |written| written.straighten(motion))
    }
}

impl<'a> From<&'a Surfaces> for Checked<'a> {
    fn from(surfaces: &'a Surfaces) -> Self {
        Self { skin: &surfaces.skin, written: surfaces.written.as_ref() }
    }
}

impl<'a> Checked<'a> {
    /// Something of each surface.
    pub(crate) fn each<T>(self, mut of: impl FnMut(&'a Shell) -> T) -> BySurface<T> {
        BySurface { skin: of(self.skin), written: self.written.map(of) }
    }

    /// The skin, then the written surface.
    pub fn iter(self) -> impl Iterator<Item = &'a Shell> {
        std::iter::once(self.skin).chain(self.written)
    }
}

impl<T> BySurface<T> {
    /// The skin's, then the written surface's.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        std::iter::once(&self.skin).chain(&self.written)
    }
}

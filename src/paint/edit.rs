//! What can be done to importance by hand, as it stands in a scene file.

use serde::{Deserialize, Serialize};

use super::Canvas;
use crate::{
    Error, Result,
    importance::{CLAMP_MAX, CLAMP_MIN, falloff},
};

/// One edit: what one undo takes back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Edit {
    /// The pointer pressed, moved and let go.
    Stroke {
        /// With what.
        brush: Brush,
        /// Where, in order.
        dabs: Vec<Dab>,
    },
    /// All of a part at once.
    Fill(Fill),
}

/// How a stroke changes importance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Brush {
    /// What it does.
    pub action: Action,
    /// [`Action::Set`]: the importance it sets; [`Action::Add`], [`Action::Subtract`]: the factor. In
    /// `CLAMP_MIN..=CLAMP_MAX`; the others do not use it.
    pub value: f32,
    /// How much of it happens, 0 (nothing) to 1 (all).
    pub strength: f32,
    /// How it fades towards the rim.
    #[serde(default)]
    pub falloff: Falloff,
    /// Whether it happens on the other side of the middle as well, along x, y, z.
    #[serde(default)]
    pub mirror: [bool; 3],
}

impl Default for Brush {
    fn default() -> Self {
        Self { action: Action::Set, value: 2.0, strength: 0.5, falloff: Falloff::Smooth, mirror: [false; 3] }
    }
}

/// What a brush does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Action {
    /// Towards a value.
    Set,
    /// Times a factor.
    Add,
    /// Divided by a factor.
    Subtract,
    /// Towards the mean of the neighbours.
    Smooth,
    /// Back to what the layers say.
    Erase,
}

/// How a brush fades from its centre to its rim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Falloff {
    /// Without a crease (C²).
    #[default]
    Smooth,
    /// Evenly.
    Linear,
    /// Not at all: a hard rim.
    Constant,
}

impl Falloff {
    /// Weight at `t` radii from the centre: 0..=1, nothing from 1 on.
    pub fn weight(self, t: f64) -> f64 {
        match self {
            Self::Smooth => falloff(t),
            Self::Linear => (1.0 - t).clamp(0.0, 1.0),
            Self::Constant => f64::from(t < 1.0),
        }
    }
}

/// One touch of a brush.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dab {
    /// Centre on the surface at rest, source units.
    pub centre: [f64; 3],
    /// Radius, source units, > 0.
    pub radius: f64,
}

/// A part that is filled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Fill {
    /// Everything.
    All {
        /// Importance.
        value: f32,
    },
    /// A named region.
    Region {
        /// Its name.
        name: String,
        /// Importance.
        value: f32,
    },
    /// The piece of surface that hangs together with a vertex.
    Connected {
        /// Index of the vertex.
        vertex: u32,
        /// Importance.
        value: f32,
    },
    /// Everything, from one end to the other of the box around it, even in ratio.
    Gradient {
        /// Along which axis.
        axis: Axis,
        /// Importance at the low end.
        from: f32,
        /// Importance at the high end.
        to: f32,
    },
}

/// An axis of source space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Axis {
    /// First coordinate.
    X,
    /// Second coordinate.
    Y,
    /// Third coordinate.
    Z,
}

impl Edit {
    /// Whether the edit can be meant for this surface. `index` counts from 0.
    ///
    /// # Errors
    /// Names the stroke, the value and its range.
    pub fn check(&self, index: usize, canvas: &Canvas) -> Result<()> {
        let refuse = |what: String| Err(Error::input(format!("stroke {index}: {what}")));
        let importance = |value: f32| (CLAMP_MIN..=CLAMP_MAX).contains(&value);
        let range = |value: f32| format!("importance {value} is not within {CLAMP_MIN} to {CLAMP_MAX}");
        match self {
            Self::Stroke { brush, dabs } => {
                if !importance(brush.value) {
                    return refuse(range(brush.value));
                }
                if !(0.0..=1.0).contains(&brush.strength) {
                    return refuse(format!("strength {} is not within 0 to 1", brush.strength));
                }
                for (k, dab) in dabs.iter().enumerate() {
                    if !(dab.centre.iter().all(|c| c.is_finite()) && dab.radius > 0.0 && dab.radius.is_finite()) {
                        let [x, y, z] = dab.centre;
                        let place = format!("dab {k} at ({x}, {y}, {z}) with radius {}", dab.radius);
                        return refuse(format!("{place}: the centre must be finite and the radius > 0"));
                    }
                }
                Ok(())
            }
            Self::Fill(fill) => {
                let values = match fill {
                    Fill::All { value } | Fill::Region { value, .. } | Fill::Connected { value, .. } => [*value; 2],
                    Fill::Gradient { from, to, .. } => [*from, *to],
                };
                if let Some(bad) = values.into_iter().find(|v| !importance(*v)) {
                    return refuse(range(bad));
                }
                match fill {
                    Fill::Region { name, .. } if !canvas.region_names().contains(name) => {
                        let known = canvas.region_names().join(", ");
                        let known = if known.is_empty() { "it has none".into() } else { format!("it has {known}") };
                        refuse(format!("the surface has no region `{name}`; {known}"))
                    }
                    Fill::Connected { vertex, .. } if *vertex as usize >= canvas.vertices() => {
                        refuse(format!("the surface has no vertex {vertex}; it has {}", canvas.vertices()))
                    }
                    _ => Ok(()),
                }
            }
        }
    }
}

//! What a film looks like: one validated struct, from the command line and panels alike.

use std::ops::Deref;

use crate::{Error, Result};

/// Fewest pixels along a side: below it nothing can be told, and encoders refuse.
pub const MIN_SIDE: u32 = 16;

/// Most pixels along a side: textures of every adapter that can draw at all go this far; 8K is within.
pub const MAX_SIDE: u32 = 8192;

/// Longest title, in characters: more is not readable in one line at 720p.
pub const MAX_TITLE: usize = 80;

/// Most frames of a film: ten minutes at 60 frames per second.
pub const MAX_FRAMES: usize = 36_000;

/// How growth follows time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ease {
    /// Evenly.
    Linear,
    /// Slow at first.
    In,
    /// Slow at last.
    Out,
    /// Slow at both ends.
    #[default]
    InOut,
}

impl Ease {
    /// How far it has grown at a share `t` of the time, both 0..=1; 0 at 0, 1 at 1, never falling.
    pub fn at(self, t: f64) -> f64 {
        let t = t.clamp(0.0, 1.0);
        match self {
            Self::Linear => t,
            Self::In => t * t,
            Self::Out => t * (2.0 - t),
            Self::InOut => t * t * (3.0 - 2.0 * t),
        }
    }
}

/// What is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    /// Importance as colour.
    #[default]
    Importance,
    /// Colours and textures of the input.
    Plain,
    /// What Eq. 1 alone would give, grey, what crosses or is turned over red.
    Classic,
    /// Eq. 1 alone on the left, as in [`Classic`](Self::Classic), the certified growth on the right.
    Compare,
    /// The lattice's cells.
    Voxels,
}

/// From where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Degrees to the side; 0 looks at the front (from +Z), 90 from +X.
    pub yaw: f32,
    /// Degrees from above, -89..=89.
    pub pitch: f32,
    /// 1 fits the largest state into the picture, 2 is twice as near.
    pub zoom: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self { yaw: 20.0, pitch: 8.0, zoom: 1.0 }
    }
}

/// Settings as written, not yet checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    /// Length of the whole film in seconds, holds and the way back included.
    pub seconds: f64,
    /// Frames per second, 1..=60.
    pub fps: u32,
    /// Pixels across, [`MIN_SIDE`]`..=`[`MAX_SIDE`].
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// How growth follows time.
    pub ease: Ease,
    /// Grow and shrink back, so that the film can loop.
    pub ping_pong: bool,
    /// Seconds to rest at both ends of the growth.
    pub hold: f64,
    /// Turns around the vertical axis over the film; negative turns the other way.
    pub turntable: f32,
    /// From where.
    pub camera: Camera,
    /// What is shown.
    pub view: View,
    /// Whether a legend explains the colours.
    pub legend: bool,
    /// A title in the picture.
    pub title: Option<String>,
    /// Whether the background is transparent.
    pub transparent: bool,
    /// One picture at this λ, 0..=1, in place of a film.
    pub still: Option<f32>,
}

impl Default for Draft {
    fn default() -> Self {
        Self {
            seconds: 6.0,
            fps: 30,
            width: 1920,
            height: 1080,
            ease: Ease::default(),
            ping_pong: false,
            hold: 0.5,
            turntable: 0.0,
            camera: Camera::default(),
            view: View::default(),
            legend: false,
            title: None,
            transparent: false,
            still: None,
        }
    }
}

/// Settings that have been checked. They read like their [`Draft`]; to change them, change a draft and check again.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings(Draft);

impl Deref for Settings {
    type Target = Draft;

    fn deref(&self) -> &Draft {
        &self.0
    }
}

impl Settings {
    /// Checks a draft. This is the only way to make settings.
    ///
    /// # Errors
    /// One sentence with the option, its value and its range.
    pub fn new(draft: Draft) -> Result<Self> {
        for side in [draft.width, draft.height] {
            if !(MIN_SIDE..=MAX_SIDE).contains(&side) {
                let size = format!("{}x{}", draft.width, draft.height);
                return Err(Error::input(format!("size {size}: a side has {MIN_SIDE} to {MAX_SIDE} pixels")));
            }
        }
        within("turntable", f64::from(draft.turntable), -100.0, 100.0)?;
        within("camera's yaw", f64::from(draft.camera.yaw), -360.0, 360.0)?;
        within("camera's pitch", f64::from(draft.camera.pitch), -89.0, 89.0)?;
        within("camera's zoom", f64::from(draft.camera.zoom), 0.1, 20.0)?;
        if let Some(title) = &draft.title {
            let length = title.chars().count();
            if length > MAX_TITLE {
                return Err(Error::input(format!("the title has {length} characters; {MAX_TITLE} fit")));
            }
            if title.chars().any(char::is_control) {
                return Err(Error::input("the title has a line break or another control character; write one line"));
            }
        }
        if let Some(lambda) = draft.still {
            within("still", f64::from(lambda), 0.0, 1.0)?;
            return Ok(Self(draft));
        }
        if !(1..=60).contains(&draft.fps) {
            return Err(Error::input(format!("fps {} is not within 1 to 60", draft.fps)));
        }
        within("seconds", draft.seconds, 0.1, 3600.0)?;
        within("hold", draft.hold, 0.0, 3600.0)?;
        let settings = Self(draft);
        let (frames, held) = (settings.frames(), 2 * settings.hold_frames());
        if frames > MAX_FRAMES {
            return Err(Error::input(format!("{frames} frames are more than {MAX_FRAMES}; take fewer seconds or fps")));
        }
        // One step up, and one down again.
        let least = held + if settings.ping_pong { 2 } else { 1 };
        if frames <= least {
            let (seconds, hold, fps) = (settings.seconds, settings.hold, settings.fps);
            let sentence = format!(
                "{seconds} seconds at {fps} frames per second are too short to rest {hold} seconds at both ends; \
                 take more seconds or less hold"
            );
            return Err(Error::input(sentence));
        }
        Ok(settings)
    }

    /// Frames of the film; one for a still.
    pub fn frames(&self) -> usize {
        if self.still.is_some() { 1 } else { (self.seconds * f64::from(self.fps)).round() as usize }
    }

    /// Frames at rest at each end of the growth, beyond the first that shows it.
    pub fn hold_frames(&self) -> usize {
        (self.hold * f64::from(self.fps)).round() as usize
    }

    /// The draft to change.
    pub fn into_draft(self) -> Draft {
        self.0
    }
}

fn within(name: &str, value: f64, least: f64, most: f64) -> Result<()> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(Error::input(format!("{name} {value} is not within {least} to {most}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_fault_is_named() {
        let draft = Draft::default;
        let cases = [
            (Draft { width: 8, ..draft() }, "8x1080"),
            (Draft { height: 9000, ..draft() }, "1920x9000"),
            (Draft { fps: 0, ..draft() }, "fps 0"),
            (Draft { fps: 120, ..draft() }, "fps 120"),
            (Draft { seconds: f64::NAN, ..draft() }, "seconds NaN"),
            (Draft { seconds: 0.0, ..draft() }, "seconds 0"),
            (Draft { seconds: 3000.0, ..draft() }, "90000 frames"),
            (Draft { hold: -1.0, ..draft() }, "hold -1"),
            (Draft { hold: 3.0, ..draft() }, "rest 3 seconds"),
            (Draft { turntable: f32::INFINITY, ..draft() }, "turntable inf"),
            (Draft { camera: Camera { pitch: 90.0, ..Camera::default() }, ..draft() }, "pitch 90"),
            (Draft { still: Some(1.5), ..draft() }, "still 1.5"),
            (Draft { still: Some(f32::NAN), ..draft() }, "still NaN"),
            (Draft { title: Some("x".repeat(81)), ..draft() }, "81 characters"),
            (Draft { title: Some("a\nb".into()), ..draft() }, "line break"),
        ];
        for (draft, expected) in cases {
            let error = Settings::new(draft).unwrap_err().to_string();
            assert!(error.contains(expected), "{error:?} does not say {expected:?}");
        }
        assert!(Settings::new(draft()).is_ok());
        assert!(Settings::new(Draft { still: Some(0.5), seconds: 0.0, ..draft() }).is_ok(), "a still has no length");
    }

    #[test]
    fn eases_rise_from_0_to_1() {
        for ease in [Ease::Linear, Ease::In, Ease::Out, Ease::InOut] {
            assert_eq!((ease.at(0.0), ease.at(1.0)), (0.0, 1.0), "{ease:?}");
            assert!((0..100).all(|i| ease.at(f64::from(i) / 100.0) < ease.at(f64::from(i + 1) / 100.0)), "{ease:?}");
        }
        assert_eq!(Ease::InOut.at(0.5), 0.5);
        assert!(Ease::In.at(0.5) < 0.5 && Ease::Out.at(0.5) > 0.5);
    }
}

//! What goes beside a film: how it was made, and what was proven of every state it shows.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{Ease, FramePlan, Settings, View};
use crate::certificate::Certificate;

/// How a film was made and what it shows.
#[derive(Debug, Clone, Serialize)]
pub struct Account {
    /// Whether every state of the growth that is shown is proven free of inverted elements and crossings; for the view of
    /// Eq. 1 alone, whether its states are.
    pub certified: bool,
    /// What was asked of the film.
    pub settings: SettingsAccount,
    /// What did the drawing.
    pub adapter: String,
    /// Frames drawn per second of drawing, certificates not counted.
    pub render_frames_per_second: f64,
    /// Frames encoded per second of encoding, which runs beside the drawing.
    pub encode_frames_per_second: f64,
    /// Size of the film in bytes.
    pub bytes: u64,
    /// λ of the keyframes; what was proven of them is in the report.
    pub keyframes: Vec<f32>,
    /// `[frames]`
    pub frames: Vec<FrameAccount>,
}

/// What was asked of a film.
#[derive(Debug, Clone, Serialize)]
pub struct SettingsAccount {
    seconds: f64,
    fps: u32,
    size: [u32; 2],
    ease: &'static str,
    ping_pong: bool,
    hold: f64,
    turntable: f32,
    /// Yaw and pitch in degrees, zoom.
    camera: [f32; 3],
    view: &'static str,
    legend: bool,
    title: Option<String>,
    transparent: bool,
    still: Option<f32>,
}

/// What one frame shows.
#[derive(Debug, Clone, Serialize)]
pub struct FrameAccount {
    /// λ.
    lambda: f32,
    /// Keyframes blended and the share of the second.
    mix: (usize, usize, f32),
    /// How far the table has turned, radians.
    turn: f32,
    /// Of the growth, where it is shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    growth: Option<Proof>,
    /// Of Eq. 1 alone, where it is shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    classic: Option<Proof>,
}

/// What was proven of a state.
#[derive(Debug, Clone, Serialize)]
struct Proof {
    certified: bool,
    inverted: usize,
    crossings: usize,
    surface_crossings: usize,
    enclosed: usize,
    min_volume_ratio: f64,
}

impl From<&Certificate> for Proof {
    fn from(certificate: &Certificate) -> Self {
        Self {
            certified: certificate.certified(),
            inverted: certificate.inverted(),
            crossings: certificate.crossings(),
            surface_crossings: certificate.surface_crossings(),
            enclosed: certificate.enclosed(),
            min_volume_ratio: certificate.min_volume_ratio(),
        }
    }
}

impl FrameAccount {
    /// Of a frame of the plan and what was found.
    pub(super) fn new(frame: &FramePlan, growth: Option<&Certificate>, classic: Option<&Certificate>) -> Self {
        Self {
            lambda: frame.lambda,
            mix: (frame.mix.from, frame.mix.to, frame.mix.t),
            turn: frame.turn,
            growth: growth.map(Proof::from),
            classic: classic.map(Proof::from),
        }
    }

    /// Whether what the film is about is proven in this frame: the growth, or Eq. 1 where that is all there is.
    pub(super) fn certified(&self) -> bool {
        self.growth.as_ref().or(self.classic.as_ref()).is_some_and(|proof| proof.certified)
    }
}

impl From<&Settings> for SettingsAccount {
    fn from(settings: &Settings) -> Self {
        Self {
            seconds: settings.seconds,
            fps: settings.fps,
            size: [settings.width, settings.height],
            ease: match settings.ease {
                Ease::Linear => "linear",
                Ease::In => "in",
                Ease::Out => "out",
                Ease::InOut => "in-out",
            },
            ping_pong: settings.ping_pong,
            hold: settings.hold,
            turntable: settings.turntable,
            camera: [settings.camera.yaw, settings.camera.pitch, settings.camera.zoom],
            view: match settings.view {
                View::Importance => "importance",
                View::Plain => "plain",
                View::Classic => "classic",
                View::Compare => "compare",
                View::Voxels => "voxels",
            },
            legend: settings.legend,
            title: settings.title.clone(),
            transparent: settings.transparent,
            still: settings.still,
        }
    }
}

/// Where the account of a film lies: beside it, `film.json` for `film.mp4`.
pub fn sidecar(film: &Path) -> PathBuf {
    film.with_extension("json")
}

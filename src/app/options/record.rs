//! `homunculus record`: how the film is to be.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::scene::{SceneOptions, number};
use crate::importance::Layer;
use crate::record::{self, Camera, Draft, Settings};
use crate::{Error, Result};

/// Film the growth, or take a picture of it
///
/// No window, display or GPU is needed, only a Vulkan driver; a software one will do. The format is the name's: .mp4, .gif,
/// .apng, FOLDER/ for numbered PNGs; .webm, .mov, .mkv and .webp where ffmpeg is installed. Beside OUT.mp4 lies OUT.json, with
/// how it was made and what was proven of each state it shows. The same scene gives the same film.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  homunculus record gallery:homunculus -o growth.mp4 --legend --title 'How we feel our body'
  homunculus record head.ron -o head.gif --size 640x480 --ping-pong --turntable 1
  homunculus record body.obj --sphere 0.7,1.4,0,0.2,2.5 -o body.apng --transparent --view plain
  homunculus record gallery:hand -o compare.mp4 --view compare --fps 60
  homunculus record gallery:hand -o hand.png --still 1 --size 7680x4320
  homunculus record map.png --regions ids.png --values people.csv --per-area -o cartogram.mp4 --title 'Where people live'
  homunculus record gallery:crocodile -o both.mp4 --view compare")]
pub struct RecordOptions {
    /// What to warp and how.
    #[command(flatten)]
    pub scene: SceneOptions,

    /// The film: .mp4, .gif, .apng, FOLDER/ (PNGs); with ffmpeg .webm, .mov, .mkv, .webp
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,

    /// Length of the whole film, holds and the way back included
    #[arg(long, value_name = "S", help_heading = "Film", default_value = "6", value_parser = number, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Frames per second, 1 to 60
    #[arg(long, value_name = "N", help_heading = "Film", default_value_t = 30)]
    pub fps: u32,
    /// Pixels across and down, 16 to 8192
    #[arg(long, value_name = "WxH", help_heading = "Film", default_value = "1920x1080", value_parser = size)]
    pub size: [u32; 2],
    /// How growth follows time
    #[arg(long, help_heading = "Film", value_enum, default_value = "in-out")]
    pub ease: EaseName,
    /// Grow and shrink back, so that the film can loop
    #[arg(long, help_heading = "Film")]
    pub ping_pong: bool,
    /// Seconds to rest at both ends of the growth
    #[arg(long, value_name = "S", help_heading = "Film", default_value = "0.5", value_parser = number, allow_negative_numbers = true)]
    pub hold: f64,
    /// One picture at this λ, 0 to 1, in place of a film: .png
    #[arg(long, value_name = "LAMBDA", help_heading = "Film", value_parser = number, allow_negative_numbers = true)]
    pub still: Option<f64>,

    /// What to show [default: importance, of a picture plain]
    #[arg(long, help_heading = "Picture", value_enum)]
    pub view: Option<ViewName>,
    /// Degrees to the side (0: from +Z, 90: from +X), degrees from above, and how much nearer than all fits [default: 20,8,1];
    /// a picture is looked at straight on: 0,0,ZOOM
    #[arg(long, value_name = "YAW,PITCH[,ZOOM]", help_heading = "Picture", value_parser = camera, allow_hyphen_values = true)]
    pub camera: Option<Camera>,
    /// Turns around the vertical axis over the film; negative turns the other way
    #[arg(long, value_name = "TURNS", help_heading = "Picture", default_value = "0", value_parser = number, allow_negative_numbers = true)]
    pub turntable: f64,
    /// Explain the colours
    #[arg(long, help_heading = "Picture")]
    pub legend: bool,
    /// A title in the picture
    #[arg(long, value_name = "TEXT", help_heading = "Picture")]
    pub title: Option<String>,
    /// No background; for .apng, .gif, PNGs, .webm, .mov, .mkv and .webp
    #[arg(long, help_heading = "Picture")]
    pub transparent: bool,
}

/// `--ease`
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EaseName {
    /// Evenly
    Linear,
    /// Slow at first
    In,
    /// Slow at last
    Out,
    /// Slow at both ends
    InOut,
}

/// `--view`
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ViewName {
    /// Importance as colour
    Importance,
    /// Colours and textures of the input
    Plain,
    /// What the linear solution (Eq. 1) alone would give, crossings in red
    Classic,
    /// The linear solution beside the certified growth
    Compare,
    /// The cells
    Voxels,
}

/// `record`: the options, and the importance among them in the order given.
#[derive(Debug)]
pub struct RecordOrder {
    /// All options.
    pub options: RecordOptions,
    /// Importance, in the order given, paths relative to the working directory.
    pub layers: Vec<Layer>,
}

impl RecordOptions {
    /// What is asked of the film.
    ///
    /// # Errors
    /// A value out of range; a turn around a picture, which would show its edge.
    pub(in crate::app) fn settings(&self, is_flat: bool) -> Result<Settings> {
        let [width, height] = self.size;
        let straight = Camera { yaw: 0.0, pitch: 0.0, zoom: 1.0 };
        let usual = if is_flat { (straight, ViewName::Plain) } else { (Camera::default(), ViewName::Importance) };
        let (camera, view) = (self.camera.unwrap_or(usual.0), self.view.unwrap_or(usual.1));
        if is_flat && self.turntable != 0.0 {
            return Err(Error::input("--turntable is for bodies: a picture is looked at straight on; leave it out"));
        }
        if is_flat && (camera.yaw, camera.pitch) != (0.0, 0.0) {
            return Err(Error::input("a picture is looked at straight on; give --camera 0,0,ZOOM or leave it out"));
        }
        Settings::new(Draft {
            seconds: self.seconds,
            fps: self.fps,
            width,
            height,
            ease: match self.ease {
                EaseName::Linear => record::Ease::Linear,
                EaseName::In => record::Ease::In,
                EaseName::Out => record::Ease::Out,
                EaseName::InOut => record::Ease::InOut,
            },
            ping_pong: self.ping_pong,
            hold: self.hold,
            turntable: self.turntable as f32,
            camera,
            view: match view {
                ViewName::Importance => record::View::Importance,
                ViewName::Plain => record::View::Plain,
                ViewName::Classic => record::View::Classic,
                ViewName::Compare => record::View::Compare,
                ViewName::Voxels => record::View::Voxels,
            },
            legend: self.legend,
            title: self.title.clone(),
            transparent: self.transparent,
            still: self.still.map(|lambda| lambda as f32),
        })
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']).map(|(w, h)| (w.trim().parse(), h.trim().parse()));
    match sides {
        Some((Ok(width), Ok(height))) => Ok([width, height]),
        _ => Err("give it as 1920x1080".into()),
    }
}

fn camera(text: &str) -> Result<Camera, String> {
    let numbers: Vec<f32> = text.split(',').map(|n| number(n.trim()).map(|n| n as f32)).collect::<Result<_, _>>()?;
    match numbers[..] {
        [yaw, pitch] => Ok(Camera { yaw, pitch, zoom: 1.0 }),
        [yaw, pitch, zoom] => Ok(Camera { yaw, pitch, zoom }),
        _ => Err(format!("two or three numbers YAW,PITCH[,ZOOM] are needed, there are {}", numbers.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_cameras_are_read() {
        assert_eq!(size("1280x720"), Ok([1280, 720]));
        assert!(size("1280").is_err() && size("ax2").is_err() && size("-1x2").is_err());
        assert_eq!(camera("30,-10"), Ok(Camera { yaw: 30.0, pitch: -10.0, zoom: 1.0 }));
        assert_eq!(camera("0, 5, 2.5"), Ok(Camera { yaw: 0.0, pitch: 5.0, zoom: 2.5 }));
        assert!(camera("1").is_err() && camera("1,2,3,4").is_err() && camera("a,b").is_err());
    }
}

//! `homunculus record`: from a scene to a film of its growth.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::load::{self, Loaded};
use super::outputs::{check_extension, check_places};
use super::scene_options::{SceneOptions, number};
use super::{Verdict, flat, note, progress, say};
use crate::diagnostics::human_bytes;
use crate::export::report::Report;
use crate::importance::Layer;
use crate::record::{self, Account, Camera, Draft, Settings, Subject, sidecar};
use crate::scene::Scene;
use crate::{Error, Result, run, run::Domain};

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

/// What lies beside a film.
#[derive(Serialize)]
struct Beside<'a> {
    film: &'a Path,
    version: &'static str,
    /// Nothing is drawn at random.
    seed: Option<u64>,
    scene: &'a crate::scene::Draft,
    recording: &'a Account,
    report: &'a Report,
}

impl RecordOptions {
    /// What is asked of the film.
    ///
    /// # Errors
    /// A value out of range; a turn around a picture, which would show its edge.
    fn settings(&self, is_picture: bool) -> Result<Settings> {
        let [width, height] = self.size;
        let straight = Camera { yaw: 0.0, pitch: 0.0, zoom: 1.0 };
        let usual = if is_picture { (straight, ViewName::Plain) } else { (Camera::default(), ViewName::Importance) };
        let (camera, view) = (self.camera.unwrap_or(usual.0), self.view.unwrap_or(usual.1));
        if is_picture && self.turntable != 0.0 {
            return Err(Error::input("--turntable is for bodies: a picture is looked at straight on; leave it out"));
        }
        if is_picture && (camera.yaw, camera.pitch) != (0.0, 0.0) {
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

/// Warps, films and says how it went.
pub(super) fn run(order: RecordOrder) -> Result<Verdict> {
    let options = &order.options;
    let scene = options.scene.scene(&order.layers)?;
    let source = load::picture_source(&scene.source)?;
    let settings = options.settings(source.is_some())?;
    if source.is_none() && scene.background.is_some() {
        return Err(Error::input("--background is for pictures, and this is a mesh; leave it out"));
    }
    check_outputs(options, &settings, &scene)?;
    let adapter = record::check(&settings, &options.output)?;
    let quiet = options.scene.quiet;
    if adapter.is_software && !quiet {
        note(&format!("drawing with {} (no GPU): a few frames per second", adapter.name));
    }
    let (mut subject, report) = match source {
        Some(source) => flat::subject(&scene, &options.scene, source)?,
        None => body(&scene, &options.scene)?,
    };
    let watcher = progress::watcher(quiet);
    let take = record::shoot(&mut subject, &settings, &options.output, &watcher, |_| {});
    watcher.finish();
    let take = take?;
    let account = take.account.clone();
    let beside = Beside {
        film: options.output.file_name().map_or(&options.output, Path::new),
        version: env!("CARGO_PKG_VERSION"),
        seed: None,
        scene: &scene,
        recording: &account,
        report: &report,
    };
    let written = take.keep(&beside)?;
    if let Some(path) = &options.scene.save_scene {
        scene.save(path)?;
    }
    if !quiet {
        say(&summary(&account, written.iter().chain(&options.scene.save_scene)));
    }
    Ok(if account.certified { Verdict::Done } else { Verdict::NotCertified })
}

/// A body that has grown, and what came of it.
fn body(scene: &Scene, options: &SceneOptions) -> Result<(Subject, Report)> {
    let Loaded { boundary, stack, settings, warnings } = load::load(scene, options)?;
    let watcher = progress::watcher(options.quiet);
    let clamped = stack.clamped();
    let solved = run::solve(Domain::body(Arc::new(boundary), Arc::new(stack), settings.clone()), &watcher);
    watcher.finish();
    let solved = solved?;
    let (subject, outcome) = Subject::new(solved.boundary.clone(), solved);
    Ok((subject, Report::of(scene, &settings, clamped, &outcome, warnings)))
}

/// Whether all files can come to lie where they are wanted.
fn check_outputs(options: &RecordOptions, settings: &Settings, scene: &Scene) -> Result<()> {
    let film = &options.output;
    check_extension(&options.scene.save_scene, "--save-scene", &["ron"])?;
    let sidecar = sidecar(film);
    let files = [Some(&sidecar), options.scene.save_scene.as_ref()].into_iter().flatten().map(PathBuf::as_path);
    let is_folder = record::encode::Format::of(film, settings.still.is_some())? == record::encode::Format::PngFolder;
    // A folder is checked by its encoder.
    check_places(scene, files.chain((!is_folder).then_some(film.as_path())))
}

/// One line for a person.
fn summary<'a>(account: &Account, written: impl Iterator<Item = &'a PathBuf>) -> String {
    let verdict = if account.certified { "certified" } else { "NOT CERTIFIED" };
    let files = written.map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let bytes = human_bytes(account.bytes as f64);
    let (drawn, encoded) = (account.render_frames_per_second, account.encode_frames_per_second);
    match account.frames.len() {
        1 => {
            format!(
                "{verdict}; {bytes}; drawn in {:.1} s, encoded in {:.1} s; written: {files}",
                1.0 / drawn,
                1.0 / encoded
            )
        }
        frames => format!(
            "{verdict} in {frames} frames; {bytes}; drawn at {drawn:.1}, encoded at {encoded:.0} frames per second; \
             written: {files}"
        ),
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

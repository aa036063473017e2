//! What the program `ffmpeg` writes, where it is installed: frames go to it through a pipe.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};

use image::RgbaImage;

use super::target::Target;
use super::{Encoder, Reel, Whole};
use crate::{Error, Result};

/// How ffmpeg writes films with one extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recipe {
    extension: &'static str,
    muxer: &'static str,
    encoder: &'static str,
    options: &'static [&'static str],
    /// Pixels without and with alpha.
    pixels: [&'static str; 2],
    /// Whether its colours are BT.709 in the limited range, rather than RGB or the format's own business.
    is_video: bool,
}

/// All that is known. Qualities are such that a person sees no difference.
const RECIPES: [Recipe; 4] = [
    Recipe {
        extension: "webm",
        muxer: "webm",
        encoder: "libvpx-vp9",
        options: &["-crf", "24", "-b:v", "0", "-deadline", "good", "-cpu-used", "4", "-auto-alt-ref", "0"],
        pixels: ["yuv420p", "yuva420p"],
        is_video: true,
    },
    // ProRes, which cutting programs want.
    Recipe {
        extension: "mov",
        muxer: "mov",
        encoder: "prores_ks",
        options: &["-profile:v", "4"],
        pixels: ["yuv444p10le", "yuva444p10le"],
        is_video: true,
    },
    // Lossless.
    Recipe {
        extension: "mkv",
        muxer: "matroska",
        encoder: "ffv1",
        options: &["-level", "3", "-g", "1"],
        pixels: ["bgr0", "bgra"],
        is_video: false,
    },
    Recipe {
        extension: "webp",
        muxer: "webp",
        encoder: "libwebp_anim",
        options: &["-quality", "90", "-loop", "0"],
        pixels: ["bgra", "bgra"],
        is_video: false,
    },
];

impl Recipe {
    /// The recipe for a file name's extension, in small letters.
    pub fn of(extension: &str) -> Option<Self> {
        RECIPES.into_iter().find(|recipe| recipe.extension == extension)
    }

    fn arguments(&self, reel: &Reel) -> Vec<String> {
        let pixels = self.pixels[usize::from(reel.transparent)];
        let (size, rate) = (format!("{}x{}", reel.width, reel.height), reel.fps.to_string());
        let mut words = vec!["-y", "-hide_banner", "-nostdin", "-loglevel", "error"];
        words.extend(["-f", "rawvideo", "-pix_fmt", "rgba", "-video_size", &size, "-framerate", &rate, "-i", "pipe:0"]);
        words.extend(["-c:v", self.encoder]);
        words.extend(self.options);
        if self.is_video {
            words.extend(["-vf", "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int"]);
            words.extend(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"]);
            words.extend(["-color_range", "tv"]);
        }
        // No date and no version of ffmpeg in the file: the same frames give the same bytes.
        words.extend(["-pix_fmt", pixels, "-fflags", "+bitexact", "-flags:v", "+bitexact", "-f", self.muxer]);
        words.into_iter().map(str::to_owned).collect()
    }
}

/// Whether ffmpeg is there and can do it.
pub(super) fn check(recipe: Recipe, path: &Path) -> Result<()> {
    let asked = Command::new("ffmpeg").args(["-hide_banner", "-encoders"]).stdin(Stdio::null()).output();
    let extension = recipe.extension;
    match asked {
        Ok(output) if String::from_utf8_lossy(&output.stdout).split_whitespace().any(|w| w == recipe.encoder) => Ok(()),
        Ok(_) => {
            let sentence =
                format!("the ffmpeg installed here lacks {}, which .{extension} needs; take .mp4", recipe.encoder);
            Err(Error::in_file(path, sentence))
        }
        Err(_) => {
            let sentence = format!(
                "the program ffmpeg, which writes .{extension}, is not installed; install it (Debian: apt-get install \
                 ffmpeg) or take .mp4, .gif, .apng or FOLDER/, which need nothing"
            );
            Err(Error::in_file(path, sentence))
        }
    }
}

/// A file that ffmpeg is writing.
pub(super) struct Ffmpeg {
    /// Before the child, so that the pipe is closed first.
    pipe: Option<ChildStdin>,
    child: Reaped,
    complaints: File,
    target: Target,
}

/// A child that does not outlive us.
struct Reaped(Child);

impl Drop for Reaped {
    fn drop(&mut self) {
        // Fails only where it has ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Ffmpeg {
    /// Starts ffmpeg.
    pub fn new(recipe: Recipe, path: &Path, reel: &Reel) -> Result<Self> {
        check(recipe, path)?;
        let (target, sink) = Target::new(path)?;
        drop(sink);
        // A file, not a pipe: nobody has to read it while frames go the other way.
        let complaints = tempfile::tempfile().map_err(|e| target.failed(e))?;
        let mut command = Command::new("ffmpeg");
        command.args(recipe.arguments(reel)).arg(target.temporary()).stdin(Stdio::piped()).stdout(Stdio::null());
        command.stderr(complaints.try_clone().map_err(|e| target.failed(e))?);
        #[cfg(unix)]
        {
            use std::os::unix::process::CommandExt as _;
            // Ctrl-C is for us to hear: we end it in order.
            command.process_group(0);
        }
        let mut child = Reaped(command.spawn().map_err(|e| target.failed(e))?);
        let pipe = child.0.stdin.take();
        Ok(Self { pipe, child, complaints, target })
    }

    /// What went wrong, in ffmpeg's words where it has any.
    fn failed(&mut self, otherwise: io::Error) -> Error {
        self.pipe = None;
        // It ends by itself once its input has; a complaint is worth waiting for.
        let _ = self.child.0.wait();
        let mut said = String::new();
        let read = self.complaints.rewind().and_then(|()| self.complaints.read_to_string(&mut said));
        let last = said.lines().rfind(|line| !line.trim().is_empty());
        match (read, last) {
            (Ok(_), Some(line)) => self.target.failed(io::Error::other(format!("ffmpeg says: {}", line.trim()))),
            _ => self.target.failed(otherwise),
        }
    }
}

impl Encoder for Ffmpeg {
    fn frame(&mut self, frame: &RgbaImage) -> Result<()> {
        let closed = || io::Error::from(io::ErrorKind::BrokenPipe);
        let written = self.pipe.as_mut().ok_or_else(closed).and_then(|pipe| pipe.write_all(frame.as_raw()));
        written.map_err(|error| self.failed(error))
    }

    fn finish(mut self: Box<Self>) -> Result<Whole> {
        self.pipe = None;
        match self.child.0.wait() {
            Ok(status) if status.success() => Ok(self.target.whole()),
            Ok(status) => Err(self.failed(io::Error::other(format!("ffmpeg ended with {status}")))),
            Err(error) => Err(self.failed(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_is_asked_for_where_it_counts() {
        let reel = |transparent| Reel { width: 64, height: 48, fps: 30, frames: 2, transparent };
        let recipe = Recipe::of("webm").unwrap();
        let has = |transparent, word: &str| recipe.arguments(&reel(transparent)).iter().any(|w| w == word);
        assert!(has(true, "yuva420p") && !has(true, "yuv420p"));
        assert!(has(false, "yuv420p") && !has(false, "yuva420p"));
        assert!(has(false, "64x48") && has(false, "30"));
        assert_eq!(Recipe::of("mp4"), None);
    }
}

//! Encoding beside rendering: a thread takes frames as they come, and the next one is drawn meanwhile.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Instant;

use image::RgbaImage;

use super::encode::{Encoder, Whole};
use crate::{Error, Result};

/// Frames that may wait: enough for one that takes longer, few enough to stay small.
const WAITING: usize = 2;

enum Message {
    Frame(RgbaImage),
    /// All frames are there. Without it the file is given up.
    Done,
}

/// What the thread hands back: the file, and the seconds that encoding took. Nothing if it was given up.
type Encoded = Option<(Whole, f64)>;

/// An encoder at work. Dropped, it leaves nothing.
pub(super) struct Writer {
    sender: Option<SyncSender<Message>>,
    thread: Option<JoinHandle<Result<Encoded>>>,
}

impl Writer {
    /// Puts an encoder to work.
    pub fn new(encoder: Box<dyn Encoder>) -> Result<Self> {
        let (sender, receiver) = sync_channel(WAITING);
        let builder = std::thread::Builder::new().name("encoder".into());
        let thread = builder.spawn(move || encode(encoder, &receiver));
        let thread = thread.map_err(|e| Error::Fault(format!("starting the encoder's thread: {e}")))?;
        Ok(Self { sender: Some(sender), thread: Some(thread) })
    }

    /// Hands over a frame; waits where the encoder is behind.
    ///
    /// # Errors
    /// What the encoder met, as soon as it is known.
    pub fn frame(&mut self, frame: RgbaImage) -> Result<()> {
        self.send(Message::Frame(frame))
    }

    /// Waits until all frames are on the disk.
    ///
    /// # Errors
    /// What the encoder met.
    pub fn finish(mut self) -> Result<(Whole, f64)> {
        self.send(Message::Done)?;
        self.join()?.ok_or_else(|| Error::Fault("the encoder gave up".into()))
    }

    fn send(&mut self, message: Message) -> Result<()> {
        if self.sender.as_ref().is_some_and(|sender| sender.send(message).is_ok()) {
            return Ok(());
        }
        // It has ended, and only an error ends it early.
        self.join().and_then(|_| Err(Error::Fault("the encoder ended early".into())))
    }

    fn join(&mut self) -> Result<Encoded> {
        self.sender = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(Error::Fault("the encoder broke".into())),
            None => Ok(None),
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // What it met does not matter any more; that its temporary files are gone does.
        let _ = self.join();
    }
}

fn encode(mut encoder: Box<dyn Encoder>, frames: &Receiver<Message>) -> Result<Encoded> {
    let mut seconds = 0.0;
    for message in frames {
        let start = Instant::now();
        match message {
            Message::Frame(frame) => encoder.frame(&frame)?,
            Message::Done => {
                let whole = encoder.finish()?;
                return Ok(Some((whole, seconds + start.elapsed().as_secs_f64())));
            }
        }
        seconds += start.elapsed().as_secs_f64();
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::encode::{Format, Reel};
    use std::path::Path;

    const REEL: Reel = Reel { width: 32, height: 16, fps: 10, frames: 3, transparent: false };

    fn listing(folder: &Path) -> Vec<String> {
        let name =
            |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().to_string_lossy().into_owned();
        std::fs::read_dir(folder).unwrap().map(name).collect()
    }

    fn writer(path: &Path) -> Writer {
        let format = Format::of(path, false).unwrap();
        let samples = vec![RgbaImage::new(32, 16); format.samples(3).len()];
        Writer::new(format.begin(path, &REEL, &samples).unwrap()).unwrap()
    }

    #[test]
    fn every_format_names_its_file_at_the_end_and_only_then() {
        for name in ["a.mp4", "a.gif", "a.apng", "a/"] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            let mut writer = writer(&path);
            (0..3).for_each(|k| writer.frame(RgbaImage::from_pixel(32, 16, image::Rgba([80 * k, 0, 0, 255]))).unwrap());
            let (whole, _) = writer.finish().unwrap();
            assert!(!path.exists() && listing(folder.path()).len() == 1, "{name}");
            whole.name().unwrap();
            assert_eq!(listing(folder.path()), [name.trim_end_matches('/')], "{name}");
        }
    }

    #[test]
    fn one_that_is_dropped_leaves_nothing() {
        for name in ["a.mp4", "a.gif", "a.apng", "a/"] {
            let folder = tempfile::tempdir().unwrap();
            let mut given_up = writer(&folder.path().join(name));
            given_up.frame(RgbaImage::new(32, 16)).unwrap();
            drop(given_up);
            assert_eq!(listing(folder.path()), [""; 0], "{name}, before the end");
            let mut unnamed = writer(&folder.path().join(name));
            (0..3).for_each(|_| unnamed.frame(RgbaImage::new(32, 16)).unwrap());
            drop(unnamed.finish().unwrap());
            assert_eq!(listing(folder.path()), [""; 0], "{name}, after the end");
        }
    }
}

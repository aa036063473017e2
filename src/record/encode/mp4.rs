//! H.264 in MP4, as browsers and slide programs play it: 4:2:0, BT.709 in the limited range and said so, `moov` first.
//!
//! Encoded by OpenH264 (BSD-2), put into MP4 by `muxide` (MIT or Apache-2.0). One encoder thread, so that the same frames
//! give the same bytes.

use std::path::Path;

use image::RgbaImage;
use muxide::api::{Muxer, MuxerBuilder, MuxerError, VideoCodec};
use openh264::OpenH264API;
use openh264::encoder::{
    BitRate, Complexity, Encoder as H264, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, QpRange,
    RateControlMode, UsageType, VuiConfig,
};
use openh264::formats::YUVBuffer;
use rayon::prelude::*;

use super::target::{Sink, Target};
use super::{Encoder, Reel, Whole};
use crate::{Error, Result};

/// Largest picture OpenH264 takes: 4K, upright or across.
const MOST: (u32, u32) = (3840, 2160);

/// Bits per pixel and frame that the encoder may spend at most. Growth on a quiet background takes a tenth of it; less would
/// show blocks in smooth shading.
const BITS_PER_PIXEL: f64 = 0.25;

/// Quantizers: below the first nobody sees a difference, above the second edges show.
const QUANTIZERS: QpRange = QpRange::new(14, 26);

/// Seconds between pictures that stand alone: players seek to them.
const SECONDS_PER_GROUP: u32 = 2;

/// Whether MP4 can hold it.
pub(super) fn check(path: &Path, reel: &Reel) -> Result<()> {
    let (width, height) = (reel.width, reel.height);
    if !width.is_multiple_of(2) || !height.is_multiple_of(2) {
        let (w, h) = (width & !1, height & !1);
        return Err(Error::in_file(path, format!("MP4 wants even sizes; take --size {w}x{h}")));
    }
    if width.max(height) > MOST.0 || width.min(height) > MOST.1 {
        let sentence = format!("MP4 films go up to {}x{} here; take a smaller --size", MOST.0, MOST.1);
        return Err(Error::in_file(path, sentence));
    }
    if reel.transparent {
        let sentence = "MP4 has no transparency; take .apng, .gif, FOLDER/ or, with ffmpeg, .webm";
        return Err(Error::in_file(path, sentence));
    }
    Ok(())
}

/// An MP4 on its way.
pub(super) struct Mp4 {
    target: Target,
    encoder: H264,
    muxer: Muxer<Sink>,
    reel: Reel,
    frame: usize,
    bytes: Vec<u8>,
}

impl Mp4 {
    /// Opens one.
    pub fn new(path: &Path, reel: &Reel) -> Result<Self> {
        check(path, reel)?;
        let rate = f64::from(reel.fps) * f64::from(reel.width) * f64::from(reel.height) * BITS_PER_PIXEL;
        let config = EncoderConfig::new()
            .usage_type(UsageType::CameraVideoRealTime)
            .rate_control_mode(RateControlMode::Quality)
            .bitrate(BitRate::from_bps(rate as u32))
            .max_frame_rate(FrameRate::from_hz(reel.fps as f32))
            .qp(QUANTIZERS)
            .complexity(Complexity::High)
            .intra_frame_period(IntraFramePeriod::from_num_frames(SECONDS_PER_GROUP * reel.fps))
            .skip_frames(false)
            .num_threads(1)
            .vui(VuiConfig::bt709());
        let encoder = H264::with_api_config(OpenH264API::from_source(), config).map_err(fault)?;
        let (target, sink) = Target::new(path)?;
        let muxer = MuxerBuilder::new(sink)
            .video(VideoCodec::H264, reel.width, reel.height, f64::from(reel.fps))
            .with_fast_start(true)
            .build()
            .map_err(|e| of_muxer(&target, e))?;
        Ok(Self { target, encoder, muxer, reel: *reel, frame: 0, bytes: Vec::new() })
    }
}

impl Encoder for Mp4 {
    fn frame(&mut self, frame: &RgbaImage) -> Result<()> {
        let (width, height) = (self.reel.width as usize, self.reel.height as usize);
        let yuv = YUVBuffer::from_vec(yuv(frame), width, height);
        let stream = self.encoder.encode(&yuv).map_err(fault)?;
        self.bytes.clear();
        stream.write_vec(&mut self.bytes);
        let is_key = stream.frame_type() == FrameType::IDR;
        let seconds = self.frame as f64 / f64::from(self.reel.fps);
        self.frame += 1;
        self.muxer.write_video(seconds, &self.bytes, is_key).map_err(|e| of_muxer(&self.target, e))
    }

    fn finish(self: Box<Self>) -> Result<Whole> {
        let Self { target, mut muxer, .. } = *self;
        muxer.finish_in_place().map_err(|e| of_muxer(&target, e))?;
        target.finish(muxer.into_writer())
    }
}

fn fault(error: openh264::Error) -> Error {
    Error::Fault(format!("encoding H.264: {error}"))
}

fn of_muxer(target: &Target, error: MuxerError) -> Error {
    match error {
        MuxerError::Io(error) => target.failed(error),
        error => Error::Fault(format!("writing MP4: {error}")),
    }
}

/// Planar 4:2:0 of BT.709 (Rec. ITU-R BT.709-6, 3.2 to 3.5) in the limited range; its factors in units of 2⁻¹⁶. Chroma is the
/// mean over two by two pixels. Even sizes.
fn yuv(frame: &RgbaImage) -> Vec<u8> {
    let (width, height) = (frame.width() as usize, frame.height() as usize);
    let mut planes = vec![0; width * height * 3 / 2];
    let (y, uv) = planes.split_at_mut(width * height);
    let (u, v) = uv.split_at_mut(width * height / 4);
    let rows = frame.as_raw().par_chunks_exact(8 * width);
    rows.zip(y.par_chunks_exact_mut(2 * width))
        .zip(u.par_chunks_exact_mut(width / 2).zip(v.par_chunks_exact_mut(width / 2)))
        .for_each(|((rgba, y), (u, v))| {
            for (pixel, y) in rgba.chunks_exact(4).zip(y) {
                *y = luma(pixel);
            }
            for (x, (u, v)) in u.iter_mut().zip(v).enumerate() {
                let at = [8 * x, 8 * x + 4, 8 * x + 4 * width, 8 * x + 4 * width + 4];
                let sum = |channel: usize| at.iter().map(|i| i32::from(rgba[i + channel])).sum();
                (*u, *v) = chroma([sum(0), sum(1), sum(2)]);
            }
        });
    planes
}

/// 16..=235.
fn luma(rgb: &[u8]) -> u8 {
    let [r, g, b] = [0, 1, 2].map(|c| i32::from(rgb[c]));
    ((11966 * r + 40254 * g + 4064 * b + (16 << 16) + (1 << 15)) >> 16) as u8
}

/// 16..=240, of the sum over four pixels.
fn chroma([r, g, b]: [i32; 3]) -> (u8, u8) {
    let of = |weighed: i32| ((weighed + (512 << 16) + (1 << 17)) >> 18) as u8;
    (of(-6596 * r - 22189 * g + 28785 * b), of(28785 * r - 26145 * g - 2640 * b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    /// BT.709-6 by its formulas, in doubles.
    fn expected([r, g, b]: [u8; 3]) -> [f64; 3] {
        let [r, g, b] = [r, g, b].map(|c| f64::from(c) / 255.0);
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        [16.0 + 219.0 * y, 128.0 + 224.0 * (b - y) / 1.8556, 128.0 + 224.0 * (r - y) / 1.5748]
    }

    #[test]
    fn colours_are_those_of_the_standard() {
        let levels = [0, 1, 50, 127, 128, 200, 254, 255];
        for rgb in levels.iter().flat_map(|&r| levels.iter().flat_map(move |&g| levels.map(|b| [r, g, b]))) {
            let [r, g, b] = rgb;
            let planes = yuv(&RgbaImage::from_pixel(2, 2, Rgba([r, g, b, 255])));
            let found = [planes[0], planes[4], planes[5]].map(f64::from);
            let within = found.iter().zip(expected(rgb)).all(|(found, expected)| (found - expected).abs() < 0.51);
            assert!(within, "{rgb:?}: {found:?}, expected {:?}", expected(rgb));
        }
    }

    #[test]
    fn chroma_is_the_mean_and_planes_are_in_order() {
        let mut frame = RgbaImage::from_pixel(4, 2, Rgba([255, 255, 255, 255]));
        frame.put_pixel(2, 0, Rgba([255, 0, 0, 255]));
        let planes = yuv(&frame);
        assert_eq!(planes[..8], [235, 235, 63, 235, 235, 235, 235, 235]);
        // Three parts white, one part red: U a quarter of the way from 128 to 102, V from 128 to 240.
        assert_eq!(planes[8..], [128, 122, 128, 156]);
    }
}

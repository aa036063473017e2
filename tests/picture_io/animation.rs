//! What is written as an animation plays as it was drawn.

use crate::disc;
use homunculus::picture::animate;
use image::{Rgba, RgbaImage};
use std::io::Cursor;
use std::time::Duration;

fn film(count: u32, delay: Duration) -> Vec<animate::Frame> {
    let frame = |k: u32| {
        let mut pixels = disc(48, 10.0 + f64::from(k), [200, 30, 60], [0; 3]);
        (0..48).for_each(|x| pixels.put_pixel(x, 24, Rgba([x as u8 * 5, 200, 255 - x as u8, 255])));
        animate::Frame { pixels, delay }
    };
    (0..count).map(frame).collect()
}

/// Draws the frames of an APNG one over the other, as a viewer would; with the seconds shown.
fn play_apng(bytes: &[u8]) -> (Vec<RgbaImage>, f64) {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().expect("a header");
    let count = reader.info().animation_control().expect("animated").num_frames;
    let mut canvas = RgbaImage::new(reader.info().width, reader.info().height);
    let (mut frames, mut seconds) = (Vec::new(), 0.0);
    for _ in 0..count {
        let mut buffer = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut buffer).expect("a frame");
        let control = *reader.info().frame_control().expect("animated");
        seconds += f64::from(control.delay_num) / f64::from(control.delay_den);
        let part = RgbaImage::from_raw(
            control.width,
            control.height,
            buffer[..(control.width * control.height * 4) as usize].to_vec(),
        )
        .expect("as many bytes as pixels");
        image::imageops::replace(&mut canvas, &part, control.x_offset.into(), control.y_offset.into());
        frames.push(canvas.clone());
    }
    (frames, seconds)
}

#[test]
fn apng_plays_every_frame_as_it_was() {
    let delay = Duration::from_secs_f64(1.0 / 30.0);
    let frames = film(31, delay);
    let mut bytes = Vec::new();
    animate::apng(&mut bytes, 31, frames.iter().cloned().map(Ok)).unwrap();
    let (played, seconds) = play_apng(&bytes);
    assert_eq!(played.len(), 31);
    assert!(played.iter().zip(&frames).all(|(a, b)| *a == b.pixels));
    assert!((seconds - 31.0 / 30.0).abs() <= 0.001, "{seconds} s");
    let mut other = frames;
    other[7].pixels.put_pixel(3, 3, Rgba([1, 2, 3, 255]));
    assert!(!played.iter().zip(&other).all(|(a, b)| *a == b.pixels), "sabotage: another pixel is seen");
    assert!(animate::apng(Vec::new(), 5, film(3, delay).into_iter().map(Ok)).is_err(), "frames are missing");
    assert!(animate::apng(Vec::new(), 2, film(3, delay).into_iter().map(Ok)).is_err(), "one too many");
    assert!(animate::apng(Vec::new(), 0, []).is_err());
}

#[test]
fn gif_plays_its_frames_in_few_colours() {
    let delay = Duration::from_secs_f64(1.0 / 15.0);
    let mut frames = film(20, delay);
    frames.extend(film(20, delay).into_iter().rev());
    let mut bytes = Vec::new();
    let samples = [&frames[0].pixels, &frames[19].pixels];
    animate::gif(&mut bytes, &samples, frames.iter().cloned().map(Ok)).unwrap();
    let (played, seconds) = play_gif(&bytes);
    assert_eq!(played.len(), 40);
    assert!((seconds - 40.0 / 15.0).abs() <= 0.01, "{seconds} s");
    let is_alike = |played: &RgbaImage, drawn: &RgbaImage| {
        played.pixels().zip(drawn.pixels()).all(|(a, b)| {
            let is_seen = b.0[3] >= 128;
            (a.0[3] > 0) == is_seen && (!is_seen || (0..3).all(|c| a.0[c].abs_diff(b.0[c]) <= 24))
        })
    };
    assert!(played.iter().zip(&frames).all(|(a, b)| is_alike(a, &b.pixels)), "growing and shrinking, no trace is left");
    assert!(!is_alike(&played[0], &frames[19].pixels), "sabotage: another frame is seen");
    let hasty = film(3, Duration::from_millis(5)).into_iter().map(Ok);
    assert!(animate::gif(Vec::new(), &samples, hasty).unwrap_err().to_string().contains("50 frames"));
}

/// Draws the frames of a GIF one over the other, as a viewer would; with the seconds shown.
fn play_gif(bytes: &[u8]) -> (Vec<RgbaImage>, f64) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut reader = options.read_info(bytes).expect("a header");
    let mut canvas = RgbaImage::new(reader.width().into(), reader.height().into());
    let (mut frames, mut seconds) = (Vec::new(), 0.0);
    while let Some(frame) = reader.read_next_frame().expect("a frame") {
        seconds += f64::from(frame.delay) / 100.0;
        let (left, top) = (u32::from(frame.left), u32::from(frame.top));
        for (i, pixel) in frame.buffer.chunks_exact(4).enumerate().filter(|(_, p)| p[3] > 0) {
            let (x, y) = (i as u32 % u32::from(frame.width), i as u32 / u32::from(frame.width));
            canvas.put_pixel(left + x, top + y, Rgba([pixel[0], pixel[1], pixel[2], 255]));
        }
        frames.push(canvas.clone());
        if frame.dispose == gif::DisposalMethod::Background {
            for (x, y) in (0..frame.height).flat_map(|y| (0..frame.width).map(move |x| (x, y))) {
                canvas.put_pixel(left + u32::from(x), top + u32::from(y), Rgba([0; 4]));
            }
        }
    }
    (frames, seconds)
}

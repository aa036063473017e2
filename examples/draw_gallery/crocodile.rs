//! A crocodile from the side, its jaws open.

use tiny_skia::{Mask, Path, PathBuilder};

use crate::pen::{Place, Sheet, circle, colour, faint, gradient, mix, polygon, smooth, smooth_into};

const WIDTH: u32 = 1200;
const HEIGHT: u32 = 600;
/// Nothing is drawn above.
const TOP: u32 = 100;
const INK: u32 = 0x26301A;
const BACK: u32 = 0x4C6A2C;
const FLANK: u32 = 0x86A04A;
const BELLY: u32 = 0xE4DDA6;

/// The back from the tail's tip to the nostrils.
const BACK_LINE: [Place; 22] = [
    (6.0, 494.0),
    (74.0, 470.0),
    (130.0, 444.0),
    (190.0, 404.0),
    (250.0, 360.0),
    (315.0, 318.0),
    (385.0, 286.0),
    (460.0, 266.0),
    (540.0, 258.0),
    (615.0, 262.0),
    (680.0, 264.0),
    (728.0, 250.0),
    (758.0, 226.0),
    (788.0, 216.0),
    (816.0, 226.0),
    (842.0, 240.0),
    (900.0, 226.0),
    (980.0, 194.0),
    (1050.0, 164.0),
    (1096.0, 140.0),
    (1124.0, 132.0),
    (1150.0, 142.0),
];
/// The snout's end and the upper jaw's lower edge, to the corner of the mouth.
const UPPER_JAW: [Place; 8] = [
    (1160.0, 164.0),
    (1152.0, 188.0),
    (1124.0, 200.0),
    (1060.0, 226.0),
    (990.0, 262.0),
    (920.0, 292.0),
    (858.0, 310.0),
    (812.0, 330.0),
];
/// The lower jaw's upper edge, from the corner of the mouth.
const LOWER_JAW: [Place; 7] = [
    (828.0, 346.0),
    (880.0, 366.0),
    (945.0, 392.0),
    (1010.0, 420.0),
    (1070.0, 446.0),
    (1112.0, 462.0),
    (1134.0, 482.0),
];
/// Chin, throat, belly and the tail's underside.
const UNDERSIDE: [Place; 15] = [
    (1120.0, 500.0),
    (1080.0, 500.0),
    (1010.0, 482.0),
    (935.0, 458.0),
    (865.0, 438.0),
    (800.0, 434.0),
    (730.0, 446.0),
    (650.0, 464.0),
    (560.0, 474.0),
    (470.0, 470.0),
    (390.0, 456.0),
    (310.0, 448.0),
    (220.0, 462.0),
    (130.0, 478.0),
    (72.0, 489.0),
];

/// The picture and the picture of regions: 1 teeth.
pub fn draw() -> (Sheet, Sheet) {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    let mut ids = Sheet::new(WIDTH, HEIGHT);

    leg(&mut sheet, (436.0, 404.0), -18.0, true);
    leg(&mut sheet, (716.0, 400.0), 24.0, true);

    let body = outline();
    let teeth = teeth();
    crest(&mut sheet);
    for tooth in &teeth {
        draw_tooth(&mut sheet, tooth);
        ids.label(&polygon(&tooth.corners, true), 1, 5.0);
    }
    sheet.stroke(&body, colour(INK), 8.0);
    let stops =
        [(0.0, colour(BACK)), (0.45, colour(FLANK)), (0.8, mix(FLANK, BELLY, 0.35)), (1.0, mix(FLANK, BELLY, 0.6))];
    sheet.shade(&body, gradient((600.0, 220.0), (585.0, 500.0), &stops), None);
    let mask = sheet.mask(&body);
    belly(&mut sheet, &mask);
    scales(&mut sheet, &mask);
    mouth(&mut sheet, &mask);
    head(&mut sheet, &mask);
    // The jaws' edge is in front of the teeth's roots; what of a tooth lies behind it is no tooth.
    sheet.stroke(&smooth(&UPPER_JAW[2..], false), colour(INK), 3.5);
    sheet.stroke(&smooth(&LOWER_JAW[..6], false), colour(INK), 3.5);
    ids.label(&body, 0, 2.0);

    leg(&mut sheet, (330.0, 392.0), -26.0, false);
    leg(&mut sheet, (612.0, 388.0), 26.0, false);
    (sheet.cut_out(TOP, HEIGHT - TOP), ids.cut_out(TOP, HEIGHT - TOP))
}

fn outline() -> Path {
    let points: Vec<Place> = BACK_LINE.iter().chain(&UPPER_JAW).chain(&LOWER_JAW).chain(&UNDERSIDE).copied().collect();
    smooth(&points, true)
}

/// Horny plates along the back and the tail.
fn crest(sheet: &mut Sheet) {
    let line: Vec<Place> = resample(&BACK_LINE[1..11], 26.0);
    for (k, ends) in line.windows(2).enumerate() {
        let ((x0, y0), (x1, y1)) = (ends[0], ends[1]);
        let (dx, dy) = (x1 - x0, y1 - y0);
        let along_tail = 1.0 - (k as f32 / line.len() as f32);
        let height = 11.0 + 15.0 * (along_tail * 3.1).sin().max(0.0);
        let length = dx.hypot(dy);
        let (nx, ny) = (dy / length, -dx / length);
        let tip = (x0 + dx * 0.30 + nx * height, y0 + dy * 0.30 + ny * height);
        let mut builder = PathBuilder::new();
        builder.move_to(x0 - nx * 8.0, y0 - ny * 8.0);
        builder.quad_to(x0 + nx * 4.0, y0 + ny * 4.0, tip.0, tip.1);
        builder.quad_to(x1 + nx * height * 0.35, y1 + ny * height * 0.35, x1 - nx * 8.0, y1 - ny * 8.0);
        builder.close();
        let plate = builder.finish().expect("a plate");
        sheet.stroke(&plate, colour(INK), 7.0);
        sheet.fill(&plate, mix(BACK, 0x2F4A1C, 0.35));
    }
}

/// Light plates with seams below.
fn belly(sheet: &mut Sheet, mask: &Mask) {
    let upper: Vec<Place> = UNDERSIDE.iter().map(|&(x, y)| (x, y - 10.0 - 26.0 * bump((x - 560.0) / 420.0))).collect();
    let lower: Vec<Place> = UNDERSIDE.iter().rev().map(|&(x, y)| (x, y + 30.0)).collect();
    let mut builder = PathBuilder::new();
    smooth_into(&mut builder, &upper, false);
    lower.iter().for_each(|p| builder.line_to(p.0, p.1));
    builder.close();
    let plate = builder.finish().expect("a belly");
    let stops = [(0.0, colour(BELLY)), (1.0, mix(BELLY, 0xA8925A, 0.5))];
    sheet.shade(&plate, gradient((0.0, 420.0), (0.0, 500.0), &stops), Some(mask));
    sheet.stroke_within(&smooth(&upper, false), faint(INK, 0.35), 2.5, Some(mask));
    let mut belly_mask = mask.clone();
    belly_mask.intersect_path(&plate, tiny_skia::FillRule::Winding, true, tiny_skia::Transform::identity());
    for (x, y) in resample(&upper, 24.0) {
        sheet.stroke_within(
            &smooth(&[(x, y), (x - 5.0, y + 22.0), (x - 4.0, y + 50.0)], false),
            faint(0x6E5F32, 0.45),
            2.0,
            Some(&belly_mask),
        );
    }
}

/// Rows of scales on the flank, larger towards the back.
fn scales(sheet: &mut Sheet, mask: &Mask) {
    let back = resample(&BACK_LINE[2..12], 23.0);
    for row in 0..4 {
        let depth = 20.0 + 31.0 * row as f32;
        for (k, &(x, y)) in back.iter().enumerate() {
            let room = 40.0 + 120.0 * bump((x - 560.0) / 380.0);
            if depth > room {
                continue;
            }
            let place = (x + if row % 2 == 0 { 0.0 } else { 11.5 }, y + depth + 3.0 * (k as f32 * 1.7).sin());
            let (w, h) = (8.5 - row as f32 * 0.9, 6.0 - row as f32 * 0.6);
            let scale = smooth(
                &[(place.0 - w, place.1), (place.0, place.1 - h), (place.0 + w, place.1), (place.0, place.1 + h)],
                true,
            );
            sheet.shade(&scale, tiny_skia::Shader::SolidColor(faint(0x35501F, 0.55 - 0.09 * row as f32)), Some(mask));
            let shine = smooth(
                &[
                    (place.0 - w * 0.6, place.1 - h * 0.4),
                    (place.0, place.1 - h * 0.8),
                    (place.0 + w * 0.5, place.1 - h * 0.5),
                ],
                false,
            );
            sheet.stroke_within(&shine, faint(0xD9E59A, 0.45), 1.6, Some(mask));
        }
    }
}

/// The red lining along both jaws.
fn mouth(sheet: &mut Sheet, mask: &Mask) {
    for jaw in [&UPPER_JAW[2..], &LOWER_JAW[..6]] {
        let line = smooth(jaw, false);
        sheet.stroke_within(&line, colour(0x7E2B2B), 26.0, Some(mask));
        sheet.stroke_within(&line, colour(0xC9565A), 19.0, Some(mask));
        sheet.stroke_within(&line, colour(0xE58C86), 8.0, Some(mask));
    }
    let corner = smooth(&[(790.0, 330.0), (812.0, 322.0), (834.0, 338.0), (814.0, 352.0)], true);
    sheet.shade(&corner, tiny_skia::Shader::SolidColor(colour(0xA63E42)), Some(mask));
    sheet.stroke_within(
        &smooth(&[(774.0, 312.0), (782.0, 338.0), (800.0, 362.0)], false),
        faint(INK, 0.55),
        3.5,
        Some(mask),
    );
}

/// Eye, nostril and the folds of the head.
fn head(sheet: &mut Sheet, mask: &Mask) {
    let eye = (786.0, 240.0);
    sheet.fill(&circle(eye, 23.0), mix(BACK, 0x2F4A1C, 0.4));
    sheet.fill(&circle((eye.0, eye.1 + 1.0), 17.5), colour(INK));
    sheet.fill(&circle((eye.0, eye.1 + 1.0), 15.0), colour(0xF2C53D));
    sheet.fill(&circle((eye.0, eye.1 + 3.0), 12.0), colour(0xE8A92A));
    let pupil = smooth(
        &[(eye.0, eye.1 - 12.0), (eye.0 + 4.5, eye.1 + 1.0), (eye.0, eye.1 + 14.0), (eye.0 - 4.5, eye.1 + 1.0)],
        true,
    );
    sheet.fill(&pupil, colour(0x14160F));
    sheet.fill(&circle((eye.0 + 5.0, eye.1 - 5.0), 4.0), colour(0xFFFFFF));
    let lid = smooth(
        &[
            (eye.0 - 22.0, eye.1 + 2.0),
            (eye.0 - 14.0, eye.1 - 14.0),
            (eye.0 + 2.0, eye.1 - 18.0),
            (eye.0 + 18.0, eye.1 - 11.0),
            (eye.0 + 23.0, eye.1 + 2.0),
        ],
        false,
    );
    sheet.stroke(&lid, colour(INK), 5.0);
    let nostril = smooth(&[(1112.0, 150.0), (1124.0, 145.0), (1134.0, 150.0), (1124.0, 156.0)], true);
    sheet.fill(&nostril, colour(INK));
    for (k, &(x, y)) in
        [(880.0, 258.0), (930.0, 242.0), (980.0, 222.0), (1030.0, 200.0), (1074.0, 180.0)].iter().enumerate()
    {
        let size = 7.0 - k as f32 * 0.5;
        sheet.shade(&circle((x, y), size), tiny_skia::Shader::SolidColor(faint(0x35501F, 0.45)), Some(mask));
    }
    for (k, &(x, y)) in [(880.0, 404.0), (930.0, 424.0), (980.0, 446.0), (1030.0, 464.0)].iter().enumerate() {
        sheet.shade(
            &circle((x, y), 5.5 - k as f32 * 0.5),
            tiny_skia::Shader::SolidColor(faint(0x35501F, 0.30)),
            Some(mask),
        );
    }
    let cheek = smooth(&[(742.0, 282.0), (734.0, 320.0), (746.0, 366.0), (772.0, 396.0)], false);
    sheet.stroke_within(&cheek, faint(INK, 0.30), 3.0, Some(mask));
}

/// A tooth: the two ends of its root and its tip.
struct Tooth {
    corners: [Place; 3],
}

/// Teeth along both jaws, those of one in the gaps of the other.
fn teeth() -> Vec<Tooth> {
    let mut teeth = Vec::new();
    for (jaw, side, count, first) in [(&UPPER_JAW[2..], -1.0_f32, 9, 0.03), (&LOWER_JAW[..7], 1.0, 8, 0.12)] {
        let line = resample(jaw, 2.0);
        for k in 0..count {
            let t = first + (0.90 - first) * k as f32 / (count - 1) as f32;
            let at = |t: f32| line[((t * (line.len() - 1) as f32) as usize).min(line.len() - 1)];
            let size = if side < 0.0 { 1.0 - 0.45 * t } else { 0.55 + 0.45 * t } * if k % 2 == 0 { 1.12 } else { 0.86 };
            let half = 15.0 * size / (2.0 * line.len() as f32);
            let (a, b) = (at((t - half).max(0.0)), at((t + half).min(1.0)));
            let (dx, dy) = (b.0 - a.0, b.1 - a.1);
            let length = dx.hypot(dy).max(1.0);
            let (nx, ny) = if side < 0.0 { (-dy / length, dx / length) } else { (dy / length, -dx / length) };
            let (nx, ny) = if (side < 0.0) == (ny > 0.0) { (nx, ny) } else { (-nx, -ny) };
            let middle = ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0);
            let root = |p: Place| (p.0 - nx * 12.0, p.1 - ny * 12.0);
            let tip = (middle.0 + nx * 38.0 * size - 4.0, middle.1 + ny * 38.0 * size);
            teeth.push(Tooth { corners: [root(a), tip, root(b)] });
        }
    }
    teeth
}

fn draw_tooth(sheet: &mut Sheet, tooth: &Tooth) {
    let [a, tip, b] = tooth.corners;
    let mut builder = PathBuilder::new();
    builder.move_to(a.0, a.1);
    builder.quad_to(a.0 * 0.55 + tip.0 * 0.45 + (a.0 - b.0) * 0.12, a.1 * 0.55 + tip.1 * 0.45, tip.0, tip.1);
    builder.quad_to(b.0 * 0.55 + tip.0 * 0.45 + (b.0 - a.0) * 0.12, b.1 * 0.55 + tip.1 * 0.45, b.0, b.1);
    builder.close();
    let path = builder.finish().expect("a tooth");
    sheet.stroke(&path, colour(INK), 5.0);
    let (left, right) = if a.0 < b.0 { (a, b) } else { (b, a) };
    let stops = [(0.0, colour(0xFFFFFB)), (0.55, colour(0xF7F0DA)), (1.0, colour(0xC9B98C))];
    sheet.shade(&path, gradient(left, right, &stops), None);
}

/// A bent leg from the shoulder to the claws, leaning by `lean` pixels; those on the far side are in shadow.
fn leg(sheet: &mut Sheet, (x, y): Place, lean: f32, is_far: bool) {
    let sign = lean.signum();
    let foot = (x + lean, 548.0);
    let knee = (x - sign * 16.0, (y + foot.1) / 2.0 + 14.0);
    let points = [
        (x - 56.0, y - 4.0),
        (x - 54.0, y + 44.0),
        (knee.0 - 34.0, knee.1 - 2.0),
        (foot.0 - 34.0, foot.1 - 42.0),
        (foot.0 - 36.0, foot.1 - 4.0),
        (foot.0 + 8.0, foot.1 + 4.0),
        (foot.0 + 52.0, foot.1 + 4.0),
        (foot.0 + 60.0, foot.1 - 10.0),
        (foot.0 + 30.0, foot.1 - 34.0),
        (knee.0 + 44.0, knee.1 + 4.0),
        (x + 52.0, y + 40.0),
        (x + 54.0, y - 8.0),
        (x, y - 44.0),
    ];
    let path = smooth(&points, true);
    let (upper, lower) = if is_far {
        (mix(BACK, INK, 0.25), mix(BACK, INK, 0.45))
    } else {
        (mix(FLANK, BACK, 0.25), mix(FLANK, BACK, 0.75))
    };
    if is_far {
        sheet.stroke(&path, colour(INK), 8.0);
        sheet.shade(&path, gradient((x, y), (x, foot.1), &[(0.0, upper), (1.0, lower)]), None);
        claws(sheet, foot, 0xA59C78);
        return;
    }
    // The thigh grows out of the flank: its outline fades towards the back.
    let clip = sheet.mask(&polygon(&[(0.0, y - 4.0), (1200.0, y - 4.0), (1200.0, 600.0), (0.0, 600.0)], true));
    sheet.stroke_within(&path, colour(INK), 8.0, Some(&clip));
    sheet.stroke(&path, faint(INK, 0.25), 5.0);
    sheet.shade(&path, gradient((x - 30.0, y - 40.0), (x + 20.0, foot.1), &[(0.0, upper), (1.0, lower)]), None);
    for (k, &(dx, dy)) in
        [(-18.0, 0.0), (6.0, -8.0), (-8.0, 24.0), (16.0, 16.0), (-20.0, 48.0), (4.0, 44.0)].iter().enumerate()
    {
        sheet.fill(&circle((x + dx, y + dy), 6.0 - 0.4 * k as f32), faint(0x35501F, 0.40));
    }
    claws(sheet, foot, 0xEDE4BE);
}

/// Three claws at the toes.
fn claws(sheet: &mut Sheet, foot: Place, horn: u32) {
    for (dx, dy) in [(20.0, -1.0), (40.0, 0.0), (58.0, -6.0)] {
        let (x, y) = (foot.0 + dx, foot.1 + dy);
        let claw = smooth(
            &[(x - 9.0, y - 7.0), (x + 6.0, y - 6.0), (x + 17.0, y + 8.0), (x + 2.0, y + 6.0), (x - 9.0, y + 5.0)],
            true,
        );
        sheet.stroke(&claw, colour(INK), 4.5);
        sheet.fill(&claw, colour(horn));
    }
}

/// 1 in the middle, smoothly 0 at ±1.
fn bump(t: f32) -> f32 {
    if t.abs() >= 1.0 { 0.0 } else { (1.0 - t * t).powi(2) }
}

/// Points at even distances along a line through points.
fn resample(points: &[Place], step: f32) -> Vec<Place> {
    let mut resampled = vec![points[0]];
    let mut left = step;
    for ends in points.windows(2) {
        let ((x0, y0), (x1, y1)) = (ends[0], ends[1]);
        let length = (x1 - x0).hypot(y1 - y0);
        let mut at = left;
        while at <= length {
            resampled.push((x0 + (x1 - x0) * at / length, y0 + (y1 - y0) * at / length));
            at += step;
        }
        left = at - length;
    }
    resampled
}

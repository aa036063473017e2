//! 3.2  What of a picture is the body: alpha over a threshold, and a background of one colour cut out from the rim.

use glam::UVec2;

use super::Pixels;

/// Which pixels are the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Least alpha, as a part of full opacity, 0..=1. A fully transparent pixel is never the body.
    pub alpha: f32,
    /// What is cut out of the picture before.
    pub background: Option<Background>,
}

/// A colour that is background where it reaches the picture's rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    /// sRGB, each 0..=1.
    pub colour: [f32; 3],
    /// Largest difference in any of the three channels, 0..=1.
    pub tolerance: f32,
}

impl Default for Cut {
    /// Half opaque is the edge that a smoothed outline is drawn around.
    fn default() -> Self {
        Self { alpha: 0.5, background: None }
    }
}

impl std::str::FromStr for Background {
    type Err = String;

    /// `COLOUR,TOLERANCE`, the colour as in CSS: `white,0.1`, `#fff,0.05`, `rgb(250, 250, 240),0.1`.
    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = "write COLOUR,TOLERANCE as in `white,0.1` or `#fff,0.05`";
        let (colour, tolerance) =
            text.rsplit_once(',').ok_or_else(|| format!("`{text}` has no tolerance; {wanted}"))?;
        let parsed = csscolorparser::parse(colour.trim()).map_err(|_| format!("`{colour}` is no colour; {wanted}"))?;
        let tolerance: f32 = tolerance.trim().parse().map_err(|_| format!("`{tolerance}` is no number; {wanted}"))?;
        if !(0.0..=1.0).contains(&tolerance) {
            return Err(format!("the tolerance {tolerance} is not in 0..1; {wanted}"));
        }
        Ok(Self { colour: [parsed.r, parsed.g, parsed.b], tolerance })
    }
}

impl Background {
    fn is(&self, rgba: [u16; 4]) -> bool {
        let near = |c: usize| (f32::from(rgba[c]) / 65535.0 - self.colour[c]).abs() <= self.tolerance + 1e-6;
        rgba[3] == 0 || (0..3).all(near)
    }
}

impl Cut {
    /// `[pixels]` whether each is the body; what is background becomes transparent. The error lacks the file's name.
    pub(super) fn apply(&self, pixels: &mut Pixels, warnings: &mut Vec<String>) -> Result<Vec<bool>, String> {
        if let Some(background) = &self.background {
            let outside = flood(pixels, background);
            if !outside.contains(&true) {
                warnings.push("the background's colour does not reach the picture's rim: nothing was cut out".into());
            }
            clear(pixels, &outside, background);
        }
        let size = pixels.size();
        let count = (size.x * size.y) as usize;
        let alpha = |index: usize| f32::from(pixels.wide(index)[3]) / 65535.0;
        let domain: Vec<bool> = (0..count).map(|i| alpha(i) > 0.0 && alpha(i) >= self.alpha).collect();
        let inside = domain.iter().filter(|inside| **inside).count();
        if inside == 0 {
            return Err(match self.background {
                Some(_) => "nothing is left of the picture without its background; lower the tolerance".into(),
                None => format!("no pixel of the picture is more opaque than {}; there is nothing to warp", self.alpha),
            });
        }
        let faint = (0..count).filter(|&i| alpha(i) > 0.0).count() - inside;
        // The smoothed rim of an outline is a few hundredths of a body; a shadow or a glow is more.
        if faint * 4 > inside {
            warnings.push(format!(
                "{faint} pixels fainter than {} of full opacity are not part of the body and are left out",
                self.alpha
            ));
        }
        Ok(domain)
    }
}

/// `[pixels]` which are background: joined to the rim over edges by pixels of its colour.
fn flood(pixels: &Pixels, background: &Background) -> Vec<bool> {
    let UVec2 { x: width, y: height } = pixels.size();
    let mut outside = vec![false; (width * height) as usize];
    let mut open: Vec<(u32, u32)> = (0..width).flat_map(|x| [(x, 0), (x, height - 1)]).collect();
    open.extend((0..height).flat_map(|y| [(0, y), (width - 1, y)]));
    while let Some((x, y)) = open.pop() {
        let index = (y * width + x) as usize;
        if outside[index] || !background.is(pixels.wide(index)) {
            continue;
        }
        outside[index] = true;
        open.extend(around(x, y, width, height).filter(|&(i, j)| i == x || j == y));
    }
    outside
}

/// Makes the background transparent, and the pixels along it as transparent as they are mixed with it: each is taken as
/// a·F + (1 − a)·B with F the nearest colour further inside, so that no fringe of the background goes along.
fn clear(pixels: &mut Pixels, outside: &[bool], background: &Background) {
    let UVec2 { x: width, y: height } = pixels.size();
    let rgb = |rgba: [u16; 4]| [0, 1, 2].map(|c| f32::from(rgba[c]) / 65535.0);
    let is_rim = |x: u32, y: u32| around(x, y, width, height).any(|(i, j)| outside[(j * width + i) as usize]);
    let mut mixed = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let index = (y * width + x) as usize;
        if outside[index] || !is_rim(x, y) {
            continue;
        }
        let inner = around(x, y, width, height).filter(|&(i, j)| !outside[(j * width + i) as usize] && !is_rim(i, j));
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for (i, j) in inner {
            let colour = rgb(pixels.wide((j * width + i) as usize));
            (0..3).for_each(|c| sum[c] += colour[c]);
            count += 1.0;
        }
        if count == 0.0 {
            continue;
        }
        let inner = sum.map(|s| s / count);
        let own = pixels.wide(index);
        let along: f32 = (0..3).map(|c| (rgb(own)[c] - background.colour[c]) * (inner[c] - background.colour[c])).sum();
        let whole: f32 = (0..3).map(|c| (inner[c] - background.colour[c]).powi(2)).sum();
        let share = if whole > 0.0 { (along / whole).clamp(0.0, 1.0) } else { 1.0 };
        if share < 1.0 {
            let [r, g, b] = inner.map(|c| (c * 65535.0).round() as u16);
            mixed.push((index, [r, g, b, (f32::from(own[3]) * share).round() as u16]));
        }
    }
    for (index, rgba) in mixed {
        pixels.set_wide(index, rgba);
    }
    for index in outside.iter().enumerate().filter(|(_, outside)| **outside).map(|(index, _)| index) {
        pixels.set_wide(index, [0; 4]);
    }
}

/// The up to eight pixels around one.
fn around(x: u32, y: u32, width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    let columns = x.saturating_sub(1)..=(x + 1).min(width - 1);
    let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
    rows.flat_map(move |j| columns.clone().map(move |i| (i, j))).filter(move |&place| place != (x, y))
}

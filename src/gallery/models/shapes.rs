//! Solids made of parts, each of which belongs to a region: what the models of the gallery are written in.
//!
//! A [`Solid`] is a list of parts, melted into one another or cut out of what stands, in the order given. Regions come
//! from the same parts: a point belongs to the part it lies on, and where two meet, to both.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3, Vec3Swizzles as _};
use rayon::prelude::*;

use crate::gallery::implicit::{self, Mesh, Remesh, curve, polygonize, ramp, remesh, round_cone, union};

/// A near-distance: negative inside, metres.
type Field = Box<dyn Fn(Vec3) -> f32 + Send + Sync>;

struct Part {
    /// `None` takes away.
    region: Option<usize>,
    melt: f32,
    field: Field,
}

/// A body made of parts.
pub struct Solid {
    /// Lowest and highest corner of a box around it.
    pub bounds: [Vec3; 2],
    /// Width in which the memberships of two parts that meet pass into one another, metres.
    pub blend: f32,
    regions: Vec<(&'static str, f32)>,
    parts: Vec<Part>,
    paints: Vec<(usize, Field)>,
}

impl Solid {
    /// An empty body; `regions` are names with the wanted length of a triangle's edge there, metres.
    pub fn new(low: Vec3, high: Vec3, blend: f32, regions: &[(&'static str, f32)]) -> Self {
        Self { bounds: [low, high], blend, regions: regions.to_vec(), parts: Vec::new(), paints: Vec::new() }
    }

    /// A name that was not declared is a slip of the pen: its part falls to the first region, and the test of the
    /// tables against the regions shows it.
    fn index(&self, region: &str) -> usize {
        self.regions.iter().position(|r| r.0 == region).unwrap_or(0)
    }

    /// Adds a part, melted within `melt` metres into what stands.
    pub fn add(&mut self, region: &str, melt: f32, field: impl Fn(Vec3) -> f32 + Send + Sync + 'static) {
        let region = Some(self.index(region));
        self.parts.push(Part { region, melt, field: Box::new(field) });
    }

    /// Takes a part away from what stands, the edge rounded within `melt`; what stands keeps its regions.
    pub fn cut(&mut self, melt: f32, field: impl Fn(Vec3) -> f32 + Send + Sync + 'static) {
        self.parts.push(Part { region: None, melt, field: Box::new(field) });
    }

    /// Adds a part at x and at −x.
    pub fn pair(&mut self, region: &str, melt: f32, field: impl Fn(Vec3) -> f32 + Send + Sync + 'static) {
        self.add(region, melt, move |p| field(Vec3::new(p.x.abs(), p.y, p.z)));
    }

    /// Paints a region over the parts with an opacity in 0..=1; later paint covers earlier.
    pub fn paint(&mut self, region: &str, opacity: impl Fn(Vec3) -> f32 + Send + Sync + 'static) {
        let region = self.index(region);
        self.paints.push((region, Box::new(opacity)));
    }

    /// Near-distance to the surface, metres: negative inside.
    pub fn distance(&self, p: Vec3) -> f32 {
        combine(self.parts.iter(), p)
    }

    /// Names of the regions.
    pub fn region_names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.regions.iter().map(|r| r.0)
    }

    /// `[regions]` distance to the nearest part of each; infinite where it has none.
    fn region_distances(&self, p: Vec3) -> Vec<f32> {
        let mut near = vec![f32::INFINITY; self.regions.len()];
        for part in &self.parts {
            let d = (part.field)(p);
            match part.region {
                Some(region) => near[region] = near[region].min(d),
                None => near.iter_mut().for_each(|n| *n = n.max(-d)),
            }
        }
        near
    }

    /// Regions and weights of a point of the surface: weights above a thousandth, summing to 1.
    pub fn memberships(&self, p: Vec3) -> Vec<(u16, f32)> {
        let near = self.region_distances(p);
        let least = near.iter().copied().fold(f32::INFINITY, f32::min);
        let mut weights: Vec<f32> = near.iter().map(|d| ramp(self.blend - (d - least), 0.0, self.blend)).collect();
        normalise(&mut weights);
        for (region, opacity) in &self.paints {
            let opacity = opacity(p);
            weights.iter_mut().for_each(|w| *w *= 1.0 - opacity);
            weights[*region] += opacity;
        }
        weights.iter_mut().filter(|w| **w < 1e-3).for_each(|w| *w = 0.0);
        normalise(&mut weights);
        (0_u16..).zip(weights).filter(|&(_, w)| w > 0.0).collect()
    }

    /// The wanted length of a triangle's edge at `p`, metres: a region's own, growing gently away from it.
    pub fn edge_length(&self, p: Vec3) -> f32 {
        /// Growth of the edge per metre from a fine region: neighbours differ by less than a third.
        const GRADE: f32 = 0.25;
        let near = self.region_distances(p);
        let sizes = self.regions.iter().zip(near).filter(|(_, d)| d.is_finite());
        sizes.map(|((_, edge), d)| edge + GRADE * d.max(0.0)).fold(f32::INFINITY, f32::min)
    }

    /// The surface as even triangles, sampled at `cell` metres first: smaller than half of the narrowest gap.
    pub fn mesh(&self, cell: f32) -> Mesh {
        let margin = Vec3::splat(2.0 * cell);
        let (low, high) = (self.bounds[0] - margin, self.bounds[1] + margin);
        let blocks = Blocks::new(self, low, high);
        let field = |p: Vec3| blocks.distance(p);
        let mut net = polygonize(&field, low, high, cell);
        net.keep_largest();
        remesh(&net, &field, &|p| self.edge_length(p), Remesh { rounds: 6, reach: cell })
    }
}

/// The parts put together at `p`, in their order; infinite where there is none.
fn combine<'a>(parts: impl Iterator<Item = &'a Part>, p: Vec3) -> f32 {
    parts.fold(f32::INFINITY, |f, part| {
        let d = (part.field)(p);
        match part.region {
            None => -union(-f, d, part.melt),
            Some(_) if f.is_finite() => union(f, d, part.melt),
            Some(_) => d,
        }
    })
}

/// A solid cut into blocks, each with the parts that may touch it: the same surface, many times faster.
struct Blocks<'a> {
    solid: &'a Solid,
    low: Vec3,
    size: f32,
    count: [usize; 3],
    /// `[blocks]` the parts near, and the distance at the block's middle.
    near: Vec<(Vec<u32>, f32)>,
}

impl<'a> Blocks<'a> {
    fn new(solid: &'a Solid, low: Vec3, high: Vec3) -> Self {
        /// Blocks along the longest side: finer lists fewer parts in each, but takes longer to make.
        const ALONG: f32 = 32.0;
        /// A part's near-distance is at most this many times its distance.
        const TRUST: f32 = 2.2;
        let size = (high - low).max_element() / ALONG;
        let count = ((high - low) / size).ceil().as_uvec3().to_array().map(|n| n as usize + 1);
        let half = 0.5 * size * 3.0_f32.sqrt();
        let near = (0..count.iter().product::<usize>()).into_par_iter().map(|b| {
            let at = [b % count[0], b / count[0] % count[1], b / count[0] / count[1]].map(|n| n as f32 + 0.5);
            let middle = low + Vec3::from(at) * size;
            let listed = (0_u32..)
                .zip(&solid.parts)
                .filter(|(_, part)| (part.field)(middle) < TRUST * (half + 2.0 * part.melt + 0.01));
            (listed.map(|(k, _)| k).collect(), solid.distance(middle))
        });
        Self { solid, low, size, count, near: near.collect() }
    }

    fn distance(&self, p: Vec3) -> f32 {
        let at = ((p - self.low) / self.size).max(Vec3::ZERO).as_uvec3().to_array();
        let [x, y, z] = std::array::from_fn(|k| (at[k] as usize).min(self.count[k] - 1));
        let (parts, far) = &self.near[x + (y + z * self.count[1]) * self.count[0]];
        let f = combine(parts.iter().map(|&k| &self.solid.parts[k as usize]), p);
        if f.is_finite() { f } else { *far }
    }
}

fn normalise(weights: &mut [f32]) {
    let total: f32 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= total);
}

/// A tube of varying radius along a smooth curve through knots.
pub struct Tube {
    knots: Vec<(Vec3, f32)>,
    /// `[spans of STRIDE cones]` a ball around each.
    balls: Vec<(Vec3, f32)>,
}

/// Cones that share a bounding ball.
const STRIDE: usize = 6;

impl Tube {
    /// A tube through `(point, radius)` knots, eight cones from knot to knot.
    pub fn new(knots: &[(Vec3, f32)]) -> Self {
        Self::polyline(curve(knots, 8))
    }

    /// A tube along a polyline of `(point, radius)` that is fine already.
    pub fn polyline(knots: Vec<(Vec3, f32)>) -> Self {
        let ball = |first: usize| {
            let span = &knots[first..(first + STRIDE + 1).min(knots.len())];
            let centre = span.iter().map(|k| k.0).sum::<Vec3>() / span.len() as f32;
            (centre, span.iter().map(|k| k.0.distance(centre) + k.1).fold(0.0, f32::max))
        };
        let balls = (0..knots.len() - 1).step_by(STRIDE).map(ball).collect();
        Self { knots, balls }
    }

    /// The cones of ball `b`, with the index of the first.
    fn span(&self, b: usize) -> (usize, &[(Vec3, f32)]) {
        (b * STRIDE, &self.knots[b * STRIDE..((b + 1) * STRIDE + 1).min(self.knots.len())])
    }

    /// Distance to the tube.
    pub fn distance(&self, p: Vec3) -> f32 {
        let mut least = f32::INFINITY;
        for (b, &(centre, reach)) in self.balls.iter().enumerate() {
            if p.distance(centre) - reach < least {
                let cones = self.span(b).1.windows(2).map(|k| round_cone(p, k[0].0, k[1].0, k[0].1, k[1].1));
                least = cones.fold(least, f32::min);
            }
        }
        least
    }

    /// Where along the tube the point nearest to `p` is: 0 at the first knot, 1 at the last.
    pub fn along(&self, p: Vec3) -> f32 {
        let (mut least, mut place) = (f32::INFINITY, 0.0);
        for (b, &(centre, reach)) in self.balls.iter().enumerate() {
            if p.distance(centre) - reach > least {
                continue;
            }
            let (first, knots) = self.span(b);
            for (i, k) in knots.windows(2).enumerate() {
                let axis = k[1].0 - k[0].0;
                let t = ((p - k[0].0).dot(axis) / axis.length_squared().max(1e-12)).clamp(0.0, 1.0);
                let distance = p.distance(k[0].0 + axis * t);
                if distance < least {
                    (least, place) = (distance, (first + i) as f32 + t);
                }
            }
        }
        place / (self.knots.len() - 1) as f32
    }
}

/// Distance to a ring around the y axis: `major` to the middle of the tube, `minor` its radius.
pub fn torus(p: Vec3, major: f32, minor: f32) -> f32 {
    Vec2::new(p.xz().length() - major, p.y).length() - minor
}

/// Distance to a capsule: a stick of one radius.
pub fn stick(p: Vec3, a: Vec3, b: Vec3, radius: f32) -> f32 {
    let axis = b - a;
    let t = ((p - a).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
    p.distance(a + axis * t) - radius
}

/// Distance to an upright disc, centred at the origin: `radius` and `half` height include the `round`ing of its edge.
pub fn disc(p: Vec3, radius: f32, half: f32, round: f32) -> f32 {
    let q = Vec2::new(p.xz().length() - (radius - round), p.y.abs() - (half - round));
    q.max(Vec2::ZERO).length() + q.max_element().min(0.0) - round
}

/// Distance to the body that a closed polygon in the plane sweeps: negative inside, corners rounded from without.
pub fn polygon(p: Vec2, corners: &[Vec2]) -> f32 {
    let mut least = f32::INFINITY;
    let mut inside = false;
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (edge, to) = (b - a, p - a);
        least = least.min((to - edge * (to.dot(edge) / edge.length_squared()).clamp(0.0, 1.0)).length_squared());
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + edge.x * (p.y - a.y) / edge.y {
            inside = !inside;
        }
    }
    if inside { -least.sqrt() } else { least.sqrt() }
}

/// A profile of the plane swept by `half` to both sides along z, all edges rounded.
pub fn extrude(profile: f32, z: f32, half: f32, round: f32) -> f32 {
    let q = Vec2::new(profile + round, z.abs() - half + round);
    q.max(Vec2::ZERO).length() + q.max_element().min(0.0) - round
}

/// A thin shell `thickness` metres thick around the surface of a field.
pub fn shell(distance: f32, thickness: f32) -> f32 {
    distance.abs() - 0.5 * thickness
}

/// The point as seen in the nearest of `count` equal sectors around the y axis: repeats a part around it.
pub fn around(p: Vec3, count: u32, phase: f32) -> Vec3 {
    let sector = TAU / count as f32;
    let angle = p.x.atan2(p.z) - phase;
    let turned = angle - (angle / sector).round() * sector;
    let radius = p.xz().length();
    Vec3::new(radius * turned.sin(), p.y, radius * turned.cos())
}

/// A frame's view of a point: [`implicit::Frame::local`] for a part at `origin` whose y axis runs `along`.
pub fn frame(origin: Vec3, along: Vec3, towards: Vec3) -> implicit::Frame {
    implicit::Frame::new(origin, along, towards)
}

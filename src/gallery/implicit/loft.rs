//! A stack of ovals along an axis: the way to give a part a measured silhouette.

use glam::{Vec2, Vec3};

/// One oval of a [`Loft`], across the axis at height `y`.
#[derive(Debug, Clone, Copy)]
pub struct Station {
    /// Where along the axis, metres; increasing from station to station.
    pub y: f32,
    /// The oval's centre.
    pub centre: Vec2,
    /// Half-width towards +x and towards −x, metres.
    pub width: [f32; 2],
    /// Depth towards +z and towards −z, metres.
    pub depth: [f32; 2],
    /// 2 is an ellipse, 3 a rounded box.
    pub power: f32,
}

impl Station {
    /// An oval symmetric in x: `(y, half-width, z of its front, z of its back, power)`.
    pub const fn sym(y: f32, half: f32, front: f32, back: f32, power: f32) -> Self {
        let mid = 0.5 * (front + back);
        let depth = 0.5 * (front - back);
        Self { y, centre: Vec2::new(0.0, mid), width: [half, half], depth: [depth, depth], power }
    }

    /// An oval between `x = left` and `right` (left < right), `z = back` and `front`.
    pub const fn between(y: f32, left: f32, right: f32, front: f32, back: f32, power: f32) -> Self {
        let (w, d) = (0.5 * (right - left), 0.5 * (front - back));
        Self { y, centre: Vec2::new(0.5 * (right + left), 0.5 * (front + back)), width: [w, w], depth: [d, d], power }
    }

    fn values(&self) -> [f32; 7] {
        let [right, left] = self.width;
        let [front, back] = self.depth;
        [self.centre.x, self.centre.y, right, left, front, back, self.power]
    }
}

/// Ovals joined by a natural cubic spline (curvature has no jump) and closed by round caps.
#[derive(Debug, Clone)]
pub struct Loft {
    ys: Vec<f32>,
    values: Vec<[f32; 7]>,
    bends: Vec<[f32; 7]>,
    caps: [f32; 2],
}

impl Loft {
    /// A loft through at least two stations; `caps` are the lengths of the round ends below the first and above the last.
    pub fn new(stations: &[Station], caps: [f32; 2]) -> Self {
        let ys: Vec<f32> = stations.iter().map(|s| s.y).collect();
        let values: Vec<[f32; 7]> = stations.iter().map(Station::values).collect();
        let bends = natural_spline(&ys, &values);
        Self { ys, values, bends, caps }
    }

    /// The oval at height `y`: centre x, centre z, +x, −x, +z, −z half-axes, power.
    fn oval(&self, y: f32) -> [f32; 7] {
        let last = self.ys.len() - 1;
        let i = self.ys.partition_point(|&k| k <= y).clamp(1, last);
        let step = self.ys[i] - self.ys[i - 1];
        let b = ((y - self.ys[i - 1]) / step).clamp(0.0, 1.0);
        let a = 1.0 - b;
        let (wa, wb) = ((a * a * a - a) * step * step / 6.0, (b * b * b - b) * step * step / 6.0);
        std::array::from_fn(|k| {
            a * self.values[i - 1][k] + b * self.values[i][k] + wa * self.bends[i - 1][k] + wb * self.bends[i][k]
        })
    }

    /// Near-distance to the loft from a point in its own frame (axis y).
    pub fn distance(&self, p: Vec3) -> f32 {
        let (first, last) = (self.ys[0], self.ys[self.ys.len() - 1]);
        let [cx, cz, right, left, front, back, power] = self.oval(p.y);
        let (dx, dz) = (p.x - cx, p.z - cz);
        let (rx, rz) = (if dx > 0.0 { right } else { left }, if dz > 0.0 { front } else { back });
        let over = if p.y > last { (p.y - last) / self.caps[1] } else { ((first - p.y) / self.caps[0]).max(0.0) };
        let (u, v) = ((dx / rx).abs(), (dz / rz).abs());
        let flat = (u.powf(power) + v.powf(power)).powf(1.0 / power).max(1e-4);
        let size = flat.hypot(over);
        // The gradient of `size` across the axis; along it the radii change slowly except in the caps.
        let (gu, gv) = ((u / flat).powf(power - 1.0) / rx, (v / flat).powf(power - 1.0) / rz);
        let cap = if p.y > last { self.caps[1] } else { self.caps[0] };
        let slope = (gu.hypot(gv) * flat / size).hypot(over / size / cap);
        (size - 1.0) / slope
    }
}

/// Second derivatives of the natural cubic spline through `values` at `ys`: the tridiagonal system, by elimination.
fn natural_spline(ys: &[f32], values: &[[f32; 7]]) -> Vec<[f32; 7]> {
    let n = ys.len();
    let mut bends = vec![[0.0; 7]; n];
    let mut upper = vec![0.0; n];
    for i in 1..n.saturating_sub(1) {
        let (before, after) = (ys[i] - ys[i - 1], ys[i + 1] - ys[i]);
        let share = before / (before + after);
        let pivot = share * upper[i - 1] + 2.0;
        upper[i] = (share - 1.0) / pivot;
        bends[i] = std::array::from_fn(|k| {
            let kink = (values[i + 1][k] - values[i][k]) / after - (values[i][k] - values[i - 1][k]) / before;
            (6.0 * kink / (before + after) - share * bends[i - 1][k]) / pivot
        });
    }
    for i in (0..n.saturating_sub(1)).rev() {
        bends[i] = std::array::from_fn(|k| upper[i] * bends[i + 1][k] + bends[i][k]);
    }
    bends[0] = [0.0; 7];
    bends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loft_of_circles_is_a_cylinder() {
        let s = |y| Station::sym(y, 0.5, 0.5, -0.5, 2.0);
        let loft = Loft::new(&[s(0.0), s(1.0), s(2.0)], [0.5, 0.5]);
        assert!((loft.distance(Vec3::new(1.0, 1.0, 0.0)) - 0.5).abs() < 1e-5);
        assert!(loft.distance(Vec3::new(0.0, 2.5, 0.0)).abs() < 1e-3);
        assert!(loft.distance(Vec3::new(0.3, 1.2, 0.3)) < 0.0);
    }
}

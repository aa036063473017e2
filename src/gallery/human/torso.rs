//! Trunk and neck: a measured silhouette with the muscles a stranger looks for.

use glam::{Vec2, Vec3};

use crate::gallery::implicit::{
    Loft, Station, bump, chain, curve, cut, ellipsoid, mirrored, ramp, round_cone, stroke, union,
};

/// Trunk and neck.
#[derive(Debug)]
pub struct Torso {
    trunk: Loft,
    neck: Loft,
    clavicle: Vec<(Vec3, f32)>,
    hollow: Vec<(Vec3, f32)>,
}

impl Torso {
    /// Half-breadths and depths after the usual proportions of a 1.75 m adult between the sexes: waist 0.28 wide at
    /// 0.63 of the height, hips 0.34 at 0.53, chest 0.32 at 0.73, neck 0.36 around.
    pub(crate) fn new() -> Self {
        let trunk = [
            Station::sym(0.840, 0.152, 0.056, -0.082, 2.1),
            Station::sym(0.890, 0.169, 0.084, -0.094, 2.1),
            Station::sym(0.935, 0.169, 0.098, -0.101, 2.2),
            Station::sym(0.980, 0.163, 0.103, -0.097, 2.2),
            Station::sym(1.040, 0.149, 0.105, -0.085, 2.2),
            Station::sym(1.100, 0.138, 0.102, -0.077, 2.2),
            Station::sym(1.160, 0.137, 0.101, -0.081, 2.3),
            Station::sym(1.220, 0.145, 0.105, -0.097, 2.3),
            Station::sym(1.280, 0.155, 0.109, -0.112, 2.3),
            Station::sym(1.340, 0.158, 0.102, -0.120, 2.3),
            Station::sym(1.385, 0.146, 0.082, -0.118, 2.2),
            Station::sym(1.425, 0.112, 0.054, -0.104, 2.1),
            Station::sym(1.455, 0.072, 0.032, -0.086, 2.0),
        ];
        let neck = [
            Station::sym(1.400, 0.062, 0.030, -0.092, 2.0),
            Station::sym(1.440, 0.055, 0.032, -0.082, 2.0),
            Station::sym(1.480, 0.050, 0.036, -0.069, 2.0),
            Station::sym(1.520, 0.046, 0.041, -0.062, 2.0),
            Station::sym(1.560, 0.045, 0.044, -0.060, 2.0),
            Station::sym(1.610, 0.045, 0.044, -0.060, 2.0),
        ];
        let k = |x: f32, y: f32, z: f32, r: f32| (Vec3::new(x, y, z), r);
        let clavicle = [
            k(0.020, 1.418, 0.0, 0.012),
            k(0.062, 1.420, 0.0, 0.013),
            k(0.110, 1.431, 0.0, 0.014),
            k(0.158, 1.436, 0.0, 0.017),
        ];
        let hollow = [k(0.040, 1.441, 0.0, 0.016), k(0.072, 1.444, 0.0, 0.020), k(0.108, 1.455, 0.0, 0.017)];
        Self {
            trunk: Loft::new(&trunk, [0.05, 0.05]),
            neck: Loft::new(&neck, [0.05, 0.03]),
            clavicle: curve(&clavicle, 4),
            hollow: curve(&hollow, 4),
        }
    }

    /// Near-distance; `p` in the body's space, either half.
    pub fn distance(&self, p: Vec3) -> f32 {
        let q = mirrored(p, 0.012);
        let mut f = self.trunk.distance(q);
        f = union(f, self.back(q), 0.07);
        f = union(f, self.front(p, q), 0.045);
        f = union(f, buttocks(p), 0.050);
        f = union(f, self.neck(q), 0.05);
        f = union(f, trapezius(q), 0.050);
        // Furrow of the spine, line of the belly, navel, notch above the breastbone.
        let back = Vec2::new(p.x, 0.0).length();
        f += 0.0065 * bump(back, 0.046) * bump(p.y - 1.17, 0.25) * f32::from(p.z < 0.0);
        f += 0.0026 * bump(back, 0.034) * bump(p.y - 1.17, 0.15) * f32::from(p.z > 0.0);
        f += 0.0090 * bump(p.distance(Vec3::new(0.0, 1.047, 0.108)), 0.015);
        f += 0.0050 * bump(p.distance(Vec3::new(0.0, 1.432, 0.046)), 0.026);
        // Collar bones and the hollows above them, drawn as seen from the front; the dimples above the buttocks.
        let (front, flat) = (ramp(p.z, -0.035, 0.0), q.with_z(0.0));
        f -= 0.0046 * front * ramp(q.x, 0.005, 0.035) * stroke(flat, &self.clavicle);
        f += 0.0040 * front * stroke(flat, &self.hollow);
        f + 0.0022 * bump(q.distance(Vec3::new(0.045, 0.990, -0.098)), 0.032)
    }

    fn back(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        let lat = chain(
            q,
            &[(v(0.085, 1.10, -0.040), 0.035), (v(0.128, 1.26, -0.055), 0.042), (v(0.165, 1.36, -0.040), 0.034)],
            0.03,
        );
        let scapula = ellipsoid(q, v(0.088, 1.330, -0.080), v(0.062, 0.090, 0.040));
        let erector = chain(
            q,
            &[(v(0.036, 0.98, -0.066), 0.030), (v(0.040, 1.12, -0.046), 0.030), (v(0.036, 1.30, -0.084), 0.025)],
            0.02,
        );
        union(union(lat, scapula, 0.07), erector, 0.06)
    }

    fn front(&self, p: Vec3, q: Vec3) -> f32 {
        let v = Vec3::new;
        // A slab with a lower border that runs up to the arm pit; the two leave a furrow on the breastbone.
        let pec = |s: f32| {
            let p = v(p.x * s, p.y, p.z);
            let body = ellipsoid(p, v(0.074, 1.308, 0.070), v(0.073, 0.058, 0.044));
            let tail = round_cone(p, v(0.082, 1.325, 0.066), v(0.166, 1.380, 0.020), 0.042, 0.032);
            union(body, tail, 0.05)
        };
        let belly = ellipsoid(q, v(0.0, 1.035, 0.037), v(0.100, 0.125, 0.076));
        let ribs = ellipsoid(q, v(0.056, 1.190, 0.046), v(0.072, 0.090, 0.056));
        let hip = ellipsoid(q, v(0.100, 1.000, 0.034), v(0.045, 0.060, 0.050));
        let mound = ellipsoid(q, v(0.0, 0.868, 0.045), v(0.050, 0.060, 0.042));
        let chest = union(union(pec(1.0), pec(-1.0), 0.026), ribs, 0.05);
        union(union(union(chest, belly, 0.07), hip, 0.06), mound, 0.07)
    }

    fn neck(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        let column = self.neck.distance(q);
        let strap = chain(
            q,
            &[(v(0.040, 1.585, -0.014), 0.010), (v(0.031, 1.505, 0.014), 0.011), (v(0.012, 1.434, 0.034), 0.009)],
            0.01,
        );
        let larynx = ellipsoid(q, v(0.0, 1.502, 0.031), v(0.012, 0.020, 0.013));
        union(union(column, strap, 0.030), larynx, 0.026)
    }
}

fn trapezius(q: Vec3) -> f32 {
    let v = Vec3::new;
    let knots = [
        (v(0.018, 1.550, -0.042), 0.022),
        (v(0.052, 1.470, -0.052), 0.031),
        (v(0.108, 1.438, -0.047), 0.031),
        (v(0.165, 1.411, -0.032), 0.029),
    ];
    chain(q, &knots, 0.05)
}

fn buttocks(p: Vec3) -> f32 {
    let side = |s: f32| {
        let q = Vec3::new(p.x * s, p.y, p.z);
        let seat = ellipsoid(q, Vec3::new(0.076, 0.874, -0.060), Vec3::new(0.079, 0.086, 0.079));
        let upper = ellipsoid(q, Vec3::new(0.082, 0.950, -0.046), Vec3::new(0.070, 0.068, 0.062));
        union(seat, upper, 0.07)
    };
    let both = union(side(1.0), side(-1.0), 0.012);
    let cleft = ellipsoid(p, Vec3::new(0.0, 0.884, -0.152), Vec3::new(0.009, 0.085, 0.060));
    cut(both, cleft, 0.02)
}

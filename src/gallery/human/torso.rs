//! Trunk and neck: a measured silhouette with the muscles a stranger looks for.

use glam::{Vec2, Vec3};

use crate::gallery::implicit::{Loft, Station, bump, chain, cut, ellipsoid, mirrored, round_cone, union};

/// Trunk and neck.
#[derive(Debug)]
pub struct Torso {
    trunk: Loft,
    neck: Loft,
}

impl Torso {
    /// Half-breadths and depths after the usual proportions of a 1.75 m adult between the sexes: waist 0.28 wide at
    /// 0.63 of the height, hips 0.34 at 0.53, chest 0.32 at 0.73, neck 0.36 around.
    pub(crate) fn new() -> Self {
        let trunk = [
            Station::sym(0.840, 0.120, 0.056, -0.075, 2.2),
            Station::sym(0.890, 0.156, 0.086, -0.098, 2.2),
            Station::sym(0.935, 0.168, 0.099, -0.108, 2.3),
            Station::sym(0.980, 0.166, 0.102, -0.104, 2.3),
            Station::sym(1.040, 0.150, 0.105, -0.088, 2.3),
            Station::sym(1.100, 0.138, 0.101, -0.077, 2.3),
            Station::sym(1.160, 0.138, 0.100, -0.081, 2.3),
            Station::sym(1.220, 0.146, 0.106, -0.097, 2.3),
            Station::sym(1.280, 0.155, 0.112, -0.112, 2.3),
            Station::sym(1.340, 0.158, 0.104, -0.120, 2.3),
            Station::sym(1.390, 0.148, 0.082, -0.118, 2.2),
            Station::sym(1.430, 0.112, 0.052, -0.104, 2.1),
            Station::sym(1.460, 0.070, 0.028, -0.084, 2.0),
        ];
        let neck = [
            Station::sym(1.400, 0.070, 0.030, -0.092, 2.0),
            Station::sym(1.440, 0.062, 0.032, -0.082, 2.0),
            Station::sym(1.480, 0.053, 0.036, -0.068, 2.0),
            Station::sym(1.520, 0.051, 0.042, -0.061, 2.0),
            Station::sym(1.560, 0.051, 0.045, -0.060, 2.0),
            Station::sym(1.610, 0.051, 0.045, -0.060, 2.0),
        ];
        Self { trunk: Loft::new(&trunk, [0.05, 0.03]), neck: Loft::new(&neck, [0.03, 0.03]) }
    }

    /// Near-distance; `p` in the body's space, either half.
    pub fn distance(&self, p: Vec3) -> f32 {
        let q = mirrored(p, 0.004);
        let mut f = self.trunk.distance(q);
        f = union(f, self.back(q), 0.07);
        f = union(f, self.front(p, q), 0.06);
        f = union(f, buttocks(p), 0.045);
        f = union(f, self.neck(q), 0.05);
        f = union(f, shoulder_girdle(q), 0.060);
        // Furrow of the spine, line of the belly, navel, notch above the breastbone.
        let back = Vec2::new(p.x, 0.0).length();
        f += 0.0065 * bump(back, 0.030) * bump(p.y - 1.17, 0.25) * f32::from(p.z < 0.0);
        f += 0.0030 * bump(back, 0.020) * bump(p.y - 1.17, 0.15) * f32::from(p.z > 0.0);
        f += 0.0120 * bump(p.distance(Vec3::new(0.0, 1.047, 0.106)), 0.013);
        f += 0.0045 * bump(p.distance(Vec3::new(0.0, 1.432, 0.046)), 0.030);
        f
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
        let pec = |s: f32| {
            let p = v(p.x * s, p.y, p.z);
            let body = ellipsoid(p, v(0.076, 1.298, 0.068), v(0.074, 0.058, 0.050));
            let tail = round_cone(p, v(0.085, 1.318, 0.062), v(0.168, 1.378, 0.020), 0.044, 0.032);
            union(body, tail, 0.05)
        };
        let ribs = round_cone(q, v(0.040, 1.200, 0.066), v(0.098, 1.140, 0.036), 0.036, 0.036);
        let belly = ellipsoid(q, v(0.0, 1.035, 0.035), v(0.105, 0.130, 0.076));
        let hip = ellipsoid(q, v(0.105, 1.000, 0.036), v(0.045, 0.060, 0.050));
        let mound = ellipsoid(q, v(0.0, 0.868, 0.045), v(0.050, 0.060, 0.042));
        let chest = union(union(pec(1.0), pec(-1.0), 0.030), ribs, 0.06);
        union(union(union(chest, belly, 0.07), hip, 0.06), mound, 0.07)
    }

    fn neck(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        let column = self.neck.distance(q);
        let strap = chain(
            q,
            &[(v(0.048, 1.585, -0.014), 0.012), (v(0.034, 1.505, 0.016), 0.012), (v(0.014, 1.437, 0.034), 0.009)],
            0.01,
        );
        let larynx = ellipsoid(q, v(0.0, 1.502, 0.032), v(0.013, 0.020, 0.013));
        union(union(column, strap, 0.026), larynx, 0.026)
    }
}

fn shoulder_girdle(q: Vec3) -> f32 {
    let v = Vec3::new;
    let trapezius = chain(
        q,
        &[(v(0.020, 1.545, -0.040), 0.026), (v(0.065, 1.462, -0.050), 0.036), (v(0.160, 1.428, -0.034), 0.030)],
        0.05,
    );
    let clavicle = chain(
        q,
        &[
            (v(0.022, 1.416, 0.034), 0.010),
            (v(0.075, 1.424, 0.036), 0.009),
            (v(0.125, 1.434, 0.014), 0.009),
            (v(0.175, 1.438, -0.014), 0.012),
        ],
        0.02,
    );
    union(trapezius, clavicle, 0.034)
}

fn buttocks(p: Vec3) -> f32 {
    let side = |s: f32| {
        let q = Vec3::new(p.x * s, p.y, p.z);
        let seat = ellipsoid(q, Vec3::new(0.078, 0.878, -0.066), Vec3::new(0.080, 0.082, 0.078));
        let upper = ellipsoid(q, Vec3::new(0.090, 0.955, -0.052), Vec3::new(0.072, 0.070, 0.066));
        union(seat, upper, 0.06)
    };
    let both = union(side(1.0), side(-1.0), 0.014);
    let cleft = ellipsoid(p, Vec3::new(0.0, 0.875, -0.150), Vec3::new(0.006, 0.070, 0.050));
    cut(both, cleft, 0.02)
}

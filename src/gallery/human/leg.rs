//! Thigh, knee, calf, ankle and foot, of the half x ≥ 0.

use glam::Vec3;

use crate::gallery::implicit::{Frame, Loft, Station, ball, bump, chain, common, ellipsoid, round_cone, union};

/// One leg with its foot.
#[derive(Debug)]
pub struct Leg {
    shank: Loft,
    foot: Frame,
    toes: [Toe; 5],
}

/// A toe in the foot's frame: the joints' centres and radii.
#[derive(Debug)]
pub struct Toe {
    /// Base, middle, tip.
    pub knots: [(Vec3, f32); 3],
}

/// Where the foot stands: below the ankle, on the ground.
const ANKLE: Vec3 = Vec3::new(0.151, 0.0, -0.018);

impl Leg {
    /// Crotch at 0.47 of the height, knee at 0.28, calf thickest at 0.20, ankle at 0.05.
    pub(crate) fn new() -> Self {
        let s = Station::between;
        let shank = [
            s(0.940, 0.045, 0.125, 0.030, -0.040, 2.0),
            s(0.895, 0.022, 0.154, 0.064, -0.068, 2.1),
            s(0.840, 0.008, 0.173, 0.083, -0.083, 2.1),
            s(0.760, 0.016, 0.185, 0.089, -0.084, 2.1),
            s(0.680, 0.036, 0.189, 0.085, -0.077, 2.1),
            s(0.600, 0.058, 0.187, 0.073, -0.067, 2.1),
            s(0.540, 0.073, 0.181, 0.061, -0.057, 2.2),
            s(0.490, 0.080, 0.177, 0.054, -0.051, 2.3),
            s(0.445, 0.082, 0.177, 0.046, -0.053, 2.3),
            s(0.400, 0.086, 0.182, 0.036, -0.062, 2.1),
            s(0.345, 0.090, 0.188, 0.030, -0.070, 2.1),
            s(0.290, 0.098, 0.186, 0.025, -0.066, 2.1),
            s(0.220, 0.112, 0.182, 0.020, -0.054, 2.1),
            s(0.150, 0.122, 0.180, 0.017, -0.047, 2.1),
            s(0.100, 0.123, 0.181, 0.018, -0.048, 2.1),
            s(0.060, 0.122, 0.180, 0.018, -0.048, 2.1),
        ];
        let mut ordered = shank;
        ordered.reverse();
        let foot = Frame::new(ANKLE, Vec3::Y, Vec3::new(0.20, 0.0, 1.0).normalize());
        Self { shank: Loft::new(&ordered, [0.03, 0.05]), foot, toes: toes() }
    }

    /// The foot's frame: x lateral, y up, z towards the toes, origin on the ground below the ankle.
    pub fn foot_frame(&self) -> &Frame {
        &self.foot
    }

    /// Great toe first.
    pub fn toes(&self) -> &[Toe; 5] {
        &self.toes
    }

    /// Near-distance; `q` in the half x ≥ 0.
    pub fn distance(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        let mut f = self.shank.distance(q);
        if q.y > 0.24 && q.y < 0.72 {
            let quad = ellipsoid(q, v(0.102, 0.575, 0.032), v(0.030, 0.062, 0.032));
            let outer = ellipsoid(q, v(0.158, 0.600, 0.032), v(0.026, 0.075, 0.032));
            f = union(f, union(quad, outer, 0.04), 0.045);
            f = union(f, ellipsoid(q, v(0.129, 0.494, 0.037), v(0.025, 0.030, 0.021)), 0.026);
            f = union(f, round_cone(q, v(0.129, 0.462, 0.036), v(0.131, 0.430, 0.030), 0.010, 0.012), 0.025);
            f = union(f, ellipsoid(q, v(0.114, 0.365, -0.040), v(0.030, 0.090, 0.036)), 0.045);
            f = union(f, ellipsoid(q, v(0.160, 0.375, -0.040), v(0.028, 0.086, 0.034)), 0.045);
            f += 0.006 * bump(q.distance(v(0.130, 0.480, -0.062)), 0.045);
        }
        if q.y < 0.40 {
            f = union(f, self.foot_distance(q), 0.028);
        }
        f
    }

    fn foot_distance(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        let p = self.foot.local(q);
        let heel = ellipsoid(p, v(0.0, 0.030, -0.040), v(0.032, 0.038, 0.036));
        let tendon = round_cone(p, v(0.0, 0.250, -0.018), v(0.0, 0.045, -0.048), 0.008, 0.017);
        let inner = chain(
            p,
            &[(v(-0.008, 0.040, -0.015), 0.030), (v(-0.020, 0.040, 0.055), 0.025), (v(-0.030, 0.022, 0.128), 0.021)],
            0.02,
        );
        let outer = chain(
            p,
            &[(v(0.010, 0.032, -0.015), 0.027), (v(0.024, 0.024, 0.050), 0.021), (v(0.038, 0.015, 0.105), 0.014)],
            0.02,
        );
        let instep = chain(
            p,
            &[(v(0.0, 0.080, 0.004), 0.032), (v(-0.006, 0.052, 0.055), 0.026), (v(-0.004, 0.024, 0.122), 0.017)],
            0.03,
        );
        let ankles = ball(p, v(-0.026, 0.088, 0.004), 0.0125).min(ball(p, v(0.029, 0.076, -0.004), 0.012));
        let mut f = union(union(inner, outer, 0.03), instep, 0.03);
        f = union(union(f, heel, 0.03), tendon, 0.03);
        f = union(f, ankles, 0.02);
        for toe in &self.toes {
            f = union(f, chain(p, &toe.knots, 0.004), 0.010);
        }
        // The ground flattens the sole.
        common(f, -p.y, 0.012)
    }
}

fn toes() -> [Toe; 5] {
    // Base x, z; direction outward in degrees; length; radius at the waist and at the pad: metres, a tenth over life.
    let table: [(f32, f32, f32, f32, f32, f32); 5] = [
        (-0.034, 0.136, -7.0, 0.053, 0.0124, 0.0136),
        (-0.007, 0.138, 1.0, 0.048, 0.0088, 0.0100),
        (0.013, 0.130, 10.0, 0.044, 0.0084, 0.0095),
        (0.031, 0.118, 19.0, 0.039, 0.0080, 0.0091),
        (0.046, 0.104, 29.0, 0.033, 0.0078, 0.0088),
    ];
    table.map(|(x, z, degrees, length, waist, pad)| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let along = |t: f32, y: f32| Vec3::new(x + sin * length * t, y, z + cos * length * t);
        Toe { knots: [(along(-0.2, 0.020), waist * 1.15), (along(0.45, 0.017), waist), (along(1.0, pad * 0.95), pad)] }
    })
}

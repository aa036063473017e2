//! Thigh, knee, calf, ankle and foot, of the half x ≥ 0.

use glam::Vec3;

use super::finger::nail;
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

impl Toe {
    /// Near-distance; `p` in the foot's frame.
    fn distance(&self, p: Vec3) -> f32 {
        let [_, (joint, _), (tip, r)] = self.knots;
        let f = chain(p, &self.knots, 0.004);
        if f > 0.03 {
            return f;
        }
        let along = ((tip - joint) * Vec3::new(1.0, 0.0, 1.0)).normalize();
        let side = along.cross(Vec3::Y);
        let d = p - tip;
        f + nail(Vec3::new(d.dot(side), d.dot(along) - 0.1 * r, d.y), r)
    }
}

/// Where the foot stands: below the ankle, on the ground.
const ANKLE: Vec3 = Vec3::new(0.154, 0.0, -0.018);

impl Leg {
    /// Crotch at 0.47 of the height, knee at 0.28, calf thickest at 0.20, ankle at 0.05.
    pub(crate) fn new() -> Self {
        let s = Station::between;
        let shank = [
            s(0.940, 0.040, 0.140, 0.036, -0.046, 2.0),
            s(0.895, 0.022, 0.165, 0.066, -0.070, 2.1),
            s(0.840, 0.008, 0.177, 0.083, -0.094, 2.1),
            s(0.760, 0.016, 0.183, 0.089, -0.092, 2.1),
            s(0.680, 0.035, 0.184, 0.085, -0.083, 2.1),
            s(0.600, 0.056, 0.181, 0.073, -0.071, 2.1),
            s(0.540, 0.070, 0.176, 0.061, -0.060, 2.2),
            s(0.490, 0.077, 0.173, 0.054, -0.053, 2.2),
            s(0.445, 0.079, 0.173, 0.046, -0.054, 2.2),
            s(0.400, 0.083, 0.180, 0.037, -0.062, 2.1),
            s(0.345, 0.090, 0.188, 0.030, -0.070, 2.1),
            s(0.290, 0.098, 0.186, 0.025, -0.066, 2.1),
            s(0.220, 0.112, 0.182, 0.020, -0.054, 2.1),
            s(0.150, 0.121, 0.181, 0.018, -0.048, 2.1),
            s(0.100, 0.123, 0.181, 0.018, -0.048, 2.1),
            s(0.060, 0.122, 0.180, 0.018, -0.048, 2.1),
        ];
        let mut ordered = shank;
        ordered.reverse();
        let foot = Frame::new(ANKLE, Vec3::Y, Vec3::new(0.10, 0.0, 1.0).normalize());
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
            &[(v(-0.008, 0.040, -0.015), 0.030), (v(-0.022, 0.040, 0.055), 0.026), (v(-0.040, 0.022, 0.119), 0.021)],
            0.02,
        );
        let outer = chain(
            p,
            &[(v(0.010, 0.032, -0.015), 0.027), (v(0.027, 0.024, 0.050), 0.022), (v(0.049, 0.015, 0.094), 0.015)],
            0.02,
        );
        let instep = chain(
            p,
            &[(v(0.0, 0.082, 0.004), 0.031), (v(-0.008, 0.054, 0.055), 0.028), (v(-0.010, 0.024, 0.117), 0.017)],
            0.03,
        );
        let ankles = ball(p, v(-0.026, 0.088, 0.004), 0.0098).min(ball(p, v(0.029, 0.076, -0.004), 0.0098));
        let mut f = union(union(inner, outer, 0.03), instep, 0.03);
        f = union(union(f, heel, 0.03), tendon, 0.03);
        f = union(f, ankles, 0.028);
        for toe in &self.toes {
            // The bone behind it, from the middle of the foot to the toe's ball.
            let (base, r) = toe.knots[0];
            let head = Vec3::new(base.x, 0.0195, base.z - 0.004);
            f = union(f, round_cone(p, v(0.25 * base.x - 0.004, 0.044, 0.045), head, 0.026, 1.15 * r + 0.005), 0.022);
        }
        for toe in &self.toes {
            f = union(f, toe.distance(p), 0.012);
        }
        // The ground flattens the sole.
        common(f, -p.y, 0.012)
    }
}

fn toes() -> [Toe; 5] {
    // Base x, z; direction outward in degrees; length; radius at the waist and at the pad: metres, a little over life.
    // Spread so far, and stepping back to the little toe, that no two share a cell over their outer half at 96 cells
    // along the body. Gaps are 15 to 19 mm there, cells 18: the bounds between cells must fall into the gaps.
    let table: [(f32, f32, f32, f32, f32, f32); 5] = [
        (-0.0483, 0.1305, -3.6, 0.041, 0.0122, 0.0134),
        (-0.0127, 0.1345, 1.6, 0.037, 0.0084, 0.0093),
        (0.0164, 0.1320, 10.1, 0.034, 0.0080, 0.0089),
        (0.0442, 0.1223, 26.7, 0.031, 0.0077, 0.0085),
        (0.0589, 0.0891, 32.1, 0.027, 0.0076, 0.0083),
    ];
    table.map(|(x, z, degrees, length, waist, pad)| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let along = |t: f32, y: f32| Vec3::new(x + sin * length * t, y, z + cos * length * t);
        Toe { knots: [(along(-0.2, 0.020), waist * 1.15), (along(0.50, 0.0175), waist), (along(1.0, pad * 0.95), pad)] }
    })
}

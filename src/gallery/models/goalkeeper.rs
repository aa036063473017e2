//! A goalkeeper in full stretch, the ball at the fingertips of the upper hand.

use glam::Vec3;

use super::shapes::{Solid, Tube, stick};
use crate::gallery::implicit::{Frame, Loft, Station, ball, ellipsoid, ramp, round_box, round_cone};

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// One side of the body in the trunk's frame: y to the head, z out of the chest.
struct Side {
    shoulder: Vec3,
    elbow: Vec3,
    wrist: Vec3,
    /// Where the palm looks.
    palm: Vec3,
    hip: Vec3,
    knee: Vec3,
    ankle: Vec3,
    toes: Vec3,
}

/// The upper side, then the lower one.
const SIDES: [Side; 2] = [
    Side {
        shoulder: v(-0.180, 0.440, 0.0),
        elbow: v(-0.215, 0.715, 0.050),
        wrist: v(-0.165, 0.960, 0.110),
        palm: v(0.25, 0.0, 1.0),
        hip: v(-0.092, 0.000, 0.0),
        knee: v(-0.135, -0.270, 0.325),
        ankle: v(-0.150, -0.560, 0.060),
        toes: v(-0.160, -0.680, 0.120),
    },
    Side {
        shoulder: v(0.180, 0.440, 0.0),
        elbow: v(0.220, 0.700, 0.060),
        wrist: v(0.165, 0.930, 0.130),
        palm: v(-0.25, 0.0, 1.0),
        hip: v(0.092, 0.000, 0.0),
        knee: v(0.115, -0.425, 0.060),
        ankle: v(0.125, -0.830, -0.050),
        toes: v(0.130, -0.975, -0.010),
    },
];

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        v(-1.20, -0.16, -0.34),
        v(1.28, 1.62, 0.55),
        0.045,
        &[
            ("trunk", 0.021),
            ("head", 0.0165),
            ("shoulder", 0.017),
            ("upper_arm", 0.017),
            ("forearm", 0.015),
            ("hand", 0.0115),
            ("hip", 0.022),
            ("thigh", 0.019),
            ("knee", 0.015),
            ("shin", 0.0165),
            ("foot", 0.0145),
            ("ball", 0.019),
        ],
    );
    let body = Frame::new(v(-0.20, 0.66, 0.0), v(0.84, 0.54, 0.0), Vec3::Z);
    trunk(&mut s, body);
    head(&mut s, body);
    for side in &SIDES {
        arm(&mut s, body, side);
        leg(&mut s, body, side);
    }
    s
}

fn trunk(s: &mut Solid, body: Frame) {
    let loft = Loft::new(
        &[
            Station::sym(0.02, 0.165, 0.100, -0.120, 2.5),
            Station::sym(0.13, 0.150, 0.098, -0.102, 2.5),
            Station::sym(0.28, 0.172, 0.118, -0.110, 2.5),
            Station::sym(0.40, 0.190, 0.112, -0.112, 2.5),
            Station::sym(0.475, 0.120, 0.070, -0.090, 2.3),
        ],
        [0.06, 0.05],
    );
    s.add("trunk", 0.0, move |p| loft.distance(body.local(p)));
    s.add("hip", 0.08, move |p| ellipsoid(body.local(p), v(0.0, 0.0, -0.015), v(0.175, 0.105, 0.128)));
    // The shirt's hem.
    s.add("trunk", 0.03, move |p| {
        let q = body.local(p) - v(0.0, 0.055, -0.008);
        super::shapes::torus(v(q.x * 0.72, q.y, q.z), 0.120, 0.018)
    });
}

fn head(s: &mut Solid, body: Frame) {
    let at = move |p: Vec3| body.local(p);
    s.add("head", 0.04, move |p| round_cone(at(p), v(0.0, 0.45, -0.02), v(0.0, 0.57, 0.01), 0.062, 0.055));
    s.add("head", 0.02, move |p| ellipsoid(at(p), v(0.0, 0.690, 0.022), v(0.082, 0.112, 0.102)));
    s.add("head", 0.05, move |p| ellipsoid(at(p), v(0.0, 0.630, 0.062), v(0.060, 0.062, 0.062)));
    // Nose, ears, a cap of hair.
    s.add("head", 0.020, move |p| round_cone(at(p), v(0.0, 0.700, 0.118), v(0.0, 0.668, 0.132), 0.012, 0.019));
    s.add("head", 0.012, move |p| {
        ellipsoid(v(at(p).x.abs(), at(p).y, at(p).z), v(0.086, 0.682, 0.010), v(0.016, 0.032, 0.024))
    });
    s.add("head", 0.010, move |p| {
        let q = at(p);
        let hair = ellipsoid(q, v(0.0, 0.712, 0.000), v(0.094, 0.108, 0.106));
        hair.max(0.075 - (q.y - 0.66) - 0.10 * ramp(-q.z, -0.05, 0.06))
    });
}

fn arm(s: &mut Solid, body: Frame, side: &Side) {
    let [shoulder, elbow, wrist] = [side.shoulder, side.elbow, side.wrist].map(|p| body.world(p));
    s.add("shoulder", 0.07, move |p| ball(p, shoulder, 0.082));
    s.paint("shoulder", move |p| ramp(-ball(p, shoulder, 0.075), -0.055, 0.0));
    let upper = Tube::new(&[(shoulder, 0.066), (shoulder.lerp(elbow, 0.45), 0.060), (elbow, 0.045)]);
    s.add("upper_arm", 0.04, move |p| upper.distance(p));
    let fore = Tube::new(&[(elbow, 0.046), (elbow.lerp(wrist, 0.35), 0.049), (wrist, 0.036)]);
    s.add("forearm", 0.03, move |p| fore.distance(p));
    // A glove with cuff, palm, four fingers and a thumb.
    let along = (wrist - elbow).normalize();
    let glove = Frame::new(wrist, along, body.axes * side.palm);
    // The thumbs look at each other.
    let inward = if side.palm.x > 0.0 { 1.0 } else { -1.0 };
    let inward = if glove.axes.x_axis.dot(body.axes.x_axis) > 0.0 { inward } else { -inward };
    s.add("hand", 0.014, move |p| round_cone(glove.local(p), v(0.0, 0.0, 0.0), v(0.0, 0.04, 0.0), 0.047, 0.049));
    s.add("hand", 0.022, move |p| round_box(glove.local(p) - v(0.0, 0.095, 0.0), v(0.068, 0.062, 0.034), 0.032));
    for (i, length) in [0.098, 0.108, 0.102, 0.084].into_iter().enumerate() {
        let k = 1.5 - i as f32;
        let (sin, cos) = (inward * k * 17.0_f32).to_radians().sin_cos();
        let root = v(inward * k * 0.036, 0.138 - 0.004 * k * k, 0.0);
        let tip = root + v(length * sin, length * cos, 0.018);
        s.add("hand", 0.012, move |p| round_cone(glove.local(p), root, tip, 0.0245, 0.0225));
    }
    s.add("hand", 0.018, move |p| {
        let (a, b) = (v(inward * 0.048, 0.070, 0.012), v(inward * 0.125, 0.118, 0.045));
        round_cone(glove.local(p), a, b, 0.030, 0.024)
    });
    if side.palm.x > 0.0 {
        let centre = glove.world(v(-inward * 0.045, 0.262, 0.126));
        s.add("ball", 0.010, move |p| ball(p, centre, 0.118));
    }
}

fn leg(s: &mut Solid, body: Frame, side: &Side) {
    let [hip, knee, ankle, toes] = [side.hip, side.knee, side.ankle, side.toes].map(|p| body.world(p));
    let thigh = Tube::new(&[(hip, 0.098), (hip.lerp(knee, 0.45), 0.083), (knee, 0.060)]);
    s.add("thigh", 0.05, move |p| thigh.distance(p));
    // Shorts to the middle of the thigh.
    let hem = hip.lerp(knee, 0.52);
    s.add("thigh", 0.012, move |p| round_cone(p, hip, hem, 0.105, 0.096).max((p - hem).dot((knee - hip).normalize())));
    s.add("knee", 0.03, move |p| ball(p, knee, 0.064));
    s.paint("knee", move |p| ramp(-ball(p, knee, 0.068), -0.050, 0.0));
    let calf = knee.lerp(ankle, 0.32);
    let back = (knee - hip).normalize() + (knee - ankle).normalize();
    let shin =
        Tube::new(&[(knee, 0.056), (calf - back * 0.012, 0.060), (knee.lerp(ankle, 0.7), 0.046), (ankle, 0.041)]);
    s.add("shin", 0.03, move |p| shin.distance(p));
    // A sock's rim.
    let rim = knee.lerp(ankle, 0.20);
    let down = (ankle - knee).normalize();
    s.add("shin", 0.012, move |p| stick(p, rim, rim + down * 0.02, 0.066));
    // A boot: heel, ankle, and a toe cap that is wider than it is high.
    let forward = (toes - ankle).normalize();
    let heel = ankle + down * 0.038 - forward * 0.035;
    let tip = toes + down * 0.030 + forward * 0.020;
    s.add("foot", 0.03, move |p| round_cone(p, heel, ankle + down * 0.015, 0.045, 0.047));
    s.add("foot", 0.03, move |p| round_cone(p, heel, tip, 0.046, 0.043));
    s.add("foot", 0.03, move |p| ball(p, heel.lerp(tip, 0.62) - down * 0.012, 0.050));
}

//! Regions of the body, named as anatomy names them, with smooth membership.
//!
//! Each region is *painted over* the ones before it with an opacity between 0 and 1, so that a vertex's weights always
//! sum to 1 and change smoothly wherever the opacities do.

use glam::Vec3;

use super::face::EYE;
use super::head::to_head;
use super::{Finger, Human};
use crate::gallery::implicit::{ellipsoid, ramp, round_cone};

/// All regions of the human, in the order of [`memberships`]' indices.
pub const NAMES: [&str; 35] = [
    "scalp",
    "forehead",
    "eye",
    "ear",
    "nose",
    "cheek",
    "lip",
    "mouth",
    "chin",
    "neck",
    "shoulder",
    "upper_arm",
    "forearm",
    "back_of_hand",
    "palm",
    "thumb",
    "thumb_tip",
    "index_finger",
    "index_fingertip",
    "middle_finger",
    "middle_fingertip",
    "ring_finger",
    "ring_fingertip",
    "little_finger",
    "little_fingertip",
    "chest",
    "belly",
    "back",
    "buttock",
    "thigh",
    "calf",
    "foot",
    "sole",
    "great_toe",
    "toes",
];

/// A stack of paint.
struct Paint([f32; NAMES.len()]);

impl Paint {
    /// Paints `region` over what is there. An unknown name is a slip of the pen that the tests catch (nothing happens).
    fn over(&mut self, region: &str, opacity: f32) {
        let Some(k) = NAMES.iter().position(|n| *n == region) else { return };
        self.0.iter_mut().for_each(|w| *w *= 1.0 - opacity);
        self.0[k] += opacity;
    }
}

/// Regions and weights of a point of the skin: weights above a thousandth, summing to 1.
pub fn memberships(human: &Human, p: Vec3) -> Vec<(u16, f32)> {
    let mut paint = Paint([0.0; NAMES.len()]);
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    trunk(&mut paint, q);
    leg(&mut paint, human, q);
    head(&mut paint, human, q);
    arm(&mut paint, human, p, q);
    let mut kept: Vec<(u16, f32)> = (0_u16..).zip(paint.0).filter(|&(_, w)| w > 1e-3).collect();
    let total: f32 = kept.iter().map(|k| k.1).sum();
    kept.iter_mut().for_each(|k| k.1 /= total);
    kept
}

fn trunk(paint: &mut Paint, q: Vec3) {
    paint.over("chest", 1.0);
    paint.over("belly", ramp(1.19 - q.y, -0.04, 0.04));
    paint.over("back", ramp(-0.008 - q.z, -0.022, 0.022));
    paint.over("buttock", ramp(-0.030 - q.z, -0.02, 0.02) * ramp(0.985 - q.y, -0.03, 0.03));
    paint.over("shoulder", ramp(q.x, 0.095, 0.150) * ramp(q.y, 1.35, 1.41));
    paint.over("neck", ramp(q.y - 1.447 + 0.10 * q.z, -0.018, 0.018) * ramp(0.095 - q.x, -0.015, 0.02));
}

fn leg(paint: &mut Paint, human: &Human, q: Vec3) {
    // The groin rises outward; behind, the fold below the buttock is level.
    let front = ramp(0.850 + 0.45 * (q.x - 0.03) - q.y, -0.025, 0.025);
    let fold = ramp(0.815 - q.y, -0.02, 0.02);
    let behind = ramp(-0.030 - q.z, -0.02, 0.02);
    let below = ramp(1.0 - q.y, -0.02, 0.02) * ramp(0.40 - q.x, 0.0, 0.05);
    paint.over("thigh", below * (front + (fold - front) * behind));
    paint.over("calf", ramp(0.465 - q.y, -0.025, 0.025));
    paint.over("foot", ramp(0.095 - q.y, -0.018, 0.018));
    paint.over("sole", ramp(0.015 - q.y, -0.010, 0.010));
    let p = human.leg.foot_frame().local(q);
    for (i, toe) in human.leg.toes().iter().enumerate() {
        let [a, b, c] = toe.knots.map(|k| k.0);
        let near = round_cone(p, a, b, toe.knots[0].1, toe.knots[1].1).min(round_cone(
            p,
            b,
            c,
            toe.knots[1].1,
            toe.knots[2].1,
        ));
        let along = (p - a).dot((c - a).normalize());
        let opacity = ramp(0.0105 - near, 0.0, 0.011) * ramp(along, 0.007, 0.029);
        paint.over(if i == 0 { "great_toe" } else { "toes" }, opacity);
    }
}

fn head(paint: &mut Paint, human: &Human, body: Vec3) {
    let face = &human.head.face;
    let q = to_head(body);
    let v = Vec3::new;
    // From below the chin up behind the ear to the hairline of the nape.
    let line = -100.0 + 0.45 * (84.0 - q.z).max(0.0);
    let head = ramp(q.y - line, -8.0, 8.0);
    paint.over("scalp", head);
    paint.over("cheek", head * ramp(q.z, 4.0, 26.0) * ramp(22.0 - q.y, -8.0, 8.0));
    paint.over("forehead", head * ramp(q.z, 34.0, 58.0) * ramp(q.y, 8.0, 22.0) * ramp(66.0 - q.y, -8.0, 8.0));
    paint.over("chin", ramp(-ellipsoid(q, v(0.0, -98.0, 84.0), v(27.0, 19.0, 26.0)), -6.0, 2.0));
    paint.over("mouth", ramp(-ellipsoid(q, v(0.0, -71.0, 98.0), v(35.0, 19.0, 24.0)), -5.0, 3.0));
    paint.over("eye", ramp(23.0 - q.distance(EYE.0), -1.0, 7.0));
    let nose = round_cone(q, v(0.0, 2.0, 96.0), v(0.0, -41.0, 106.0), 10.0, 18.0);
    paint.over("nose", ramp(-nose, -4.0, 1.5) * ramp(q.y, -56.0, -50.0));
    paint.over("lip", ramp(3.2 - face.lips(q), 0.0, 5.2) * ramp(q.z, 60.0, 75.0));
    paint.over("ear", ramp(3.5 - face.ear(q), 0.0, 6.0) * ramp(q.x, 64.0, 74.0));
}

fn arm(paint: &mut Paint, human: &Human, p: Vec3, q: Vec3) {
    let arm = &human.arm;
    let (limb, trunk) = (arm.distance(q), human.torso.distance(p));
    let is_arm = ramp(trunk - limb, -0.026, 0.036) * ramp(q.x, 0.10, 0.18) * ramp(q.y, 0.5, 0.6);
    if is_arm <= 0.0 {
        return;
    }
    let (upper, fore, hand) = (arm.upper.local(q), arm.fore.local(q), arm.hand.frame.local(q));
    paint.over("shoulder", is_arm);
    paint.over("upper_arm", is_arm * ramp(upper.y, 0.075, 0.135));
    paint.over("forearm", is_arm * ramp(fore.y, -0.03, 0.03));
    hand_regions(paint, &arm.hand.fingers, hand, is_arm);
}

/// Paints the hand; `p` in the hand's frame.
fn hand_regions(paint: &mut Paint, fingers: &[Finger; 5], p: Vec3, opacity: f32) {
    paint.over("back_of_hand", opacity * ramp(p.y, -0.012, 0.018));
    paint.over("palm", opacity * ramp(p.y, -0.006, 0.024) * ramp(p.z, -0.004, 0.010));
    for (i, finger) in fingers.iter().enumerate() {
        // The thumb begins at its knuckle, past the metacarpal.
        let first = usize::from(i == 0);
        let near = 0.008 - finger.distance(p);
        let begin = finger.knots[first].0;
        let out = (finger.knots[first + 1].0 - begin).normalize();
        let joint = finger.knots[2].0;
        let to_tip = (finger.knots[3].0 - joint).normalize();
        let digit = opacity * ramp(near, 0.0, 0.006) * ramp((p - begin).dot(out), 0.004, 0.026);
        paint.over(NAMES[15 + 2 * i], digit);
        paint.over(NAMES[16 + 2 * i], digit * ramp((p - joint).dot(to_tip), -0.004, 0.010));
    }
}

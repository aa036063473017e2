//! An airliner with four engines on approach: flaps and landing gear out.

use glam::Vec3;

use super::shapes::{Solid, Tube, disc, frame};
use crate::gallery::implicit::{Loft, Station, ellipsoid, round_cone, union};

/// Edge of the wing's plan at a share `s` of the half-span (0 at the root): nose, tail, height, half-thickness.
const WING: [[f32; 5]; 4] = [
    [0.00, 0.330, -0.150, -0.060, 0.036],
    [0.36, 0.080, -0.190, -0.028, 0.029],
    [0.70, -0.120, -0.265, 0.010, 0.023],
    [1.00, -0.290, -0.365, 0.046, 0.018],
];
const HALF_SPAN: f32 = 0.96;

/// Where the engines hang: x, y, z of the middle.
const ENGINES: [Vec3; 2] = [Vec3::new(0.335, -0.155, 0.205), Vec3::new(0.575, -0.130, 0.035)];

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        Vec3::new(-1.02, -0.42, -1.02),
        Vec3::new(1.02, 0.48, 1.02),
        0.045,
        &[
            ("fuselage", 0.024),
            ("wing", 0.019),
            ("flap", 0.017),
            ("tail", 0.019),
            ("engine", 0.0135),
            ("pylon", 0.016),
            ("nose_gear", 0.0125),
            ("main_gear", 0.0125),
        ],
    );
    let body = fuselage();
    s.add("fuselage", 0.0, move |p| body.distance(Vec3::new(p.x, p.z, p.y)));
    // The fairing where the wing passes through the belly.
    s.add("fuselage", 0.08, |p| ellipsoid(p, Vec3::new(0.0, -0.085, 0.06), Vec3::new(0.125, 0.070, 0.36)));
    let wing = plane(&WING, HALF_SPAN);
    s.pair("wing", 0.045, move |p| wing.distance(p));
    let tailplane = plane(&[[0.0, -0.760, -0.940, 0.065, 0.022], [1.0, -0.905, -0.985, 0.095, 0.017]], 0.36);
    s.pair("tail", 0.03, move |p| tailplane.distance(p));
    let fin = plane(&[[0.0, -0.640, -0.930, 0.0, 0.026], [1.0, -0.880, -1.000, 0.0, 0.018]], 0.40);
    s.add("tail", 0.05, move |p| fin.distance(Vec3::new(p.y - 0.05, p.x, p.z)));
    flaps(&mut s);
    engines(&mut s);
    gear(&mut s);
    s
}

/// Nose to tail along z: round in section, the belly rising towards the tail.
fn fuselage() -> Loft {
    let ring = |z: f32, r: f32, middle: f32| Station::sym(z, r, middle + r, middle - r, 2.0);
    Loft::new(
        &[
            ring(-0.90, 0.030, 0.062),
            ring(-0.74, 0.068, 0.044),
            ring(-0.50, 0.112, 0.012),
            ring(-0.28, 0.126, 0.0),
            ring(0.10, 0.128, 0.0),
            ring(0.60, 0.128, 0.0),
            ring(0.76, 0.118, -0.006),
            ring(0.86, 0.094, -0.016),
        ],
        [0.055, 0.11],
    )
}

/// A wing along x from plan rows of (share of the span, nose, tail, height, half-thickness).
fn plane(rows: &[[f32; 5]], span: f32) -> Wing {
    let stations: Vec<Station> = rows
        .iter()
        .map(|&[s, nose, tail, height, half]| {
            // Thickest at a third of the chord, as an aerofoil is.
            let thick = nose - 0.36 * (nose - tail);
            Station {
                y: s * span,
                centre: glam::Vec2::new(height, thick),
                width: [half, half],
                depth: [nose - thick, thick - tail],
                power: 2.3,
            }
        })
        .collect();
    Wing { loft: Loft::new(&stations, [0.02, 0.022]) }
}

/// A loft turned so that it runs along x.
struct Wing {
    loft: Loft,
}

impl Wing {
    fn distance(&self, p: Vec3) -> f32 {
        self.loft.distance(Vec3::new(p.y, p.x, p.z))
    }
}

/// Height, nose and tail of the wing at `x`, by straight lines.
fn wing_at(x: f32) -> [f32; 3] {
    let s = (x / HALF_SPAN).clamp(0.0, 1.0);
    let i = WING.windows(2).position(|w| s <= w[1][0]).unwrap_or(WING.len() - 2);
    let (a, b) = (WING[i], WING[i + 1]);
    let t = (s - a[0]) / (b[0] - a[0]);
    [a[3] + t * (b[3] - a[3]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])]
}

/// Two panels to a side, hinged down behind the wing.
fn flaps(s: &mut Solid) {
    for (from, to, chord) in [(0.175, 0.395, 0.115), (0.455, 0.665, 0.090)] {
        let stations = [from, to].map(|x: f32| {
            let [height, _, tail] = wing_at(x);
            let (front, back) = (tail + 0.030, tail + 0.030 - chord);
            Station {
                y: x,
                centre: glam::Vec2::new(height - 0.002, 0.5 * (front + back)),
                width: [0.019, 0.019],
                depth: [0.5 * chord, 0.5 * chord],
                power: 2.6,
            }
        });
        let loft = Loft::new(&stations, [0.018, 0.018]);
        let hinge = wing_at(0.5 * (from + to));
        s.pair("flap", 0.016, move |p| {
            // Turned by 32 degrees about the hinge at the wing's tail.
            let [_, _, tail] = wing_at(p.x.clamp(from, to));
            let (sin, cos) = 32.0_f32.to_radians().sin_cos();
            let (y, z) = (p.y - hinge[0], p.z - tail - 0.03);
            loft.distance(Vec3::new(y * cos - z * sin + hinge[0], p.x, y * sin + z * cos + tail + 0.03))
        });
    }
}

fn engines(s: &mut Solid) {
    for e in ENGINES {
        let [height, nose, _] = wing_at(e.x);
        s.pair("pylon", 0.02, move |p| {
            round_cone(p, Vec3::new(e.x, height - 0.004, nose - 0.05), e + Vec3::new(0.0, 0.05, -0.03), 0.022, 0.022)
                .min(round_cone(
                    p,
                    Vec3::new(e.x, height - 0.006, nose - 0.10),
                    e + Vec3::new(0.0, 0.05, -0.06),
                    0.022,
                    0.022,
                ))
        });
    }
    for e in ENGINES {
        let ring = |z: f32, r: f32| Station::sym(z, r, r, -r, 2.0);
        let cowl = Loft::new(
            &[ring(-0.115, 0.046), ring(-0.05, 0.066), ring(0.03, 0.073), ring(0.085, 0.068)],
            [0.012, 0.022],
        );
        let core = Tube::new(&[(Vec3::new(0.0, 0.0, -0.10), 0.036), (Vec3::new(0.0, 0.0, -0.165), 0.017)]);
        s.pair("engine", 0.018, move |p| {
            let q = p - e;
            union(cowl.distance(Vec3::new(q.x, q.z, q.y)), core.distance(q), 0.012)
        });
        s.cut(0.014, move |p| {
            let q = Vec3::new(p.x.abs(), p.y, p.z) - e;
            ellipsoid(q, Vec3::new(0.0, 0.0, 0.112), Vec3::new(0.052, 0.052, 0.052))
        });
        s.pair("engine", 0.008, move |p| {
            round_cone(p - e, Vec3::new(0.0, 0.0, 0.045), Vec3::new(0.0, 0.0, 0.085), 0.022, 0.010)
        });
    }
}

fn gear(s: &mut Solid) {
    let v = Vec3::new;
    // Nose: a leg with two wheels.
    s.add("nose_gear", 0.02, move |p| round_cone(p, v(0.0, -0.10, 0.66), v(0.0, -0.285, 0.675), 0.022, 0.019));
    s.pair("nose_gear", 0.012, move |p| wheel(p, v(0.0435, -0.290, 0.675), 0.052));
    s.add("nose_gear", 0.01, move |p| round_cone(p, v(-0.04, -0.290, 0.675), v(0.04, -0.290, 0.675), 0.016, 0.016));
    // Main: a leg below the root of each wing, four wheels on a beam.
    let leg = v(0.185, -0.290, -0.045);
    s.pair("main_gear", 0.02, move |p| round_cone(p, v(0.165, -0.07, -0.03), leg, 0.026, 0.022));
    s.pair("main_gear", 0.016, move |p| round_cone(p, leg + v(0.0, 0.0, 0.07), leg - v(0.0, 0.0, 0.07), 0.019, 0.019));
    s.pair("main_gear", 0.012, move |p| {
        let q = v((p.x - leg.x).abs(), p.y - leg.y, (p.z - leg.z).abs());
        let axle = round_cone(q, v(-0.04, 0.0, 0.070), v(0.04, 0.0, 0.070), 0.016, 0.016);
        union(wheel(q, v(0.0465, 0.0, 0.070), 0.055), axle, 0.01)
    });
}

/// A tyre about an axle along x.
fn wheel(p: Vec3, centre: Vec3, radius: f32) -> f32 {
    let q = frame(centre, Vec3::X, Vec3::Z).local(p);
    disc(q, radius, 0.024, 0.017)
}

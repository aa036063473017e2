//! throw-away
use glam::*;
use homunculus::{boundary::Boundary, certificate::Surface, collision::Warper, edge::EdgeSolver, voxel::*};
use std::time::Instant;
fn arg(name: &str, d: f32) -> f32 { std::env::args().find_map(|a| a.strip_prefix(&format!("{name}=")).map(|v| v.parse().expect("num"))).unwrap_or(d) }
fn main() {
    let file = std::env::args().nth(1).expect("file");
    let text = std::fs::read_to_string(&file).expect("read");
    let (mut p, mut t) = (vec![], vec![]);
    for l in text.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        if l.starts_with("v ") { p.push(DVec3::new(w[1].parse().expect("n"), w[2].parse().expect("n"), w[3].parse().expect("n"))); }
        if l.starts_with("f ") { let f: Vec<u32> = w[1..].iter().map(|s| s.split('/').next().expect("i").parse::<u32>().expect("i") - 1).collect(); for k in 1..f.len()-1 { t.push([f[0], f[k], f[k+1]]); } }
    }
    let b = Boundary::from_triangles("x", p, t);
    let t0 = Instant::now();
    let c = voxelize(&b, arg("res", 64.0) as u32).expect("voxelize");
    println!("cells {} nodes {} edges {} faces {} bodies {} in {:.3}s", c.cells.len(), c.nodes(), c.edges(), c.faces.len(), c.bodies, t0.elapsed().as_secs_f64());
    // spheres: hands and head, source units relative to bounds
    let (lo, hi) = b.positions.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let ext = hi - lo;
    let amp = arg("amp", 2.5);
    let spheres = [(DVec3::new(lo.x + 0.04 * ext.x, lo.y + 0.8 * ext.y, (lo.z + hi.z) * 0.5), 0.22 * ext.y, amp), (DVec3::new(hi.x - 0.04 * ext.x, lo.y + 0.8 * ext.y, (lo.z + hi.z) * 0.5), 0.22 * ext.y, amp), (DVec3::new((lo.x + hi.x) * 0.5, hi.y - 0.06 * ext.y, (lo.z + hi.z) * 0.5), 0.15 * ext.y, amp * 0.8)];
    let f: Vec<f32> = c.rest.iter().map(|q| {
        let s = c.grid.source_from_lattice(q.as_dvec3());
        let mut v = 0.0_f64;
        for (o, r, a) in spheres { let d = ((s - o).length() / r).min(1.0); let w = (1.0 - d * d).powi(2) ; v = v * (1.0 - w) + w * (a as f64).ln(); }
        v.exp() as f32
    }).collect();
    let t0 = Instant::now();
    let mut e = EdgeSolver::new(&c);
    println!("edge setup {:.3}s", t0.elapsed().as_secs_f64());
    let mut lin = c.rest.clone();
    let t0 = Instant::now();
    let s = e.solve(&c, &f, &mut lin);
    println!("eq1 {s:?} {:.3}s", t0.elapsed().as_secs_f64());
    let mut f2 = f.clone();
    for v in f2.iter_mut().take(300) { *v *= 1.2; }
    let t0 = Instant::now();
    let s = e.solve(&c, &f2, &mut lin.clone());
    println!("eq1 dab {s:?} {:.3}s", t0.elapsed().as_secs_f64());
    let mut skin = Surface::new(c.faces.clone(), &c.rest);
    println!("classic crossings {}", skin.crossings(&lin).len());
    let mut w = Warper::new(&c, &f);
    w.pcg = arg("pcg", 2.0) as usize;
    w.anderson = arg("and", 0.0) as usize;
    w.step_limit = arg("lim", 0.5);
    let mu = arg("mu", 0.5);
    let (steps, inner, last) = (arg("steps", 20.0) as usize, arg("inner", 4.0) as usize, arg("last", 80.0) as usize);
    let t0 = Instant::now();
    for k in 1..=steps {
        w.grow(k as f32 / steps as f32);
        let n = if k == steps { last } else { inner };
        for it in 0..n {
            let (r, m, h) = w.iterate(mu);
            if it + 1 == n || (k == steps && it % 10 == 0) { let (p50, p95, mx, d99) = quality(&c, &w); println!("λ {:.2} it {it} force {r:.5} motion {m:.4} held {h:?} contacts {} size {p50:.3} {p95:.3} {mx:.2} dist {d99:.3}  {:.2}s", k as f32 / steps as f32, w.contacts.len(), t0.elapsed().as_secs_f64()); }
        }
    }
    println!("parts local {:.2} global {:.2} contact {:.2} guard {:.2}", w.seconds[0], w.seconds[1], w.seconds[2], w.seconds[3]);
    let t0 = Instant::now();
    println!("final crossings {} {:.3}s", skin.crossings(&w.positions).len(), t0.elapsed().as_secs_f64());
    // write obj via nearest cell trilinear-ish
    if let Some(out) = std::env::args().find_map(|a| a.strip_prefix("out=").map(String::from)) {
        let mut s = String::new();
        let idx: std::collections::HashMap<[i32; 3], usize> = c.cells.iter().enumerate().map(|(i, c)| (c.to_array(), i)).collect();
        for p in &b.positions {
            let q = c.grid.lattice_from_source(*p);
            let cell = q.floor().as_ivec3();
            let Some(&k) = idx.get(&cell.to_array()) else { println!("outside {q}"); continue };
            let r = q - cell.as_dvec3();
            let mut ord = [0, 1, 2]; ord.sort_by(|&a, &b| r[b].total_cmp(&r[a]));
            let mut corner = 0; let mut pos = DVec3::ZERO; let mut lastw = 1.0;
            for a in ord { pos += w.positions[c.corners[k][corner] as usize].as_dvec3() * (lastw - r[a]); lastw = r[a]; corner |= 1 << a; }
            pos += w.positions[c.corners[k][7] as usize].as_dvec3() * lastw;
            let o = c.grid.source_from_lattice(pos);
            s += &format!("v {} {} {}\n", o.x, o.y, o.z);
        }
        for t in &b.triangles { s += &format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1); }
        std::fs::write(out, s).expect("write");
    }
}
fn quality(c: &Complex, w: &Warper) -> (f64, f64, f64, f64) {
    let mut e = vec![]; let mut d = vec![];
    for t in 0..c.elements() {
        let n = c.element(t);
        let at = n.map(|i| w.positions[i as usize]);
        let r = n.map(|i| c.rest[i as usize]);
        let m = |a: [Vec3A; 4]| Mat3A::from_cols(a[1] - a[0], a[2] - a[0], a[3] - a[0]);
        let f = m(at) * m(r).inverse();
        let s = f.determinant().cbrt() as f64;
        let q = w.importance[t / 6] as f64;
        e.push((s / q).max(q / s) - 1.0);
        let ftf = f.transpose() * f; 
        // conformal distortion sigma1/sigma3 via eigenvalues
        let (a, b) = eig(ftf); d.push((a / b).sqrt());
    }
    e.sort_by(f64::total_cmp); d.sort_by(f64::total_cmp);
    let n = e.len();
    (e[n / 2], e[n * 95 / 100], e[n - 1], d[n * 99 / 100])
}
fn eig(m: Mat3A) -> (f64, f64) {
    let m = DMat3::from_cols(m.x_axis.as_dvec3(), m.y_axis.as_dvec3(), m.z_axis.as_dvec3());
    let q = (m.x_axis.x + m.y_axis.y + m.z_axis.z) / 3.0;
    let p1 = m.y_axis.x.powi(2) + m.z_axis.x.powi(2) + m.z_axis.y.powi(2);
    let p2 = (m.x_axis.x - q).powi(2) + (m.y_axis.y - q).powi(2) + (m.z_axis.z - q).powi(2) + 2.0 * p1;
    let p = (p2 / 6.0).sqrt().max(1e-12);
    let b = (m - DMat3::IDENTITY * q) * (1.0 / p);
    let r = (b.determinant() / 2.0).clamp(-1.0, 1.0);
    let phi = r.acos() / 3.0;
    let hi = q + 2.0 * p * phi.cos();
    let lo = q + 2.0 * p * (phi + 2.0 * std::f64::consts::PI / 3.0).cos();
    (hi, lo)
}

//! The surface as a whole: which vertices coincide, how many pieces and holes there are, how large it is.

use std::collections::HashMap;

use glam::DVec3;

use super::Boundary;

/// Disjoint sets with path halving; the smallest member represents.
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    /// Each in a set of its own.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The representative of the set of `item`.
    pub fn find(&mut self, mut item: u32) -> u32 {
        while self.0[item as usize] != item {
            let parent = self.0[item as usize];
            self.0[item as usize] = self.0[parent as usize];
            item = self.0[item as usize];
        }
        item
    }

    /// Makes one set of two.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        let (low, high) = (a.min(b), a.max(b));
        self.0[high as usize] = low;
    }
}

impl Boundary {
    /// `[vertices]` the first vertex with exactly the same position (`-0.0` is `0.0`).
    pub fn welded(&self) -> Vec<u32> {
        let mut first = HashMap::with_capacity(self.positions.len());
        let key = |p: &DVec3| (*p + DVec3::ZERO).to_array().map(f64::to_bits);
        self.positions.iter().enumerate().map(|(i, p)| *first.entry(key(p)).or_insert(i as u32)).collect()
    }

    /// How many pieces the triangles form that share no vertex of `welded`.
    pub fn components(&self, welded: &[u32]) -> usize {
        let mut sets = Sets::new(self.positions.len());
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| welded[v as usize]);
            sets.join(a, b);
            sets.join(a, c);
        }
        let mut roots: Vec<u32> = self.triangles.iter().map(|t| sets.find(welded[t[0] as usize])).collect();
        roots.sort_unstable();
        roots.dedup();
        roots.len()
    }

    /// How many holes and rims there are: connected chains of edges which exactly one triangle uses.
    ///
    /// Triangles with two welded corners alike are left out: they have no inside that an edge could bound.
    pub fn boundary_loops(&self, welded: &[u32]) -> usize {
        let mut uses: HashMap<[u32; 2], u32> = HashMap::new();
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| welded[v as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *uses.entry([from.min(to), from.max(to)]).or_default() += 1;
            }
        }
        let mut sets = Sets::new(self.positions.len());
        let mut on_rim: Vec<u32> = Vec::new();
        for (&[a, b], _) in uses.iter().filter(|&(_, &count)| count == 1) {
            sets.join(a, b);
            on_rim.push(a);
        }
        let mut roots: Vec<u32> = on_rim.into_iter().map(|v| sets.find(v)).collect();
        roots.sort_unstable();
        roots.dedup();
        roots.len()
    }

    /// Lowest and highest corner of the box around all vertices, source units; `None` without vertices.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p))))
    }
}

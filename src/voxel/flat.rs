//! Pixels become cells: the domain of a picture.
//!
//! A cell is inside where it has a common area with a pixel that is (3.2). What is asked of a cell is the mean of its
//! pixels' areas, and each cell knows which part of it lies in which region, so that areas come out right although cells
//! are larger than pixels.
//!
//! Source units are pixels with y upwards: the lower left corner of the picture is the origin.

use glam::{DVec2, DVec3, UVec2, UVec3};
use rayon::prelude::*;

use super::{Complex, Grid};
use crate::{Error, Result, boundary::Regions};

/// A picture as the method sees it: which pixels belong to it, and what they ask for.
#[derive(Debug, Clone, Default)]
pub struct Flat {
    /// What to call it.
    pub name: String,
    /// Pixels, x to the right, y downwards.
    pub size: UVec2,
    /// `[pixels]`, row by row from the top: whether the pixel belongs to the domain.
    pub inside: Vec<bool>,
    /// `[pixels]` importance, > 0.
    pub importance: Vec<f32>,
    /// Regions, `of_vertex` by pixel.
    pub regions: Option<Regions>,
}

/// What a region has of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Index of the region; `u32::MAX` for pixels of none.
    pub region: u32,
    /// Area in pixels.
    pub area: f32,
    /// Asked area: the integral of f² over it, in pixels.
    pub asked: f32,
}

/// `[cells]` shares of regions, in compressed rows.
#[derive(Debug, Clone, Default)]
pub struct Shares {
    start: Vec<u32>,
    list: Vec<Share>,
}

impl Shares {
    /// Shares of a cell, by rising region.
    pub fn of(&self, cell: usize) -> &[Share] {
        &self.list[self.start[cell] as usize..self.start[cell + 1] as usize]
    }

    /// `[cells]` the size asked for if region r's share counts `factors[r]` times (others once): the root of the mean of
    /// f².
    pub fn sizes(&self, factors: &[f32]) -> Vec<f32> {
        (0..self.start.len() - 1)
            .map(|cell| {
                let (mut area, mut asked) = (0.0_f64, 0.0_f64);
                for share in self.of(cell) {
                    let factor = factors.get(share.region as usize).copied().unwrap_or(1.0);
                    area += f64::from(share.area);
                    asked += f64::from(share.asked * factor);
                }
                (asked / area).sqrt() as f32
            })
            .collect()
    }

    /// `[cells]` the region with most of each cell, `u32::MAX` for none.
    pub fn regions(&self) -> Vec<u32> {
        let largest = |shares: &[Share]| {
            shares.iter().max_by(|a, b| a.area.total_cmp(&b.area)).map_or(u32::MAX, |share| share.region)
        };
        (0..self.start.len() - 1).map(|cell| largest(self.of(cell))).collect()
    }
}

impl Flat {
    /// Whether it is a map: regions take more than half of it, and what they ask for is area.
    pub fn is_map(&self) -> bool {
        let Some(regions) = &self.regions else { return false };
        let inside = || self.inside.iter().zip(&regions.of_vertex).filter(|(inside, _)| **inside);
        2 * inside().filter(|(_, region)| **region != u32::MAX).count() > inside().count()
    }

    /// Corners of the box around the inside pixels, y downwards.
    fn bounds(&self) -> Option<(UVec2, UVec2)> {
        let (mut low, mut high) = (UVec2::MAX, UVec2::ZERO);
        for (k, _) in self.inside.iter().enumerate().filter(|(_, inside)| **inside) {
            let p = UVec2::new(k as u32 % self.size.x, k as u32 / self.size.x);
            low = low.min(p);
            high = high.max(p + 1);
        }
        (low.x < high.x).then_some((low, high))
    }

    /// The grid of `resolution` ≥ 1 cells along the longest side of the inside pixels' box, centred on it.
    ///
    /// # Errors
    /// A picture without an inside pixel.
    pub fn grid(&self, resolution: u32) -> Result<Grid> {
        let Some((low, high)) = self.bounds() else {
            return Err(Error::input(format!("{}: no pixel of the picture belongs to the domain", self.name)));
        };
        let extent = (high - low).as_dvec2();
        let cell_size = extent.max_element() / f64::from(resolution);
        // A side that is a whole number of cells long must not get another one by rounding.
        let cells = (extent / cell_size - 1.0e-9).ceil().max(DVec2::ONE);
        let middle = (low + high).as_dvec2() * 0.5;
        let middle = DVec2::new(middle.x, f64::from(self.size.y) - middle.y);
        let origin = middle - cells * (0.5 * cell_size);
        Ok(Grid { origin: origin.extend(0.0), cell_size, cells: cells.as_uvec2().extend(1) })
    }

    /// The cells that inside pixels touch, with what is asked of each.
    ///
    /// # Errors
    /// As [`grid`](Self::grid).
    pub fn voxelize(&self, resolution: u32) -> Result<(Complex, Shares)> {
        let complex = self.lattice(resolution)?;
        let shares = self.shares(&complex);
        Ok((complex, shares))
    }

    /// The cells that inside pixels touch.
    ///
    /// # Errors
    /// As [`grid`](Self::grid).
    pub fn lattice(&self, resolution: u32) -> Result<Complex> {
        let grid = self.grid(resolution)?;
        let UVec3 { x: columns, y: rows, .. } = grid.cells;
        let is_inside = |cell: u32| {
            let mut is_touched = false;
            self.overlaps(&grid, cell % columns, cell / columns, |_, _| is_touched = true);
            is_touched
        };
        let inside: Vec<bool> = (0..columns * rows).into_par_iter().map(is_inside).collect();
        Ok(Complex::from_flat_cells(grid, &inside))
    }

    /// What regions have of the cells of this picture's lattice, and what is asked of each.
    pub fn shares(&self, complex: &Complex) -> Shares {
        let of_cell: Vec<Vec<Share>> =
            complex.cells.par_iter().map(|cell| self.shares_of(&complex.grid, cell.x as u32, cell.y as u32)).collect();
        let mut shares = Shares { start: vec![0], list: Vec::new() };
        for of_cell in of_cell {
            shares.list.extend(of_cell);
            shares.start.push(shares.list.len() as u32);
        }
        shares
    }

    /// What each region has of a cell; nothing where no inside pixel touches it.
    fn shares_of(&self, grid: &Grid, column: u32, row: u32) -> Vec<Share> {
        let mut shares: Vec<Share> = Vec::new();
        self.overlaps(grid, column, row, |pixel, area| {
            let region = self.regions.as_ref().map_or(u32::MAX, |r| r.of_vertex[pixel]);
            let (area, f) = (area as f32, self.importance[pixel]);
            let share = Share { region, area, asked: area * f * f };
            match shares.iter_mut().find(|s| s.region == region) {
                Some(sum) => {
                    sum.area += share.area;
                    sum.asked += share.asked;
                }
                None => shares.push(share),
            }
        });
        shares.sort_unstable_by_key(|share| share.region);
        shares
    }

    /// Gives each inside pixel that has an area in common with a cell, and that area.
    fn overlaps(&self, grid: &Grid, column: u32, row: u32, mut give: impl FnMut(usize, f64)) {
        let corner = |dx: u32, dy: u32| {
            grid.source_from_lattice(DVec3::new(f64::from(column + dx), f64::from(row + dy), 0.0)).truncate()
        };
        let (low, high) = (corner(0, 0), corner(1, 1));
        // A picture's rows go downwards.
        let (top, bottom) = (f64::from(self.size.y) - high.y, f64::from(self.size.y) - low.y);
        // Overlaps thinner than rounding are none.
        let sliver = 1.0e-6 * grid.cell_size.min(1.0);
        let overlaps = |from: f64, to: f64, most: u32| {
            let first = from.floor().max(0.0) as u32;
            (first..most.min(to.ceil().max(0.0) as u32)).filter_map(move |k| {
                let overlap = to.min(f64::from(k + 1)) - from.max(f64::from(k));
                (overlap > sliver).then_some((k, overlap))
            })
        };
        for (y, height) in overlaps(top, bottom, self.size.y) {
            for (x, width) in overlaps(low.x, high.x, self.size.x) {
                let pixel = (y * self.size.x + x) as usize;
                if self.inside[pixel] {
                    give(pixel, width * height);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(rows: [&str; 3]) -> Flat {
        let text: Vec<char> = rows.iter().flat_map(|row| row.chars()).collect();
        Flat {
            name: "test".into(),
            size: UVec2::new(4, 3),
            inside: text.iter().map(|&c| c != '.').collect(),
            importance: text.iter().map(|&c| if c == 'b' { 2.0 } else { 1.0 }).collect(),
            regions: Some(Regions {
                names: vec!["a".into(), "b".into()],
                of_vertex: text
                    .iter()
                    .map(|&c| ['a', 'b'].iter().position(|&r| r == c).map_or(u32::MAX, |r| r as u32))
                    .collect(),
            }),
        }
    }

    #[test]
    fn a_cell_is_inside_where_a_pixel_of_it_is() {
        let flat = picture(["aa..", "aab.", "...."]);
        // The box is three pixels wide and two high: cells are as large as pixels.
        let (complex, shares) = flat.voxelize(3).expect("a domain");
        assert_eq!((complex.cells.len(), complex.grid.cell_size), (5, 1.0));
        assert_eq!(complex.grid.origin, DVec3::new(0.0, 1.0, 0.0));
        let asked: f64 = (0..5).flat_map(|c| shares.of(c).to_vec()).map(|s| f64::from(s.asked)).sum();
        assert_eq!(asked, 4.0 + 4.0);
        // One cell of all: its size is the root of the mean area.
        let (complex, shares) = picture(["abab", "....", "...."]).voxelize(1).expect("a domain");
        assert_eq!(complex.cells.len(), 1);
        assert_eq!(shares.sizes(&[]), [2.5_f32.sqrt()]);
        assert_eq!(shares.sizes(&[1.0, 0.25]), [1.0]);
    }

    #[test]
    fn nothing_inside_is_refused() {
        assert!(picture(["....", "....", "...."]).voxelize(8).is_err());
    }
}

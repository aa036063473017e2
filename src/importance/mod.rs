//! 3.2  **F**, the importance: the linear size factor asked for, > 0, 1 = keep.

/// A point on the boundary's surface where importance is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Index into [`Boundary::triangles`](crate::boundary::Boundary::triangles).
    pub triangle: u32,
    /// Barycentric weights of the triangle's three corners, each in 0..=1, summing to 1.
    pub weights: [f32; 3],
}

//! A mesh as stored in a page.

/// A mesh as text: vertices in whole steps from a corner, and three indices for each triangle. Both are little-endian numbers in base 64.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corner with the least coordinates, metres.
    pub least: [f32; 3],
    /// The step, metres.
    pub step: f32,
    /// x, y and z of each vertex, 16 bits each.
    pub places: String,
    /// Indices of vertices, 16 bits each, or 32 if `wide`.
    pub corners: String,
    /// True if indices have 32 bits.
    pub wide: bool,
    /// Number of triangles.
    pub triangles: usize,
}

//! A mesh as a page has it.

/// A mesh as text: places in whole steps from a corner, and three of them for each triangle. Both are little-endian numbers in base 64.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corner, metres.
    pub least: [f32; 3],
    /// The step, metres.
    pub step: f32,
    /// x, y and z of each place, 16 bits each.
    pub places: String,
    /// Indices of places, 16 bits each, or 32 if `wide`.
    pub corners: String,
    /// Whether indices have 32 bits.
    pub wide: bool,
    /// Number of triangles.
    pub triangles: usize,
}

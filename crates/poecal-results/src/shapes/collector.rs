//! Triangles from the readers of meshes.

/// Most triangles of all meshes.
pub(crate) const MOST_TRIANGLES: usize = 3_000_000;
/// Largest coordinate, metres.
const FAR: f64 = 1e4;

/// Vertices of triangles, metres.
pub(crate) type Triangles = Vec<[[f32; 3]; 3]>;

/// Reason why a mesh cannot be drawn, in words that follow "not drawn: ".
pub(crate) type MeshReason = String;

/// Collects triangles up to a number, scaled.
pub(crate) struct Collector {
    scale: [f64; 3],
    most: usize,
    found: Triangles,
}

impl Collector {
    pub(crate) fn new(scale: [f64; 3], most: usize) -> Self {
        Collector { scale, most, found: Vec::new() }
    }

    /// Adds a triangle. One with a vertex that is no position is left out.
    pub(crate) fn add(&mut self, corners: [[f64; 3]; 3]) -> Result<(), MeshReason> {
        if self.found.len() >= self.most {
            return Err(format!("with the others it has more than {MOST_TRIANGLES} triangles"));
        }
        let scaled = corners.map(|corner| [0, 1, 2].map(|k| corner[k] * self.scale[k]));
        if scaled.iter().flatten().all(|value| value.abs() <= FAR) {
            self.found.push(scaled.map(|corner| corner.map(|value| value as f32)));
        }
        Ok(())
    }

    /// Adds a polygon as triangles about its first vertex.
    pub(crate) fn fan(&mut self, corners: &[[f64; 3]]) -> Result<(), MeshReason> {
        for pair in corners.get(1..).unwrap_or_default().windows(2) {
            if let (Some(&first), &[second, third]) = (corners.first(), pair) {
                self.add([first, second, third])?;
            }
        }
        Ok(())
    }

    /// The triangles; an error if there are none.
    pub(crate) fn into_triangles(self) -> Result<Triangles, MeshReason> {
        if self.found.is_empty() { Err("found no triangles in it".to_owned()) } else { Ok(self.found) }
    }
}

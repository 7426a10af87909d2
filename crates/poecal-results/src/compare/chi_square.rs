//! Test of a change against noise.

/// A χ² of a change against its covariance, and the largest that noise exceeds in one of a hundred cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquare {
    /// `dᵀ C⁻¹ d`.
    pub value: f64,
    /// Rank of C.
    pub freedom: usize,
    /// Value that noise exceeds with a probability of 1 % (of all joints together).
    pub limit: f64,
}

impl ChiSquare {
    /// True if it is more than noise.
    #[must_use]
    pub fn is_change(&self) -> bool {
        self.value > self.limit
    }
}

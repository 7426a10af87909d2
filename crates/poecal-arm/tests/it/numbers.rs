//! Random numbers with the same bits everywhere.

use nalgebra::Vector3;

/// Sums and shifts of splitmix64.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    /// A number in [-1, 1).
    pub(crate) fn next_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.next_number(), self.next_number(), self.next_number())
    }

    #[allow(dead_code, reason = "the benchmark has no use for it")]
    pub(crate) fn six_numbers(&mut self, size: f64) -> [f64; 6] {
        [0; 6].map(|_| size * self.next_number())
    }
}

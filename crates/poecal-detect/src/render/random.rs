//! Random numbers from a seed.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// Random numbers that a seed determines.
#[derive(Clone, Debug)]
pub struct RandomGenerator {
    generator: ChaCha8Rng,
}

impl RandomGenerator {
    /// Generator of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        RandomGenerator { generator: ChaCha8Rng::seed_from_u64(seed) }
    }

    /// A number between two others.
    pub fn draw_uniform(&mut self, from: f64, to: f64) -> f64 {
        let part = (self.generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        from + (to - from) * part
    }

    /// An integer below another.
    pub fn draw_below(&mut self, limit: usize) -> usize {
        (self.draw_uniform(0.0, limit as f64) as usize).min(limit.saturating_sub(1))
    }

    /// A nearly normal number of variance one: the sum of eight numbers, which is fast and ends at 4.9.
    pub fn rough_normal(&mut self) -> f64 {
        let parts = |bits: u64| (bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48);
        let sum = parts(self.generator.next_u64()) + parts(self.generator.next_u64());
        (sum as f64 / 65535.0 - 4.0) * (12.0_f64 / 8.0).sqrt()
    }
}

//! Pseudo-random numbers that are the same in every run.

use nalgebra::Vector3;

/// A linear congruential generator of 64 bits.
pub(crate) struct LinearCongruential(u64);

impl LinearCongruential {
    pub(crate) fn new(seed: u64) -> Self {
        LinearCongruential(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1))
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 11
    }

    /// A uniform number between 0 and 1.
    pub(crate) fn uniform_number(&mut self) -> f64 {
        (self.next() as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// A number of the standard normal distribution (Box-Muller transform).
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform_number().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform_number()).cos()
    }

    /// Three independent numbers of this standard deviation.
    #[cfg(test)]
    pub(crate) fn vector(&mut self, sigma: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| sigma * self.normal())
    }

    /// A few different numbers below a count.
    pub(crate) fn distinct_numbers(&mut self, few: usize, count: usize) -> Vec<usize> {
        let mut found = Vec::with_capacity(few);
        while found.len() < few.min(count) {
            let next = (self.next() % count.max(1) as u64) as usize;
            if !found.contains(&next) {
                found.push(next);
            }
        }
        found
    }
}

/// Errors of a pose, with these standard deviations, about axes.
pub(crate) fn draw_errors(draw: &mut LinearCongruential, sigmas: &[f64; 6]) -> (Vector3<f64>, Vector3<f64>) {
    let numbers = sigmas.map(|sigma| sigma * draw.normal());
    (Vector3::new(numbers[0], numbers[1], numbers[2]), Vector3::new(numbers[3], numbers[4], numbers[5]))
}

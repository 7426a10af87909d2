//! Random numbers whose values stay the same between versions: a ChaCha8 stream and a few lines on top.

use nalgebra::{Matrix3, Vector3, Vector4};
use rand_core::Rng;

use poecal_arm::lie::rotation;

/// Uniform in [0, 1), 53 bits.
pub fn uniform_number(generator: &mut impl Rng) -> f64 {
    (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// Normal with mean 0 and variance 1 (Box-Muller; the second value is not kept, so that the stream is easy to follow).
pub fn normal(generator: &mut impl Rng) -> f64 {
    let radius = (-2.0 * (1.0 - uniform_number(generator)).ln()).sqrt();
    radius * (std::f64::consts::TAU * uniform_number(generator)).cos()
}

/// Three independent normal components.
pub fn normal_vector(generator: &mut impl Rng) -> Vector3<f64> {
    Vector3::new(normal(generator), normal(generator), normal(generator))
}

/// A uniformly distributed unit vector.
pub fn direction(generator: &mut impl Rng) -> Vector3<f64> {
    loop {
        let vector = normal_vector(generator);
        let length = vector.norm();
        if length > 1e-6 {
            return vector / length;
        }
    }
}

/// A uniformly distributed rotation.
pub fn rotation(generator: &mut impl Rng) -> Matrix3<f64> {
    let q = Vector4::new(normal(generator), normal(generator), normal(generator), normal(generator));
    rotation::from_quaternion_xyzw(&q)
}

/// Puts a slice in random order (Fisher-Yates).
pub fn shuffle<T>(generator: &mut impl Rng, items: &mut [T]) {
    for i in (1..items.len()).rev() {
        let j = (uniform_number(generator) * (i + 1) as f64) as usize;
        items.swap(i, j);
    }
}

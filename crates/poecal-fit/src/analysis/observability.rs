//! Observability indices of a set of configurations.

use serde::{Deserialize, Serialize};

/// Indices O1 to O5 of sun2008 over the singular values `s₁ ≥ … ≥ sₙ` of the whitened Jacobian of the scaled minimal unknowns:
/// theory.md §7 (36b). Larger is better. `None` where a singular value is zero but for rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Observability {
    /// `(s₁ s₂ … sₙ)^(1/n) / √m`, 1/m (metre): the geometric mean of the singular values, by the number m of configurations.
    pub o1: Option<f64>,
    /// `sₙ / s₁`: the inverse of the condition number.
    pub o2: Option<f64>,
    /// `sₙ`, 1/m (metre): the inverse of the largest standard deviation.
    pub o3: Option<f64>,
    /// `sₙ² / s₁`, 1/m (metre): the noise amplification index.
    pub o4: Option<f64>,
    /// `1 / Σ 1/sₖ`, 1/m (metre).
    pub o5: Option<f64>,
}

impl Observability {
    /// Indices of singular values, largest first, from `count` configurations: theory.md §7 (36b). All are `None` if a value is not above
    /// zero.
    #[must_use]
    pub fn new(singular_values: &[f64], count: usize) -> Self {
        let (Some(&most), Some(&least)) = (singular_values.first(), singular_values.last()) else {
            return Observability::default();
        };
        if count == 0 || singular_values.iter().any(|&value| value.is_nan() || value <= 0.0) {
            return Observability::default();
        }
        let n = singular_values.len() as f64;
        let mean_logarithm = singular_values.iter().map(|value| value.ln()).sum::<f64>() / n;
        Observability {
            o1: Some(mean_logarithm.exp() / (count as f64).sqrt()),
            o2: Some(least / most),
            o3: Some(least),
            o4: Some(least * least / most),
            o5: Some(1.0 / singular_values.iter().map(|value| 1.0 / value).sum::<f64>()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Observability;

    #[test]
    fn indices_are_means_and_ratios_of_singular_values() {
        let found = Observability::new(&[8.0, 4.0, 2.0], 4);
        assert_eq!((found.o1, found.o2, found.o3), (Some(2.0), Some(0.25), Some(2.0)));
        assert_eq!((found.o4, found.o5), (Some(0.5), Some(1.0 / 0.875)));
        assert_eq!(Observability::new(&[8.0, 0.0], 4), Observability::default());
    }
}

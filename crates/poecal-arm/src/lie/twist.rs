//! Twists: elements of se(3).

use nalgebra::{Matrix6, Vector3, Vector6};

use super::{hat, series};

/// An infinitesimal motion of a target about its own origin, in the device's axes: `v` moves the origin (metres), `w` turns the
/// target (radians). With the target's position `p` it is `(v_s + ω_s × p; ω_s)` of the spatial twist `(v_s; ω_s)`: the factor
/// `[I -p̂]` of lou2009 (23) is already applied (theory.md §4 (14)).
///
/// ```
/// use nalgebra::Vector3;
/// let lifted: poecal_arm::lie::TargetTwist = (Vector3::z() * 1e-3, Vector3::zeros());
/// assert_eq!(lifted.1.norm(), 0.0);
/// ```
pub type TargetTwist = (Vector3<f64>, Vector3<f64>);

/// A twist `ξ = (v; ω)`: linear part `v` (metres), angular part `ω` (radians), in the frame that the name or the text states
/// (theory.md §1 (1)).
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::lie::Twist;
/// let a = Twist::new(Vector3::new(0.1, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
/// let b = Twist::new(Vector3::new(0.0, 2.0, 0.0), Vector3::new(1.0, 0.0, 0.0));
/// // [a, b] = ad_a b = -[b, a]
/// assert!((a.bracket(&b).to_vector() + b.bracket(&a).to_vector()).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    /// Linear part, metres.
    pub v: Vector3<f64>,
    /// Angular part, radians.
    pub w: Vector3<f64>,
}

impl Twist {
    /// The twist `(v; w)`.
    #[must_use]
    pub fn new(v: Vector3<f64>, w: Vector3<f64>) -> Self {
        Twist { v, w }
    }

    /// The zero twist.
    #[must_use]
    pub fn zero() -> Self {
        Twist::new(Vector3::zeros(), Vector3::zeros())
    }

    /// The six numbers `[v; ω]`, linear part first.
    #[must_use]
    pub fn to_vector(&self) -> Vector6<f64> {
        Vector6::new(self.v.x, self.v.y, self.v.z, self.w.x, self.w.y, self.w.z)
    }

    /// The twist of six numbers `[v; ω]`, linear part first.
    #[must_use]
    pub fn from_vector(vector: &Vector6<f64>) -> Self {
        Twist::new(Vector3::new(vector[0], vector[1], vector[2]), Vector3::new(vector[3], vector[4], vector[5]))
    }

    /// `ad_ξ = [[ω̂, v̂], [0, ω̂]]` acting on `[v; ω]`: theory.md §1 (2).
    #[must_use]
    pub fn adjoint_matrix(&self) -> Matrix6<f64> {
        let mut ad = Matrix6::zeros();
        ad.fixed_view_mut::<3, 3>(0, 0).copy_from(&hat(&self.w));
        ad.fixed_view_mut::<3, 3>(0, 3).copy_from(&hat(&self.v));
        ad.fixed_view_mut::<3, 3>(3, 3).copy_from(&hat(&self.w));
        ad
    }

    /// The Lie bracket `[self, other] = ad_self other`: theory.md §1 (2).
    #[must_use]
    pub fn bracket(&self, other: &Twist) -> Twist {
        Twist::new(self.w.cross(&other.v) + self.v.cross(&other.w), self.w.cross(&other.w))
    }

    /// The left Jacobian `J_l(ξ) = ∫₀¹ Ad(exp(ξ s)) ds`, the integral of lou2009 (5) and (18) in closed form, theory.md §1 (3) and (4):
    /// `I + a ad + b ad² + c ad³ + d ad⁴` with coefficients of the angle alone (park1994).
    #[must_use]
    pub fn left_jacobian(&self) -> Matrix6<f64> {
        let angle_squared = self.w.norm_squared();
        let (cosc, sincc) = (series::cosc(angle_squared), series::sincc(angle_squared));
        let ad = self.adjoint_matrix();
        let ad2 = ad * ad;
        // On se(3) ad satisfies ad⁵ = -2θ² ad³ - θ⁴ ad; matching Σ adᵏ/(k+1)! determines the four coefficients.
        let (c, d) = series::left_jacobian(angle_squared);
        let a = cosc + angle_squared * c;
        let b = sincc + angle_squared * d;
        Matrix6::identity() + ad * a + ad2 * b + ad2 * ad * c + ad2 * ad2 * d
    }

    /// `J_l(ξ)⁻¹ = I - ad/2 + b ad² + d ad⁴` for `|ω| < 2π`, with coefficients of the angle alone (theory.md §1 (4a)).
    #[must_use]
    pub fn inverse_left_jacobian(&self) -> Matrix6<f64> {
        let ad = self.adjoint_matrix();
        let ad2 = ad * ad;
        let (b, d) = series::inverse_left_jacobian(self.w.norm_squared());
        Matrix6::identity() - ad * 0.5 + ad2 * b + ad2 * ad2 * d
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_left_jacobian_is_the_inverse() {
        for scale in [0.0, 1e-8, 0.05, 0.099, 0.101, 0.2, 1.0, 3.1] {
            let twist =
                Twist::new(Vector3::new(0.3, -0.2, 0.5) * (scale + 0.1), Vector3::new(0.6, -0.48, 0.64) * scale);
            let product = twist.left_jacobian() * twist.inverse_left_jacobian();
            let error = (product - Matrix6::identity()).norm();
            println!("scale {scale}: {error:.1e}");
            assert!(error < 1e-13, "{error}");
        }
    }

    #[test]
    fn left_jacobian_is_the_integral_of_the_adjoint() {
        for scale in [0.0, 1e-8, 0.099, 0.101, 1.0, 3.1] {
            let direction = Twist::new(Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.6, -0.48, 0.64));
            let twist = Twist::new(direction.v * scale, direction.w * scale);
            // Gauss-Legendre with 5 points on 16 panels: exact to rounding for angles up to π.
            let nodes = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
            let weights = [0.568_888_888_888_888_9, 0.478_628_670_499_366_47, 0.236_926_885_056_189_08];
            let mut integral = Matrix6::zeros();
            for panel in 0..16 {
                for (k, &node) in nodes.iter().enumerate() {
                    for sign in if k == 0 { &[1.0][..] } else { &[-1.0, 1.0][..] } {
                        let s = (f64::from(panel) + 0.5 + 0.5 * sign * node) / 16.0;
                        let pose = crate::lie::Pose::exp(&Twist::new(twist.v * s, twist.w * s));
                        integral += pose.adjoint() * (weights[k] / 32.0);
                    }
                }
            }
            let error = (twist.left_jacobian() - integral).norm();
            println!("scale {scale}: {error:.1e}");
            assert!(error < 1e-13, "{error}");
        }
    }
}

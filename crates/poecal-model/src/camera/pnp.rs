//! Pose of known points from their rays, without an initial guess.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use poecal_arm::lie::{Pose, hat, rotation};

type Matrix9 = SMatrix<f64, 9, 9>;
type Vector9 = SVector<f64, 9>;

/// Largest number of steps from a start.
const STEPS: usize = 60;
/// Two rotations that differ by less are one, rad.
const SAME: f64 = 1e-3;
/// Largest number of poses.
const MOST: usize = 4;

/// Poses of a body in the frame of the rays, the best first. They are the local minima over the rotations of `Σ |(I - f fᵀ)(R P + t)|²`, the
/// squared distances of the points from their rays, with the best t of each R and all points in front. A plane may have two, three points
/// four (theory.md §4, *Pictures*; terzakis2020). At least three points are needed.
#[must_use]
pub fn poses_of_rays(seen: &[(Vector3<f64>, Vector3<f64>)]) -> Vec<Pose> {
    let Some(quadric) = Quadric::new(seen) else { return Vec::new() };
    let mut found: Vec<(f64, Matrix3<f64>)> = Vec::new();
    for start in turns_of_a_cube() {
        let Some((cost, turn)) = quadric.find_minimum(start, &found) else { continue };
        if !found.iter().any(|(_, known)| rotation::log(&(known * turn.transpose())).norm() < SAME) {
            found.push((cost, turn));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let pose = |(_, turn): &(f64, Matrix3<f64>)| Pose::new(*turn, quadric.translation(turn));
    let in_front = |pose: &Pose| seen.iter().all(|(point, ray)| pose.act(point).dot(ray) > 0.0);
    found.iter().map(pose).filter(in_front).take(MOST).collect()
}

/// The squared distances as a quadratic form of the nine numbers of a rotation, row by row, and the translation as a linear one.
struct Quadric {
    form: Matrix9,
    translation: SMatrix<f64, 3, 9>,
}

impl Quadric {
    fn new(seen: &[(Vector3<f64>, Vector3<f64>)]) -> Option<Self> {
        if seen.len() < 3 {
            return None;
        }
        let mut across_all = Matrix3::zeros();
        let mut turned = SMatrix::<f64, 3, 9>::zeros();
        let across = |ray: &Vector3<f64>| Matrix3::identity() - ray * ray.transpose();
        for (point, ray) in seen {
            across_all += across(ray);
            turned += across(ray) * rows_of(point);
        }
        let translation = -(inverse(&across_all)? * turned);
        let mut form = Matrix9::zeros();
        for (point, ray) in seen {
            let whole = rows_of(point) + translation;
            form += whole.transpose() * across(ray) * whole;
        }
        Some(Quadric { form, translation })
    }

    fn translation(&self, turn: &Matrix3<f64>) -> Vector3<f64> {
        self.translation * numbers(turn)
    }

    fn cost(&self, turn: &Matrix3<f64>) -> f64 {
        let r = numbers(turn);
        (r.transpose() * self.form * r)[0].max(0.0)
    }

    /// Minimum that is reached from a start, by Levenberg-Marquardt on the rotation; `None` if it nears one that is known.
    fn find_minimum(&self, start: Matrix3<f64>, known: &[(f64, Matrix3<f64>)]) -> Option<(f64, Matrix3<f64>)> {
        let (mut turn, mut cost, mut damping) = (start, self.cost(&start), 1e-3);
        let scale = self.form.trace() / 9.0;
        for _ in 0..STEPS {
            let r = numbers(&turn);
            let slopes =
                SMatrix::<f64, 9, 3>::from_columns(&[0, 1, 2].map(|k| numbers(&(hat(&Vector3::ith(k, 1.0)) * turn))));
            let gradient = slopes.transpose() * self.form * r;
            // The second derivative of the rotation is included: with it the minimum is a minimum, and not a saddle.
            let mut curvature: Matrix3<f64> = slopes.transpose() * self.form * slopes;
            let pull = self.form * r;
            for i in 0..3 {
                for j in 0..3 {
                    let [a, b] = [i, j].map(|k| hat(&Vector3::ith(k, 1.0)));
                    curvature[(i, j)] += 0.5 * pull.dot(&numbers(&((a * b + b * a) * turn)));
                }
            }
            let step = loop {
                let damped = curvature + Matrix3::identity() * (damping * scale);
                if let Some(inverse) = inverse(&damped) {
                    break -(inverse * gradient);
                }
                damping = (damping * 10.0).max(1e-6);
                if damping > 1e9 {
                    return None;
                }
            };
            let next = rotation::exp(&step) * turn;
            let new = self.cost(&next);
            if new <= cost {
                (turn, cost, damping) = (next, new, damping * 0.1);
                if step.norm() < 1e-10 {
                    break;
                }
                let is_known =
                    |(_, known): &(f64, Matrix3<f64>)| rotation::log(&(known * turn.transpose())).norm() < SAME;
                if step.norm() < 0.1 * SAME && known.iter().any(is_known) {
                    return None;
                }
            } else if step.norm() < 1e-9 {
                break;
            } else {
                damping = (damping * 10.0).max(1e-6);
            }
        }
        Some((cost, rotation::orthonormalized(&turn)))
    }
}

/// Inverse of a symmetric matrix by its cofactors; `None` if it is not positive definite.
fn inverse(matrix: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let [a, b, c] = [0, 1, 2].map(|k| matrix.column(k).into_owned());
    let determinant = a.dot(&b.cross(&c));
    let size = matrix.trace() / 3.0;
    let minor = matrix[(0, 0)] * matrix[(1, 1)] - matrix[(0, 1)] * matrix[(1, 0)];
    let is_definite = matrix[(0, 0)] > 0.0 && minor > 0.0 && determinant > 1e-14 * size * size * size;
    is_definite.then(|| Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)]).transpose() / determinant)
}

/// `R P` as a linear function of the rows of R.
fn rows_of(point: &Vector3<f64>) -> SMatrix<f64, 3, 9> {
    let mut rows = SMatrix::zeros();
    for k in 0..3 {
        for l in 0..3 {
            rows[(k, 3 * k + l)] = point[l];
        }
    }
    rows
}

fn numbers(turn: &Matrix3<f64>) -> Vector9 {
    Vector9::from_fn(|k, _| turn[(k / 3, k % 3)])
}

/// The 24 rotations of a cube.
fn turns_of_a_cube() -> Vec<Matrix3<f64>> {
    let mut found = Vec::with_capacity(24);
    for x in 0..3 {
        for y in (0..3).filter(|y| *y != x) {
            for signs in 0..4 {
                let sign = |bit: i32| if signs & bit == 0 { 1.0 } else { -1.0 };
                let (a, b) = (Vector3::ith(x, sign(1)), Vector3::ith(y, sign(2)));
                found.push(Matrix3::from_columns(&[a, b, a.cross(&b)]));
            }
        }
    }
    found
}

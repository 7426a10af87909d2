//! Sums of a bundle over the corners of one picture.

use nalgebra::{Matrix6, Vector3, Vector6};

use crate::state::RowChain;
use poecal_arm::lie::Pose;
use poecal_model::camera::{Board, Centre, CommonError, LENS_NUMBERS, Picture, motion_by_inverse};
use poecal_numerics::kernels::{CornerProducts, Corners, LaneBlock, MOTIONS, WIDTH};
use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;

/// Motions, numbers of the lens, and the residual.
pub(crate) const MOST_COLUMNS: usize = MOTIONS + LENS_NUMBERS + 1;

/// Motion of a point of a board by the numbers of its board: index and direction for each number that moves it.
pub(crate) type PointMotions = Vec<(usize, Vector3<f64>)>;

/// Buffers of one thread.
pub(crate) struct BundleScratch {
    pub(crate) chain: RowChain,
    pub(crate) twists: Vec<(Vector3<f64>, Vector3<f64>)>,
    pub(crate) corners: Vec<Corners>,
    pub(crate) products: CornerProducts,
    /// Motions of the board in the camera's frame by the robot's unknowns, six rows.
    pub(crate) motions: Vec<f64>,
    /// The same motions weighted by the information of the corners, then the products of motions and numbers.
    pub(crate) weighed: Vec<f64>,
    /// For each camera the products of all numbers with motions, its lens and the residual, summed over its pictures.
    pub(crate) points: Vec<Vec<[f64; MOST_COLUMNS]>>,
}

impl BundleScratch {
    /// Buffers for numbers of unknowns of a robot, of all unknowns, and of cameras.
    pub(crate) fn new(robot: usize, all: usize, cameras: usize) -> Self {
        BundleScratch {
            chain: RowChain::default(),
            twists: vec![(Vector3::zeros(), Vector3::zeros()); robot],
            corners: Vec::new(),
            products: CornerProducts::default(),
            motions: vec![0.0; MOTIONS * robot],
            weighed: vec![0.0; MOTIONS * all],
            points: vec![vec![[0.0; MOST_COLUMNS]; all - robot]; cameras],
        }
    }

    /// Packs the corners of a picture side by side.
    pub(crate) fn pack(&mut self, picture: &Picture, board: &Board, sigma_px: f64) {
        self.corners.resize(picture.corners.len().div_ceil(WIDTH), Corners::NONE);
        if let Some(last) = self.corners.last_mut() {
            last.root = LaneBlock::ZERO;
        }
        for (at, corner) in picture.corners.iter().enumerate() {
            let (block, lane) = (&mut self.corners[at / WIDTH], at % WIDTH);
            block.root.0[lane] = 0.0;
            let Some(point) = board.points.get(corner.point as usize) else { continue };
            (0..3).for_each(|k| block.point[k].0[lane] = point[k]);
            (0..2).for_each(|k| block.pixel[k].0[lane] = corner.pixel[k]);
            block.root.0[lane] = corner.weight.max(0.0).sqrt() / corner.sigma_px.unwrap_or(sigma_px);
        }
    }

    /// Motions of the board in the camera's frame by the unknowns, from those of the row.
    pub(crate) fn direct(&mut self, camera_from_board: &Pose, of_camera: bool) {
        let n = self.twists.len();
        let turned = of_camera.then(|| motion_by_inverse(camera_from_board));
        for (column, (v, w)) in self.twists.iter().enumerate() {
            let mut motion = Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z);
            if let Some(turned) = &turned {
                motion = turned * motion;
            }
            (0..MOTIONS).for_each(|k| self.motions[k * n + column] = motion[k]);
        }
    }

    /// Information of the corners on the board's motions, and their gradient.
    pub(crate) fn of_motions(&self) -> (Matrix6<f64>, Vector6<f64>) {
        let products = &self.products;
        let last = products.columns() - 1;
        (Matrix6::from_fn(|a, b| products.product(a, b)), Vector6::from_fn(|a, _| products.product(a, last)))
    }
}

/// `E` of `S = EᵀE = (H + Q⁻¹)⁻¹`. Q is the covariance of the shared error of the corners, as motions of the board in the camera's frame.
pub(crate) fn shared_root(common: CommonError, camera_from_board: &Pose, information: &Matrix6<f64>) -> Matrix6<f64> {
    let [a, b] = [common.shift_m, common.turn_rad];
    let own = Matrix6::from_diagonal(&Vector6::new(a, a, a, b, b, b));
    let spread = match common.about {
        Centre::Board => own,
        Centre::Camera => motion_by_inverse(camera_from_board) * own,
    };
    let inner = Matrix6::identity() + spread.transpose() * information * spread;
    let lower = linalg::cholesky_6(inner).map(|factor| factor.l());
    let root = lower.and_then(|lower| lower.solve_lower_triangular(&spread.transpose()));
    root.unwrap_or_else(Matrix6::zeros)
}

/// Writes the products of each corner's point with the motions, and adds those with the lens and with one another.
#[inline(always)]
pub(crate) fn add_points(
    by_points: &[PointMotions],
    picture: &Picture,
    products: &CornerProducts,
    (weighed, points): (&mut [f64], &mut [[f64; MOST_COLUMNS]]),
    (sums, robot): (&mut NormalEquations, usize),
) {
    let n = sums.gradient.len();
    let (of_corner, used) = (products.of_corner(), products.columns());
    let mut own = [0.0; 3 * MOST_COLUMNS + 6];
    for (at, corner) in picture.corners.iter().enumerate() {
        let Some(columns) = by_points.get(corner.point as usize) else { continue };
        let (block, lane) = (at / WIDTH * of_corner, at % WIDTH);
        for (out, wide) in own.iter_mut().zip(&products.by_point[block..block + of_corner]) {
            *out = wide.0[lane];
        }
        let (by_x, rest) = own.split_at(used);
        let (by_y, rest) = rest.split_at(used);
        let (by_z, rest) = rest.split_at(used);
        let [xx, xy, xz, yy, yz, zz] = [rest[0], rest[1], rest[2], rest[3], rest[4], rest[5]];
        for (order, (place, by)) in columns.iter().enumerate() {
            let mut with = [0.0; MOST_COLUMNS];
            for (out, ((a, b), c)) in with.iter_mut().zip(by_x.iter().zip(by_y).zip(by_z)) {
                *out = a * by.x + b * by.y + c * by.z;
            }
            let at = robot + place;
            (0..MOTIONS).for_each(|k| weighed[k * n + at] += with[k]);
            points[*place].iter_mut().zip(&with).for_each(|(sum, value)| *sum += value);
            let turned = [
                xx * by.x + xy * by.y + xz * by.z,
                xy * by.x + yy * by.y + yz * by.z,
                xz * by.x + yz * by.y + zz * by.z,
            ];
            for (other, by_other) in &columns[order..] {
                let (first, second) = (at.min(robot + other), at.max(robot + other));
                let product = turned[0] * by_other.x + turned[1] * by_other.y + turned[2] * by_other.z;
                sums.gram[first * n + second] += product;
            }
        }
    }
}

/// Adds `Jᵀ W` to the upper triangle, and `Jᵀ p` to the gradient.
#[inline(always)]
pub(crate) fn add_products(
    (motions, robot): (&[f64], usize),
    (weighed, n): (&[f64], usize),
    pull: &Vector6<f64>,
    sums: &mut NormalEquations,
) {
    let mut rows = weighed.chunks_exact(n);
    let [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)] = std::array::from_fn(|_| rows.next()) else {
        return;
    };
    for column in 0..robot {
        let own: [f64; MOTIONS] = std::array::from_fn(|k| motions[k * robot + column]);
        sums.gradient[column] += own.iter().zip(pull.iter()).map(|(a, b)| a * b).sum::<f64>();
        let out = &mut sums.gram[column * n + column..(column + 1) * n];
        let firsts = a[column..].iter().zip(&b[column..]).zip(&c[column..]);
        let lasts = d[column..].iter().zip(&e[column..]).zip(&f[column..]);
        for ((out, ((a, b), c)), ((d, e), f)) in out.iter_mut().zip(firsts).zip(lasts) {
            *out += (own[0] * a + own[1] * b + own[2] * c) + (own[3] * d + own[4] * e + own[5] * f);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2x3, Vector2};

    use super::*;
    use poecal_arm::lie::hat;
    use poecal_model::camera::{Distortion, Lens};
    use poecal_numerics::kernels::{BrownConrady, FixedMotion, corner_products, simd_levels};

    /// The products of a picture by every level of instructions beside those of the corners one by one.
    #[test]
    fn products_are_those_of_the_corners_one_by_one() {
        let lens = Lens {
            distortion: Distortion::Brown([-0.18, 0.04, 1e-3, -7e-4, -0.01, 0.02, -0.01, 0.003]),
            ..Lens::pinhole([1510.0, 1490.0], [960.0, 610.0])
        };
        let brown = BrownConrady { numbers: lens.numbers(), unknown: 12, turn: 4.0 };
        let pose = Pose::from_xyz_rpy([-0.1, 0.05, 0.7], [0.5, -0.3, 0.2]);
        // Two blocks, of which the last is padded; one point is behind the camera.
        let count = 13;
        let mut corners = vec![Corners::NONE; 2];
        let (mut sums, mut first_point) = (vec![0.0; 19 * 19], Vec::new());
        for at in 0..count {
            let (block, lane) = (at / WIDTH, at % WIDTH);
            let z = if at == 12 { -50.0 } else { 0.0 };
            let place = Vector3::new(0.03 * (at % 4) as f64, 0.03 * (at / 4) as f64, z);
            let root = 1.0 + 0.1 * at as f64;
            let pixel = Vector2::new(900.0 + at as f64, 600.0);
            for k in 0..3 {
                corners[block].point[k].0[lane] = place[k];
            }
            (corners[block].pixel[0].0[lane], corners[block].pixel[1].0[lane]) = (pixel.x, pixel.y);
            corners[block].root.0[lane] = root;
            let arm = pose.rotation * place;
            let Some(found) = lens.projection(&(arm + pose.translation)) else { continue };
            let turn: Matrix2x3<f64> = -found.by_point * hat(&arm);
            let error = pixel - found.pixel;
            for axis in 0..2 {
                let mut columns: Vec<f64> = found.by_point.row(axis).iter().copied().collect();
                columns.extend(turn.row(axis).iter());
                columns.extend(found.by_lens[axis]);
                columns.push(error[axis]);
                for a in 0..19 {
                    for b in a..19 {
                        sums[a * 19 + b] += columns[a] * columns[b] * root * root;
                    }
                }
                if at == 0 {
                    let on_board = (found.by_point * pose.rotation).row(axis).into_owned();
                    first_point.push((columns, on_board, root * root));
                }
            }
        }
        let mut worst: f64 = 0.0;
        for level in simd_levels() {
            let mut products = CornerProducts::default();
            corner_products(level, &brown, &FixedMotion::from(&pose), &corners, true, &mut products);
            for a in 0..19 {
                for b in a..19 {
                    let size = (sums[a * 19 + a] * sums[b * 19 + b]).sqrt().max(1e-30);
                    worst = worst.max((products.product(a, b) - sums[a * 19 + b]).abs() / size);
                }
            }
            for k in 0..3 {
                for a in 0..19 {
                    let of = |(columns, on_board, weight): &(Vec<f64>, nalgebra::RowVector3<f64>, f64)| {
                        columns[a] * on_board[k] * weight
                    };
                    let one: f64 = first_point.iter().map(of).sum();
                    let size: f64 = first_point.iter().map(|it| of(it).abs()).sum::<f64>().max(1e-12);
                    worst = worst.max((products.by_point[k * 19 + a].0[0] - one).abs() / size);
                }
            }
            assert!((products.unseen - 2.2 * 2.2).abs() < 1e-12, "{level:?}: {}", products.unseen);
        }
        println!("products differ by {worst:.1e}");
        // Sums of 26 terms in another order.
        assert!(worst < 1e-13, "{worst:e}");
    }
}

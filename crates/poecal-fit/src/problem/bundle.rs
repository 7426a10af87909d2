//! Bundle adjustment of all corners of all pictures: robot, cameras and boards by Gauss-Newton's method on pixels, with the shared error of a
//! picture's corners eliminated picture by picture (theory.md §4, *Pictures* (17f)).

use nalgebra::{DVector, Matrix6, Vector6};

use super::Layout;
use super::bundle_desk::{BundleScratch, MOST_COLUMNS, PointMotions, add_points, add_products, shared_root};
use crate::parameters::Parameter;
use crate::state::{Estimate, Linkage, Session};
use poecal_arm::lie::Pose;
use poecal_model::camera::{Board, Camera, CommonError, Distortion, Picture, PictureUnknowns};
use poecal_numerics::kernels::{self as lanes, BrownConrady, FixedMotion, MOTIONS, SimdLevel};
use poecal_numerics::solve::NormalEquations;
use poecal_numerics::threads;

/// Pictures of one partial sum. Fixed, so that the result does not depend on the number of threads.
const CHUNK: usize = 128;

/// Residual, in standard deviations, of a corner that the camera cannot see.
const UNSEEN: f64 = 1e4;

/// Cameras and boards of one pass, as the kernel needs them.
struct BundleScene {
    lenses: Vec<BrownConrady>,
    boards: Vec<Board>,
}

/// A bundle of pictures, ready for a fit.
pub struct Bundle<'a> {
    session: Session<'a>,
    /// Indices of the pictures.
    pictures: Vec<usize>,
    pub(crate) layout: Layout,
    numbers: PictureUnknowns,
    /// Motions of each point of each board.
    by_points: Vec<Vec<PointMotions>>,
    /// Unknown numbers of each lens: index among all, index among those of the lens, prior.
    of_lenses: Vec<Vec<(usize, usize, f64)>>,
    common: CommonError,
    pub(crate) level: SimdLevel,
}

impl<'a> Bundle<'a> {
    /// Bundle of the pictures among some rows, with the free parameters of the robot and the unknown numbers of cameras and boards. `None` if
    /// a lens is none of Brown and Conrady's.
    #[must_use]
    pub fn new(session: Session<'a>, rows: &[u32], free: Vec<Parameter>, numbers: PictureUnknowns) -> Option<Self> {
        let pictures = &session.data.pictures;
        let is_brown = |it: &Camera| matches!(it.lens.distortion, Distortion::Brown(_));
        pictures.cameras.iter().all(is_brown).then(|| Bundle {
            pictures: rows.iter().filter_map(|row| pictures.index_of_row(*row)).collect(),
            layout: Layout::new(free, session.length_m),
            by_points: (0..pictures.boards.len()).map(|board| numbers.by_points(board)).collect(),
            of_lenses: (0..pictures.cameras.len()).map(|it| numbers.of_lens(it).collect()).collect(),
            common: pictures.common,
            level: SimdLevel::best_level(),
            session,
            numbers,
        })
    }

    /// The same bundle with another shared error of a picture's corners.
    #[must_use]
    pub fn with_common(self, common: CommonError) -> Self {
        Bundle { common, ..self }
    }

    /// Order and scale of the robot's unknowns, which come before the numbers.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Normal information of all corners and of the numbers' prior: of the robot's unknowns, then of the numbers.
    #[must_use]
    pub fn normal(&self, estimate: &Estimate, numbers: &DVector<f64>) -> NormalEquations {
        let (cameras, boards) = self.numbers.apply_step(numbers);
        let lens = |(camera, lens): (&Camera, &Vec<_>)| BrownConrady {
            numbers: camera.lens.numbers(),
            unknown: lens.len(),
            turn: camera.lens.turn(),
        };
        let scene = BundleScene { lenses: cameras.iter().zip(&self.of_lenses).map(lens).collect(), boards };
        let linkage = Linkage::new(estimate);
        let robot = self.layout.dim();
        let n = robot + numbers.len();
        let parts = threads::map_chunks(&self.pictures, CHUNK, |_, pictures| {
            let mut sums = NormalEquations::new(n);
            let mut desk = BundleScratch::new(robot, n, scene.lenses.len());
            pictures.iter().for_each(|at| self.add(*at, (&scene, &linkage), &mut desk, &mut sums));
            self.add_lens_points(&desk.points, &mut sums);
            sums
        });
        let mut total = NormalEquations::new(n);
        parts.iter().for_each(|part| total.add(part));
        for (k, value) in numbers.iter().enumerate() {
            total.gram[(robot + k) * (n + 1)] += 1.0;
            total.gradient[robot + k] -= value;
            total.cost += 0.5 * value * value;
        }
        total.residuals += numbers.len();
        total
    }
}

impl Bundle<'_> {
    /// Adds the corners of one picture.
    fn add(
        &self,
        at: usize,
        (scene, linkage): (&BundleScene, &Linkage),
        desk: &mut BundleScratch,
        sums: &mut NormalEquations,
    ) {
        let data = self.session.data;
        let picture = &data.pictures.all[at];
        let row = picture.row as usize;
        let observation = &data.observations[row];
        let lens = scene.lenses.get(picture.camera);
        let Some((lens, board)) = lens.zip(scene.boards.get(picture.board)) else { return };
        desk.chain.evaluate(linkage, self.session.packed, row, observation);
        let pose = picture.directed_measurement(&desk.chain.target);
        desk.pack(picture, board, data.pictures.sigma_px);
        let has_points = self.by_points.get(picture.board).is_some_and(|it| !it.is_empty());
        let BundleScratch { corners, products, .. } = desk;
        let motion = FixedMotion::from(&pose);
        lanes::corner_products(self.level, lens, &motion, corners, has_points, products);
        self.layout.target_twists(&desk.chain, observation.target, &mut desk.twists);
        desk.direct(&pose, picture.of_camera);
        sums.residuals += 2 * picture.corners.iter().filter(|corner| corner.weight > 0.0).count();
        self.weigh(picture, desk, sums);
        self.eliminate(&pose, desk, sums);
    }

    /// Adds the products of the numbers of camera and board among themselves, and writes those with the motions of the board.
    fn weigh(&self, picture: &Picture, desk: &mut BundleScratch, sums: &mut NormalEquations) {
        let robot = self.layout.dim();
        let n = sums.gradient.len();
        let BundleScratch { products, weighed, points, .. } = desk;
        weighed.fill(0.0);
        let last = products.columns() - 1;
        let lens = self.of_lenses.get(picture.camera).map_or(&[][..], Vec::as_slice);
        for (order, (place, number, prior)) in lens.iter().enumerate() {
            let (own, column) = (robot + place, MOTIONS + number);
            (0..MOTIONS).for_each(|k| weighed[k * n + own] = products.product(k, column) * prior);
            sums.gradient[own] += products.product(column, last) * prior;
            for (other, other_number, other_prior) in &lens[order..] {
                let value = products.product(column, MOTIONS + other_number);
                sums.gram[own * n + robot + other] += value * prior * other_prior;
            }
        }
        let Some(by_points) = self.by_points.get(picture.board).filter(|it| !it.is_empty()) else { return };
        let Some(points) = points.get_mut(picture.camera) else { return };
        lanes::by_best(
            #[inline(always)]
            || add_points(by_points, picture, products, (weighed, points), (sums, robot)),
        );
    }

    /// Adds the products of lenses with points that were summed over pictures.
    fn add_lens_points(&self, points: &[Vec<[f64; MOST_COLUMNS]>], sums: &mut NormalEquations) {
        let robot = self.layout.dim();
        let n = sums.gradient.len();
        for (points, lens) in points.iter().zip(&self.of_lenses) {
            for (place, products) in points.iter().enumerate() {
                let at = robot + place;
                sums.gradient[at] += products[MOTIONS + lens.len()];
                for (lens, number, prior) in lens {
                    let (first, second) = ((robot + lens).min(at), (robot + lens).max(at));
                    sums.gram[first * n + second] += products[MOTIONS + number] * prior;
                }
            }
        }
    }

    /// Adds the parts that depend on the motions of the board, without the shared error of the corners:
    /// `[J|I]ᵀ (H - H S H) [J|I]` with `S = (H + Q⁻¹)⁻¹`, and likewise the products with the numbers.
    fn eliminate(&self, camera_from_board: &Pose, desk: &mut BundleScratch, sums: &mut NormalEquations) {
        let robot = self.layout.dim();
        let n = sums.gradient.len();
        let (information, mut pull) = desk.of_motions();
        let BundleScratch { products, motions, weighed, .. } = desk;
        let last = products.columns() - 1;
        sums.cost += 0.5 * (products.product(last, last) + products.unseen * UNSEEN * UNSEEN);
        for k in 0..MOTIONS {
            let row = &mut weighed[k * n..k * n + robot];
            for (l, motion) in motions.chunks_exact(robot).enumerate() {
                let weight = information[(k, l)];
                row.iter_mut().zip(motion).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        if self.common.shift_m > 0.0 || self.common.turn_rad > 0.0 {
            let root = shared_root(self.common, camera_from_board, &information);
            sums.cost -= 0.5 * (root * pull).norm_squared();
            self.share((&root, &information), &mut pull, (weighed, n), sums);
        }
        lanes::by_best(
            #[inline(always)]
            || add_products((motions, robot), (weighed, n), &pull, sums),
        );
    }

    /// Subtracts from the products of a picture the part that a shared error of all its corners explains.
    fn share(
        &self,
        (root, information): (&Matrix6<f64>, &Matrix6<f64>),
        pull: &mut Vector6<f64>,
        (weighed, n): (&mut [f64], usize),
        sums: &mut NormalEquations,
    ) {
        let robot = self.layout.dim();
        let explained = root * *pull;
        let of_column = |weighed: &[f64], column: usize| root * Vector6::from_fn(|k, _| weighed[k * n + column]);
        let own: Vec<(usize, Vector6<f64>)> = (robot..n)
            .filter(|column| (0..MOTIONS).any(|k| weighed[k * n + column] != 0.0))
            .map(|column| (column, of_column(weighed, column)))
            .collect();
        for (order, (column, by)) in own.iter().enumerate() {
            sums.gradient[*column] -= by.dot(&explained);
            for (other, by_other) in &own[order..] {
                sums.gram[column * n + other] -= by.dot(by_other);
            }
        }
        let back = information * root.transpose();
        for column in 0..n {
            let by = of_column(weighed, column);
            let less = back * by;
            (0..MOTIONS).for_each(|k| weighed[k * n + column] -= less[k]);
        }
        *pull -= back * explained;
    }
}

//! Unknowns of cameras and boards beside the robot, and the derivatives of corners by them (theory.md §4, *Pictures*).

use nalgebra::{DMatrix, DVector, Matrix2x3, Matrix2xX, Matrix6, Matrix6xX, Vector2, Vector3, Vector6};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::board::Board;
use super::lens::{Distortion, LENS_NAMES, LENS_NUMBERS, Projection};
use super::shape::BoardExtent;
use super::{Camera, Corner, SightingInput};
use poecal_arm::lie::Pose;
use poecal_numerics::linalg;

/// Prior of focal lengths and of the centre, as shares of the focal length and of the picture's width; the last factor is for a guessed
/// lens.
const FOCAL: f64 = 0.02;
const CENTRE: f64 = 0.02;
const GUESSED: f64 = 10.0;
/// Prior of the coefficients of a distortion, and of its tangential ones.
const DISTORTION: f64 = 0.1;
const TANGENTIAL: f64 = 0.01;
/// Prior of the scales of a board and of the sagitta of its bend as a share of its half side.
const SHAPE: f64 = 0.005;
/// Prior of the position of a point of a body, metres.
const PLACE_M: f64 = 1e-3;

/// A group of unknowns of a camera or of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PictureUnknown {
    /// Numbers of a camera's lens.
    Lens(usize),
    /// Scales of a flat board along x and y, and its bend along both.
    Board(usize),
    /// Positions of the points of a body.
    Markers(usize),
}

/// An estimated number of a camera or of a board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "FoundEntry")]
pub struct PictureNumber {
    /// Name: `lens`, `board` or `markers`, then a name, and the number's own, such as `lens.left.fx`.
    pub name: String,
    /// Unit, `px` or `mm`; empty for shares and for coefficients.
    pub unit: String,
    /// Initial value.
    pub given: f64,
    /// Estimated value.
    pub found: f64,
    /// Standard deviation of the prior.
    pub prior: f64,
    /// Standard deviation of the estimate, by the corners and the prior.
    pub deviation: f64,
}

/// Factor by which another lens must explain the corners of single pictures better, for the stated one to be that of other pictures: "three times"
/// to one digit.
pub const OTHER_LENS: f64 = 2.5;

/// Numbers whose change exceeds some standard deviations, in words.
#[must_use]
pub fn changed_numbers(numbers: &[PictureNumber], deviations: f64) -> String {
    let changed = numbers.iter().filter(|it| (it.found - it.given).abs() > deviations * it.deviation);
    let words = changed.map(|it| {
        let own = it.name.rsplit('.').next().unwrap_or_default();
        let digits = if it.unit == "px" { 1 } else { 4 };
        format!("{own} {:.digits$} instead of {:.digits$}", it.found, it.given)
    });
    let words: Vec<String> = words.collect();
    if words.is_empty() { "of several numbers".to_owned() } else { words.join(", ") }
}

/// Unknown numbers of cameras and boards as steps from their initial values, in standard deviations of their prior.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureUnknowns {
    cameras: Vec<Camera>,
    boards: Vec<Board>,
    parts: Vec<UnknownNumbers>,
}

/// Numbers of one unknown.
#[derive(Clone, Debug, PartialEq)]
struct UnknownNumbers {
    of: PictureUnknown,
    first: usize,
    /// Indices of the unknown numbers of a lens.
    places: Vec<usize>,
    priors: Vec<f64>,
}

/// Information of the corners of pictures on the unknown numbers, with free poses of the pictures, and the gradient of half their squares.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureInformation {
    /// Information, in deviations of the prior.
    pub gram: DMatrix<f64>,
    /// Gradient.
    pub pull: DVector<f64>,
}

impl PictureInformation {
    /// No information on `count` numbers.
    #[must_use]
    pub fn zero(count: usize) -> Self {
        PictureInformation { gram: DMatrix::zeros(count, count), pull: DVector::zeros(count) }
    }
}

impl PictureUnknowns {
    /// Numbers of some unknowns, with these cameras and boards as initial values.
    #[must_use]
    pub fn new(cameras: &[Camera], boards: &[Board], unknowns: &[PictureUnknown]) -> Self {
        let mut parts: Vec<UnknownNumbers> = Vec::new();
        let mut first = 0;
        for &of in unknowns {
            let (places, priors) = match of {
                PictureUnknown::Lens(camera) => cameras.get(camera).map(lens_priors).unwrap_or_default(),
                PictureUnknown::Board(board) => boards.get(board).map(shape_priors).unwrap_or_default(),
                PictureUnknown::Markers(board) => {
                    let count = boards.get(board).map_or(0, |board| 3 * board.points.len());
                    (Vec::new(), vec![PLACE_M; count])
                }
            };
            first += priors.len();
            parts.push(UnknownNumbers { of, first: first - priors.len(), places, priors });
        }
        PictureUnknowns { cameras: cameras.to_vec(), boards: boards.to_vec(), parts }
    }

    /// Number of unknown numbers.
    #[must_use]
    pub fn count(&self) -> usize {
        self.parts.iter().map(|part| part.priors.len()).sum()
    }

    /// Cameras and boards after a step.
    #[must_use]
    pub fn apply_step(&self, step: &DVector<f64>) -> (Vec<Camera>, Vec<Board>) {
        let (mut cameras, mut boards) = (self.cameras.clone(), self.boards.clone());
        for part in &self.parts {
            let own = |k: usize| step[part.first + k] * part.priors[k];
            match part.of {
                PictureUnknown::Lens(camera) => {
                    let Some(camera) = cameras.get_mut(camera) else { continue };
                    let mut numbers = camera.lens.numbers();
                    part.places.iter().enumerate().for_each(|(k, &place)| numbers[place] += own(k));
                    camera.lens = camera.lens.with_numbers(&numbers);
                }
                PictureUnknown::Board(board) => {
                    let Some(board) = boards.get_mut(board) else { continue };
                    let shape = BoardExtent::from_board(board);
                    let numbers = [own(0), own(1), own(2), own(3)];
                    board.points.iter_mut().for_each(|point| *point = shape.bend_point(point, numbers));
                }
                PictureUnknown::Markers(board) => {
                    let Some(board) = boards.get_mut(board) else { continue };
                    for (at, point) in board.points.iter_mut().enumerate() {
                        *point += Vector3::new(own(3 * at), own(3 * at + 1), own(3 * at + 2));
                    }
                }
            }
        }
        (cameras, boards)
    }

    /// Adds the information of the corners of a picture beyond its pose; returns the derivatives of that pose by the numbers, as motions of the
    /// board in the camera's axes: `-H⁻¹ H_z`. `information` is that of the pose.
    pub fn add(
        &self,
        (camera, board): (usize, usize),
        view: &SightingInput<'_>,
        (pose, information): (&Pose, &Matrix6<f64>),
        own: &mut PictureInformation,
    ) -> Matrix6xX<f64> {
        let count = self.count();
        let mut mixed = Matrix6xX::zeros(count);
        let mut by_pose = Vector6::zeros();
        let parts: Vec<&UnknownNumbers> = self.parts.iter().filter(|part| part.is_of(camera, board)).collect();
        let shape = self.boards.get(board).map(BoardExtent::from_board);
        let mut columns: Vec<(usize, Vector2<f64>)> = Vec::new();
        for corner in view.corners.iter().filter(|corner| corner.weight > 0.0) {
            let Some(seen) = view.corner_residual(corner, pose) else { continue };
            columns.clear();
            for part in &parts {
                part.columns(&seen, corner, (pose, shape.as_ref(), &self.boards), &mut columns);
            }
            let weight = corner.weight;
            for (place, (a, by_a)) in columns.iter().enumerate() {
                let mut column = mixed.column_mut(*a);
                column += seen.by_motion.transpose() * by_a * weight;
                own.pull[*a] += weight * by_a.dot(&seen.error);
                for (b, by_b) in columns.iter().skip(place) {
                    let value = weight * by_a.dot(by_b);
                    own.gram[(*a, *b)] += value;
                    if a != b {
                        own.gram[(*b, *a)] += value;
                    }
                }
            }
            by_pose += seen.by_motion.transpose() * seen.error * weight;
        }
        let Some(factor) = linalg::cholesky_6(*information) else { return Matrix6xX::zeros(count) };
        let follow = -(factor.inverse() * &mixed);
        own.gram += mixed.transpose() * &follow;
        own.pull += follow.transpose() * by_pose;
        follow
    }

    /// Derivative of a pixel of a camera by all numbers, in deviations of their prior: by those of its lens.
    #[must_use]
    pub fn by_lens(&self, camera: usize, found: &Projection) -> Matrix2xX<f64> {
        let mut by = Matrix2xX::zeros(self.count());
        for (own, place, prior) in self.of_lens(camera) {
            (0..2).for_each(|axis| by[(axis, own)] = found.by_lens[axis][place] * prior);
        }
        by
    }

    /// Unknown numbers of a camera's lens: index among all, index among those of the lens, and prior.
    pub fn of_lens(&self, camera: usize) -> impl Iterator<Item = (usize, usize, f64)> {
        let own = self.parts.iter().filter(move |part| part.of == PictureUnknown::Lens(camera));
        own.flat_map(UnknownNumbers::lens)
    }

    /// Motion of each point of a board by the numbers, metres for a deviation of their prior: index among all and direction; empty if they are
    /// known.
    pub fn by_points(&self, board: usize) -> Vec<Vec<(usize, Vector3<f64>)>> {
        let Some(given) = self.boards.get(board) else { return Vec::new() };
        let is_own = |part: &&UnknownNumbers| matches!(part.of, PictureUnknown::Board(at) | PictureUnknown::Markers(at) if at == board);
        let parts: Vec<&UnknownNumbers> = self.parts.iter().filter(is_own).collect();
        if parts.is_empty() {
            return Vec::new();
        }
        let shape = BoardExtent::from_board(given);
        let of = |(at, point): (usize, &Vector3<f64>)| {
            let mut columns = Vec::new();
            for part in &parts {
                part.moves(at, (point, &shape), |place, way, prior| columns.push((place, way * prior)));
            }
            columns
        };
        given.points.iter().enumerate().map(of).collect()
    }

    /// Numbers after a step, with their standard deviations in units of those of the prior.
    #[must_use]
    pub fn numbers(&self, step: &DVector<f64>, deviations: &[f64]) -> Vec<PictureNumber> {
        let mut all = Vec::with_capacity(self.count());
        for part in &self.parts {
            for (k, &prior) in part.priors.iter().enumerate() {
                let (name, unit, given) = self.name_number(part, k);
                let factor = if unit == "mm" { 1e3 } else { 1.0 };
                let at = part.first + k;
                all.push(PictureNumber {
                    name,
                    unit: unit.to_owned(),
                    given: factor * given,
                    found: factor * (given + step[at] * prior),
                    prior: factor * prior,
                    deviation: factor * prior * deviations.get(at).copied().unwrap_or(1.0),
                });
            }
        }
        all
    }

    fn name_number(&self, part: &UnknownNumbers, k: usize) -> (String, &'static str, f64) {
        let camera = |at: usize| self.cameras.get(at).map_or("", |it| it.name.as_str());
        match part.of {
            PictureUnknown::Lens(at) => {
                let place = part.places.get(k).copied().unwrap_or(0);
                let given = self.cameras.get(at).map_or(0.0, |it| it.lens.numbers()[place]);
                let is_fisheye =
                    self.cameras.get(at).is_some_and(|it| matches!(it.lens.distortion, Distortion::Fisheye(_)));
                let name = if is_fisheye && place >= 4 { FISHEYE_NAMES[place - 4] } else { LENS_NAMES[place] };
                (format!("lens.{}.{name}", camera(at)), if place < 4 { "px" } else { "" }, given)
            }
            PictureUnknown::Board(at) => {
                let (name, unit, given) =
                    [("scale_x", "", 1.0), ("scale_y", "", 1.0), ("bend_x", "mm", 0.0), ("bend_y", "mm", 0.0)]
                        [k.min(3)];
                (format!("board.{}.{name}", self.board_name(at)), unit, given)
            }
            PictureUnknown::Markers(at) => {
                let board = self.boards.get(at);
                let point = board.and_then(|it| it.names.get(k / 3)).map_or("", String::as_str);
                let given = board.and_then(|it| it.points.get(k / 3)).map_or(0.0, |it| it[k % 3]);
                (format!("markers.{}.{point}.{}", self.board_name(at), ["x", "y", "z"][k % 3]), "mm", given)
            }
        }
    }

    fn board_name(&self, at: usize) -> &str {
        self.boards.get(at).map_or("", |it| it.name.as_str())
    }
}

/// Names of the coefficients of a fisheye.
const FISHEYE_NAMES: [&str; 4] = ["k1", "k2", "k3", "k4"];

impl UnknownNumbers {
    fn is_of(&self, camera: usize, board: usize) -> bool {
        match self.of {
            PictureUnknown::Lens(at) => at == camera,
            PictureUnknown::Board(at) | PictureUnknown::Markers(at) => at == board,
        }
    }

    /// Derivatives of a corner's pixel by the numbers, in standard deviations of the corner and of the prior, with their indices.
    fn columns(
        &self,
        seen: &super::sighting::CornerResidual,
        corner: &Corner,
        (pose, shape, given): (&Pose, Option<&BoardExtent>, &[Board]),
        out: &mut Vec<(usize, Vector2<f64>)>,
    ) {
        if let PictureUnknown::Lens(_) = self.of {
            out.extend(self.lens().map(|(own, place, prior)| {
                (own, Vector2::new(seen.by_lens[0][place], seen.by_lens[1][place]) * prior)
            }));
            return;
        }
        let on_board: Matrix2x3<f64> = seen.by_point * pose.rotation;
        let at = corner.point as usize;
        let (PictureUnknown::Lens(board) | PictureUnknown::Board(board) | PictureUnknown::Markers(board)) = self.of;
        let point = given.get(board).and_then(|it| it.points.get(at));
        let Some((shape, point)) = shape.zip(point) else { return };
        self.moves(at, (point, shape), |own, way, prior| out.push((own, on_board * way * prior)));
    }

    /// Numbers of a lens: index among all, index among those of the lens, and prior.
    fn lens(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let both = self.places.iter().zip(&self.priors).enumerate();
        both.map(|(k, (&place, &prior))| (self.first + k, place, prior))
    }

    /// Motion of a point of a board by its numbers: index among all, direction, and prior of each.
    fn moves(
        &self,
        at: usize,
        (point, shape): (&Vector3<f64>, &BoardExtent),
        mut each: impl FnMut(usize, Vector3<f64>, f64),
    ) {
        match self.of {
            PictureUnknown::Lens(_) => {}
            PictureUnknown::Board(_) => {
                let ways = shape.by_numbers(point);
                let all = ways.column_iter().zip(&self.priors).enumerate();
                all.for_each(|(k, (way, prior))| each(self.first + k, way.into(), *prior));
            }
            PictureUnknown::Markers(_) => {
                let first = self.first + 3 * at;
                (0..3).for_each(|k| each(first + k, Vector3::ith(k, 1.0), PLACE_M));
            }
        }
    }
}

/// Unknown numbers of a lens, and their priors: focal lengths, centre, and the coefficients of its distortion, at least k1, k2, p1, p2.
fn lens_priors(camera: &Camera) -> (Vec<usize>, Vec<f64>) {
    let lens = &camera.lens;
    let numbers = lens.numbers();
    let width = lens.size_px.map_or(2.0 * lens.centre_px[0], |[width, _]| f64::from(width));
    let wider = if camera.is_guessed { GUESSED } else { 1.0 };
    let prior = |place: usize| match (place, lens.distortion) {
        (0 | 1, _) => wider * FOCAL * lens.focal(),
        (2 | 3, _) => wider.min(3.0) * CENTRE * width,
        (6 | 7, Distortion::Brown(_)) => TANGENTIAL,
        _ => DISTORTION,
    };
    let last = numbers.iter().rposition(|it| *it != 0.0).map_or(0, |at| at + 1).max(8);
    let places: Vec<usize> = (0..last.min(LENS_NUMBERS)).collect();
    let priors = places.iter().map(|&place| prior(place)).collect();
    (places, priors)
}

fn shape_priors(board: &Board) -> (Vec<usize>, Vec<f64>) {
    let BoardExtent { half_m: [x, y], .. } = BoardExtent::from_board(board);
    (Vec::new(), vec![SHAPE, SHAPE, SHAPE * x, SHAPE * y])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Lens;
    use Vector6;

    /// Information and derivatives of a flat board compared with differences: the pose that fits its corners best, and its squares.
    #[test]
    fn what_corners_say_of_lens_and_board_is_that_of_differences() {
        let size_px = Some([1920, 1200]);
        let lens = Lens {
            distortion: Distortion::Brown([-0.18, 0.03, 4e-4, -3e-4, 0.0, 0.0, 0.0, 0.0]),
            size_px,
            ..Lens::pinhole([1500.0, 1490.0], [955.0, 603.0])
        };
        let board = Board::chessboard("board", [7, 5], 0.036).unwrap();
        let (mut cameras, mut boards) = (vec![Camera::new("left".to_owned(), lens)], vec![board.clone()]);
        let pose = Pose::from_xyz_rpy([-0.1, 0.05, 0.7], [0.5, -0.3, 0.2]);
        let corner = |off: f64| {
            move |(point, place): (u32, &Vector3<f64>)| {
                let off = Vector2::new(0.3 * f64::from(point % 3) - 0.3, 0.2 * f64::from(point % 2)) * off;
                let pixel = lens.pixel(&pose.act(place)).unwrap() + off;
                Corner { point, pixel, sigma_px: Some(0.5), weight: 1.0, line: 0 }
            }
        };
        let all = [PictureUnknown::Lens(0), PictureUnknown::Board(0), PictureUnknown::Markers(0)];
        let unknowns = PictureUnknowns::new(&cameras, &boards, &all);
        let count = unknowns.count();
        assert_eq!(count, 8 + 4 + 3 * 24);
        let (mut worst, mut worst_pull): (f64, f64) = (0.0, 0.0);
        // Corners are exact, or have errors: then the gradient of their squares is not zero.
        for off in [0.0, 1.0] {
            let corners: Vec<Corner> = (0..).zip(&board.points).map(corner(off)).collect();
            let mut best = |step: &DVector<f64>| {
                (cameras, boards) = unknowns.apply_step(step);
                let (lens, board) = (&cameras[0].lens, &boards[0]);
                let view = SightingInput { lens, board, corners: &corners, sigma_px: 0.5 };
                let found = view.sighting(&pose, false).unwrap();
                (found.camera_from_board, found.information, found.cost)
            };
            let none = DVector::zeros(count);
            let (at, information, _) = best(&none);
            let mut own = PictureInformation::zero(count);
            let view = SightingInput { lens: &lens, board: &board, corners: &corners, sigma_px: 0.5 };
            let follow = unknowns.add((0, 0), &view, (&at, &information), &mut own);
            for k in 0..count {
                let mut step = none.clone();
                step[k] = 1e-2;
                let (up, _, more) = best(&step);
                step[k] = -1e-2;
                let (down, _, less) = best(&step);
                let shift = (up.translation - down.translation) / 2e-2;
                let turn = poecal_arm::lie::rotation::log(&(up.rotation * down.rotation.transpose())) / 2e-2;
                let moved = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
                if off == 0.0 {
                    worst = worst.max((moved - follow.column(k)).norm() / follow.column(k).norm().max(1e-4));
                } else {
                    // Half the squares decrease by the gradient.
                    worst_pull = worst_pull.max((own.pull[k] + 0.25 * (more - less) / 1e-2).abs() / own.pull.amax());
                }
            }
        }
        println!("{count} numbers: the pose follows to {worst:.1e}, pull to {worst_pull:.1e}");
        // Central differences of a step of 1e-2: its square.
        assert!(worst < 1e-3 && worst_pull < 1e-4, "{worst:e} {worst_pull:e}");
    }
}

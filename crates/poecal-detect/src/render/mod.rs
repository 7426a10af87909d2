//! Pictures of boards as a camera would take them, with the truth: for tests, and to plan a session.
//!
//! A pixel is the mean light on its area (8 × 8 samples at edges of the board), blurred by a Gaussian, with noise, and rounded to an integer level as
//! in a camera.

mod board;
mod camera;
mod clutter;
mod draw;
mod random;

use nalgebra::{Matrix3, Vector2, Vector3};

pub use camera::RenderCamera;
pub use clutter::clutter;
pub use draw::{DrawnScene, RandomScenes};
pub use random::RandomGenerator;

use crate::gray::Gray;
use crate::layout::BoardLayout;
use board::BoardShades;

/// Scene before a camera, and the camera's properties.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderScene {
    /// The camera.
    pub camera: RenderCamera,
    /// Rotation from the board's axes (x along columns, y along rows, origin at the first inner corner) to the camera's.
    pub rotation: Matrix3<f64>,
    /// The first inner corner in the camera's frame, metres.
    pub translation_m: Vector3<f64>,
    /// Levels of dark and light squares.
    pub levels: [f64; 2],
    /// Relative excess of the light at the right and the lower border over that in the middle.
    pub gradient: [f64; 2],
    /// Standard deviation of the Gaussian blur, pixels.
    pub blur_px: f64,
    /// Standard deviation of the noise of a pixel, gray levels.
    pub noise: f64,
    /// Patch that covers a part of the board.
    pub patch: Option<Occluder>,
}

/// A rectangle in the picture that covers its background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occluder {
    /// Its middle, pixels.
    pub middle_px: Vector2<f64>,
    /// Half its sides, pixels.
    pub half_px: [f64; 2],
    /// Its turn, rad.
    pub turn_rad: f64,
    /// Its gray level.
    pub level: f64,
}

impl Occluder {
    /// True if it covers a point, or is within this margin of it.
    #[must_use]
    pub fn covers(&self, place: Vector2<f64>, margin_px: f64) -> bool {
        let (sin, cos) = self.turn_rad.sin_cos();
        let off = place - self.middle_px;
        let along = [cos * off.x + sin * off.y, cos * off.y - sin * off.x];
        (0..2).all(|k| along[k].abs() <= self.half_px[k] + margin_px)
    }
}

/// True position of a corner, or of the middle of a dot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueCorner {
    /// Number of the point.
    pub id: usize,
    /// Position, pixels.
    pub place_px: Vector2<f64>,
    /// True if it, and all of a dot, is in the picture and not covered, with [`SEEN_PX`] around it.
    pub visible: bool,
}

/// Size of the surroundings of a visible corner that must be seen, pixels to each side.
pub const SEEN_PX: f64 = 5.0;
/// Samples along a side of a pixel at an edge.
const SAMPLES: usize = 8;

impl RenderScene {
    /// Positions of the inner corners or the dots in the picture.
    #[must_use]
    pub fn truth(&self, layout: &BoardLayout) -> Vec<TrueCorner> {
        let [width, height] = self.camera.size.map(|it| it as f64 - 1.0);
        let dot_m = layout.dot_radius() * layout.square_m;
        (0..layout.corners())
            .filter_map(|id| {
                let at = (layout.corner(id) - Vector2::new(1.0, 1.0)) * layout.square_m;
                let point = self.rotation * Vector3::new(at.x, at.y, 0.0) + self.translation_m;
                let place_px = self.camera.project(&point)?;
                // A dot counts as visible only as a whole.
                let beside = [[1.0, 0.0], [0.0, 1.0]].map(|it| self.rotation * Vector3::new(it[0], it[1], 0.0) * dot_m);
                let reach_px = beside.map(|it| self.camera.project(&(point + it)).map(|it| (it - place_px).norm()));
                let seen_px = SEEN_PX + reach_px.into_iter().flatten().fold(0.0, f64::max);
                let covered = self.patch.is_some_and(|it| it.covers(place_px, seen_px));
                let (x, y) = (place_px.x, place_px.y);
                let inside = x >= seen_px && y >= seen_px && x + seen_px <= width && y + seen_px <= height;
                Some(TrueCorner { id, place_px, visible: inside && !covered })
            })
            .collect()
    }

    /// The picture, before a background.
    #[must_use]
    pub fn render(&self, layout: &BoardLayout, background: &Gray, random: &mut RandomGenerator) -> Gray {
        let shades = BoardShades::new(layout);
        let lattice = self.lattice(layout);
        let mut picture = self.sample_shades(&shades, &lattice, background);
        if let Some(patch) = &self.patch {
            let width = picture.width();
            for (at, level) in picture.levels_mut().iter_mut().enumerate() {
                if patch.covers(Vector2::new((at % width) as f64, (at / width) as f64), 0.0) {
                    *level = patch.level as f32;
                }
            }
        }
        finish_picture(picture, self.blur_px, self.noise, random)
    }

    /// Positions on the board, squares, of the corners of all pixels.
    fn lattice(&self, layout: &BoardLayout) -> Vec<Vector2<f64>> {
        let [width, height] = self.camera.size;
        let back = self.rotation.transpose();
        let origin = back * -self.translation_m;
        let [low, high] = self.bounds_in_picture(layout);
        let corner = |at: usize| {
            let (column, row) = (at % (width + 1), at / (width + 1));
            let (x, y) = (column as f64, row as f64);
            if x < low.x || y < low.y || x > high.x || y > high.y {
                return Vector2::new(f64::MAX, f64::MAX);
            }
            let ray = self.camera.ray(Vector2::new(x - 0.5, y - 0.5));
            let ray = back * ray;
            let reach = -origin.z / ray.z;
            if reach <= 0.0 || reach.is_nan() {
                return Vector2::new(f64::MAX, f64::MAX);
            }
            let on_board = origin + ray * reach;
            on_board.xy() / layout.square_m + Vector2::new(1.0, 1.0)
        };
        (0..(width + 1) * (height + 1)).map(corner).collect()
    }

    /// Bounding box of the board, with its paper, in the picture: from points along its outline. The whole picture, if one of them is not visible.
    fn bounds_in_picture(&self, layout: &BoardLayout) -> [Vector2<f64>; 2] {
        const STEPS: usize = 24;
        let [columns, rows] = layout.squares.map(|it| it as f64 + 2.0);
        let mut limits = [Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY)];
        for k in 0..4 * STEPS {
            let part = (k % STEPS) as f64 / STEPS as f64;
            let [x, y] = match k / STEPS {
                0 => [part, 0.0],
                1 => [1.0, part],
                2 => [1.0 - part, 1.0],
                _ => [0.0, 1.0 - part],
            };
            let at = Vector2::new(x * columns - 2.0, y * rows - 2.0) * layout.square_m;
            let point = self.rotation * Vector3::new(at.x, at.y, 0.0) + self.translation_m;
            let Some(place) = self.camera.project(&point) else {
                return [Vector2::repeat(f64::NEG_INFINITY), Vector2::repeat(f64::INFINITY)];
            };
            limits = [limits[0].inf(&place), limits[1].sup(&place)];
        }
        [limits[0].add_scalar(-4.0), limits[1].add_scalar(4.0)]
    }

    fn sample_shades(&self, shades: &BoardShades, lattice: &[Vector2<f64>], background: &Gray) -> Gray {
        let [width, height] = self.camera.size;
        let at_corners: Vec<i8> = lattice.iter().map(|it| shades.shade_at(*it)).collect();
        let corners = |column: usize, row: usize| {
            let first = row * (width + 1) + column;
            [first, first + 1, first + width + 1, first + width + 2]
        };
        let is_edge = |column: usize, row: usize| {
            let [a, b, c, d] = corners(column, row).map(|it| at_corners[it]);
            a != b || a != c || a != d
        };
        let edges: Vec<bool> = (0..width * height).map(|at| is_edge(at % width, at / width)).collect();
        let near_edge = |column: usize, row: usize| {
            (row.saturating_sub(1)..=(row + 1).min(height - 1)).any(|row| {
                let first = row * width;
                edges[first + column.saturating_sub(1)..=first + (column + 1).min(width - 1)].contains(&true)
            })
        };
        let mut picture = Gray::from_level(width, height, 0.0);
        for (at, level) in picture.levels_mut().iter_mut().enumerate() {
            let (column, row) = (at % width, at / width);
            let all = corners(column, row);
            let behind = f64::from(background.levels().get(at).copied().unwrap_or(0.0));
            let mean = if near_edge(column, row) {
                let [a, b, c, d] = all.map(|it| lattice[it]);
                let mut sum = 0.0;
                for k in 0..SAMPLES * SAMPLES {
                    let [x, y] = [k % SAMPLES, k / SAMPLES].map(|it| (it as f64 + 0.5) / SAMPLES as f64);
                    let place = (a * (1.0 - x) + b * x) * (1.0 - y) + (c * (1.0 - x) + d * x) * y;
                    sum += self.level(shades.shade_at(place), behind);
                }
                sum / (SAMPLES * SAMPLES) as f64
            } else {
                self.level(at_corners[all[0]], behind)
            };
            let from_middle = |place: usize, size: usize| 2.0 * place as f64 / size as f64 - 1.0;
            let light =
                1.0 + self.gradient[0] * from_middle(column, width) + self.gradient[1] * from_middle(row, height);
            *level = (mean * light) as f32;
        }
        picture
    }

    fn level(&self, shade: i8, behind: f64) -> f64 {
        match shade {
            board::DARK => self.levels[0],
            board::LIGHT => self.levels[1],
            _ => behind,
        }
    }
}

/// A picture with blur and noise, in integer levels.
#[must_use]
pub fn finish_picture(mut picture: Gray, blur_px: f64, noise: f64, random: &mut RandomGenerator) -> Gray {
    picture = picture.blur(blur_px, 4.0);
    for level in picture.levels_mut() {
        *level = (*level + (noise * random.rough_normal()) as f32).round().clamp(0.0, 255.0);
    }
    picture
}

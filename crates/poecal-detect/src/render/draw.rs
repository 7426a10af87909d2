//! Random scenes of a board.

use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};

use super::{Occluder, RandomGenerator, RenderCamera, RenderScene, TrueCorner, clutter};
use crate::gray::Gray;
use crate::layout::BoardLayout;

/// Parameters of random scenes: 1920 × 1200 pixels, and ranges of blur, noise, tilt and distance.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomScenes {
    /// The camera.
    pub camera: RenderCamera,
    /// Blur, pixels.
    pub blur_px: [f64; 2],
    /// Noise, gray levels.
    pub noise: [f64; 2],
    /// Angle between the board's normal and the line of sight, degrees.
    pub tilt_deg: [f64; 2],
    /// Pixels of a square seen from the front.
    pub square_px: [f64; 2],
    /// Gray levels from dark to light.
    pub contrast: [f64; 2],
    /// Interval of scenes with a covered part; 0: never.
    pub covered_each: usize,
}

impl Default for RandomScenes {
    fn default() -> Self {
        let camera = RenderCamera {
            size: [1920, 1200],
            focal_px: [1500.0, 1500.0],
            centre_px: [955.0, 605.0],
            distortion: [-0.18, 0.0],
        };
        RandomScenes {
            camera,
            blur_px: [0.5, 1.6],
            noise: [1.0, 6.0],
            tilt_deg: [0.0, 60.0],
            square_px: [40.0, 110.0],
            contrast: [40.0, 190.0],
            covered_each: 5,
        }
    }
}

/// A random scene with its picture and its truth.
#[derive(Clone, Debug)]
pub struct DrawnScene {
    /// The scene.
    pub scene: RenderScene,
    /// Its picture.
    pub picture: Gray,
    /// True positions of the corners.
    pub truth: Vec<TrueCorner>,
    /// Angle between the board's normal and the line of sight, degrees.
    pub tilt_deg: f64,
}

impl RandomScenes {
    /// The scene with a number, for a seed.
    #[must_use]
    pub fn scene(&self, layout: &BoardLayout, seed: u64, number: usize) -> DrawnScene {
        let mut random = RandomGenerator::new(seed ^ (number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let pick = |random: &mut RandomGenerator, range: [f64; 2]| random.draw_uniform(range[0], range[1]);
        let tilt_deg = pick(&mut random, self.tilt_deg);
        let square_px = pick(&mut random, self.square_px);
        let (rotation, translation_m) = self.pose(layout, tilt_deg, square_px, &mut random);
        let contrast = pick(&mut random, self.contrast);
        let dark = random.draw_uniform(8.0, (235.0 - contrast).clamp(9.0, 90.0));
        let mut scene = RenderScene {
            camera: self.camera,
            rotation,
            translation_m,
            levels: [dark, dark + contrast],
            gradient: [random.draw_uniform(-0.15, 0.15), random.draw_uniform(-0.15, 0.15)],
            blur_px: pick(&mut random, self.blur_px),
            noise: pick(&mut random, self.noise),
            patch: None,
        };
        if self.covered_each > 0 && number % self.covered_each == self.covered_each - 1 {
            scene.patch = Some(patch(&scene.truth(layout), &mut random));
        }
        let background = clutter(self.camera.size, &mut random);
        let picture = scene.render(layout, &background, &mut random);
        DrawnScene { truth: scene.truth(layout), picture, scene, tilt_deg }
    }

    /// A pose with the whole board in the picture, or, if there is none, most of it.
    fn pose(
        &self,
        layout: &BoardLayout,
        tilt_deg: f64,
        square_px: f64,
        random: &mut RandomGenerator,
    ) -> (Matrix3<f64>, Vector3<f64>) {
        let [columns, rows] = layout.squares.map(|it| it as f64);
        let middle = Vector3::new(columns / 2.0 - 1.0, rows / 2.0 - 1.0, 0.0) * layout.square_m;
        let far_m = self.camera.focal_px[0] * layout.square_m / square_px;
        let mut best = (usize::MAX, Matrix3::identity(), Vector3::zeros());
        for _ in 0..40 {
            let axis_rad = random.draw_uniform(0.0, std::f64::consts::TAU);
            let axis = Vector3::new(axis_rad.cos(), axis_rad.sin(), 0.0);
            let roll = Rotation3::from_axis_angle(&Vector3::z_axis(), random.draw_uniform(-3.2, 3.2));
            let tilt = Rotation3::new(axis * tilt_deg.to_radians());
            let [width, height] = self.camera.size.map(|it| it as f64);
            let place = Vector2::new(random.draw_uniform(0.25, 0.75) * width, random.draw_uniform(0.25, 0.75) * height);
            let ray = self.camera.ray(place);
            // The tilt of the board is relative to its own line of sight.
            let sight = Rotation3::rotation_between(&Vector3::z(), &ray).unwrap_or_default();
            let rotation = (sight * tilt * roll).into_inner();
            let translation = ray * far_m - rotation * middle;
            let outside = self.count_outside(layout, &rotation, &translation);
            if outside < best.0 {
                best = (outside, rotation, translation);
            }
            if outside == 0 {
                break;
            }
        }
        (best.1, best.2)
    }

    /// Number of the outer corners of the board, and of its inner ones, outside the picture.
    fn count_outside(&self, layout: &BoardLayout, rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> usize {
        let [columns, rows] = layout.squares;
        let all = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row)));
        all.filter(|(column, row)| {
            let at = Vector3::new(*column as f64 - 1.0, *row as f64 - 1.0, 0.0) * layout.square_m;
            let [width, height] = self.camera.size.map(|it| it as f64);
            self.camera.project(&(rotation * at + translation)).is_none_or(|place| {
                place.x < 10.0 || place.y < 10.0 || place.x > width - 10.0 || place.y > height - 10.0
            })
        })
        .count()
    }
}

/// Patch that covers a part of the board: about a quarter of its size, at a corner of the grid.
fn patch(truth: &[TrueCorner], random: &mut RandomGenerator) -> Occluder {
    let places: Vec<Vector2<f64>> = truth.iter().map(|it| it.place_px).collect();
    let middle = places.iter().sum::<Vector2<f64>>() / places.len().max(1) as f64;
    let size = places.iter().map(|it| (it - middle).norm()).fold(0.0, f64::max);
    let middle_px = places.get(random.draw_below(places.len())).copied().unwrap_or(middle);
    Occluder {
        middle_px,
        half_px: [size * random.draw_uniform(0.15, 0.45), size * random.draw_uniform(0.15, 0.45)],
        turn_rad: random.draw_uniform(0.0, 3.2),
        level: random.draw_uniform(10.0, 230.0),
    }
}

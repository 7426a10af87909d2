//! Factors by which the bounds of few poses are wider than by formula (parametric bootstrap). Sessions are simulated from the fit of this
//! one, and fitted by the same steps.
//!
//! The formula takes the parts of the noise, the point of the target and the rows without outliers as they were found. With few poses these
//! are uncertain themselves.

use super::bounds::{FrameSide, bound_frame};
use super::draw::{LinearCongruential, draw_errors};
use super::equations::{PosePair, sight_axes};
use super::fit::HandEyeFit;
use super::noise::FrameCovariance;
use poecal_arm::lie::{Pose, rotation};

/// Number of simulated sessions.
const SESSIONS: usize = 99;
/// Number of rows from which on the formula is as good.
const MANY: usize = 40;
/// Largest factor.
const MOST: f64 = 3.0;

/// Factors of the bounds of position and orientation, of the camera and of the target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors {
    camera: (f64, f64),
    target: (f64, f64),
}

impl Factors {
    pub(crate) fn factors_of_side(&self, side: FrameSide) -> (f64, f64) {
        if side == FrameSide::Camera { self.camera } else { self.target }
    }
}

/// Factors for a fit of rows that all count.
pub(crate) fn factors(rows: &[PosePair], fit: &HandEyeFit) -> Factors {
    let none = Factors { camera: (1.0, 1.0), target: (1.0, 1.0) };
    if rows.len() >= MANY {
        return none;
    }
    let truth = fit.own_frames();
    let poses = [truth.outer.inverse(), truth.inner];
    let mut ratios: [Vec<f64>; 4] = Default::default();
    let mut draw = LinearCongruential::new(rows.len() as u64);
    for _ in 0..SESSIONS {
        let session = simulate_like(rows, fit, &mut draw);
        let Some(again) = HandEyeFit::from_start(&session, truth) else { continue };
        let kept = again.rows(&again.seen_about(&session));
        let Some(spread) = FrameCovariance::from_pairs(&again.noise, &kept, &again.frames) else { continue };
        for (side, (pose, at)) in [FrameSide::Camera, FrameSide::Target].into_iter().zip(poses.iter().zip([0, 2])) {
            let placed = bound_frame(&spread, &again.frames, &again.point, side);
            let (shift, turn) = placed.pose.distance_and_angle(pose);
            ratios[at].push(shift / placed.bound95_m.max(f64::MIN_POSITIVE));
            ratios[at + 1].push(turn / placed.bound95_rad.max(f64::MIN_POSITIVE));
        }
    }
    let factor = |ratios: &mut Vec<f64>| {
        ratios.sort_by(f64::total_cmp);
        // The 95th of 99 has 95 of 100 before it.
        let at = (ratios.len() + 1) * 95 / 100;
        ratios.get(at.saturating_sub(1)).map_or(1.0, |it| it.clamp(1.0, MOST))
    };
    let [a, b, c, d] = &mut ratios;
    Factors { camera: (factor(a), factor(b)), target: (factor(c), factor(d)) }
}

/// Rows predicted by the fit, with its noise.
fn simulate_like(rows: &[PosePair], fit: &HandEyeFit, draw: &mut LinearCongruential) -> Vec<PosePair> {
    let sigmas = std::array::from_fn(|number| fit.noise.sigma(number));
    let back = Pose::from_translation(-fit.point);
    let row = |pair: &PosePair| {
        let exact = fit.frames.predict(&pair.moved);
        let axes = sight_axes(&exact).transpose();
        let (shift, turn) = draw_errors(draw, &sigmas);
        let seen = Pose::new(rotation::exp(&(axes * turn)) * exact.rotation, exact.translation + axes * shift);
        PosePair { seen: seen * back, ..*pair }
    };
    rows.iter().map(row).collect()
}

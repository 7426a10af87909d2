//! Factors by which the bounds of few poses are wider than by formula (parametric bootstrap). Sessions are simulated from the fit of this
//! one, and fitted by the same steps.
//!
//! The formula takes the parts of the noise, the point of the target and the rows without outliers as they were found. With few poses these
//! are uncertain themselves.

use super::bounds::{Side, bounded};
use super::draw::{Draw, drawn};
use super::equations::{Pair, sight_axes};
use super::fit::Fit;
use super::noise::Spread;
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
    pub(crate) fn factors_of_side(&self, side: Side) -> (f64, f64) {
        if side == Side::Camera { self.camera } else { self.target }
    }
}

/// Factors for a fit of rows that all count.
pub(crate) fn factors(rows: &[Pair], fit: &Fit) -> Factors {
    let none = Factors { camera: (1.0, 1.0), target: (1.0, 1.0) };
    if rows.len() >= MANY {
        return none;
    }
    let truth = fit.own_frames();
    let poses = [truth.outer.inverse(), truth.inner];
    let mut ratios: [Vec<f64>; 4] = Default::default();
    let mut draw = Draw::new(rows.len() as u64);
    for _ in 0..SESSIONS {
        let session = like(rows, fit, &mut draw);
        let Some(again) = Fit::from_start(&session, truth) else { continue };
        let kept = again.rows(&again.seen_about(&session));
        let Some(spread) = Spread::from_pairs(&again.noise, &kept, &again.frames) else { continue };
        for (side, (pose, at)) in [Side::Camera, Side::Target].into_iter().zip(poses.iter().zip([0, 2])) {
            let placed = bounded(&spread, &again.frames, &again.point, side);
            let (shift, turn) = placed.pose.apart(pose);
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
fn like(rows: &[Pair], fit: &Fit, draw: &mut Draw) -> Vec<Pair> {
    let sigmas = std::array::from_fn(|number| fit.noise.sigma(number));
    let back = Pose::from_translation(-fit.point);
    let row = |pair: &Pair| {
        let exact = fit.frames.predicted(&pair.moved);
        let axes = sight_axes(&exact).transpose();
        let (shift, turn) = drawn(draw, &sigmas);
        let seen =
            Pose::new(rotation::exp(&(axes * turn)) * exact.rotation, exact.translation + axes * shift);
        Pair { seen: seen * back, ..*pair }
    };
    rows.iter().map(row).collect()
}

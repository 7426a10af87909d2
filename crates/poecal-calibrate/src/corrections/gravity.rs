//! Estimate of an unknown direction of gravity.

use nalgebra::Vector3;

use super::context::{CorrectionContext, RowSample};
use poecal_arm::lie::rotation;
use poecal_model::robot::{CorrectionModel, Sizes};

/// Tilts of the direction of gravity that are tried in turn, radians, and the most steps with each.
const TILTS: [f64; 6] = [0.35, 0.17, 0.09, 0.04, 0.02, 0.01];
const MOST_TILTS: usize = 8;
/// Gain of the logarithm of the likelihood from which a direction is evidently another than -z. Without sag, the best of all directions gains up to
/// 9.
const EVIDENT: f64 = 12.0;
/// Numbers of a configuration that count as independent.
const NUMBERS_OF_A_CONFIGURATION: f64 = 3.0;
/// Least share by which the noise must decrease.
const LEAST_GAIN: f64 = 0.005;

impl CorrectionContext<'_> {
    /// Direction of gravity with which terms leave the least noise: the best of three, tilted until it no longer improves. If it is not evidently
    /// better than -z of the base, returns -z with a sentence about it.
    pub(crate) fn gravity(&self, moves: &[bool], sizes: Sizes) -> (Vector3<f64>, Option<String>) {
        let along = |direction: &Vector3<f64>| {
            let model = CorrectionModel::new(&self.nominal, *direction, moves, self.extent(Some(sizes)));
            self.sample_rows(&model.with_sizes(&sizes), Some(sizes))
        };
        let score = |direction: &Vector3<f64>| {
            along(direction).map_or(f64::INFINITY, |it| it.linear.logarithm_of_noise(&sizes))
        };
        let down = -Vector3::z();
        let of_down = score(&down);
        let (mut best, mut least) = (down, of_down);
        for direction in [-Vector3::x(), -Vector3::y()] {
            let found = score(&direction);
            if found < least {
                (best, least) = (direction, found);
            }
        }
        for step in TILTS {
            for _ in 0..MOST_TILTS {
                let x = rotation::perpendicular_to(&best);
                let y = best.cross(&x);
                let before = least;
                for turn in [x, -x, y, -y] {
                    let tilted = rotation::exp(&(turn * step)) * best;
                    let found = score(&tilted);
                    if found < least {
                        (best, least) = (tilted.normalize(), found);
                    }
                }
                if least == before {
                    break;
                }
            }
        }
        let Some(RowSample { linear, configurations, .. }) = along(&best) else { return (down, None) };
        // Errors shared by the rows of a configuration count once.
        let numbers = linear.numbers();
        let counted = numbers.min(NUMBERS_OF_A_CONFIGURATION * configurations as f64);
        let gained = if of_down.is_finite() { (of_down - least) / numbers } else { f64::INFINITY };
        if gained * counted < EVIDENT || gained < LEAST_GAIN {
            return (down, Some(not_found(&best, gained)));
        }
        // The opposite direction leads to the same fit with all coefficients negated; joints deflect in the direction of their torque, so the sum of
        // coefficients is positive.
        let given = linear.solution(&sizes, &linear.normal_information()).map(|found| {
            let sags = found.terms.iter().filter(|it| it.term.needs_gravity());
            sags.map(|it| it.coefficient).sum::<f64>()
        });
        (if given.is_some_and(|given| given < 0.0) { -best } else { best }, None)
    }
}

/// Statement for a session in which terms are useless for any direction.
pub(crate) fn of_no_use() -> String {
    "the direction of gravity was not found: no joint terms predict other rows clearly better; if the robot does not stand upright, state it (--gravity \
     X,Y,Z)"
        .to_owned()
}

/// Statement about a direction that is not adopted.
fn not_found(best: &Vector3<f64>, gained: f64) -> String {
    let [x, y, z] = [best.x, best.y, best.z].map(|it| format!("{it:.2}").replace("-0.00", "0.00"));
    let percent = 100.0 * (1.0 - (-gained.max(0.0)).exp());
    format!(
        "the direction of gravity was not found: along ({x}, {y}, {z}) of the base, the best one, the joints' terms leave {percent:.1} % less \
         noise than along (0, 0, -1), which is taken; if the robot does not stand upright, state the direction (--gravity X,Y,Z)"
    )
}

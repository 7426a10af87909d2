//! Signs and zeros of joints that are unknown before anything was measured, as those of a motor whose horn was put on by hand: every sign is
//! tried, and the zeros are fitted with nominal screws.

use super::pictures::{in_hand, take_first_poses};
use crate::forensics::{Fitter, Misfit, ReadingColumns, RowChange, subsample};
use crate::state::Estimate;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{ReadingKind, Robot, Term, Tolerance};

/// Joints of which all signs are tried together; of more, one and two are turned at a time.
const MOST_TOGETHER: usize = 7;
/// Iterations of a fit of zeros.
const ITERATIONS: usize = 40;
/// Combinations of signs whose zeros are fitted from further starts.
const BEST: usize = 4;
/// Further starts of each zero, rad.
const STARTS_RAD: [f64; 4] = [-1.4, 1.4, -2.8, 0.7];
/// Prior standard deviation of a zero, rad: horns are put on by hand, on splines 14 degrees apart.
const PRIOR_RAD: f64 = 0.52;
/// Prior of the axes: printed parts on hobby servos.
const AXES: Tolerance = Tolerance { angle_rad: 0.0175, length_m: 1e-3 };
/// Errors of the nominal axes that count as independent: four of each of five joints. They, and not noise, make the misfit.
const INDEPENDENT: f64 = 20.0;
/// Odds of the best combination of signs against any other that count as evident: 100 to 1, as a logarithm.
const EVIDENT: f64 = 4.6;

/// Signs and zeros of the readings, `joint = sign · reading + zero`.
#[derive(Clone, Debug, PartialEq)]
pub struct JointZeros {
    /// Sign of each reading, 1 or -1.
    pub signs: Vec<f64>,
    /// Zero of each reading, radians; `None` where the rows do not determine it.
    pub zeros: Vec<Option<f64>>,
    /// Root mean square error of the nominal robot with them, metres; an angle counts as its arc at a third of the reach.
    pub misfit_m: f64,
    /// The same with the readings as they are.
    pub before_m: f64,
    /// The same with the best other combination of signs.
    pub other_m: f64,
    /// Logarithm of the odds against that, with the prior of the zeros.
    pub odds: f64,
}

impl JointZeros {
    /// True if no other combination of signs explains the rows nearly as well.
    #[must_use]
    pub fn are_evident(&self) -> bool {
        self.odds > EVIDENT
    }

    /// The readings of a row, changed in place.
    pub fn apply(&self, readings: &mut [f64]) {
        for ((reading, sign), zero) in readings.iter_mut().zip(&self.signs).zip(&self.zeros) {
            *reading = sign * *reading + zero.unwrap_or(0.0);
        }
    }
}

/// A combination of signs with the zeros that fit best.
#[derive(Clone)]
struct SignCandidate {
    signs: Vec<f64>,
    zeros: Vec<f64>,
    misfit: Misfit,
}

impl SignCandidate {
    /// Negative logarithm of the posterior, but for a constant.
    fn score(&self) -> f64 {
        let squares: f64 = self.zeros.iter().map(|zero| (zero / PRIOR_RAD).powi(2)).sum();
        INDEPENDENT * self.misfit.total_m.max(f64::MIN_POSITIVE).ln() + 0.5 * squares
    }
}

/// The rows, the robot, and which readings have signs and zeros of their own.
struct Search<'a> {
    fitter: Fitter<'a>,
    data: Dataset,
    columns: Vec<usize>,
    joints: Vec<usize>,
    fitted: Vec<usize>,
}

/// Finds signs and zeros of the joints by all rows. Pictures whose camera is not placed by name may be of a camera beside the robot or in its
/// hand: the better of the two is taken. `None` without rows, or of readings that no joint has for itself.
#[must_use]
pub fn find_zeros(data: &Dataset, robot: &Robot) -> Option<JointZeros> {
    let mut places = vec![data.clone()];
    if !data.pictures.is_empty() {
        places.push(in_hand(data));
        places.iter_mut().for_each(take_first_poses);
    }
    let found = places.iter().filter_map(|data| Search::new(data, robot)?.run());
    found.min_by(|a, b| a.misfit_m.total_cmp(&b.misfit_m))
}

impl<'a> Search<'a> {
    fn new(data: &Dataset, robot: &'a Robot) -> Option<Self> {
        let known = ReadingColumns::new(robot);
        let own = |column: usize| Some((column, known.only_joint(robot, column)?.0));
        let angles = (0..known.names.len()).filter(|&column| known.kinds[column] == ReadingKind::Angle);
        let (columns, joints): (Vec<usize>, Vec<usize>) = angles.filter_map(own).unzip();
        if data.is_empty() || joints.is_empty() {
            return None;
        }
        // The frame of the device takes in the zero of the first joint, and the target that of the last.
        let fitted = joints.iter().copied().skip(1).take(joints.len().saturating_sub(2)).collect();
        let fitter = Fitter::new(robot, data, true);
        Some(Search { fitter, data: subsample(data), columns, joints, fitted })
    }

    fn run(&self) -> Option<JointZeros> {
        let count = self.columns.len();
        let zeros = vec![0.0; count];
        let mut all: Vec<SignCandidate> =
            self.combinations().into_iter().map(|signs| self.candidate(signs, &zeros)).collect();
        let before_m = self.fitter.roughly_registered(&self.data).1.total_m;
        let by_score = |a: &SignCandidate, b: &SignCandidate| a.score().total_cmp(&b.score());
        all.sort_by(by_score);
        let best: Vec<SignCandidate> = all.iter().take(BEST).cloned().collect();
        for candidate in best {
            for at in 0..count {
                if !self.fitted.contains(&self.joints[at]) {
                    continue;
                }
                for start in STARTS_RAD {
                    let mut zeros = vec![0.0; count];
                    zeros[at] = start;
                    all.push(self.candidate(candidate.signs.clone(), &zeros));
                }
            }
        }
        all.sort_by(by_score);
        let found = self.refined(all.first()?);
        let other = all.iter().find(|it| it.signs != found.signs);
        let zero = |at: usize| {
            let is_fitted = self.fitted.contains(&self.joints[at]);
            is_fitted.then(|| found.zeros[at])
        };
        let width = self.data.reading_names().len();
        let mut result = JointZeros {
            signs: vec![1.0; width],
            zeros: vec![None; width],
            misfit_m: found.misfit.total_m,
            before_m,
            other_m: other.map_or(f64::INFINITY, |it| it.misfit.total_m),
            odds: other.map_or(f64::INFINITY, |it| it.score() - found.score()),
        };
        for (at, &column) in self.columns.iter().enumerate() {
            result.signs[column] = found.signs[at];
            result.zeros[column] = zero(at);
        }
        Some(result)
    }

    /// The zeros with the axes fitted too, as far as a prior allows.
    fn refined(&self, found: &SignCandidate) -> SignCandidate {
        let (data, registered) = self.changed(&found.signs, &found.zeros);
        let by_axes = self.fitter.with_term_and_axes(&data, &registered, (&self.fitted, Term::OFFSET), AXES);
        SignCandidate { signs: found.signs.clone(), zeros: self.zeros(&by_axes.0, &found.zeros), ..found.clone() }
    }

    /// Combinations of signs: all of few joints, beginning with no joint turned.
    fn combinations(&self) -> Vec<Vec<f64>> {
        let count = self.columns.len();
        let sign = |turned: bool| if turned { -1.0 } else { 1.0 };
        if count <= MOST_TOGETHER {
            return (0..1_usize << count)
                .map(|pattern| (0..count).map(|at| sign(pattern >> at & 1 == 1)).collect())
                .collect();
        }
        let mut all = vec![vec![1.0; count]];
        for a in 0..count {
            for b in 0..=a {
                all.push((0..count).map(|at| sign(at == a || at == b)).collect());
            }
        }
        all
    }

    /// The zeros that fit best with these signs, from a start.
    fn candidate(&self, signs: Vec<f64>, start: &[f64]) -> SignCandidate {
        let (data, registered) = self.changed(&signs, start);
        let (estimate, misfit) = self.fitter.with_term(&data, &registered, (&self.fitted, Term::OFFSET), ITERATIONS);
        SignCandidate { zeros: self.zeros(&estimate, start), signs, misfit }
    }

    /// The rows with signs and zeros, and the nominal robot registered to them.
    fn changed(&self, signs: &[f64], zeros: &[f64]) -> (Dataset, Estimate) {
        let width = self.data.reading_names().len();
        let mut factors = vec![1.0; width];
        self.columns.iter().zip(signs).for_each(|(&column, sign)| factors[column] = *sign);
        let mut data = RowChange::Scales(factors).apply(&self.data);
        for (&column, &by) in self.columns.iter().zip(zeros).filter(|(_, by)| **by != 0.0) {
            data = RowChange::Add(column, by).apply(&data);
        }
        let (registered, _) = self.fitter.roughly_registered(&data);
        (data, registered)
    }

    /// Zeros of an estimate with those that it began with, within half a turn.
    fn zeros(&self, estimate: &Estimate, start: &[f64]) -> Vec<f64> {
        let zero = |(joint, start): (&usize, &f64)| {
            let multiplier = self.fitter.robot.joints[*joint].reading.multiplier;
            let turned = start + estimate.coefficient(*joint, Term::OFFSET) / multiplier;
            turned - std::f64::consts::TAU * (turned / std::f64::consts::TAU).round()
        };
        self.joints.iter().zip(start).map(zero).collect()
    }
}

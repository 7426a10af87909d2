//! The product of exponentials of lou2009, and its derivatives by differences.

use nalgebra::{DMatrix, Vector3, Vector6};
use poecal_arm::lie::{Pose, Twist};
use poecal_lou2009::literal::AdjointErrors;
use poecal_lou2009::{MeasurementKind, PaperFormulation};
use poecal_model::robot::Robot;

/// Arguments of the POE formula: free twists `ξ_i`, joint values, `M` as its logarithm or `exp(Υ) M`, `P_c0`.
#[derive(Clone)]
pub(crate) struct Formula {
    twists: Vec<Twist>,
    values: Vec<f64>,
    home: Pose,
    point: Vector3<f64>,
}

impl Formula {
    pub(crate) fn new(robot: &Robot, values: &[f64]) -> Self {
        Formula {
            twists: robot.joints.iter().map(|joint| joint.screw.twist()).collect(),
            values: values.to_vec(),
            home: robot.home,
            point: robot.home.translation,
        }
    }

    /// The product of exponentials without `M`, lou2009 (2).
    fn motion(&self) -> Pose {
        (self.twists.iter().zip(&self.values))
            .fold(Pose::identity(), |before, (xi, &value)| before * Pose::exp(&Twist::new(xi.v * value, xi.w * value)))
    }
}

/// A change of the formula by a step in one unknown.
pub(crate) type Step<'a> = Box<dyn Fn(&Formula, f64) -> Formula + 'a>;

fn unit(k: usize, step: f64) -> Vector6<f64> {
    let mut vector = Vector6::zeros();
    vector[k] = step;
    vector
}

/// The unknowns in the order of lou2009 (7).
pub(crate) fn steps<'a>(
    robot: &'a Robot,
    errors: &'a AdjointErrors,
    formulation: PaperFormulation,
    seen: MeasurementKind,
) -> Vec<Step<'a>> {
    let mut steps: Vec<Step<'a>> = Vec::new();
    let joints = robot.joints.iter().enumerate();
    if formulation.has_offsets() {
        for (i, _) in joints.clone() {
            steps.push(Box::new(move |at, step| {
                let mut at = at.clone();
                at.values[i] += step;
                at
            }));
        }
    }
    let free = formulation.has_free_screws();
    for (i, joint) in joints {
        for k in 0..if free && joint.screw.is_prismatic() { 3 } else { 6 } {
            let nominal = joint.screw.twist();
            let eta = errors.eta[i].to_vector();
            steps.push(Box::new(move |at, step| {
                let mut at = at.clone();
                at.twists[i] = if free {
                    Twist::from_vector(&(at.twists[i].to_vector() + unit(k, step)))
                } else {
                    Pose::exp(&Twist::from_vector(&(eta + unit(k, step)))).transform(&nominal)
                };
                at
            }));
        }
    }
    for k in 0..if seen == MeasurementKind::Poses { 6 } else { 3 } {
        let (home, upsilon) = (robot.home, errors.upsilon.to_vector());
        steps.push(Box::new(move |at, step| {
            let mut at = at.clone();
            at.home = if free {
                Pose::exp(&Twist::from_vector(&(home.log().to_vector() + unit(k, step))))
            } else {
                Pose::exp(&Twist::from_vector(&(upsilon + unit(k, step)))) * home
            };
            if seen == MeasurementKind::Points {
                at.point[k] += step;
            }
            at
        }));
    }
    steps
}

/// Central differences of tenth order of the POE formula.
pub(crate) fn differences(at: &Formula, steps: &[Step<'_>], seen: MeasurementKind) -> DMatrix<f64> {
    const STEP: f64 = 0.01;
    let weights = [5.0 / 6.0, -5.0 / 21.0, 5.0 / 84.0, -5.0 / 504.0, 1.0 / 1260.0];
    let here = at.motion();
    let columns: Vec<Vector6<f64>> = steps
        .iter()
        .map(|change| {
            let mut sum = Vector6::zeros();
            for (k, weight) in weights.into_iter().enumerate() {
                for sign in [1.0, -1.0] {
                    let moved = change(at, sign * STEP * (k + 1) as f64);
                    let motion = moved.motion();
                    let difference = match seen {
                        MeasurementKind::Poses => (motion * moved.home * (here * at.home).inverse()).log(),
                        MeasurementKind::Points => {
                            Twist::new(motion.act(&moved.point) - here.act(&at.point), Vector3::zeros())
                        }
                    };
                    sum += difference.to_vector() * (sign * weight / STEP);
                }
            }
            sum
        })
        .collect();
    let all = DMatrix::from_fn(6, columns.len(), |row, column| columns[column][row]);
    all.rows(0, if seen == MeasurementKind::Poses { 6 } else { 3 }).into_owned()
}

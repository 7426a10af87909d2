//! Displacements of programs for the nominal robot in the workspace, and the joint corrections that compensate them.

use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};
use poecal_arm::{Arm, MOST_JOINTS};

use super::{Calibration, DeviceFrameKnowledge, Level};
use crate::trust::expected_errors::allowed_readings;
use poecal_arm::lie::{Pose, rotation};
use poecal_fit::state::PackedValues;
use poecal_fit::uncertainty::Uncertainty;
use poecal_model::offsets::{TaughtFrames, with_tool_of};
use poecal_model::robot::{Joint, JointKind, Robot};
use poecal_numerics::distributions::median;
use poecal_numerics::linalg::cholesky_6;

/// Compared configurations.
const CONFIGURATIONS: usize = 192;
/// Base and tool are fitted over every third of them.
const FITTED: usize = 3;
/// Cells along the longer side of the map, at most.
const MOST_CELLS: f64 = 14.0;
/// Configurations are spread by the fractional parts of multiples of the roots of the primes.
const PRIMES: [f64; MOST_JOINTS] =
    [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0, 47.0, 53.0];
/// Distance (m) and angle (rad) below which a pose counts as reached.
const REACHED: f64 = 1e-9;
/// Correction of a joint (rad, m) too large for a robot near its nominal model: another branch.
const FAR: f64 = 0.6;
/// Most steps of the iteration from a configuration to the corrected one.
const STEPS: usize = 8;
/// Fewest readings of an arm that can compensate every displacement.
const FREE: usize = 6;

/// Displacement of the actual robot's tip from the nominal one's, `(B FK_nominal(q) T)⁻¹ FK_actual(q)`, over the sampled workspace. Base B and tool T
/// are taught on the actual robot, so that the joints alone cause the displacement. A program is corrected by readings `q'` with
/// `FK_actual(q') = B FK_nominal(q) T`.
pub struct Workspace {
    /// Name of the joint on whose axis the map is centred; `None` is the base's z axis.
    pub about: Option<String>,
    /// Side of the cells, metres.
    pub cell_m: f64,
    /// The cells, by height and then by distance.
    pub cells: Vec<WorkspaceCell>,
    /// All configurations together.
    pub all: Displacements,
    /// Median and largest correction of each reading that moves the tip (rad, m), over configurations with a correction near the intended one. Empty
    /// for an arm with fewer than six, which cannot compensate every displacement.
    pub joints: Vec<(String, JointKind, ValueSpread)>,
    /// Configurations whose displacement is smaller than the expected error of the calibration itself.
    pub needless: usize,
    /// Configurations with a corrected reading beyond the limits.
    pub beyond_limits: usize,
    /// Configurations from which no small correction leads to the pose, because of a near singularity.
    pub unmended: usize,
}

/// A part of the workspace.
pub struct WorkspaceCell {
    /// Lower end of the distance of the nominal tip from the axis, metres.
    pub radius_m: f64,
    /// Lower end of its height along the axis above the base's origin, metres.
    pub height_m: f64,
    pub displaced: Displacements,
    /// Expected error of predictions here (root mean square, metres), `sqrt(mean tr P_p)` of theory.md §9 (40).
    pub expected_m: Option<f64>,
}

/// Displacements of some configurations.
pub struct Displacements {
    /// Number of configurations.
    pub configurations: usize,
    /// Distances, metres.
    pub position_m: ValueSpread,
    /// Angles, radians.
    pub rotation_rad: ValueSpread,
}

/// Median and largest of some values.
#[derive(Clone, Copy, Debug, Default)]
pub struct ValueSpread {
    /// Median: half of the values are smaller.
    pub median: f64,
    /// The largest value.
    pub largest: f64,
}

impl ValueSpread {
    fn from_values(values: impl Iterator<Item = f64> + Clone) -> Self {
        ValueSpread { largest: values.clone().fold(0.0, f64::max), median: median(values).unwrap_or(0.0) }
    }
}

impl Displacements {
    fn from_comparisons<'a>(places: impl Iterator<Item = &'a ComparedConfiguration> + Clone) -> Self {
        Displacements {
            configurations: places.clone().count(),
            position_m: ValueSpread::from_values(places.clone().map(|it| it.moved_m)),
            rotation_rad: ValueSpread::from_values(places.map(|it| it.turned_rad)),
        }
    }
}

/// Displacements over the sampled workspace; `None` for a calibration that must not be used, for one whose axes were held, and for robots whose tip
/// some joint does not move.
pub fn workspace(calibration: &Calibration) -> Option<Workspace> {
    if calibration.verdict.level <= Level::Located {
        return None;
    }
    let trust = &calibration.trust;
    let (actual, expected, uncertainty) = match calibration.correction.as_deref().filter(|it| it.has_terms()) {
        Some(found) => (&found.robot, &found.expected, found.uncertainty.as_ref()),
        None => (&calibration.robot, &trust.expected, trust.uncertainty.as_ref()),
    };
    let nominal = with_tool_of(actual, &calibration.nominal)?;
    let (nominal_arm, readings) = nominal.arm(&[]).ok()?;
    let (actual_arm, own) = actual.arm(&[]).ok()?;
    let allowed = sampled_ranges(calibration, &nominal, &readings)?;
    if own != readings {
        return None;
    }
    let arms = ArmPair { nominal: &nominal_arm, actual: &actual_arm };
    let sample: Vec<Vec<f64>> = (0..CONFIGURATIONS).map(|index| configuration(index, &allowed)).collect();
    let tips: Vec<(Pose, Pose)> = sample.iter().map(|q| arms.tips(q)).collect();
    let base_is_known = calibration.frame == DeviceFrameKnowledge::Base;
    let fitted: Vec<(Pose, Pose)> = tips.iter().step_by(FITTED).copied().collect();
    let taught = TaughtFrames::from_tips(&fitted, nominal.arm_m() / 3.0, base_is_known);
    let (axis, about) = axis_of(&nominal);
    let mut compared: Vec<ComparedConfiguration> = sample
        .iter()
        .zip(&tips)
        .map(|(q, (nominal, actual))| arms.compare(q, &taught.tip(nominal), actual, &axis))
        .collect();
    if let Some(uncertainty) = uncertainty {
        let squares = expected_squares(actual, &readings, &sample, uncertainty);
        compared.iter_mut().zip(squares).for_each(|(it, square)| it.expected_m2 = Some(square));
    }
    let is_free = readings.len() >= FREE;
    let expected_m = expected.measured.map_or(REACHED, |it| it.sigma_m);
    let cell_m = cell(&compared);
    let cells = cells(&mut compared, cell_m);
    let names = nominal.reading_names();
    let of_joint = |(index, &reading): (usize, &usize)| {
        let name = names.get(reading)?.clone();
        let kind = nominal.joints.iter().find(|joint| joint.reading.name == name)?.kind;
        let changes = compared.iter().filter_map(|it| it.mended.as_ref()?.get(index).copied());
        Some((name, kind, ValueSpread::from_values(changes)))
    };
    Some(Workspace {
        about,
        cell_m,
        cells,
        all: Displacements::from_comparisons(compared.iter()),
        joints: readings.iter().enumerate().filter(|_| is_free).filter_map(of_joint).collect(),
        needless: compared.iter().filter(|it| it.moved_m <= expected_m).count(),
        beyond_limits: compared.iter().filter(|it| it.is_beyond_limits).count(),
        unmended: compared.iter().filter(|it| is_free && it.mended.is_none()).count(),
    })
}

/// The cells of the workspace that contain configurations; sorts the configurations by cell.
fn cells(compared: &mut [ComparedConfiguration], cell_m: f64) -> Vec<WorkspaceCell> {
    let at = |it: &ComparedConfiguration| [it.height_m, it.radius_m].map(|value| (value / cell_m).floor() as i64);
    compared.sort_by_key(at);
    let cell = |own: &[ComparedConfiguration]| {
        let [height, radius] = at(own.first()?);
        let squares = own.iter().map(|it| it.expected_m2).sum::<Option<f64>>();
        Some(WorkspaceCell {
            radius_m: radius as f64 * cell_m,
            height_m: height as f64 * cell_m,
            displaced: Displacements::from_comparisons(own.iter()),
            expected_m: squares.map(|sum| (sum / own.len() as f64).sqrt()),
        })
    };
    compared.chunk_by(|one, other| at(one) == at(other)).filter_map(cell).collect()
}

/// Mean square errors of predicted positions (of the first target, or the tip) in configurations of these readings.
fn expected_squares(robot: &Robot, readings: &[usize], sample: &[Vec<f64>], uncertainty: &Uncertainty) -> Vec<f64> {
    let indices = robot.reading_indices();
    let mut values = Vec::with_capacity(sample.len() * indices.len());
    for q in sample {
        let of = |index: usize| readings.iter().position(|&own| own == index).and_then(|k| q.get(k)).copied();
        let joints = robot.joints.iter().zip(&indices);
        values.extend(joints.map(|(joint, &index)| joint.reading.value(of(index).unwrap_or_default())));
    }
    uncertainty.positions(&PackedValues::of_values(robot, &values), 0).iter().map(Matrix3::trace).collect()
}

/// Sampled range of each of these readings; `None` if one has none.
fn sampled_ranges(calibration: &Calibration, nominal: &Robot, readings: &[usize]) -> Option<Vec<[f64; 2]>> {
    let ranges: Vec<[f64; 2]> = calibration.trust.coverage.iter().map(|it| [it.sampled_min, it.sampled_max]).collect();
    let allowed = allowed_readings(nominal, &ranges);
    let own = readings.iter().map(|&it| allowed.get(it).copied().filter(|ends| ends.iter().all(|end| end.is_finite())));
    own.collect()
}

/// A configuration of the sample, spread evenly over these ranges.
fn configuration(index: usize, allowed: &[[f64; 2]]) -> Vec<f64> {
    let value =
        |([least, most], prime): (&[f64; 2], f64)| least + (most - least) * (0.5 + index as f64 * prime.sqrt()).fract();
    allowed.iter().zip(PRIMES).map(value).collect()
}

/// Axis of the map.
struct MapAxis {
    point: Vector3<f64>,
    direction: Vector3<f64>,
}

impl MapAxis {
    /// Distance of a position from the axis, and height above the base's origin along it.
    fn cylindrical(&self, place: &Vector3<f64>) -> (f64, f64) {
        let from_axis = place - self.point;
        let along = self.direction.dot(&from_axis);
        ((from_axis - self.direction * along).norm(), self.direction.dot(place))
    }
}

/// The axis of the first joint, if it turns, pointing up; else the base's z axis.
fn axis_of(robot: &Robot) -> (MapAxis, Option<String>) {
    let first = robot.joints_to(robot.tip_body()).first().and_then(|&joint| robot.joints.get(joint));
    match first {
        Some(Joint { name, kind: JointKind::Revolute, screw, .. }) => {
            let direction = if screw.w().z < 0.0 { -screw.w() } else { screw.w() };
            (MapAxis { point: screw.w().cross(&screw.v()), direction }, Some(name.clone()))
        }
        _ => (MapAxis { point: Vector3::zeros(), direction: Vector3::z() }, None),
    }
}

/// Side of the cells of a map: 1, 2 or 5 times a power of ten.
fn cell(compared: &[ComparedConfiguration]) -> f64 {
    let span = |of: fn(&ComparedConfiguration) -> f64| {
        let values = compared.iter().map(of);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    // A robot whose tip does not move has one cell.
    let least = (span(|it| it.radius_m).max(span(|it| it.height_m)) / MOST_CELLS).max(1e-3);
    let power = 10f64.powf(least.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= least);
    factor.unwrap_or(10.0) * power
}

/// The two arms.
struct ArmPair<'a> {
    nominal: &'a Arm,
    actual: &'a Arm,
}

/// A compared configuration.
struct ComparedConfiguration {
    /// Intended position of the tip: distance from the axis, height along it.
    radius_m: f64,
    height_m: f64,
    moved_m: f64,
    turned_rad: f64,
    /// Sizes of the corrections, if small ones exist.
    mended: Option<Vec<f64>>,
    is_beyond_limits: bool,
    /// Expected mean square error of a prediction here, square metres.
    expected_m2: Option<f64>,
}

impl ArmPair<'_> {
    fn tips(&self, q: &[f64]) -> (Pose, Pose) {
        (self.nominal.forward_kinematics(q), self.actual.forward_kinematics(q))
    }

    /// Compares the actual tip with its intended pose.
    fn compare(&self, q: &[f64], meant: &Pose, actual: &Pose, axis: &MapAxis) -> ComparedConfiguration {
        let (radius_m, height_m) = axis.cylindrical(&meant.translation);
        let (moved_m, turned_rad) = actual.distance_and_angle(meant);
        let found = ComparedConfiguration {
            radius_m,
            height_m,
            moved_m,
            turned_rad,
            mended: None,
            is_beyond_limits: false,
            expected_m2: None,
        };
        if q.len() < FREE {
            return found;
        }
        let Some(mended) = self.correct_configuration(q, meant) else { return found };
        let changes = mended.iter().zip(q).map(|(to, from)| (to - from).abs());
        let is_near = self.nominal.handedness(&mended) * self.nominal.handedness(q) >= 0.0;
        let is_within =
            |q: &[f64]| q.iter().zip(self.actual.limits()).all(|(q, (low, high))| (low..=high).contains(&q));
        ComparedConfiguration {
            is_beyond_limits: is_near && is_within(q) && !is_within(&mended),
            mended: is_near.then(|| changes.collect()),
            ..found
        }
    }

    /// The configuration near this one with the actual tip at its intended pose: Newton's iteration by the least changes, `q ← q + Jᵀ (J Jᵀ)⁻¹ e`;
    /// `None` if it does not end near.
    fn correct_configuration(&self, q: &[f64], meant: &Pose) -> Option<Vec<f64>> {
        let reach = self.actual.reach_m();
        let mut mended = q.to_vec();
        for _ in 0..STEPS {
            let tip = self.actual.forward_kinematics(&mended);
            let shift = meant.translation - tip.translation;
            let turn: Vector3<f64> = rotation::log(&(meant.rotation * tip.rotation.transpose()));
            if shift.norm() <= REACHED && turn.norm() <= REACHED {
                return Some(mended);
            }
            let columns: Vec<Vector6<f64>> = self.actual.jacobian(&mended)[..q.len()]
                .iter()
                .map(|(v, w)| {
                    let v = v / reach;
                    Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
                })
                .collect();
            let mut products = Matrix6::identity() * f64::EPSILON;
            columns.iter().for_each(|column| products += column * column.transpose());
            let left = shift / reach;
            let step = cholesky_6(products)?.solve(&Vector6::new(left.x, left.y, left.z, turn.x, turn.y, turn.z));
            for (value, column) in mended.iter_mut().zip(&columns) {
                *value += column.dot(&step);
            }
            if !mended.iter().zip(q).all(|(to, from)| (to - from).abs() <= FAR) {
                return None;
            }
        }
        None
    }
}

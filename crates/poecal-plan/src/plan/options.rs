//! Options of a plan.

use nalgebra::Vector3;

use super::conditions::Conditions;
use super::rows::{PlannedRow, RowPurpose};
use poecal_fit::analysis::PlannedSession;
use poecal_model::robot::{Corrections, Tolerance};
use poecal_model::simulate::SessionKind;

/// Default position of the first of several targets, metres.
const NEST_M: [f64; 3] = [0.05, 0.0, 0.0];
/// Number of drawn candidates if none are supplied.
const CANDIDATES: usize = 2000;

/// The future fit of planned measurements: the measurements, and the priors.
///
/// ```
/// use poecal_plan::plan::PlannedFit;
/// assert_eq!(PlannedFit::default().count, 30);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedFit {
    /// Kind and noise of the measurements, and the choice of an unknown device frame.
    pub session: PlannedSession,
    /// Number of different configurations.
    pub count: usize,
    /// Prior of the axes ([`poecal_calibrate::CalibrationOptions::tolerance`]).
    pub tolerance: Option<Tolerance>,
    /// Expected joint terms, which will be fitted for the corrected model; of the common sizes unless sizes are stated.
    pub corrections: Corrections,
    /// Direction of gravity, in the base frame.
    pub gravity: Vector3<f64>,
    /// Error of the tip that remains for any number of measurements; 0.3 mm for each metre of reach if unknown.
    pub robot_error: Option<RobotError>,
    /// Number of targets of a nest at the tip, all measured in each configuration.
    pub targets: usize,
    /// Position of the first target in the tip's frame, metres, the others turned about its z; `None` plans for the targets of the model.
    pub target_offset: Option<Vector3<f64>>,
}

impl Default for PlannedFit {
    /// Points with 0.05 mm in 30 configurations.
    fn default() -> Self {
        PlannedFit {
            session: PlannedSession { kind: SessionKind::POINT, ..PlannedSession::default() },
            count: 30,
            tolerance: Some(Tolerance::default()),
            corrections: Corrections::Auto,
            gravity: -Vector3::z(),
            robot_error: None,
            targets: 1,
            target_offset: None,
        }
    }
}

/// Options of a plan.
///
/// ```
/// use poecal_plan::plan::{PlanOptions, PlannedFit, plan};
/// use poecal_model::simulate::elbow;
/// let options = PlanOptions { fit: PlannedFit { count: 12, ..Default::default() }, candidates: 200, ..Default::default() };
/// let found = plan(&elbow(), &options)?;
/// assert_eq!(found.rows.iter().filter(|row| !row.returns && row.part == poecal_plan::plan::RowPurpose::Fit).count(), 12);
/// assert!(found.expected.calibrated_m() < found.random.calibrated_m());
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PlanOptions {
    /// The future fit.
    pub fit: PlannedFit,
    /// Criterion of the list.
    pub criterion: PlanCriterion,
    /// Configurations to choose from, readings one after the other; if there are none, random ones are drawn and improved.
    pub list: Option<Vec<f64>>,
    /// Number of drawn candidates.
    pub candidates: usize,
    /// Configurations of the robot's work, in which predictions shall be good; random ones within the limits if there are none.
    pub workspace: Option<Vec<f64>>,
    /// Number of random judging rows; by default a third of the configurations.
    pub judge: Option<usize>,
    /// Conditions of measurement.
    pub conditions: Conditions,
    /// Existing rows: those to fit count, those that return to an earlier one do not.
    pub kept: Vec<PlannedRow>,
    /// Indices of kept rows that could not be measured: new ones replace them, not within 10° of them, and the plan has all rows in their order.
    pub replaced: Vec<usize>,
    /// True if lists of other lengths are planned too, which shows the sufficient number and takes as long as the list.
    pub with_curve: bool,
    /// Seed of random choices.
    pub seed: u64,
}

impl Default for PlanOptions {
    fn default() -> Self {
        PlanOptions {
            fit: PlannedFit::default(),
            criterion: PlanCriterion::Expected,
            list: None,
            candidates: CANDIDATES,
            workspace: None,
            judge: None,
            conditions: Conditions::default(),
            kept: Vec::new(),
            replaced: Vec::new(),
            with_curve: true,
            seed: 1,
        }
    }
}

impl PlanOptions {
    /// Readings of the kept configurations to fit that stay, one after the other.
    #[must_use]
    pub fn fitted_readings(&self) -> Vec<f64> {
        let replaced = self.replaced_rows();
        let stays = |row: &&PlannedRow| {
            row.part == RowPurpose::Fit && !row.returns && replaced.iter().all(|it| it.readings != row.readings)
        };
        self.kept.iter().filter(stays).flat_map(|row| row.readings.clone()).collect()
    }

    /// The rows that are replaced: for a row that returns, the one to which it returns.
    pub(crate) fn replaced_rows(&self) -> Vec<&PlannedRow> {
        let mut found: Vec<&PlannedRow> = Vec::new();
        for row in self.replaced.iter().filter_map(|&at| self.kept.get(at)) {
            let first = self.kept.iter().find(|it| it.readings == row.readings).unwrap_or(row);
            if !found.iter().any(|it| it.readings == first.readings) {
                found.push(first);
            }
        }
        found
    }

    /// Readings of the rows that are replaced, one after the other.
    pub(crate) fn avoided_readings(&self) -> Vec<f64> {
        self.replaced_rows().into_iter().flat_map(|row| row.readings.clone()).collect()
    }

    /// Number of new configurations of a part: those that complete the kept ones, or those that replace rows.
    pub(crate) fn new_of(&self, part: RowPurpose, kept: usize) -> usize {
        if self.replaced.is_empty() {
            return match part {
                RowPurpose::Fit => self.fit.count.saturating_sub(kept),
                RowPurpose::Judge => self.judge.unwrap_or(self.fit.count.div_ceil(3)),
            };
        }
        self.replaced_rows().iter().filter(|row| row.part == part).count()
    }
}

impl PlannedFit {
    /// The fit with this number of targets at the tip, the first at an offset, metres; several without an offset are beside the flange.
    #[must_use]
    pub fn with_targets(self, targets: usize, offset_m: Option<[f64; 3]>) -> Self {
        let offset_m = offset_m.or((targets > 1).then_some(NEST_M));
        PlannedFit { targets, target_offset: offset_m.map(Vector3::from), ..self }
    }
}

/// Root mean square error of the tip that a calibration leaves for any number of measurements, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotError {
    /// Error of the calibrated model: the part that no geometry describes.
    pub calibrated_m: f64,
    /// Error of the corrected model: the part that neither geometry nor joint terms describe. If unknown, it is the rest of the former beyond terms
    /// of the common sizes, and at least 0.4 of it.
    pub corrected_m: Option<f64>,
}

/// Criterion of a list of configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum PlanCriterion {
    /// Expected squared error of the tip over the workspace, of the calibrated and of the corrected model, each relative to that of random
    /// configurations.
    #[default]
    Expected,
    /// Determinant of geometry's information.
    D,
    /// Mean variance of geometry's unknowns.
    A,
    /// Largest variance of geometry's unknowns.
    E,
    /// Largest variance of a prediction in the workspace.
    G,
}

impl PlanCriterion {
    /// All criteria with their words.
    pub const WORDS: [(&'static str, PlanCriterion); 5] = [
        ("expected", PlanCriterion::Expected),
        ("D", PlanCriterion::D),
        ("A", PlanCriterion::A),
        ("E", PlanCriterion::E),
        ("G", PlanCriterion::G),
    ];

    /// Word of the criterion.
    #[must_use]
    pub fn word(self) -> &'static str {
        Self::WORDS.into_iter().find(|it| it.1 == self).map_or("expected", |it| it.0)
    }
}

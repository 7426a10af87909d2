//! Rows of a test, and the cells that they belong to.

use nalgebra::{Matrix3, Vector3};

use super::intervals::mean_and_covariance;
use poecal_arm::lie::Pose;
use poecal_numerics::distributions::median;

/// Commanded positions (metres) within this belong to one pose.
const SAME_M: f64 = 2e-5;

/// Words of a row that say what was done; empty where a file does not state them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TestLabels {
    /// The pose, like `P1`.
    pub pose: String,
    /// The cycle.
    pub cycle: String,
    /// The path on which the pose was approached.
    pub approach: String,
    /// The series of cycles, of a drift test.
    pub series: String,
    /// The arm, of a test of exchangeability.
    pub arm: String,
    /// Speed, as stated.
    pub speed: String,
    /// Load, as stated.
    pub payload: String,
}

/// A row of a test: where the target was commanded to be, and where it was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct TestRow {
    /// Commanded `base_from_target`.
    pub commanded: Pose,
    /// The same by a calibrated model of the arm.
    pub calibrated: Option<Pose>,
    /// Measured position of the target in the device frame, metres.
    pub position_m: Vector3<f64>,
    /// Measured orientation `device_from_target`, if there is one.
    pub rotation: Option<Matrix3<f64>>,
    /// Standard deviations of the instrument's noise, each component, if stated: metres, radians.
    pub noise: [Option<f64>; 2],
    /// Labels of the row.
    pub labels: TestLabels,
    /// File and line, for messages.
    pub place: String,
}

/// Rows of one pose, arm, approach and series.
#[derive(Clone, Debug)]
pub(super) struct PoseCell<'a> {
    pub(super) pose: String,
    pub(super) labels: &'a TestLabels,
    pub(super) rows: Vec<&'a TestRow>,
}

/// All cells. The base cells are those of the first row's arm, approach and series: one for each pose.
#[derive(Clone, Debug)]
pub(super) struct PoseCells<'a> {
    pub(super) base: Vec<PoseCell<'a>>,
    pub(super) others: Vec<PoseCell<'a>>,
}

impl<'a> PoseCells<'a> {
    /// Sorts rows; poses without a name are told apart by their commanded positions.
    pub(super) fn from_rows(rows: &'a [TestRow]) -> Self {
        let mut unnamed: Vec<Vector3<f64>> = Vec::new();
        let mut cells: Vec<PoseCell<'a>> = Vec::new();
        for row in rows {
            let pose = if row.labels.pose.is_empty() {
                let own = row.commanded.translation;
                let known = unnamed.iter().position(|it| (it - own).norm() < SAME_M);
                let at = known.unwrap_or_else(|| {
                    unnamed.push(own);
                    unnamed.len() - 1
                });
                format!("P{}", at + 1)
            } else {
                row.labels.pose.clone()
            };
            match cells.iter_mut().find(|it| it.pose == pose && it.is_like(&row.labels)) {
                Some(cell) => cell.rows.push(row),
                None => cells.push(PoseCell { pose, labels: &row.labels, rows: vec![row] }),
            }
        }
        let first = cells.first().map(|it| it.labels);
        let (mut base, others): (Vec<_>, Vec<_>) =
            cells.into_iter().partition(|it| first.is_some_and(|first| it.is_like(first)));
        base.sort_by(|a, b| a.pose.cmp(&b.pose));
        PoseCells { base, others }
    }

    /// True if all base rows have orientations.
    pub(super) fn have_rotations(&self) -> bool {
        self.base.iter().flat_map(|it| &it.rows).all(|row| row.rotation.is_some())
    }
}

impl PoseCell<'_> {
    /// True if rows with these labels are of the same arm, approach and series.
    fn is_like(&self, labels: &TestLabels) -> bool {
        let of = |it: &TestLabels| [it.arm.clone(), it.approach.clone(), it.series.clone()];
        of(self.labels) == of(labels)
    }

    pub(super) fn count(&self) -> usize {
        self.rows.len()
    }

    /// Barycentre (metres) and covariance of the measured positions, device frame.
    pub(super) fn barycentre(&self) -> (Vector3<f64>, Matrix3<f64>) {
        mean_and_covariance(self.rows.iter().map(|row| row.position_m))
    }

    /// Mean commanded pose: rows of one command differ by rounding.
    pub(super) fn commanded_pose(&self) -> Pose {
        self.mean_pose(|row| Some(row.commanded)).unwrap_or_else(Pose::identity)
    }

    /// The same by the calibrated model.
    pub(super) fn calibrated_pose(&self) -> Option<Pose> {
        self.mean_pose(|row| row.calibrated)
    }

    fn mean_pose(&self, of: impl Fn(&TestRow) -> Option<Pose>) -> Option<Pose> {
        let poses: Vec<Pose> = self.rows.iter().map(|row| of(row)).collect::<Option<_>>()?;
        let places = poses.iter().map(|it| it.translation).sum::<Vector3<f64>>();
        poses.first().map(|first| Pose::new(first.rotation, places / poses.len() as f64))
    }

    /// Mean variance of the instrument's noise, of positions (0) or rotations (1), if every row states it.
    pub(super) fn noise_variance(&self, quantity: usize) -> Option<f64> {
        let squares = self.rows.iter().map(|row| row.noise[quantity].map(|it| it * it));
        Some(squares.sum::<Option<f64>>()? / self.count() as f64)
    }

    /// Median position, and the median distance of rows from it, metres.
    pub(super) fn middle(&self) -> (Vector3<f64>, f64) {
        let places: Vec<Vector3<f64>> = self.rows.iter().map(|row| row.position_m).collect();
        let middle = poecal_numerics::distributions::median_point(&places);
        (middle, median(places.iter().map(|it| (it - middle).norm())).unwrap_or(0.0))
    }
}

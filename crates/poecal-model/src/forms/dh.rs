//! Tables of Denavit and Hartenberg, Craig, and Hayati.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::AxisFrames;
use super::frames::along_axis;
use crate::robot::{JointKind, Robot};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Axes whose directions differ by less are parallel.
const PARALLEL: f64 = 1e-12;
/// Sine of the angle between two axes below which they are nearly parallel: their row is Hayati's.
const NEARLY_PARALLEL: f64 = 0.1;
/// Number of reaches beyond which no controller takes an offset along an axis.
const MOST_REACHES: f64 = 10.0;

/// Convention of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DhConvention {
    /// Denavit and Hartenberg.
    Standard,
    /// Craig.
    Modified,
    /// Denavit and Hartenberg, with Hayati's row between axes that are nearly parallel.
    Hayati,
}

impl DhConvention {
    /// Motion of a row, with the joint's value within theta of a revolute joint and within d of a prismatic one.
    #[must_use]
    pub fn formula(self) -> &'static str {
        match self {
            DhConvention::Standard => "Rz(theta) Tz(d) Tx(a) Rx(alpha)",
            DhConvention::Modified => "Rx(alpha) Tx(a) Rz(theta) Tz(d)",
            DhConvention::Hayati => "dh: Rz(theta) Tz(d) Tx(a) Rx(alpha); hayati: Rz(theta) Tx(a) Rx(alpha) Ry(beta)",
        }
    }
}

/// Set of the four numbers of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowKind {
    /// theta, d, a, alpha.
    Dh,
    /// theta, a, alpha, beta.
    Hayati,
}

/// A row: the motion from one joint's frame to the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DhEntry {
    /// Name of the joint.
    pub joint: String,
    /// Kind of the joint.
    pub kind: JointKind,
    /// Set of the numbers.
    pub row: RowKind,
    /// Angle about z at a joint value of zero, radians.
    pub theta_rad: f64,
    /// Shift along z at a joint value of zero, metres.
    pub d_m: f64,
    /// Shift along x, metres.
    pub a_m: f64,
    /// Angle about x, radians.
    pub alpha_rad: f64,
    /// Angle about y, radians; zero in a row of Denavit and Hartenberg.
    pub beta_rad: f64,
}

impl DhEntry {
    fn new(joint: &str, kind: JointKind) -> Self {
        let row = RowKind::Dh;
        let joint = joint.to_owned();
        DhEntry { joint, kind, row, theta_rad: 0.0, d_m: 0.0, a_m: 0.0, alpha_rad: 0.0, beta_rad: 0.0 }
    }

    /// Motion about z and along z.
    fn of_joint(&self) -> Pose {
        Pose::new(rotation::about(2, self.theta_rad), Vector3::z() * self.d_m)
    }

    /// Motion along x, about x, about y.
    fn of_link(&self) -> Pose {
        let turn = rotation::about(0, self.alpha_rad) * rotation::about(1, self.beta_rad);
        Pose::new(turn, Vector3::x() * self.a_m)
    }
}

/// A serial robot by a table of rows: the motion from base to tip is `B · rows · E`, with the joint values within the rows.
#[derive(Clone, Debug, PartialEq)]
pub struct DhTable {
    /// Convention of the rows.
    pub convention: DhConvention,
    /// Frame of the first row in the base.
    pub base_from_first: Pose,
    /// A row for each joint.
    pub rows: Vec<DhEntry>,
    /// The tip in the frame after the last row.
    pub last_from_tip: Pose,
}

impl DhTable {
    /// Table of a robot.
    ///
    /// # Errors
    /// [`ErrorKind::Export`] as [`AxisFrames::from_robot`], and if a row of Denavit and Hartenberg between nearly parallel axes would have an offset of
    /// more than ten reaches.
    pub fn from_robot(robot: &Robot, convention: DhConvention) -> Result<Self> {
        // The call refuses the same robots, and absorbs offsets of readings.
        let plain = AxisFrames::from_robot(robot)?.robot(robot)?;
        let frames: Vec<Pose> = plain.joints.iter().map(along_axis).collect();
        let kinds: Vec<JointKind> = plain.joints.iter().map(|joint| joint.kind).collect();
        let points = points(&frames, &kinds);
        let reach_m = plain.reach_m();
        let first = frames.first().copied().unwrap_or_else(Pose::identity);
        let base_from_first = Pose::new(first.rotation, points.first().copied().unwrap_or_default());
        let mut current = base_from_first;
        let mut rows = Vec::with_capacity(frames.len());
        for (at, joint) in plain.joints.iter().enumerate() {
            let mut row = DhEntry::new(&joint.name, joint.kind);
            if let (Some(next), Some(point)) = (frames.get(at + 1), points.get(at + 1)) {
                let to_row = current.inverse();
                let axis = to_row.rotation * next.rotation.column(2);
                let point = match joint.kind {
                    JointKind::Revolute => point,
                    JointKind::Prismatic => &points[at],
                };
                row.lead_to(convention, &to_row.act(point), &axis);
                if row.d_m.abs() > MOST_REACHES * reach_m {
                    return Err(too_far(&row, &plain.joints[at + 1].name, reach_m));
                }
            }
            current = current * row.of_joint() * row.of_link();
            rows.push(row);
        }
        let last_from_tip = current.inverse() * plain.home;
        if convention == DhConvention::Modified {
            // Craig's row has the link before the joint.
            let mut link = (0.0, 0.0);
            for row in &mut rows {
                let own = (row.a_m, row.alpha_rad);
                (row.a_m, row.alpha_rad) = link;
                link = own;
            }
        }
        Ok(DhTable { convention, base_from_first, rows, last_from_tip })
    }

    /// The same robot by frames with z along each axis.
    #[must_use]
    pub fn frames(&self) -> AxisFrames {
        let mut joints = Vec::with_capacity(self.rows.len());
        // The factor after the joint before.
        let mut before = self.base_from_first;
        for row in &self.rows {
            let (joint, link) = (row.of_joint(), row.of_link());
            match self.convention {
                DhConvention::Standard | DhConvention::Hayati => {
                    joints.push(before * joint);
                    before = link;
                }
                DhConvention::Modified => {
                    joints.push(before * link * joint);
                    before = Pose::identity();
                }
            }
        }
        AxisFrames { joints, last_from_tip: before * self.last_from_tip }
    }
}

/// A point on each axis. For a revolute joint it is that of its frame. A prismatic joint has no position: its point is on the next axis, so
/// that the two meet.
fn points(frames: &[Pose], kinds: &[JointKind]) -> Vec<Vector3<f64>> {
    let mut points: Vec<Vector3<f64>> = frames.iter().map(|frame| frame.translation).collect();
    for at in (0..frames.len().saturating_sub(1)).rev() {
        if kinds[at] == JointKind::Prismatic {
            let (own, next) = (frames[at].translation, points[at + 1]);
            let along = frames[at + 1].rotation.column(2).into_owned();
            points[at] = next + along * along.dot(&(own - next));
        }
    }
    points
}

impl DhEntry {
    /// Sets the numbers that lead from the joint's frame to one on the next axis, which goes through a point along a direction there. For a
    /// prismatic joint the point is the intersection of its axis with the next.
    fn lead_to(&mut self, convention: DhConvention, point: &Vector3<f64>, axis: &Vector3<f64>) {
        let across = Vector3::z().cross(axis);
        let sine = across.norm();
        let turns = self.kind == JointKind::Revolute;
        if convention == DhConvention::Hayati && turns && (PARALLEL..NEARLY_PARALLEL).contains(&sine) {
            self.row = RowKind::Hayati;
            let through = point - axis * (point.z / axis.z);
            (self.a_m, self.theta_rad) = to_polar(&through);
            let seen = rotation::about(2, -self.theta_rad) * axis;
            self.beta_rad = seen.x.clamp(-1.0, 1.0).asin();
            self.alpha_rad = (-seen.y).atan2(seen.z);
            return;
        }
        let normal = (sine >= PARALLEL).then(|| across / if across.x < 0.0 { -sine } else { sine });
        match (turns, &normal) {
            // The two meet in the point.
            (false, _) => self.d_m = point.z,
            (true, None) => (self.a_m, self.theta_rad) = to_polar(point),
            (true, Some(normal)) => {
                // Feet of the common normal.
                let foot = |other: &Vector3<f64>| point.cross(other).dot(&across) / (sine * sine);
                self.d_m = foot(axis);
                self.a_m = (point + axis * foot(&Vector3::z())).dot(normal);
            }
        }
        match normal {
            Some(normal) => {
                self.theta_rad = normal.y.atan2(normal.x);
                self.alpha_rad = across.dot(&normal).atan2(axis.z);
            }
            None if axis.z < 0.0 => self.alpha_rad = std::f64::consts::PI,
            None => {}
        }
    }
}

/// Distance from z, and the angle about it.
fn to_polar(point: &Vector3<f64>) -> (f64, f64) {
    let distance = point.x.hypot(point.y);
    if distance < PARALLEL { (0.0, 0.0) } else { (distance, point.y.atan2(point.x)) }
}

fn too_far(row: &DhEntry, next: &str, reach_m: f64) -> Error {
    ErrorKind::Export.error(format!(
        "found axes of `{}` and `{next}` that are nearly parallel, whose row of Denavit and Hartenberg needs d = {:.1} m ({:.0} times the reach), \
         expected at most ten: take `--format hayati`, which has another row there, or `poe`",
        row.joint,
        row.d_m,
        (row.d_m / reach_m).abs()
    ))
}

//! Position and orientation of a frame.

use nalgebra::{Matrix3, Vector3};

use super::FunctionRow;
use super::point::XYZ;
use crate::measurement::session::{MeasurementOrigin, RandomDraws, SessionKind, SessionTraits, StationLayout};
use crate::measurement::{
    Channel, Channels, InitialGuess, Kernel, MeasuredValues, Measurement, MeasurementFunction, Quantity,
};
use poecal_arm::lie::{Freedom, Pose, hat, rotation, series};

/// Channels of a pose: position, then rotation vector.
static FRAME: Channels = Channels::new(&[
    XYZ[0],
    XYZ[1],
    XYZ[2],
    Channel { name: "rx", quantity: Quantity::Rotation },
    Channel { name: "ry", quantity: Quantity::Rotation },
    Channel { name: "rz", quantity: Quantity::Rotation },
]);

/// Measured frame, `e = [y - p; log(Y Rᵀ)]` at the target and in the device's axes (theory.md §4 (16)). The rotation rows of the sensitivity
/// are `J_r(r)⁻¹`, exact also for large residuals `r = log(Y Rᵀ)`.
static POSE: MeasurementFunction = MeasurementFunction {
    name: "pose",
    plural: "poses",
    quantities: &[Quantity::Position, Quantity::Rotation],
    channels: |_| &FRAME,
    residual: |values, predicted, out| {
        let pose = frame(values);
        let turn = rotation::log(&(pose.rotation * predicted.rotation.transpose()));
        out[..3].copy_from_slice((pose.translation - predicted.translation).as_slice());
        out[3..6].copy_from_slice(turn.as_slice());
    },
    sensitivity: |values, predicted, out| {
        // Y (exp(ω̂) R)ᵀ = exp(r̂) exp(-ω̂), so r moves by -J_r(r)⁻¹ ω; J_r(r)⁻¹ = I + r̂/2 + cotc r̂².
        let r = rotation::log(&(frame(values).rotation * predicted.rotation.transpose()));
        let hat_r = hat(&r);
        let turn = Matrix3::identity() + hat_r * 0.5 + hat_r * hat_r * series::cotc(r.norm_squared());
        for k in 0..3 {
            (out[k], out[3 + k]) = ([0.0; 6], [0.0; 6]);
            out[k][k] = 1.0;
            for (number, value) in out[3 + k][3..].iter_mut().zip(turn.row(k).iter()) {
                *number = *value;
            }
        }
    },
    is_wrench: true,
    lengths: 3,
    kernel: Kernel::Pose,
    target_freedom: |_| Freedom::FRAME,
    clue: |values| InitialGuess::Frame(frame(values)),
    ..MeasurementFunction::USUAL
};

#[inline]
fn frame(values: &MeasuredValues) -> Pose {
    let [x, y, z, columns @ ..] = values;
    Pose::new(Matrix3::from_column_slice(columns), Vector3::new(*x, *y, *z))
}

pub(crate) const ROW: FunctionRow = FunctionRow { function: &POSE, columns: &[], sessions: &[POSES, MIXED, RELATIVE] };

const POSES: SessionTraits = SessionTraits {
    word: "pose",
    plural: Some("poses"),
    help: "Positions and orientations",
    function: &POSE,
    places: &[""],
    stands: StationLayout::Anywhere,
    drawn: MeasurementOrigin::Seen(|target, drawn| add_noise(target, drawn.length, drawn)),
    columns: &[],
    about: "# qx to qw    the target's orientation in the device's frame, as a quaternion (w last). Instead, name the columns\n\
            #             rx,ry,rz[deg] for a rotation vector, or roll,pitch,yaw[deg] for turns about the fixed x, then y, then z.\n",
};

const MIXED: SessionTraits = SessionTraits {
    word: "mixed",
    plural: None,
    help: "Poses and points in turn",
    drawn: MeasurementOrigin::Seen(|target, drawn| {
        let is_pose = drawn.row.is_multiple_of(2);
        if is_pose {
            add_noise(target, drawn.length, drawn)
        } else {
            Measurement::point(target.translation + drawn.length)
        }
    }),
    about: "# qx to qw    the target's orientation in the device's frame, as a quaternion (w last); leave all four empty in rows\n\
            #             where a point was seen.\n",
    ..POSES
};

const RELATIVE: SessionTraits = SessionTraits {
    word: "relative",
    plural: Some("relative"),
    help: "Poses from one configuration in another",
    places: &["pair"],
    stands: StationLayout::Before,
    drawn: MeasurementOrigin::Seen(|target, drawn| {
        let shift = (drawn.lengths)();
        add_noise(target, shift, drawn)
    }),
    columns: &["pair", "x[mm]", "y[mm]", "z[mm]", "qx", "qy", "qz", "qw"],
    about: "# pair        two rows with the same name are one measurement, of two configurations; the second has the numbers.\n\
            # x to qw     the target in the second, seen from where it was in the first.\n",
    ..POSES
};

/// A pose with noise.
fn add_noise(target: &Pose, shift: Vector3<f64>, drawn: &RandomDraws<'_>) -> Measurement {
    let turn = rotation::exp(&drawn.turn);
    Measurement::of_pose(&Pose::new(turn * target.rotation, target.translation + shift))
}

impl SessionKind {
    /// Position and orientation of the tip.
    pub const POSE: SessionKind = SessionKind::new(&POSES);
    /// Poses and points in turn.
    pub const MIXED: SessionKind = SessionKind::new(&MIXED);
    /// Poses of the tip from one configuration in another.
    pub const RELATIVE: SessionKind = SessionKind::new(&RELATIVE);
}

impl Measurement {
    /// A measured `device_from_target`.
    ///
    /// ```
    /// # mod poecal {
    /// #     pub use poecal_arm::lie;
    /// #     pub use poecal_model::measurement::Measurement;
    /// # }
    /// use poecal::lie::Pose;
    /// use poecal::Measurement;
    /// let pose = Pose::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]);
    /// let mut e = [1.0; 6];
    /// Measurement::of_pose(&pose).residual(&pose, &mut e);
    /// assert!(e.iter().all(|component| component.abs() < 1e-15));
    /// ```
    #[must_use]
    pub fn of_pose(pose: &Pose) -> Self {
        let mut seen = Measurement::new(&POSE, pose.translation.as_slice());
        seen.values_mut()[3..].copy_from_slice(pose.rotation.as_slice());
        seen
    }

    /// True if it is a pose, or all of a position.
    #[must_use]
    #[inline]
    pub fn is_place(&self) -> bool {
        *self.function() == POSE || *self.function() == super::point::POINT
    }

    /// The same pose, or position, after a change; `None` if it is neither.
    #[must_use]
    pub fn map_pose(&self, to: impl FnOnce(Pose) -> Pose) -> Option<Self> {
        match self.frame() {
            Some(pose) => Some(Measurement::of_pose(&to(pose))),
            None => {
                let place = self.position().filter(|_| self.is_place())?;
                Some(Measurement::point(to(Pose::from_translation(place)).translation))
            }
        }
    }
}

//! Deviations of axes and targets from nominal, and their derivatives (theory.md §6 (27a), (27c)).

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};

use poecal_arm::lie::{Pose, hat};
use poecal_model::robot::Tolerance;
use poecal_numerics::linalg::{self, Factor6};

/// Rounding of the base's information, as a share of its trace: axes that are all parallel leave directions undetermined.
const ROUNDING: f64 = 1e-12;

/// A nominal axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NominalAxis {
    pub(crate) direction: Vector3<f64>,
    pub(crate) origin: Vector3<f64>,
    pub(crate) turns: bool,
    pub(crate) tolerance: Tolerance,
}

/// Nominal position of a target at home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NominalTarget {
    /// Index of the target.
    pub(crate) target: usize,
    pub(crate) place: Vector3<f64>,
    pub(crate) sigma_m: f64,
}

/// Deviation of a target, over its standard deviation.
pub(crate) struct TargetDeviation {
    pub(crate) target: usize,
    pub(crate) value: Vector3<f64>,
    /// Derivative by shifts along the target's own axes.
    pub(crate) own: Matrix3<f64>,
}

/// Derivatives of axes and targets by a motion of the base, a twist.
type BaseDerivatives = (Vec<Matrix6<f64>>, Vec<Matrix3x6<f64>>);

/// Deviations, after the best motion of the base if that is free.
pub(crate) struct Deviations {
    pub(crate) axes: Vec<AxisDeviation>,
    pub(crate) targets: Vec<TargetDeviation>,
    /// Derivatives of both by a motion of the base; `None` if the base is held.
    pub(crate) by_base: Option<BaseDerivatives>,
}

/// Deviation of an axis, tilts before shifts, each over its standard deviation, with the quantities of its derivatives.
pub(crate) struct AxisDeviation {
    pub(crate) value: Vector6<f64>,
    x: Vector3<f64>,
    y: Vector3<f64>,
    d: Vector3<f64>,
    /// Distance from the axis frame's origin along the axis to the point nearest to the nominal origin.
    along: f64,
    nearest: Vector3<f64>,
    /// Vector from that point to the nominal origin.
    missing: Vector3<f64>,
    tilt: f64,
    shift: f64,
}

/// Derivatives of a deviation by the motions of its axis: a shift changes the second half only.
pub(crate) struct AxisDerivatives {
    shifts: [Vector3<f64>; 2],
    turns: [Vector6<f64>; 2],
}

impl AxisDerivatives {
    /// All motions as columns.
    pub(crate) fn columns(&self) -> [Vector6<f64>; 4] {
        let whole = |shift: Vector3<f64>| Vector6::new(0.0, 0.0, 0.0, shift.x, shift.y, shift.z);
        let ([a, b], [c, d]) = (self.shifts, self.turns);
        [whole(a), whole(b), c, d]
    }

    /// Product of two columns.
    #[inline]
    pub(crate) fn product(&self, column: usize, other: usize) -> f64 {
        match (column, other) {
            (0 | 1, 0 | 1) => self.shifts[column].dot(&self.shifts[other]),
            (0 | 1, _) => self.along_shift(column, &self.turns[other - 2]),
            (_, 0 | 1) => self.along_shift(other, &self.turns[column - 2]),
            _ => self.turns[column - 2].dot(&self.turns[other - 2]),
        }
    }

    /// Product of a column with a deviation.
    #[inline]
    pub(crate) fn column_product(&self, column: usize, value: &Vector6<f64>) -> f64 {
        if column < 2 { self.along_shift(column, value) } else { self.turns[column - 2].dot(value) }
    }

    #[inline]
    fn along_shift(&self, column: usize, value: &Vector6<f64>) -> f64 {
        let [_, _, _, x, y, z] = value.data.0[0];
        self.shifts[column].dot(&Vector3::new(x, y, z))
    }
}

impl AxisDeviation {
    /// Deviation of an axis with this `base_from_axis`.
    pub(crate) fn new(nominal: &NominalAxis, frame: &Pose) -> Self {
        let [x, y, d] = [0, 1, 2].map(|k| frame.rotation.column(k).into_owned());
        let (tilt, shift) = (1.0 / nominal.tolerance.angle_rad, 1.0 / nominal.tolerance.length_m);
        let shift = if nominal.turns { shift } else { 0.0 };
        let along = d.dot(&(nominal.origin - frame.translation));
        let nearest = frame.translation + d * along;
        let missing = nominal.origin - nearest;
        let mut made = AxisDeviation { value: Vector6::zeros(), x, y, d, along, nearest, missing, tilt, shift };
        made.value = made.combine(d - nominal.direction, -missing);
        made
    }

    fn combine(&self, tilted: Vector3<f64>, shifted: Vector3<f64>) -> Vector6<f64> {
        let (a, b) = (tilted * self.tilt, shifted * self.shift);
        Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z)
    }

    /// A rotation moves the direction by `turned`, a point of the axis by `moved`, and the nearest point also along the axis.
    fn change(&self, turned: Vector3<f64>, moved: Vector3<f64>) -> Vector6<f64> {
        let d = self.d;
        self.combine(turned, moved - d * d.dot(&moved) + d * turned.dot(&self.missing))
    }

    /// A shift moves no direction.
    fn shift_only(&self, moved: Vector3<f64>) -> Vector6<f64> {
        self.combine(Vector3::zeros(), moved - self.d * self.d.dot(&moved))
    }

    /// Derivatives by shifts along x and y and rotations about x and y of the axis' own frame.
    #[inline]
    pub(crate) fn own_motions(&self) -> AxisDerivatives {
        let AxisDeviation { x, y, d, along, .. } = *self;
        let shifted = |moved: Vector3<f64>| (moved - d * d.dot(&moved)) * self.shift;
        AxisDerivatives {
            shifts: [shifted(x), shifted(y)],
            turns: [self.change(-y, -y * along), self.change(x, x * along)],
        }
    }

    /// Derivative by a motion of the base, a twist.
    pub(crate) fn by_base(&self) -> Matrix6<f64> {
        let mut base = Matrix6::zeros();
        for k in 0..3 {
            let unit = Vector3::ith(k, 1.0);
            base.set_column(k, &self.shift_only(unit));
            base.set_column(3 + k, &self.change(unit.cross(&self.d), unit.cross(&self.nearest)));
        }
        base
    }
}

impl NominalTarget {
    /// Deviation of a target with this `base_from_target`.
    pub(crate) fn deviation(&self, frame: &Pose) -> TargetDeviation {
        TargetDeviation {
            target: self.target,
            value: (frame.translation - self.place) / self.sigma_m,
            own: frame.rotation / self.sigma_m,
        }
    }

    /// Derivative of the deviation by a motion of the base, a twist.
    pub(crate) fn by_base(&self, frame: &Pose) -> Matrix3x6<f64> {
        let mut base = Matrix3x6::zeros();
        base.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(1.0);
        base.fixed_view_mut::<3, 3>(0, 3).copy_from(&-hat(&frame.translation));
        base / self.sigma_m
    }
}

impl Deviations {
    /// `½ |u|²` of the axes.
    pub(crate) fn cost_of_axes(&self) -> f64 {
        self.axes.iter().map(|it| 0.5 * it.value.norm_squared()).sum()
    }

    /// `½ |u|²` of axes and targets.
    pub(crate) fn cost(&self) -> f64 {
        self.cost_of_axes() + self.targets.iter().map(|it| 0.5 * it.value.norm_squared()).sum::<f64>()
    }

    /// Gradient by a motion of the base, and the factor of its information, `BᵀB` with `B = (0 T; A S)` for an axis: a shift tilts no axis.
    /// `None` if the base is held; no factor if the information is singular.
    pub(crate) fn of_base(&self) -> Option<(Vector6<f64>, Factor6)> {
        let (of_axes, of_targets) = self.by_base.as_ref()?;
        let (mut shifts, mut mixed, mut turns) = (Matrix3::zeros(), Matrix3::zeros(), Matrix3::zeros());
        for base in of_axes {
            let [tilted, across, moved] =
                [(0, 3), (3, 0), (3, 3)].map(|at| base.fixed_view::<3, 3>(at.0, at.1).into_owned());
            shifts += across.tr_mul(&across);
            mixed += across.tr_mul(&moved);
            turns += tilted.tr_mul(&tilted) + moved.tr_mul(&moved);
        }
        for base in of_targets {
            let [across, moved] = [0, 3].map(|at| base.fixed_view::<3, 3>(0, at).into_owned());
            shifts += across.tr_mul(&across);
            mixed += across.tr_mul(&moved);
            turns += moved.tr_mul(&moved);
        }
        let least = ROUNDING * (shifts.trace() + turns.trace());
        let mut gram = Matrix6::identity() * least;
        for (at, block) in [((0, 0), shifts), ((0, 3), mixed), ((3, 0), mixed.transpose()), ((3, 3), turns)] {
            let mut place = gram.fixed_view_mut::<3, 3>(at.0, at.1);
            place += block;
        }
        let factor = linalg::cholesky_6(gram)?;
        let axes: Vector6<f64> = self.axes.iter().zip(of_axes).map(|(it, base)| base.tr_mul(&it.value)).sum();
        let targets = self.targets.iter().zip(of_targets).map(|(it, base)| base.tr_mul(&it.value));
        Some((axes + targets.sum::<Vector6<f64>>(), factor))
    }
}

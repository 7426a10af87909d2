//! Measurements of rows, in the form of the kernels.

use poecal_model::measurement::{Kernel, Measurement};
use poecal_numerics::kernels::Along;

/// Form of the measurements of a group of rows, for the kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// The position of a point.
    Point,
    /// A pose, by the residual of its type.
    Pose,
    /// One number of a point's position.
    Along(Along),
    /// Another function of a target's pose: the number of its values, and true if they depend on the orientation.
    Shaped(usize, bool),
}

impl Form {
    /// Form of a measurement. The flags state whether the kernels have the columns of all screws and the
    /// residual of poses. The last one states whether the instrument's range is plain, without unknown zero
    /// and scale.
    pub(crate) fn from_measurement(
        measured: &Measurement,
        have_screws: bool,
        have_residual: bool,
        is_plain: impl Fn() -> bool,
    ) -> Self {
        match measured.function().kernel {
            Kernel::Place if have_screws => Form::Point,
            Kernel::Pose if have_screws && have_residual => Form::Pose,
            Kernel::Height if have_screws => Form::Along(Along::Height),
            Kernel::Distance if have_screws && is_plain() => Form::Along(Along::Distance),
            Kernel::Place | Kernel::Pose | Kernel::Height | Kernel::Distance | Kernel::Any => {
                Form::shaped_of(measured)
            }
        }
    }

    /// Form of any function of a target's pose.
    pub(crate) fn shaped_of(measured: &Measurement) -> Self {
        Form::Shaped(measured.dim(), measured.sees_orientation())
    }

    /// Form of the same rows, as any function of the target's pose.
    pub(crate) fn shaped(self) -> Self {
        Form::Shaped(self.numbers(), self.sees_orientation())
    }

    /// True if the rows depend on the target's orientation.
    pub(crate) fn sees_orientation(self) -> bool {
        match self {
            Form::Point | Form::Along(_) => false,
            Form::Pose => true,
            Form::Shaped(_, sees) => sees,
        }
    }

    /// Number of values of each row.
    pub(crate) fn numbers(self) -> usize {
        match self {
            Form::Point => 3,
            Form::Pose => 6,
            Form::Along(_) => 1,
            Form::Shaped(numbers, _) => numbers,
        }
    }
}

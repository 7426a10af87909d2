//! Measurements of rows, in the form of the kernels.

use poecal_model::measurement::{Kernel, Measurement};
use poecal_numerics::kernels::PlaceComponent;

/// Form of the measurements of a group of rows, for the kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RowForm {
    /// The position of a point.
    Point,
    /// A pose, by the residual of its type.
    Pose,
    /// One number of a point's position.
    Along(PlaceComponent),
    /// Another function of a target's pose: the number of its values, and true if they depend on the orientation.
    Shaped(usize, bool),
}

impl RowForm {
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
            Kernel::Place if have_screws => RowForm::Point,
            Kernel::Pose if have_screws && have_residual => RowForm::Pose,
            Kernel::Height if have_screws => RowForm::Along(PlaceComponent::Height),
            Kernel::Distance if have_screws && is_plain() => RowForm::Along(PlaceComponent::Distance),
            Kernel::Place | Kernel::Pose | Kernel::Height | Kernel::Distance | Kernel::Any => {
                RowForm::shaped_of(measured)
            }
        }
    }

    /// Form of any function of a target's pose.
    pub(crate) fn shaped_of(measured: &Measurement) -> Self {
        RowForm::Shaped(measured.dim(), measured.sees_orientation())
    }

    /// Form of the same rows, as any function of the target's pose.
    pub(crate) fn general(self) -> Self {
        RowForm::Shaped(self.numbers(), self.sees_orientation())
    }

    /// True if the rows depend on the target's orientation.
    pub(crate) fn sees_orientation(self) -> bool {
        match self {
            RowForm::Point | RowForm::Along(_) => false,
            RowForm::Pose => true,
            RowForm::Shaped(_, sees) => sees,
        }
    }

    /// Number of values of each row.
    pub(crate) fn numbers(self) -> usize {
        match self {
            RowForm::Point => 3,
            RowForm::Pose => 6,
            RowForm::Along(_) => 1,
            RowForm::Shaped(numbers, _) => numbers,
        }
    }
}

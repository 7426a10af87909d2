//! Formulations: other parameterisations, residuals and methods, supplied from outside for comparison.

use poecal_fit::parameters::{Parameter, screw_axes};
use poecal_fit::problem::Problem;
use poecal_fit::state::Estimate;
use poecal_model::measurement::PoseResidual;
use poecal_model::robot::JointKind;
use poecal_numerics::solve::{NormalEquations, Options, Summary, minimize};

/// Result of one minimisation: estimate, normal information, summary.
pub type Minimum = (Estimate, NormalEquations, Summary);

/// Minimises a problem from a start.
pub type Minimize = fn(&Problem<'_>, Estimate, &Options) -> Minimum;

/// Parameterisation of the joints, residual of measured frames, and method. The result is always judged in the minimal basis.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_calibrate::Formulation;
/// #     pub use poecal_model::robot::JointKind;
/// # }
/// use poecal::{Formulation, JointKind};
/// // The usual one has four unknowns for an axis that turns.
/// let unknowns = (Formulation::default().joint_parameters)(&[JointKind::Revolute]);
/// assert_eq!(unknowns[0].model().columns().len(), 4);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Formulation {
    /// Its description in `calibration.json`.
    pub words: FormulationWords,
    /// Parameters of joints of these kinds, in the order of the chain.
    pub joint_parameters: fn(&[JointKind]) -> Vec<Parameter>,
    /// Residual of measured frames; `None`: at the target.
    pub pose_residual: Option<&'static dyn PoseResidual>,
    /// Minimises a problem from a start.
    pub minimize: Minimize,
}

/// Description of a formulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormulationWords {
    /// Parameterisation of joint errors.
    pub formulation: &'static str,
    /// Residual of measured frames.
    pub pose_residual: &'static str,
    /// Method of the solver.
    pub method: &'static str,
    /// Its effect on the result.
    pub note: Option<&'static str>,
}

impl Default for FormulationWords {
    fn default() -> Self {
        FormulationWords { formulation: "adjoint", pose_residual: "tool", method: "levenberg-marquardt", note: None }
    }
}

impl Default for Formulation {
    /// Each screw moves as a rigid body in the minimal basis (lou2009 16 to 18), residuals of frames are at the target, steps are damped.
    fn default() -> Self {
        Formulation {
            words: FormulationWords::default(),
            joint_parameters: screw_axes,
            pose_residual: None,
            minimize: |problem, start, options| minimize(problem, start, options),
        }
    }
}

impl PartialEq for Formulation {
    fn eq(&self, other: &Self) -> bool {
        self.words == other.words
    }
}

//! Another way to write the fit and to minimise it: given from outside, for comparison.

use crate::estimate::Estimate;
use crate::measurement::PoseResidual;
use crate::parameters::{Parameter, screw_axes};
use crate::problem::Problem;
use crate::robot::JointKind;
use crate::solve::{Normal, Options, Summary, minimize};

/// What one minimisation gives: the state, its normal information, and what was done.
pub type Minimum = (Estimate, Normal, Summary);

/// How a formulation minimises a problem from a start.
pub type Minimize = fn(&Problem<'_>, Estimate, &Options) -> Minimum;

/// A way to write the unknowns of the joints and the errors of measured frames, and to minimise. What is delivered is judged in the
/// minimal basis, whatever the way.
///
/// ```
/// use poecal::{Formulation, JointKind};
/// // The usual one has four unknowns for an axis that turns.
/// let unknowns = (Formulation::default().joint_parameters)(&[JointKind::Revolute]);
/// assert_eq!(unknowns[0].model().columns().len(), 4);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Formulation {
    /// Its words in `calibration.json`.
    pub words: FormulationWords,
    /// The unknowns of joints of some kinds, in the order of the chain.
    pub joint_parameters: fn(&[JointKind]) -> Vec<Parameter>,
    /// Residual of measured frames, if not at the target.
    pub pose_residual: Option<&'static dyn PoseResidual>,
    /// Minimises a problem from a start.
    pub minimize: Minimize,
}

/// What a fit says of its formulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormulationWords {
    /// Parameterisation of joint errors.
    pub formulation: &'static str,
    /// Residual of measured frames.
    pub pose_residual: &'static str,
    /// Method of the solver.
    pub method: &'static str,
    /// What that does to the result.
    pub note: Option<&'static str>,
}

impl Default for FormulationWords {
    fn default() -> Self {
        FormulationWords {
            formulation: "adjoint",
            pose_residual: "tool",
            method: "levenberg-marquardt",
            note: None,
        }
    }
}

impl Default for Formulation {
    /// Each screw moves as a rigid body in the minimal basis (lou2009 16 to 18), errors of frames are written at the target, steps are
    /// damped.
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

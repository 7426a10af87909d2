//! Formulations and methods of a calibration that lou2009 discusses: unknowns of the joints, errors of measured frames, steps.

use poecal_calibrate as calibration;
use poecal_fit::parameters::{Parameter, ScrewAxis, ValueTerm};
use poecal_model::measurement::PoseResidual;
use poecal_model::robot::{JointKind, Term};
use poecal_numerics::solve::minimize;
use serde::Serialize;

use crate::{FreeScrew, SpatialResidual, gauss_newton};

/// Parameterisation of joint errors (lou2009, sections II and III). All describe the same robots; they differ in the number of unknowns, in the
/// treatment of constraints, and in the identifiable parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PaperFormulation {
    /// Each screw moves as a rigid body, `ξ ← Ad_exp(η) ξ`, in the minimal basis: no constraints, no offsets (lou2009 16 to 18).
    #[default]
    Adjoint,
    /// Each screw is six free numbers, made a screw again after every iteration (okamura1996 without offsets).
    Screw,
    /// Free screws and joint offsets, 7n + 6 unknowns (okamura1996, lou2009 3 to 10).
    ScrewOffsets,
    /// Adjoint errors and joint offsets, to show the effect of offsets: they add unknowns, and no rank (lou2009 Proposition 1).
    AdjointOffsets,
}

impl PaperFormulation {
    /// All formulations.
    pub const ALL: [PaperFormulation; 4] = [
        PaperFormulation::Adjoint,
        PaperFormulation::Screw,
        PaperFormulation::ScrewOffsets,
        PaperFormulation::AdjointOffsets,
    ];

    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            PaperFormulation::Adjoint => "adjoint",
            PaperFormulation::Screw => "screw",
            PaperFormulation::ScrewOffsets => "screw-offsets",
            PaperFormulation::AdjointOffsets => "adjoint-offsets",
        }
    }

    /// The unknowns of joints of some kinds, in the order of the chain.
    #[must_use]
    pub fn joint_parameters(self, kinds: &[JointKind]) -> Vec<Parameter> {
        let mut parameters = Vec::with_capacity(2 * kinds.len());
        for (joint, &kind) in kinds.iter().enumerate() {
            parameters.push(if self.has_free_screws() {
                FreeScrew::parameter(joint, kind)
            } else {
                Parameter::ScrewAxis(ScrewAxis { joint, kind })
            });
            if self.has_offsets() {
                parameters.push(Parameter::ValueTerm(ValueTerm { joint, kind, term: Term::OFFSET }));
            }
        }
        parameters
    }

    /// Usual method of the formulation: plain Gauss-Newton if screws are free numbers, since steps that are judged by the cost after normalisation
    /// are shortened repeatedly (docs/theory.md §3).
    #[must_use]
    pub fn usual_method(self) -> Method {
        if self.has_free_screws() { Method::GaussNewton } else { Method::LevenbergMarquardt }
    }

    /// True if joint offsets are unknowns.
    #[must_use]
    pub fn has_offsets(self) -> bool {
        matches!(self, PaperFormulation::ScrewOffsets | PaperFormulation::AdjointOffsets)
    }

    /// True if screws are six free numbers, projected to screws after every step.
    #[must_use]
    pub fn has_free_screws(self) -> bool {
        matches!(self, PaperFormulation::Screw | PaperFormulation::ScrewOffsets)
    }
}

/// Form of the errors of measured frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PaperResidual {
    /// Position and rotation at the target, in which a device's data sheet states its noise.
    #[default]
    Tool,
    /// The twist about the device's origin ([`SpatialResidual`]).
    Spatial,
}

impl PaperResidual {
    /// All forms.
    pub const ALL: [PaperResidual; 2] = [PaperResidual::Tool, PaperResidual::Spatial];

    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            PaperResidual::Tool => "tool",
            PaperResidual::Spatial => "spatial",
        }
    }

    /// Residual in the form of the library.
    #[must_use]
    pub fn model(self) -> Option<&'static dyn PoseResidual> {
        match self {
            PaperResidual::Tool => None,
            PaperResidual::Spatial => Some(&SpatialResidual),
        }
    }
}

/// Method of the solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Damped steps, accepted only if they lower the cost.
    #[default]
    LevenbergMarquardt,
    /// Full steps, accepted unconditionally: the iterated least squares of lou2009. It may diverge.
    GaussNewton,
}

impl Method {
    /// Both methods.
    pub const ALL: [Method; 2] = [Method::LevenbergMarquardt, Method::GaussNewton];

    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Method::LevenbergMarquardt => "levenberg-marquardt",
            Method::GaussNewton => "gauss-newton",
        }
    }

    /// The minimisation by these steps.
    #[must_use]
    pub fn minimize(self) -> calibration::Minimize {
        match self {
            Method::LevenbergMarquardt => |problem, start, options| minimize(problem, start, options),
            Method::GaussNewton => |problem, start, options| gauss_newton(problem, start, options),
        }
    }
}

/// A formulation with its residual and method, for [`CalibrationOptions`](calibration::CalibrationOptions).
#[must_use]
pub fn to_formulation(
    formulation: PaperFormulation,
    residual: PaperResidual,
    method: Method,
) -> calibration::Formulation {
    let joint_parameters: fn(&[JointKind]) -> Vec<Parameter> = match formulation {
        PaperFormulation::Adjoint => |kinds| PaperFormulation::Adjoint.joint_parameters(kinds),
        PaperFormulation::Screw => |kinds| PaperFormulation::Screw.joint_parameters(kinds),
        PaperFormulation::ScrewOffsets => |kinds| PaperFormulation::ScrewOffsets.joint_parameters(kinds),
        PaperFormulation::AdjointOffsets => |kinds| PaperFormulation::AdjointOffsets.joint_parameters(kinds),
    };
    calibration::Formulation {
        words: calibration::FormulationWords {
            formulation: formulation.word(),
            pose_residual: residual.word(),
            method: method.word(),
            note: note(formulation, method),
        },
        joint_parameters,
        pose_residual: residual.model(),
        minimize: method.minimize(),
    }
}

/// Effect of the formulation and method on the result.
fn note(formulation: PaperFormulation, method: Method) -> Option<&'static str> {
    match (formulation, method) {
        (PaperFormulation::Adjoint, _) | (PaperFormulation::Screw, Method::LevenbergMarquardt) => None,
        (PaperFormulation::Screw, Method::GaussNewton) => {
            Some("screws are normalised after each step, so with noise this is not the least squares")
        }
        (PaperFormulation::ScrewOffsets, Method::GaussNewton) => Some(
            "screws are normalised after each step, so with noise this is not the least squares; joint offsets cannot be separated from screws, and are part of them",
        ),
        (PaperFormulation::ScrewOffsets | PaperFormulation::AdjointOffsets, _) => {
            Some("joint offsets cannot be separated from screws, and are part of them")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_formulation_is_that_of_the_library() {
        let usual = to_formulation(PaperFormulation::Adjoint, PaperResidual::Tool, Method::LevenbergMarquardt);
        assert_eq!(usual, calibration::Formulation::default());
    }
}

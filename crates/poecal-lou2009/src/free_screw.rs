//! A joint's screw as free numbers, the original formulation (docs/theory.md §5 (22a) to (22c)).

use nalgebra::{Matrix3, Vector3};
use poecal_arm::lie::{Pose, Screw, TargetTwist, Twist, rotation};
use poecal_fit::parameters::{Column, OtherScrew, Parameter, ScrewModel};
use poecal_fit::state::{JointView, RowChain};
use poecal_model::robot::JointKind;

/// A screw with all its numbers free, `ξ ← ξ + dξ`, made a screw again by the retraction (okamura1996, lou2009
/// equations 5 to 9): `ω/|ω|`, `(v - ω(ω·v))/|ω|`. `dξ` is written in the joint's axis frame A, `ξ = Ad_A ε_z`, where the
/// integral of lou2009 (8e) is `θ J_l(ε_z θ) = diag(K, K)` with `K = [[sin θ, cos θ - 1, 0], [1 - cos θ, sin θ, 0], [0, 0, θ]]`:
/// columns `(K e_k; 0)` and `(K e_k × d; K e_k)`. Prismatic: `ω` stays zero, columns `(θ e_k; 0)`.
///
/// Two of a revolute joint's six unknowns (the length of ω, which acts as a gear factor, and the pitch) and one of a prismatic
/// joint's three are no screws: the retraction drops them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FreeScrew;

impl FreeScrew {
    /// The free screw of a joint as a parameter.
    #[must_use]
    pub fn parameter(joint: usize, kind: JointKind) -> Parameter {
        Parameter::OtherScrew(OtherScrew { joint, kind, model: &FreeScrew })
    }
}

const SCREW: [Column; 6] = [
    Column::shift("vx"),
    Column::shift("vy"),
    Column::shift("vz"),
    Column::turn("wx"),
    Column::turn("wy"),
    Column::turn("wz"),
];
/// A change of a unit direction: a number that counts as radians.
const DIRECTION: [Column; 3] = [Column::direction("vx"), Column::direction("vy"), Column::direction("vz")];

impl ScrewModel for FreeScrew {
    fn name(&self) -> &'static str {
        "free screw"
    }

    fn columns(&self, kind: JointKind) -> &'static [Column] {
        match kind {
            JointKind::Revolute => &SCREW,
            JointKind::Prismatic => &DIRECTION,
        }
    }

    fn target_twists(&self, joint: &JointView, chain: &RowChain, out: &mut [TargetTwist]) {
        let zero = Vector3::zeros();
        match joint.kind {
            JointKind::Revolute => {
                let (sine, versine) = (joint.sine, 1.0 - joint.cosine_or_value);
                let arm = chain.target.translation - joint.origin;
                let directions =
                    [joint.x * sine + joint.y * versine, joint.y * sine - joint.x * versine, joint.z * joint.value];
                for (k, direction) in directions.into_iter().enumerate() {
                    out[k] = (direction, zero);
                    out[3 + k] = (direction.cross(&arm), direction);
                }
            }
            JointKind::Prismatic => {
                for (out, axis) in out.iter_mut().zip([joint.x, joint.y, joint.z]) {
                    *out = (axis * joint.value, zero);
                }
            }
        }
    }

    fn project_constraints(&self, kind: JointKind, step: &mut [f64]) {
        step[2] = 0.0;
        if kind == JointKind::Revolute {
            step[5] = 0.0;
        }
    }

    fn retract(&self, kind: JointKind, base_from_axis: &Pose, step: &[f64]) -> Pose {
        let z = Vector3::z();
        let first = Vector3::new(step[0], step[1], step[2]);
        let moved = match kind {
            JointKind::Revolute => Twist::new(first, z + Vector3::new(step[3], step[4], step[5])),
            JointKind::Prismatic => Twist::new(z + first, Vector3::zeros()),
        };
        // A step that makes the direction vanish has no nearest screw: the axis stays, and the step is judged by its cost.
        let Some(screw) = Screw::project(&moved) else { return *base_from_axis };
        let turn: Matrix3<f64> = rotation::shortest_arc(&z, &screw.direction());
        (*base_from_axis * Pose::new(turn, screw.nearest_point(&Vector3::zeros()))).orthonormalized()
    }
}

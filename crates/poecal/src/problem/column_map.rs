//! Columns of one group of rows: the unknowns that move its target, in the order of the kernels.

use super::{Layout, Problem};
use crate::estimate::Sight;
use crate::lanes::{JointPlan, NUMBERS, Plan};
use crate::parameters::Parameter;

/// Columns of one group of rows: their order in the kernels, and their places in a step.
#[derive(Clone, Debug)]
pub(super) struct ColumnMap {
    pub(super) sight: Sight,
    pub(super) plan: Plan,
    /// Places of the plan's translation and rotation columns in a step.
    shift_places: Vec<usize>,
    pub(super) turn_places: Vec<usize>,
}

impl ColumnMap {
    /// For a problem of the kinds that kernels serve ([`Problem::is_served`]); `None` if its unknowns contradict each other.
    pub(super) fn new(problem: &Problem<'_>, sight: Sight, framed: bool) -> Option<Self> {
        let mut made = ColumnMap {
            sight,
            plan: plan_without_unknowns(problem, framed),
            shift_places: Vec::new(),
            turn_places: Vec::new(),
        };
        // The kernels' order: device frame, joints, target.
        made.add_device(&problem.layout)?;
        made.add_joints(&problem.layout)?;
        made.plan.tilts = made.turn_places.len();
        made.add_target(&problem.layout)?;
        made.plan.shifts = made.shift_places.len();
        Some(made)
    }

    /// Places of the plan's columns in a step: translation columns, then rotation columns.
    pub(super) fn places(&self) -> impl Iterator<Item = usize> {
        self.shift_places.iter().chain(&self.turn_places).copied()
    }

    /// Length of a row's residual.
    pub(super) fn numbers(&self) -> usize {
        if self.plan.framed { NUMBERS } else { NUMBERS / 2 }
    }

    fn shift(&mut self, places: &[(usize, f64)]) {
        self.shift_places.extend(places.iter().map(|&(place, _)| place));
    }

    /// Adds rotation columns about the directions of the translation columns from `first` on.
    fn turn(&mut self, places: &[(usize, f64)], first: usize) {
        self.turn_places.extend(places.iter().map(|&(place, _)| place));
        self.plan.turns.extend(first..first + places.len());
    }

    fn add_device(&mut self, layout: &Layout) -> Option<()> {
        for (parameter, places) in layout.parameters() {
            // Frames of other stations do not move these rows.
            if let Parameter::DeviceFrame(device) = parameter
                && device.station == self.sight.station
            {
                if self.plan.device.is_some() {
                    return contradiction("one frame of the device is unknown twice");
                }
                self.plan.device = Some(device.about.into());
                self.shift(&places[..3]);
                self.turn(&places[3..], 0);
            }
        }
        Some(())
    }

    fn add_joints(&mut self, layout: &Layout) -> Option<()> {
        for (parameter, places) in layout.parameters() {
            let axis = match parameter {
                Parameter::ScrewAxis(axis) => axis,
                Parameter::OtherScrew(_) | Parameter::JointOffset(_) => {
                    return contradiction("kernels do not have these unknowns");
                }
                Parameter::DeviceFrame(_) | Parameter::TargetFrame(_) | Parameter::TargetPlace(_) => continue,
            };
            let first = self.shift_places.len();
            let turns = places.len() == 4;
            let joint = self.plan.joints.get_mut(axis.joint);
            let Some(joint) = joint.filter(|joint| joint.columns.is_none() && joint.turns == turns) else {
                return contradiction("a joint is unknown twice, or of another kind than its screw");
            };
            joint.columns = Some((first, self.turn_places.len()));
            self.shift(&places[..2]);
            self.turn(&places[2..], first);
        }
        Some(())
    }

    fn add_target(&mut self, layout: &Layout) -> Option<()> {
        for (parameter, places) in layout.parameters() {
            let target = match parameter {
                Parameter::TargetFrame(frame) => frame.target,
                Parameter::TargetPlace(place) => place.target,
                Parameter::ScrewAxis(_)
                | Parameter::OtherScrew(_)
                | Parameter::JointOffset(_)
                | Parameter::DeviceFrame(_) => continue,
            };
            if target != self.sight.target {
                continue;
            }
            if self.plan.place.is_some() {
                return contradiction("a target is unknown twice");
            }
            let first = self.shift_places.len();
            self.plan.place = Some(first);
            self.shift(&places[..3]);
            if places.len() > 3 && self.plan.framed {
                self.plan.frame = Some(self.turn_places.len());
                self.turn(&places[3..], first);
            }
        }
        Some(())
    }
}

/// Contradictory unknowns are a mistake of the caller. Tests stop there; a release takes the row-by-row path.
fn contradiction(what: &str) -> Option<()> {
    debug_assert!(false, "{what}");
    None
}

fn plan_without_unknowns(problem: &Problem<'_>, framed: bool) -> Plan {
    Plan {
        joints: problem.session.packed.turns().map(|turns| JointPlan { turns, columns: None }).collect(),
        device: None,
        place: None,
        frame: None,
        shifts: 0,
        tilts: 0,
        turns: Vec::new(),
        length_m: problem.layout.length_m(),
        framed,
        ratio: None,
    }
}

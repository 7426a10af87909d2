//! The hot path: rows grouped by target and kind, packed side by side, and summed by [`crate::lanes`].
//!
//! It serves points and poses with minimal screws, targets and a device frame; everything else takes the general path in `mod.rs`,
//! which is also what this one is tested against.

use super::alike::{Alike, Whitening};
use super::scatter::Scatter;
use super::{Layout, Problem};
use crate::estimate::{Estimate, Linkage};
use crate::lanes::{self, Arm, JointPlan, Level, Plan, RowData, Rows, Step, Totals};
use crate::measurement::{Measurement, PoseMeasurement, SpatialPoseMeasurement};
use crate::parameters::Parameter;
use crate::solve::Normal;
use crate::threads;
use std::cell::RefCell;

/// Rows that one partial sum takes in. Fixed, so that the result does not depend on the number of threads.
const CHUNK: usize = 1024;
/// Partial sums that exist at a time: memory beside the data stays bounded.
const TOGETHER: usize = 64;
/// Most rows that stay packed; more are packed anew in each pass, chunk by chunk, which costs a tenth of it, and less than memory that
/// has not been used before.
const KEPT: usize = 2048;

thread_local! {
    /// Room for a chunk that is not kept.
    static ROWS: RefCell<Rows> = const { RefCell::new(Rows::EMPTY) };
}

/// What is summed over rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sums {
    /// Cost, gradient and `JᵀJ`.
    All,
    /// The same, `JᵀJ` but for the curvature of the logarithm where that spares time.
    Nearly,
    /// Cost and gradient.
    Gradient,
}

/// Groups of rows that are computed alike.
#[derive(Clone, Debug)]
pub(super) struct Fast {
    groups: Vec<(Group, Scatter)>,
    level: Level,
}

#[derive(Clone, Debug)]
struct Group {
    target: usize,
    plan: Plan,
    /// Places of the plan's shifts and turns in a step.
    shift_places: Vec<usize>,
    turn_places: Vec<usize>,
    rows: Vec<u32>,
    /// Chunks of the rows side by side, if they are kept.
    packed: Vec<Rows>,
}

impl Fast {
    /// Arranges the rows of a problem; `None` if the general path must serve it.
    pub(super) fn new(problem: &Problem<'_>, level: Level) -> Option<Self> {
        let mut groups = Vec::new();
        for alike in Alike::sorted(problem)? {
            let mut group = Group::new(problem, alike.target, alike.framed)?;
            group.plan.ratio = alike.ratio;
            group.rows = alike.rows;
            let scatter = group.scatter(problem.layout.dim());
            groups.push((group, scatter));
        }
        let mut fast = Fast { groups, level };
        fast.pack(problem);
        Some(fast)
    }

    /// Packs what is kept packed.
    pub(super) fn pack(&mut self, problem: &Problem<'_>) {
        if problem.rows.len() > KEPT {
            return;
        }
        for (Group { plan, rows, packed, .. }, _) in &mut self.groups {
            packed.resize_with(rows.len().div_ceil(CHUNK), Rows::default);
            for (rows, packed) in rows.chunks(CHUNK).zip(packed) {
                pack(problem, plan, rows, packed);
            }
        }
    }

    /// Normal information of all rows; a `JᵀJ` that is not asked for is left empty.
    pub(super) fn normal(&self, problem: &Problem<'_>, state: &Estimate, sums: Sums) -> Normal {
        let linkage = Linkage::new(state);
        let steps: Vec<Step> = linkage.steps().iter().map(Step::from).collect();
        let mut normal = match sums {
            Sums::Gradient => Normal::new(0),
            Sums::All | Sums::Nearly => Normal::new(problem.layout.dim()),
        };
        normal.gradient.resize(problem.layout.dim(), 0.0);
        for (group, scatter) in &self.groups {
            let end = Step::from(linkage.end(group.target));
            let arm = Arm { plan: &group.plan, steps: &steps, end: &end, nearly: sums == Sums::Nearly };
            let totals = group.sum(problem, self.level, &arm, sums);
            group.put(&totals, &mut normal);
            if sums != Sums::Gradient {
                scatter.add(&totals, &mut normal.gram);
            }
        }
        normal
    }
}

impl Group {
    fn new(problem: &Problem<'_>, target: usize, framed: bool) -> Option<Self> {
        let mut group = Group {
            target,
            plan: plan_without_unknowns(problem, framed),
            shift_places: Vec::new(),
            turn_places: Vec::new(),
            rows: Vec::new(),
            packed: Vec::new(),
        };
        // The kernels' order: device frame, joints, target.
        group.add_device(&problem.layout)?;
        group.add_joints(&problem.layout)?;
        group.plan.tilts = group.turn_places.len();
        group.add_target(&problem.layout)?;
        group.plan.shifts = group.shift_places.len();
        Some(group)
    }

    fn shift(&mut self, places: &[(usize, f64)]) {
        self.shift_places.extend(places.iter().map(|&(place, _)| place));
    }

    /// Turns about the directions of the shifts from `first` on.
    fn turn(&mut self, places: &[(usize, f64)], first: usize) {
        self.turn_places.extend(places.iter().map(|&(place, _)| place));
        self.plan.turns.extend(first..first + places.len());
    }

    fn add_device(&mut self, layout: &Layout) -> Option<()> {
        for (parameter, places) in layout.parameters() {
            if let Parameter::DeviceFrame(device) = parameter {
                if self.plan.device.is_some() {
                    return None;
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
                Parameter::FreeScrew(_) | Parameter::JointOffset(_) => return None,
                Parameter::DeviceFrame(_) | Parameter::TargetFrame(_) | Parameter::TargetPlace(_) => continue,
            };
            let first = self.shift_places.len();
            let joint = self.plan.joints.get_mut(axis.joint)?;
            if joint.columns.is_some() || joint.turns != (places.len() == 4) {
                return None;
            }
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
                _ => continue,
            };
            if target != self.target {
                continue;
            }
            if self.plan.place.is_some() {
                return None;
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

    /// Sums over all rows of the group, in the order of its chunks whatever the number of threads.
    fn sum(&self, problem: &Problem<'_>, level: Level, arm: &Arm<'_>, sums: Sums) -> Totals {
        let sum = if sums == Sums::Gradient { lanes::sum_gradient } else { lanes::sum_products };
        let chunk = |index: usize| match self.packed.get(index) {
            Some(rows) => sum(level, arm, &rows.blocks),
            None => {
                let last = self.rows.len().min((index + 1) * CHUNK);
                let mut packed = ROWS.take();
                pack(problem, &self.plan, &self.rows[index * CHUNK..last], &mut packed);
                let totals = sum(level, arm, &packed.blocks);
                ROWS.set(packed);
                totals
            }
        };
        let chunks = self.rows.len().div_ceil(CHUNK);
        if chunks <= 1 {
            return chunk(0);
        }
        let mut total: Option<Totals> = None;
        for first in (0..chunks).step_by(TOGETHER) {
            let together = first..chunks.min(first + TOGETHER);
            for part in threads::map_parts(together.len(), |index| chunk(first + index)) {
                match &mut total {
                    Some(total) => total.add(&part),
                    None => total = Some(part),
                }
            }
        }
        // There is more than one chunk.
        total.unwrap_or_else(|| chunk(0))
    }

    fn scatter(&self, n: usize) -> Scatter {
        Scatter::new(&self.plan, &self.shift_places, &self.turn_places, n)
    }

    /// Puts cost and gradient of the group into the problem's normal information.
    fn put(&self, totals: &Totals, normal: &mut Normal) {
        let places = self.shift_places.iter().chain(&self.turn_places);
        for (value, &place) in totals.gradient.iter().zip(places) {
            normal.gradient[place] += value;
        }
        normal.cost += totals.cost;
        normal.residuals += self.rows.len() * if self.plan.framed { 6 } else { 3 };
    }
}

fn plan_without_unknowns(problem: &Problem<'_>, framed: bool) -> Plan {
    Plan {
        joints: problem.packed.turns().map(|turns| JointPlan { turns, columns: None }).collect(),
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

/// Sets rows side by side.
fn pack(problem: &Problem<'_>, plan: &Plan, rows: &[u32], packed: &mut Rows) {
    let usual = Whitening::new(problem.noise);
    packed.pack(plan, rows.len(), |at| row_data(problem, usual, rows[at] as usize, plan.framed));
}

#[inline(always)]
fn row_data<'a>(problem: &'a Problem<'_>, usual: Whitening, row: usize, framed: bool) -> RowData<'a> {
    let observation = &problem.data.observations[row];
    let Whitening { weight, ratio } = usual.of(observation, problem.noise);
    let weight = match problem.weights.and_then(|weights| weights.get(row)) {
        Some(own) => own.sqrt() * weight,
        None => weight,
    };
    let (position, orientation) = match problem.measurement(row) {
        Measurement::Point(point) => (&point.position, None),
        Measurement::Pose(PoseMeasurement { pose })
        | Measurement::SpatialPose(SpatialPoseMeasurement { pose }) => {
            (&pose.translation, framed.then_some((&pose.rotation.data.0, ratio)))
        }
    };
    RowData { joints: problem.packed.row(row), position: &position.data.0[0], orientation, weight }
}

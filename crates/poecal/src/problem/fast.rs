//! The hot path: rows grouped by target and kind, packed side by side, and summed by [`crate::lanes`].
//!
//! It serves points and poses with minimal screws, targets and a device frame; everything else takes the general path in `mod.rs`,
//! which is also what this one is tested against.

use super::{Layout, Problem};
use crate::estimate::{Estimate, Linkage};
use crate::lanes::{self, Arm, JointPlan, Level, Plan, RowData, Rows, Step, Totals, product};
use crate::lie::Pose;
use crate::measurement::Measurement;
use crate::parameters::Parameter;
use crate::solve::Normal;
use rayon::prelude::*;

/// Rows that one partial sum takes in. Fixed, so that the result does not depend on the number of threads.
const CHUNK: usize = 1024;
/// Partial sums that exist at a time: memory beside the data stays bounded.
const TOGETHER: usize = 64;
/// Most rows that stay packed; more are packed anew in each pass, chunk by chunk, which costs a tenth of it.
const KEPT: usize = 8192;

/// Relative difference of two ratios that differ by rounding only.
const SAME_RATIO: f64 = 1e-14;

/// Groups of rows that are computed alike.
#[derive(Clone, Debug)]
pub(super) struct Fast {
    groups: Vec<Group>,
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
        let mut groups: Vec<Group> = Vec::new();
        for &row in &problem.rows {
            let observation = &problem.data.observations[row as usize];
            let framed = match problem.measurement(row as usize) {
                Measurement::Point(_) => false,
                Measurement::Pose(_) => true,
                Measurement::SpatialPose(_) => return None,
            };
            let noise = observation.noise_or(problem.noise);
            let ratio = framed.then(|| noise.position_m / noise.rotation_rad);
            let target = observation.target;
            let known = groups.iter_mut().find(|group| group.target == target && group.plan.framed == framed);
            if let Some(group) = known {
                group.plan.ratio = group.plan.ratio.zip(ratio).and_then(|(known, ratio)| {
                    ((ratio - known).abs() <= SAME_RATIO * known).then_some(known)
                });
                group.rows.push(row);
            } else {
                let mut group = Group::new(problem, target, framed)?;
                group.plan.ratio = ratio;
                group.rows.push(row);
                groups.push(group);
            }
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
        for Group { plan, rows, packed, .. } in &mut self.groups {
            packed.resize_with(rows.len().div_ceil(CHUNK), Rows::default);
            for (rows, packed) in rows.chunks(CHUNK).zip(packed) {
                pack(problem, plan, rows, packed);
            }
        }
    }

    /// Normal information of all rows; with `full` false its `JᵀJ` is left zero.
    pub(super) fn normal(&self, problem: &Problem<'_>, state: &Estimate, full: bool) -> Normal {
        let linkage = Linkage::new(state);
        let steps: Vec<Step> = linkage.steps().iter().map(step).collect();
        let mut normal = Normal::new(problem.layout.dim());
        for group in &self.groups {
            let end = step(linkage.end(group.target));
            let totals = group.sum(problem, self.level, &steps, &end, full);
            group.put(&totals, &mut normal, full);
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
    fn sum(&self, problem: &Problem<'_>, level: Level, steps: &[Step], end: &Step, full: bool) -> Totals {
        let arm = Arm { plan: &self.plan, steps, end };
        let sum = if full { lanes::sum_products } else { lanes::sum_gradient };
        let chunk = |index: usize| match self.packed.get(index) {
            Some(rows) => sum(level, &arm, &rows.blocks),
            None => {
                let last = self.rows.len().min((index + 1) * CHUNK);
                let mut packed = Rows::default();
                pack(problem, &self.plan, &self.rows[index * CHUNK..last], &mut packed);
                sum(level, &arm, &packed.blocks)
            }
        };
        let mut total = chunk(0);
        let chunks: Vec<usize> = (1..self.rows.len().div_ceil(CHUNK)).collect();
        for together in chunks.chunks(TOGETHER) {
            let parts: Vec<Totals> = together.par_iter().map(|&index| chunk(index)).collect();
            parts.iter().for_each(|part| total.add(part));
        }
        total
    }

    /// Puts sums of the group into the problem's normal information.
    fn put(&self, totals: &Totals, normal: &mut Normal, full: bool) {
        let n = normal.dim();
        let places = self.shift_places.iter().chain(&self.turn_places);
        for (value, &place) in totals.gradient.iter().zip(places) {
            normal.gradient[place] += value;
        }
        normal.cost += totals.cost;
        normal.residuals += self.rows.len() * if self.plan.framed { 6 } else { 3 };
        if !full {
            return;
        }
        let mut add = |a: usize, b: usize, value: f64| normal.gram[a.min(b) * n + a.max(b)] += value;
        let columns = self.plan.columns();
        let seen = &self.turn_places[..self.plan.tilts];
        let places: Vec<usize> = self.shift_places.iter().chain(seen).copied().collect();
        for (a, &place) in places.iter().enumerate() {
            for (b, &other) in places.iter().enumerate().skip(a) {
                add(place, other, totals.products[product(columns, a, b)]);
            }
        }
        if !self.plan.framed {
            return;
        }
        let turns = self.turn_places.len();
        let shared = self.plan.ratio.map(|ratio| (ratio / self.plan.length_m).powi(2));
        for (a, (&place, &shift)) in self.turn_places.iter().zip(&self.plan.turns).enumerate() {
            for (b, (&other, &other_shift)) in
                self.turn_places.iter().zip(&self.plan.turns).enumerate().skip(a)
            {
                let own = totals.turned[product(turns, a, b)];
                let (first, second) = (shift.min(other_shift), shift.max(other_shift));
                let of_shifts = totals.products[product(columns, first, second)];
                add(place, other, shared.map_or(own, |factor| factor * (of_shifts + own)));
            }
        }
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
    packed.pack(plan, rows.len(), |at| row_data(problem, rows[at] as usize, plan.framed));
}

fn row_data<'a>(problem: &'a Problem<'_>, row: usize, framed: bool) -> RowData<'a> {
    let observation = &problem.data.observations[row];
    let noise = observation.noise_or(problem.noise);
    let root = problem.weights.and_then(|weights| weights.get(row)).map_or(1.0, |weight| weight.sqrt());
    let (position, orientation) = match problem.measurement(row) {
        Measurement::Point(point) => (point.position, None),
        Measurement::Pose(seen) => (seen.pose.translation, Some(seen.pose.rotation)),
        Measurement::SpatialPose(seen) => (seen.pose.translation, Some(seen.pose.rotation)),
    };
    let ratio = noise.position_m / noise.rotation_rad;
    RowData {
        joints: problem.packed.row(row),
        position: position.into(),
        orientation: orientation.filter(|_| framed).map(|rotation| (rotation.data.0, ratio)),
        weight: root / noise.position_m,
    }
}

fn step(pose: &Pose) -> Step {
    Step { columns: pose.rotation.data.0, translation: pose.translation.into() }
}

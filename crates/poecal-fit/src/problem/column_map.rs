//! Columns of one group of rows: the unknowns that move its target, in the order of the kernels.

use super::form::RowForm;
use super::kernel_columns::{KernelColumns, StepColumn, ValueFactor};
use super::{Layout, Problem};
use crate::parameters::{OtherScrew, Parameter, ParameterSubject};
use crate::state::{ClockTerm, Estimate, PassedJoint, Sight};
use poecal_arm::lie::Freedom;
use poecal_model::robot::JointKind;
use poecal_numerics::kernels::{DevicePlan, JointPlan, KernelPlan, PlaceComponent, TILE, TermPlan};

impl KernelColumns {
    /// Columns for rows of one sight and form. If two parameters belong to one frame, axis or target, the first counts.
    pub(crate) fn new(problem: &Problem<'_>, state: &Estimate, sight: Sight, form: RowForm) -> Self {
        // An instrument's known zero is not in the kernels.
        let is_plain = form != RowForm::Along(PlaceComponent::Distance) || state.range(sight.station).is_plain();
        let form = if is_plain { form } else { form.general() };
        let unknowns = problem.layout.dim();
        let mut made = KernelColumns {
            sight,
            form,
            plan: plan_without_unknowns(problem, state, sight, form),
            shift_places: Vec::with_capacity(unknowns),
            turn_places: Vec::with_capacity(unknowns),
            given_places: Vec::new(),
            screws: Vec::new(),
            ranges: Vec::new(),
            terms: Vec::new(),
        };
        // The kernels' order: device frame, joints, target.
        made.add_device(&problem.layout, state.tree.shared_target(sight.station));
        made.add_joints(&problem.layout, state.tree.route(sight));
        made.plan.tilts = made.turn_places.len();
        made.add_target(&problem.layout);
        made.add_range(&problem.layout);
        made.plan.shifts = made.shift_places.len();
        made.plan.idle = made.idle_tiles();
        made
    }

    /// For each tile of columns, true if none is an unknown; empty if all tiles have one.
    fn idle_tiles(&self) -> Vec<bool> {
        if self.shift_places.iter().all(|place| place.is_unknown()) {
            return Vec::new();
        }
        let places: Vec<StepColumn> = self.step_columns().take(self.plan.columns()).collect();
        places.chunks(TILE).map(|tile| !tile.iter().any(|place| place.is_unknown())).collect()
    }

    /// Columns of the step, in the plan's order: translations, rotations, supplied ones.
    pub(crate) fn step_columns(&self) -> impl Iterator<Item = StepColumn> {
        self.shift_places.iter().chain(&self.turn_places).chain(&self.given_places).copied()
    }

    /// Places of the rotation columns.
    pub(crate) fn turn_places(&self) -> &[StepColumn] {
        &self.turn_places
    }

    /// Length of a row's residual.
    pub(crate) fn numbers(&self) -> usize {
        self.form.numbers()
    }

    /// Places of the six motions of a frame, some of which are unknowns.
    fn frame_places(freedom: Freedom, places: &[(usize, f64)]) -> [Option<(usize, f64)>; 6] {
        let mut all = [None; 6];
        freedom.motions().iter().zip(places).for_each(|(&motion, &place)| all[motion] = Some(place));
        all
    }

    /// Adds translation columns of a frame, and rotation columns about their directions if it turns.
    fn add_frame(&mut self, places: [Option<(usize, f64)>; 6], turns: bool, sign: f64) {
        let first = self.shift_places.len();
        let of = |place: Option<(usize, f64)>| place.map_or(StepColumn::NONE, |(at, _)| StepColumn { at, sign });
        let [shifts @ .., a, b, c] = places;
        self.shift_places.extend(shifts.map(of));
        if turns {
            self.turn_places.extend([a, b, c].map(of));
            self.plan.turns.extend(first..first + 3);
        }
    }

    fn shift(&mut self, places: &[(usize, f64)], sign: f64) {
        self.shift_places.extend(places.iter().map(|&(at, _)| StepColumn { at, sign }));
    }

    /// Adds rotation columns about the directions of the translation columns from `first` on.
    fn turn(&mut self, places: &[(usize, f64)], first: usize, sign: f64) {
        self.turn_places.extend(places.iter().map(|&(at, _)| StepColumn { at, sign }));
        self.plan.turns.extend(first..first + places.len());
    }

    /// Columns of the device's frame, or of the target that carries it: a step of that target moves the base in the opposite direction.
    fn add_device(&mut self, layout: &Layout, shared: Option<usize>) {
        let subject = shared.map_or(ParameterSubject::Instrument(self.sight.station), ParameterSubject::Target);
        for (parameter, places) in layout.parameters() {
            let model = parameter.model();
            if model.subject() != subject || self.plan.device.is_some() {
                continue;
            }
            let (about, freedom, sign) = match parameter {
                Parameter::DeviceFrame(device) => (device.about.into(), device.freedom, 1.0),
                Parameter::TargetFrame(frame) => ([0.0; 3], frame.freedom, -1.0),
                Parameter::TargetPlace(_) => ([0.0; 3], Freedom::PLACE, -1.0),
                Parameter::ScrewAxis(_)
                | Parameter::OtherScrew(_)
                | Parameter::ValueTerm(_)
                | Parameter::RangeUnknown(_)
                | Parameter::ClockUnknown(_) => continue,
            };
            let turns = freedom.turns();
            self.plan.device = Some(DevicePlan { about, turns });
            self.add_frame(Self::frame_places(freedom, places), turns, sign);
        }
    }

    fn add_joints(&mut self, layout: &Layout, route: &[PassedJoint]) {
        let mut of_joints: Vec<(usize, Unknown<'_>)> = Vec::with_capacity(layout.dim());
        for (parameter, places) in layout.parameters() {
            if let ParameterSubject::Joint(joint) = parameter.model().subject() {
                of_joints.push((joint, (parameter, places)));
            }
        }
        of_joints.sort_by_key(|(joint, _)| *joint);
        // A clock moves every joint: a column of each, with one place.
        let of_clocks: Vec<(ClockTerm, &[(usize, f64)])> = layout
            .parameters()
            .filter_map(|(parameter, places)| {
                let Parameter::ClockUnknown(it) = parameter else { return None };
                let is_its = it.station == self.sight.station && self.sight.from.is_none();
                is_its.then_some((it.term, places))
            })
            .collect();
        for (index, passed) in route.iter().enumerate() {
            self.plan.joints[index].terms.0 = self.plan.terms.len();
            let first = of_joints.partition_point(|(joint, _)| *joint < passed.joint);
            let own = of_joints[first..].iter().take_while(|(joint, _)| *joint == passed.joint);
            for &(_, (parameter, places)) in own {
                match parameter {
                    Parameter::ScrewAxis(_) => self.add_axis(index, places),
                    Parameter::ValueTerm(term) => {
                        self.add_term(index, *passed, ValueFactor::Term(term.term), places);
                    }
                    Parameter::OtherScrew(screw) => self.add_given(screw, places),
                    Parameter::DeviceFrame(_)
                    | Parameter::TargetFrame(_)
                    | Parameter::TargetPlace(_)
                    | Parameter::RangeUnknown(_)
                    | Parameter::ClockUnknown(_) => {}
                }
            }
            for &(term, places) in &of_clocks {
                self.add_term(index, *passed, ValueFactor::Clock(term), places);
            }
        }
    }

    fn add_axis(&mut self, index: usize, places: &[(usize, f64)]) {
        let first = self.shift_places.len();
        let joint = &mut self.plan.joints[index];
        if joint.columns.is_some() || joint.turns != (places.len() == 4) {
            return;
        }
        joint.columns = Some((first, self.turn_places.len()));
        self.shift(&places[..2], 1.0);
        self.turn(&places[2..], first, 1.0);
    }

    /// Columns of a screw in another parameterisation, once whether its joint is passed once or twice.
    fn add_given(&mut self, screw: &OtherScrew, places: &[(usize, f64)]) {
        if !self.screws.iter().any(|(known, _)| known == screw) {
            self.given_places.extend(places.iter().map(|&(at, _)| StepColumn { at, sign: 1.0 }));
            self.plan.given += places.len();
            self.screws.push((*screw, places.iter().map(|&(_, scale)| scale).collect()));
        }
    }

    fn add_term(&mut self, index: usize, passed: PassedJoint, factor: ValueFactor, places: &[(usize, f64)]) {
        let shift = self.shift_places.len();
        let joint = &mut self.plan.joints[index];
        joint.terms.1 += 1;
        let turn = joint.turns.then_some(self.turn_places.len());
        self.plan.terms.push(TermPlan { shift, turn });
        // The kernels count a radian as a length, and a metre as one.
        let own = if turn.is_some() { self.plan.length_m } else { 1.0 };
        self.terms.extend(places.iter().map(|&(_, scale)| (passed, factor, own / scale)));
        if turn.is_some() {
            // Direction of the rotation, along which no unknown moves.
            self.shift_places.push(StepColumn::NONE);
            self.turn(places, shift, 1.0);
        } else {
            self.shift(places, 1.0);
        }
    }

    /// Zero and scale of the instrument's distances, behind all other supplied columns.
    fn add_range(&mut self, layout: &Layout) {
        for (parameter, places) in layout.parameters() {
            let Parameter::RangeUnknown(range) = parameter else { continue };
            if range.station == self.sight.station && self.plan.shaped > 0 {
                self.given_places.extend(places.iter().map(|&(at, _)| StepColumn { at, sign: 1.0 }));
                self.ranges.extend(places.iter().map(|&(_, scale)| (range.term, scale)));
                self.plan.given += places.len();
            }
        }
    }

    fn add_target(&mut self, layout: &Layout) {
        for (parameter, places) in layout.parameters() {
            if parameter.model().subject() != ParameterSubject::Target(self.sight.target) || self.plan.place.is_some() {
                continue;
            }
            let freedom = match parameter {
                Parameter::TargetFrame(frame) => frame.freedom,
                Parameter::TargetPlace(_)
                | Parameter::DeviceFrame(_)
                | Parameter::ScrewAxis(_)
                | Parameter::OtherScrew(_)
                | Parameter::ValueTerm(_)
                | Parameter::RangeUnknown(_)
                | Parameter::ClockUnknown(_) => Freedom::PLACE,
            };
            let turns = freedom.turns() && self.plan.framed;
            self.plan.place = Some(self.shift_places.len());
            if turns {
                self.plan.frame = Some(self.turn_places.len());
            }
            self.add_frame(Self::frame_places(freedom, places), turns, 1.0);
        }
    }
}

/// A parameter with the places of its unknowns.
type Unknown<'a> = (&'a Parameter, &'a [(usize, f64)]);

fn plan_without_unknowns(problem: &Problem<'_>, state: &Estimate, sight: Sight, form: RowForm) -> KernelPlan {
    let route = state.tree.route(sight);
    let joints = route.iter().map(|passed| JointPlan {
        terms: (0, 0),
        turns: state.kinds()[passed.joint] == JointKind::Revolute,
        columns: None,
    });
    KernelPlan {
        joints: joints.collect(),
        terms: Vec::new(),
        in_order: !state.moves_values()
            && !problem.layout.moves_values()
            && route.len() == state.kinds().len()
            && route.iter().enumerate().all(|(index, passed)| passed.joint == index && !passed.backward),
        device: None,
        place: None,
        frame: None,
        shifts: 0,
        tilts: 0,
        turns: Vec::with_capacity(problem.layout.dim()),
        idle: Vec::new(),
        length_m: problem.layout.length_m(),
        given: 0,
        framed: form.sees_orientation(),
        shaped: match form {
            RowForm::Point | RowForm::Pose | RowForm::Along(_) => 0,
            RowForm::Shaped(numbers, _) => numbers,
        },
        along: if let RowForm::Along(along) = form { Some(along) } else { None },
        ratio: None,
    }
}

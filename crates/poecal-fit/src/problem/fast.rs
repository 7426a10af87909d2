//! The hot path: rows grouped by instrument, target and form, packed side by side, and summed by [`poecal_numerics::kernels`].

use super::Problem;
use super::groups::{Accumulate, FastRows, KernelGroup, SecondDifference};
use super::kernel_columns::{KernelColumns, ValueFactor};
use super::row_group::{RowGroup, Whitening};
use super::scatter::GramScatter;
use crate::parameters::ParameterColumns as _;
use crate::state::{Estimate, Linkage, PassedJoint, RowChain, Sight};
use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_model::measurement::{Kernel, NUMBERS, Noise};
use poecal_numerics::kernels::{
    self as lanes, ArmAtEstimate, FixedMotion, PackedRows, PassTotals, RowFunctions, ShapedRow, SimdLevel, UnpackedRow,
    WIDTH,
};
use poecal_numerics::solve::NormalEquations;
use poecal_numerics::threads;
use std::cell::RefCell;

/// Largest number of rows of one partial sum.
const CHUNK: usize = 1024;
/// Partial sums held at a time, so that memory beside the data stays bounded.
const TOGETHER: usize = 64;
/// Largest number of rows that stay packed. Larger problems are repacked in every pass: 10 % of its time, cheaper than page faults on new
/// memory.
const KEPT: usize = 2048;

thread_local! {
    /// Buffer of a chunk that does not stay packed.
    pub(crate) static ROWS: RefCell<PackedRows> = const { RefCell::new(PackedRows::EMPTY) };
}

impl FastRows {
    /// Groups the rows of a problem.
    pub(crate) fn new(problem: &Problem<'_>, state: &Estimate, level: SimdLevel) -> Self {
        FastRows::from_groups(problem, state, level, RowGroup::of_problem(problem), None)
    }

    /// The same groups for the second derivative of the residuals along a step, which replaces the residuals.
    pub(crate) fn with_second_difference(problem: &Problem<'_>, state: &Estimate, second: SecondDifference) -> Self {
        let mut groups = RowGroup::of_problem(problem);
        groups.iter_mut().for_each(|group| {
            group.form = group.form.general();
            group.ratio = None;
        });
        FastRows::from_groups(problem, state, problem.level, groups, Some(second))
    }

    fn from_groups(
        problem: &Problem<'_>,
        state: &Estimate,
        level: SimdLevel,
        of_rows: Vec<RowGroup>,
        second: Option<SecondDifference>,
    ) -> Self {
        let mut groups = Vec::new();
        for group in of_rows {
            let mut arranged = KernelColumns::new(problem, state, group.sight, group.form);
            arranged.plan.ratio = group.ratio;
            let keeps = problem.rows.len() <= KEPT && !(state.moves_values() || problem.layout.moves_values());
            let scatter = GramScatter::new(&arranged, problem.layout.dim());
            groups.push((KernelGroup { arranged, rows: group.rows, keeps, packed: Vec::new() }, scatter));
        }
        let mut fast = FastRows { groups, level, linkage: Linkage::new(state), second };
        fast.pack(problem);
        fast
    }

    /// Packs the rows of small problems, unless joint values depend on the state.
    pub(crate) fn pack(&mut self, problem: &Problem<'_>) {
        let FastRows { groups, linkage, .. } = self;
        for (KernelGroup { arranged, rows, packed, .. }, _) in groups.iter_mut().filter(|(group, _)| group.keeps) {
            let size = chunk_size(rows.len());
            packed.resize_with(rows.len().div_ceil(size), PackedRows::default);
            for (rows, packed) in rows.chunks(size).zip(packed) {
                pack(problem, linkage, arranged, rows, packed);
            }
        }
    }

    /// Normal information of all rows, theory.md §6 (28); without `JᵀJ` if only the gradient is needed.
    pub(crate) fn normal(&self, problem: &Problem<'_>, state: &Estimate, sums: Accumulate) -> NormalEquations {
        let linkage = Linkage::new(state);
        let mut normal = match sums {
            Accumulate::Gradient => NormalEquations::new(0),
            Accumulate::All | Accumulate::GaussNewton => NormalEquations::new(problem.layout.dim()),
        };
        normal.gradient.resize(problem.layout.dim(), 0.0);
        for (group, scatter) in &self.groups {
            let KernelColumns { sight, plan, .. } = &group.arranged;
            let (steps, end) = fixed_motions(&linkage, *sight);
            let nearly = sums == Accumulate::GaussNewton;
            let arm = ArmAtEstimate { plan, steps: &steps, end: &end, shape: None, nearly };
            let totals = group.sum(problem, (&linkage, self.second.as_ref()), self.level, &arm, sums);
            group.put(&totals, &mut normal);
            if sums != Accumulate::Gradient {
                scatter.add(&totals, &mut normal.gram);
            }
        }
        normal
    }
}

impl KernelGroup {
    /// Sums over all rows of the group, in the order of its chunks whatever the number of threads.
    fn sum(
        &self,
        problem: &Problem<'_>,
        (linkage, second): (&Linkage, Option<&SecondDifference>),
        level: SimdLevel,
        arm: &ArmAtEstimate<'_>,
        sums: Accumulate,
    ) -> PassTotals {
        let sum = match (sums, self.arranged.plan.is_plain()) {
            (Accumulate::Gradient, true) => lanes::sum_plain_gradient,
            (Accumulate::Gradient, false) => lanes::sum_gradient,
            (Accumulate::All | Accumulate::GaussNewton, true) => lanes::sum_plain_products,
            (Accumulate::All | Accumulate::GaussNewton, false) => lanes::sum_products,
        };
        let size = chunk_size(self.rows.len());
        let chunk = |index: usize| {
            let last = self.rows.len().min((index + 1) * size);
            let rows = &self.rows[index * size..last];
            let shapes = RowShapes { problem, linkage, second, arranged: &self.arranged, rows };
            let arm = &ArmAtEstimate { shape: shapes.as_shape(), ..*arm };
            match self.packed.get(index) {
                Some(rows) => sum(level, arm, &rows.blocks),
                None => {
                    let mut packed = ROWS.take();
                    pack(problem, linkage, &self.arranged, rows, &mut packed);
                    let totals = sum(level, arm, &packed.blocks);
                    ROWS.set(packed);
                    totals
                }
            }
        };
        let chunks = self.rows.len().div_ceil(size);
        if chunks <= 1 {
            return chunk(0);
        }
        let mut total: Option<PassTotals> = None;
        for first in (0..chunks).step_by(TOGETHER) {
            let together = first..chunks.min(first + TOGETHER);
            for part in threads::map_parts(together.len(), |index| chunk(first + index)) {
                match &mut total {
                    Some(total) => total.add(&part),
                    None => total = Some(part),
                }
            }
        }
        // Here there is more than one chunk.
        total.unwrap_or_else(|| chunk(0))
    }

    /// Adds cost and gradient of the group to the problem's normal information.
    fn put(&self, totals: &PassTotals, normal: &mut NormalEquations) {
        let places = self.arranged.step_columns();
        for (value, place) in totals.gradient.iter().zip(places).filter(|(_, place)| place.is_unknown()) {
            normal.gradient[place.at] += place.sign * value;
        }
        normal.cost += totals.cost;
        normal.residuals += self.rows.len() * self.arranged.numbers();
    }
}

/// Rows with functions of their targets' poses, or unknowns, that the kernels do not have.
pub(crate) struct RowShapes<'a> {
    pub(crate) problem: &'a Problem<'a>,
    pub(crate) linkage: &'a Linkage,
    pub(crate) second: Option<&'a SecondDifference>,
    pub(crate) arranged: &'a KernelColumns,
    pub(crate) rows: &'a [u32],
}

impl RowShapes<'_> {
    /// These shapes, if the plan needs them.
    pub(crate) fn as_shape(&self) -> Option<&dyn RowFunctions> {
        (self.arranged.plan.shaped > 0).then_some(self)
    }

    /// Whitened columns of screws in another parameterisation, by their own formulas.
    fn give(&self, row: usize, shaped: &ShapedRow, given: &mut [[f64; NUMBERS]]) {
        let session = self.problem.session;
        let mut chain = RowChain::default();
        chain.evaluate(self.linkage, session.packed, row, &session.data.observations[row]);
        let mut rest = given.iter_mut();
        for (screw, scales) in &self.arranged.screws {
            let mut twists = [(Vector3::zeros(), Vector3::zeros()); 6];
            screw.target_twists(&chain, self.arranged.sight.target, &mut twists[..scales.len()]);
            for (((v, w), scale), out) in twists.iter().zip(scales).zip(&mut rest) {
                *out = shaped
                    .sensitivity
                    .map(|[a, b, c, p, q, r]| (a * v.x + b * v.y + c * v.z + p * w.x + q * w.y + r * w.z) / scale);
            }
        }
    }
}

impl RowFunctions for RowShapes<'_> {
    fn row(&self, place: usize, predicted: &Pose, given: &mut [[f64; NUMBERS]]) -> ShapedRow {
        let Some(&row) = self.rows.get(place) else { return ShapedRow::NONE };
        let range = self.linkage.range(self.arranged.sight.station);
        let mut shaped = self.problem.shape_row(row as usize, predicted, range);
        if !given.is_empty() {
            let (screws, ranges) = given.split_at_mut(given.len() - self.arranged.ranges.len());
            self.give(row as usize, &shaped, screws);
            self.problem.range_columns(row as usize, predicted, range, &self.arranged.ranges, ranges);
        }
        if let Some(second) = self.second {
            self.problem.second_difference(row as usize, second, &mut shaped);
        }
        shaped
    }
}

/// Relative frames of a sight, and its target in the last one, or in the device frame if no joint is between the two.
pub(crate) fn fixed_motions(linkage: &Linkage, sight: Sight) -> (Vec<FixedMotion>, FixedMotion) {
    let (steps, end) = linkage.frames(sight);
    let end = linkage.fixed_device_frame(sight).map_or(*end, |&device| device * *end);
    (steps.map(FixedMotion::from).collect(), FixedMotion::from(&end))
}

/// Number of rows of each partial sum: about equal parts, so that threads finish together. It is independent of the number of
/// threads, as is the result.
fn chunk_size(rows: usize) -> usize {
    rows.div_ceil(rows.div_ceil(CHUNK).max(1)).next_multiple_of(WIDTH).max(WIDTH)
}

/// Packs rows side by side, with the joint values of a state.
pub(crate) fn pack(
    problem: &Problem<'_>,
    linkage: &Linkage,
    arranged: &KernelColumns,
    rows: &[u32],
    packed: &mut PackedRows,
) {
    let KernelColumns { sight, plan, terms, .. } = arranged;
    let session = problem.session;
    let station = rows.first().map_or(0, |&row| session.observation(row).station);
    let noise = session.usual_noise(station, problem.noise);
    let usual = (noise, Whitening::new(noise));
    let route = linkage.tree().route(*sight);
    // The places are looked up once for all rows.
    let place = |(passed, factor, _): &(PassedJoint, ValueFactor, f64)| match factor {
        ValueFactor::Term(term) => session.packed.place_of(passed.joint, *term),
        ValueFactor::Clock(_) => None,
    };
    let places: Vec<Option<usize>> = terms.iter().map(place).collect();
    let is_pose = plan.is_pose();
    packed.pack(
        plan,
        rows.len(),
        #[inline(always)]
        |at| row_data(problem, usual, rows[at] as usize, is_pose),
        |at, joint| {
            let sight = Sight::from(session.observation(rows[at]));
            let (_, first, second) = linkage.joint_value(route[joint], session.packed, rows[at] as usize, sight);
            (first, second)
        },
        |at, term| {
            let (place, (passed, factor, scale), row) = (places[term], terms[term], rows[at] as usize);
            let basis = scale
                * match factor {
                    ValueFactor::Term(term) => {
                        let from = session.observation(rows[at]).from.filter(|_| passed.backward);
                        session.packed.basis_at(row, from, place, (passed.joint, term))
                    }
                    ValueFactor::Clock(term) => session.packed.motion(row).map_or(0.0, |(rates, time_s)| {
                        term.factor(time_s) * rates.get(passed.joint).copied().unwrap_or_default()
                    }),
                };
            if passed.backward { -basis } else { basis }
        },
    );
}

#[inline(always)]
fn row_data<'a>(
    problem: &'a Problem<'_>,
    (noise, usual): (Noise, Whitening),
    row: usize,
    is_pose: bool,
) -> UnpackedRow<'a> {
    let observation = &problem.session.data.observations[row];
    let joints = problem.session.packed.row(row);
    let measured = problem.measurement(row);
    let [x, y, z, columns @ ..] = measured.values();
    let position = match measured.function().kernel {
        Kernel::Pose | Kernel::Place | Kernel::Distance | Kernel::Any => [*x, *y, *z],
        Kernel::Height => [0.0, 0.0, *x],
    };
    if !measured.is_place() {
        let weight = 1.0 / problem.noise(row)[measured.function().leading_quantity()];
        return UnpackedRow { joints, position, orientation: None, weight };
    }
    let orientation = is_pose.then(|| columns.as_chunks::<3>().0.first_chunk::<3>()).flatten();
    let Whitening { weight, ratio } = usual.whitening_of_row(observation, noise);
    let weight = match problem.weights.and_then(|weights| weights.get(row)) {
        Some(own) => own.sqrt() * weight,
        None => weight,
    };
    let orientation = orientation.map(|columns| (columns, ratio));
    UnpackedRow { joints, position, orientation, weight }
}

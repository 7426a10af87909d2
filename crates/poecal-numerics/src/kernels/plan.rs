//! Input of the kernels: an arm's frames, its columns, and rows side by side.

use super::gram::TILE;
use super::rows::RowFunctions;
use super::vector::{LaneBlock, WIDTH};
use poecal_arm::lie::Pose;

/// A fixed motion: three columns of a rotation, and a translation in metres.
#[derive(Clone, Copy, Debug)]
pub struct FixedMotion {
    pub(crate) columns: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
}

impl From<&Pose> for FixedMotion {
    fn from(pose: &Pose) -> Self {
        FixedMotion { columns: pose.rotation.data.0, translation: pose.translation.into() }
    }
}

/// A joint on the kinematic chain to the target.
#[derive(Clone, Copy, Debug)]
pub struct JointPlan {
    /// True if it is revolute.
    pub turns: bool,
    /// First translation and rotation column, if its axis is unknown.
    pub columns: Option<(usize, usize)>,
    /// First unknown term among all, and their number.
    pub terms: (usize, usize),
}

/// An unknown term of a joint's value: its translation column and, for a revolute joint, its rotation column. The translation column of
/// a revolute joint is only the direction of that rotation, and no unknown.
#[derive(Clone, Copy, Debug)]
pub struct TermPlan {
    /// Translation column.
    pub shift: usize,
    /// Rotation column.
    pub turn: Option<usize>,
}

/// An unknown device frame: the first three translation columns, and the first three rotation columns if it `turns`.
#[derive(Clone, Copy, Debug)]
pub struct DevicePlan {
    /// Point about which it rotates.
    pub about: [f64; 3],
    /// True if it rotates.
    pub turns: bool,
}

/// One number of a target's position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceComponent {
    /// Height, along the device's z.
    Height,
    /// Distance from the device's origin.
    Distance,
}

/// Columns of one group of rows: *shifts* are translation columns (a direction times the row's weight); *turns* are rotation columns
/// about the direction of one of the shifts, `w = v / L`, of which the first `tilts` also translate.
#[derive(Clone, Debug)]
pub struct KernelPlan {
    /// Columns of the joints.
    pub joints: Vec<JointPlan>,
    /// True if these are all joints of a row in their order, none backward, and their values do not depend on the estimate.
    pub in_order: bool,
    /// Unknown terms, joint after joint.
    pub terms: Vec<TermPlan>,
    /// The device frame, if it is unknown.
    pub device: Option<DevicePlan>,
    /// First translation column of the target's position, if that is unknown.
    pub place: Option<usize>,
    /// First rotation column of the target's frame, if that is unknown.
    pub frame: Option<usize>,
    /// Number of translation columns.
    pub shifts: usize,
    /// Number of rotation columns that also translate.
    pub tilts: usize,
    /// The translation column of each rotation column.
    pub turns: Vec<usize>,
    /// For each tile of columns, true if they are all directions of rotation columns and no unknowns; empty if none is.
    pub idle: Vec<bool>,
    /// Metres that a radian counts.
    pub length_m: f64,
    /// True if the rows depend on the target's orientation.
    pub framed: bool,
    /// Number of columns that the rows themselves supply, after all others.
    pub given: usize,
    /// Numbers of each row, if they are another function of the target's pose than its position and orientation ([`ArmAtEstimate::shape`]); else 0.
    pub shaped: usize,
    /// The direction along which a row measured one number, if it did not measure a position.
    pub along: Option<PlaceComponent>,
    /// Position over rotation noise in m/rad, if it is the same in all rows: rotation products then follow from those of the translation
    /// columns (theory.md §6 (28a)).
    pub ratio: Option<f64>,
}

impl KernelPlan {
    /// Columns of position rows; all columns of shaped rows.
    pub fn columns(&self) -> usize {
        self.shifts + if self.shaped > 0 { self.turns.len() + self.given } else { self.tilts }
    }

    /// Groups of three numbers of a row whose products are summed at once.
    pub(crate) fn slots(&self) -> usize {
        self.shaped.div_ceil(3).max(1)
    }

    /// True if the products of the tile at these two columns are needed. Those of directions are needed only with each other's translation
    /// columns, from which the products of rotations follow (theory.md §6 (28a)), and only if an orientation was measured.
    #[inline(always)]
    pub(crate) fn needs(&self, column: usize, other: usize) -> bool {
        let is_idle = |column: usize| self.idle.get(column / TILE).copied().unwrap_or(false);
        let both_shift = column.max(other) < self.shifts;
        !is_idle(column) && !is_idle(other) || self.is_pose() && both_shift
    }

    /// True if the rows are positions and poses of an arm whose joints have no unknown terms: these have kernels of their own, without all
    /// else.
    pub fn is_plain(&self) -> bool {
        self.shaped == 0 && self.along.is_none() && self.terms.is_empty()
    }

    /// True if a row has a measured orientation beside its position.
    pub fn is_pose(&self) -> bool {
        self.framed && self.shaped == 0
    }

    /// Number of rows that rotation adds to the products of rotation columns. Two are of the curvature of the logarithm, which may be
    /// left out. All three are added if the ratio of noises differs between rows (theory.md §6 (28a)).
    pub(crate) fn turned_rows(&self, nearly: bool) -> usize {
        match (self.is_pose(), self.ratio) {
            (false, _) => 0,
            (true, Some(_)) => {
                if nearly {
                    0
                } else {
                    2
                }
            }
            (true, None) => 3,
        }
    }

    /// Wide numbers of a block of [`WIDTH`] rows: the weight `1/σ` and the ratio of noises, the measured position, the columns of a
    /// measured orientation, `(cos θ, sin θ)` or `(θ, 0)` of each joint, and the factor of each unknown term.
    pub fn block_len(&self) -> usize {
        let seen = if self.is_pose() { 12 } else { 3 };
        2 + seen + 2 * self.joints.len() + self.terms.len()
    }
}

/// Rows side by side, in blocks of [`WIDTH`]; the last is padded with rows of weight zero.
#[derive(Clone, Debug, Default)]
pub struct PackedRows {
    /// The numbers of one block after another.
    pub blocks: Vec<LaneBlock>,
}

/// One row to be packed.
pub struct UnpackedRow<'a> {
    /// `(cos θ, sin θ)` or `(θ, 0)` of each joint.
    pub joints: &'a [(f64, f64)],
    /// The measured position in the device frame, metres.
    pub position: [f64; 3],
    /// Columns of the measured orientation, and position over rotation noise.
    pub orientation: Option<(&'a [[f64; 3]; 3], f64)>,
    /// `1/σ` of a position component, or zero.
    pub weight: f64,
}

impl PackedRows {
    /// No rows.
    pub const EMPTY: PackedRows = PackedRows { blocks: Vec::new() };

    /// Packs rows in place of those packed before. If joints are not in order, `joint` writes the values of each on the chain, with minus
    /// the value of one passed backward; `term` returns the factor of each unknown term.
    #[inline(always)]
    pub fn pack<'a>(
        &mut self,
        plan: &KernelPlan,
        count: usize,
        row: impl Fn(usize) -> UnpackedRow<'a>,
        joint: impl Fn(usize, usize) -> (f64, f64),
        term: impl Fn(usize, usize) -> f64,
    ) {
        let len = plan.block_len();
        let blocks = count.div_ceil(WIDTH);
        self.blocks.resize(blocks * len, LaneBlock::ZERO);
        for (index, block) in self.blocks.chunks_exact_mut(len).enumerate() {
            let first = index * WIDTH;
            // The last block is padded with its last row, at weight zero.
            let at = |lane: usize| (first + lane).min(count - 1);
            // Rows are made one by one: functions that build arrays may not be inlined, and each row then costs calls.
            let [a, b, c, d, e, f, g, h] = [0, 1, 2, 3, 4, 5, 6, 7].map(at);
            let rows: [UnpackedRow<'a>; WIDTH] = [row(a), row(b), row(c), row(d), row(e), row(f), row(g), row(h)];
            put(plan, block, &rows);
            if !plan.in_order {
                let (_, joints) = block.split_at_mut(len - plan.terms.len() - 2 * plan.joints.len());
                let (joints, terms) = joints.split_at_mut(2 * plan.joints.len());
                for (k, pair) in joints.as_chunks_mut::<2>().0.iter_mut().enumerate() {
                    for lane in 0..WIDTH {
                        (pair[0].0[lane], pair[1].0[lane]) = joint(at(lane), k);
                    }
                }
                for (k, wide) in terms.iter_mut().enumerate() {
                    *wide = LaneBlock(std::array::from_fn(|lane| term(at(lane), k)));
                }
            }
            if let Some(weights) = block.first_mut() {
                weights.0[(count - first).min(WIDTH)..].fill(0.0);
            }
        }
    }
}

/// Writes a block, number after number, each of all rows.
#[inline(always)]
fn put(plan: &KernelPlan, block: &mut [LaneBlock], rows: &[UnpackedRow<'_>; WIDTH]) {
    let Some((noise, rest)) = block.split_first_chunk_mut::<2>() else { return };
    noise[0] = LaneBlock(std::array::from_fn(|lane| rows[lane].weight));
    noise[1] = LaneBlock(std::array::from_fn(|lane| rows[lane].orientation.map_or(0.0, |(_, ratio)| ratio)));
    let Some((position, rest)) = rest.split_first_chunk_mut::<3>() else { return };
    for (k, wide) in position.iter_mut().enumerate() {
        *wide = LaneBlock(std::array::from_fn(|lane| rows[lane].position[k]));
    }
    let (turned, joints) = rest.split_at_mut(if rows[0].orientation.is_some() { 9 } else { 0 });
    if let [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f), Some(g), Some(h)] =
        rows.each_ref().map(|row| row.orientation.map(|(columns, _)| columns))
    {
        let columns = [a, b, c, d, e, f, g, h];
        for (k, wide) in turned.iter_mut().enumerate() {
            *wide = LaneBlock(std::array::from_fn(|lane| columns[lane][k / 3][k % 3]));
        }
    }
    if !plan.in_order {
        return;
    }
    let values = rows.each_ref().map(|row| row.joints);
    for (joint, pair) in joints.as_chunks_mut::<2>().0.iter_mut().enumerate() {
        for (lane, values) in values.iter().enumerate() {
            let (cosine, sine) = values[joint];
            pair[0].0[lane] = cosine;
            pair[1].0[lane] = sine;
        }
    }
}

/// An arm at an estimate: its columns, its relative frames at zero joint values, and the target in the last one.
#[derive(Clone, Copy)]
pub struct ArmAtEstimate<'a> {
    /// Columns.
    pub plan: &'a KernelPlan,
    /// Frame of each joint in the one before, at zero joint values.
    pub steps: &'a [FixedMotion],
    /// The target in the last frame.
    pub end: &'a FixedMotion,
    /// The rows' own functions, if they have them ([`KernelPlan::shaped`]).
    pub shape: Option<&'a dyn RowFunctions>,
    /// True if the products may omit the curvature of the logarithm, to save time (theory.md §6 (28a)).
    pub nearly: bool,
}

//! What the kernels are told: an arm's frames, its unknowns, and rows side by side.

use super::vector::{WIDTH, Wide};
use crate::lie::Pose;

/// A fixed motion: three columns of a rotation, and a translation in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) columns: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
}

impl From<&Pose> for Step {
    fn from(pose: &Pose) -> Self {
        Step { columns: pose.rotation.data.0, translation: pose.translation.into() }
    }
}

/// A joint: whether it turns, and its first shift column and turn, if its axis is unknown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointPlan {
    pub(crate) turns: bool,
    pub(crate) columns: Option<(usize, usize)>,
}

/// Columns of one group of rows: *shifts* are translation columns (a direction times the row's weight); *turns* are rotation columns
/// about the direction of one of the shifts, `w = v / L`, of which the first `tilts` also translate.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) joints: Vec<JointPlan>,
    /// The point about which the device's frame is turned, if that is unknown: three shifts and three turns, the first ones.
    pub(crate) device: Option<[f64; 3]>,
    /// First shift of the target's place, if that is unknown.
    pub(crate) place: Option<usize>,
    /// First turn of the target's frame, if that is unknown.
    pub(crate) frame: Option<usize>,
    pub(crate) shifts: usize,
    pub(crate) tilts: usize,
    /// The shift of each turn.
    pub(crate) turns: Vec<usize>,
    /// How many metres a radian counts.
    pub(crate) length_m: f64,
    /// Whether orientation was measured.
    pub(crate) framed: bool,
    /// Position over rotation noise in m/rad, if it is the same in all rows: rotation products then follow from those of shifts.
    pub(crate) ratio: Option<f64>,
}

impl Plan {
    /// Columns of position rows.
    pub(crate) fn columns(&self) -> usize {
        self.shifts + self.tilts
    }

    /// Rows of what rotation adds to the products of turns; none if it is the curvature of the logarithm alone, and that may be left out.
    pub(super) fn turned_rows(&self, nearly: bool) -> usize {
        match (self.framed, self.ratio) {
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

    /// Wide numbers of a block of [`WIDTH`] rows: the weight `1/σ` and the ratio of noises, the measured position, where orientation
    /// was measured its columns; and `(cos θ, sin θ)` or `(θ, 0)` a joint.
    pub(crate) fn block_len(&self) -> usize {
        let seen = if self.framed { 12 } else { 3 };
        2 + seen + 2 * self.joints.len()
    }
}

/// Rows side by side, in blocks of [`WIDTH`]; the last is filled up with rows of no weight.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    pub(crate) blocks: Vec<Wide>,
}

/// One row to be packed.
pub(crate) struct RowData<'a> {
    /// `(cos θ, sin θ)` or `(θ, 0)` of each joint.
    pub(crate) joints: &'a [(f64, f64)],
    pub(crate) position: &'a [f64; 3],
    /// Columns of the measured orientation, and position over rotation noise.
    pub(crate) orientation: Option<(&'a [[f64; 3]; 3], f64)>,
    /// `1/σ` of a position component, or zero.
    pub(crate) weight: f64,
}

impl Rows {
    pub(crate) const EMPTY: Rows = Rows { blocks: Vec::new() };

    /// Packs rows, whatever was packed before.
    #[inline(always)]
    pub(crate) fn pack<'a>(&mut self, plan: &Plan, count: usize, row: impl Fn(usize) -> RowData<'a>) {
        let len = plan.block_len();
        let blocks = count.div_ceil(WIDTH);
        self.blocks.resize(blocks * len, Wide::ZERO);
        for (index, block) in self.blocks.chunks_exact_mut(len).enumerate() {
            let first = index * WIDTH;
            // What fills up the last block is its last row, without weight.
            let rows: [RowData<'a>; WIDTH] = std::array::from_fn(|lane| row((first + lane).min(count - 1)));
            put(block, &rows);
            if let Some(weights) = block.first_mut() {
                weights.0[(count - first).min(WIDTH)..].fill(0.0);
            }
        }
    }
}

/// Writes a block, a number of all rows after the other.
#[inline(always)]
fn put(block: &mut [Wide], rows: &[RowData<'_>; WIDTH]) {
    let Some((noise, rest)) = block.split_first_chunk_mut::<2>() else { return };
    noise[0] = Wide(std::array::from_fn(|lane| rows[lane].weight));
    noise[1] = Wide(std::array::from_fn(|lane| rows[lane].orientation.map_or(0.0, |(_, ratio)| ratio)));
    let Some((position, rest)) = rest.split_first_chunk_mut::<3>() else { return };
    for (k, wide) in position.iter_mut().enumerate() {
        *wide = Wide(std::array::from_fn(|lane| rows[lane].position[k]));
    }
    let (turned, joints) = rest.split_at_mut(if rows[0].orientation.is_some() { 9 } else { 0 });
    if let [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f), Some(g), Some(h)] =
        rows.each_ref().map(|row| row.orientation.map(|(columns, _)| columns))
    {
        let columns = [a, b, c, d, e, f, g, h];
        for (k, wide) in turned.iter_mut().enumerate() {
            *wide = Wide(std::array::from_fn(|lane| columns[lane][k / 3][k % 3]));
        }
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

/// An arm as it stands: what is unknown of it, its frames at zero, and the way from the last one to the target.
#[derive(Clone, Copy)]
pub(crate) struct Arm<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) steps: &'a [Step],
    pub(crate) end: &'a Step,
    /// Whether the curvature of the logarithm may be left out of the products where that spares time (theory.md §6 (28a)).
    pub(crate) nearly: bool,
}

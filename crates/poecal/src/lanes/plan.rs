//! What the kernels are told: an arm's frames, its unknowns, and rows side by side.

use super::vector::{WIDTH, Wide};

/// A fixed motion: three columns of a rotation, and a translation in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) columns: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
}

/// A joint: whether it turns, and its first shift column and turn, if its axis is unknown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointPlan {
    pub(crate) turns: bool,
    pub(crate) columns: Option<(usize, usize)>,
}

/// How the unknowns of one kind of row are arranged. *Shifts* move the target by a direction (times the row's weight); a *turn* turns
/// about the direction of one of the shifts, `w = v / L`, and those before `tilts` move the target besides.
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

    /// Rows of what rotation adds to the products of turns.
    pub(super) fn turned_rows(&self) -> usize {
        match (self.framed, self.ratio) {
            (false, _) => 0,
            (true, Some(_)) => 2,
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
    pub(crate) position: [f64; 3],
    /// Columns of the measured orientation, and position over rotation noise.
    pub(crate) orientation: Option<([[f64; 3]; 3], f64)>,
    /// `1/σ` of a position component, or zero.
    pub(crate) weight: f64,
}

impl Rows {
    /// Packs rows, whatever was packed before.
    pub(crate) fn pack<'a>(&mut self, plan: &Plan, count: usize, row: impl Fn(usize) -> RowData<'a>) {
        let len = plan.block_len();
        let blocks = count.div_ceil(WIDTH);
        self.blocks.resize(blocks * len, Wide::ZERO);
        for (index, block) in self.blocks.chunks_exact_mut(len).enumerate() {
            for lane in 0..WIDTH {
                let at = index * WIDTH + lane;
                let data = row(at.min(count - 1));
                put(block, lane, &data, if at < count { data.weight } else { 0.0 });
            }
        }
    }
}

#[inline(always)]
fn put(block: &mut [Wide], lane: usize, data: &RowData<'_>, weight: f64) {
    let Some((noise, rest)) = block.split_first_chunk_mut::<2>() else { return };
    noise[0].0[lane] = weight;
    noise[1].0[lane] = data.orientation.map_or(0.0, |(_, ratio)| ratio);
    let Some((position, rest)) = rest.split_first_chunk_mut::<3>() else { return };
    for (wide, number) in position.iter_mut().zip(data.position) {
        wide.0[lane] = number;
    }
    let columns = data.orientation.as_ref().map_or(&[] as &[f64], |(columns, _)| columns.as_flattened());
    let (turned, joints) = rest.split_at_mut(columns.len());
    for (wide, number) in turned.iter_mut().zip(columns) {
        wide.0[lane] = *number;
    }
    for (pair, &(cosine, sine)) in joints.as_chunks_mut::<2>().0.iter_mut().zip(data.joints) {
        pair[0].0[lane] = cosine;
        pair[1].0[lane] = sine;
    }
}

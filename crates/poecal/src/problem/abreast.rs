//! Jacobian and residuals of several rows side by side.

use super::Problem;
use super::alike::Alike;
use super::arrangement::Arrangement;
use super::fast::{ROWS, pack};
use crate::estimate::{Estimate, Linkage};
use crate::lanes::{self, Arm, NUMBERS, Step, WIDTH, Wide};

/// Whitened Jacobian of the prediction and residuals of up to [`WIDTH`] rows, one a lane: three numbers of the position, three of the
/// rotation. What a row does not have is zero.
pub(crate) struct Abreast {
    /// Column after column.
    pub(crate) jacobian: Vec<[Wide; NUMBERS]>,
    pub(crate) residual: [Wide; NUMBERS],
    /// Numbers that each row has.
    pub(crate) numbers: [usize; WIDTH],
}

impl Abreast {
    fn new(n: usize) -> Self {
        Abreast {
            jacobian: vec![[Wide::ZERO; NUMBERS]; n],
            residual: [Wide::ZERO; NUMBERS],
            numbers: [0; WIDTH],
        }
    }

    fn clear(&mut self) {
        self.jacobian.fill([Wide::ZERO; NUMBERS]);
        self.residual = [Wide::ZERO; NUMBERS];
        self.numbers = [0; WIDTH];
    }
}

impl Problem<'_> {
    /// Gives [`WIDTH`] of some rows of the data after the other, by their places among these, in any order; what is given may be used
    /// up.
    pub(crate) fn for_rows_abreast(
        &self,
        state: &Estimate,
        rows: &[u32],
        mut each: impl FnMut(&[u32], &mut Abreast),
    ) {
        let mut abreast = Abreast::new(self.layout().dim());
        match self.arranged(state, rows) {
            Some(groups) => {
                groups.iter().for_each(|group| self.by_kernel(state, rows, group, &mut abreast, &mut each));
            }
            None => self.one_by_one(state, rows, &mut abreast, &mut each),
        }
    }

    /// Places of rows that are computed alike, if the kernels serve them.
    fn arranged(&self, state: &Estimate, rows: &[u32]) -> Option<Vec<(Arrangement, Vec<u32>)>> {
        if !self.is_served(state) {
            return None;
        }
        let alike = Alike::of(self, rows, |place, _| place).into_iter();
        alike.map(|it| Some((Arrangement::new(self, it.sight, it.framed)?, it.rows))).collect()
    }

    fn by_kernel(
        &self,
        state: &Estimate,
        rows: &[u32],
        (arranged, places): &(Arrangement, Vec<u32>),
        abreast: &mut Abreast,
        each: &mut impl FnMut(&[u32], &mut Abreast),
    ) {
        let linkage = Linkage::new(state);
        let mut steps: Vec<Step> = linkage.steps().iter().map(Step::from).collect();
        if let Some((first, own)) = steps.first_mut().zip(linkage.first_step_from(arranged.sight.station)) {
            *first = Step::from(own);
        }
        let end = Step::from(linkage.end(arranged.sight.target));
        let plan = &arranged.plan;
        let arm = Arm { plan, steps: &steps, end: &end, nearly: false };
        let columns: Vec<usize> = arranged.places().collect();
        let own: Vec<u32> = places.iter().map(|&place| rows[place as usize]).collect();
        let mut packed = ROWS.take();
        pack(self, plan, &own, &mut packed);
        for (places, block) in places.chunks(WIDTH).zip(packed.blocks.chunks_exact(plan.block_len())) {
            abreast.clear();
            abreast.numbers[..places.len()].fill(arranged.numbers());
            let Abreast { jacobian, residual, .. } = abreast;
            lanes::whitened_columns(self.level, &arm, block, &columns, jacobian, residual);
            each(places, abreast);
        }
        ROWS.set(packed);
    }

    fn one_by_one(
        &self,
        state: &Estimate,
        rows: &[u32],
        abreast: &mut Abreast,
        each: &mut impl FnMut(&[u32], &mut Abreast),
    ) {
        let n = self.layout().dim();
        let mut places: Vec<u32> = Vec::with_capacity(WIDTH);
        let mut next = 0..;
        self.for_rows(state, rows, |_, jacobian, residual| {
            let lane = places.len();
            for (k, value) in residual.iter().enumerate() {
                abreast.residual[k].0[lane] = *value;
                for (column, value) in abreast.jacobian.iter_mut().zip(&jacobian[k * n..]) {
                    column[k].0[lane] = *value;
                }
            }
            abreast.numbers[lane] = residual.len();
            places.extend(next.next());
            if places.len() == WIDTH {
                each(&places, abreast);
                abreast.clear();
                places.clear();
            }
        });
        if !places.is_empty() {
            each(&places, abreast);
        }
    }
}

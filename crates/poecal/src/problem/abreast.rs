//! Jacobian and residuals of several rows side by side.

use super::Problem;
use crate::estimate::Estimate;
use crate::lanes::{NUMBERS, WIDTH, Wide};

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
    /// Gives [`WIDTH`] of some rows of the data after the other; what is given may be used up.
    pub(crate) fn for_rows_abreast(
        &self,
        state: &Estimate,
        rows: &[u32],
        mut each: impl FnMut(&[u32], &mut Abreast),
    ) {
        let n = self.layout().dim();
        let mut abreast = Abreast::new(n);
        let mut parts = rows.chunks(WIDTH);
        let mut part = parts.next().unwrap_or_default();
        let mut lane = 0;
        self.for_rows(state, rows, |_, jacobian, residual| {
            for (k, (row, value)) in jacobian.chunks_exact(n.max(1)).zip(residual).enumerate() {
                abreast.residual[k].0[lane] = *value;
                for (column, value) in abreast.jacobian.iter_mut().zip(row) {
                    column[k].0[lane] = *value;
                }
            }
            abreast.numbers[lane] = residual.len();
            lane += 1;
            if lane == part.len() {
                each(part, &mut abreast);
                abreast.clear();
                part = parts.next().unwrap_or_default();
                lane = 0;
            }
        });
    }
}

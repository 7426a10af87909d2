//! Groups of rows that one kernel call can take: rows of one target and one station, all of one form.

use super::Problem;
use super::form::RowForm;
use crate::state::Sight;
use poecal_model::measurement::{Noise, Observation, Quantity};
use poecal_numerics::threads;

/// Rows that one thread groups at a time.
const CHUNK: usize = 8192;
/// Relative difference of two ratios that differ by rounding only.
const SAME_RATIO: f64 = 1e-14;

/// Rows of one target, station and form, in their original order.
pub(crate) struct RowGroup {
    pub(crate) sight: Sight,
    /// Form of the measurements.
    pub(crate) form: RowForm,
    /// Position over rotation noise in m/rad, if it is the same in all rows.
    pub(crate) ratio: Option<f64>,
    /// Rows, or another key of each.
    pub(crate) rows: Vec<u32>,
}

impl RowGroup {
    /// Groups the rows of a problem.
    pub(crate) fn of_problem(problem: &Problem<'_>) -> Vec<RowGroup> {
        if problem.rows.len() <= CHUNK {
            return RowGroup::all_from_rows(problem, &problem.rows, |_, row| row);
        }
        let parts =
            threads::map_chunks(&problem.rows, CHUNK, |_, rows| RowGroup::all_from_rows(problem, rows, |_, row| row));
        let mut groups: Vec<RowGroup> = Vec::new();
        for other in parts.into_iter().flatten() {
            match groups.iter_mut().find(|group| group.holds(other.sight, other.form)) {
                Some(group) => {
                    group.ratio = common_ratio(group.ratio, other.ratio);
                    group.rows.extend(other.rows);
                }
                None => groups.push(other),
            }
        }
        groups
    }

    /// Groups rows by target, station and form; stores `key(position, row)` of each.
    pub(crate) fn all_from_rows(problem: &Problem<'_>, rows: &[u32], key: impl Fn(u32, u32) -> u32) -> Vec<RowGroup> {
        let mut groups: Vec<RowGroup> = Vec::new();
        let (usual, are_alike) = (Whitening::new(problem.noise), problem.session.noise_ratios.is_empty());
        let ratio = |observation: &Observation| match are_alike {
            true => usual.whitening_of_row(observation, problem.noise).ratio,
            false => Whitening::new(problem.session.noise_of(observation, problem.noise)).ratio,
        };
        let own = |row: u32| problem.measurement(row as usize);
        let (is_other, residual) = (problem.layout.has_other_screws(), problem.session.data.pose_residual);
        let mut at = 0;
        for (position, &row) in (0..).zip(rows) {
            let observation = problem.session.observation(row);
            let is_plain = || !problem.layout.has_range(observation.station);
            // The kernels only have noise that is the same in all directions.
            let form = match observation.noise_shape {
                Some(_) => RowForm::shaped_of(own(row)),
                None => RowForm::from_measurement(own(row), !is_other, residual.is_none(), is_plain),
            };
            let sight = Sight::from(observation);
            // Most rows are like the one before.
            if !groups.get(at).is_some_and(|group| group.holds(sight, form)) {
                at = groups.iter().position(|group| group.holds(sight, form)).unwrap_or(groups.len());
            }
            let ratio = (form == RowForm::Pose).then(|| ratio(observation));
            match groups.get_mut(at) {
                Some(group) => {
                    group.ratio = common_ratio(group.ratio, ratio);
                    group.rows.push(key(position, row));
                }
                None => {
                    let mut own = Vec::with_capacity(rows.len() - position as usize);
                    own.push(key(position, row));
                    groups.push(RowGroup { sight, form, ratio, rows: own });
                }
            }
        }
        groups
    }

    fn holds(&self, sight: Sight, form: RowForm) -> bool {
        self.sight.is_like(sight) && self.form == form
    }
}

/// The common ratio if both are equal but for rounding.
fn common_ratio(known: Option<f64>, other: Option<f64>) -> Option<f64> {
    known.zip(other).and_then(|(known, other)| ((other - known).abs() <= SAME_RATIO * known).then_some(known))
}

/// Weights that whiten a row's residual.
#[derive(Clone, Copy)]
pub(crate) struct Whitening {
    /// `1/σ` of a position component.
    pub(crate) weight: f64,
    /// Position over rotation noise.
    pub(crate) ratio: f64,
}

impl Whitening {
    pub(crate) fn new(noise: Noise) -> Self {
        let [position, rotation] = [noise[Quantity::Position], noise[Quantity::Rotation]];
        Whitening { weight: 1.0 / position, ratio: position / rotation }
    }

    /// Whitening of a row, which may state its own noise; `self` is the whitening by the `usual` noise.
    #[inline(always)]
    pub(crate) fn whitening_of_row(self, observation: &Observation, usual: Noise) -> Self {
        match (observation.stated.get(Quantity::Position), observation.stated.get(Quantity::Rotation)) {
            (None, None) => self,
            _ => Whitening::new(observation.noise_or(usual)),
        }
    }
}

//! The rows of a plan in the order of measurement.

use super::conditions::{Checker, Obstacle};
use super::make::Planner;
use super::order::TravelDistance;
use super::rows::{PlannedRow, RowPurpose, with_returns};
use poecal_model::simulate::random;

impl Planner<'_> {
    /// The rows in the order of measurement: those to fit by travel, then the judging ones, and the first one at intervals.
    pub(crate) fn rows(&mut self, readings: Vec<Vec<f64>>, origins: &[Option<usize>]) -> Vec<PlannedRow> {
        let travel = TravelDistance::new(&self.experiment.robot, self.experiment.length_m());
        let judged = self.options.new_of(RowPurpose::Judge, 0);
        let width = self.experiment.width();
        let mut left: Vec<usize> = (0..self.workspace.len() / width).collect();
        random::shuffle(&mut self.generator, &mut left);
        let checker = Checker::new(&self.experiment.robot, &self.options.conditions)
            .with_avoided(&self.avoided, self.experiment.length_m());
        let stated = self.options.workspace.is_some();
        let can_be = |at: &&usize| {
            let found = checker.obstacle_to_measuring(&self.workspace[**at * width..(**at + 1) * width]);
            found.is_none_or(|it| stated && it == Obstacle::Limits)
        };
        let judges: Vec<Vec<f64>> = left
            .iter()
            .filter(can_be)
            .take(judged)
            .map(|&at| self.workspace[at * width..(at + 1) * width].to_vec())
            .collect();
        let mut rows: Vec<PlannedRow> = Vec::new();
        let home = vec![0.0; width];
        for (part, all) in [(RowPurpose::Fit, &readings), (RowPurpose::Judge, &judges)] {
            let start = rows.last().map_or(home.clone(), |row| row.readings.clone());
            let slices: Vec<&[f64]> = all.iter().map(Vec::as_slice).collect();
            for at in travel.shortest_order(&start, &slices) {
                let candidate = if part == RowPurpose::Fit { origins.get(at).copied().flatten() } else { None };
                rows.push(PlannedRow { readings: all[at].clone(), part, returns: false, candidate });
            }
        }
        if self.options.replaced.is_empty() { with_returns(rows) } else { self.replace_rows(rows) }
    }

    /// The kept rows in their order, with new ones in place of those that are replaced.
    fn replace_rows(&self, mut new: Vec<PlannedRow>) -> Vec<PlannedRow> {
        let mut rows = self.options.kept.clone();
        for old in self.options.replaced_rows() {
            let Some(found) = new.iter().position(|it| it.part == old.part) else { continue };
            let found = new.remove(found);
            for row in rows.iter_mut().filter(|row| row.readings == old.readings) {
                row.readings.clone_from(&found.readings);
                row.candidate = found.candidate;
            }
        }
        rows
    }
}

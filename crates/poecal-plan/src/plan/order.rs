//! The order of configurations by travel.

use poecal_model::robot::{ReadingKind, Robot};

/// Sweeps that shorten the path.
const SWEEPS: usize = 20;

/// Distance between configurations: the largest change of a joint, radians; for a sliding joint over the length that a radian counts.
pub(crate) struct TravelDistance {
    scales: Vec<f64>,
}

impl TravelDistance {
    pub(crate) fn new(robot: &Robot, length_m: f64) -> Self {
        let scale = |name: &String| match robot.reading_kind(name) {
            ReadingKind::Angle => 1.0,
            ReadingKind::Length => 1.0 / length_m,
            ReadingKind::Factor => 0.0,
        };
        TravelDistance { scales: robot.reading_names().iter().map(scale).collect() }
    }

    pub(crate) fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.scales.iter().zip(a.iter().zip(b)).map(|(scale, (a, b))| scale * (a - b).abs()).fold(0.0, f64::max)
    }

    /// An order of configurations with a short path from `start` on: from each to the nearest, then shortened by reversing parts of it.
    pub(crate) fn shortest_order(&self, start: &[f64], rows: &[&[f64]]) -> Vec<usize> {
        let mut left: Vec<usize> = (0..rows.len()).collect();
        let (mut order, mut at) = (Vec::new(), start);
        while !left.is_empty() {
            let far = |&index: &usize| self.distance(at, rows[index]);
            let Some(next) = (0..left.len()).min_by(|&a, &b| far(&left[a]).total_cmp(&far(&left[b]))) else {
                break;
            };
            order.push(left.remove(next));
            at = order.last().map_or(start, |&index| rows[index]);
        }
        let place = |order: &[usize], at: usize| if at == 0 { start } else { rows[order[at - 1]] };
        for _ in 0..SWEEPS {
            let mut is_shorter = false;
            for first in 1..=order.len() {
                for last in first + 1..=order.len() {
                    let (before, a) = (place(&order, first - 1), place(&order, first));
                    let b = place(&order, last);
                    let behind = (last < order.len()).then(|| place(&order, last + 1));
                    let to = |from: &[f64]| behind.map_or(0.0, |it| self.distance(from, it));
                    let saved = self.distance(before, a) + to(b) - self.distance(before, b) - to(a);
                    if saved > 1e-9 {
                        order[first - 1..last].reverse();
                        is_shorter = true;
                    }
                }
            }
            if !is_shorter {
                break;
            }
        }
        order
    }
}

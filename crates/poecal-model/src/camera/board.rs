//! Bodies of known points: boards, cubes of tags, frames of markers.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::linalg;

/// Points of one solid, in its own frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Board {
    /// Name.
    pub name: String,
    /// Names of its points.
    pub names: Vec<String>,
    /// The points, metres, in the same order.
    pub points: Vec<Vector3<f64>>,
}

impl Board {
    /// Index of the point with a name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|own| own == name)
    }

    /// Points by their numbers, if all of their names are one word with a number behind it, such as `corner0` and `dot12`; otherwise empty.
    #[must_use]
    pub fn point_numbers(&self) -> BTreeMap<u32, u32> {
        let word = |name: &str| name.trim_end_matches(|it: char| it.is_ascii_digit()).len();
        let first = self.names.first().and_then(|name| name.get(..word(name)));
        let Some(first) = first.filter(|first| !first.ends_with('.')) else { return BTreeMap::new() };
        let number = |name: &String| name.strip_prefix(first)?.parse::<u32>().ok();
        let all: Option<BTreeMap<u32, u32>> =
            self.names.iter().map(number).zip(0..).map(|(number, at)| Some((number?, at))).collect();
        all.filter(|all| all.len() == self.names.len()).unwrap_or_default()
    }

    /// The same points in the order of a grid that counts along its other side first. This is the result of an exchange of columns and rows
    /// of a board. `None` if the board is no grid, or as long as it is wide.
    #[must_use]
    pub fn transposed(&self) -> Option<Self> {
        let [first, second, ..] = self.points.as_slice() else { return None };
        let along = second - first;
        let on_line = |point: &Vector3<f64>| (point - first).cross(&along).norm() < 1e-6 * along.norm_squared();
        let columns = self.points.iter().take_while(|point| on_line(point)).count();
        let rows = self.points.len() / columns.max(1);
        if columns * rows != self.points.len() || rows < 2 || columns == rows {
            return None;
        }
        let across = self.points.get(columns)? - first;
        let place = |at: usize| first + along * (at % rows) as f64 + across * (at / rows) as f64;
        let is_grid = (0..self.points.len()).all(|at| {
            let own = first + along * (at % columns) as f64 + across * (at / columns) as f64;
            (own - self.points[at]).norm() < 1e-6 * along.norm()
        });
        is_grid.then(|| Board { points: (0..self.points.len()).map(place).collect(), ..self.clone() })
    }

    /// Half turn that takes each point of a flat board to the one with the same position from the end. It is the appearance of a chessboard whose
    /// first corner was taken for its last. `None` if the points lie otherwise.
    #[must_use]
    pub fn half_turn(&self) -> Option<Pose> {
        let middle = middle(&self.points);
        let radius = self.radius_m();
        let mirrored = self.points.iter().zip(self.points.iter().rev());
        let is_turned = mirrored.clone().all(|(one, other)| ((one + other) * 0.5 - middle).norm() < 1e-6 * radius);
        if dimensions(&self.points) != 2 || !is_turned {
            return None;
        }
        let turn = rotation::exp(&(normal(&self.points) * std::f64::consts::PI));
        Some(Pose::new(turn, middle - turn * middle))
    }

    /// Largest distance of a point from the middle, metres.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        let middle = middle(&self.points);
        self.points.iter().map(|point| (point - middle).norm()).fold(0.0, f64::max)
    }

    /// The same board in another size.
    #[must_use]
    pub fn scale(&self, factor: f64) -> Self {
        Board { points: self.points.iter().map(|point| point * factor).collect(), ..self.clone() }
    }
}

/// Mean of some points.
#[must_use]
pub fn middle(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64
}

/// Direction in which some points are nearest to each other: the normal of a flat board.
#[must_use]
pub fn normal(points: &[Vector3<f64>]) -> Vector3<f64> {
    let (_, vectors) = linalg::symmetric_eigen(scatter(points).as_slice(), 3);
    Vector3::new(vectors[(0, 0)], vectors[(1, 0)], vectors[(2, 0)])
}

fn scatter(points: &[Vector3<f64>]) -> Matrix3<f64> {
    let middle = middle(points);
    points.iter().map(|point| (point - middle) * (point - middle).transpose()).sum()
}

/// Number of dimensions of some points: 0 of a single position, 1 of a line, 2 of a plane, 3 otherwise, by a thousandth of their size.
#[must_use]
pub fn dimensions(points: &[Vector3<f64>]) -> usize {
    let (values, _) = linalg::symmetric_eigen(scatter(points).as_slice(), 3);
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().filter(|value| **value > 1e-6 * largest).count()
}

//! Rank judged against the noise, and the directions that the data leave open, by joint name (theory.md §7 (36)).

use nalgebra::DMatrix;

use crate::linalg;
use crate::measurement::Dataset;
use crate::parameters::Parameter;
use crate::problem::Layout;
use crate::robot::{JointKind, Robot};
use crate::solve::Normal;

/// Singular values below this share of the largest are rounding of the normal equations.
const ROUNDING: f64 = 3e-7;
/// A direction is told by the data if its standard deviation is below this share of the length that a radian counts (about 2°,
/// or some 10 to 20 mm on an arm of ordinary size): a robot's drawing is known better than that.
const PLAUSIBLE: f64 = 0.03;

/// A combination of unknowns that the measurements do not determine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Direction {
    /// What it is, in words.
    pub description: String,
    /// The joints concerned.
    pub joints: Vec<String>,
}

/// What the measurements determine.
///
/// ```
/// use poecal::analysis::Identifiability;
/// let all = Identifiability { parameters: 30, rank: 30, condition: 35.0, unidentifiable: vec![] };
/// assert_eq!(all.parameters, all.rank);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Identifiability {
    /// Unknowns in the minimal basis: 4 a revolute joint, 2 a prismatic one, 6 a target frame, 3 a target point.
    pub parameters: usize,
    /// Directions among them that the data determine against the noise.
    pub rank: usize,
    /// Largest singular value of the scaled Jacobian over the smallest that counts to the rank.
    pub condition: f64,
    /// The directions that are left open.
    pub unidentifiable: Vec<Direction>,
}

/// Judges the normal information at an estimate; `length_m` is how many metres a radian counts in it
/// (theory.md §7 (36)).
#[must_use]
pub fn identifiability(
    robot: &Robot,
    data: &Dataset,
    layout: &Layout,
    normal: &Normal,
    length_m: f64,
) -> Identifiability {
    let n = layout.dim();
    let (values, vectors) = linalg::symmetric_eigen(&normal.gram, n);
    let largest = values.last().copied().unwrap_or(0.0).max(0.0);
    let redundancy = normal.residuals as f64 / (normal.residuals as f64 - n as f64).max(1.0);
    let variance = normal.mean_square() * redundancy;
    let least = (largest * ROUNDING * ROUNDING).max(variance / (PLAUSIBLE * length_m).powi(2));
    let open = values.iter().take_while(|&&value| value <= least || value <= 0.0).count();
    let condition = values.get(open).map_or(f64::INFINITY, |&value| (largest / value).sqrt());
    let unidentifiable = sparse_basis(&vectors.columns(0, open).into_owned())
        .iter()
        .map(|direction| describe(robot, data, layout, direction))
        .collect();
    Identifiability { parameters: n, rank: n - open, condition, unidentifiable }
}

/// A basis of the same space with as many zeros as elimination gives: directions that concern few joints each.
fn sparse_basis(basis: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> =
        basis.column_iter().map(|column| column.iter().copied().collect()).collect();
    let count = rows.len();
    for k in 0..count {
        let pivot = (k..count)
            .flat_map(|r| (0..basis.nrows()).map(move |c| (r, c)))
            .max_by(|&(r, c), &(s, d)| rows[r][c].abs().total_cmp(&rows[s][d].abs()));
        let Some((row, column)) = pivot else { break };
        rows.swap(k, row);
        let value = rows[k][column];
        rows[k].iter_mut().for_each(|x| *x /= value);
        let pivot_row = rows[k].clone();
        for (r, other) in rows.iter_mut().enumerate() {
            if r != k {
                let factor = other[column];
                for (x, p) in other.iter_mut().zip(&pivot_row) {
                    *x -= factor * p;
                }
            }
        }
    }
    for row in &mut rows {
        let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
        row.iter_mut().for_each(|x| *x /= norm);
    }
    rows
}

/// A direction in words: which joints' axes move how, and which targets with them.
fn describe(robot: &Robot, data: &Dataset, layout: &Layout, direction: &[f64]) -> Direction {
    const NOTABLE: f64 = 0.02;
    let mut joints = Vec::new();
    let mut parts = Vec::new();
    for (parameter, places) in layout.parameters() {
        let share: Vec<f64> = places.iter().map(|&(place, _)| direction[place] * direction[place]).collect();
        if share.iter().sum::<f64>() < NOTABLE {
            continue;
        }
        match parameter {
            Parameter::ScrewAxis(axis) => {
                let name = &robot.joints[axis.joint].name;
                joints.push(name.clone());
                parts.push(match axis.kind {
                    JointKind::Prismatic => format!("the sliding direction of {name}"),
                    JointKind::Revolute if share[0] + share[1] < NOTABLE => {
                        format!("the tilt of {name}'s axis")
                    }
                    JointKind::Revolute if share[2] + share[3] < NOTABLE => {
                        format!("the place of {name}'s axis")
                    }
                    JointKind::Revolute => format!("the place and tilt of {name}'s axis"),
                });
            }
            Parameter::FreeScrew(screw) => {
                let name = &robot.joints[screw.joint].name;
                joints.push(name.clone());
                parts.push(format!("the screw of {name}"));
            }
            Parameter::JointOffset(offset) => {
                let name = &robot.joints[offset.joint].name;
                if !joints.contains(name) {
                    joints.push(name.clone());
                }
                parts.push(format!("the zero of {name}"));
            }
            Parameter::TargetPlace(place) => parts.push(target_words(data, place.target, "the place of")),
            Parameter::TargetFrame(frame) => parts.push(target_words(data, frame.target, "the frame of")),
            Parameter::DeviceFrame(_) => parts.push("the device's frame".to_owned()),
        }
    }
    let description = match parts.len() {
        0 => "a combination of all unknowns".to_owned(),
        1 => format!("{} is not determined by these measurements", parts[0]),
        _ => format!("{} can change together unseen by these measurements", join(&parts)),
    };
    Direction { description, joints }
}

fn target_words(data: &Dataset, target: usize, what: &str) -> String {
    match data.targets.get(target).and_then(|name| name.as_deref()) {
        Some(name) => format!("{what} target {name}"),
        None => format!("{what} the tip"),
    }
}

fn join(parts: &[String]) -> String {
    match parts.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        Some((last, _)) => last.clone(),
        None => String::new(),
    }
}

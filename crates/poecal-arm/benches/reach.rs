//! Time and completeness of inverse kinematics, on the nominal arms of the tests and on calibrated ones:
//!
//! `cargo bench -p poecal-arm --bench reach [-- TARGETS] [--kind NAME] [--json]`
//!
//! For each arm TARGETS poses (20,000 by default) of random configurations, all joints within a turn; for each pose all branches, and the nearest
//! configuration from one whose joints are up to 0.3 rad away. *Found* is the share of targets whose original configuration is among the branches;
//! of seven axes one is held at its value. *Far* is the same share where the smallest singular value of the Jacobian of the free joints is above
//! 0.01. `--json` prints one object a line for `benches/peers/reach`, and `--arms` the arms alone: directions and points of axes, and the tip at
//! zero.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a program that prints what it measures")]

#[path = "../tests/it/calibrated.rs"]
mod calibrated;
#[path = "../tests/it/numbers.rs"]
mod numbers;

use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_arm::trig::wrap_angle;
use poecal_arm::{AllBranches, Arm, Branches, HeldBranches};

use numbers::Numbers;

const TARGETS: usize = 20_000;
/// Errors of an arm's axes (rad, m): nominal, usual results of calibration (other programs compute with these), and 1° and 5 mm.
const OFF: [(f64, f64); 3] = [(0.0, 0.0), (0.005, 1e-3), (0.0175, 5e-3)];
/// Smallest singular value above which a configuration counts as far from singular.
const FAR: f64 = 0.01;
/// Distance of the start of a search from its target, rad.
const AWAY: f64 = 0.3;
/// Remainder (lengths over reach, rad) below which a target counts as reached.
const REACHED: f64 = 1e-10;
/// Largest difference of a joint in configurations that are equal, rad. If branches meet, rounding of the target alone moves them by its
/// root.
const SAME: f64 = 1e-6;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_json = arguments.iter().any(|it| it == "--json");
    let kind = arguments.iter().position(|it| it == "--kind").and_then(|at| arguments.get(at + 1));
    let targets = arguments.iter().find_map(|it| it.parse().ok()).unwrap_or(TARGETS);
    let are_arms = arguments.iter().any(|it| it == "--arms");
    if !is_json && !are_arms {
        println!("{targets} targets an arm; times in µs, median and 99th percentile");
        println!(
            "{:<27}{:>8}{:>9}{:>9}{:>8}{:>10}{:>10}{:>9}{:>9}{:>10}{:>10}{:>10}",
            "",
            "found %",
            "far %",
            "branches",
            "median",
            "p99",
            "off, m",
            "off, rad",
            "nearest",
            "p99",
            "far %",
            "or all %"
        );
    }
    for name in calibrated::KINDS.into_iter().chain(calibrated::SEVEN) {
        if kind.is_some_and(|kind| kind != name) {
            continue;
        }
        for &off in if is_json || are_arms { &OFF[..2] } else { &OFF[..] } {
            let is_seven = calibrated::SEVEN.contains(&name);
            let make = if is_seven { calibrated::arm_of_seven } else { calibrated::arm };
            let arm = make(name, off.0, off.1);
            if are_arms {
                println!("{}", arm_json(&arm, name, off.0 != 0.0));
                continue;
            }
            let label = if off.0 == 0.0 { name.to_owned() } else { format!("{name} {:.1}°", off.0.to_degrees()) };
            let measured = measure_reach(&arm, targets);
            println!("{}", if is_json { measured.json(name, off) } else { measured.line(&label) });
        }
    }
}

/// An arm as JSON.
fn arm_json(arm: &Arm, kind: &str, is_calibrated: bool) -> String {
    let list = |it: &Vector3<f64>| format!("[{}, {}, {}]", it.x, it.y, it.z);
    let lists = |of: fn(&Screw) -> Vector3<f64>| {
        arm.screws().iter().map(|it| list(&of(it))).collect::<Vec<String>>().join(", ")
    };
    let rows = arm.home().rotation.transpose();
    let rows: Vec<String> = rows.column_iter().map(|row| list(&row.into_owned())).collect();
    format!(
        "{{\"kind\": \"{kind}\", \"calibrated\": {is_calibrated}, \"directions\": [{}], \"points\": [{}], \"tip\": {}, \"turned\": [{}]}}",
        lists(Screw::direction),
        lists(|it| it.nearest_point(&Vector3::zeros())),
        list(&arm.home().translation),
        rows.join(", "),
    )
}

/// Results of an arm.
#[derive(Default)]
struct Measured {
    targets: usize,
    far: usize,
    branches: usize,
    found: usize,
    found_far: usize,
    position_m: f64,
    rotation_rad: f64,
    at_us: Vec<f32>,
    nearest_us: Vec<f32>,
    /// Targets that are far from singular and that the iteration reaches, and those that it reaches with the help of all branches.
    reached: usize,
    reached_by_all: usize,
}

fn measure_reach(arm: &Arm, targets: usize) -> Measured {
    let mut numbers = Numbers(5);
    let mut out = Measured { targets, ..Measured::default() };
    if let Some(all) = AllBranches::new(arm) {
        let at = |target: &Pose, _: &[f64; 6]| all.branches_at(target);
        out.run(arm, &mut numbers, (&at, &|target, q| all.solve_nearest(target, q)), None);
    } else if let Some(held) = HeldBranches::new(arm, None) {
        let joint = held.joint();
        let at = |target: &Pose, q: &[f64; 7]| held.branches_at(target, q[joint]);
        out.run(arm, &mut numbers, (&at, &|target, q| held.solve_nearest(target, q)), Some(joint));
    }
    out.at_us.sort_by(f32::total_cmp);
    out.nearest_us.sort_by(f32::total_cmp);
    out
}

/// All branches for a pose, at the held joint of a configuration; and the nearest configuration.
type Solvers<'a, const N: usize> =
    (&'a dyn Fn(&Pose, &[f64; N]) -> Branches<N>, &'a dyn Fn(&Pose, &mut [f64; N]) -> f64);

impl Measured {
    fn run<const N: usize>(
        &mut self,
        arm: &Arm,
        numbers: &mut Numbers,
        (at, nearest): Solvers<'_, N>,
        held: Option<usize>,
    ) {
        for _ in 0..self.targets {
            let q: [f64; N] = std::array::from_fn(|_| PI * numbers.next_number());
            let target = arm.forward_kinematics(&q);
            let is_far = calibrated::smallest_free(arm, &q, held) > FAR;
            self.far += usize::from(is_far);
            let begin = Instant::now();
            let found = black_box(at(black_box(&target), &q));
            self.at_us.push(1e6 * begin.elapsed().as_secs_f32());
            let is_same = |branch: &[f64; N]| branch.iter().zip(&q).all(|(a, b)| wrap_angle(a - b).abs() < SAME);
            let is_found = found.as_slice().iter().any(is_same);
            self.branches += found.as_slice().len();
            self.found += usize::from(is_found);
            self.found_far += usize::from(is_found && is_far);
            for branch in found.as_slice() {
                let tip = arm.forward_kinematics(branch);
                let turned = rotation::log(&(tip.rotation * target.rotation.transpose()));
                self.position_m = self.position_m.max((tip.translation - target.translation).norm());
                self.rotation_rad = self.rotation_rad.max(turned.norm());
            }
            let mut near = q.map(|q| q + AWAY * numbers.next_number());
            let mut by_all = near;
            self.reached_by_all += usize::from(is_far && nearest(&target, &mut by_all) < REACHED);
            let begin = Instant::now();
            let left = black_box(arm.solve_nearest(black_box(&target), black_box(&mut near)));
            self.nearest_us.push(1e6 * begin.elapsed().as_secs_f32());
            self.reached += usize::from(is_far && left < REACHED);
        }
    }
}

/// A quantile of sorted times; NaN without times.
fn quantile(sorted: &[f32], share: f64) -> f32 {
    let at = (share * sorted.len() as f64) as usize;
    sorted.get(at.min(sorted.len().saturating_sub(1))).copied().unwrap_or(f32::NAN)
}

fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

impl Measured {
    fn line(&self, label: &str) -> String {
        let branches = format!(
            "{:>8.3}{:>9.3}{:>9.2}{:>8.1}{:>10.1}{:>10.1e}{:>9.1e}",
            percent(self.found, self.targets),
            percent(self.found_far, self.far),
            self.branches as f64 / self.targets as f64,
            quantile(&self.at_us, 0.5),
            quantile(&self.at_us, 0.99),
            self.position_m,
            self.rotation_rad,
        );
        let by_all = format!("{:>10.3}", percent(self.reached_by_all, self.far));
        format!(
            "{label:<27}{branches}{:>9.2}{:>10.2}{:>10.3}{by_all}",
            quantile(&self.nearest_us, 0.5),
            quantile(&self.nearest_us, 0.99),
            percent(self.reached, self.far),
        )
    }

    fn json(&self, kind: &str, (off_rad, off_m): (f64, f64)) -> String {
        let fields = [
            format!("\"kind\": \"{kind}\", \"calibrated\": {}, \"targets\": {}", off_rad != 0.0, self.targets),
            format!("\"axes_off_rad\": {off_rad}, \"axes_off_m\": {off_m}"),
            format!("\"nearest_median_us\": {}", quantile(&self.nearest_us, 0.5)),
            format!("\"nearest_p99_us\": {}", quantile(&self.nearest_us, 0.99)),
            format!("\"nearest_reached_percent\": {}", percent(self.reached, self.far)),
            format!("\"all_median_us\": {}", quantile(&self.at_us, 0.5)),
            format!("\"all_p99_us\": {}", quantile(&self.at_us, 0.99)),
            format!("\"branches\": {}", self.branches as f64 / self.targets as f64),
            format!("\"found_percent\": {}", percent(self.found, self.targets)),
            format!("\"found_far_percent\": {}", percent(self.found_far, self.far)),
            format!("\"off_m\": {:e}, \"off_rad\": {:e}", self.position_m, self.rotation_rad),
        ];
        format!("{{{}}}", fields.join(", "))
    }
}

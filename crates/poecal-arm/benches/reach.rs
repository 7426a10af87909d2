//! Time and completeness of inverse kinematics, on the arms of the tests as drawn and as calibration finds them:
//!
//! `cargo bench -p poecal-arm --bench reach [-- TARGETS] [--kind NAME] [--json]`
//!
//! For each arm TARGETS poses (20,000 unless given) of random configurations, all joints within a turn; for each pose all branches, and the
//! nearest configuration from one whose joints are up to 0.3 rad away. *Found* is the share of targets of which the configuration that they
//! were made with is among the branches; *far* the same where the smallest singular value of its Jacobian is above 0.01. `--json` prints one
//! object a line for `benches/peers/reach`, and `--arms` the arms alone: directions and points of axes, and the tip at zero.

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
use poecal_arm::trig::wrapped;
use poecal_arm::{AllBranches, Arm};

use numbers::Numbers;

const TARGETS: usize = 20_000;
/// How far an arm's axes are off: as drawn, and as calibration finds them (rad, m).
const OFF: [(f64, f64); 2] = [(0.0, 0.0), (0.005, 1e-3)];
const SEVEN: &str = "seven axes";
/// Smallest singular value above which a configuration counts as far from singular.
const FAR: f64 = 0.01;
/// How far from its target a search begins, rad.
const AWAY: f64 = 0.3;
/// What is left (lengths over reach, rad) where a target counts as reached.
const REACHED: f64 = 1e-10;
/// Largest difference of a joint in configurations that are the same, rad. Where branches meet, rounding of the target alone moves them by
/// its root.
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
    for name in calibrated::KINDS.into_iter().chain([SEVEN]) {
        if kind.is_some_and(|kind| kind != name) {
            continue;
        }
        for off in OFF {
            let arm = if name == SEVEN { seven_axes(off) } else { calibrated::arm(name, off.0, off.1) };
            if are_arms {
                println!("{}", drawn(&arm, name, off.0 != 0.0));
                continue;
            }
            let label = if off.0 == 0.0 { name.to_owned() } else { format!("{name}, cal.") };
            let measured = measured(&arm, targets);
            println!("{}", if is_json { measured.json(name, off.0 != 0.0) } else { measured.line(&label) });
        }
    }
}

/// An arm as collaborative robots of seven axes are, with a spherical shoulder and wrist.
fn seven_axes((angle_rad, length_m): (f64, f64)) -> Arm {
    let (y, z) = (Vector3::y(), Vector3::z());
    let axes = [z, y, z, -y, z, y, z];
    let heights = [0.0, 0.36, 0.36, 0.78, 0.78, 1.18, 1.18];
    let mut numbers = Numbers(2009);
    let screws: Vec<Screw> = axes
        .iter()
        .zip(heights)
        .map(|(axis, height)| {
            let axis = rotation::exp(&(numbers.vector() * angle_rad)) * axis;
            Screw::revolute(&axis, &(Vector3::new(0.0, 0.0, height) + numbers.vector() * length_m))
        })
        .collect();
    Arm::new(&screws, &Pose::from_translation(Vector3::new(0.0, 0.0, 1.306))).unwrap()
}

/// An arm as JSON.
fn drawn(arm: &Arm, kind: &str, is_calibrated: bool) -> String {
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

/// What was measured of an arm.
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

fn measured(arm: &Arm, targets: usize) -> Measured {
    let all = AllBranches::new(arm);
    let mut numbers = Numbers(5);
    let mut out = Measured { targets, ..Measured::default() };
    for _ in 0..targets {
        let [a, b, c, d, e, f] = numbers.six(PI);
        let q = &[a, b, c, d, e, f, PI * numbers.one()][..arm.joints()];
        let target = arm.forward_kinematics(q);
        let is_far = arm.smallest_singular_value(q) > FAR;
        out.far += usize::from(is_far);
        let mut near = [0.0; 7];
        near.iter_mut().zip(q).for_each(|(near, q)| *near = q + AWAY * numbers.one());
        if let (Some(all), Ok(six)) = (&all, <&[f64; 6]>::try_from(q)) {
            let begin = Instant::now();
            let found = black_box(all.at(black_box(&target)));
            out.at_us.push(1e6 * begin.elapsed().as_secs_f32());
            let is_same =
                |branch: &&[f64; 6]| branch.iter().zip(six).all(|(a, b)| wrapped(a - b).abs() < SAME);
            let is_found = found.as_slice().iter().any(|branch| is_same(&branch));
            out.branches += found.as_slice().len();
            out.found += usize::from(is_found);
            out.found_far += usize::from(is_found && is_far);
            for branch in found.as_slice() {
                let tip = arm.forward_kinematics(branch);
                let turned = rotation::log(&(tip.rotation * target.rotation.transpose()));
                out.position_m = out.position_m.max((tip.translation - target.translation).norm());
                out.rotation_rad = out.rotation_rad.max(turned.norm());
            }
            let mut six = [near[0], near[1], near[2], near[3], near[4], near[5]];
            out.reached_by_all += usize::from(is_far && all.nearest(&target, &mut six) < REACHED);
        }
        let near = &mut near[..arm.joints()];
        let begin = Instant::now();
        let left = black_box(arm.nearest(black_box(&target), black_box(near)));
        out.nearest_us.push(1e6 * begin.elapsed().as_secs_f32());
        out.reached += usize::from(is_far && left < REACHED);
    }
    out.at_us.sort_by(f32::total_cmp);
    out.nearest_us.sort_by(f32::total_cmp);
    out
}

/// A quantile of sorted times; NaN of none.
fn quantile(sorted: &[f32], share: f64) -> f32 {
    let at = (share * sorted.len() as f64) as usize;
    sorted.get(at.min(sorted.len().saturating_sub(1))).copied().unwrap_or(f32::NAN)
}

fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

impl Measured {
    fn line(&self, label: &str) -> String {
        let branches = if self.at_us.is_empty() {
            format!("{:>62}", "no branches: not six axes")
        } else {
            format!(
                "{:>8.3}{:>9.3}{:>9.2}{:>8.1}{:>10.1}{:>10.1e}{:>9.1e}",
                percent(self.found, self.targets),
                percent(self.found_far, self.far),
                self.branches as f64 / self.targets as f64,
                quantile(&self.at_us, 0.5),
                quantile(&self.at_us, 0.99),
                self.position_m,
                self.rotation_rad,
            )
        };
        let by_all = if self.at_us.is_empty() {
            String::new()
        } else {
            format!("{:>10.3}", percent(self.reached_by_all, self.far))
        };
        format!(
            "{label:<27}{branches}{:>9.2}{:>10.2}{:>10.3}{by_all}",
            quantile(&self.nearest_us, 0.5),
            quantile(&self.nearest_us, 0.99),
            percent(self.reached, self.far),
        )
    }

    fn json(&self, kind: &str, is_calibrated: bool) -> String {
        let mut fields = vec![
            format!("\"kind\": \"{kind}\", \"calibrated\": {is_calibrated}, \"targets\": {}", self.targets),
            format!("\"nearest_median_us\": {}", quantile(&self.nearest_us, 0.5)),
            format!("\"nearest_p99_us\": {}", quantile(&self.nearest_us, 0.99)),
            format!("\"nearest_reached_percent\": {}", percent(self.reached, self.far)),
        ];
        if !self.at_us.is_empty() {
            fields.extend([
                format!("\"all_median_us\": {}", quantile(&self.at_us, 0.5)),
                format!("\"all_p99_us\": {}", quantile(&self.at_us, 0.99)),
                format!("\"branches\": {}", self.branches as f64 / self.targets as f64),
                format!("\"found_percent\": {}", percent(self.found, self.targets)),
                format!("\"found_far_percent\": {}", percent(self.found_far, self.far)),
                format!("\"off_m\": {:e}, \"off_rad\": {:e}", self.position_m, self.rotation_rad),
            ]);
        }
        format!("{{{}}}", fields.join(", "))
    }
}

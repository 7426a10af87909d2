//! Effect of compensation over the workspace: the figures of `calibration.json` against the two robots of the file, compared by their own forward
//! kinematics in the same configurations.

use std::time::Instant;

use nalgebra::{Vector3, Vector6};
use poecal_arm::lie::{Pose, Twist, rotation};
use poecal_calibrate::{CalibrationOptions, DeviceFrameKnowledge, calibrate};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, elbow, gantry, scara, seven_axis};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::residuals::Residuals;

const PRIMES: [f64; 7] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0];

/// Configurations that the file claims to have compared: fractional parts of multiples of the roots of primes, over the sampled ranges.
fn configurations(file: &CalibrationFile, count: usize) -> Vec<Vec<f64>> {
    let value = |index: usize, joint: usize| {
        let range = &file.coverage[joint];
        let share = (0.5 + index as f64 * PRIMES[joint].sqrt()).fract();
        range.sampled_min + share * (range.sampled_max - range.sampled_min)
    };
    (0..count).map(|index| (0..file.coverage.len()).map(|joint| value(index, joint)).collect()).collect()
}

/// The tool that takes the nominal tips to the actual ones: of the relative poses, the one about which their logarithms sum to zero.
fn taught_tool(relative: &[Pose]) -> Pose {
    let mut tool = relative[0];
    for _ in 0..20 {
        let sum = relative
            .iter()
            .map(|it| (tool.inverse() * *it).log().to_vector())
            .fold(Vector6::zeros(), |sum, it| sum + it);
        tool = tool * Pose::exp(&Twist::from_vector(&(sum / relative.len() as f64)));
    }
    tool
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn file_of(robot: &Robot, kind: SessionKind, options: &CalibrationOptions) -> (CalibrationFile, Residuals) {
    let device_anywhere = options.frame == DeviceFrameKnowledge::Unknown;
    let made = Simulation { count: 60, device_anywhere, ..Simulation::default() }.run(robot, kind).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, options).unwrap();
    let begin = Instant::now();
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    println!("{}: its file was made in {:.2} ms", robot.name, 1e3 * begin.elapsed().as_secs_f64());
    let file = CalibrationFile::parse(&file.to_text().unwrap(), "calibration.json").unwrap();
    (file, Residuals::from_calibration(&made.data, &calibration))
}

#[test]
fn displacements_are_those_of_the_two_robots() {
    let options = CalibrationOptions { frame: DeviceFrameKnowledge::Base, ..CalibrationOptions::default() };
    for robot in [elbow(), seven_axis(), scara()] {
        let (file, _) = file_of(&robot, SessionKind::POSE, &options);
        let found = file.compensation.as_deref().unwrap();
        let nominal = file.nominal_robot().unwrap();
        let actual = file.corrected_file().unwrap_or_else(|| file.clone()).robot().unwrap();
        let sample = configurations(&file, found.all.configurations);
        let nominal: Vec<Pose> = sample.iter().map(|q| nominal.forward_kinematics(q)).collect();
        let actual: Vec<Pose> = sample.iter().map(|q| actual.forward_kinematics(q)).collect();
        let relative: Vec<Pose> = nominal.iter().zip(&actual).map(|(n, a)| n.inverse() * *a).collect();
        // The file states that it is fitted over every third.
        let fitted: Vec<Pose> = relative.iter().step_by(3).copied().collect();
        let tool = taught_tool(&fitted);
        let meant: Vec<Pose> = nominal.iter().map(|it| *it * tool).collect();
        let moved = |k: usize| 1e3 * (meant[k].translation - actual[k].translation).norm();
        let turned = |k: usize| {
            let turn: Vector3<f64> = rotation::log(&(meant[k].rotation.transpose() * actual[k].rotation));
            turn.norm().to_degrees()
        };
        let all: Vec<usize> = (0..sample.len()).collect();
        let check = |rows: &[usize], own: &poecal_results::calibration_file::DisplacementEntry| {
            let of = |value: &dyn Fn(usize) -> f64| rows.iter().map(|k| value(*k)).collect::<Vec<f64>>();
            let largest = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
            assert_eq!(rows.len(), own.configurations);
            [
                (middle(of(&moved)), own.position_mm.median),
                (largest(of(&moved)), own.position_mm.max),
                (middle(of(&turned)), own.rotation_deg.median),
                (largest(of(&turned)), own.rotation_deg.max),
            ]
            .into_iter()
            .map(|(expected, found)| (expected - found).abs() / (1e-3 + expected))
            .fold(0.0, f64::max)
        };
        let mut off = check(&all, &found.all);
        // About the first joint's axis, which in these robots is the base's z axis.
        let at = |value: f64| (value / found.cell_m).floor() as i64;
        let mut seen = 0;
        for cell in &found.cells {
            let step = |value: f64| (value / found.cell_m).round() as i64;
            let is_here = |k: &usize| {
                let place = meant[*k].translation;
                at(place.xy().norm()) == step(cell.radius_m) && at(place.z) == step(cell.height_m)
            };
            let rows: Vec<usize> = all.iter().copied().filter(is_here).collect();
            seen += rows.len();
            off = off.max(check(&rows, &cell.displaced));
        }
        println!(
            "{}: {} cells, {:.3} mm in the median, at most {:.3} mm; largest difference {off:.1e}",
            robot.name,
            found.cells.len(),
            found.all.position_mm.median,
            found.all.position_mm.max
        );
        assert_eq!(seen, sample.len());
        // Two steps of the fit leave the third order of a motion of 2 degrees.
        assert!(off < 1e-4, "{}: {off}", robot.name);
    }
}

#[test]
fn corrections_are_told_where_an_arm_can_be_corrected() {
    let options = CalibrationOptions::default();
    let (file, _) = file_of(&elbow(), SessionKind::POSE, &options);
    let found = file.compensation.unwrap();
    println!("{:?}", found.joints);
    assert_eq!(found.joints.len(), 6);
    for joint in &found.joints {
        let (median, largest) = (joint.change.median, joint.change.max);
        assert!(0.0 < median && median < largest && largest < 0.6_f64.to_degrees() && joint.unit == "deg");
    }
    // An arm of fewer joints cannot correct every displacement, and no corrections are stated.
    let (file, _) = file_of(&scara(), SessionKind::POSE, &options);
    assert!(file.compensation.unwrap().joints.is_empty());
    let (file, _) = file_of(&gantry(), SessionKind::POSE, &options);
    println!("gantry: {:?}", file.compensation.map(|it| (it.about, it.all, it.joints)));
}

#[test]
fn files_without_it_have_a_report_without_it() {
    let (mut file, residuals) = file_of(&elbow(), SessionKind::POINT, &CalibrationOptions::default());
    let page = poecal_report::calibration_page(&file, &residuals).unwrap().concat();
    assert!(page.contains("id=\"compensation\"") && page.contains("Error of an uncorrected program"));
    file.compensation = None;
    let text = file.to_text().unwrap();
    assert!(!text.contains("\"compensation\""));
    let file = CalibrationFile::parse(&text, "calibration.json").unwrap();
    let page = poecal_report::calibration_page(&file, &residuals).unwrap().concat();
    assert!(!page.contains("compensation") && page.contains("<h1>"));
}

//! Several targets without names, and similar cases.

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_fit::forensics::{DiagnosisOptions, diagnose};
use poecal_model::measurement::{Dataset, Measurement};
use poecal_model::simulate::{SessionKind, Simulation, elbow};

/// Statements on rows of 30 configurations; the positions of each are those that `seen` computes from the tip.
fn statements(seen: impl Fn(usize, Pose) -> Vec<Vector3<f64>>) -> Vec<String> {
    let made = Simulation { count: 30, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    for row in 0..made.data.len() {
        for position in seen(row, made.data.observations[row].measurement.pose()) {
            let point = Measurement::point(position);
            data.push(made.data.readings(row), None, point).unwrap();
        }
    }
    let rows: Vec<u32> = data.all_rows();
    let found = diagnose(&made.nominal, &data, &rows, &DiagnosisOptions::default());
    found.into_iter().map(|it| format!("{:?}: {}", it.kind, it.statement)).collect()
}

#[test]
fn targets_without_names_are_told_by_their_distances() {
    let places = [Vector3::zeros(), Vector3::new(0.06, 0.0, 0.0), Vector3::new(0.0, 0.08, 0.0)];
    let found = statements(|_, pose| places.iter().map(|place| pose.translation + pose.rotation * place).collect());
    assert_eq!(
        found,
        ["TargetsUnnamed: each of 30 configurations has rows at 3 places that are always 60.0 to 100 mm apart \
             (such as row 1 and row 2), as 3 targets are: add a column `target` that names which one each row saw"]
    );
}

#[test]
fn wrong_rows_are_no_targets() {
    // A wrong row in some configurations, each at another position.
    let found = statements(|row, pose| {
        let wrong = pose.translation + Vector3::new(0.03, 0.02, 0.01) * (row + 1) as f64;
        if row % 3 == 0 { vec![pose.translation, wrong] } else { vec![pose.translation] }
    });
    assert!(found.iter().all(|found| !found.starts_with("TargetsUnnamed")), "{found:?}");
    assert!(found.iter().any(|found| found.contains("contradicts it")), "{found:?}");
}

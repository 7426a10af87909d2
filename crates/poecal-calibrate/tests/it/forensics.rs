//! Mistakes put into simulated sessions are named, and clean sessions raise no alarm.

use poecal_testing::sessions::geometry;
use std::collections::BTreeSet;

use crate::mistakes::{Looked, Session, assert_mistakes_are_named, assert_no_alarms};
use nalgebra::Vector3;
use poecal_calibrate::{CalibrationOptions, DeviceFrameKnowledge, calibrate, nominal_estimate};
use poecal_fit::forensics::{Diagnosis, DiagnosisKind, DiagnosisOptions, diagnose};
use poecal_fit::start::{Registration, register};
use poecal_fit::state::{self as estimate, PackedValues};
use poecal_model::measurement::{Dataset, Measurement, Noise};
use poecal_model::robot::JointKind;
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_testing::trials::{choose_some, trials};

const KINDS: [DiagnosisKind; 12] = [
    DiagnosisKind::JointUnit,
    DiagnosisKind::PositionUnit,
    DiagnosisKind::JointSign,
    DiagnosisKind::JointsSwapped,
    DiagnosisKind::JointZero,
    DiagnosisKind::QuaternionOrder,
    DiagnosisKind::InvertedPose,
    DiagnosisKind::EulerConvention,
    DiagnosisKind::LeftHanded,
    DiagnosisKind::RowShift,
    DiagnosisKind::TargetsSwapped,
    DiagnosisKind::DuplicateRows,
];

/// Half of a file with another export.
#[test]
fn a_mistake_of_a_part_of_the_rows_is_named_with_these_rows() {
    for seed in trials(4).at_least(2).seeds() {
        let made = Simulation { count: 60, seed, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
        let changed = |is_of: fn(usize) -> bool| {
            let mut data = Dataset::new(made.data.reading_names().to_vec());
            for row in 0..made.data.len() {
                let mut readings = made.data.readings(row).to_vec();
                if is_of(row) {
                    readings[2] = -readings[2];
                }
                data.push(&readings, None, made.data.observations[row].measurement).unwrap();
            }
            diagnose(&made.nominal, &data, &data.all_rows(), &DiagnosisOptions::default())
        };
        for (is_of, which, first) in
            [(|row| row >= 30, "last", 40), (|row| row < 25, "first", 0)] as [(fn(usize) -> bool, _, _); 2]
        {
            let found = changed(is_of);
            println!("{found:?}");
            let [found] = &found[..] else { panic!("{found:?}") };
            assert_eq!((found.kind, found.rows.first()), (DiagnosisKind::JointSign, Some(&first)));
            let begin = format!("in the {which} third of the rows alone, counting joint3 the other way");
            assert!(found.statement.starts_with(&begin), "{}", found.statement);
        }
        assert_eq!(changed(|_| false), []);
    }
}

fn diagnose_session(session: &Session, data: &Dataset) -> Vec<Diagnosis> {
    let rows: Vec<u32> = data.all_rows();
    diagnose(
        &session.robot,
        data,
        &rows,
        &DiagnosisOptions { device_free: session.device_free, ..DiagnosisOptions::default() },
    )
}

/// Root mean square position error of the nominal robot with fitted device and targets, metres.
fn registered_m(session: &Session, data: &Dataset) -> f64 {
    let packed = PackedValues::from_dataset(&session.robot, data);
    let rows: Vec<u32> = data.all_rows();
    let registration = Registration {
        session: estimate::Session::new(&session.robot, data, &packed, session.device_free).with_length(0.33),
        rows: &rows,
        noise: Noise::new(1e-3, 3e-3),
        targets_free: true,
        prior: None,
    };
    let (_, cost) = register(&registration, &nominal_estimate(&session.robot, data));
    1e-3 * (2.0 * cost / data.len() as f64).sqrt()
}

/// A drawn session with a mistake of the kind that belongs to the index. Impossible mistakes are drawn again, and so are joint zeros that are not
/// gross (registered error below 2.5 times that of the clean session), since a calibration is meant to absorb them. The zero of the first and last
/// joint, and of slides that only shift the base, moves nothing at all.
fn draw_mistaken_session(index: u64) -> (Session, DiagnosisKind, Dataset, String) {
    let kind = KINDS[index as usize % KINDS.len()];
    for attempt in 0.. {
        let seed = index / KINDS.len() as u64 + 1000 * index + 77_777 * attempt;
        let session = Session::from_seed(seed);
        let Some((data, words)) = session.with_mistake(kind, seed) else { continue };
        if kind == DiagnosisKind::JointZero
            && registered_m(&session, &data) < 2.5 * registered_m(&session, &session.data)
        {
            continue;
        }
        return (session, kind, data, words);
    }
    unreachable!("some session can have every mistake")
}

#[test]
fn mistakes_are_named() {
    assert_mistakes_are_named(trials(60), |index| {
        let (session, kind, data, words) = draw_mistaken_session(index);
        let found = diagnose_session(&session, &data);
        let is_right = !found.is_empty() && found.iter().all(|one| one.kind == kind);
        let words = format!("({words}); {}", session.words);
        Looked { label: format!("{kind:?}"), words, is_right, found }
    });
}

/// A header with a wrong unit for one of three columns.
#[test]
fn a_column_in_another_unit_is_named_alone() {
    for seed in trials(12).seeds() {
        let session = Session::from_seed(700 + seed);
        let axis = seed as usize % 3;
        let mut data = session.data.clone();
        for row in &mut data.observations {
            assert!(row.measurement.is_place(), "{:?}", row.measurement);
            row.measurement.values_mut()[axis] *= 1e-3;
        }
        let found = diagnose_session(&session, &data);
        let name = ["x", "y", "z"][axis];
        println!("{}: {found:?}", session.words);
        let [only] = &found[..] else { panic!("{name}, {}: {found:?}", session.words) };
        assert_eq!(only.kind, DiagnosisKind::PositionUnit);
        assert!(only.statement.contains(&format!("multiplying {name} alone by 1000")), "{}", only.statement);
    }
}

/// An elbow in which each reading of a joint is that of the data plus a multiple of the reading before.
fn couple_readings(session: &Session, column: usize, own: f64, factor: f64) -> Dataset {
    let mut data = Dataset::new(session.data.reading_names().to_vec());
    data.targets.clone_from(&session.data.targets);
    for row in 0..session.data.len() {
        let mut readings = session.data.readings(row).to_vec();
        readings[column] = own * readings[column] + factor * readings[column - 1];
        data.push_observation(&readings, session.data.observations[row]).unwrap();
    }
    data
}

#[test]
fn readings_that_are_sums_of_two_joints_are_named() {
    for (seed, own, factor) in choose_some([(0, 1.0, 1.0), (10, 1.0, -1.0), (20, -1.0, 1.0), (30, -1.0, -1.0)]) {
        let session = Session::from_seed(seed);
        let found = diagnose_session(&session, &couple_readings(&session, 2, own, factor));
        let kinds: Vec<_> = found.iter().map(|one| one.kind).collect();
        assert_eq!(kinds, [DiagnosisKind::JointsCoupled], "{}: {found:?}", session.words);
        // joint3 = (reading - factor joint2) / own
        let (own, factor) = (own as i32, (-factor / own) as i32);
        let line = if (own, factor) == (1, 1) {
            "counting joint3 from the level".to_owned()
        } else {
            format!("`joint3 = {{ columns = {{ joint3 = {own}, joint2 = {factor} }} }}`")
        };
        assert!(found[0].statement.contains(&line), "{line}: {}", found[0].statement);
    }
}

#[test]
fn readings_in_per_cent_and_of_other_gears_are_named_with_their_factors() {
    let sessions = trials(32);
    let (mut named, mut wrong) = (0, Vec::new());
    for seed in sessions.seeds() {
        let session = Session::from_seed(500 + seed);
        let joints = &session.robot.joints;
        let is_per_cent = seed % 2 == 0 && joints.iter().all(|it| it.limits.is_some());
        // Factors of percentages read as degrees, or of one gear.
        let factors: Vec<f64> = joints
            .iter()
            .enumerate()
            .map(|(at, joint)| match joint.limits {
                Some(limits) if is_per_cent && joint.kind == JointKind::Revolute => {
                    1_f64.to_radians() * 200.0 / (limits.upper - limits.lower)
                }
                _ if !is_per_cent && at == 1 => 0.7,
                _ => 1.0,
            })
            .collect();
        let data = scale_readings(&session, &factors);
        let found = diagnose_session(&session, &data);
        let (kinds, words) = (found.iter().map(|it| it.kind).collect::<Vec<_>>(), &session.words);
        let is_right = kinds == [DiagnosisKind::JointScale]
            && joints.iter().zip(&factors).all(|(joint, factor)| {
                // The factor is determined with nominal screws, so only two of its digits are compared.
                *factor == 1.0 || {
                    let text = found[0].statement.split(&format!("{}: ", joint.name)).nth(1).unwrap_or_default();
                    let number = text.split([',', ')']).next().and_then(|it| it.parse::<f64>().ok());
                    number.is_some_and(|it| (it * factor - 1.0).abs() < 0.05)
                }
            });
        if is_right { named += 1 } else { wrong.push(format!("{is_per_cent} {words}: {kinds:?}")) }
    }
    println!("{named} of {} named: {wrong:#?}", sessions.count);
    assert!(named as f64 >= 0.7 * sessions.count as f64, "{wrong:#?}");
}

/// A session whose readings have other sizes.
fn scale_readings(session: &Session, factors: &[f64]) -> Dataset {
    let mut data = Dataset::new(session.data.reading_names().to_vec());
    data.targets.clone_from(&session.data.targets);
    for row in 0..session.data.len() {
        let readings: Vec<f64> = session.data.readings(row).iter().zip(factors).map(|(it, by)| it * by).collect();
        data.push_observation(&readings, session.data.observations[row]).unwrap();
    }
    data
}

/// Diagnoses of `poecal calibrate`.
fn told_with_calibration(session: &Session, data: &Dataset) -> Vec<Diagnosis> {
    let frame = if session.device_free { DeviceFrameKnowledge::Unknown } else { DeviceFrameKnowledge::Base };
    calibrate(&session.robot, data, &CalibrationOptions { frame, ..Default::default() }).unwrap().diagnosis
}

#[test]
fn check_and_calibrate_name_the_same_mistakes() {
    let mut different = Vec::new();
    let planted = choose_some(0..KINDS.len() as u64).into_iter().map(draw_mistaken_session);
    let elbow = Session::from_seed(0);
    let data = couple_readings(&elbow, 2, 1.0, 1.0);
    for (session, kind, data, words) in
        planted.chain([(elbow, DiagnosisKind::JointsCoupled, data, "joint3 + joint2".to_owned())])
    {
        let kinds = |found: Vec<Diagnosis>| found.into_iter().map(|one| one.kind).collect::<BTreeSet<_>>();
        let (checked, calibrated) =
            (kinds(diagnose_session(&session, &data)), kinds(told_with_calibration(&session, &data)));
        if checked != calibrated || !checked.contains(&kind) {
            different
                .push(format!("{kind:?} ({words}; {}): checked {checked:?}, calibrated {calibrated:?}", session.words));
        }
    }
    assert!(different.is_empty(), "{different:#?}");
}

/// A session of an elbow whose rows see this number of targets in turn, with the sign of one joint wrong or not.
fn of_targets(targets: usize, sign: f64) -> (Session, Dataset) {
    let mut session = Session::from_seed(0);
    let made = Simulation { count: 3 * targets, ..Simulation::default() }.run(&elbow(), SessionKind::POINT).unwrap();
    session.robot = made.nominal;
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    for row in 0..made.data.len() {
        let mut readings = made.data.readings(row).to_vec();
        readings[2] *= sign;
        let name = format!("T{}", row % targets);
        data.push(&readings, Some(&name), made.data.observations[row].measurement).unwrap();
    }
    (session, data)
}

/// Formerly each target had unknowns of its own in every fit of every hypothesis, and each pair was a hypothesis: the search took hours.
#[test]
fn a_thousand_targets_are_looked_through() {
    let targets = trials(1000).at_least(300).count.min(1000);
    let (session, data) = of_targets(targets, 1.0);
    assert_eq!(diagnose_session(&session, &data), []);
    let (session, data) = of_targets(targets, -1.0);
    let found = diagnose_session(&session, &data);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].kind, DiagnosisKind::JointSign);
    let (session, data) = of_targets(1000, -1.0);
    let options = CalibrationOptions { held_out: Some(0.0), ..Default::default() };
    let error = calibrate(&session.robot, &data, &options).unwrap_err();
    assert_eq!(
        error.to_string(),
        "found 3024 unknowns (24 of the screws, 3000 of 1000 targets), expected at most 1000 in one fit: \
         calibrate with fewer targets, or a shorter chain"
    );
}

/// An elbow and 600 rows of 30 targets, each at a position of its own.
fn of_many_places() -> (Session, Dataset) {
    let (session, _) = of_targets(30, 1.0);
    let made = Simulation { count: 600, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    for row in 0..made.data.len() {
        let target = row % 30;
        let angle = target as f64;
        let place = Vector3::new(0.1 * angle.sin(), 0.1 * angle.cos(), 0.003 * angle);
        let position = made.data.observations[row].measurement.pose().act(&place);
        let seen = Measurement::point(position);
        data.push(made.data.readings(row), Some(&format!("T{target}")), seen).unwrap();
    }
    (session, data)
}

/// Names exchanged in rows of two of many targets.
#[test]
fn two_of_many_targets_exchanged_in_some_rows_are_named() {
    let (session, mut data) = of_many_places();
    for row in data.observations.iter_mut().skip(300) {
        row.target = match row.target {
            7 => 21,
            21 => 7,
            other => other,
        };
    }
    let found = diagnose_session(&session, &data);
    assert_eq!(found.iter().map(|one| one.kind).collect::<Vec<_>>(), [DiagnosisKind::TargetsSwapped]);
    let statement = &found[0].statement;
    assert!(statement.contains("T7 and T21") || statement.contains("T21 and T7"), "{statement}");
}

#[test]
fn a_clean_calibration_has_no_mistake() {
    let simulation = poecal_model::simulate::Simulation::default();
    let made = simulation.run(&poecal_model::simulate::elbow(), poecal_model::simulate::SessionKind::POINT).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &geometry()).unwrap();
    let rows: Vec<u32> = made.data.all_rows();
    let options = DiagnosisOptions { calibrated: Some(&calibration.models.calibrated), ..DiagnosisOptions::default() };
    assert_eq!(diagnose(&made.nominal, &made.data, &rows, &options), []);
}

#[test]
fn clean_sessions_raise_no_alarm() {
    assert_no_alarms(trials(200), |index| {
        let session = Session::from_seed(index + 5_000_000);
        let found = diagnose_session(&session, &session.data);
        (session.words, found)
    });
}

//! Mistakes put into simulated sessions are named, and clean sessions are left in peace.

#![allow(clippy::unwrap_used)]

mod mistakes;

use std::collections::BTreeMap;

use mistakes::Session;
use poecal::calibration::{CalibrationOptions, calibrate, delivered};
use poecal::estimate::Packed;
use poecal::forensics::{Diagnosis, DiagnosisKind, Options, diagnose};
use poecal::measurement::{Dataset, Noise};
use poecal::start::{Registration, register};
use rayon::prelude::*;

/// Sessions of each test: a few by default, 1,000 with `POECAL_FORENSICS=1000`.
fn sessions(default: usize) -> usize {
    std::env::var("POECAL_FORENSICS").ok().and_then(|count| count.parse().ok()).unwrap_or(default)
}

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

fn found(session: &Session, data: &Dataset) -> Vec<Diagnosis> {
    let rows: Vec<u32> = (0..data.len() as u32).collect();
    diagnose(&session.robot, data, &rows, &Options { device_free: session.device_free, ..Options::default() })
}

/// Root mean square position error of the nominal robot with device and targets found, metres.
fn registered_m(session: &Session, data: &Dataset) -> f64 {
    let packed = Packed::new(&session.robot, data.all_readings(), data.reading_names().len());
    let rows: Vec<u32> = (0..data.len() as u32).collect();
    let registration = Registration {
        data,
        packed: &packed,
        rows: &rows,
        noise: Noise { position_m: 1e-3, rotation_rad: 3e-3 },
        length_m: 0.33,
        device_free: session.device_free,
        targets_free: true,
    };
    let (_, cost) = register(&registration, &delivered(&session.robot, data));
    1e-3 * (2.0 * cost / data.len() as f64).sqrt()
}

/// A drawn session with a mistake of the kind that belongs to the index. What a session cannot have is drawn again, and so are joint
/// zeros that are not gross, the registered error being below 2.5 times that of the clean session: a calibration takes them in, as
/// it is meant to (the zero of the first and last joint, and of slides that only shift the base, move nothing at all).
fn mistaken(index: u64) -> (Session, DiagnosisKind, Dataset, String) {
    let kind = KINDS[index as usize % KINDS.len()];
    for attempt in 0.. {
        let seed = index / KINDS.len() as u64 + 1000 * index + 77_777 * attempt;
        let session = Session::drawn(seed);
        let Some((data, words)) = session.mistaken(kind, seed) else { continue };
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
    let count = sessions(60);
    let results: Vec<(DiagnosisKind, bool)> = (0..count as u64)
        .into_par_iter()
        .map(|index| {
            let (session, kind, data, words) = mistaken(index);
            let found = found(&session, &data);
            let right = !found.is_empty() && found.iter().all(|one| one.kind == kind);
            if !right {
                println!("MISSED {index} {kind:?} ({words}); {}", session.words);
                found.iter().for_each(|one| println!("    found {:?}: {}", one.kind, one.statement));
            }
            (kind, right)
        })
        .collect();
    let mut by_kind: BTreeMap<DiagnosisKind, (usize, usize)> = BTreeMap::new();
    for (kind, right) in &results {
        let entry = by_kind.entry(*kind).or_default();
        entry.0 += usize::from(*right);
        entry.1 += 1;
    }
    for (kind, (right, all)) in &by_kind {
        println!("{kind:?}: {right} of {all}");
    }
    let right = results.iter().filter(|(_, right)| *right).count();
    println!("named correctly: {right} of {count}");
    assert!(right as f64 >= 0.95 * count as f64, "{right} of {count}");
}

#[test]
fn a_clean_calibration_has_no_mistake() {
    let simulation = poecal::simulate::Simulation::default();
    let made = simulation.run(&poecal::simulate::elbow(), poecal::simulate::Kind::Point).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    let rows: Vec<u32> = (0..made.data.len() as u32).collect();
    let options = Options { calibrated: Some(&calibration.models.calibrated), ..Options::default() };
    assert_eq!(diagnose(&made.nominal, &made.data, &rows, &options), []);
}

#[test]
fn clean_sessions_raise_no_alarm() {
    let count = sessions(200);
    let alarms: Vec<String> = (0..count as u64)
        .into_par_iter()
        .flat_map_iter(|index| {
            let session = Session::drawn(index + 5_000_000);
            let found = found(&session, &session.data);
            found.into_iter().map(move |one| format!("{}: {:?}: {}", session.words, one.kind, one.statement))
        })
        .collect();
    alarms.iter().for_each(|alarm| println!("ALARM {alarm}"));
    println!("alarms: {} of {count}", alarms.len());
    assert!(alarms.len() as f64 <= 0.01 * count as f64);
}

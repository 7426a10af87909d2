//! Masses of models, and the robot's own weight.

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_calibrate::{CalibrationOptions, Corrections, calibrate};
use poecal_formats::robot_toml;
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_model::robot::{Body, Gravity, JointTerm, Mass, Moments, Robot, Situation, Statics, Term, TermKind};
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_results::calibration_file::{CalibrationFile, Inputs};

/// A shoulder and an elbow with a cover that is fixed to the forearm, and a cart below the base.
const HEAVY: &str = r#"<robot name="heavy">
  <link name="cart"><inertial><mass value="90"/></inertial></link>
  <link name="base"><inertial><mass value="30"/></inertial></link>
  <link name="upper"><inertial><origin xyz="0.2 0 0.01" rpy="1 0 0"/><mass value="8"/></inertial></link>
  <link name="fore"><inertial><origin xyz="0.1 0 0"/><mass value="3"/></inertial></link>
  <link name="cover"><inertial><mass value="0.5"/></inertial></link>
  <link name="tool"/>
  <joint name="stand" type="fixed"><parent link="cart"/><child link="base"/><origin xyz="0 0 1"/></joint>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="screws" type="fixed"><parent link="fore"/><child link="cover"/><origin xyz="0.2 0.05 0"/></joint>
  <joint name="flange" type="fixed"><parent link="fore"/><child link="tool"/><origin xyz="0.3 0 0"/></joint>
</robot>"#;

/// The masses of a URDF are those that its chain moves, come back from TOML, and their moments are the derivatives of their potential.
#[test]
fn masses_of_a_urdf_pull_as_their_potential_says() {
    let selection =
        ChainSelection { base_link: Some("base".to_owned()), tip_link: Some("tool".to_owned()), ..Default::default() };
    let robot = |text: &str| UrdfDocument::parse(text, "heavy.urdf", &selection).unwrap().robot().clone();
    let heavy = robot(HEAVY);
    let found: Vec<(usize, [f64; 3], f64)> =
        heavy.masses.iter().map(|it| (it.body.joint().unwrap(), it.place.into(), it.kg)).collect();
    let expected = [(0, [0.2, 0.0, 0.51], 8.0), (1, [0.5, 0.0, 0.5], 3.0), (1, [0.6, 0.05, 0.5], 0.5)];
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!((found.0, found.2), (expected.0, expected.2));
        assert!((Vector3::from(found.1) - Vector3::from(expected.1)).norm() < 1e-15);
    }
    assert_eq!(found.len(), expected.len());
    // Masses are no reason to refuse a model: a link whose mass cannot be read has none.
    for (from, to) in [("\"8\"", "\"heavy\""), ("\"8\"/>", "\"8\"/><mass value=\"9\"/>")] {
        assert_eq!(robot(&HEAVY.replace(from, to)).masses, heavy.masses[1..]);
    }
    assert_eq!(robot(&HEAVY.replace("0.2 0.05 0", "0.2 0.05 left")).masses, heavy.masses[..2]);
    let toml = robot_toml::write(&heavy);
    // Numbers are written without their rounding errors.
    let again = robot_toml::parse(&toml, "heavy.toml").unwrap().masses;
    let is_same = |(a, b): (&Mass, &Mass)| (a.body, a.kg) == (b.body, b.kg) && (a.place - b.place).norm() < 1e-15;
    assert!(again.len() == 3 && again.iter().zip(&heavy.masses).all(is_same), "{toml}");
    let error = robot_toml::parse(&toml.replace("kg = 3", "kg = -3"), "heavy.toml").unwrap_err().to_string();
    assert!(error.contains("found the mass -3, expected kilograms above 0"), "{error}");

    let error = robot_toml::parse(&toml.replace("on = \"shoulder\"", "on = \"base\""), "heavy.toml").unwrap_err();
    assert!(error.to_string().contains("found a mass on the base"), "{error}");
    // They follow joint offsets that become screws.
    let mut off = heavy.clone();
    off.masses[2].place = off.home.translation;
    off.terms = vec![JointTerm { joint: 0, term: Term::OFFSET, coefficient: 0.3 }];
    let off = off.without_offsets();
    assert!((off.masses[2].place - off.home.translation).norm() < 1e-15 && off.home != heavy.home);

    let down = Vector3::new(0.1, 0.2, -1.0).normalize();
    let mut pulled = heavy.clone();
    pulled.gravity = Some(Gravity::of_unit_weights(&heavy, down));
    let statics = Statics::new(&pulled).unwrap();
    let potential = |readings: &[f64; 2]| {
        let of_mass = |mass: &Mass| {
            let end = Robot { tip: Some(mass.body), home: Pose::from_translation(mass.place), ..heavy.clone() };
            mass.kg * end.forward_kinematics(readings).translation.dot(&down)
        };
        heavy.masses.iter().map(of_mass).sum::<f64>()
    };
    let mut moments = Moments::default();
    let at = [0.4, -0.7];
    statics.evaluate(&at, &mut moments);
    for joint in 0..2 {
        let step = 1e-5;
        let [mut more, mut less] = [at; 2];
        more[joint] += step;
        less[joint] -= step;
        let slope = (potential(&more) - potential(&less)) / (2.0 * step);
        let situation = Situation { values: &at, moments: Some(&moments), factors: &[] };
        let moment = situation.basis(joint, TermKind::Masses.with_number(0)) * statics.mass_levers_kg_m()[joint];
        println!("{moment:.9} kg m, by differences {slope:.9}");
        // Differences of order 2 over 1e-5.
        assert!((moment - slope).abs() < 1e-8);
    }
}

/// The masses are kept with the corrected model, and the term of all of them is among those of a joint that carries them.
#[test]
fn masses_are_kept_with_the_corrected_model() {
    let mut nominal = elbow();
    let mass = |joint: usize, kg: f64| {
        let place = nominal.joints[joint].frame.translation + Vector3::new(0.1, 0.02, 0.1);
        Mass { body: Body::Link(joint), place, kg }
    };
    nominal.masses = vec![mass(1, 9.0), mass(2, 6.0), mass(4, 2.0)];
    let Ok(Corrections::Sizes(terms)) = "sag=1e-3".parse() else { panic!("no sizes") };
    let made = Simulation { terms, count: 60, ..Simulation::default() }.run(&nominal, SessionKind::POSE).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    let found = calibration.correction.as_ref().unwrap();
    assert!(found.robot.terms.iter().any(|it| it.term == TermKind::Masses.with_number(0) && it.coefficient != 0.0));
    let text = CalibrationFile::new(&calibration, &made.data, Inputs::default()).to_text().unwrap();
    let read = CalibrationFile::parse(&text, "calibration.json").unwrap().corrected_file().unwrap().robot().unwrap();
    let apart = (0..made.data.len()).map(|row| {
        let [a, b] = [&found.robot, &read].map(|it| it.forward_kinematics(made.data.readings(row)).translation);
        (a - b).norm()
    });
    let apart = apart.fold(0.0, f64::max);
    println!("read back {apart:.1e} m apart");
    assert!(apart < 1e-14);
    for wrong in ["\"mass_kg\": -6.0", "\"mass_kg\": 1e300"] {
        let text = text.replace("\"mass_kg\": 6.0", wrong);
        let refused =
            CalibrationFile::parse(&text, "calibration.json").and_then(|file| file.corrected_file().unwrap().robot());
        assert!(refused.unwrap_err().to_string().contains("expected above 0 and at most 1e6"));
    }
}

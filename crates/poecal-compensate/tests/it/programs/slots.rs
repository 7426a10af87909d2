//! Programs with slots for targets. The test fills the slots from configurations, so that it knows their meaning, and reads them again between the
//! surrounding bytes, which must be the same.
//!
//! A slot is `@J{q}` (joints), `@P{q}` or `@P{q|tool|frame}` (a pose, by the names of the case's poses), with the configuration in degrees. `@j` and
//! `@p` mark slots that are unchanged. Letters behind are specific to the language.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, Twist, rotation};
use poecal_compensate::{Inverse, Language, ProgramOptions, compensate_program};
use poecal_model::robot::{Joint, JointLimits, JointTerm, Robot, Term, TermKind};

/// A program, and its expected outcome.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) text: &'static str,
    /// Options as words: `tool 1=0,0,…`, `frame …`, `base …`, `flange …`.
    pub(super) options: &'static [&'static str],
    /// Lines, names and reasons of unchanged targets.
    pub(super) listed: &'static [(usize, &'static str, &'static str)],
}

/// Writer and reader of a language in the test.
pub(super) struct Form {
    /// Text of joints, of a configuration in radians.
    pub(super) joints: fn(&[f64]) -> String,
    /// Text of a pose, of the nominal robot's configuration (rad), in the form of the slot's letter.
    pub(super) pose: fn(char, &Pose, &[f64]) -> String,
    /// The configuration (rad) of the numbers in a text of joints.
    pub(super) to_joints: fn(&[f64]) -> Vec<f64>,
    /// The pose of the numbers in a text.
    pub(super) to_pose: fn(&[f64]) -> Pose,
    /// Checks the words in the numbers about the configuration that the controller finds for them.
    pub(super) words: fn(&[f64], &[f64]),
    /// A tool, a frame, the controller's base or its flange by name.
    pub(super) named: fn(&str) -> Pose,
}

/// Content of a slot.
struct Slot {
    letter: char,
    q: Vec<f64>,
    tool: Pose,
    frame: Pose,
    text: String,
}

impl Slot {
    fn is_kept(&self) -> bool {
        self.letter.is_ascii_lowercase()
    }
}

/// The numbers in a text, in their order.
pub(super) fn numbers(text: &str) -> Vec<f64> {
    let is_number = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let pieces = text.split(|c: char| !is_number(c)).filter(|it| it.contains(|c: char| c.is_ascii_digit()));
    pieces.map(|it| it.parse().unwrap_or_else(|_| panic!("`{it}` in `{text}`"))).collect()
}

/// The literal pieces of a template and the slots between them.
fn cut_template(template: &str, nominal: &Robot, form: &Form) -> (Vec<String>, Vec<Slot>) {
    let (mut pieces, mut slots) = (vec![String::new()], Vec::new());
    let mut rest = template;
    while let Some(at) = rest.find('@') {
        pieces.last_mut().unwrap().push_str(&rest[..at]);
        let letter = rest[at + 1..].chars().next().unwrap();
        let end = at + rest[at..].find('}').unwrap();
        let inside: Vec<&str> = rest[at + 3..end].split('|').collect();
        let q: Vec<f64> = inside[0].split_whitespace().map(|it| it.parse::<f64>().unwrap().to_radians()).collect();
        let named = |at: usize| inside.get(at).map_or(Pose::identity(), |it| (form.named)(it));
        let (tool, frame) = (named(1), named(2));
        let text = if letter.eq_ignore_ascii_case(&'j') {
            (form.joints)(&q)
        } else {
            (form.pose)(letter, &(frame.inverse() * nominal.forward_kinematics(&q) * tool), &q)
        };
        slots.push(Slot { letter, q, tool, frame, text });
        pieces.push(String::new());
        rest = &rest[end + 1..];
    }
    pieces.last_mut().unwrap().push_str(rest);
    (pieces, slots)
}

fn latin(text: &str) -> Vec<u8> {
    text.chars().map(|it| u8::try_from(u32::from(it)).unwrap()).collect()
}

/// Texts in the slots of a written program, between the same pieces.
fn texts_in_slots(written: &[u8], pieces: &[String]) -> Vec<String> {
    let first = latin(&pieces[0]);
    assert!(written.starts_with(&first), "the beginning has changed");
    let mut at = first.len();
    let mut found = Vec::new();
    for piece in &pieces[1..] {
        let piece = latin(piece);
        let rest = &written[at..];
        let length = if piece.is_empty() {
            rest.len()
        } else {
            rest.windows(piece.len()).position(|it| it == piece).unwrap_or_else(|| {
                panic!("`{}` is missing in `{}`", String::from_utf8_lossy(&piece), String::from_utf8_lossy(rest))
            })
        };
        found.push(String::from_utf8(rest[..length].to_vec()).unwrap());
        at += length + piece.len();
    }
    assert_eq!(at, written.len(), "the end has changed");
    found
}

fn pose_difference(one: &Pose, other: &Pose) -> (f64, f64) {
    let turn = rotation::log(&(one.rotation.transpose() * other.rotation));
    ((one.translation - other.translation).norm(), turn.norm())
}

/// Remaining metres and radians if lengths are written to 1e-9 m and angles to 1e-7 degrees or 1e-9 rad: six numbers with half of that, and arms of a
/// metre.
const ROUNDING: f64 = 2e-8;
/// Least correction that is not rounding: metres or radians.
const LEAST_MOVED: f64 = 1e-4;

/// Compensates a case and checks every slot; returns the largest remaining distance and angle, and the number of corrected slots.
pub(super) fn check(case: &Case, options: &ProgramOptions, robots: (&Robot, &Robot), form: &Form) -> (f64, f64, usize) {
    let (nominal, actual) = robots;
    let (pieces, slots) = cut_template(case.text, nominal, form);
    let mut text = latin(&pieces[0]);
    for (slot, piece) in slots.iter().zip(&pieces[1..]) {
        text.extend(latin(&slot.text));
        text.extend(latin(piece));
    }
    let (written, summary) = compensate_program(&text, robots, &[], options).unwrap();
    let listed: Vec<(usize, &str, &str)> =
        summary.changes.listed.iter().map(|it| (it.line, it.name.as_str(), it.reason.as_str())).collect();
    assert_eq!(listed, case.listed, "{}", case.name);
    let corrected = slots.iter().filter(|it| !it.is_kept()).count();
    assert_eq!(summary.corrected, corrected, "{}: {:?}", case.name, summary.changes.listed);
    let checked = summary.changes.checked.unwrap();
    let (checked_m, checked_rad) = (checked.left_m, checked.left_rad);
    assert!(checked_m.value < ROUNDING && checked_rad.value < ROUNDING, "{}", case.name);
    let inverse = Inverse::new(nominal, &[]).unwrap();
    let mut worst = (0.0_f64, 0.0_f64);
    for (slot, found) in slots.iter().zip(texts_in_slots(&written, &pieces)) {
        if slot.is_kept() {
            assert_eq!(found, slot.text, "{}", case.name);
            continue;
        }
        let (meant, commanded) = (numbers(&slot.text), numbers(&found));
        let (target, q) = if slot.letter == 'J' {
            (nominal.forward_kinematics(&(form.to_joints)(&meant)), (form.to_joints)(&commanded))
        } else {
            let place = |it: &[f64]| slot.frame * (form.to_pose)(it) * slot.tool.inverse();
            let told = place(&commanded);
            // The controller computes with the nominal robot.
            let q = inverse.solve_nearest(&told, &slot.q, true).unwrap();
            (form.words)(&commanded, &q);
            (place(&meant), q)
        };
        let uncorrected = pose_difference(&actual.forward_kinematics(&slot.q), &target);
        assert!(uncorrected.0.max(uncorrected.1) > LEAST_MOVED, "{}: nothing to correct", case.name);
        let left = pose_difference(&actual.forward_kinematics(&q), &target);
        worst = (worst.0.max(left.0), worst.1.max(left.1));
        assert!(left.0 < ROUNDING && left.1 < ROUNDING, "{}: {}: {left:?}", case.name, slot.text);
    }
    (worst.0, worst.1, corrected)
}

/// A robot of six axes, each a direction and a point (m), with limits in degrees.
pub(super) fn robot(axes: [([f64; 3], [f64; 3]); 6], limits: [(f64, f64); 6], home: Pose) -> Robot {
    let joint = |at: usize| {
        let ((direction, point), (lower, upper)) = (axes[at], limits[at]);
        let screw = Screw::revolute(&Vector3::from(direction), &Vector3::from(point));
        let mut joint = Joint::revolute(&format!("joint{}", at + 1), screw);
        joint.limits = Some(JointLimits { lower: f64::to_radians(lower), upper: f64::to_radians(upper) });
        joint
    };
    Robot::new("arm", (0..6).map(joint).collect(), home).unwrap()
}

/// The actual robot: axes some tenths of a millimetre and of a milliradian off, offsets, and an eccentric gear.
pub(super) fn make_actual(nominal: &Robot) -> Robot {
    let mut out = nominal.clone();
    for (at, joint) in out.joints.iter_mut().enumerate() {
        let k = at as f64;
        let v = Vector3::new((k + 1.0).sin(), (2.0 * k).cos(), (3.0 * k + 2.0).sin()) * 4e-4;
        let w = Vector3::new((5.0 * k).cos(), (k + 3.0).sin(), (4.0 * k).cos()) * 5e-4;
        joint.screw = joint.screw.transform(&Pose::exp(&Twist::new(v, w)));
        let coefficient = 2e-3 * (k + 0.5).sin();
        out.terms.push(JointTerm { joint: at, term: Term::OFFSET, coefficient });
    }
    let wave = TermKind::Sine.with_number(1);
    out.terms.push(JointTerm { joint: 1, term: wave, coefficient: 8e-4 });
    out
}

/// Options of a case.
pub(super) fn options(case: &Case, language: Language) -> ProgramOptions {
    let mut options = ProgramOptions { check: true, ..ProgramOptions::new(language) };
    for words in case.options {
        let (what, words) = words.split_once(' ').unwrap();
        match what {
            "tool" => options.given.add_tool(words, language),
            "frame" => options.given.add_frame(words, language),
            "base" => options.given.set_base(words, language),
            _ => options.given.set_flange(words, language),
        }
        .unwrap();
    }
    options
}

//! Arms of all sizes with their camera at the right end, at the wrong one, and with inverted poses.

use nalgebra::Vector3;

use super::draw::LinearCongruential;
use super::{CameraMounting, FindingKind, HandEyeLevel, HandEyeOptions, hand_eye};
use poecal_arm::lie::{Pose, rotation};
use poecal_testing::trials::trials;

/// A simulated session of an arm of some reach.
struct SimulatedEnds {
    camera: CameraMounting,
    on_flange: Pose,
    flange: Vec<Pose>,
    target: Vec<Pose>,
}

/// An arm of 0.3 to 3 m. The mounted object is up to 0.5 m from the flange, at most 0.3 of the reach. The static object is at a usual position: a
/// board within reach, a camera up to twice as far. Every second board has its z axis towards the camera.
fn session(seed: u64) -> SimulatedEnds {
    let mut draw = LinearCongruential::new(seed + 71);
    let camera = [CameraMounting::InHand, CameraMounting::Beside][seed as usize % 2];
    let mut between = |from: f64, to: f64| from + (to - from) * draw.uniform_number();
    let reach = 0.3 * 10f64.powf(between(0.0, 1.0));
    let held = between(0.02, 1.0) * 0.5f64.min(0.3 * reach);
    let (around, height) = (between(-2.0, 2.0), between(-0.2, 0.5) * reach);
    let away = reach * if camera == CameraMounting::InHand { between(0.35, 0.9) } else { between(0.8, 1.9) };
    let far = reach * if camera == CameraMounting::InHand { between(0.25, 0.6) } else { 0.0 };
    let noise = 10f64.powf(between(-4.0, -2.5));
    let side = [std::f64::consts::PI, 0.0][seed as usize / 2 % 2];
    let count = 10 + (seed % 3) as usize * 5;
    let on_flange = Pose::new(rotation::exp(&draw.vector(1.0)), draw.vector(1.0).normalize() * held);
    let stays = Vector3::new(away * around.cos(), away * around.sin(), height);
    let mut found = SimulatedEnds { camera, on_flange, flange: Vec::new(), target: Vec::new() };
    let in_base = match camera {
        CameraMounting::InHand => Pose::new(rotation::exp(&draw.vector(0.3)) * rotation::about(0, side), stays),
        // The camera looks at the middle of the arm's range.
        CameraMounting::Beside => {
            let middle = Vector3::new(0.5 * reach * around.cos(), 0.5 * reach * around.sin(), 0.5 * reach);
            Pose::new(rotation::shortest_arc(&Vector3::z(), &(middle - stays).normalize()), stays)
        }
    };
    for _ in 0..2000 {
        if found.flange.len() == count {
            break;
        }
        let turn = rotation::exp(&draw.vector(0.35));
        let (seen, base_from_flange) = match camera {
            CameraMounting::InHand => {
                let place = Vector3::new(0.0, 0.0, far) + draw.vector(0.12 * far);
                // The board faces the camera, from above.
                let seen = Pose::new(turn * rotation::about(0, std::f64::consts::PI - side), place);
                (seen, in_base * seen.inverse() * on_flange.inverse())
            }
            CameraMounting::Beside => {
                let middle = Vector3::new(0.5 * reach * around.cos(), 0.5 * reach * around.sin(), 0.5 * reach);
                let place = in_base.inverse().act(&(middle + draw.vector(0.15 * reach)));
                let seen = Pose::new(turn * rotation::about(0, side), place);
                (seen, in_base * seen * on_flange.inverse())
            }
        };
        let distance = base_from_flange.translation.norm();
        if !(0.2 * reach..reach).contains(&distance) || seen.translation.xy().norm() > 0.8 * seen.translation.z {
            continue;
        }
        let shift = draw.vector(noise * seen.translation.norm());
        let off = rotation::exp(&draw.vector(3.0 * noise));
        found.flange.push(base_from_flange);
        found.target.push(Pose::new(off * seen.rotation, seen.translation + shift));
    }
    assert_eq!(found.flange.len(), count, "session {seed}");
    found
}

/// Outcome of a session.
#[derive(Clone, Copy, PartialEq)]
enum End {
    /// Refused, or level "do not use".
    Refused,
    /// The camera at its true position.
    Right,
    /// The camera at another position.
    Wrong,
}

impl SimulatedEnds {
    fn end_session(
        &self,
        camera: CameraMounting,
        inverted: bool,
        (flange, target): (Option<bool>, Option<bool>),
    ) -> (End, String) {
        let arm: Vec<Pose> = self.flange.iter().map(|it| if inverted { it.inverse() } else { *it }).collect();
        let options = HandEyeOptions { camera, flange_inverted: flange, target_inverted: target };
        match hand_eye(&arm.into(), &self.target.clone().into(), &options, &|row| format!("row {row}")) {
            Err(error) => (End::Refused, error.to_string()),
            Ok(found) if found.level == HandEyeLevel::DoNotUse => (End::Refused, found.reasons.join("; ")),
            Ok(found) => {
                let (shift, turn) = found.on_flange.pose.distance_and_angle(&self.on_flange);
                let is_right = camera == self.camera && shift < 0.1 * self.reach() && turn < 0.2;
                let said = found.findings.iter().map(|it| it.statement.clone()).collect::<Vec<_>>().join("; ");
                if inverted && is_right && flange.is_none() {
                    assert!(found.findings.iter().any(|it| it.kind == FindingKind::Inverted), "{said}");
                }
                (if is_right { End::Right } else { End::Wrong }, said)
            }
        }
    }

    fn reach(&self) -> f64 {
        self.flange.iter().map(|it| it.translation.norm()).fold(0.0, f64::max)
    }

    fn other_camera(&self) -> CameraMounting {
        match self.camera {
            CameraMounting::InHand => CameraMounting::Beside,
            CameraMounting::Beside => CameraMounting::InHand,
        }
    }
}

/// Known directions of two lists of poses; of poses and corners; of joint readings and poses; of joint readings and corners.
const KNOWN: [(Option<bool>, Option<bool>); 4] =
    [(None, None), (None, Some(false)), (Some(false), None), (Some(false), Some(false))];

#[test]
fn a_camera_at_the_other_end_is_never_a_result() {
    let trials = trials(240);
    let mut accepted = 0;
    for seed in trials.seeds() {
        let (session, known) = (session(seed), KNOWN[seed as usize / 2 % KNOWN.len()]);
        let (end, said) = session.end_session(session.camera, false, known);
        if end != End::Right {
            println!("{seed} {:?}, right end: {said}", session.camera);
        }
        assert!(end != End::Wrong, "{seed}: {said}");
        accepted += usize::from(end == End::Right);
        let (end, said) = session.end_session(session.other_camera(), false, known);
        assert!(end == End::Refused, "{seed} {:?}, {known:?}: {said}", session.camera);
        assert!(said.contains(&format!("run with --camera {}", session.camera.word())), "{seed}: {said}");
    }
    println!("{accepted} of {} accepted at the right end", trials.count);
    assert!(60 * accepted >= 59 * trials.count, "{accepted}");
}

#[test]
fn inverted_poses_are_inverted_back_or_refused() {
    let sessions: Vec<SimulatedEnds> = trials(120).seeds().map(session).collect();
    for known in KNOWN.into_iter().filter(|it| it.0.is_none()) {
        let (mut right, mut refused) = (0, 0);
        for (seed, session) in sessions.iter().enumerate() {
            match session.end_session(session.camera, true, known) {
                (End::Right, _) => right += 1,
                (End::Refused, said) => {
                    assert!(said.contains("--flange flange-from-base"), "{seed}: {said}");
                    refused += 1;
                    // The statement is followed.
                    let (end, said) = session.end_session(session.camera, true, (Some(true), known.1));
                    assert!(end == End::Right, "{seed}: {said}");
                }
                (End::Wrong, said) => panic!("{seed} {:?}, {known:?}: {said}", session.camera),
            }
            // Two statements are wrong, and the poses fit: the positions of both frames reveal it.
            let (end, said) = session.end_session(session.other_camera(), true, known);
            assert!(end == End::Refused, "{seed} {:?}: {said}", session.camera);
            assert!(said.contains(&format!("--camera {} --flange flange-from-base", session.camera.word())), "{said}");
        }
        println!("{known:?}, inverted: {right} inverted back, {refused} refused");
        // Objects farther from the flange than half of the distance to the base are one in thirty.
        assert!(5 * right >= 4 * sessions.len(), "{right}");
    }
}

//! Report drawings of anchors, sockets, planes, spheres, directions and pairs, and of a robot with two arms.

use crate::report_page::{Session, check_figures, data_of};
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_model::simulate::{SessionKind, elbow};
use serde_json::Value;

/// Each kind, the kind of its references, their number, and words of the page.
const KINDS: [(SessionKind, &str, usize, &str); 9] = [
    (SessionKind::DISTANCE, "anchor", 3, "along the line to the anchor"),
    (SessionKind::CHANGE, "anchor", 3, "150 distances"),
    (SessionKind::SPHERE, "sphere", 1, "to the sphere that it touched"),
    (SessionKind::SOCKET, "socket", 2, "to the middle of the socket"),
    (SessionKind::PLANE, "plane", 3, "along the plane's normal to the height measured"),
    (SessionKind::FLUSH, "plane", 3, "150 flush faces"),
    (SessionKind::DIRECTION, "direction", 1, "150 directions"),
    (SessionKind::BALL_BAR, "pair", 1, "150 distances between two configurations"),
    (SessionKind::RELATIVE, "pair", 1, "150 poses between two configurations"),
];

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|it| it.as_f64().unwrap()).collect()
}

/// References of each kind with their kinds and estimated poses, and figures that are those of the file.
#[test]
fn every_kind_is_drawn_as_what_it_is() {
    for (kind, word, count, words) in KINDS {
        let session = Session::new(&elbow(), kind, 150);
        check_figures(kind.word(), &session);
        let (page, file) = (session.page(), &session.file);
        assert!(page.contains(words), "{}: {words}", kind.word());
        let data = data_of(&page);
        let drawn = data["instruments"].as_array().unwrap();
        assert_eq!(drawn.len(), count, "{}", kind.word());
        assert_eq!(data["draws_instruments"], Value::from(word != "pair"), "{}", kind.word());
        for (it, station) in drawn.iter().zip(&file.stations) {
            assert_eq!((&it["kind"], &it["on"]), (&Value::from(word), &Value::Null), "{}", kind.word());
            assert_eq!(numbers(&it["pose"]["position_m"]), station.base_from_device.position_m);
            let turn = numbers(&it["pose"]["quaternion_xyzw"]);
            let known = station.base_from_device.quaternion_xyzw;
            // Read back and normalised again: rounding.
            assert!(turn.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-15), "{turn:?} {known:?}");
        }
        // The page mentions a device frame only if there is one.
        assert!(!page.contains("in the axes of the measuring device"), "{}", kind.word());
        assert!(!page.contains("contact_x") && !page.contains("tilt_x"), "{}", kind.word());
    }
}

/// A sphere has its radius, known or found, in millimetres in the file and in metres in the page's data.
#[test]
fn spheres_have_their_radius() {
    let session = Session::new(&elbow(), SessionKind::SPHERE, 150);
    let radius = session.file.stations[0].radius_mm.unwrap();
    let drawn = data_of(&session.page())["instruments"][0]["radius_m"].as_f64().unwrap();
    println!("radius of a sphere of 50 mm: {radius:.4} mm");
    // Its size scales with that of the robot, which the model's 2 mm of about a metre determines: 1 mm of 50.
    assert!((radius - 50.0).abs() < 1.0 && (drawn - 1e-3 * radius).abs() < 1e-15);
}

/// Both arms, with a plane in the left hand that the right hand measures, and both hands as targets of planes beside them.
#[test]
fn both_arms_are_drawn_with_what_they_hold() {
    let robot = |instruments: &[(&str, &str)], targets: &[(&str, &str)]| {
        let pairs =
            |of: &[(&str, &str)]| of.iter().map(|(name, link)| ((*name).to_owned(), (*link).to_owned())).collect();
        let selection = ChainSelection {
            base_link: Some("torso".to_owned()),
            instruments: pairs(instruments),
            targets: pairs(targets),
            ..ChainSelection::default()
        };
        let text = include_str!("../../../poecal-testing/data/torso.urdf");
        UrdfDocument::parse(text, "torso.urdf", &selection).unwrap().robot().clone()
    };
    let ons = |data: &Value, list: &str| -> Vec<Value> {
        data[list].as_array().unwrap().iter().map(|it| it["on"].clone()).collect()
    };
    let arms: Vec<Value> = [None, Some(0), Some(1), Some(2), Some(3), Some(4)]
        .into_iter()
        .chain([None, Some(6), Some(7), Some(8), Some(9), Some(10)])
        .map(Value::from)
        .collect();

    let both = robot(&[], &[("left", "left_hand"), ("right", "right_hand")]);
    let session = Session::new(&both, SessionKind::PLANE, 400);
    check_figures("two arms on planes", &session);
    let data = data_of(&session.page());
    assert_eq!(ons(&data, "joints"), arms);
    assert_eq!(ons(&data, "targets"), [5, 11].map(Value::from));
    assert_eq!(ons(&data, "instruments"), [Value::Null, Value::Null, Value::Null]);
    assert!(data["instruments"].as_array().unwrap().iter().all(|it| it["kind"] == "plane"));
    // Rows of both hands.
    let rows = data["rows"]["target"].as_array().unwrap();
    assert!([0, 1].iter().all(|target| rows.contains(&Value::from(*target))));

    let hand = robot(&[("wire", "left_hand")], &[("ball", "right_hand")]);
    let session = Session::new(&hand, SessionKind::DISTANCE, 400);
    let page = session.page();
    let data = data_of(&page);
    assert_eq!(ons(&data, "joints"), arms);
    // The arm of the target comes first, since its target is the tip.
    let named = |list: &str| {
        let joint = data[list][0]["on"].as_u64().unwrap() as usize;
        data["joints"][joint]["name"].as_str().unwrap().to_owned()
    };
    assert_eq!((&*named("instruments"), &*named("targets")), ("left6", "right6"));
    assert_eq!(data["instruments"][0]["kind"], "anchor");
    assert!(page.contains("<td class=\"word\">anchor</td>"), "the table of what stands where");
}

//! A calibrated robot is written into a URDF text. The model that is read back moves like the calibrated robot, and the rest of the text stays.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, Twist, rotation};
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_model::robot::Robot;
use poecal_testing::largest::larger_or_nan;
use poecal_testing::trials::trials;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

/// Metres and radians: rounding over some ten joints, with room.
const TOLERANCE: f64 = 1e-12;

struct Random(ChaCha8Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Random(ChaCha8Rng::seed_from_u64(seed))
    }

    fn draw_within(&mut self, span: f64) -> f64 {
        span * (2.0 * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 1.0)
    }

    fn vector(&mut self, span: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.draw_within(span))
    }

    fn one_in(&mut self, count: u64) -> bool {
        self.0.next_u64().is_multiple_of(count)
    }

    fn choice<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[(self.0.next_u64() % words.len() as u64) as usize]
    }
}

fn words(v: Vector3<f64>) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

/// A chain of random joints and origins, axes of one length, quotes and gaps, with a leader beside it.
fn random_urdf(random: &mut Random, length: f64) -> String {
    let (end, quote) = (random.choice(&["\n", "\r\n", ""]), random.choice(&["\"", "'"]));
    let count = 2 + random.0.next_u64() % 9;
    let mut text = format!("<?xml version='1.0'?>{end}<!-- kept: µ & <joint> -->{end}<robot name='r'>{end}");
    for link in 0..=count {
        let _ = write!(text, "  <link name='l{link}'><visual><origin xyz='1 2 3'/></visual></link>{end}");
    }
    let leader = "<link name='m'/><joint name='lead' type='prismatic'><parent link='l0'/><child link='m'/></joint>";
    let _ = write!(text, "  {leader}{end}");
    for i in 0..count {
        let moving = random.choice(&["revolute", "continuous", "prismatic"]);
        let kind = if i > 0 && random.one_in(3) { "fixed" } else { moving };
        let _ = write!(text, "  <joint name='j{i}' type='{kind}'>{end}    ");
        if random.one_in(4) {
            let _ = write!(text, "<!-- a comment -->{end}    ");
        }
        let _ = write!(text, "<parent link='l{i}'/>{end}    <child link='l{}'/>{end}", i + 1);
        let mut rpy = random.vector(3.2);
        if random.one_in(3) {
            rpy.y = if random.one_in(2) { FRAC_PI_2 } else { -FRAC_PI_2 };
        }
        let (xyz, rpy) = (words(random.vector(0.6)), words(rpy));
        let origin = match random.0.next_u64() % 5 {
            0 => String::new(),
            1 => format!("<origin xyz={quote}{xyz}{quote}/>"),
            2 => format!("<origin rpy={quote} {rpy} {quote} ></origin>"),
            3 => format!("<origin\n rpy={quote}{rpy}{quote}\n xyz={quote}{xyz}{quote} />"),
            _ => "<origin/>".to_owned(),
        };
        let axis = match random.0.next_u64() % 4 {
            0 => String::new(),
            1 => "<axis xyz='0 0 -1'/>".to_owned(),
            2 => "<axis/>".to_owned(),
            _ => format!("<axis xyz='{}'/>", words(random.vector(3.0).normalize() * length)),
        };
        let _ = write!(text, "    {origin}{axis}{end}");
        if i > 0 && random.one_in(4) {
            let _ = write!(text, "<mimic joint='lead' multiplier='-0.5' offset='0.1'/>");
        }
        let _ = write!(text, "  </joint>{end}");
    }
    text + "</robot>" + end
}

fn parse(text: &str, tip: &str) -> UrdfDocument {
    let selection = ChainSelection { tip_link: Some(tip.to_owned()), ..Default::default() };
    UrdfDocument::parse(text, "test.urdf", &selection).unwrap()
}

/// The robot with every screw and the home pose moved by about 3° and 15 mm.
fn disturb_robot(robot: &Robot, random: &mut Random) -> Robot {
    let mut motion = || Pose::exp(&Twist::new(random.vector(0.015), random.vector(0.05)));
    let screws: Vec<Screw> = robot.joints.iter().map(|joint| joint.screw.transform(&motion())).collect();
    let mut calibrated = robot.with_screws(&screws);
    calibrated.home = (motion() * robot.home).orthonormalized();
    calibrated
}

fn largest_difference(a: &Robot, b: &Robot, random: &mut Random) -> f64 {
    assert_eq!(a.reading_names(), b.reading_names());
    (0..20).fold(0.0, |largest, _| {
        let readings: Vec<f64> = a.reading_names().iter().map(|_| random.draw_within(2.0)).collect();
        let (a, b) = (a.forward_kinematics(&readings), b.forward_kinematics(&readings));
        let turn = rotation::log(&(a.rotation.transpose() * b.rotation)).norm();
        larger_or_nan(larger_or_nan(largest, (a.translation - b.translation).norm()), turn)
    })
}

#[test]
fn random_robots_read_back_as_they_were_calibrated() {
    let mut largest = 0.0_f64;
    let robots = trials(3000);
    for seed in robots.seeds() {
        let mut random = Random::new(seed);
        let text = random_urdf(&mut random, 2.5);
        let tip = format!("l{}", text.matches("<visual>").count() - 1);
        let urdf = parse(&text, &tip);
        let calibrated = disturb_robot(urdf.robot(), &mut random);
        let patched = urdf.patch(&calibrated).unwrap();
        let again = parse(&patched.text, &patched.tip_link);
        let difference = largest_difference(&calibrated, again.robot(), &mut random);
        assert!(difference < TOLERANCE, "seed {seed}: {difference:e}\n{text}\n{}", patched.text);
        assert_eq!(again.robot().joints.len(), calibrated.joints.len());
        // The model that was read back needs no further change.
        assert_eq!(again.patch(again.robot()).unwrap().text, patched.text);
        largest = larger_or_nan(largest, difference);
    }
    println!("largest difference over {} robots: {largest:.1e}", robots.count);
}

#[test]
fn an_unchanged_robot_leaves_every_byte() {
    for seed in trials(200).seeds() {
        // A revolute joint without a range is written as continuous.
        let text = random_urdf(&mut Random::new(seed), 1.0).replace("'revolute'", "'continuous'");
        let tip = format!("l{}", text.matches("<visual>").count() - 1);
        let urdf = parse(&text, &tip);
        let patched = urdf.patch(urdf.robot()).unwrap();
        assert_eq!((patched.text, patched.tip_link, patched.notes), (text, tip, vec![]));
    }
}

const TEXT: &str = "\u{feff}<?xml version=\"1.0\"?>\r\n<!-- shop floor, cell 4 -->\r\n<robot name='arm'>\r\n\
\t<link name=\"base\"/><link name=\"arm\"/><link name=\"hand\"/>\r\n\
\t<joint name=\"j1\" type=\"revolute\">\r\n\t\t<parent link=\"base\"/>\r\n\t\t<child link='arm'/>\r\n\
\t\t<origin   xyz='0 0 0.3'/> <!-- measured -->\r\n\t\t<axis xyz=\"0 0 1\"/>\r\n\t\t<limit lower=\"-1\" upper=\"1\"/>\r\n\t</joint>\r\n\
\t<joint name=\"j2\" type=\"continuous\">\r\n\t\t<parent link=\"arm\"/>\r\n\t\t<child link=\"hand\"/>\r\n\t</joint>\r\n</robot>\r\n";

#[test]
fn only_changed_values_are_replaced_and_missing_ones_inserted() {
    let urdf = parse(TEXT, "hand");
    let mut calibrated = urdf.robot().clone();
    let shift = Pose::from_translation(Vector3::new(0.0, 0.0, 0.125));
    calibrated.joints[1].frame = shift * calibrated.joints[1].frame;
    calibrated.joints[1].screw = calibrated.joints[1].screw.transform(&shift);
    calibrated.home = shift * calibrated.home;
    let patched = urdf.patch(&calibrated).unwrap();
    let joint2 = "type=\"continuous\">\r\n\t\t";
    assert_eq!(patched.text, TEXT.replace(joint2, &format!("{joint2}<origin xyz=\"0 0 0.125\"/>\r\n\t\t")));
    assert_eq!((patched.tip_link.as_str(), patched.notes.len()), ("hand", 0));

    calibrated.home.rotation = rotation::about(2, 0.25);
    let patched = urdf.patch(&calibrated).unwrap();
    let added = "</joint>\r\n\t<link name=\"hand_calibrated\"/>\r\n\t<joint name=\"hand_calibrated_joint\" type=\"fixed\">\r\n\
                 \t\t<parent link=\"hand\"/>\r\n\t\t<child link=\"hand_calibrated\"/>\r\n\
                 \t\t<origin xyz=\"0 0 0\" rpy=\"0 0 0.25\"/>\r\n\t</joint>\r\n</robot>\r\n";
    assert!(patched.text.ends_with(added), "{}", patched.text);
    assert_eq!(patched.tip_link, "hand_calibrated");
    assert_eq!(
        patched.notes,
        [
            "link `hand_calibrated` was added below `hand` to hold the calibrated tip, since no fixed joint follows the last moving one"
        ]
    );
}

#[test]
fn an_axis_that_leaves_its_frame_is_written() {
    let urdf = parse(TEXT, "hand");
    let mut calibrated = urdf.robot().clone();
    // Only the screws change: the frames do not follow.
    calibrated.joints[0].screw = Screw::revolute(&Vector3::new(0.0, 0.6, 0.8), &Vector3::new(0.5, 0.0, 0.3));
    calibrated.joints[1].screw = Screw::revolute(&Vector3::y(), &Vector3::new(0.0, 0.0, 0.25));
    let patched = urdf.patch(&calibrated).unwrap();
    assert!(patched.text.contains("xyz='0.5 0 0.3'/> <!-- measured -->\r\n\t\t<axis xyz=\"0 0.6 0.8\"/>"));
    assert!(patched.text.contains("<axis xyz=\"0 1 0\"/>\r\n\t\t<parent"), "{}", patched.text);
    let again = parse(&patched.text, &patched.tip_link);
    assert!(largest_difference(&calibrated, again.robot(), &mut Random::new(1)) < TOLERANCE);
}

#[test]
fn another_robot_is_refused() {
    let urdf = parse(TEXT, "hand");
    let mut other = urdf.robot().clone();
    other.joints.pop();
    assert_eq!(
        urdf.patch(&other).unwrap_err().to_string(),
        "the calibrated robot has other joints, expected the robot that was read from test.urdf"
    );
    let mut other = urdf.robot().clone();
    other.home.translation.x = f64::NAN;
    assert_eq!(
        urdf.patch(&other).unwrap_err().to_string(),
        "the home pose is not at a finite place, expected the robot that was read from test.urdf"
    );
}

/// Other readers understand these differently: an axis of length 2 scales a slide, and a revolute joint has no range.
#[test]
fn axes_are_written_as_unit_vectors_and_endless_joints_as_continuous() {
    let text = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\n\
        <joint name=\"turn\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><origin xyz=\"0 0 0.4\"/><axis xyz=\"0 0 1\"/><limit effort=\"1\" velocity=\"1\"/></joint>\n\
        <joint name=\"slide\" type=\"prismatic\"><parent link=\"b\"/><child link=\"c\"/><origin xyz=\"0.1 0 0\"/><axis xyz=\"0 2 0\"/><limit lower=\"0\" upper=\"1\"/></joint></robot>";
    let urdf = parse(text, "c");
    assert_eq!(
        urdf.remarks(),
        [
            "took only the direction of axes that are no unit vectors, by which others scale the motion: `slide` (length 2)",
            "joints without `lower` and `upper`, which others refuse or hold at 0: `turn`; state them, or type=\"continuous\" if the joint turns without end"
        ]
    );
    let patched = urdf.patch(urdf.robot()).unwrap();
    assert_eq!(
        patched.text,
        text.replace("\"0 2 0\"", "\"0 1 0\"").replace("type=\"revolute\"", "type=\"continuous\"")
    );
    assert_eq!(patched.notes.len(), 2);
    let again = parse(&patched.text, "c");
    assert_eq!((again.robot(), again.remarks()), (urdf.robot(), &[][..]));
}

/// A quaternion counts from version 1.1 on, as in urdfdom, and stays one when it is written.
#[test]
fn quaternions_count_by_the_version_of_the_text() {
    let text = |version: &str, origin: &str| {
        format!(
            "<robot name=\"r\"{version}><link name=\"a\"/><link name=\"b\"/>\n\
             <joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/><origin xyz=\"0 0 0.4\" {origin}/><axis xyz=\"0 0 1\"/></joint></robot>"
        )
    };
    let quaternion = "quat_xyzw=\"0.7071067811865476 0 0 0.7071067811865476\"";
    let turned = parse(&text("", "rpy=\"1.5707963267948966 0 0\""), "b");
    for version in [" version=\"1.1\"", " version=\"1.2\""] {
        let own = text(version, quaternion);
        let urdf = parse(&own, "b");
        assert!((urdf.robot().home.rotation - turned.robot().home.rotation).amax() < 1e-15);
        assert!(urdf.remarks().is_empty());
        assert_eq!(urdf.patch(urdf.robot()).unwrap().text, own);
        let calibrated = disturb_robot(urdf.robot(), &mut Random::new(1));
        let again = parse(&urdf.patch(&calibrated).unwrap().text, "b_calibrated");
        assert!(largest_difference(&calibrated, again.robot(), &mut Random::new(2)) < TOLERANCE);
    }
    for version in ["", " version=\"1.0\""] {
        let urdf = parse(&text(version, quaternion), "b");
        assert_eq!(urdf.robot().home.rotation, parse(&text("", ""), "b").robot().home.rotation);
        assert!(urdf.remarks()[0].starts_with("ignored `quat_xyzw` in the origins of `j`"), "{:?}", urdf.remarks());
    }
    let error = |origin: &str| {
        let text = text(" version=\"1.2\"", origin);
        UrdfDocument::parse(&text, "r.urdf", &ChainSelection::default()).unwrap_err().to_string()
    };
    assert!(error(&format!("rpy=\"0 0 0\" {quaternion}")).contains("has `rpy` and `quat_xyzw`, expected one"));
    assert!(error("quat_xyzw=\"1 1 0 0\"").contains("has a quaternion of length 1.41"));
}

//! URScript.

use nalgebra::{Rotation3, Vector3};
use poecal_arm::lie::Pose;
use poecal_compensate::{Language, ProgramOptions, compensate_program};
use poecal_model::robot::Robot;

use super::slots::{Case, Form, check, make_actual, options, robot};

/// The geometry of a UR5, with its joints at zero as its maker defines them: lying along -x.
fn ur5_robot() -> Robot {
    let (z, y, d1, a2, a3, d4, d5, d6) =
        ([0.0, 0.0, 1.0], [0.0, -1.0, 0.0], 0.0892, 0.425, 0.392, 0.1092, 0.0947, 0.0823);
    let axes = [
        (z, [0.0, 0.0, 0.0]),
        (y, [0.0, 0.0, d1]),
        (y, [-a2, 0.0, d1]),
        (y, [-a2 - a3, 0.0, d1]),
        ([0.0, 0.0, -1.0], [-a2 - a3, -d4, 0.0]),
        (y, [-a2 - a3, 0.0, d1 - d5]),
    ];
    let home = Pose::from_xyz_rpy([-a2 - a3, -d4 - d6, d1 - d5], [std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    robot(axes, [(-360.0, 360.0); 6], home)
}

fn vector_pose(it: &[f64]) -> Pose {
    let turn = Rotation3::from_scaled_axis(Vector3::new(it[3], it[4], it[5]));
    Pose::new(*turn.matrix(), Vector3::new(it[0], it[1], it[2]))
}

fn find_named(name: &str) -> Pose {
    match name {
        "t" => vector_pose(&[0.01, -0.02, 0.15, 0.1, 0.2, 0.3]),
        "u" => vector_pose(&[0.0, 0.0, 0.2, 0.0, 0.0, 0.0]),
        "f" => vector_pose(&[-0.4, 0.1, 0.05, 0.0, 0.0, 1.57]),
        "ff" => find_named("f") * vector_pose(&[0.1, 0.0, 0.0, 0.3, 0.0, 0.0]),
        "base" => vector_pose(&[0.0, 0.0, 0.0, 0.0, 0.0, std::f64::consts::PI]),
        "flange" => vector_pose(&[0.0, 0.0, -0.05, 0.0, 0.0, 0.5]),
        // Frame and tool of the case in which the model's base and tip differ from the controller's.
        "tf" => find_named("flange") * find_named("t"),
        "bf" => find_named("base"),
        _ => Pose::identity(),
    }
}

fn six_texts(numbers: &[f64], decimals: usize) -> String {
    let texts: Vec<String> = numbers.iter().map(|it| format!("{it:.decimals$}")).collect();
    texts.join(", ")
}

const FORM: Form = Form {
    joints: |q| six_texts(q, 4),
    pose: |_, pose, _| {
        let turn = Rotation3::from_matrix_unchecked(pose.rotation).scaled_axis();
        six_texts(&[pose.translation.x, pose.translation.y, pose.translation.z, turn.x, turn.y, turn.z], 6)
    },
    to_joints: <[f64]>::to_vec,
    to_pose: vector_pose,
    words: |_, _| {},
    named: find_named,
};

const COMPUTED: &str = "it is computed while the program runs";
const SEVERAL: &str = "it is assigned several times";

/// Twenty programs; each is named by its content.
const CASES: [Case; 20] = [
    Case {
        name: "joints alone, with other numbers around",
        text: "# Ablauf für Zelle 3: movej([0,0,0,0,0,0])\ndef prog():\n  movej([@J{10 -70 80 -100 -80 20}], a=1.3962634, v=1.0471975, t=0, r=0)\n  \
               sleep(0.5)\n  movel([@J{25 -60 70 -95 -75 35}],1.2,0.25)\nend\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "a tool that is set, and poses from a known configuration",
        text: "def prog():\n  set_tcp(p[0.01, -0.02, 0.15, 0.1, 0.2, 0.3])\n  movej([@J{10 -70 80 -100 -80 20}])\n  \
               movel(p[@P{25 -60 70 -95 -75 35|t}], a=1.2, v=0.25)\n  movep(p[@P{15 -65 75 -90 -85 25|t}])\nend\nprog()\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "no tool: poses stay, joints do not",
        text: "movej([@J{10 -70 80 -100 -80 20}])\nwp = p[@p{25 -60 70 -95 -75 35|t}]\nmovel(wp)\n",
        options: &[],
        listed: &[(2, "wp", "the tool is not known: state it by --tool-data (motion on line 3)")],
    },
    Case {
        name: "a tool that the user states",
        text: "movej([@J{10 -70 80 -100 -80 20}])\r\nmovel(p[@P{25 -60 70 -95 -75 35|t}])\r\n",
        options: &["tool 0.01,-0.02,0.15,0.1,0.2,0.3"],
        listed: &[],
    },
    Case {
        name: "waypoints in variables, as a pendant writes them, with qnear",
        text: "def Prog():\n  global WP_1_p=p[@P{10 -70 80 -100 -80 20|t}]\n  global WP_1_q=[0.1745, -1.2217, 1.3963, -1.7453, -1.3963, \
               0.3491]\n  global WP_2_p=p[@P{25 -60 70 -95 -75 35|t}]\n  set_tcp(p[0.01,-0.02,0.15,0.1,0.2,0.3])\n  while (True):\n    $ 2 \
               \"MoveJ\"\n    movej(get_inverse_kin(WP_1_p, qnear=WP_1_q), a=1.396, v=1.047)\n    movel(WP_2_p, a=1.2, v=0.25)\n  end\nend\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "a frame by pose_trans, as number and as variable",
        text: "feature = p[-0.4, 0.1, 0.05, 0.0, 0.0, 1.57]\nset_tcp(p[0,0,0.2,0,0,0])\nmovej([@J{10 -70 80 -100 -80 \
               20}])\nmovel(pose_trans(feature, p[@P{25 -60 70 -95 -75 35|u|f}]))\nmovel(pose_trans(p[-0.4, 0.1, 0.05, 0, 0, 1.57], \
               p[@P{15 -65 75 -90 -85 25|u|f}]), r=0.01)\nmovel(pose_trans(feature, pose_trans(p[0.1,0,0,0.3,0,0], p[@P{10 -70 80 -100 -80 \
               20|u|ff}])))\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "a frame that only the user knows, and one that nobody does",
        text: "set_tcp(p[0,0,0.2,0,0,0])\nmovej([@J{10 -70 80 -100 -80 20}])\nmovel(pose_trans(table, p[@P{25 -60 70 -95 -75 \
               35|u|f}]))\nwp = p[0.3, 0.1, 0.2, 0.0, 3.14, 0.0]\nmovel(pose_trans(shelf, wp))\n",
        options: &["frame table=-0.4,0.1,0.05,0,0,1.57"],
        listed: &[(
            4,
            "wp",
            "its frame is stated in no line of this file: state it by --work-object NAME= (motion on line 5)",
        )],
    },
    Case {
        name: "no configuration known at first, nor behind a branch in which the robot moves",
        text: "set_tcp(p[0,0,0.2,0,0,0]); zero = p[@p{25 -60 70 -95 -75 35|u}]\nmovel(zero)\nmovej([@J{10 -70 80 -100 -80 20}])\nif \
               read_digital(1):\n  movel(p[@P{15 -65 75 -90 -85 25|u}])\nend\nfirst = p[@p{25 -60 70 -95 -75 35|u}]\nmovel(first)\n",
        options: &[],
        listed: &[
            (
                1,
                "zero",
                "the program states no configuration, and the one before is not known: state where the robot starts by --start, or begin with a joint target (motion on line 2)",
            ),
            (
                7,
                "first",
                "the program states no configuration, and the one before is not known: state where the robot starts by --start, or begin with a joint target (motion on line 8)",
            ),
        ],
    },
    Case {
        name: "arguments by name, over several lines",
        text: "movej( q = [@J{10 -70 80 -100 -80 20}] ,\n  a = 1.4 ,\tv= 1.05 )\n\n\nmovel([@J{25 -60 70 -95 -75 35}]\n)",
        options: &[],
        listed: &[],
    },
    Case {
        name: "variables and expressions in a target, and targets that are computed",
        text: "h = 0.2\nset_tcp(p[0,0,0.2,0,0,0])\nmovej([0.1, -1.2, 1.4, -1.7, -pi/2, 0.3])\nmovel(p[0.3, 0.1, h, 0, 3.14, \
               0])\nmovel(pose_add(get_actual_tcp_pose(), p[0,0,0.1,0,0,0]))\nq = get_actual_joint_positions()\nmovej(q)\n",
        options: &[],
        listed: &[
            (3, "[0.1, -1.2, 1.4, -1.7, -pi/2, 0.3]", "it has words or expressions instead of numbers"),
            (4, "p[0.3, 0.1, h, 0, 3.14, 0]", "it has words or expressions instead of numbers"),
            (5, "pose_add(get_actual_tcp_pose(), p[0,0,0.1,0,0,0])", COMPUTED),
            (7, "q", COMPUTED),
        ],
    },
    Case {
        name: "a way relative to a target that is corrected itself",
        text: "set_tcp(p[0,0,0.2,0,0,0])\nmovej([@J{10 -70 80 -100 -80 20}])\nwp = p[@P{25 -60 70 -95 -75 35|u}]\nmovel(pose_trans(wp, \
               p[0,0,-0.1,0,0,0]))\nmovej([@J{15 -65 75 -90 -85 25}])\nmovel(wp)\n",
        options: &[],
        listed: &[(4, "p[0,0,-0.1,0,0,0]", "it is relative to a target that is corrected itself")],
    },
    Case {
        name: "a variable that changes, and a parameter",
        text: "def go(wp):\n  movel(wp)\nend\nset_tcp(p[0,0,0.2,0,0,0])\nmovej([@J{10 -70 80 -100 -80 20}])\nv = p[0.3,0.1,0.2,0,3.14,0]\nv[2] \
               = 0.3\nmovel(v)\ngo(p[0.3,0.1,0.25,0,3.14,0])\nw = [0,0,0,0,0,0]\nw = [1,1,1,1,1,1]\nmovej(w)\n",
        options: &[],
        listed: &[
            (2, "wp", SEVERAL),
            (8, "v", SEVERAL),
            (9, "p[0.3,0.1,0.25,0,3.14,0]", "it is handed to a routine"),
            (12, "w", SEVERAL),
        ],
    },
    Case {
        name: "arcs by a point between",
        text: "set_tcp(p[0,0,0.2,0,0,0])\nmovej([@J{10 -70 80 -100 -80 20}])\nmovec(p[@P{15 -65 75 -90 -85 25|u}], p[@P{25 -60 70 -95 -75 \
               35|u}], a=1.2, v=0.25, r=0.05, mode=1)\nmovel(p[@P{10 -70 80 -100 -80 20|u}])\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "routines within routines, called twice, in a loop",
        text: "def inner():\n  movel(p[@P{15 -65 75 -90 -85 25|u}])\nend\ndef outer():\n  movej([@J{10 -70 80 -100 -80 20}])\n  inner()\n  \
               movel(p[@P{25 -60 70 -95 -75 35|u}])\nend\nset_tcp(p[0,0,0.2,0,0,0])\nwhile True:\n  outer()\n  outer()\nend\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "one target with two tools",
        text: "wp = p[@p{15 -65 75 -90 -85 25|u}]\nset_tcp(p[0,0,0.2,0,0,0])\nmovej([@J{10 -70 80 -100 -80 \
               20}])\nmovel(wp)\nset_tcp(p[0,0,0.25,0,0,0])\nmovel(wp)\nset_tcp(computed())\nmovel(wp)\n",
        options: &[],
        listed: &[(1, "wp", "it is used with several tools or frames: make a target for each (motion on line 6)")],
    },
    Case {
        name: "a thread that sets the tool",
        text: "thread T():\n  while True:\n    set_tcp(p[0,0,0.2,0,0,0])\n    sync()\n  end\nend\nrun T()\nmovej([@J{10 -70 80 -100 -80 \
               20}])\nset_tcp(p[0,0,0.2,0,0,0])\nwp = p[@p{15 -65 75 -90 -85 25|u}]\nmovel(wp)\n",
        options: &[],
        listed: &[(10, "wp", "the tool is not known: state it by --tool-data (motion on line 11)")],
    },
    Case {
        name: "speeds, streams, and a pose nearest to qnear that stands in the statement",
        text: "set_tcp(p[0,0,0.2,0,0,0])\nmovej(get_inverse_kin(p[@P{15 -65 75 -90 -85 25|u}], [0.26, -1.13, 1.3, -1.57, -1.48, \
               0.44]))\nspeedl([0,0,0.1,0,0,0], 0.5, 1)\nservoj([@J{10 -70 80 -100 -80 20}], 0, 0, 0.008, 0.1, 300)\nwp = p[@p{25 -60 70 -95 \
               -75 35|u}]\nmovel(wp)\n",
        options: &[],
        listed: &[
            (3, "speedl([0,0,0.1,0,0,0], 0.5, 1)", "it is a motion without a target"),
            (
                5,
                "wp",
                "the program states no configuration, and the one before is not known: state where the robot starts by --start, or begin with a joint target (motion on line 6)",
            ),
        ],
    },
    Case {
        name: "poses nearest to the configuration before",
        text: "set_tcp(p[0,0,0.2,0,0,0])\nmovej([@J{10 -70 80 -100 -80 20}])\nmovej(p[@P{25 -60 70 -95 -75 35|u}])\nmovej(get_inverse_kin(p[@P{15 \
               -65 75 -90 -85 25|u}]))\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "on one line, and Latin letters in texts",
        text: "def p(): textmsg(\"Grüße: movel(p[0,0,0,0,0,0])\") end\nif True: movej([@J{10 -70 80 -100 -80 20}]) else: movej([@J{25 -60 70 -95 -75 \
               35}]) end # ß\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "the model's base and tip are others than the controller's",
        text: "set_tcp(p[0.01, -0.02, 0.15, 0.1, 0.2, 0.3])\nmovej([@J{10 -70 80 -100 -80 20}])\nmovel(p[@P{25 -60 70 -95 -75 35|tf|bf}])\n",
        options: &["base 0,0,0,0,0,3.141592653589793", "flange 0,0,-0.05,0,0,0.5"],
        listed: &[],
    },
];

#[test]
fn targets_of_twenty_programs_are_reached_and_all_else_stays() {
    let nominal = ur5_robot();
    let actual = make_actual(&nominal);
    let mut count = 0;
    for case in &CASES {
        let (metres, radians, corrected) = check(case, &options(case, Language::UrScript), (&nominal, &actual), &FORM);
        println!("{}: {corrected} corrected, {metres:.1e} m and {radians:.1e} rad left", case.name);
        count += corrected;
    }
    println!("{count} targets");
}

#[test]
fn degrees_signs_and_spaces_are_those_of_the_program() {
    let nominal = ur5_robot();
    let actual = make_actual(&nominal);
    let text = "movej( [ d2r(10), - 1.25 , +1.4 ,d2r( -100 ), -d2r(80),.35 ] , a = 1.4 )\n";
    let options = ProgramOptions::new(Language::UrScript);
    let (written, summary) = compensate_program(text.as_bytes(), (&nominal, &actual), &[], &options).unwrap();
    let written = String::from_utf8(written).unwrap();
    assert!(summary.is_whole() && summary.corrected == 1, "{:?}", summary.changes.listed);
    let bare = |text: &str| text.replace(|c: char| c.is_ascii_digit() || ".+-".contains(c), "");
    assert_eq!(bare(&written), bare(text));
    assert!(written.contains(", - 1.2") && written.contains(" +1.3"), "{written}");
    let found = super::slots::numbers(&written.replace("d2r", "").replace("- ", "-").replace("-(", "("));
    let q = [found[0].to_radians(), found[1], found[2], found[3].to_radians(), -found[4].to_radians(), found[5]];
    let meant = [10_f64.to_radians(), -1.25, 1.4, -100_f64.to_radians(), -80_f64.to_radians(), 0.35];
    let (there, here) = (actual.forward_kinematics(&q), nominal.forward_kinematics(&meant));
    let left = (there.translation - here.translation).norm();
    println!("{written}{left:.1e} m left");
    assert!(left < 2e-8, "{left}");
}

/// Configurations in which a path of 0.3 m is followed in a series of programs: the time is proportional to their length.
#[test]
fn a_long_program_takes_time_by_its_length() {
    let nominal = ur5_robot();
    let actual = make_actual(&nominal);
    let options = ProgramOptions::new(Language::UrScript);
    let program = |count: usize| {
        let line = |at: usize| format!("movej([0.1, -1.2, 1.4, {}, -1.4, 0.3])\n", -1.7 + 1e-4 * (at % 1000) as f64);
        (0..count).map(line).collect::<String>()
    };
    let time = |count: usize| {
        let text = program(count);
        let start = std::time::Instant::now();
        let (_, summary) = compensate_program(text.as_bytes(), (&nominal, &actual), &[], &options).unwrap();
        assert_eq!(summary.corrected, count);
        start.elapsed().as_secs_f64() / count as f64
    };
    let (short, long) = (time(2_000), time(40_000));
    println!("{:.1} µs a target of 2,000, {:.1} of 40,000", short * 1e6, long * 1e6);
    // Twenty times as many: quadratic growth would take twenty times as long each.
    assert!(long < 8.0 * short, "{short} {long}");
}

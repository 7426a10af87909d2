//! KRL.

use nalgebra::{Rotation3, Vector3};
use poecal_arm::lie::Pose;
use poecal_compensate::{Language, ProgramOptions, compensate_program};
use poecal_model::robot::Robot;

use super::slots::{Case, Form, check, make_actual, options, robot};

/// An arm with the axes and signs of KUKA's: lying along x at zero, axis 4 above axis 3.
fn kuka_robot() -> Robot {
    let (down, y, back) = ([0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]);
    let axes = [
        (down, [0.0, 0.0, 0.0]),
        (y, [0.025, 0.0, 0.4]),
        (y, [0.585, 0.0, 0.4]),
        (back, [0.585, 0.0, 0.425]),
        (y, [1.1, 0.0, 0.425]),
        (back, [1.1, 0.0, 0.425]),
    ];
    let limits = [(-170.0, 170.0), (-190.0, 45.0), (-120.0, 156.0), (-185.0, 185.0), (-120.0, 120.0), (-350.0, 350.0)];
    robot(axes, limits, Pose::from_xyz_rpy([1.19, 0.0, 0.425], [0.0, std::f64::consts::FRAC_PI_2, 0.0]))
}

/// X, Y, Z in millimetres, A, B, C in degrees about z, y and x.
fn abc_pose(it: &[f64]) -> Pose {
    let [a, b, c] = [it[3], it[4], it[5]].map(f64::to_radians);
    let turn = Rotation3::from_euler_angles(c, b, a);
    Pose::new(*turn.matrix(), Vector3::new(it[0], it[1], it[2]) * 1e-3)
}

fn find_named(name: &str) -> Pose {
    match name {
        "t" => abc_pose(&[10.0, -20.0, 150.0, 10.0, 20.0, 30.0]),
        "u" => abc_pose(&[0.0, 0.0, 200.0, 0.0, 0.0, 0.0]),
        "f" => abc_pose(&[400.0, 100.0, 50.0, 90.0, 0.0, 0.0]),
        _ => Pose::identity(),
    }
}

/// Status and turn of a configuration (rad), by the lengths of this arm.
fn status(q: &[f64]) -> (u32, u32) {
    let forearm = q[1] + q[2];
    let x = 0.025 + 0.56 * q[1].cos() + 0.515 * forearm.cos() + 0.025 * forearm.sin();
    let stretched = (0.025_f64 / 0.515).atan();
    let status = u32::from(x < 0.0) | u32::from(q[2] > stretched) << 1 | u32::from(q[4] < 0.0) << 2;
    let turn = q.iter().enumerate().fold(0, |all, (at, it)| all | u32::from(*it < 0.0) << at);
    (status, turn)
}

const FORM: Form = Form {
    joints: |q| {
        let texts: Vec<String> =
            q.iter().enumerate().map(|(at, it)| format!("A{} {:.3}", at + 1, it.to_degrees())).collect();
        texts.join(",")
    },
    pose: |letter, pose, q| {
        let (c, b, a) = Rotation3::from_matrix_unchecked(pose.rotation).euler_angles();
        let [a, b, c] = [a, b, c].map(f64::to_degrees);
        let [x, y, z] = (pose.translation * 1e3).into();
        let pose = format!("X {x:.4},Y {y:.4},Z {z:.4},A {a:.5},B {b:.5},C {c:.5}");
        let (status, turn) = status(q);
        if letter.eq_ignore_ascii_case(&'s') { format!("{pose},S {status},T {turn}") } else { pose }
    },
    // `A1` and `E1` are numbers to the reader too.
    to_joints: |numbers| numbers.chunks(2).map(|it| it[1].to_radians()).collect(),
    to_pose: abc_pose,
    words: |numbers, q| {
        if let [.., s, t] = numbers
            && numbers.len() == 8
        {
            assert_eq!((*s as u32, *t as u32), status(q));
        }
    },
    named: find_named,
};

macro_rules! program {
    ($($line:literal),* $(,)?) => {
        concat!("DEF p()\n$TOOL={X 10,Y -20,Z 150,A 10,B 20,C 30}\n$BASE=$NULLFRAME\n", $($line, "\n",)* "END\n")
    };
}

macro_rules! lines {
    ($($line:literal),* $(,)?) => { concat!($($line, "\n"),*) };
}

const SEVERAL: &str = "it is assigned several times, or handed to a routine";
const RELATIVE: &str =
    "the motion is by an amount from where the robot is, which is corrected: a small error of the amount stays";
const EXTERNAL: &str = "external axes that the model does not have are not at zero";
const PARTIAL: &str = "it does not state all values: the others are those of the position before";
const COMPUTED: &str = "it is computed while the program runs";
const ABSENT: &str = "its values are in another file: correct the one that states them";
const PLACE: &str = "its tool or base is not known: state them by --tool-data NUMBER= and --work-object NUMBER=";

/// Twenty programs; each is named by its content.
const CASES: [Case; 20] = [
    Case {
        name: "axes alone, with comments, folds and CRLF",
        text: "&ACCESS RVP\r\nDEF weld( )\r\n;FOLD PTP HOME Vel= 100 % für {A1 0}\r\nptp {a1 0, A2 -90}; X\r\nPTP {@J{10 -70 80 20 40 -30}} C_PTP ; \
               Größe {A1 5}\r\nPTP {E6AXIS: @J{-15 -60 70 -10 50 25},E1 0.0,E2 0,E3 0,E4 0,E5 0,E6 0}\r\nEND\r\n",
        options: &[],
        listed: &[(4, "{a1 0, A2 -90}", PARTIAL)],
    },
    Case {
        name: "tool and base in the program, S and T, straight ways without",
        text: program!(
            "PTP {E6POS: @S{10 -70 80 20 40 -30|t},E1 0.0,E2 0.0}",
            "LIN {@P{5 -65 75 10 45 -20|t}} C_DIS",
            "LIN {FRAME: @P{-15 -60 70 -10 50 25|t}}",
        ),
        options: &[],
        listed: &[],
    },
    Case {
        name: "S and T in bits",
        text: program!("PTP {POS: @P{10 -70 80 20 40 -30|t},S 'B 010',T 'B100010'}"),
        options: &[],
        listed: &[],
    },
    Case {
        name: "axes at almost zero, where turns change",
        text: program!("PTP {@S{0.01 -70 80 0.01 40 0.01|t}}", "PTP {@S{-0.02 -70 80 -0.01 40 -0.02|t}}",),
        options: &[],
        listed: &[],
    },
    Case {
        name: "neither tool nor base",
        text: "DEF p()\nDECL E6POS P1\nP1={@s{10 -70 80 20 40 -30|t}}\nPTP P1\n$TOOL=$NULLFRAME\nP2={@s{5 -65 75 10 45 -20}}\nPTP P2\nEND\n",
        options: &[],
        listed: &[
            (3, "P1", "the tool is not known: state it by --tool-data (motion on line 4)"),
            (6, "P2", "the frame is not known: state it by --work-object (motion on line 7)"),
        ],
    },
    Case {
        name: "tool and base by number, from the user and from the file",
        text: lines!(
            "DEF p()",
            "TOOL_DATA[2]={X 0,Y 0,Z 200,A 0,B 0,C 0}",
            "BAS(#TOOL,1)",
            "BAS(#BASE,0)",
            "PTP {@S{10 -70 80 20 40 -30|t}}",
            "$TOOL=TOOL_DATA[2]",
            "$BASE = BASE_DATA[7]",
            "LIN {@S{5 -65 75 10 45 -20|u|f}}",
            "BAS (#VEL_CP,2)",
            "$BASE=$WORLD",
            "lin {@P{-15 -60 70 -10 50 25|u}}",
            "END",
        ),
        options: &["tool 1=10,-20,150,10,20,30", "frame 7=400,100,50,90,0,0"],
        listed: &[],
    },
    Case {
        name: "a list of data, as inline forms write it",
        text: lines!(
            "DEFDAT  WELD PUBLIC",
            "EXT BAS (BAS_COMMAND :IN,REAL :IN )",
            "DECL E6POS XP1={@S{10 -70 80 20 40 -30|t|f},E1 0.0,E2 0.0,E3 0.0,E4 0.0,E5 0.0,E6 0.0}",
            "DECL FDAT FP1={TOOL_NO 1,BASE_NO 7,IPO_FRAME #BASE,POINT2[] \" \",TQ_STATE FALSE}",
            "DECL PDAT PPDAT1={VEL 100.0,ACC 100.0,APO_DIST 100.0}",
            "DECL E6POS XP2={@s{5 -65 75 10 45 -20|t},E1 0.0}",
            "DECL FDAT FP2={TOOL_NO 3,BASE_NO 0,IPO_FRAME #BASE}",
            "DECL E6POS XP3={@s{5 -65 75 10 45 -20|t},E1 0.0}",
            "DECL FDAT FP3={TOOL_NO 1,BASE_NO 7,IPO_FRAME #TCP}",
            "DECL E6AXIS XHOME={@J{-15 -60 70 -10 50 25},E1 0.0}",
            "DECL FRAME SHELF={X 1,Y 2,Z 3,A 0,B 0,C 0}",
            "ENDDAT",
        ),
        options: &["tool 1=10,-20,150,10,20,30", "frame 7=400,100,50,90,0,0"],
        listed: &[
            (6, "XP2", PLACE),
            (8, "XP3", "the tool stands outside (IPO_FRAME #TCP)"),
            (11, "SHELF", "a frame: whether motions go there is not in this file"),
        ],
    },
    Case {
        name: "a list of data without points of inline forms",
        text: "DEFDAT D\r\nDECL POS A1POS={@S{10 -70 80 20 40 -30|t|f}}\r\nDECL E6POS P[3]\r\nP[1]={@S{5 -65 75 10 45 -20|t|f}}\r\nP[2]={@p{5 -65 75 10 \
               45 -20|t|f}}\r\nENDDAT\r\n",
        options: &["tool 10,-20,150,10,20,30", "frame 400,100,50,90,0,0"],
        listed: &[(
            5,
            "P[2]",
            "the program states no configuration, and the one before is not known: state where the robot starts by --start, or begin with a joint target",
        )],
    },
    Case {
        name: "points in another file, each told once",
        text: program!("PTP XP1", "LIN XP2", "PTP XP1 C_PTP", "PTP $POS_ACT"),
        options: &[],
        listed: &[(4, "XP1", ABSENT), (5, "XP2", ABSENT), (7, "$POS_ACT", COMPUTED)],
    },
    Case {
        name: "inline forms with their data in the same file",
        text: lines!(
            "DEF p()",
            "DECL FDAT FP1",
            "FP1={TOOL_NO 1,BASE_NO 7,IPO_FRAME #BASE}",
            "XP1={@S{10 -70 80 20 40 -30|t|f}}",
            "XP2={@S{5 -65 75 10 45 -20|t|f}}",
            ";FOLD PTP P1 Vel=100 % PDAT1 Tool[1] Base[7];%{PE}",
            "$BWDSTART=FALSE",
            "PDAT_ACT=PPDAT1",
            "FDAT_ACT=FP1",
            "BAS(#PTP_PARAMS,100)",
            "PTP XP1",
            ";ENDFOLD",
            "$TOOL=$NULLFRAME",
            "SLIN XP2 WITH $VEL=SVEL_CP(2.0, , LCPDAT1), $TOOL=STOOL2(FP1), $BASE=SBASE(FP1.BASE_NO), $IPO_MODE=SIPO_MODE(FP1.IPO_FRAME)",
            "END",
        ),
        options: &["tool 1=10,-20,150,10,20,30", "frame 7=400,100,50,90,0,0"],
        listed: &[],
    },
    Case {
        name: "relative motions, and expressions",
        text: program!(
            "PTP {@S{10 -70 80 20 40 -30|t}}",
            "LIN_REL {Z 10} #TOOL",
            "PTP_REL {A1 5}",
            "LIN {X HEIGHT,Y 0,Z 500,A 0,B 90,C 0}",
            "LIN P2:{X 0,Y 0,Z 50,A 0,B 0,C 0}",
        ),
        options: &[],
        listed: &[
            (5, "LIN_REL {Z 10} #TOOL", RELATIVE),
            (6, "PTP_REL {A1 5}", RELATIVE),
            (7, "{X HEIGHT,Y 0,Z 500,A 0,B 90,C 0}", "it has words or expressions instead of numbers"),
            (8, "P2:{X 0,Y 0,Z 50,A 0,B 0,C 0}", COMPUTED),
        ],
    },
    Case {
        name: "arcs, and one with an angle",
        text: program!(
            "PTP {@S{10 -70 80 20 40 -30|t}}",
            "CIRC {@P{5 -65 75 10 45 -20|t}},{@P{-15 -60 70 -10 50 25|t}} C_DIS",
            "V={X 1,Y 2,Z 3,A 0,B 0,C 0}",
            "CIRC V,V,CA 90",
        ),
        options: &[],
        listed: &[(7, "V", "with CA, the arc does not end there")],
    },
    Case {
        name: "external axes",
        text: program!(
            "XA={E6POS: @s{10 -70 80 20 40 -30|t},E1 100.0,E2 0.0}",
            "PTP XA",
            "XB={E6AXIS: @j{10 -70 80 20 40 -30},E1 0.0,E2 90.0}",
            "PTP XB",
            "PTP {E6AXIS: @J{10 -70 80 20 40 -30},E1 0.0}",
        ),
        options: &[],
        listed: &[(5, "XA", EXTERNAL), (7, "XB", EXTERNAL)],
    },
    Case {
        name: "points that change, and elements by a computed index",
        text: program!(
            "DECL INT I",
            "XA={@s{10 -70 80 20 40 -30|t}}",
            "XA.Z=XA.Z+10",
            "PTP XA",
            "XB={@s{10 -70 80 20 40 -30|t}}",
            "MOVED(XB)",
            "PTP XB",
            "XP[1]={@S{10 -70 80 20 40 -30}}",
            "$TOOL=$NULLFRAME",
            "$BASE=$NULLFRAME",
            "PTP XP[1]",
            "PTP XP[I]",
        ),
        options: &[],
        listed: &[(7, "XA", SEVERAL), (10, "XB", SEVERAL), (15, "XP[I]", COMPUTED)],
    },
    Case {
        name: "S and T that no configuration has, and a straight way to another than they state",
        text: program!(
            "XA={@p{10 -70 80 20 40 -30|t},S 2,T 63}",
            "PTP XA",
            "PTP {@S{10 -70 80 20 40 -30|t}}",
            "XB={@p{5 -65 75 10 45 -20|t},S 6,T 11}",
            "LIN XB",
        ),
        options: &[],
        listed: &[
            (
                4,
                "XA",
                "no configuration of the nominal robot fits the one that is stated: check it, --controller-base and --controller-flange (motion on line 5)",
            ),
            (
                7,
                "XB",
                "the configuration that is stated is not the one to which the motion before leads: check both (motion on line 8)",
            ),
        ],
    },
    Case {
        name: "loops, branches and routines",
        text: lines!(
            "DEF p()",
            "$TOOL={X 10,Y -20,Z 150,A 10,B 20,C 30}",
            "$BASE=$NULLFRAME",
            "FOR I=1 TO 5",
            "  PTP {@S{10 -70 80 20 40 -30|t}}",
            "  IF $IN[1]==TRUE THEN",
            "    go ( )",
            "  ELSE",
            "    LIN {@P{5 -65 75 10 45 -20|t}}",
            "  ENDIF",
            "ENDFOR",
            "XA={@p{-15 -60 70 -10 50 25|t}}",
            "LIN XA",
            "END",
            "DEF GO()",
            "  LIN {@P{-15 -60 70 -10 50 25|t}}",
            "END",
        ),
        options: &[],
        listed: &[(
            12,
            "XA",
            "the program states no configuration, and the one before is not known: state where the robot starts by --start, or begin with a joint target (motion on line 13)",
        )],
    },
    Case {
        name: "a routine of another file may set the tool",
        text: program!("gripper(TRUE)", "XA={@s{10 -70 80 20 40 -30|t}}", "PTP XA"),
        options: &[],
        listed: &[(5, "XA", "the tool is not known: state it by --tool-data (motion on line 6)")],
    },
    Case {
        name: "points with one base and with two, and a tool that stands outside",
        text: program!(
            "XA={@S{10 -70 80 20 40 -30|t}}",
            "XC={@s{5 -65 75 10 45 -20|t}}",
            "PTP XA",
            "PTP XC",
            "$BASE={X 1,Y 0,Z 0,A 0,B 0,C 0}",
            "PTP XC",
            "$BASE={X 400,Y 100,Z 50,A 90,B 0,C 0}",
            "PTP {@S{-25 -80 95 15 -45 10|t|f}}",
            "$BASE={X 0,Y 0,Z 0,A 0,B 0,C 0}",
            "PTP XA",
            "$IPO_MODE=#TCP",
            "XB={@s{10 -70 80 20 40 -30|t}}",
            "PTP XB",
        ),
        options: &[],
        listed: &[
            (5, "XC", "it is used with several tools or frames: make a target for each (motion on line 9)"),
            (15, "XB", "the tool is not known: state it by --tool-data (motion on line 16)"),
        ],
    },
    Case {
        name: "upper and lower case, odd spacing, numbers of every form",
        text: "def P ( )\n  $Tool = { x 10 , Y - 20, z +150.0 , a 1E1,b 20,C 3.0E+1 }\n  $base=$nullframe\n\tPtp   { Axis : @J{10 -70 80 20 40 \
               -30} }\n  spTP { @S{10 -70 80 20 40 -30|t} }   with $VEL_AXIS[1]=SVEL_JOINT(100.0)\nend\n",
        options: &[],
        listed: &[],
    },
    Case {
        name: "a wrist that is straight, and a point without S and T near one that is known",
        text: program!(
            "XA={@s{10 -70 80 20 0 -30|t}}",
            "PTP XA",
            "PTP {@J{10 -70 80 20 40 -30}}",
            "PTP {@P{5 -65 75 10 45 -20|t}}",
        ),
        options: &[],
        listed: &[(4, "XA", "it is at a singularity: make it a joint target (motion on line 5)")],
    },
];

#[test]
fn targets_of_twenty_programs_are_reached_and_all_else_stays() {
    let nominal = kuka_robot();
    let actual = make_actual(&nominal);
    let mut count = 0;
    for case in &CASES {
        let (metres, radians, corrected) = check(case, &options(case, Language::Krl), (&nominal, &actual), &FORM);
        println!("{}: {corrected} corrected, {metres:.1e} m and {radians:.1e} rad left", case.name);
        count += corrected;
    }
    println!("{count} targets");
}

/// The example of KUKA's programming manual: the arm with its upper arm upright and its forearm level has S 'B 010', T 'B 000010'.
#[test]
fn the_status_of_the_home_position_is_that_of_the_manual() {
    let nominal = kuka_robot();
    // A wrist that is bent a little, since at zero it is singular: both have A5 above zero.
    let q = [0.1_f64, -90.0, 90.0, 0.1, 10.0, 0.1].map(f64::to_radians);
    let pose = (FORM.pose)('P', &nominal.forward_kinematics(&q), &q);
    for (words, is_taken) in [("S 2,T 2", true), ("S 0,T 2", false), ("S 6,T 2", false), ("S 2,T 3", false)] {
        let text = format!("DEF p()\n$TOOL=$NULLFRAME\n$BASE=$NULLFRAME\nPTP {{{pose},{words}}}\nEND\n");
        let options = ProgramOptions::new(Language::Krl);
        let (_, summary) = compensate_program(text.as_bytes(), (&nominal, &nominal), &[], &options).unwrap();
        assert_eq!(summary.corrected == 1, is_taken, "{words}: {:?}", summary.changes.listed);
    }
}

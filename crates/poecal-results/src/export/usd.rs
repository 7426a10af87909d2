//! USD physics: bodies with joints about z. Joint frames are of single precision there, which limits it to a tenth of a micrometre.

use std::fmt::Write as _;

use nalgebra::Vector3;

use super::{ExportedText, Proof, remaining_difference, unreadable_error};
use poecal_arm::lie::Pose;
use poecal_model::forms::AxisFrames;
use poecal_model::robot::{Body, JointKind, Robot};
use poecal_numerics::error::Result;
use poecal_storage::numbers::format_shortest;

pub(crate) fn write(robot: &Robot) -> Result<ExportedText> {
    let frames = AxisFrames::from_robot(robot)?;
    let plain = frames.robot(robot)?;
    let mut text = String::new();
    text.push_str("def Xform \"robot\" (\n    prepend apiSchemas = [\"PhysicsArticulationRootAPI\"]\n)\n{\n");
    push_body(&mut text, "base", &Pose::identity(), None);
    let mut base_from = Pose::identity();
    for (at, frame) in frames.joints.iter().enumerate() {
        base_from = base_from * *frame;
        push_body(&mut text, &format!("link{}", at + 1), &base_from, mass_of(robot, Body::Link(at)));
    }
    push_body(&mut text, "tip", &(base_from * frames.last_from_tip), None);
    // Without it the base would be free.
    text.push_str(
        "    def PhysicsFixedJoint \"base_to_world\"\n    {\n        rel physics:body1 = </robot/base>\n    }\n",
    );
    let mut before = "base".to_owned();
    for (at, (joint, frame)) in plain.joints.iter().zip(&frames.joints).enumerate() {
        let link = format!("link{}", at + 1);
        let (schema, scale) = match joint.kind {
            JointKind::Revolute => ("PhysicsRevoluteJoint", 180.0 / std::f64::consts::PI),
            JointKind::Prismatic => ("PhysicsPrismaticJoint", 1.0),
        };
        push_joint(&mut text, (schema, &format!("joint{}", at + 1)), (&before, &link), frame);
        text.push_str("        uniform token physics:axis = \"Z\"\n");
        if let Some(limits) = joint.limits {
            let _ = writeln!(text, "        float physics:lowerLimit = {}", format_shortest(limits.lower * scale));
            let _ = writeln!(text, "        float physics:upperLimit = {}", format_shortest(limits.upper * scale));
        }
        let _ = writeln!(text, "        custom string poecal:joint = {}", serde_json::Value::from(joint.name.as_str()));
        text.push_str("    }\n");
        before = link;
    }
    push_joint(&mut text, ("PhysicsFixedJoint", "tool"), (&before, "tip"), &frames.last_from_tip);
    text.push_str("    }\n}\n");
    let again = read(&text, frames.joints.len())?.robot(robot)?;
    let remains = remaining_difference(robot, &again);
    let words = format!(
        "frames of joints are of single precision in USD: the tip is off by up to {:.1e} m and {:.1e} rad",
        remains.position_m, remains.rotation_rad
    );
    let head = format!(
        "#usda 1.0\n(\n    defaultPrim = \"robot\"\n    doc = {}\n    kilogramsPerUnit = 1\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\n",
        serde_json::Value::from(format!("Joints of a calibrated robot; {words}."))
    );
    let masses = if robot.masses.is_empty() {
        "the model states no masses, so that those of the bodies are left to the simulator"
    } else {
        "masses of links are those of the model, moments of inertia are left to the simulator"
    };
    Ok(ExportedText { text: head + &text, notes: vec![words, masses.to_owned()], proof: Proof::Remains(remains) })
}

/// The mass of a link, kg, and its centre in the base at zero; `None` if the model states none.
fn mass_of(robot: &Robot, body: Body) -> Option<(f64, Vector3<f64>)> {
    let own = || robot.masses.iter().filter(|it| it.body == body);
    let kg: f64 = own().map(|it| it.kg).sum();
    (kg > 0.0).then(|| (kg, own().map(|it| it.place * it.kg).sum::<Vector3<f64>>() / kg))
}

fn push_body(text: &mut String, name: &str, pose: &Pose, mass: Option<(f64, Vector3<f64>)>) {
    let [x, y, z]: [f64; 3] = pose.translation.into();
    let [qx, qy, qz, qw] = pose.quaternion_xyzw();
    let (schema, mass) = mass.map_or_else(Default::default, |(kg, centre)| {
        let [x, y, z] = <[f64; 3]>::from(pose.inverse().act(&centre)).map(|it| it as f32);
        let words = format!(
            "        point3f physics:centerOfMass = ({x:?}, {y:?}, {z:?})\n        float physics:mass = {}\n",
            format_shortest(kg)
        );
        (", \"PhysicsMassAPI\"", words)
    });
    let _ = writeln!(
        text,
        "    def Xform \"{name}\" (\n        prepend apiSchemas = [\"PhysicsRigidBodyAPI\"{schema}]\n    )\n    {{\n{mass}        \
         quatd xformOp:orient = ({qw:?}, {qx:?}, {qy:?}, {qz:?})\n        double3 xformOp:translate = ({x:?}, {y:?}, {z:?})\n        \
         uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]\n    }}"
    );
}

fn push_joint(text: &mut String, (schema, name): (&str, &str), (before, link): (&str, &str), frame: &Pose) {
    // The value in single precision, as a reader stores it.
    let [x, y, z] = <[f64; 3]>::from(frame.translation).map(|it| it as f32);
    let [qx, qy, qz, qw] = frame.quaternion_xyzw().map(|it| it as f32);
    let _ = writeln!(
        text,
        "    def {schema} \"{name}\"\n    {{\n        rel physics:body0 = </robot/{before}>\n        rel physics:body1 = </robot/{link}>\n        \
         point3f physics:localPos0 = ({x:?}, {y:?}, {z:?})\n        quatf physics:localRot0 = ({qw:?}, {qx:?}, {qy:?}, {qz:?})\n        \
         point3f physics:localPos1 = (0, 0, 0)\n        quatf physics:localRot1 = (1, 0, 0, 0)"
    );
}

fn read(text: &str, count: usize) -> Result<AxisFrames> {
    let numbers = |line: &str| -> Vec<f64> {
        let inside = line.split_once('(').map_or("", |(_, rest)| rest.trim_end_matches(')'));
        inside.split(',').filter_map(|it| it.trim().parse::<f32>().ok()).map(f64::from).collect()
    };
    let of = |what: &str| -> Vec<Vec<f64>> {
        text.lines().filter(|line| line.trim_start().starts_with(what)).map(numbers).collect()
    };
    let (places, turns) = (of("point3f physics:localPos0 ="), of("quatf physics:localRot0 ="));
    let mut poses = Vec::with_capacity(count + 1);
    for pair in places.iter().zip(&turns) {
        let ([x, y, z], [w, qx, qy, qz]) = (pair.0.as_slice(), pair.1.as_slice()) else {
            return Err(unreadable_error("a frame without numbers"));
        };
        poses.push(Pose::from_position_quaternion([*x, *y, *z], [*qx, *qy, *qz, *w]));
    }
    let last_from_tip = poses.pop().filter(|_| poses.len() == count).ok_or_else(|| unreadable_error("no frame"))?;
    Ok(AxisFrames { joints: poses, last_from_tip })
}

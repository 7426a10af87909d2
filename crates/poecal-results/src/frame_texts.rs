//! A frame in the forms that people paste: matrix, quaternion, ROS, URDF, easy_handeye2, MoveIt, OpenCV, and makers' tools.

use std::fmt::Write as _;

use poecal_arm::lie::{Pose, rotation};

/// A frame by the names of its parent and its own.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedFrame {
    /// The parent's name, as `tool0`.
    pub parent: String,
    /// Its own name, as `camera`.
    pub child: String,
    /// `parent_from_child`.
    pub pose: Pose,
}

/// Nine decimals, without `-0`.
fn number(value: f64) -> String {
    let text = format!("{value:.9}");
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

fn listed(values: &[f64], separator: &str) -> String {
    values.iter().map(|it| number(*it)).collect::<Vec<_>>().join(separator)
}

impl NamedFrame {
    /// Rows of the 4 × 4 matrix, metres.
    #[must_use]
    pub fn matrix(&self) -> [[f64; 4]; 4] {
        let Pose { rotation, translation } = &self.pose;
        std::array::from_fn(|i| {
            std::array::from_fn(|j| match (i, j) {
                (3, _) => f64::from(u8::from(j == 3)),
                (_, 3) => translation[i],
                _ => rotation[(i, j)],
            })
        })
    }

    /// Rotation vector, radians.
    #[must_use]
    pub fn rvec(&self) -> [f64; 3] {
        rotation::log(&self.pose.rotation).into()
    }

    /// Roll, pitch, yaw of URDF, radians.
    #[must_use]
    pub fn rpy(&self) -> [f64; 3] {
        rotation::to_rpy(&self.pose.rotation)
    }

    fn arguments(&self) -> [(&'static str, f64); 7] {
        let t = &self.pose.translation;
        let [qx, qy, qz, qw] = self.pose.quaternion_xyzw();
        [("x", t.x), ("y", t.y), ("z", t.z), ("qx", qx), ("qy", qy), ("qz", qz), ("qw", qw)]
    }

    /// The line that publishes it in ROS 2.
    #[must_use]
    pub fn static_transform_publisher(&self) -> String {
        let numbers: String =
            self.arguments().iter().map(|(name, value)| format!(" --{name} {}", number(*value))).collect();
        format!(
            "ros2 run tf2_ros static_transform_publisher{numbers} --frame-id {} --child-frame-id {}",
            self.parent, self.child
        )
    }

    /// The fixed joint of a URDF.
    #[must_use]
    pub fn urdf_joint(&self) -> String {
        format!(
            "<joint name=\"{child}_joint\" type=\"fixed\">\n  <parent link=\"{}\"/>\n  <child link=\"{child}\"/>\n  <origin xyz=\"{}\" rpy=\"{}\"/>\n</joint>",
            self.parent,
            listed(self.pose.translation.as_slice(), " "),
            listed(&self.rpy(), " "),
            child = self.child
        )
    }

    /// The launch file that MoveIt's hand-eye calibration writes.
    #[must_use]
    pub fn launch_file(&self, what: &str) -> String {
        let mut lines = String::new();
        for (name, value) in self.arguments() {
            let _ = writeln!(lines, "                \"--{name}\",\n                \"{}\",", number(value));
        }
        format!(
            "\"\"\"{what}: {parent} -> {child}, by poecal\"\"\"\n\nfrom launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n\
             def generate_launch_description() -> LaunchDescription:\n    nodes = [\n        Node(\n            package=\"tf2_ros\",\n            \
             executable=\"static_transform_publisher\",\n            output=\"log\",\n            arguments=[\n                \"--frame-id\",\n                \
             \"{parent}\",\n                \"--child-frame-id\",\n                \"{child}\",\n{lines}            ],\n        ),\n    ]\n    return \
             LaunchDescription(nodes)\n",
            parent = self.parent,
            child = self.child
        )
    }

    /// The file of easy_handeye2, which its publisher reads.
    #[must_use]
    pub fn easy_handeye2(&self, is_in_hand: bool, [base, flange, camera, target]: [&str; 4]) -> String {
        let kind = if is_in_hand { "eye_in_hand" } else { "eye_on_base" };
        let [(_, x), (_, y), (_, z), (_, qx), (_, qy), (_, qz), (_, qw)] = self.arguments();
        let [x, y, z, qx, qy, qz, qw] = [x, y, z, qx, qy, qz, qw].map(number);
        format!(
            "parameters:\n  name: poecal\n  calibration_type: {kind}\n  tracking_base_frame: {camera}\n  tracking_marker_frame: {target}\n  \
             robot_base_frame: {base}\n  robot_effector_frame: {flange}\n  freehand_robot_movement: true\n  move_group_namespace: /\n  move_group: \
             manipulator\ntransform:\n  translation:\n    x: {x}\n    y: {y}\n    z: {z}\n  rotation:\n    x: {qx}\n    y: {qy}\n    z: {qz}\n    w: {qw}\n"
        )
    }

    /// What `cv::FileStorage` reads: `rvec`, `tvec` and the matrix.
    #[must_use]
    pub fn opencv(&self) -> String {
        let matrix = |name: &str, rows: usize, columns: usize, values: &[f64]| {
            format!(
                "{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {} ]\n",
                listed(values, ", ")
            )
        };
        let [rvec, tvec] = [self.rvec(), self.pose.translation.into()];
        "%YAML:1.0\n---\n".to_owned()
            + &matrix("rvec", 3, 1, &rvec)
            + &matrix("tvec", 3, 1, &tvec)
            + &matrix(&format!("{}_from_{}", self.parent, self.child), 4, 4, self.matrix().as_flattened())
    }

    /// All short forms, each under its name.
    #[must_use]
    pub fn short_forms(&self) -> String {
        let rows: Vec<String> =
            self.matrix().iter().map(|row| format!("  [{}]", listed(row, ", "))).collect();
        let millimetres: Vec<f64> = self.pose.translation.iter().map(|it| 1e3 * it).collect();
        let [a, b, c] = self.rpy().map(f64::to_degrees);
        let [qx, qy, qz, qw] = self.pose.quaternion_xyzw();
        let name = format!("{} from {}", self.parent, self.child);
        [
            format!("# {name}: 4 x 4 matrix, metres"),
            format!("[\n{}\n]", rows.join(",\n")),
            format!("# {name}: x y z (m), quaternion x y z w"),
            format!("{}  {}", listed(self.pose.translation.as_slice(), " "), listed(&[qx, qy, qz, qw], " ")),
            format!("# {name}: OpenCV's tvec (m) and rvec (rad)"),
            format!("{}  {}", listed(self.pose.translation.as_slice(), " "), listed(&self.rvec(), " ")),
            format!("# {name}: X Y Z (mm), KUKA's A B C (deg)"),
            format!("{}  {}", listed(&millimetres, " "), listed(&[c, b, a], " ")),
            format!("# {name}: X Y Z (mm), FANUC's W P R (deg)"),
            format!("{}  {}", listed(&millimetres, " "), listed(&[a, b, c], " ")),
            format!("# {name}: ROS 2"),
            self.static_transform_publisher(),
            format!("# {name}: URDF"),
            self.urdf_joint(),
        ]
        .join("\n")
            + "\n"
    }
}

/// A tool's tip (and its axes) in the forms of controllers.
#[must_use]
pub fn tool_forms(pose: &Pose) -> String {
    let [x, y, z] = [0, 1, 2].map(|k| number(1e3 * pose.translation[k]));
    let [roll, pitch, yaw] = rotation::to_rpy(&pose.rotation).map(|it| number(it.to_degrees()));
    let [qx, qy, qz, qw] = pose.quaternion_xyzw().map(number);
    let [rx, ry, rz]: [f64; 3] = rotation::log(&pose.rotation).into();
    let metres = listed(pose.translation.as_slice(), ", ");
    [
        "# KUKA (KRL), mm and deg".to_owned(),
        format!("$TOOL = {{X {x}, Y {y}, Z {z}, A {yaw}, B {pitch}, C {roll}}}"),
        "# FANUC, UTOOL, mm and deg".to_owned(),
        format!("X {x}  Y {y}  Z {z}  W {roll}  P {pitch}  R {yaw}"),
        "# ABB (RAPID), mm; set mass and centre of gravity".to_owned(),
        format!("PERS tooldata tPoecal := [TRUE,[[{x},{y},{z}],[{qw},{qx},{qy},{qz}]],[1,[0,0,1],[1,0,0,0],0,0,0]];"),
        "# Universal Robots (URScript), m and rad".to_owned(),
        format!("set_tcp(p[{metres}, {}])", listed(&[rx, ry, rz], ", ")),
    ]
    .join("\n")
        + "\n"
}

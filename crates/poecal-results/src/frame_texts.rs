//! A frame in the usual forms for pasting: matrix, quaternion, ROS, URDF, easy_handeye2, MoveIt, OpenCV, and makers' tools.

use std::fmt::Write as _;

use poecal_arm::lie::{Pose, rotation};
use poecal_storage::numbers::format_shortest;

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
    if text.trim_start_matches(['-', '0', '.']).is_empty() { text.trim_start_matches('-').to_owned() } else { text }
}

fn join_values(values: &[f64], separator: &str) -> String {
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
            join_values(self.pose.translation.as_slice(), " "),
            join_values(&self.rpy(), " "),
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

    /// Text that `cv::FileStorage` reads: `rvec`, `tvec` and the matrix.
    #[must_use]
    pub fn opencv(&self) -> String {
        let matrix = |name: &str, rows: usize, columns: usize, values: &[f64]| {
            format!(
                "{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {} ]\n",
                join_values(values, ", ")
            )
        };
        let [rvec, tvec] = [self.rvec(), self.pose.translation.into()];
        "%YAML:1.0\n---\n".to_owned()
            + &matrix("rvec", 3, 1, &rvec)
            + &matrix("tvec", 3, 1, &tvec)
            + &matrix(&format!("{}_from_{}", self.parent, self.child), 4, 4, self.matrix().as_flattened())
    }

    /// Its position alone, if its orientation was not measured.
    #[must_use]
    pub fn position_forms(&self) -> String {
        let millimetres: Vec<f64> = self.pose.translation.iter().map(|it| 1e3 * it).collect();
        let name = format!("{} from {}, position only", self.parent, self.child);
        [
            format!("# {name}: x y z (m)"),
            join_values(self.pose.translation.as_slice(), " "),
            format!("# {name}: X Y Z (mm)"),
            join_values(&millimetres, " "),
            format!("# {name}: ROS 2, with the axes of {}", self.parent),
            self.static_transform_publisher(),
            format!("# {name}: URDF, with the axes of {}", self.parent),
            self.urdf_joint(),
        ]
        .join("\n")
            + "\n"
    }

    /// All short forms, each under its name.
    #[must_use]
    pub fn short_forms(&self) -> String {
        // All digits, for programs that read it.
        let digits = |row: &[f64; 4]| row.map(|it| format_shortest(it + 0.0)).join(", ");
        let rows: Vec<String> = self.matrix().iter().map(|row| format!("  [{}]", digits(row))).collect();
        let millimetres: Vec<f64> = self.pose.translation.iter().map(|it| 1e3 * it).collect();
        let [a, b, c] = self.rpy().map(f64::to_degrees);
        let [qx, qy, qz, qw] = self.pose.quaternion_xyzw();
        let name = format!("{} from {}", self.parent, self.child);
        [
            format!("# {name}: 4 x 4 matrix, metres"),
            format!("[\n{}\n]", rows.join(",\n")),
            format!("# {name}: x y z (m), quaternion x y z w"),
            format!("{}  {}", join_values(self.pose.translation.as_slice(), " "), join_values(&[qx, qy, qz, qw], " ")),
            format!("# {name}: OpenCV's tvec (m) and rvec (rad)"),
            format!("{}  {}", join_values(self.pose.translation.as_slice(), " "), join_values(&self.rvec(), " ")),
            format!("# {name}: X Y Z (mm), KUKA's A B C (deg)"),
            format!("{}  {}", join_values(&millimetres, " "), join_values(&[c, b, a], " ")),
            format!("# {name}: X Y Z (mm), FANUC's W P R (deg)"),
            format!("{}  {}", join_values(&millimetres, " "), join_values(&[a, b, c], " ")),
            format!("# {name}: ROS 2"),
            self.static_transform_publisher(),
            format!("# {name}: URDF"),
            self.urdf_joint(),
        ]
        .join("\n")
            + "\n"
    }
}

/// Bounds of a tool: of the tip and, if its direction was measured, of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolBounds {
    /// Bound of the tip, metres.
    pub tip_m: f64,
    /// Bound of the direction, radians; `None` if it was not measured.
    pub axis_rad: Option<f64>,
}

/// A tool in the form of a maker of controllers.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolForm {
    /// The maker's short name.
    pub maker: &'static str,
    /// Its language and units, and the unknown values that stay as the controller has them.
    pub remark: String,
    /// The text to paste, or the numbers to type.
    pub text: String,
}

/// Number of decimals that resolve a tenth of a bound.
fn known_to(bound: f64) -> usize {
    if bound > 0.0 { (1.0 - bound.log10().floor()).clamp(0.0, 9.0) as usize } else { 9 }
}

/// A number with these decimals, without `-0`.
fn with_decimals(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.trim_start_matches(['-', '0', '.']).is_empty() {
        true => text.trim_start_matches('-').to_owned(),
        false => text,
    }
}

/// A tool's tip, and its axes if its direction was measured, in the forms of controllers: with only significant digits, and without a mass.
#[must_use]
pub fn tool_forms(pose: &Pose, bounds: ToolBounds) -> Vec<ToolForm> {
    let (mm, m) = (known_to(1e3 * bounds.tip_m), known_to(bounds.tip_m));
    let [x, y, z] = [0, 1, 2].map(|k| with_decimals(1e3 * pose.translation[k], mm));
    let [ux, uy, uz] = [0, 1, 2].map(|k| with_decimals(pose.translation[k], m));
    let form = |maker: &'static str, remark: String, text: String| ToolForm { maker, remark, text };
    let Some(axis) = bounds.axis_rad else {
        let keep = |angles: &str| format!("position only, keep your {angles}");
        return vec![
            form("KUKA", format!("KUKA, mm; {}", keep("A, B, C")), format!("X {x}, Y {y}, Z {z}  (keep your A, B, C)")),
            form(
                "FANUC",
                format!("FANUC, UTOOL, mm; {}", keep("W, P, R")),
                format!("X {x}  Y {y}  Z {z}  (keep your W, P, R)"),
            ),
            form(
                "ABB",
                format!("ABB (RAPID), mm; {} and load", keep("orientation")),
                format!("tPoecal.tframe.trans := [{x},{y},{z}];"),
            ),
            form(
                "UR",
                format!("Universal Robots (URScript), m; {}", keep("RX, RY, RZ")),
                format!("tcp = get_tcp_offset()\nset_tcp(p[{ux}, {uy}, {uz}, tcp[3], tcp[4], tcp[5]])"),
            ),
        ];
    };
    let (deg, rad) = (known_to(axis.to_degrees()), known_to(axis));
    let [roll, pitch, yaw] = rotation::to_rpy(&pose.rotation).map(|it| with_decimals(it.to_degrees(), deg));
    let [qx, qy, qz, qw] = pose.quaternion_xyzw().map(number);
    let [rx, ry, rz]: [f64; 3] = rotation::log(&pose.rotation).into();
    let [rx, ry, rz] = [rx, ry, rz].map(|it| with_decimals(it, rad));
    let turn = "the turn about the tool's axis was not measured";
    vec![
        form(
            "KUKA",
            format!("KUKA (KRL), mm and deg; {turn}"),
            format!("$TOOL = {{X {x}, Y {y}, Z {z}, A {yaw}, B {pitch}, C {roll}}}"),
        ),
        form(
            "FANUC",
            format!("FANUC, UTOOL, mm and deg; {turn}"),
            format!("X {x}  Y {y}  Z {z}  W {roll}  P {pitch}  R {yaw}"),
        ),
        form(
            "ABB",
            format!("ABB (RAPID), mm; {turn}; keep your load"),
            format!("tPoecal.tframe := [[{x},{y},{z}],[{qw},{qx},{qy},{qz}]];"),
        ),
        form(
            "UR",
            format!("Universal Robots (URScript), m and rad; {turn}"),
            format!("set_tcp(p[{ux}, {uy}, {uz}, {rx}, {ry}, {rz}])"),
        ),
    ]
}

//! A robot as lines, drawn from two sides: for paper, and for browsers that do not draw in three dimensions.

use maud::{Markup, PreEscaped};
use nalgebra::Vector3;

use crate::plot::{ArmPlot, ArmSeries};
use poecal_plan::plan::skeleton;
use poecal_results::calibration_file::CalibrationFile;

/// A picture from one side: the horizontal and the vertical coordinate.
pub(crate) struct SideView {
    title: &'static str,
    pub(crate) axes: [usize; 2],
    up: &'static str,
}

impl SideView {
    /// Projection of a point.
    pub(crate) fn project(&self, at: &Vector3<f64>) -> [f64; 2] {
        self.axes.map(|axis| at[axis])
    }
}

const VIEWS: [SideView; 2] = [
    SideView { title: "From the side", axes: [0, 2], up: "z" },
    SideView { title: "From above", axes: [0, 1], up: "y" },
];

/// Both pictures of a robot.
pub(crate) fn pictures(arms: impl Fn(&SideView) -> Vec<ArmSeries>) -> Vec<Markup> {
    views("", "the robot as lines between the frames of its joints", "m", arms)
}

/// Both pictures of something, in a unit of length.
pub(crate) fn views(name: &str, what: &str, unit: &str, arms: impl Fn(&SideView) -> Vec<ArmSeries>) -> Vec<Markup> {
    let one = |view: &SideView| {
        let title =
            if name.is_empty() { view.title.to_owned() } else { format!("{name}, {}", view.title.to_lowercase()) };
        let plot = ArmPlot {
            description: format!("{title}: {what}"),
            title,
            x_title: format!("x of the base, {unit}"),
            y_title: format!("{}, {unit}", view.up),
            arms: arms(view),
        };
        PreEscaped(plot.svg())
    };
    VIEWS.iter().map(one).collect()
}

/// The calibrated robot in the middle of the sampled range; empty for a file without a valid robot.
pub(crate) fn draw_robot(file: &CalibrationFile) -> Vec<Markup> {
    let Ok(robot) = file.robot() else { return Vec::new() };
    let middle = |name: &String| {
        let joint = robot.joints.iter().find(|joint| joint.reading.name == *name)?;
        let sampled = file.coverage.iter().find(|it| it.joint == joint.name)?;
        Some(0.5 * (sampled.sampled_min + sampled.sampled_max))
    };
    let readings: Vec<f64> = robot.reading_names().iter().map(|name| middle(name).unwrap_or_default()).collect();
    let lines = skeleton(&robot, &readings);
    pictures(|view| {
        let ends = lines.iter().map(|line| view.project(&line[1])).collect();
        let lines = lines.iter().map(|[a, b]| [view.project(a), view.project(b)]).collect();
        vec![ArmSeries { name: "calibrated".to_owned(), style: 0, lines, points: ends, ..ArmSeries::default() }]
    })
}

//! Simulated measurements of the elbow, and the program's results for them.

use std::fmt::Write as _;

use poecal_model::simulate::{SessionKind, Simulation};
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::model::Model;

use crate::folder::Folder;

pub(crate) const ROBOT: &str = include_str!("../../../../examples/elbow/robot.urdf");

/// A folder with `robot.urdf` and `measurements.csv`: 60 rows with `id` and `stage` (1 in the first 40, then 2).
pub(crate) fn session(kind: SessionKind) -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    write_measurements(&folder, "measurements.csv", kind, "", &Simulation { count: 60, ..Simulation::default() });
    folder
}

/// Writes a simulated session; every row names `target`, if it is not empty. Sessions of one seed are of one robot and begin alike.
pub(crate) fn write_measurements(
    folder: &Folder,
    name: &str,
    kind: SessionKind,
    target: &str,
    simulation: &Simulation,
) {
    let model = Model::read(folder.path("robot.urdf"), &Default::default()).unwrap();
    let data = simulation.run(&model.robot, kind).unwrap().data;
    let mut text = format!("id,stage,target,{},x,y,z,qx,qy,qz,qw\n", data.reading_names().join(","));
    for (row, observation) in data.observations.iter().enumerate() {
        let stage = if row < 40 { 1 } else { 2 };
        write!(text, "row{row},{stage},{target}").unwrap();
        for reading in data.readings(row) {
            write!(text, ",{reading:?}").unwrap();
        }
        let pose = observation.measurement.pose();
        let [x, y, z]: [f64; 3] = pose.translation.into();
        write!(text, ",{x:?},{y:?},{z:?}").unwrap();
        if observation.measurement.sees_orientation() {
            for part in pose.quaternion_xyzw() {
                write!(text, ",{part:?}").unwrap();
            }
        } else {
            text.push_str(",,,,");
        }
        text.push('\n');
    }
    folder.write(name, text);
}

pub(crate) fn calibration(folder: &Folder, name: &str) -> CalibrationFile {
    CalibrationFile::read(folder.path(name).join("calibration.json")).unwrap()
}

/// Numbers of a predicted table, without the header and the first `skip` columns.
pub(crate) fn numbers(table: &str, skip: usize) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').skip(skip).map(|cell| cell.parse().unwrap()).collect();
    table.lines().skip(1).map(row).collect()
}

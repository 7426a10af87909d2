//! `residuals.csv`: what each measurement leaves, row by row.

mod read;

use std::fmt::Write as _;
use std::io::Write;

use super::numbers::push_number;
use crate::calibration::{Calibration, RowError, RowInfluence, row_errors};
use crate::estimate::Estimate;
use crate::measurement::Dataset;
use crate::robot::{JointKind, Robot};

/// Columns that every file begins with; a column for each joint reading follows.
const COLUMNS: &str = "file,line,id,set,target,position_nominal[mm],position_registered[mm],position_calibrated[mm],x[mm],y[mm],z[mm],\
     rotation_nominal[deg],rotation_registered[deg],rotation_calibrated[deg],rx[deg],ry[deg],rz[deg],\
     weight,leverage,studentized,suspected";

/// Bytes that are written at a time, about.
const PIECE: usize = 1 << 16;
/// Rows that are worked out at a time.
const TOGETHER: usize = 8192;

/// Errors of one row by the nominal, registered and calibrated model, and the calibrated model's residual (measured less predicted) by
/// component in the device's axes.
///
/// ```
/// let errors = poecal::io::residuals::ModelErrors { models: [11.2, 10.4, 0.1], residual: [0.1, 0.0, 0.0] };
/// assert_eq!(errors.models[2], errors.residual[0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelErrors {
    /// Of the nominal, registered and calibrated model.
    pub models: [f64; 3],
    /// By component.
    pub residual: [f64; 3],
}

/// What the fit says of a row.
///
/// ```
/// let found = poecal::io::residuals::Judged { weight: 1.0, leverage: 0.3, studentized: 1.6, suspected: false };
/// assert!(!found.suspected);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Its weight in the fit; of a row held out, what it would have had.
    pub weight: f64,
    /// Mean variance of its prediction in units of its noise.
    pub leverage: f64,
    /// Length of its residual in units of its own standard deviation.
    pub studentized: f64,
    /// Whether it is suspected to be grossly wrong.
    pub suspected: bool,
}

/// What one measurement leaves.
///
/// ```
/// use poecal::io::residuals::{ModelErrors, ResidualRow};
/// let position_mm = ModelErrors { models: [11.2, 10.4, 0.1], residual: [0.1, 0.0, 0.0] };
/// let row = ResidualRow { file: 0, line: 3, id: String::new(), held_out: true, target: 0, position_mm, rotation_deg: None, judged: None };
/// assert!(row.held_out);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualRow {
    /// Index of the file that it came from.
    pub file: usize,
    /// Its line there, from 1.
    pub line: u32,
    /// Its name; empty without one.
    pub id: String,
    /// Whether it was held out of the fit.
    pub held_out: bool,
    /// Index of the target that was seen.
    pub target: usize,
    /// Errors of position, millimetres.
    pub position_mm: ModelErrors,
    /// Errors of rotation, degrees, where orientation was measured.
    pub rotation_deg: Option<ModelErrors>,
    /// What the fit says of it.
    pub judged: Option<Judged>,
}

/// What all measurements leave, in the order read.
///
/// ```
/// use poecal::calibration::{CalibrationOptions, calibrate};
/// use poecal::io::residuals::Residuals;
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let made = Simulation::default().run(&elbow(), Kind::Point)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let residuals = Residuals::of(&made.data, &calibration);
/// let text = residuals.text();
/// assert_eq!(Residuals::parse(&text, "residuals.csv")?.text(), text);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals {
    /// The files that rows came from, as named by the user.
    pub files: Vec<String>,
    /// The targets' names; the tip's is empty.
    pub targets: Vec<String>,
    /// Names of the joint readings, and whether each is a length (millimetres) or an angle (degrees).
    pub readings: Vec<(String, JointKind)>,
    /// The rows.
    pub rows: Vec<ResidualRow>,
    /// The readings of all rows, one after the other, degrees or millimetres.
    values: Vec<f64>,
}

impl Residuals {
    /// Of a finished calibration.
    #[must_use]
    pub fn of(data: &Dataset, calibration: &Calibration) -> Self {
        let mut held_out = vec![false; data.len()];
        for &row in &calibration.held_out_rows {
            held_out[row as usize] = true;
        }
        let readings: Vec<(String, JointKind)> = data
            .reading_names()
            .iter()
            .map(|name| (name.clone(), kind(&calibration.nominal, name)))
            .collect();
        let values = (0..data.len())
            .flat_map(|row| data.readings(row).iter().zip(&readings))
            .map(|(&value, &(_, kind))| shown(kind, value))
            .collect();
        let models = &calibration.models;
        let influence = RowInfluence::new(calibration, data);
        let mut rows = Vec::with_capacity(data.len());
        for some in data.all_rows().chunks(TOGETHER) {
            let errors = |estimate: &Estimate| row_errors(data, influence.packed(), some, estimate);
            let [nominal, registered, calibrated] =
                [&models.nominal, &models.registered, &models.calibrated].map(errors);
            let influences = influence.of(some);
            for (at, &row) in some.iter().enumerate() {
                let observation = &data.observations[row as usize];
                let errors = [&nominal[at], &registered[at], &calibrated[at]];
                rows.push(ResidualRow {
                    file: observation.source.file as usize,
                    line: observation.source.line,
                    id: data.ids.get(row as usize).cloned().unwrap_or_default(),
                    held_out: held_out[row as usize],
                    target: observation.target,
                    position_mm: position_errors(errors),
                    rotation_deg: rotation_errors(errors),
                    judged: calibration.robustness.rows.get(row as usize).map(|found| Judged {
                        weight: found.weight,
                        leverage: influences[at].leverage,
                        studentized: influences[at].studentized,
                        suspected: found.suspected,
                    }),
                });
            }
        }
        Residuals {
            files: data.files.iter().map(|path| path.display().to_string()).collect(),
            targets: data.targets.iter().map(|name| name.clone().unwrap_or_default()).collect(),
            readings,
            rows,
            values,
        }
    }

    /// The readings of a row, degrees or millimetres.
    #[must_use]
    pub fn values(&self, row: usize) -> &[f64] {
        let n = self.readings.len();
        self.values.get(row * n..(row + 1) * n).unwrap_or_default()
    }

    /// The name of a row's file; empty if it came from none.
    #[must_use]
    pub fn file(&self, row: &ResidualRow) -> &str {
        self.files.get(row.file).map_or("", String::as_str)
    }

    /// The text of the file.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = Vec::with_capacity(self.rows.len() * 200);
        // Writing to memory cannot fail, and what is written is text.
        let _ = self.write_to(&mut out);
        String::from_utf8(out).unwrap_or_default()
    }

    /// Writes the text of the file piece by piece.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_to(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let mut text = String::with_capacity(PIECE + PIECE / 4);
        text.push_str(COLUMNS);
        for (name, kind) in &self.readings {
            text.push(',');
            text.push_str(&quoted(&format!("{name}[{}]", unit(*kind))));
        }
        text.push('\n');
        let files: Vec<_> = self.files.iter().map(|name| quoted(name)).collect();
        let targets: Vec<_> = self.targets.iter().map(|name| quoted(name)).collect();
        for (index, row) in self.rows.iter().enumerate() {
            text.push_str(files.get(row.file).map_or("", |name| name));
            let _ = write!(text, ",{},", row.line);
            text.push_str(&quoted(&row.id));
            text.push_str(if row.held_out { ",held_out," } else { ",fit," });
            text.push_str(targets.get(row.target).map_or("", |name| name));
            write_errors(&mut text, Some(&row.position_mm));
            write_errors(&mut text, row.rotation_deg.as_ref());
            match &row.judged {
                Some(Judged { weight, leverage, studentized, suspected }) => {
                    [*weight, *leverage, *studentized].into_iter().for_each(|number| cell(&mut text, number));
                    text.push_str(if *suspected { ",1" } else { ",0" });
                }
                None => text.push_str(",,,,"),
            }
            self.values(index).iter().for_each(|&value| cell(&mut text, value));
            text.push('\n');
            if text.len() >= PIECE {
                out.write_all(text.as_bytes())?;
                text.clear();
            }
        }
        out.write_all(text.as_bytes())
    }
}

/// What a reading measures, by the joint that it moves.
fn kind(robot: &Robot, reading: &str) -> JointKind {
    let joint = robot.joints.iter().find(|joint| joint.reading.name == reading);
    joint.map_or(JointKind::Revolute, |joint| joint.kind)
}

/// The unit of a column of readings.
fn unit(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "deg",
        JointKind::Prismatic => "mm",
    }
}

/// A reading in the unit of its column.
fn shown(kind: JointKind, value: f64) -> f64 {
    match kind {
        JointKind::Revolute => value.to_degrees(),
        JointKind::Prismatic => value * 1e3,
    }
}

fn position_errors(errors: [&RowError; 3]) -> ModelErrors {
    ModelErrors {
        models: errors.map(|error| error.position_m.norm() * 1e3),
        residual: (errors[2].position_m * 1e3).into(),
    }
}

fn rotation_errors(errors: [&RowError; 3]) -> Option<ModelErrors> {
    let residual = errors[2].rotation_rad?;
    let turn = |error: &RowError| error.rotation_rad.map_or(f64::NAN, |w| w.norm().to_degrees());
    Some(ModelErrors { models: errors.map(turn), residual: residual.map(f64::to_degrees).into() })
}

fn write_errors(out: &mut String, errors: Option<&ModelErrors>) {
    let Some(errors) = errors else {
        out.push_str(",,,,,,");
        return;
    };
    errors.models.iter().chain(&errors.residual).for_each(|&value| cell(out, value));
}

fn cell(out: &mut String, number: f64) {
    out.push(',');
    push_number(out, number);
}

/// A CSV cell, quoted where it must be.
pub(super) fn quoted(text: &str) -> std::borrow::Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\"")).into()
    } else {
        text.into()
    }
}

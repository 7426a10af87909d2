//! Readings of a controller, whose sums are the readings of the model.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{JointKind, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Relation of a controller's readings to those of the model, `reading = Σ factor · counted + offset`. An example is a third axis that counts
/// from the horizontal. It is kept in `calibration.json` if they are not equal one by one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Controller {
    /// Reference of the third axis, if it was stated; absent otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub third_axis: Option<ThirdAxis>,
    /// Readings of the model's joints, in their order.
    pub readings: Vec<ControllerReading>,
}

/// Composition of a reading of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ControllerReading {
    /// Name.
    pub reading: String,
    /// Columns of the measurement files that were summed; empty for a constant.
    pub columns: BTreeMap<String, ControllerColumn>,
    /// Offset, radians or metres.
    #[serde(default)]
    pub offset: f64,
}

/// A column of the controller's readings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ControllerColumn {
    /// Factor.
    pub factor: f64,
    /// Unit of its numbers in the measurement files.
    pub unit: String,
}

/// Reference of a third axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "ThirdAxisWord")]
pub enum ThirdAxis {
    /// The lower arm, as for joints of models.
    Arm,
    /// The horizontal: the second axis does not change it.
    Level,
}

impl ThirdAxis {
    /// Word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            ThirdAxis::Arm => "arm",
            ThirdAxis::Level => "level",
        }
    }
}

/// Cosine of the angle between two axes that count as parallel (25°).
const PARALLEL: f64 = 0.9;

/// Part of the second axis in a reading of the third that counts from the horizontal: the readings (their names) of both, and the factor
/// with which `third = counted - factor · second`. `None` if second and third axes are not parallel.
#[must_use]
pub fn level(robot: &Robot) -> Option<(String, String, f64)> {
    let own: Vec<_> = robot.joints.iter().filter(|joint| joint.give_of.is_none()).take(3).collect();
    let [first, second, third] = own[..] else { return None };
    let names = [first, second, third].map(|joint| joint.reading.name.as_str());
    let are_apart = names[0] != names[1] && names[1] != names[2] && names[0] != names[2];
    let turn = [first, second, third].iter().all(|joint| joint.kind == JointKind::Revolute);
    let along = second.screw.direction().dot(&third.screw.direction());
    if !are_apart || !turn || along.abs() < PARALLEL || third.reading.multiplier == 0.0 {
        return None;
    }
    let factor = along.signum() * second.reading.multiplier / third.reading.multiplier;
    Some((names[1].to_owned(), names[2].to_owned(), factor))
}

impl Controller {
    /// Relation for a controller that counts as the model does.
    #[must_use]
    pub fn from_robot(robot: &Robot) -> Self {
        let reading = |name: String| {
            let slides = robot.joints.iter().any(|it| it.reading.name == name && it.kind == JointKind::Prismatic);
            let unit = if slides { "m" } else { "rad" }.to_owned();
            let columns = BTreeMap::from([(name.clone(), ControllerColumn { factor: 1.0, unit })]);
            ControllerReading { reading: name, columns, offset: 0.0 }
        };
        let readings = robot.joint_reading_names().into_iter().map(reading).collect();
        Controller { third_axis: None, readings }
    }

    /// Checks that it is of a robot's readings, with meaningful numbers.
    ///
    /// # Errors
    /// [`ErrorKind::Model`].
    pub fn check(&self, robot: &Robot) -> Result<()> {
        let names: Vec<&str> = self.readings.iter().map(|it| it.reading.as_str()).collect();
        if names != robot.joint_reading_names() {
            return ErrorKind::Model.refuse(format!(
                "found the readings {} of the controller, expected those of the joints, {}",
                names.join(", "),
                robot.joint_reading_names().join(", ")
            ));
        }
        let is_sound = |it: &&ControllerReading| {
            it.offset.is_finite() && it.columns.values().all(|column| column.factor.is_normal())
        };
        match self.readings.iter().find(|it| !is_sound(it)) {
            None => Ok(()),
            Some(reading) => ErrorKind::Model.refuse(format!(
                "found a factor or an offset of the reading `{}` that is no number, expected factors other than 0",
                reading.reading
            )),
        }
    }

    /// The same with readings `sign · reading + zero`, radians and metres.
    pub fn turn_and_shift(&mut self, signs: &[f64], zeros: &[Option<f64>]) {
        for ((reading, sign), zero) in self.readings.iter_mut().zip(signs).zip(zeros) {
            reading.columns.values_mut().for_each(|column| column.factor *= sign);
            reading.offset = sign * reading.offset + zero.unwrap_or(0.0);
        }
    }

    /// True if each reading is one that the controller counts, of whatever name.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.readings.iter().all(ControllerReading::is_plain)
    }

    /// The same relation with this reference of the third axis.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] for a robot whose second and third axes are not parallel; as [`Controller::controller_map`].
    pub fn with_third_axis(mut self, robot: &Robot, counts: ThirdAxis) -> Result<Self> {
        let Some((second, third, factor)) = level(robot) else {
            return ErrorKind::Option.refuse(format!(
                "found a third axis that counts from the {}, expected a robot whose second and third axes are parallel",
                counts.word()
            ));
        };
        let own = self.axes()?;
        let Some(at) = self.readings.iter().position(|it| it.reading == third) else { return Ok(self) };
        let of_second = self.readings.iter().find(|it| it.reading == second).cloned();
        let (Some(reading), Some(name)) = (self.readings.get_mut(at), own.get(at)) else { return Ok(self) };
        reading.columns.retain(|column, _| column == name);
        if let (Some(ThirdAxis::Level), Some(of_second)) = (self.third_axis, &of_second) {
            reading.offset += factor * of_second.offset;
        }
        if let (ThirdAxis::Level, Some(of_second)) = (counts, of_second) {
            for (column, it) in of_second.columns {
                let unit = it.unit;
                let added = reading.columns.entry(column).or_insert(ControllerColumn { factor: 0.0, unit });
                added.factor -= factor * it.factor;
            }
            reading.columns.retain(|_, it| it.factor != 0.0);
            reading.offset -= factor * of_second.offset;
        }
        self.third_axis = Some(counts);
        Ok(self)
    }

    /// For each reading, the column that the controller counts for this axis: readings and columns are paired one by one, where only one
    /// remains.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if they cannot be paired.
    pub fn axes(&self) -> Result<Vec<String>> {
        let mut pairs = self.pairs()?;
        pairs.sort_unstable();
        Ok(pairs.into_iter().map(|(_, column)| column.to_owned()).collect())
    }

    /// Readings with their columns, in an order in which each has one column that those before have not.
    fn pairs(&self) -> Result<Vec<(usize, &str)>> {
        let mut pairs: Vec<(usize, &str)> = Vec::with_capacity(self.readings.len());
        while pairs.len() < self.readings.len() {
            let only_new = |(at, reading): (usize, &'_ ControllerReading)| {
                let is_new = |column: &&String| pairs.iter().all(|(_, known)| known != column);
                let mut left = reading.columns.keys().filter(is_new);
                let is_open = pairs.iter().all(|(known, _)| *known != at);
                left.next().filter(|_| is_open && left.next().is_none()).map(|column| (at, column.clone()))
            };
            let Some((at, column)) = self.readings.iter().enumerate().find_map(only_new) else {
                return Err(self.not_apart());
            };
            let own = self.readings.get(at).and_then(|reading| reading.columns.get_key_value(&column));
            pairs.extend(own.map(|(column, _)| (at, column.as_str())));
        }
        Ok(pairs)
    }

    fn not_apart(&self) -> Error {
        let sums: Vec<String> =
            self.readings.iter().filter(|it| !it.is_plain()).map(ControllerReading::words).collect();
        ErrorKind::Option.error(format!(
            "the readings are made of columns ({}) that cannot be taken apart again, expected a column of its own in each: correct by a calibration \
             whose mapping has one",
            sums.join("; ")
        ))
    }

    /// Transformation from counted readings to those of the model, and its inverse.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if the sums cannot be separated again.
    pub fn controller_map(&self) -> Result<ControllerMap> {
        let (names, pairs) = (self.axes()?, self.pairs()?);
        let count = names.len();
        let forward = DMatrix::from_fn(count, count, |row, column| {
            self.readings[row].columns.get(&names[column]).map_or(0.0, |it| it.factor)
        });
        let offsets = DVector::from_iterator(count, self.readings.iter().map(|it| it.offset));
        // In the order of the pairs each reading has one unknown.
        let mut back = DMatrix::zeros(count, count);
        for &(at, _) in &pairs {
            for reading in 0..count {
                let known: f64 =
                    (0..count).filter(|&it| it != at).map(|it| forward[(at, it)] * back[(it, reading)]).sum();
                let is_own = if reading == at { 1.0 } else { 0.0 };
                back[(at, reading)] = (is_own - known) / forward[(at, at)];
            }
        }
        Ok(ControllerMap { names, forward, offsets, back })
    }

    /// Sums in words; empty if each reading is counted by itself.
    #[must_use]
    pub fn words(&self) -> String {
        let sums = self.readings.iter().filter(|it| !it.is_plain()).map(ControllerReading::words);
        sums.collect::<Vec<_>>().join(", ")
    }
}

/// A sum of columns, each with its factor, in words.
pub fn sum_words<'a>(columns: impl Iterator<Item = (&'a str, f64)>) -> String {
    let mut words = String::new();
    for (column, factor) in columns {
        let sign = match (factor < 0.0, words.is_empty()) {
            (true, true) => "- ",
            (true, false) => " - ",
            (false, true) => "",
            (false, false) => " + ",
        };
        let size = if factor.abs() == 1.0 { String::new() } else { format!("{} ", factor.abs()) };
        words.push_str(&format!("{sign}{size}{column}"));
    }
    words
}

impl ControllerReading {
    fn is_plain(&self) -> bool {
        self.offset == 0.0 && self.columns.len() == 1 && self.columns.values().all(|it| it.factor == 1.0)
    }

    fn words(&self) -> String {
        let columns = self.columns.iter().map(|(column, it)| (column.as_str(), it.factor));
        let mut words = format!("{} = {}", self.reading, sum_words(columns)).trim_end().to_owned();
        if self.offset != 0.0 || self.columns.is_empty() {
            words.push_str(&format!(" {} {:.6}", if self.offset < 0.0 { "-" } else { "+" }, self.offset.abs()));
        }
        words
    }
}

/// Transformation of counted readings to those of the model: `r = A·c + b`.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerMap {
    names: Vec<String>,
    forward: DMatrix<f64>,
    offsets: DVector<f64>,
    back: DMatrix<f64>,
}

impl ControllerMap {
    /// Names of the counted readings, in the order of the model's axes.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// `A`, by rows.
    #[must_use]
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.forward
    }

    /// `A⁻¹`, by rows.
    #[must_use]
    pub fn inverse(&self) -> &DMatrix<f64> {
        &self.back
    }

    /// `b`, radians and metres.
    #[must_use]
    pub fn offsets(&self) -> &DVector<f64> {
        &self.offsets
    }

    /// The model's readings for counted ones (rad, m).
    #[must_use]
    pub fn readings(&self, counted: &[f64]) -> Vec<f64> {
        let row = |(row, offset): (usize, &f64)| {
            counted.iter().take(self.names.len()).enumerate().map(|(at, it)| self.forward[(row, at)] * it).sum::<f64>()
                + offset
        };
        self.offsets.iter().enumerate().map(row).collect()
    }

    /// Counted readings at the model's readings (rad, m).
    #[must_use]
    pub fn controller_readings(&self, readings: &[f64]) -> Vec<f64> {
        let from: Vec<f64> = readings.iter().zip(self.offsets.iter()).map(|(it, offset)| it - offset).collect();
        self.change(&from)
    }

    /// Counted readings after a change of those of the model.
    #[must_use]
    pub fn moved_readings(&self, counted: &[f64], from: &[f64], to: &[f64]) -> Vec<f64> {
        let change: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        counted.iter().zip(self.change(&change)).map(|(it, change)| it + change).collect()
    }

    /// Change of counted readings by a change of those of the model; zero if these do not change.
    #[must_use]
    pub fn change(&self, of_readings: &[f64]) -> Vec<f64> {
        let count = self.names.len();
        let row =
            |row: usize| of_readings.iter().take(count).enumerate().map(|(at, it)| self.back[(row, at)] * it).sum();
        (0..count).map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;

    /// A reading, its columns with factors, and its offset.
    type Row = (&'static str, &'static [(&'static str, f64)], f64);

    fn controller_from_rows(rows: &[Row]) -> Controller {
        let column = |(name, factor): &(&str, f64)| {
            ((*name).to_owned(), ControllerColumn { factor: *factor, unit: "deg".to_owned() })
        };
        let reading = |(name, columns, offset): &Row| ControllerReading {
            reading: (*name).to_owned(),
            columns: columns.iter().map(column).collect(),
            offset: *offset,
        };
        Controller { third_axis: None, readings: rows.iter().map(reading).collect() }
    }

    #[test]
    fn sums_signs_factors_and_zeros_go_and_come_back() {
        let all = controller_from_rows(&[
            ("a", &[("J1", -1.0)], 0.5),
            ("b", &[("J2", 2.0), ("J3", 1.0)], 0.0),
            ("c", &[("J3", 1.0)], -0.25),
        ]);
        let counting = all.controller_map().unwrap();
        assert_eq!(counting.names(), ["J1", "J2", "J3"]);
        assert_eq!(counting.readings(&[0.1, 0.2, 0.3]), [0.4, 0.7, 0.3 - 0.25]);
        for (found, wanted) in counting.controller_readings(&[0.4, 0.7, 0.05]).iter().zip([0.1, 0.2, 0.3]) {
            assert!((found - wanted).abs() < 1e-15);
        }
        assert_eq!(counting.change(&[0.0, 0.0, 1.0]), [0.0, -0.5, 1.0]);
        assert_eq!(all.words(), "a = - J1 + 0.500000, b = 2 J2 + J3, c = J3 - 0.250000");
    }

    #[test]
    fn what_is_of_another_robot_or_no_number_is_refused() {
        let robot = elbow();
        let plain = Controller::from_robot(&robot);
        assert!(plain.check(&robot).is_ok());
        let mut short = plain.clone();
        short.readings.pop();
        assert!(short.check(&robot).unwrap_err().to_string().contains("expected those of the joints"));
        for factor in [0.0, f64::NAN, f64::INFINITY] {
            let mut wrong = plain.clone();
            wrong.readings[2].columns.values_mut().for_each(|it| it.factor = factor);
            assert!(wrong.check(&robot).unwrap_err().to_string().contains("expected factors other than 0"));
        }
    }

    #[test]
    fn what_cannot_be_taken_apart_is_refused() {
        for readings in [
            controller_from_rows(&[("a", &[("J1", 1.0), ("J2", 1.0)], 0.0), ("b", &[("J1", 1.0), ("J2", -1.0)], 0.0)]),
            controller_from_rows(&[("a", &[("J1", 1.0)], 0.0), ("b", &[("J1", 1.0)], 0.0)]),
            controller_from_rows(&[("a", &[], 0.3)]),
        ] {
            let error = readings.controller_map().unwrap_err().to_string();
            assert!(error.contains("cannot be taken apart again"), "{error}");
        }
    }

    #[test]
    fn a_third_axis_from_the_level_turns_with_the_second() {
        let robot = elbow();
        let (second, third, factor) = level(&robot).unwrap();
        let level = Controller::from_robot(&robot).with_third_axis(&robot, ThirdAxis::Level).unwrap();
        let counting = level.controller_map().unwrap();
        let at = |name: &str| robot.joint_reading_names().iter().position(|it| it == name).unwrap();
        let mut counted = vec![0.0; 6];
        counted[at(&second)] = 0.3;
        let readings = counting.readings(&counted);
        assert_eq!(readings[at(&third)], -factor * 0.3);
        // The forearm keeps its direction.
        let flat = robot.forward_kinematics(&[0.0; 6]).rotation;
        assert!((robot.forward_kinematics(&readings).rotation - flat).norm() < 1e-12);
        let again = level.with_third_axis(&robot, ThirdAxis::Arm).unwrap();
        assert!(again.is_plain());
        // The second and the third may start elsewhere; stated twice, the result is the same.
        let mut shifted = Controller::from_robot(&robot);
        for reading in &mut shifted.readings {
            reading.offset = if reading.reading == second { 0.2 } else { 0.0 };
        }
        let level = shifted.clone().with_third_axis(&robot, ThirdAxis::Level).unwrap();
        assert_eq!(level.readings[at(&third)].offset, -factor * 0.2);
        assert_eq!(level.clone().with_third_axis(&robot, ThirdAxis::Level).unwrap(), level);
        let back = level.with_third_axis(&robot, ThirdAxis::Arm).unwrap();
        assert_eq!(back.readings, shifted.readings);
    }
}

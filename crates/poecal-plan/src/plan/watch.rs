//! Rows judged as they arrive, before they are fitted; the present expected error, and the next configuration (docs/theory.md, *While measuring*).

use super::running_fit::RunningFit;
use super::watched_row::{Mistake, WatchOptions, WatchedRow};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};

/// Rows that are tested together for a moved target.
const TOGETHER: usize = 3;
/// Number of components, beyond the unknowns of the targets, from which rows can be judged.
const FEWEST_NUMBERS: usize = 6;

/// A watched session, row after row.
pub struct Watch {
    robot: Robot,
    options: WatchOptions,
    /// Expected rows, which are fitted.
    good: Vec<u32>,
    known: Option<RunningFit>,
    /// Scales and degrees of freedom after each fitted row.
    history: Vec<(f64, f64)>,
    last: Option<u32>,
}

impl Watch {
    /// A session of a robot without measurements yet.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] for kinds of measurement other than points and poses of a device.
    pub fn new(robot: &Robot, options: WatchOptions) -> Result<Self> {
        if !options.fit.session.kind.has_device() {
            return ErrorKind::Option.refuse(format!(
                "found the kind `{}`, expected points or poses, of which rows can be judged as they arrive",
                options.fit.session.kind.word()
            ));
        }
        Ok(Watch { robot: robot.clone(), options, good: Vec::new(), known: None, history: Vec::new(), last: None })
    }

    /// Judges a row of the data, in the order of their arrival, and fits it if it is as expected.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`] if the robot has more unknowns than one fit allows.
    pub fn add(&mut self, data: &Dataset, row: usize) -> Result<WatchedRow> {
        let index = u32::try_from(row).unwrap_or(u32::MAX);
        let before = self.last.replace(index);
        let mut found =
            WatchedRow { row, mistake: None, ratio: None, noticed_m: None, now: None, after: None, next: None };
        if before.is_some_and(|before| is_repeated(data, before as usize, row)) {
            found.mistake = Some(Mistake::Repeats);
            return Ok(found);
        }
        let is_new = self.known.as_ref().is_some_and(|known| known.names != [data.targets.len(), data.station_count()]);
        if is_new {
            self.known = None;
        }
        if let Some(known) = &self.known {
            let judged = known.judge(data, index);
            found.ratio = Some(judged.ratio);
            found.noticed_m = Some(judged.noticed_m);
            if judged.ratio > 1.0 {
                found.mistake = Some(known.mistake(data, index, before, judged.off_m));
            }
        }
        if found.mistake.is_none() {
            self.good.push(index);
            self.fit(data)?;
            found.mistake = self.find_moved_target(data);
        }
        if let Some(known) = &mut self.known {
            known.foresee(&mut found);
        }
        Ok(found)
    }

    /// Fits the good rows.
    fn fit(&mut self, data: &Dataset) -> Result<()> {
        let own = data.select_rows(&self.good);
        if let Some(known) = &mut self.known {
            known.fit(&own);
        } else {
            let numbers: usize = own.observations.iter().map(|row| row.measurement.dim()).sum();
            if numbers < FEWEST_NUMBERS + 3 * data.targets.len().max(1) + 3 {
                return Ok(());
            }
            self.known = Some(RunningFit::new(&self.robot, &self.options, &own)?);
        }
        if let Some(known) = &self.known {
            self.history.push((known.scale, known.freedom));
        }
        Ok(())
    }

    /// Tests whether the last rows share a moved target.
    fn find_moved_target(&mut self, data: &Dataset) -> Option<Mistake> {
        let known = self.known.as_ref()?;
        let before = *self.history.len().checked_sub(TOGETHER + 1).and_then(|at| self.history.get(at))?;
        let target = data.observations.get(*self.good.last()? as usize)?.target;
        let of_target = |row: &&u32| data.observations.get(**row as usize).is_some_and(|it| it.target == target);
        let last: Vec<u32> = self.good.iter().rev().filter(of_target).take(TOGETHER).copied().collect();
        if last.len() < TOGETHER {
            return None;
        }
        let off_m = known.shift(data, &self.good, &last, target, before)?;
        let ago = self.good.iter().filter(|row| last.iter().min().is_some_and(|first| *row >= first)).count();
        self.good.retain(|row| !last.contains(row));
        let own = data.select_rows(&self.good);
        if let Some(known) = &mut self.known {
            known.fit(&own);
        }
        Some(Mistake::Moved(off_m, ago))
    }
}

/// True if two rows have the same readings, target and numbers.
fn is_repeated(data: &Dataset, before: usize, row: usize) -> bool {
    let (Some(a), Some(b)) = (data.observations.get(before), data.observations.get(row)) else {
        return false;
    };
    a.target == b.target
        && a.station == b.station
        && a.measurement == b.measurement
        && data.readings(before) == data.readings(row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::PlannedFit;
    use poecal_model::measurement::Measurement;
    use poecal_model::simulate::{SessionKind, Simulation, elbow};

    /// Rows of a simulated session of points, one with an error of 5 mm, one with the wrong sign of joint 5, one stale.
    #[test]
    fn mistakes_are_named_as_they_arrive() {
        let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POINT).unwrap();
        let mut data = made.data.select_rows(&[]);
        for row in 0..made.data.len() {
            let mut readings = made.data.readings(row).to_vec();
            let mut observation = made.data.observations[row];
            match row {
                20 => {
                    let at = observation.measurement.position().unwrap();
                    observation.measurement = Measurement::point(at + nalgebra::Vector3::new(0.0, 5e-3, 0.0));
                }
                25 => readings[4] = -readings[4],
                30 => observation = made.data.observations[row - 1],
                _ => {}
            }
            data.push_observation(&readings, observation).unwrap();
        }
        let fit = PlannedFit {
            robot_error: Some(crate::plan::RobotError { calibrated_m: 5e-5, corrected_m: None }),
            ..PlannedFit::default()
        };
        let mut watch = Watch::new(&elbow(), WatchOptions { fit, seed: 1, ..WatchOptions::default() }).unwrap();
        let mut named = Vec::new();
        for row in 0..data.len() {
            let found = watch.add(&data, row).unwrap();
            if let Some(mistake) = found.mistake {
                println!("{row}: {mistake:?}, {:.1} mm would be noticed", 1e3 * found.noticed_m.unwrap());
                named.push((row, mistake));
            }
        }
        let rows: Vec<usize> = named.iter().map(|it| it.0).collect();
        assert_eq!(rows, [20, 25, 30], "{named:?}");
        assert!(matches!(named[0].1, Mistake::Off(_) | Mistake::Joint(..)));
        assert_eq!(named[1].1, Mistake::Sign("joint5".to_owned()));
        assert_eq!(named[2].1, Mistake::Stale);
    }
}

//! Noise of instruments that depends on the distance, as it is typed.

use std::str::FromStr;

use nalgebra::Vector3;

use super::{Dataset, Measurement, NoiseShape, Quantity};
use poecal_numerics::error::{Error, ErrorKind, Result, first_few};
use poecal_numerics::named_unit::positive_length_m;

/// Noise of an instrument that looks along a line of sight, such as `tracker:10um+5um/m`. It is 10 µm in all directions, and across the line of
/// sight 5 µm more for each metre of distance (added as squares). Angular encoders and air cause the latter. Without a name it is that of all
/// instruments.
#[derive(Clone, Debug, PartialEq)]
pub struct InstrumentNoise {
    name: Option<String>,
    /// Standard deviation in all directions, metres.
    everywhere_m: f64,
    /// Standard deviation across the line of sight, for each metre of distance.
    per_metre: f64,
}

impl FromStr for InstrumentNoise {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let (name, noise) = text.rsplit_once(':').map_or((None, text), |(name, rest)| (Some(name), rest));
        let (everywhere, per_metre) = noise.split_once('+').map_or((noise, None), |(a, b)| (a, Some(b)));
        let per_metre = match per_metre {
            Some(part) => metres(part.trim().strip_suffix("/m").ok_or_else(|| bad(text))?, text)?,
            None => 0.0,
        };
        let name = name.map(|name| name.trim().to_owned());
        if name.as_ref().is_some_and(String::is_empty) {
            return Err(bad(text));
        }
        Ok(InstrumentNoise { name, everywhere_m: metres(everywhere, text)?, per_metre })
    }
}

/// A length above 0, with its unit.
fn metres(text: &str, whole: &str) -> Result<f64> {
    positive_length_m(text)?.ok_or_else(|| bad(whole))
}

fn bad(text: &str) -> Error {
    ErrorKind::Option.error(format!(
        "found `{text}` as the noise of an instrument, expected a standard deviation in all directions and one across the line of sight for \
         each metre, like tracker:10um+5um/m"
    ))
}

impl InstrumentNoise {
    /// States the noise of the rows of its instrument that state none.
    pub fn state(&self, data: &mut Dataset) -> Result<()> {
        let station = match &self.name {
            None => None,
            Some(name) => match data.stations.iter().position(|it| it.as_ref() == Some(name)) {
                Some(station) => Some(station),
                None => return Err(self.unknown(name, data)),
            },
        };
        for row in 0..data.len() {
            let observation = &data.observations[row];
            let is_own = station.is_none_or(|station| station == observation.station);
            // A pair measures a step between two configurations, which has no line of sight.
            if !is_own || observation.from.is_some() || observation.stated.get(Quantity::Position).is_some() {
                continue;
            }
            let measurement = &observation.measurement;
            if measurement.is_part_of_position() {
                return Err(incomplete_error(data, row, measurement));
            }
            let Some(place) = measurement.position() else { continue };
            let distance = place.norm();
            let across = self.everywhere_m.hypot(self.per_metre * distance);
            let sight = place.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector3::z);
            data.state_noise(row, NoiseShape::from_sight(&sight, self.everywhere_m, across));
        }
        Ok(())
    }

    fn unknown(&self, name: &str, data: &Dataset) -> Error {
        let named: Vec<&str> = data.stations.iter().flatten().map(String::as_str).collect();
        let expected = match named.as_slice() {
            [] => "no name, since no row names its instrument".to_owned(),
            _ => format!("one of {}", first_few(&named)),
        };
        ErrorKind::Option.error(format!("found noise of the instrument `{name}`, expected {expected}"))
    }
}

/// Error of a row without a whole position, whose distance is not known.
fn incomplete_error(data: &Dataset, row: usize, seen: &Measurement) -> Error {
    let missing = ["x", "y", "z"].into_iter().zip(seen.position_components()).find(|(_, value)| value.is_none());
    let message = format!(
        "found an empty cell in `{}` beside noise that depends on the distance, expected a whole position: state the noise of such rows in \
         columns sigma_x, sigma_y, sigma_z",
        missing.map_or("x", |(name, _)| name)
    );
    let source = data.observations[row].source;
    let error = ErrorKind::Measurement.error(message);
    match data.files.get(source.file as usize) {
        Some(path) => error.at_line(path, source.line as usize),
        None => error,
    }
}

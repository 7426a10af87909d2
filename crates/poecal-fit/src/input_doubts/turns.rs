//! Orientations in degrees that are read as radians.

use std::f64::consts::TAU;

use super::{DoubtLocation, InputDoubt, SHARE};

/// Rounding allowed beyond a full turn, radians.
const ROUNDING: f64 = 1e-3;

/// Collects the angles of orientations in radians.
#[derive(Clone, Debug, Default)]
pub struct TurnWatch {
    rows: usize,
    beyond: usize,
    largest: f64,
    first: Option<FirstLargeAngle>,
}

/// The first orientation with too large an angle.
#[derive(Clone, Debug)]
struct FirstLargeAngle {
    place: DoubtLocation,
    columns: Vec<String>,
    is_vector: bool,
    most: f64,
}

impl TurnWatch {
    /// Adds an orientation: a rotation vector, or three angles, radians. `place` and names are those of its columns.
    pub fn observe(&mut self, values: [f64; 3], is_vector: bool, place: impl FnOnce() -> (DoubtLocation, Vec<String>)) {
        self.rows += 1;
        // Angles that count on over many turns are in no other unit.
        let (size, most) = if is_vector {
            (values.iter().map(|value| value * value).sum::<f64>().sqrt(), TAU + ROUNDING)
        } else {
            (values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs())), 2.0 * TAU)
        };
        if size <= most {
            return;
        }
        self.beyond += 1;
        self.largest = self.largest.max(size);
        self.first.get_or_insert_with(|| {
            let (place, columns) = place();
            FirstLargeAngle { place, columns, is_vector, most }
        });
    }

    /// Doubt if only degrees explain the angles.
    #[must_use]
    pub fn doubt(&self) -> Option<InputDoubt> {
        let first = self.first.as_ref()?;
        // Degrees of one or two turns; larger angles are neither.
        if (self.beyond as f64) < SHARE * self.rows as f64 || self.largest > (2.0 * TAU).to_degrees() {
            return None;
        }
        let what = if first.is_vector { "rotation vectors as long as" } else { "angles of an orientation up to" };
        let degrees: Vec<String> = first.columns.iter().map(|name| format!("`{name}[deg]`")).collect();
        let message = format!(
            "found {what} {:.1} rad in the columns {} ({} of {} rows are beyond {:.1} rad), expected radians: the unit is likely deg, \
             which the header states as {} and a mapping as `unit = \"deg\"`",
            self.largest,
            first.columns.join(", "),
            self.beyond,
            self.rows,
            first.most,
            degrees.join(", ")
        );
        Some(InputDoubt::new(first.place, message))
    }
}

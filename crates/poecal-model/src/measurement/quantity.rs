//! Measured quantities, and values of each of them.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::{Index, IndexMut};

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use poecal_numerics::unit::Unit;

/// Key of a quantity: its name, and the unit of files.
macro_rules! key {
    ($name:literal, Metre) => {
        concat!($name, "_mm")
    };
    ($name:literal, Radian) => {
        concat!($name, "_deg")
    };
}

/// Makes an enum of quantities from their table, a line for each: name, unit, names of its components, and the meaning of its residuals.
macro_rules! quantities {
    ($(#[$attribute:meta])* pub enum $Quantity:ident {
        $($(#[$doc:meta])* $variant:ident = ($name:literal, $unit:ident, [$($component:literal),+], $residuals:literal),)+
    }) => {
        $(#[$attribute])*
        pub enum $Quantity {
            $($(#[$doc])* $variant,)+
        }

        impl $Quantity {
            /// All quantities, in the order of every table.
            pub const ALL: [$Quantity; [$($name),+].len()] = [$($Quantity::$variant),+];

            /// Properties of a quantity: the only place that distinguishes quantities.
            const fn entry(self) -> QuantityRow {
                match self {
                    $($Quantity::$variant => QuantityRow {
                        name: $name,
                        key: key!($name, $unit),
                        unit: Unit::$unit,
                        components: &[$($component),+],
                        residuals: $residuals,
                    },)+
                }
            }
        }
    };
}

quantities! {
/// A measured quantity. Noise, scales and accuracies are of each quantity apart; a measurement type has one or two of them. A quantity that
/// is added to this table has its place in files, reports and the Python package.
///
/// ```
/// use poecal_model::measurement::Quantity;
/// use poecal_numerics::unit::Unit;
/// assert_eq!((Quantity::Rotation.name(), Quantity::Rotation.unit()), ("rotation", Unit::Radian));
/// assert_eq!((Quantity::Position.key(), Quantity::Position.component_names()), ("position_mm", &["x", "y", "z"][..]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Position of a target.
    Position = ("position", Metre, ["x", "y", "z"], "of positions along these axes"),
    /// Orientation of a target.
    Rotation = ("rotation", Radian, ["rx", "ry", "rz"], "of rotations about these axes"),
    /// Distance of a target from the instrument.
    Distance = ("distance", Metre, ["distance"], "of distances, above zero where more was measured"),
    /// Position of a ball from the middle of its socket.
    Contact = (
        "contact",
        Metre,
        ["contact_x", "contact_y", "contact_z"],
        "of contacts along three orthogonal axes, from the ball to the centre of its socket"
    ),
    /// Height of a target over a plane.
    Height = ("height", Metre, ["height"], "of heights, above zero where more was measured than predicted"),
    /// Tilts of a face against a plane, or of a target against a direction such as gravity's.
    Tilt = ("tilt", Radian, ["tilt_x", "tilt_y"], "of tilts about the target's own x and y"),
}
}

/// Properties of a quantity.
struct QuantityRow {
    name: &'static str,
    key: &'static str,
    unit: Unit,
    components: &'static [&'static str],
    residuals: &'static str,
}

// A quantity with more components does not compile.
const _: () = {
    let mut k = 0;
    while k < Quantity::ALL.len() {
        assert!(Quantity::ALL[k].entry().components.len() <= Quantity::MOST_COMPONENTS);
        k += 1;
    }
};

impl Quantity {
    /// Largest number of components of a quantity.
    pub const MOST_COMPONENTS: usize = 3;

    /// Name.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// Name with the unit of files: a key of `calibration.json`.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.entry().key
    }

    /// Names of the components of a measurement of it: columns of files.
    #[must_use]
    pub fn component_names(self) -> &'static [&'static str] {
        self.entry().components
    }

    /// Number of components of its measurement, at most [`Quantity::MOST_COMPONENTS`].
    #[must_use]
    pub fn components(self) -> usize {
        self.component_names().len()
    }

    /// Meaning of its residuals, in words.
    #[must_use]
    pub fn residual_words(self) -> &'static str {
        self.entry().residuals
    }

    /// Unit.
    #[must_use]
    pub fn unit(self) -> Unit {
        self.entry().unit
    }

    /// True if it is a part of a pose. Files have a place for these also if they were not measured.
    #[must_use]
    pub fn is_of_pose(self) -> bool {
        [Quantity::Position, Quantity::Rotation].contains(&self)
    }
}

/// A value for each quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ByQuantity<T>([T; Quantity::ALL.len()]);

impl<T> ByQuantity<T> {
    /// These values, in the order of [`Quantity::ALL`].
    pub(crate) const fn of_values(values: [T; Quantity::ALL.len()]) -> Self {
        ByQuantity(values)
    }

    /// Value that `of` returns for each quantity.
    #[inline]
    pub fn from_fn(mut of: impl FnMut(Quantity) -> T) -> Self {
        // Unlike `map`, this is inlined.
        ByQuantity(std::array::from_fn(|k| of(Quantity::ALL[k])))
    }

    /// Value that `to` returns for each value.
    #[inline]
    pub fn map<U>(self, to: impl FnMut(T) -> U) -> ByQuantity<U> {
        ByQuantity(self.0.map(to))
    }

    /// The same values with another one of one quantity.
    #[must_use]
    pub fn with_value(mut self, quantity: Quantity, value: T) -> Self {
        self[quantity] = value;
        self
    }

    /// The quantities with their values.
    pub fn iter(&self) -> impl Iterator<Item = (Quantity, &T)> + Clone {
        Quantity::ALL.into_iter().zip(&self.0)
    }

    /// Values, mutable.
    pub fn values_mut(&mut self) -> impl Iterator<Item = (Quantity, &mut T)> {
        Quantity::ALL.into_iter().zip(&mut self.0)
    }
}

impl<T> Index<Quantity> for ByQuantity<T> {
    type Output = T;

    fn index(&self, quantity: Quantity) -> &T {
        &self.0[quantity as usize]
    }
}

impl<T> IndexMut<Quantity> for ByQuantity<T> {
    fn index_mut(&mut self, quantity: Quantity) -> &mut T {
        &mut self.0[quantity as usize]
    }
}

/// Standard deviation of each component of each quantity, metres or radians, with which residuals are whitened: theory.md §4 (17).
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::{Noise, Quantity};
/// # }
/// use poecal::{Noise, Quantity};
/// let noise = Noise::new(5e-5, 1e-4);
/// assert_eq!((noise[Quantity::Position], noise[Quantity::Rotation]), (5e-5, 1e-4));
/// ```
pub type Noise = ByQuantity<f64>;

impl Noise {
    /// One standard deviation for all lengths (metres), one for all angles (radians).
    #[must_use]
    pub const fn new(length_m: f64, angle_rad: f64) -> Self {
        let mut values = [0.0; Quantity::ALL.len()];
        let mut k = 0;
        while k < values.len() {
            values[k] = match Quantity::ALL[k].entry().unit {
                Unit::Metre => length_m,
                Unit::Radian | Unit::One | Unit::Second => angle_rad,
            };
            k += 1;
        }
        ByQuantity(values)
    }

    /// Standard deviation of lengths, metres: that of a position.
    pub fn of_lengths(self) -> f64 {
        self[Quantity::Position]
    }

    /// The same noise with another value for all lengths.
    pub fn without_lengths(self, length_m: f64) -> Self {
        ByQuantity::from_fn(|quantity| match quantity.unit() {
            Unit::Metre => length_m,
            Unit::Radian | Unit::One | Unit::Second => self[quantity],
        })
    }
}

/// A positive number for each quantity for which it is stated. It is kept for every row, and therefore small.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "ByQuantity<Option<f64>>", into = "ByQuantity<Option<f64>>")]
pub struct StatedDeviations {
    /// Zero if nothing is stated.
    values: ByQuantity<f64>,
}

impl StatedDeviations {
    /// The number of a quantity.
    #[must_use]
    #[inline]
    pub fn get(&self, quantity: Quantity) -> Option<f64> {
        Some(self.values[quantity]).filter(|value| *value != 0.0)
    }

    /// States the number of a quantity; zero is none.
    pub fn set(&mut self, quantity: Quantity, value: Option<f64>) {
        self.values[quantity] = value.unwrap_or(0.0);
    }
}

impl Default for StatedDeviations {
    /// Nothing stated.
    fn default() -> Self {
        StatedDeviations { values: ByQuantity([0.0; Quantity::ALL.len()]) }
    }
}

impl From<ByQuantity<Option<f64>>> for StatedDeviations {
    fn from(values: ByQuantity<Option<f64>>) -> Self {
        StatedDeviations { values: values.map(|value| value.unwrap_or(0.0)) }
    }
}

impl From<StatedDeviations> for ByQuantity<Option<f64>> {
    fn from(stated: StatedDeviations) -> Self {
        ByQuantity::from_fn(|quantity| stated.get(quantity))
    }
}

/// A value for each quantity that was measured. In files it is an object with the keys of [`Quantity::key`]; a rotation that was not
/// measured is null.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::{MeasuredQuantities, Quantity};
/// # }
/// use poecal::{MeasuredQuantities, Quantity};
/// let largest = MeasuredQuantities::from_fn(|quantity| (quantity == Quantity::Position).then_some(0.25));
/// assert_eq!((largest.position_mm(), largest.rotation_deg()), (0.25, None));
/// assert_eq!(serde_json::to_string(&largest).unwrap(), r#"{"position_mm":0.25,"rotation_deg":null}"#);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuredQuantities<T>(ByQuantity<Option<T>>);

impl<T: Copy> MeasuredQuantities<T> {
    /// Value that `of` returns for each quantity.
    pub fn from_fn(of: impl FnMut(Quantity) -> Option<T>) -> Self {
        MeasuredQuantities(ByQuantity::from_fn(of))
    }

    /// The value of a quantity, if it was measured.
    #[must_use]
    pub fn get(&self, quantity: Quantity) -> Option<T> {
        self.0[quantity]
    }

    /// The measured quantities with their values.
    pub fn iter(&self) -> impl Iterator<Item = (Quantity, T)> {
        self.0.iter().filter_map(|(quantity, value)| Some((quantity, (*value)?)))
    }

    /// Value that `to` returns for each value.
    pub fn map<U: Copy>(self, mut to: impl FnMut(Quantity, T) -> U) -> MeasuredQuantities<U> {
        MeasuredQuantities::from_fn(|quantity| self.get(quantity).map(|value| to(quantity, value)))
    }

    /// First measured quantity, lengths before angles: that by which a model is judged.
    #[must_use]
    pub fn leading_value(&self) -> Option<(Quantity, T)> {
        self.iter().find(|(quantity, _)| quantity.unit() == Unit::Metre).or_else(|| self.iter().next())
    }

    /// The value of the rotation, degrees, if orientation was measured.
    #[must_use]
    pub fn rotation_deg(&self) -> Option<T> {
        self.get(Quantity::Rotation)
    }
}

impl<T: Copy + Default> MeasuredQuantities<T> {
    /// The value of the position, millimetres; the default if no position was measured.
    #[must_use]
    pub fn position_mm(&self) -> T {
        self.get(Quantity::Position).unwrap_or_default()
    }

    /// The value of the leading quantity; the default if nothing was measured.
    #[must_use]
    pub fn lead(&self) -> T {
        self.leading_value().map(|(_, value)| value).unwrap_or_default()
    }
}

impl<T: Serialize> Serialize for MeasuredQuantities<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let is_written = |quantity, value: &Option<T>| value.is_some() || quantity == Quantity::Rotation;
        serializer.collect_map(
            self.0.iter().filter(|(quantity, value)| is_written(*quantity, value)).map(|(it, value)| (it.key(), value)),
        )
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for MeasuredQuantities<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut values: BTreeMap<String, Option<T>> = BTreeMap::deserialize(deserializer)?;
        let found = MeasuredQuantities(ByQuantity::from_fn(|quantity| values.remove(quantity.key()).flatten()));
        if found.0.iter().all(|(_, value)| value.is_none()) {
            return Err(D::Error::custom("missing field `position_mm`"));
        }
        Ok(found)
    }
}

impl<T: JsonSchema> JsonSchema for MeasuredQuantities<T> {
    fn schema_name() -> Cow<'static, str> {
        format!("MeasuredOf{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut properties = serde_json::Map::new();
        for quantity in Quantity::ALL {
            let of = if quantity == Quantity::Rotation {
                generator.subschema_for::<Option<T>>()
            } else {
                generator.subschema_for::<T>()
            };
            properties.insert(quantity.key().to_owned(), of.to_value());
        }
        schemars::json_schema!({
            "type": "object",
            "description": "Of each quantity that was measured; null of a rotation that was not.",
            "properties": properties,
        })
    }
}

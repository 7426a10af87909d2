//! Numbers of each quantity with a key of their own beside other keys: `sigma_position_mm`, `sigma_rotation_deg`, and so on for every
//! quantity that was measured.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Deref;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Error as _, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use poecal_model::measurement::{ByQuantity, Measured, Quantity};
use poecal_numerics::unit::Unit;

/// How the keys of a number of each quantity are made.
pub trait Keys {
    /// What the number is, for the schema: `{name}` is the quantity, `{unit}` its unit.
    const WORDS: &'static str;
    /// Quantities whose key every file has.
    const ALWAYS: &'static [Quantity] = &[];
    /// Quantities whose key is null without a number; the key of others is then left out.
    const NULL: &'static [Quantity] = &[];
    /// When it is null.
    const NULL_WORDS: &'static str = "null where none was measured";
    /// Whether a file has one of them at least.
    const IS_NEEDED: bool = true;

    /// The key of a quantity.
    fn key(quantity: Quantity) -> String;
}

/// A number of each measured quantity, whose keys stand beside others. It is read as [`Measured`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyed<K, T = f64> {
    values: Measured<T>,
    keys: PhantomData<K>,
}

impl<K, T> From<Measured<T>> for Keyed<K, T> {
    fn from(values: Measured<T>) -> Self {
        Keyed { values, keys: PhantomData }
    }
}

impl<K, T> Deref for Keyed<K, T> {
    type Target = Measured<T>;

    fn deref(&self) -> &Measured<T> {
        &self.values
    }
}

impl<K: Keys, T: Copy> Keyed<K, T> {
    /// The key of a quantity, and its number if it was measured.
    #[must_use]
    pub fn named(&self, quantity: Quantity) -> (String, Option<T>) {
        (K::key(quantity), self.values.get(quantity))
    }

    /// The measured quantities with their keys and numbers.
    pub fn keys(&self) -> impl Iterator<Item = (Quantity, String, T)> {
        self.values.iter().map(|(quantity, value)| (quantity, K::key(quantity), value))
    }

    /// The first measured quantity, lengths before angles, with its key and number.
    #[must_use]
    pub fn leading_key(&self) -> Option<(Quantity, String, T)> {
        self.values.leading().map(|(quantity, value)| (quantity, K::key(quantity), value))
    }
}

impl<K: Keys, T: Copy + Serialize> Serialize for Keyed<K, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let numbers = Quantity::ALL.into_iter().map(|quantity| (quantity, self.values.get(quantity)));
        let written = numbers.filter(|(quantity, value)| value.is_some() || K::NULL.contains(quantity));
        serializer.collect_map(written.map(|(quantity, value)| (K::key(quantity), value)))
    }
}

impl<'de, K: Keys, T: Copy + Deserialize<'de>> Deserialize<'de> for Keyed<K, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let found = deserializer.deserialize_map(KeyedVisitor::<K, T>(PhantomData))?;
        let missing = K::ALWAYS.iter().find(|quantity| found.get(**quantity).is_none());
        let none = Quantity::ALL.first().filter(|_| K::IS_NEEDED && found.leading().is_none());
        match missing.or(none) {
            Some(quantity) => Err(D::Error::custom(format_args!("missing field `{}`", K::key(*quantity)))),
            None => Ok(found),
        }
    }
}

/// Takes its own keys out of an object.
struct KeyedVisitor<K, T>(PhantomData<(K, T)>);

impl<'de, K: Keys, T: Copy + Deserialize<'de>> Visitor<'de> for KeyedVisitor<K, T> {
    type Value = Keyed<K, T>;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let keys = ByQuantity::from_fn(K::key);
        let mut values: ByQuantity<Option<T>> = ByQuantity::default();
        while let Some(key) = map.next_key::<String>()? {
            match keys.iter().find(|(_, own)| **own == key) {
                Some((quantity, _)) => values[quantity] = map.next_value()?,
                None => {
                    let _: IgnoredAny = map.next_value()?;
                }
            }
        }
        Ok(Measured::of(|quantity| values[quantity]).into())
    }
}

impl<K: Keys, T: JsonSchema> JsonSchema for Keyed<K, T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        let first = Quantity::ALL.first().map(|first| K::key(*first)).unwrap_or_default();
        format!("KeyedBy_{first}").into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut properties = serde_json::Map::new();
        for quantity in Quantity::ALL {
            let is_null = K::NULL.contains(&quantity);
            let mut of =
                if is_null { generator.subschema_for::<Option<T>>() } else { generator.subschema_for::<T>() };
            let unit = match quantity.unit() {
                Unit::Metre => "millimetres",
                Unit::Radian => "degrees",
                Unit::One | Unit::Second => "without unit",
            };
            let words = K::WORDS.replace("{name}", quantity.name()).replace("{unit}", unit);
            let null = if is_null { format!("; {}", K::NULL_WORDS) } else { String::new() };
            of.insert("description".to_owned(), format!("{words}{null}.").into());
            properties.insert(K::key(quantity), of.to_value());
        }
        let always: Vec<String> = K::ALWAYS.iter().map(|quantity| K::key(*quantity)).collect();
        schemars::json_schema!({ "type": "object", "properties": properties, "required": always })
    }
}

/// Numbers in the unit of files from those in metres or radians.
pub(crate) fn shown<K: Keys>(mut si: impl FnMut(Quantity) -> Option<f64>) -> Keyed<K> {
    Measured::of(|quantity| si(quantity).map(|number| quantity.unit().shown(number))).into()
}

/// Makes kinds of keys: what differs from the usual, and the key of a quantity.
macro_rules! keys {
    ($(
        $(#[$doc:meta])*
        $name:ident { $(const $constant:ident: $type:ty = $value:expr;)+ |$quantity:ident| $key:expr }
    )+) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub struct $name;

            impl Keys for $name {
                $(const $constant: $type = $value;)+

                fn key($quantity: Quantity) -> String {
                    $key
                }
            }
        )+
    };
}

/// Parts of a pose, and those of them that files state to be missing.
const OF_POSES: &[Quantity] = &[Quantity::Position, Quantity::Rotation];
const TURNS: &[Quantity] = &[Quantity::Rotation];

keys! {
    /// `sigma_position_mm`.
    SigmaKeys {
        const WORDS: &'static str = "Standard deviation of each component of {name}, {unit}";
        const NULL: &'static [Quantity] = TURNS;
        |it| format!("sigma_{}", it.key())
    }
    /// `position_rms_mm`.
    RmsKeys {
        const WORDS: &'static str = "Root mean square error of {name}, {unit}";
        const NULL: &'static [Quantity] = TURNS;
        |it| format!("{}_rms_{}", it.name(), it.unit().symbol())
    }
    /// `residual_mm` of positions, `residual_deg` of rotations, `residual_distance_mm` and so on.
    ResidualKeys {
        const WORDS: &'static str = "Distance or angle from the {name} that the calibrated model predicts, {unit}";
        const NULL: &'static [Quantity] = TURNS;
        |it| beside("residual", it)
    }
    /// `discrepancy_position_mm`.
    DiscrepancyKeys {
        const WORDS: &'static str = "Model error: standard deviation of each component of {name}, {unit}";
        const ALWAYS: &'static [Quantity] = OF_POSES;
        |it| format!("discrepancy_{}", it.key())
    }
    /// `noise_position_mm`.
    NoiseKeys {
        const WORDS: &'static str =
            "Measurement noise in the residuals: standard deviation of each component of {name}, {unit}";
        const IS_NEEDED: bool = false;
        |it| format!("noise_{}", it.key())
    }
    /// `residuals_position`.
    AttributionKeys {
        const WORDS: &'static str = "Whether the residuals of {name} count as the robot's or the instrument's";
        const IS_NEEDED: bool = false;
        |it| format!("residuals_{}", it.name())
    }
    /// `freedom_position`.
    FreedomKeys {
        const WORDS: &'static str = "Degrees of freedom of the residuals' variance, of {name}";
        const NULL: &'static [Quantity] = OF_POSES;
        const NULL_WORDS: &'static str = "null where their noise is stated";
        const IS_NEEDED: bool = false;
        |it| format!("freedom_{}", it.name())
    }
    /// `accuracy_nominal_mm` of positions, `accuracy_nominal_distance_mm` and so on.
    NominalKeys {
        const WORDS: &'static str =
            "Pose accuracy of the nominal model: from its prediction to the mean of the measured {name}, {unit}";
        |it| beside("accuracy_nominal", it)
    }
    /// `accuracy_registered_mm`.
    RegisteredKeys {
        const WORDS: &'static str = "The same of the registered model, {unit}";
        |it| beside("accuracy_registered", it)
    }
    /// `accuracy_calibrated_mm`.
    CalibratedKeys {
        const WORDS: &'static str = "The same of the calibrated model, {unit}";
        |it| beside("accuracy_calibrated", it)
    }
    /// `repeatability_mm`.
    RepeatabilityKeys {
        const WORDS: &'static str =
            "Repeatability: mean distance of the measured {name} from its mean, plus three standard deviations, {unit}";
        |it| beside("repeatability", it)
    }
    /// `worst_repeatability_mm`.
    WorstKeys {
        const WORDS: &'static str = "The largest repeatability of {name}, {unit}";
        |it| beside("worst_repeatability", it)
    }
}

/// A key that says the unit alone of a part of a pose, and the name too of other quantities.
fn beside(word: &str, quantity: Quantity) -> String {
    if quantity.is_of_pose() {
        format!("{word}_{}", quantity.unit().symbol())
    } else {
        format!("{word}_{}", quantity.key())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_that_was_not_measured_is_null() {
        let sigma = Measured::of(|quantity| (quantity == Quantity::Position).then_some(0.05));
        let sigma: Keyed<SigmaKeys> = sigma.into();
        let text = serde_json::to_string(&sigma).unwrap();
        assert_eq!(text, r#"{"sigma_position_mm":0.05,"sigma_rotation_deg":null}"#);
        assert_eq!(serde_json::from_str::<Keyed<SigmaKeys>>(&text).unwrap(), sigma);
    }
}

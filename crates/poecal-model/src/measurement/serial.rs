//! Measurements as serialised values: the name of the function, and its numbers.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::functions::find_by_name;
use super::{MeasuredValues, Measurement};

impl Serialize for Measurement {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.function().name, self.values()).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Measurement {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (name, values): (String, MeasuredValues) = Deserialize::deserialize(deserializer)?;
        let function = find_by_name(&name).ok_or_else(|| D::Error::custom(format!("unknown function `{name}`")))?;
        Ok(Measurement::new(function, &values))
    }
}

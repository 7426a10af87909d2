//! Columns by their names, and the mapping that states them.

pub(crate) mod builder;
pub(crate) mod column_meanings;
pub(crate) mod column_names;
pub(crate) mod column_spec;
pub(crate) mod controller_counts;
mod makers_columns;
pub(crate) mod mapping;
pub(crate) mod mapping_values;
pub(crate) mod motors;
pub(crate) mod targets;
pub(crate) mod turns;

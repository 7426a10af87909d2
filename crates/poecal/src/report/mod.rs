//! Results as text for people. No number here that is not in the result.

mod table;

pub use table::{accuracy_table, summary};

//! `residuals.csv`: residuals and diagnostics of each measurement.

mod read;
mod rows;
mod source;
mod text;
mod write;

pub use rows::{ModelErrors, ResidualRow, Residuals, RowDiagnostics, columns};
pub use write::ResidualRows;

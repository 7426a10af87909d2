//! `residuals.csv`: residuals and diagnostics of each measurement.

mod read;
mod rows;
mod source;
mod text;
mod write;

pub use rows::{CornerErrors, ModelErrors, ResidualRow, Residuals, RowDiagnostics, columns, corner_columns};
pub use write::ResidualRows;

//! A line of robots: paths of their measurements and results, and the ledger of their calibrations.

mod another;
mod inbox;
mod ledger;
mod row;
mod station;

pub use another::{doubled, exchanged};
pub use inbox::{Found, newest};
pub use ledger::{LEDGER, Ledger, read_ledgers};
pub use row::{CorrectionRow, InputRow, LedgerRow, SizeRow, TermRow};
pub use station::Station;

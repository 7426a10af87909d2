//! A line of robots: where their measurements lie and their results go, and the ledger of what was done.

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

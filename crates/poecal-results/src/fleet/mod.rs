//! A line of robots: paths of their measurements and results, and the ledger of their calibrations.

mod inbox;
mod ledger;
mod mistaken_identity;
mod row;
mod station;

pub use inbox::{InboxFile, list_files};
pub use ledger::{LEDGER, Ledger, read_ledgers};
pub use mistaken_identity::{find_doubled_files, find_exchanged_robot};
pub use row::{CorrectionRow, GroupEffect, InputRow, LedgerRow, SizeRow};
pub use station::Station;

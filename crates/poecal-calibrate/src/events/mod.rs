//! Events during a session: a moved device or target, a slipped zero of a joint, or configurations that are wrong as a whole. A repaired session is
//! the session as it would have been without them (theory.md §9, *Events*).

mod event_reports;
mod hypotheses;
mod limits;
mod names;
mod repair;
mod repaired_session;
mod rows;
mod search;
mod search_outcome;
mod unsettled_readings;
mod wrong_configurations;

pub use event_reports::{Event, EventKind, Repairs};
pub use limits::{RepairLimit, RepairLimits};
pub use names::family;
pub(crate) use repair::{Events, repair};

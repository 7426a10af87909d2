//! Events during a session: a moved device or target, a slipped zero of a joint, or configurations that are wrong as a whole. A repaired session is
//! the session as it would have been without them (theory.md §9, *Events*).

mod early;
mod happened;
mod hypotheses;
mod limits;
mod names;
mod repair;
mod repaired;
mod rows;
mod search;
mod told;
mod wrong;

pub use limits::{RepairLimit, RepairLimits};
pub use names::family;
pub(crate) use repair::{Events, repair};
pub use told::{Event, EventKind, Repairs};

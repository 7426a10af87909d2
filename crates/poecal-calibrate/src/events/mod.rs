//! What happened during a session: a device or a target that was moved, a joint's zero that slipped, configurations that are wrong as a
//! whole; and the session as it would have been without (theory.md §9, *Events*).

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

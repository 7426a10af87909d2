//! Limits that errors shall keep, from their options.

use poecal::Result;
use poecal::calibration::{AcceptanceLimits, AcceptedModel, Limit};

/// The limits, if there are any.
pub(super) fn limits(limits: &[Limit], model: AcceptedModel) -> Result<Option<AcceptanceLimits>> {
    if limits.is_empty() { Ok(None) } else { AcceptanceLimits::new(limits.to_vec(), model).map(Some) }
}

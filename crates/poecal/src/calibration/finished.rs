//! A finished fit, as input of what is said of it.

use super::Models;
use crate::problem::Layout;
use crate::solve::Normal;
use crate::uncertainty::{Remainder, View};

/// A finished fit.
pub(super) struct Finished<'a> {
    pub(super) view: View<'a>,
    pub(super) layout: &'a Layout,
    pub(super) normal: &'a Normal,
    pub(super) remainder: &'a Remainder,
    pub(super) models: &'a Models,
    pub(super) seed: u64,
}

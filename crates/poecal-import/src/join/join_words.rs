//! Messages on pairs.

use poecal_fit::start::RowOrder;
pub(crate) use poecal_fit::start::{mm, number_lines, numbered_as};
use poecal_numerics::error::first_few;

/// Message on lags at which measurements fit equally well, the best first.
pub(crate) fn several_lags(listed: &[String], best_s: f64) -> String {
    format!(
        "found measurements that fit the joint readings at several lags of the clocks alike, {}, as of a program that repeats itself, expected one: state it by --lag, like --lag {best_s:.1}s+-0.5s",
        first_few(listed)
    )
}

/// Configurations in words.
pub(crate) fn count_configurations(configurations: usize) -> String {
    if configurations == 1 { "one configuration".to_owned() } else { format!("{configurations} configurations") }
}

/// An order in words.
pub(crate) fn words(order: RowOrder) -> String {
    let rows = |by: usize| if by == 1 { "one row".to_owned() } else { format!("{by} rows") };
    match order {
        RowOrder::MeasuredLater(by) => format!("with the measurements {} later", rows(by)),
        RowOrder::JointsLater(by) => format!("with the joint readings {} later", rows(by)),
        RowOrder::Reversed => "in reverse order".to_owned(),
    }
}

/// Remedy if an order fits better.
pub(crate) fn advice(order: RowOrder) -> String {
    let rows = |by: usize| if by == 1 { "the first row".to_owned() } else { format!("the first {by} rows") };
    match order {
        RowOrder::MeasuredLater(by) => format!("remove {} of the joint readings", rows(by)),
        RowOrder::JointsLater(by) => format!("remove {} of the measurements", rows(by)),
        RowOrder::Reversed => "turn one of the files round".to_owned(),
    }
}

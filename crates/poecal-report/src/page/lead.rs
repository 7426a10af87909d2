//! The one error that is reported of each row, and words for quantities.

use poecal_model::measurement::{Measured, Quantity, measuring};
use poecal_numerics::unit::Unit;
use poecal_results::residuals::{ModelErrors, ResidualRow, Residuals};

/// Reported error of each row: that of the first quantity that it measured in one unit, of lengths if any row measured one. It is the position error
/// of poses and points.
pub(crate) struct Lead {
    quantities: Vec<Quantity>,
    unit: Unit,
}

impl Lead {
    pub(crate) fn from_residuals(residuals: &Residuals) -> Self {
        let unit = residuals.leading().map_or(Unit::Metre, Quantity::unit);
        let leads = |it: &Quantity| {
            residuals.kinds().iter().any(|(kind, _)| leading(kind, unit).is_some_and(|(own, ())| own == *it))
        };
        let quantities = residuals.measured().into_iter().filter(leads).collect();
        Lead { quantities, unit }
    }

    fn found(&self, row: &ResidualRow) -> Option<(Quantity, ModelErrors)> {
        leading(&row.errors, self.unit)
    }

    /// The error of the delivered model in a row.
    pub(crate) fn error(&self, row: &ResidualRow) -> Option<f64> {
        self.found(row).map(|(_, errors)| errors.delivered())
    }

    /// The error of the model with tool and device located alone.
    pub(crate) fn registered(&self, row: &ResidualRow) -> Option<f64> {
        self.found(row).map(|(_, errors)| errors.models[1])
    }

    /// Name of the quantity: `position`.
    pub(crate) fn name(&self) -> String {
        let names: Vec<&str> = self.quantities.iter().map(|quantity| quantity.name()).collect();
        if names.is_empty() { Quantity::Position.name().to_owned() } else { names.join(" or ") }
    }

    pub(crate) fn unit(&self) -> &'static str {
        sign(self.unit)
    }
}

/// The first quantity of a unit.
fn leading<T: Copy>(measured: &Measured<T>, unit: Unit) -> Option<(Quantity, T)> {
    measured.iter().find(|(quantity, _)| quantity.unit() == unit)
}

/// A unit as the page writes it.
pub(crate) fn sign(unit: Unit) -> &'static str {
    match unit {
        Unit::Metre => "mm",
        Unit::Radian => "°",
        Unit::One | Unit::Second => "",
    }
}

/// A unit behind a number.
pub(crate) fn spaced(unit: Unit) -> &'static str {
    match unit {
        Unit::Metre => " mm",
        Unit::Radian => "°",
        Unit::One | Unit::Second => "",
    }
}

/// A component as the page names it: `position x`, `contact x`, or the name of a quantity that is one number.
pub(crate) fn component_words(quantity: Quantity, component: usize) -> String {
    let own = quantity.component_names().get(component).copied().unwrap_or_default();
    let own = own.rsplit('_').next().unwrap_or_default();
    if quantity.components() == 1 { quantity.name().to_owned() } else { format!("{} {own}", quantity.name()) }
}

/// Numbers of rows by their measured quantities: poses, points, distances and so on.
pub(crate) fn kinds_words(residuals: &Residuals) -> String {
    let of = |(kind, count): &(Measured<()>, usize)| {
        (kind.iter().map(|(quantity, ())| quantity).collect(), *count)
    };
    let mut kinds: Vec<(Vec<Quantity>, usize)> = residuals.kinds().iter().map(of).collect();
    // Poses precede points, these precede others.
    kinds.sort_by_key(|(kind, _)| (!kind.iter().all(|it| it.is_of_pose()), std::cmp::Reverse(kind.len())));
    let words = kinds.iter().map(|(kind, count)| match measuring(kind) {
        Some(function) => format!("{count} {}", function.plural),
        None => {
            let names: Vec<String> = kind.iter().map(|quantity| quantity.name().to_owned()).collect();
            format!("{count} rows of {}", listed(&names))
        }
    });
    listed(&words.collect::<Vec<_>>())
}

/// `a, b and c`.
fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

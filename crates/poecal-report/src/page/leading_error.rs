//! The one error that is reported of each row, and words for quantities.

use poecal_model::measurement::{MeasuredQuantities, Quantity, find_by_quantities};
use poecal_numerics::unit::Unit;
use poecal_results::residuals::{ModelErrors, ResidualRow, Residuals};

/// Reported error of each row: that of the first quantity that it measured in one unit, of lengths if any row measured one. It is the position error
/// of poses and points.
pub(crate) struct LeadingError {
    quantities: Vec<Quantity>,
    unit: Unit,
}

impl LeadingError {
    pub(crate) fn from_residuals(residuals: &Residuals) -> Self {
        let unit = residuals.leading_quantity().map_or(Unit::Metre, Quantity::unit);
        let leads = |it: &Quantity| {
            residuals.kinds().iter().any(|(kind, _)| leading_value(kind, unit).is_some_and(|(own, ())| own == *it))
        };
        let quantities = residuals.measured_quantities().into_iter().filter(leads).collect();
        LeadingError { quantities, unit }
    }

    fn leading_errors(&self, row: &ResidualRow) -> Option<(Quantity, ModelErrors)> {
        leading_value(&row.errors, self.unit)
    }

    /// The error of the delivered model in a row.
    pub(crate) fn error(&self, row: &ResidualRow) -> Option<f64> {
        self.leading_errors(row).map(|(_, errors)| errors.delivered_error())
    }

    /// The error of the model with tool and device located alone.
    pub(crate) fn registered_error(&self, row: &ResidualRow) -> Option<f64> {
        self.leading_errors(row).map(|(_, errors)| errors.models[1])
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
fn leading_value<T: Copy>(measured: &MeasuredQuantities<T>, unit: Unit) -> Option<(Quantity, T)> {
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
pub(crate) fn spaced_unit(unit: Unit) -> &'static str {
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
    let of = |(kind, count): &(MeasuredQuantities<()>, usize)| {
        (kind.iter().map(|(quantity, ())| quantity).collect(), *count)
    };
    let mut kinds: Vec<(Vec<Quantity>, usize)> = residuals.kinds().iter().map(of).collect();
    // Poses precede points, these precede others.
    kinds.sort_by_key(|(kind, _)| (!kind.iter().all(|it| it.is_of_pose()), std::cmp::Reverse(kind.len())));
    let words = kinds.iter().map(|(kind, count)| match find_by_quantities(kind) {
        Some(function) => format!("{count} {}", function.plural),
        None => {
            let names: Vec<String> = kind.iter().map(|quantity| quantity.name().to_owned()).collect();
            format!("{count} rows of {}", list_words(&names))
        }
    });
    list_words(&words.collect::<Vec<_>>())
}

/// `a, b and c`.
fn list_words(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

//! Rows of a list: the purpose of each, and those that return to the first.

/// Interval of rows after which the first configuration is measured again.
pub const RETURN_EVERY: usize = 20;

/// Purpose of a planned row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowPurpose {
    /// The row is fitted.
    Fit,
    /// The row is held out, to judge the fit.
    Judge,
}

impl RowPurpose {
    /// Word in the column `set`.
    #[must_use]
    pub fn set(self) -> &'static str {
        match self {
            RowPurpose::Fit => "fit",
            RowPurpose::Judge => "held_out",
        }
    }
}

/// A row of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedRow {
    /// Readings in the order of [`Robot::reading_names`](poecal_model::robot::Robot::reading_names), radians and metres.
    pub readings: Vec<f64>,
    /// Purpose of the row.
    pub part: RowPurpose,
    /// True if it is the first configuration again.
    pub returns: bool,
    /// Index of the candidate of the list from which it was chosen.
    pub candidate: Option<usize>,
}

impl PlannedRow {
    /// Rows of a list by their readings, one after the other, and by their purposes; rows with the readings of an earlier one return to it.
    #[must_use]
    pub fn of_list(readings: &[f64], width: usize, parts: &[RowPurpose]) -> Vec<PlannedRow> {
        let mut rows: Vec<PlannedRow> = Vec::new();
        for (own, &part) in readings.chunks_exact(width.max(1)).zip(parts) {
            let returns = rows.iter().any(|row| row.readings == own);
            rows.push(PlannedRow { readings: own.to_vec(), part, returns, candidate: None });
        }
        rows
    }
}

/// Number of rows of a list of `rows` that return to the first: every twentieth.
#[must_use]
pub fn returns_of(rows: usize) -> usize {
    rows / RETURN_EVERY
}

/// The rows with the first one inserted again at each interval.
pub(crate) fn with_returns(rows: Vec<PlannedRow>) -> Vec<PlannedRow> {
    let Some(first) = rows.first().cloned() else { return rows };
    let again = PlannedRow { returns: true, candidate: None, ..first };
    let mut found = Vec::new();
    for (at, row) in rows.into_iter().enumerate() {
        found.push(row);
        if (at + 1) % (RETURN_EVERY - 1) == 0 {
            found.push(again.clone());
        }
    }
    found
}

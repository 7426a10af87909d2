//! Columns with the names of a maker: X, Y, Z beside its angles.

use super::super::cells::{Separator, split};
use super::super::conventions::{CONVENTIONS, OrientationConvention};
use super::builder::Builder;
use poecal_numerics::unit::Unit;

impl Builder<'_> {
    /// True if the position is in columns X, Y, Z, in capital letters.
    pub(super) fn has_large_axes(&self) -> bool {
        !["x", "y", "z"].iter().any(|name| self.has(name)) && ["X", "Y", "Z"].iter().all(|name| self.has(name))
    }

    /// The convention of a maker whose columns the header has beside its X, Y, Z, and these columns. All have units or none, and numbers in the
    /// first row.
    /// first row.
    pub(super) fn convention(&self) -> Option<(&'static OrientationConvention, Vec<String>)> {
        let has_mapped_position = self.map.position.is_some();
        let first: Vec<Option<f64>> = self.first_numbers().filter(|_| self.has_large_axes() && !has_mapped_position)?;
        let is_stated = |at: usize, quantity| Some(self.header.unit(at, quantity, "").ok()?.is_some());
        let is_placed = is_stated(self.header.find("X").ok()??, Unit::Metre)?;
        CONVENTIONS.iter().filter(|it| it.is_unique()).find_map(|it| {
            let quantity = it.form.quantity();
            let at = it.columns.iter().map(|name| self.makers_column(name)).collect::<Option<Vec<usize>>>()?;
            let are_stated = at.iter().map(|at| is_stated(*at, quantity)).collect::<Option<Vec<bool>>>()?;
            let numbers = at.iter().map(|at| *first.get(*at)?).collect::<Option<Vec<f64>>>()?;
            let is_alike = quantity == Unit::One || are_stated.iter().all(|it| *it == is_placed);
            let is_known = is_placed || self.header.units_line.is_none();
            (is_alike && is_known && it.form.rotation(&numbers).is_ok()).then(|| {
                (it, at.iter().filter_map(|at| self.header.cells.get(*at)).map(|cell| cell.name.clone()).collect())
            })
        })
    }

    /// The unused column of a maker: letters in the maker's case, except those of quaternions, which are unique.
    fn makers_column(&self, name: &str) -> Option<usize> {
        let letter = name.strip_suffix(|it: char| it.is_ascii_digit());
        let is_it = |text: &str| text == name || letter.is_some() && text.eq_ignore_ascii_case(name);
        // Joints may be named q1 to q6.
        let numbers = letter.map(|letter| {
            let of = |text: &str| text.to_lowercase().strip_prefix(letter).is_some_and(|it| it.parse::<u32>().is_ok());
            self.header.cells.iter().filter(|cell| of(&cell.name)).count()
        });
        let mut cells = self.header.cells.iter().enumerate();
        let (at, cell) = cells.find(|(at, cell)| is_it(&cell.name) && !self.is_used(*at))?;
        (!self.readings.contains(&cell.name) && numbers.is_none_or(|it| it == 4)).then_some(at)
    }

    /// The numbers of the first row.
    fn first_numbers(&self) -> Option<Vec<Option<f64>>> {
        let row = self.header.first_row()?;
        let mut cells = Vec::new();
        split(&row, Separator::recognise(&row), &mut cells).ok()?;
        Some(cells.iter().map(|cell| cell.raw.replace(',', ".").parse().ok()).collect())
    }
}

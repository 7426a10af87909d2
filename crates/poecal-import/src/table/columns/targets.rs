//! Finds the columns of the measurements.

use std::collections::BTreeMap;

use super::super::conventions::OrientationConvention;
use super::super::inputs::{InputSource, SumTerm};
use super::super::kinds::{self, FunctionKind, KindColumns};
use super::super::orientation::OrientationForm;
use super::builder::Builder;
use super::column_spec::ColumnSpec;
use super::mapping::{OrientationSpec, PositionSpec, TargetSpec};
use poecal_numerics::error::{ErrorKind, MissingColumn, Result};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::unit::Unit;

/// Beginning of columns of expanded uncertainties (95 %), in place of `sigma_`, and their coverage factor.
const EXPANDED: &str = "U95_";

const COVERAGE_FACTOR: f64 = 2.0;

/// One target of a row; numbers are indices into [`Builder::inputs`].
#[derive(Clone, Debug)]
pub(crate) struct TargetLayout {
    pub(crate) name: Option<String>,
    /// Columns of the position; `None` in a file of other kinds of measurements.
    pub(crate) position: Option<[usize; 3]>,
    pub(crate) orientation: Option<(OrientationForm, Vec<usize>)>,
    /// The convention of the orientation's columns, if these have the names of a maker.
    pub(crate) convention: Option<&'static OrientationConvention>,
    pub(crate) sigma_position: Option<usize>,
    /// Standard deviation of each component.
    pub(crate) sigma_components: [Option<usize>; 3],
    pub(crate) sigma_rotation: Option<usize>,
    /// Other kinds of measurements.
    pub(crate) kinds: Vec<KindColumns>,
}

impl Builder<'_> {
    /// The targets of a row: those of the mapping, or the only one.
    pub(crate) fn targets(&mut self) -> Result<Vec<TargetLayout>> {
        let map = self.map;
        if !map.targets.is_empty() {
            return map.targets.iter().map(|target| self.target(target, false)).collect();
        }
        let only = TargetSpec {
            name: String::new(),
            position: map.position.clone().unwrap_or_default(),
            orientation: map.orientation.clone(),
            sigma_position: map.sigma_position.clone(),
            sigma_rotation: map.sigma_rotation.clone(),
        };
        Ok(vec![TargetLayout { name: map.target_name.clone(), ..self.target(&only, true)? }])
    }

    /// One target of a row; the columns of the only one may have our names.
    fn target(&mut self, target: &TargetSpec, is_only: bool) -> Result<TargetLayout> {
        let prefix = if is_only { String::new() } else { format!("{} ", target.name) };
        let kinds = if is_only { self.kinds()? } else { Vec::new() };
        let is_named = target.position.columns.is_some()
            || ["x", "y", "z"].iter().any(|name| self.has(name))
            || self.has_large_axes();
        let is_placed = kinds.is_empty() || is_named;
        let by_names = is_placed && is_only && target.orientation.is_none();
        let own_form = if by_names { self.own_form()? } else { None };
        let convention = if by_names && own_form.is_none() { self.convention() } else { None };
        let usual = |quantity| convention.as_ref().and_then(|it| it.0.usual_unit(quantity));
        let position =
            if is_placed { Some(self.position(&prefix, &target.position, usual(Unit::Metre))?) } else { None };
        let orientation = match (&target.orientation, own_form, &convention) {
            (Some(spec), ..) => Some(self.mapped_orientation(&prefix, spec)?),
            (None, Some(form), _) => Some(self.orientation(form, form.part_names(), None)?),
            (None, None, Some((it, columns))) => {
                let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
                Some(self.orientation(it.form, &columns, usual(it.form.quantity()))?)
            }
            (None, None, None) => None,
        };
        let mut sigma = |name: &str, spec: Option<&ColumnSpec>, quantity| {
            let unstated = self.makers_unit(usual(quantity));
            self.sigma(&format!("{prefix}{name}"), spec, (quantity, unstated), is_only && position.is_some())
        };
        let sigma_position = sigma("sigma_position", target.sigma_position.as_ref(), Unit::Metre)?;
        let sigma_rotation = sigma("sigma_rotation", target.sigma_rotation.as_ref(), Unit::Radian)?;
        let mut sigma_components = [None; 3];
        for (name, of) in ["sigma_x", "sigma_y", "sigma_z"].into_iter().zip(&mut sigma_components) {
            *of = sigma(name, None, Unit::Metre)?;
        }
        let name = Some(target.name.clone());
        Ok(TargetLayout {
            name,
            position,
            orientation,
            convention: convention.map(|it| it.0),
            sigma_position,
            sigma_components,
            sigma_rotation,
            kinds,
        })
    }

    /// True if the header has a column of this name that is not used otherwise.
    pub(super) fn has(&self, name: &str) -> bool {
        self.header.count(name) > 0 && !self.readings.contains(name)
    }

    /// The other kinds of measurements of which the header has columns.
    fn kinds(&mut self) -> Result<Vec<KindColumns>> {
        let mut found: Vec<KindColumns> = Vec::new();
        let mut known: BTreeMap<&str, usize> = BTreeMap::new();
        for kind in kinds::kinds() {
            let FunctionKind { function, columns } = kind;
            let has_number = columns.numbers.iter().any(|name| self.has(name));
            if !(self.has(kind.key()) || kind.needs_numbers() && has_number) {
                continue;
            }
            let (dimension, purpose) =
                (function.leading_quantity().unit(), format!("for the {}", function.leading_quantity().name()));
            let mut numbers = Vec::with_capacity(columns.numbers.len());
            let names = columns.numbers.iter().filter(|name| kind.needs_numbers() || self.has(name));
            for &name in names.collect::<Vec<_>>() {
                // Kinds that a word distinguishes have their numbers in the same columns.
                let input = match known.get(name) {
                    Some(&input) => input,
                    None => self.column_input(name, name, dimension, None, &purpose)?,
                };
                known.insert(name, input);
                numbers.push(input);
            }
            let mut sigmas = Vec::with_capacity(function.quantities.len());
            for &quantity in function.quantities {
                let name = format!("sigma_{}", quantity.name());
                let sigma = self.sigma(&name, None, (quantity.unit(), None), true)?;
                sigmas.extend(sigma.map(|input| (quantity, input)));
            }
            let mut places = Vec::with_capacity(columns.places.len());
            for name in columns.places {
                places.extend(self.shared_text_column(name)?);
            }
            let word = columns.word.map(|(column, _)| self.shared_text_column(column)).transpose()?.flatten();
            found.push(KindColumns { kind, numbers, sigmas, places, word });
        }
        Ok(found)
    }

    /// Index of an optional column that several kinds may use.
    fn shared_text_column(&mut self, name: &str) -> Result<Option<usize>> {
        let index = self.header.find(name)?.filter(|_| !self.readings.contains(name));
        if let Some(index) = index {
            self.mark(index);
        }
        Ok(index)
    }

    fn position(&mut self, prefix: &str, spec: &PositionSpec, usual: Option<NamedUnit>) -> Result<[usize; 3]> {
        let mut indices = [0; 3];
        for (i, (axis, index)) in ["x", "y", "z"].into_iter().zip(&mut indices).enumerate() {
            let own = if self.has_large_axes() { ["X", "Y", "Z"][i] } else { axis };
            let column = spec.columns.as_ref().and_then(|columns| columns.get(i)).map_or(own, String::as_str);
            let purpose = format!("for the position {prefix}{axis}");
            let units = (spec.unit, self.makers_unit(usual));
            let found = self.column_or(&format!("{prefix}{axis}"), column, Unit::Metre, units, &purpose);
            *index = found.map_err(|error| error.if_missing(MissingColumn::Position))?;
        }
        Ok(indices)
    }

    fn mapped_orientation(&mut self, prefix: &str, spec: &OrientationSpec) -> Result<(OrientationForm, Vec<usize>)> {
        let indices = spec.columns.iter().zip(spec.form.part_names()).map(|(column, name)| {
            let purpose = format!("for the {}orientation ({})", prefix, spec.form);
            self.column_input(&format!("{prefix}{name}"), column, spec.form.quantity(), spec.unit, &purpose)
        });
        let indices = indices.collect::<Result<_>>()?;
        Ok((spec.form, indices))
    }

    /// The unit of a maker, if nothing states one; in a line of units, an empty cell may be forgotten.
    fn makers_unit(&self, unit: Option<NamedUnit>) -> Option<(NamedUnit, UnitSource)> {
        unit.filter(|_| self.header.units_line.is_none()).map(|unit| (unit, UnitSource::Maker))
    }

    /// The form of the orientation columns with our own names: all of one form, or none.
    fn own_form(&self) -> Result<Option<OrientationForm>> {
        let mut chosen: Option<(OrientationForm, &str)> = None;
        for form in OrientationForm::BY_NAME {
            for name in form.part_names() {
                let Some(index) = self.header.find(name)?.filter(|&index| !self.is_used(index)) else {
                    continue;
                };
                match chosen {
                    Some((other, first)) if other != form => {
                        let message =
                            format!("found the orientation columns `{first}` and `{name}`, expected one form only");
                        return Err(self.header.error(ErrorKind::Measurement, index, message));
                    }
                    Some(_) => {}
                    None => chosen = Some((form, name)),
                }
            }
        }
        Ok(chosen.map(|it| it.0))
    }

    /// The orientation in columns of these names.
    fn orientation(
        &mut self,
        form: OrientationForm,
        columns: &[&str],
        usual: Option<NamedUnit>,
    ) -> Result<(OrientationForm, Vec<usize>)> {
        let purpose = format!("for the orientation ({form})");
        let units = (None, self.makers_unit(usual));
        let names = columns.iter().zip(form.part_names());
        let indices = names.map(|(column, name)| self.column_or(name, column, form.quantity(), units, &purpose));
        Ok((form, indices.collect::<Result<_>>()?))
    }

    fn sigma(
        &mut self,
        name: &str,
        spec: Option<&ColumnSpec>,
        (quantity, unstated): (Unit, Option<(NamedUnit, UnitSource)>),
        by_our_name: bool,
    ) -> Result<Option<usize>> {
        let purpose = format!("for `{name}`");
        let expanded = name.replacen("sigma_", EXPANDED, 1);
        let has_expanded = by_our_name && spec.is_none() && self.header.find(&expanded)?.is_some();
        if let Some(spec) = spec {
            return self.spec_input(name, spec, quantity, &purpose).map(Some);
        }
        let has_own = by_our_name && self.header.find(name)?.is_some();
        if let Some(second) = self.header.find(&expanded)?.filter(|_| has_expanded && has_own) {
            let message = format!("found `{expanded}` beside `{name}`, expected one of the two");
            return Err(self.header.error(ErrorKind::Measurement, second, message));
        }
        let units = (None, unstated);
        match (has_own, has_expanded) {
            (true, _) => self.column_or(name, name, quantity, units, &purpose).map(Some),
            (false, true) => self.expanded_input(name, &expanded, (quantity, unstated), &purpose).map(Some),
            (false, false) => Ok(None),
        }
    }

    /// A standard deviation from a column of expanded uncertainties.
    fn expanded_input(
        &mut self,
        name: &str,
        column: &str,
        (quantity, unstated): (Unit, Option<(NamedUnit, UnitSource)>),
        purpose: &str,
    ) -> Result<usize> {
        let index = self.column_or(name, column, quantity, (None, unstated), purpose)?;
        if let Some(input) = self.inputs.get_mut(index)
            && let InputSource::Column(column) = input.source
        {
            input.sum = vec![SumTerm { column, unit: input.unit, factor: 1.0 / COVERAGE_FACTOR }];
        }
        Ok(index)
    }
}

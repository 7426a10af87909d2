//! A figure of the standard, and a limit of one.

use std::str::FromStr;

use crate::{AcceptanceLimit, Decision};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::unit::Unit;

/// Figures of ISO 9283:1998.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureName {
    /// Pose accuracy.
    Ap,
    /// Pose repeatability.
    Rp,
    /// Multi-directional pose accuracy variation.
    Vap,
    /// Distance accuracy.
    Ad,
    /// Distance repeatability.
    Rd,
    /// Drift of pose accuracy.
    Dap,
    /// Drift of pose repeatability.
    Drp,
    /// Exchangeability.
    E,
}

impl FigureName {
    /// All with symbol, clause and words.
    pub const ALL: [(FigureName, &'static str, &'static str, &'static str); 8] = [
        (FigureName::Ap, "AP", "7.2.1", "pose accuracy"),
        (FigureName::Rp, "RP", "7.2.2", "pose repeatability"),
        (FigureName::Vap, "vAP", "7.2.3", "multi-directional pose accuracy variation"),
        (FigureName::Ad, "AD", "7.3.2", "distance accuracy"),
        (FigureName::Rd, "RD", "7.3.3", "distance repeatability"),
        (FigureName::Dap, "dAP", "7.6", "drift of pose accuracy"),
        (FigureName::Drp, "dRP", "7.6", "drift of pose repeatability"),
        (FigureName::E, "E", "7.7", "exchangeability"),
    ];

    fn entry(self) -> (&'static str, &'static str, &'static str) {
        let own = FigureName::ALL.into_iter().find(|it| it.0 == self);
        own.map_or(("", "", ""), |(_, symbol, clause, words)| (symbol, clause, words))
    }

    /// Its symbol: `AP`.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        self.entry().0
    }

    /// Its clause: `7.2.1`.
    #[must_use]
    pub fn clause(self) -> &'static str {
        self.entry().1
    }

    /// Its name in the standard.
    #[must_use]
    pub fn words(self) -> &'static str {
        self.entry().2
    }
}

/// A figure with its 95 % interval, metres or radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FigureBounds {
    /// By the formula of the standard.
    pub found: f64,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

/// A figure of one pose, or of two.
#[derive(Clone, Debug, PartialEq)]
pub struct TestFigure {
    /// Which figure.
    pub name: FigureName,
    /// Axis of the base about which angles are counted: 0 to 2 for a, b and c; `None` for lengths.
    pub axis: Option<usize>,
    /// The pose, `P1`; of distances both, `P2-P4`.
    pub pose: String,
    /// Number of cycles.
    pub cycles: usize,
    /// The figure.
    pub measured: FigureBounds,
    /// Without the stated noise of the instrument, if there is any.
    pub without_noise: Option<FigureBounds>,
    /// The same with commands corrected by a calibration, predicted from its errors in these poses.
    pub corrected: Option<FigureBounds>,
}

impl TestFigure {
    /// Symbol with its axis: `AP`, `APa`.
    #[must_use]
    pub fn symbol(&self) -> String {
        let axis = self.axis.and_then(|axis| ["a", "b", "c"].get(axis).copied());
        format!("{}{}", self.name.symbol(), axis.unwrap_or_default())
    }

    /// Unit of its numbers.
    #[must_use]
    pub fn unit(&self) -> Unit {
        if self.axis.is_some() { Unit::Radian } else { Unit::Metre }
    }
}

/// The most that a figure may be, like `AP:0.5mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FigureLimit {
    /// Which figure.
    pub name: FigureName,
    /// Unit: lengths, or angles of all axes.
    pub unit: Unit,
    /// Metres or radians.
    pub most: f64,
}

impl FromStr for FigureLimit {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let bad = || {
            let symbols = FigureName::ALL.map(|it| it.1).join(", ");
            ErrorKind::Option
                .error(format!("found `{text}` as a limit, expected one of {symbols} before a colon and a length or angle, like AP:0.5mm or RP:0.02deg"))
        };
        let (word, number) = text.split_once(':').ok_or_else(bad)?;
        let own = FigureName::ALL.into_iter().find(|it| it.1.eq_ignore_ascii_case(word.trim()));
        let (name, ..) = own.ok_or_else(bad)?;
        let AcceptanceLimit { unit, most, .. } = number.parse()?;
        if !matches!(unit, Unit::Metre | Unit::Radian) {
            return Err(bad());
        }
        Ok(FigureLimit { name, unit, most })
    }
}

/// A limit that was decided by the worst figure of all poses; numbers in metres or radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedFigure {
    /// The limit.
    pub limit: FigureLimit,
    /// The largest value and the largest ends of intervals.
    pub worst: FigureBounds,
    /// Decision on the limit.
    pub decision: Decision,
}

impl FigureLimit {
    /// Decides the limit with 95 % confidence: kept if the interval of every pose ends below it, exceeded if one begins above it.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if there is no such figure.
    pub fn judge(self, figures: &[TestFigure]) -> Result<JudgedFigure> {
        let own = || figures.iter().filter(|it| it.name == self.name && it.unit() == self.unit);
        if own().next().is_none() {
            return ErrorKind::Option.refuse(format!(
                "found the limit {}:{}{} and no such figure, expected rows that show it: {}",
                self.name.symbol(),
                self.unit.in_shown_unit(self.most),
                self.unit.symbol(),
                self.name.needs()
            ));
        }
        let most = |of: fn(&FigureBounds) -> f64| own().map(|it| of(&it.measured)).fold(0.0, f64::max);
        // The size of a signed figure counts.
        let worst = FigureBounds {
            found: most(|it| it.found.abs()),
            from: most(|it| it.from.max(-it.to)),
            to: most(|it| it.to.abs().max(it.from.abs())),
        };
        let decision = Decision::from_bounds(self.most, worst.from, Some(worst.to));
        Ok(JudgedFigure { limit: self, worst, decision })
    }
}

impl FigureName {
    /// Requirements on rows that show it.
    fn needs(self) -> &'static str {
        match self {
            FigureName::Ap | FigureName::Rp => "orientations for angles",
            FigureName::Ad | FigureName::Rd => "two poses or more, and lengths only",
            FigureName::Vap => "a column `approach` with two paths or more",
            FigureName::Dap | FigureName::Drp => "a column `series` with two series or more",
            FigureName::E => "a column `arm` with two arms or more",
        }
    }
}

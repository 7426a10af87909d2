//! Arguments of `poecal calibrate`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use poecal::calibration::{Level, Loss, Robust};
use poecal::io::output::Existing;
use poecal_lou2009::{Formulation, Method, Residual};

use super::report::ReportPlace;
use super::shared::{ChainArgs, Frame, Reading};
use crate::quantity::{BelievedTolerance, share, sigma_m, sigma_rad, whole};

/// How errors of the joints are parameterised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FormulationWord {
    /// Axes move as rigid bodies, without offsets: minimal, unconstrained
    Adjoint,
    /// Screws are free numbers, normalised after every step
    Screw,
    /// Free screws and joint offsets, 7n + 6 unknowns
    ScrewOffsets,
    /// Axes as rigid bodies, and joint offsets
    AdjointOffsets,
}

impl From<FormulationWord> for Formulation {
    fn from(word: FormulationWord) -> Self {
        match word {
            FormulationWord::Adjoint => Formulation::Adjoint,
            FormulationWord::Screw => Formulation::Screw,
            FormulationWord::ScrewOffsets => Formulation::ScrewOffsets,
            FormulationWord::AdjointOffsets => Formulation::AdjointOffsets,
        }
    }
}

/// Residuals of measured frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ResidualWord {
    /// Position and rotation at the target
    Tool,
    /// The twist about the device's origin
    Spatial,
}

impl From<ResidualWord> for Residual {
    fn from(word: ResidualWord) -> Self {
        match word {
            ResidualWord::Tool => Residual::Tool,
            ResidualWord::Spatial => Residual::Spatial,
        }
    }
}

/// How to treat outliers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RobustWord {
    /// Least squares, unless outliers are evident: then the tukey loss, and a warning
    Auto,
    /// Least squares: every row counts in full
    Off,
    /// The influence of a residual is bounded
    Huber,
    /// The influence of a large residual decreases with its size
    Cauchy,
    /// Large residuals have no influence
    Tukey,
}

impl From<RobustWord> for Robust {
    fn from(word: RobustWord) -> Self {
        match word {
            RobustWord::Auto => Robust::Auto,
            RobustWord::Off => Robust::Off,
            RobustWord::Huber => Robust::Loss(Loss::Huber),
            RobustWord::Cauchy => Robust::Loss(Loss::Cauchy),
            RobustWord::Tukey => Robust::Loss(Loss::Tukey),
        }
    }
}

/// Method of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodWord {
    /// Damped steps, taken only if they reduce the cost
    LevenbergMarquardt,
    /// Full steps, taken as they are
    GaussNewton,
}

impl From<MethodWord> for Method {
    fn from(word: MethodWord) -> Self {
        match word {
            MethodWord::LevenbergMarquardt => Method::LevenbergMarquardt,
            MethodWord::GaussNewton => Method::GaussNewton,
        }
    }
}

/// Arguments of `poecal calibrate`.
#[derive(Args, Debug)]
pub(crate) struct Calibrate {
    /// Robot model: URDF, TOML or calibration.json [default: from the settings]
    pub(crate) model: Option<PathBuf>,
    /// Measurement files (CSV), joined [default: from the settings]
    pub(crate) measurements: Vec<PathBuf>,
    /// Settings (TOML) for options that are not given here [default: poecal.toml in this folder, if no model is named]
    #[arg(long, value_name = "FILE")]
    pub(crate) settings: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    #[command(flatten)]
    pub(crate) reading: Reading,
    /// The measuring device's frame
    #[arg(long, value_enum, default_value = "unknown")]
    pub(crate) frame: Frame,
    /// Standard deviation of each measured position component, like 0.05mm [default: estimated from the data]
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, allow_hyphen_values = true)]
    pub(crate) sigma_position: Option<f64>,
    /// Standard deviation of each measured rotation component, like 0.01deg [default: estimated from the data]
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, allow_hyphen_values = true)]
    pub(crate) sigma_rotation: Option<f64>,
    /// Prior: deviation of each axis from nominal, as standard deviations, or none. It decides where the measurements determine
    /// nothing. A joint of a TOML model may state its own
    #[arg(long, value_name = "ANGLE,LENGTH|none", default_value = "0.5deg,5mm")]
    pub(crate) tolerance: BelievedTolerance,
    /// Share of the configurations held out, where nothing else says which rows are; 0 fits every row in any case [default: 0.3]
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    pub(crate) held_out: Option<f64>,
    /// Seed of that choice [default: 1]
    #[arg(long, value_parser = whole::<u64>)]
    pub(crate) seed: Option<u64>,
    /// How to treat outliers: auto fits by least squares, and by the tukey loss where that shows outliers
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) robust: RobustWord,
    /// Parameterisation of joint errors; all but the default are for comparison
    #[arg(long, value_enum, default_value = "adjoint", help_heading = "Comparison")]
    pub(crate) formulation: FormulationWord,
    /// Residual of measured frames; the paper's is for comparison. Points have one residual only
    #[arg(long, value_enum, default_value = "tool", help_heading = "Comparison")]
    pub(crate) residual: ResidualWord,
    /// Steps of the solver; plain Gauss-Newton may diverge [default: gauss-newton for formulations with free screws, else
    /// levenberg-marquardt]
    #[arg(long, value_enum, help_heading = "Comparison")]
    pub(crate) method: Option<MethodWord>,
    /// Measurement file to judge by: all other rows are fitted
    #[arg(long, value_name = "FILE", conflicts_with = "fit_where")]
    pub(crate) validate: Vec<PathBuf>,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "poecal-out")]
    pub(crate) out: PathBuf,
    /// Overwrite results in an existing folder, and a report that exists
    #[arg(long)]
    pub(crate) force: bool,
    /// Overwrite them where poecal wrote them: the meaning of `force` in the settings
    #[arg(long, hide = true)]
    pub(crate) force_own: bool,
    /// File for the report, or `none` [default: report.html among the results]
    #[arg(long, value_name = "FILE|none")]
    pub(crate) report: Option<ReportPlace>,
    /// End with code 1 if the verdict is worse than this (results are written all the same); it also does if the verdict is `do not use`
    #[arg(long, value_enum, value_name = "VERDICT")]
    pub(crate) require: Option<RequiredLevel>,
    /// Print everything: errors of fitted rows and of the nominal model, noise, solver, cross-validation, every joint
    #[arg(long)]
    pub(crate) verbose: bool,
    /// Print the calibration as JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
    /// Print where the time went, as a line of JSON on standard error; the solve is repeated for that
    #[arg(long)]
    pub(crate) timings: bool,
}

impl Calibrate {
    /// Treatment of existing results.
    pub(crate) fn existing(&self) -> Existing {
        if self.force_own && !self.force { Existing::Own } else { Existing::forced(self.force) }
    }

    /// All input files.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        let mapping = self.reading.columns.columns.iter();
        let files = self.model.iter().chain(&self.measurements).chain(&self.validate).chain(&self.settings);
        files.chain(mapping).map(PathBuf::as_path).collect()
    }
}

/// The verdicts that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RequiredLevel {
    /// Good to use anywhere within the limits
    Good,
    /// Good to use inside the sampled range, or better
    #[value(name = "inside_sampled_range")]
    InsideSampledRange,
}

impl From<RequiredLevel> for Level {
    fn from(required: RequiredLevel) -> Self {
        match required {
            RequiredLevel::Good => Level::Good,
            RequiredLevel::InsideSampledRange => Level::InsideSampledRange,
        }
    }
}

//! `station.toml`: paths of the robots' files, options of their calibration, and the limits of the line.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::hashes::sha256_of;
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source_text;

/// The keys of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StationFile {
    poecal_station: toml::Spanned<i64>,
    inbox: toml::Spanned<String>,
    results: toml::Spanned<String>,
    model: Option<String>,
    #[serde(default)]
    models: BTreeMap<String, String>,
    ledger: Option<String>,
    settings: Option<String>,
    prior: Option<String>,
    #[serde(default)]
    accept: Vec<String>,
    reference: Option<String>,
    #[serde(default)]
    limits: BTreeMap<String, [f64; 2]>,
}

/// Refuses a file at an offset.
type OffsetRefusal<'a> = &'a dyn Fn(usize, String) -> Result<()>;

impl StationFile {
    /// Refuses paths without a placeholder for the serial number, or with an unknown placeholder.
    fn check_paths(&self, refuse: OffsetRefusal<'_>) -> Result<()> {
        for (key, of) in [("inbox", &self.inbox), ("results", &self.results)] {
            let named = of.get_ref();
            if named.matches("{serial}").count() != 1 {
                let message = format!(
                    "found `{named}` as {key}, expected a path with {{serial}} once, like {key}/{{serial}}/{{date}}.csv"
                );
                return refuse(of.span().start, message);
            }
            let known = ["{serial}", "{date}", "{type}"].iter().fold(named.clone(), |rest, it| rest.replace(it, ""));
            if known.contains(['{', '}']) {
                return refuse(
                    of.span().start,
                    format!(
                        "found `{named}` as {key}, expected no other braces than {{serial}}, {{date}} and {{type}}"
                    ),
                );
            }
        }
        let dated = |of: &toml::Spanned<String>| of.get_ref().contains("{date}");
        if dated(&self.inbox) && !dated(&self.results) {
            let message = "found an inbox with {date} and results without, expected {date} in both: one result would replace another".to_owned();
            return refuse(self.results.span().start, message);
        }
        Ok(())
    }

    /// Refuses a station without the models of its types.
    fn check_models(&self, models: &BTreeMap<String, PathBuf>, refuse: OffsetRefusal<'_>) -> Result<()> {
        let has_types = self.inbox.get_ref().contains("{type}");
        if models.is_empty() || (!has_types && !models.contains_key("")) {
            let expected = if has_types { "`model`, or a table `models` with one for each {type}" } else { "`model`" };
            return refuse(0, format!("found no model, expected {expected}"));
        }
        Ok(())
    }

    /// Refuses limits that are no range.
    fn check_limits(&self, refuse: OffsetRefusal<'_>) -> Result<()> {
        for (name, [low, high]) in &self.limits {
            // NaN is in no order.
            if !(low < high && (low.is_finite() || high.is_finite())) {
                let message = format!(
                    "found limits of `{name}` that are no range, expected the lower one first, like [-0.3, 0.3], or [-inf, 0.3] of one limit"
                );
                return refuse(0, message);
            }
        }
        Ok(())
    }
}

/// A station at the end of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Its file.
    pub path: PathBuf,
    /// Its folder, the base of the paths in it.
    pub folder: PathBuf,
    /// Pattern of the paths of measurements: with `{serial}`, and `{date}` and `{type}` if there are several.
    pub inbox: String,
    /// Pattern of the paths of results: with `{serial}`, and with `{date}` if the inbox has it.
    pub results: String,
    /// The model of each type; a single type has an empty name.
    pub models: BTreeMap<String, PathBuf>,
    /// The ledger.
    pub ledger: PathBuf,
    /// Settings of `poecal calibrate`.
    pub settings: Option<PathBuf>,
    /// Estimate of the line's next robot, as `fleet_prior` of the report writes it: the prior of all but every twentieth.
    pub prior: Option<PathBuf>,
    /// Limits of `--accept`.
    pub accept: Vec<String>,
    /// Serial number of the reference arm, which is measured repeatedly.
    pub reference: Option<String>,
    /// Lower and upper limits of figures, by their names, in their units.
    pub limits: BTreeMap<String, [Option<f64>; 2]>,
}

/// One robot of this many is measured in full and judged without the prior.
const IN_FULL: u64 = 20;

impl Station {
    /// A path as in the ledger: from the folder of the station, independent of the current folder.
    #[must_use]
    pub fn from_folder(&self, path: &Path) -> String {
        path.strip_prefix(&self.folder).unwrap_or(path).display().to_string()
    }

    /// True if a robot is measured in full and judged without the prior. Its serial number ends then in a multiple of 20, so that it is known
    /// beforehand. A serial number without a final number is decided by its SHA-256.
    #[must_use]
    pub fn is_in_full(serial: &str) -> bool {
        let digits = serial.trim_start_matches(|letter: char| !letter.is_ascii_digit());
        let last = digits.rsplit(|letter: char| !letter.is_ascii_digit()).next().unwrap_or_default();
        let tail = last.get(last.len().saturating_sub(9)..).unwrap_or_default();
        let number = tail.parse::<u64>().ok().or_else(|| {
            let hash = sha256_of(serial);
            u64::from_str_radix(hash.get(..8)?, 16).ok()
        });
        number.is_some_and(|number| number % IN_FULL == 0)
    }

    /// Reads the file; paths in it are from its folder.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if it cannot be read; [`ErrorKind::Syntax`], with line and column, if it is no station.
    pub fn read(path: &Path) -> Result<Self> {
        let text =
            source_text::read_up_to(path, "a station (TOML: inbox, results and model)", ResourceLimit::Settings)?;
        let refused = |offset: usize, message: String| ErrorKind::Syntax.error(message).at_offset(path, &text, offset);
        let refuse = |offset: usize, message: String| Err(refused(offset, message));
        let file: StationFile = match toml::from_str(&text) {
            Ok(file) => file,
            Err(error) => {
                let at = error.span().map_or(0, |span| span.start);
                return Err(refused(at, error.message().trim().replace('\n', ", ")));
            }
        };
        let version = *file.poecal_station.get_ref();
        if version != 1 {
            let at = file.poecal_station.span().start;
            return Err(refused(
                at,
                format!("found a station of version {version}, expected 1: a newer poecal wrote it"),
            ));
        }
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        file.check_paths(&refuse)?;
        let mut models: BTreeMap<String, PathBuf> =
            file.models.iter().map(|(name, path)| (name.clone(), folder.join(path))).collect();
        models.extend(file.model.iter().map(|path| (String::new(), folder.join(path))));
        file.check_models(&models, &refuse)?;
        file.check_limits(&refuse)?;
        let one = |limit: f64| limit.is_finite().then_some(limit);
        let limits = file.limits.into_iter().map(|(name, [low, high])| (name, [one(low), one(high)]));
        Ok(Station {
            inbox: folder.join(file.inbox.into_inner()).display().to_string(),
            results: folder.join(file.results.into_inner()).display().to_string(),
            models,
            ledger: folder.join(file.ledger.as_deref().unwrap_or(super::LEDGER)),
            settings: file.settings.map(|path| folder.join(path)),
            prior: file.prior.map(|path| folder.join(path)),
            accept: file.accept,
            reference: file.reference,
            limits: limits.collect(),
            path: path.to_owned(),
            folder,
        })
    }
}

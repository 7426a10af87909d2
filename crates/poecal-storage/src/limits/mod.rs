//! Limits of the sizes of files: their only table, and their sentence.
//!
//! A limit is checked before memory is taken, by [`ResourceLimit::refuse`] or [`ResourceLimit::value`]. [`run_with_limits`] replaces the limits for some work of one thread, as
//! the program does for `--limit`; work on other threads inherits them. [`set`] replaces one of the process.

mod table;

use std::cell::Cell;
use std::fmt::Display;
use std::sync::atomic::{AtomicU64, Ordering};

use poecal_numerics::error::{ErrorKind, Result};

use table::{BYTES, COUNT};
pub use table::{LIMITS, LimitRow, ResourceLimit};

impl ResourceLimit {
    /// Its row of the table.
    #[must_use]
    pub fn row(self) -> &'static LimitRow {
        &LIMITS[self as usize]
    }

    /// The limit on this thread.
    #[must_use]
    pub fn value(self) -> u64 {
        current_limits().0[self as usize]
    }

    /// The limit on this thread, as a number of things in memory.
    #[must_use]
    pub fn most_held(self) -> usize {
        usize::try_from(self.value()).unwrap_or(usize::MAX)
    }

    /// The sentence of a file that exceeds the limit: the size that was found, the limit, and the remedies with and without a higher limit.
    #[must_use]
    pub fn sentence(self, found: &str) -> String {
        let row = self.row();
        let most = amount(self.value(), row.unit);
        let higher =
            if row.highest > row.usual { format!(", or allow more by --limit {}=N", row.name) } else { String::new() };
        format!("found {found}, expected at most {most} (limit `{}`): {}{higher}", row.name, row.advice)
    }

    /// The sentence for a number above the limit.
    #[must_use]
    pub fn exceeded_error(self, of: &str) -> String {
        let most = amount(self.value(), self.row().unit);
        self.sentence(&format!("more than {most} in {of}"))
    }

    /// Refuses a number beyond the limit; `found` describes the thing that has it.
    ///
    /// # Errors
    /// The [`sentence`](ResourceLimit::sentence) as an error of [`ErrorKind::File`] without a position.
    pub fn refuse(self, count: u64, found: impl Display) -> Result<()> {
        if count <= self.value() { Ok(()) } else { Err(ErrorKind::File.error(self.sentence(&found.to_string()))) }
    }

    /// The limit of a name.
    fn from_name(name: &str) -> Option<Self> {
        LIMITS.iter().find(|row| row.name == name).map(|row| row.limit)
    }
}

/// A number with its unit, for people: `64 MiB`, `1,000,000 rows`.
#[must_use]
pub fn amount(count: u64, unit: &str) -> String {
    if unit != BYTES {
        return format!("{} {unit}", with_commas(count));
    }
    let sizes = [("GiB", 30), ("MiB", 20), ("KiB", 10)];
    match sizes.into_iter().find(|(_, bits)| count >= 1 << bits && count.is_multiple_of(1 << bits)) {
        Some((size, bits)) => format!("{} {size}", count >> bits),
        None => format!("{} bytes", with_commas(count)),
    }
}

fn with_commas(count: u64) -> String {
    let digits = count.to_string();
    let mut found = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            found.push(',');
        }
        found.push(digit);
    }
    found
}

/// All limits at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResourceLimits([u64; COUNT]);

impl Default for ResourceLimits {
    fn default() -> Self {
        ResourceLimits::USUAL
    }
}

impl ResourceLimits {
    const USUAL: ResourceLimits = {
        let (mut all, mut at) = ([0; COUNT], 0);
        while at < COUNT {
            all[at] = LIMITS[at].usual;
            at += 1;
        }
        ResourceLimits(all)
    };

    /// Replaces one limit.
    #[must_use]
    pub fn with_limit(mut self, limit: ResourceLimit, most: u64) -> Self {
        self.0[limit as usize] = most;
        self
    }
}

thread_local! {
    static HERE: Cell<Option<ResourceLimits>> = const { Cell::new(None) };
}

/// The limits of threads without limits of their own.
static OF_PROCESS: [AtomicU64; COUNT] = {
    let (mut all, mut at) = ([const { AtomicU64::new(0) }; COUNT], 0);
    while at < COUNT {
        all[at] = AtomicU64::new(LIMITS[at].usual);
        at += 1;
    }
    all
};

/// The limits of this thread.
#[must_use]
pub fn current_limits() -> ResourceLimits {
    HERE.get().unwrap_or_else(|| ResourceLimits(std::array::from_fn(|at| OF_PROCESS[at].load(Ordering::Relaxed))))
}

/// Sets a limit of the whole process, except for threads at work under others ([`run_with_limits`]).
pub fn set(limit: ResourceLimit, most: u64) {
    OF_PROCESS[limit as usize].store(most, Ordering::Relaxed);
}

/// The limits that differ from the usual ones, in the form of [`parse`].
#[must_use]
pub fn list_changed() -> Vec<String> {
    let all = LIMITS.iter().zip(current_limits().0).filter(|(row, most)| row.usual != *most);
    all.map(|(row, most)| format!("{}={most}", row.name)).collect()
}

/// Runs `work` under other limits, on this thread only.
pub fn run_with_limits<T>(limits: ResourceLimits, work: impl FnOnce() -> T) -> T {
    /// Restores the previous limits, also after a panic.
    struct LimitsGuard(Option<ResourceLimits>);
    impl Drop for LimitsGuard {
        fn drop(&mut self) {
            HERE.set(self.0);
        }
    }
    let _back = LimitsGuard(HERE.replace(Some(limits)));
    work()
}

/// Parses a limit in its typed form: `rows=5000000`, `text=1GiB`.
///
/// # Errors
/// One sentence with found and expected, of [`ErrorKind::Option`].
pub fn parse(text: &str) -> Result<(ResourceLimit, u64)> {
    let refuse = |message: String| -> Result<(ResourceLimit, u64)> { Err(ErrorKind::Option.error(message)) };
    let example = "a name and a number, like rows=5000000 or text=1GiB";
    let Some((name, number)) = text.split_once('=') else {
        return refuse(format!("found `{text}`, expected {example}"));
    };
    let Some(limit) = ResourceLimit::from_name(name) else {
        let names: Vec<&str> = LIMITS.iter().map(|row| row.name).collect();
        return refuse(format!("found the limit `{name}`, expected one of {}", names.join(", ")));
    };
    let sizes = [("KiB", 10), ("MiB", 20), ("GiB", 30), ("TiB", 40)];
    let (digits, bits) = sizes
        .into_iter()
        .filter(|_| limit.row().unit == BYTES)
        .find_map(|(size, bits)| Some((number.strip_suffix(size)?, bits)))
        .unwrap_or((number, 0));
    let is_plain = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit());
    let count = digits.parse::<u64>().ok().filter(|_| is_plain).and_then(|it| it.checked_mul(1 << bits));
    let highest = limit.row().highest;
    match count {
        Some(count) if (1..=highest).contains(&count) => Ok((limit, count)),
        Some(_) => refuse(format!("found `{text}`, expected a number from 1 to {}", amount(highest, limit.row().unit))),
        None => refuse(format!("found `{text}`, expected {example}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_limits() {
        for (at, row) in LIMITS.iter().enumerate() {
            assert_eq!(row.limit as usize, at, "{}", row.name);
            assert!(row.usual <= row.highest);
        }
    }

    #[test]
    fn the_documented_limits_are_those_of_the_table() {
        let document = include_str!("../../../../SECURITY.md");
        let rows = document.lines().filter(|line| line.starts_with("| `"));
        let cells = rows.map(|line| line.split('|').map(str::trim).collect::<Vec<_>>());
        let documented: Vec<(String, String)> =
            cells.map(|cells| (cells[1].replace('`', ""), cells[2].to_owned())).collect();
        let own: Vec<(String, String)> =
            LIMITS.iter().map(|row| (row.name.to_owned(), amount(row.usual, row.unit))).collect();
        assert_eq!(documented, own);
    }

    #[test]
    fn limits_are_of_a_thread_and_for_some_work() {
        let lower = current_limits().with_limit(ResourceLimit::Rows, 3);
        run_with_limits(lower, || {
            assert_eq!(ResourceLimit::Rows.value(), 3);
            assert!(ResourceLimit::Rows.refuse(3, "3 rows").is_ok());
            let error = ResourceLimit::Rows.refuse(4, "4 rows").unwrap_err();
            assert_eq!(
                error.message(),
                "found 4 rows, expected at most 3 rows (limit `rows`): split the file, or allow more by --limit rows=N"
            );
            std::thread::spawn(|| assert_eq!(ResourceLimit::Rows.value(), 1_000_000)).join().unwrap();
        });
        assert_eq!(current_limits(), ResourceLimits::default());
        assert_eq!(run_with_limits(lower, list_changed), ["rows=3"]);
        // The stack does not grow with a higher limit.
        assert!(!ResourceLimit::Nesting.exceeded_error("a line").contains("--limit"));
    }

    #[test]
    fn a_limit_is_a_name_and_a_number() {
        assert_eq!(parse("rows=12").unwrap(), (ResourceLimit::Rows, 12));
        assert_eq!(parse("text=3MiB").unwrap(), (ResourceLimit::Text, 3 << 20));
        for (text, part) in [
            ("rows", "found `rows`, expected a name and a number"),
            ("row=1", "found the limit `row`, expected one of text, program, settings"),
            ("rows=0", "expected a number from 1 to 100,000,000 rows"),
            ("rows=3MiB", "expected a name and a number"),
            ("rows=-1", "expected a name and a number"),
            ("text=99999999999TiB", "expected a name and a number"),
            ("nesting=201", "expected a number from 1 to 200 levels"),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}

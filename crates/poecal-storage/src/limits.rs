//! Limits of what a file may take: the one table of them, and their sentence.
//!
//! A limit is asked before memory is taken, by [`Limit::refuse`] or [`Limit::most`]. [`on`] replaces the limits for some work of one thread, as the
//! program does for `--limit`; work on other threads takes them along. [`set`] replaces one of the process.

use std::cell::Cell;
use std::fmt::Display;
use std::sync::atomic::{AtomicU64, Ordering};

use poecal_numerics::error::{ErrorKind, Result};

/// A limit of what a file may take. Its number is its place in [`LIMITS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Bytes of a text that is held whole.
    Text,
    /// Bytes of a robot program.
    Program,
    /// Bytes of settings and other small texts.
    Settings,
    /// Bytes of the ledger of a line of robots.
    Ledger,
    /// Bytes of the history of a calibration's checks.
    History,
    /// Bytes of a table.
    Table,
    /// Rows of a table.
    Rows,
    /// Columns of a table.
    Columns,
    /// Elements, attributes and texts of an XML file.
    Elements,
    /// Brackets, elements or blocks in each other.
    Nesting,
    /// Bytes of a workbook.
    Workbook,
    /// Bytes of the parts of a workbook, unpacked.
    Unpacked,
    /// Cells of the sheets of a workbook, empty ones among them.
    Cells,
    /// Bytes of the chunks of a bag, unpacked.
    Bag,
    /// Bytes of one record of a bag, unpacked.
    Chunk,
    /// Topics of a bag, and frames of a topic.
    Topics,
    /// Joint readings and poses in the messages of a bag.
    Poses,
    /// Bytes of a picture.
    Picture,
    /// Pixels of a picture.
    Pixels,
    /// Parts of a picture that may be dots.
    Dots,
    /// Files of a folder.
    Files,
}

/// The number of limits.
const COUNT: usize = 21;

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct LimitRow {
    /// The limit.
    pub limit: Limit,
    /// Its name on the command line.
    pub name: &'static str,
    /// How many there may be, if nothing else is asked for.
    pub usual: u64,
    /// The largest number that can be asked for.
    pub highest: u64,
    /// The unit of the number.
    pub unit: &'static str,
    /// The things that are limited, in words.
    pub of: &'static str,
    /// How to do without a higher limit.
    pub advice: &'static str,
}

/// Bytes are written in larger units.
const BYTES: &str = "bytes";
const MIB: u64 = 1 << 20;
const ANY: u64 = 1 << 50;

const fn row(
    limit: Limit,
    name: &'static str,
    (usual, highest): (u64, u64),
    unit: &'static str,
    of: &'static str,
    advice: &'static str,
) -> LimitRow {
    LimitRow { limit, name, usual, highest, unit, of, advice }
}

/// All limits. SECURITY.md has this table; a test compares both.
pub const LIMITS: [LimitRow; COUNT] = [
    row(
        Limit::Text,
        "text",
        (64 * MIB, ANY),
        BYTES,
        "a model, a calibration, or a file of an instrument",
        "split the file",
    ),
    row(Limit::Program, "program", (4 * MIB, ANY), BYTES, "a robot program", "cut it into several"),
    row(
        Limit::Settings,
        "settings",
        (4 * MIB, ANY),
        BYTES,
        "settings, a station, a mapping, a lens or a board, a model in TOML, or the joint readings of one picture",
        "take out what it does not need",
    ),
    row(
        Limit::Ledger,
        "ledger",
        (256 * MIB, ANY),
        BYTES,
        "the ledger of `poecal fleet`",
        "begin a new one, and name both by --ledger",
    ),
    row(
        Limit::History,
        "history",
        (16 * MIB, ANY),
        BYTES,
        "the history of checks of a calibration",
        "move it away: a new one begins",
    ),
    row(Limit::Table, "table", (4096 * MIB, ANY), BYTES, "a table (CSV)", "split the file"),
    row(Limit::Rows, "rows", (1_000_000, 100_000_000), "rows", "measurements of one file", "split the file"),
    row(
        Limit::Columns,
        "columns",
        (16_384, 1_000_000),
        "columns",
        "a table",
        "leave out columns that are not needed",
    ),
    row(
        Limit::Elements,
        "elements",
        (1_000_000, 1 << 31),
        "elements",
        "elements and texts of an XML file",
        "leave out what is no joint or link, such as meshes",
    ),
    // A higher one could overflow the stack.
    row(
        Limit::Nesting,
        "nesting",
        (200, 200),
        "levels",
        "brackets, blocks or elements in each other",
        "write it with fewer",
    ),
    row(
        Limit::Workbook,
        "workbook",
        (64 * MIB, ANY),
        BYTES,
        "a workbook",
        "save the sheet of the table as `CSV UTF-8`",
    ),
    row(
        Limit::Unpacked,
        "unpacked",
        (128 * MIB, ANY),
        BYTES,
        "all parts of a workbook, unpacked, or the texts of its cells",
        "save the sheet of the table as `CSV UTF-8`",
    ),
    row(
        Limit::Cells,
        "cells",
        (4_000_000, 4_000_000_000),
        "cells",
        "the sheets of a workbook, from their first to their last cell",
        "delete what stands far from the table, or save its sheet as `CSV UTF-8`",
    ),
    row(
        Limit::Bag,
        "bag",
        (64 * 1024 * MIB, ANY),
        BYTES,
        "a bag, unpacked",
        "split it with `ros2 bag convert`",
    ),
    row(
        Limit::Chunk,
        "chunk",
        (128 * MIB, ANY),
        BYTES,
        "a chunk or message of a bag, unpacked",
        "write the bag again with smaller chunks",
    ),
    row(
        Limit::Topics,
        "topics",
        (65_536, 1 << 31),
        "topics",
        "topics of a bag, and frames of a topic",
        "record the topics that are needed alone",
    ),
    row(
        Limit::Poses,
        "poses",
        (3_000_000, 1 << 31),
        "poses",
        "joint readings and poses in the messages of a bag",
        "record the topics that are needed alone, or split the bag",
    ),
    row(Limit::Picture, "picture", (256 * MIB, ANY), BYTES, "a picture", "save it as JPEG"),
    row(
        Limit::Pixels,
        "pixels",
        (50_000_000, 4_000_000_000),
        "pixels",
        "a picture",
        "take pictures of fewer pixels",
    ),
    row(
        Limit::Dots,
        "dots",
        (6_000, 1_000_000),
        "parts",
        "parts of a picture that may be dots of a board",
        "take pictures in which the board is larger, or cover the pattern beside it",
    ),
    row(
        Limit::Files,
        "files",
        (100_000, ANY),
        "files",
        "files of a folder that is searched",
        "move those away that are done",
    ),
];

impl Limit {
    /// Its row of the table.
    #[must_use]
    pub fn row(self) -> &'static LimitRow {
        &LIMITS[self as usize]
    }

    /// The limit on this thread.
    #[must_use]
    pub fn most(self) -> u64 {
        here().0[self as usize]
    }

    /// The same, as a number of things in memory.
    #[must_use]
    pub fn most_held(self) -> usize {
        usize::try_from(self.most()).unwrap_or(usize::MAX)
    }

    /// The sentence of a file that exceeds the limit: what was found, the limit, and how to do with it or without it.
    #[must_use]
    pub fn sentence(self, found: &str) -> String {
        let row = self.row();
        let most = amount(self.most(), row.unit);
        let higher = if row.highest > row.usual {
            format!(", or allow more by --limit {}=N", row.name)
        } else {
            String::new()
        };
        format!("found {found}, expected at most {most} (limit `{}`): {}{higher}", row.name, row.advice)
    }

    /// The same, where so many were found.
    #[must_use]
    pub fn exceeded(self, of: &str) -> String {
        let most = amount(self.most(), self.row().unit);
        self.sentence(&format!("more than {most} in {of}"))
    }

    /// Refuses a number beyond the limit; `found` are words for what has it.
    ///
    /// # Errors
    /// The [`sentence`](Limit::sentence) as an error of [`ErrorKind::File`] without a place.
    pub fn refuse(self, count: u64, found: impl Display) -> Result<()> {
        if count <= self.most() {
            Ok(())
        } else {
            Err(ErrorKind::File.error(self.sentence(&found.to_string())))
        }
    }

    /// The limit of a name.
    fn named(name: &str) -> Option<Self> {
        LIMITS.iter().find(|row| row.name == name).map(|row| row.limit)
    }
}

/// A number with its unit, as people read it: `64 MiB`, `1,000,000 rows`.
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
pub struct Limits([u64; COUNT]);

impl Default for Limits {
    fn default() -> Self {
        Limits::USUAL
    }
}

impl Limits {
    const USUAL: Limits = {
        let (mut all, mut at) = ([0; COUNT], 0);
        while at < COUNT {
            all[at] = LIMITS[at].usual;
            at += 1;
        }
        Limits(all)
    };

    /// The same with another number of one.
    #[must_use]
    pub fn with(mut self, limit: Limit, most: u64) -> Self {
        self.0[limit as usize] = most;
        self
    }
}

thread_local! {
    static HERE: Cell<Option<Limits>> = const { Cell::new(None) };
}

/// The limits of threads that have none of their own.
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
pub fn here() -> Limits {
    HERE.get().unwrap_or_else(|| Limits(std::array::from_fn(|at| OF_PROCESS[at].load(Ordering::Relaxed))))
}

/// Sets a limit of the whole process, but for threads at work under others ([`on`]).
pub fn set(limit: Limit, most: u64) {
    OF_PROCESS[limit as usize].store(most, Ordering::Relaxed);
}

/// The limits that differ from the usual ones, as [`parse`] reads them.
#[must_use]
pub fn stated() -> Vec<String> {
    let all = LIMITS.iter().zip(here().0).filter(|(row, most)| row.usual != *most);
    all.map(|(row, most)| format!("{}={most}", row.name)).collect()
}

/// Does some work under other limits, as far as this thread does it.
pub fn on<T>(limits: Limits, work: impl FnOnce() -> T) -> T {
    /// Restores the limits before, also after a panic.
    struct Back(Option<Limits>);
    impl Drop for Back {
        fn drop(&mut self) {
            HERE.set(self.0);
        }
    }
    let _back = Back(HERE.replace(Some(limits)));
    work()
}

/// A limit as it is typed: `rows=5000000`, `text=1GiB`.
///
/// # Errors
/// One sentence with found and expected, of [`ErrorKind::Option`].
pub fn parse(text: &str) -> Result<(Limit, u64)> {
    let refuse = |message: String| -> Result<(Limit, u64)> { Err(ErrorKind::Option.error(message)) };
    let example = "a name and a number, like rows=5000000 or text=1GiB";
    let Some((name, number)) = text.split_once('=') else {
        return refuse(format!("found `{text}`, expected {example}"));
    };
    let Some(limit) = Limit::named(name) else {
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
        Some(_) => refuse(format!(
            "found `{text}`, expected a number from 1 to {}",
            amount(highest, limit.row().unit)
        )),
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
        let document = include_str!("../../../SECURITY.md");
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
        let lower = here().with(Limit::Rows, 3);
        on(lower, || {
            assert_eq!(Limit::Rows.most(), 3);
            assert!(Limit::Rows.refuse(3, "3 rows").is_ok());
            let error = Limit::Rows.refuse(4, "4 rows").unwrap_err();
            assert_eq!(
                error.message(),
                "found 4 rows, expected at most 3 rows (limit `rows`): split the file, or allow more by --limit rows=N"
            );
            std::thread::spawn(|| assert_eq!(Limit::Rows.most(), 1_000_000)).join().unwrap();
        });
        assert_eq!(here(), Limits::default());
        assert_eq!(on(lower, stated), ["rows=3"]);
        // The stack is not longer where more is asked for.
        assert!(!Limit::Nesting.exceeded("a line").contains("--limit"));
    }

    #[test]
    fn a_limit_is_a_name_and_a_number() {
        assert_eq!(parse("rows=12").unwrap(), (Limit::Rows, 12));
        assert_eq!(parse("text=3MiB").unwrap(), (Limit::Text, 3 << 20));
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

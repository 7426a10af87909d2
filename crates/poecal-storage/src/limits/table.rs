//! The table of limits.

/// A limit of the size of a file. Its number is its index in [`LIMITS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResourceLimit {
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
    /// Nested brackets, elements or blocks.
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
pub(crate) const COUNT: usize = 21;

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct LimitRow {
    /// The limit.
    pub limit: ResourceLimit,
    /// Its name on the command line.
    pub name: &'static str,
    /// The usual limit.
    pub usual: u64,
    /// The largest limit that can be set.
    pub highest: u64,
    /// The unit of the number.
    pub unit: &'static str,
    /// The things that are limited, in words.
    pub of: &'static str,
    /// Remedy without a higher limit.
    pub advice: &'static str,
}

/// Unit of bytes, which are written in larger units.
pub(crate) const BYTES: &str = "bytes";
const MIB: u64 = 1 << 20;
const ANY: u64 = 1 << 50;

const fn row(
    limit: ResourceLimit,
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
        ResourceLimit::Text,
        "text",
        (64 * MIB, ANY),
        BYTES,
        "a model, a calibration, or a file of an instrument",
        "split the file",
    ),
    row(ResourceLimit::Program, "program", (4 * MIB, ANY), BYTES, "a robot program", "cut it into several"),
    row(
        ResourceLimit::Settings,
        "settings",
        (4 * MIB, ANY),
        BYTES,
        "settings, a station, a mapping, a lens or a board, a model in TOML, or the joint readings of one picture",
        "take out what it does not need",
    ),
    row(
        ResourceLimit::Ledger,
        "ledger",
        (256 * MIB, ANY),
        BYTES,
        "the ledger of `poecal fleet`",
        "begin a new one, and name both by --ledger",
    ),
    row(
        ResourceLimit::History,
        "history",
        (16 * MIB, ANY),
        BYTES,
        "the history of checks of a calibration",
        "move it away: a new one begins",
    ),
    row(ResourceLimit::Table, "table", (4096 * MIB, ANY), BYTES, "a table (CSV)", "split the file"),
    row(ResourceLimit::Rows, "rows", (1_000_000, 100_000_000), "rows", "measurements of one file", "split the file"),
    row(
        ResourceLimit::Columns,
        "columns",
        (16_384, 1_000_000),
        "columns",
        "a table",
        "leave out columns that are not needed",
    ),
    row(
        ResourceLimit::Elements,
        "elements",
        (1_000_000, 1 << 31),
        "elements",
        "elements and texts of an XML file",
        "leave out what is no joint or link, such as meshes",
    ),
    // A higher one could overflow the stack.
    row(
        ResourceLimit::Nesting,
        "nesting",
        (200, 200),
        "levels",
        "brackets, blocks or elements in each other",
        "write it with fewer",
    ),
    row(
        ResourceLimit::Workbook,
        "workbook",
        (64 * MIB, ANY),
        BYTES,
        "a workbook",
        "save the sheet of the table as `CSV UTF-8`",
    ),
    row(
        ResourceLimit::Unpacked,
        "unpacked",
        (128 * MIB, ANY),
        BYTES,
        "all parts of a workbook, unpacked, or the texts of its cells",
        "save the sheet of the table as `CSV UTF-8`",
    ),
    row(
        ResourceLimit::Cells,
        "cells",
        (4_000_000, 4_000_000_000),
        "cells",
        "the sheets of a workbook, from their first to their last cell",
        "delete what stands far from the table, or save its sheet as `CSV UTF-8`",
    ),
    row(
        ResourceLimit::Bag,
        "bag",
        (64 * 1024 * MIB, ANY),
        BYTES,
        "a bag, unpacked",
        "split it with `ros2 bag convert`",
    ),
    row(
        ResourceLimit::Chunk,
        "chunk",
        (128 * MIB, ANY),
        BYTES,
        "a chunk or message of a bag, unpacked",
        "write the bag again with smaller chunks",
    ),
    row(
        ResourceLimit::Topics,
        "topics",
        (65_536, 1 << 31),
        "topics",
        "topics of a bag, and frames of a topic",
        "record the topics that are needed alone",
    ),
    row(
        ResourceLimit::Poses,
        "poses",
        (3_000_000, 1 << 31),
        "poses",
        "joint readings and poses in the messages of a bag",
        "record the topics that are needed alone, or split the bag",
    ),
    row(ResourceLimit::Picture, "picture", (256 * MIB, ANY), BYTES, "a picture", "save it as JPEG"),
    row(
        ResourceLimit::Pixels,
        "pixels",
        (50_000_000, 4_000_000_000),
        "pixels",
        "a picture",
        "take pictures of fewer pixels",
    ),
    row(
        ResourceLimit::Dots,
        "dots",
        (6_000, 1_000_000),
        "parts",
        "parts of a picture that may be dots of a board",
        "take pictures in which the board is larger, or cover the pattern beside it",
    ),
    row(
        ResourceLimit::Files,
        "files",
        (100_000, ANY),
        "files",
        "files of a folder that is searched",
        "move those away that are done",
    ),
];

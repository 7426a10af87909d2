//! What was found in the poses beside the frames: a sentence each.

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FindingKind {
    /// A list is inverted, and was inverted back.
    Inverted,
    /// Camera and target lie as if they were exchanged.
    Exchanged,
    /// Rows that repeat earlier ones, and count once.
    Repeated,
    /// Pictures whose corners fit several poses, and another one than the best fits the other pictures.
    OtherPose,
    /// Something moved during the session; the longer part was taken.
    Moved,
    /// Poses of a flat board from the other of its two sides.
    Flipped,
    /// Rows that contradict all others.
    Outliers,
    /// The camera's lengths are of another scale than the arm's.
    Scale,
    /// The pictures do not determine the lens well, or another one than the arm's poses do.
    Lens,
    /// Further poses would help.
    MissingMoves,
    /// The poses do not fit together.
    Inconsistent,
}

impl FindingKind {
    /// The word in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            FindingKind::Inverted => "inverted",
            FindingKind::Exchanged => "exchanged",
            FindingKind::Repeated => "repeated",
            FindingKind::OtherPose => "other_pose",
            FindingKind::Moved => "moved",
            FindingKind::Flipped => "flipped",
            FindingKind::Outliers => "outliers",
            FindingKind::Scale => "scale",
            FindingKind::Lens => "lens",
            FindingKind::MissingMoves => "missing_moves",
            FindingKind::Inconsistent => "inconsistent",
        }
    }
}

/// Something found, with what to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is about.
    pub kind: FindingKind,
    /// A sentence.
    pub statement: String,
    /// The rows, from 0; empty for all.
    pub rows: Vec<usize>,
}

impl Finding {
    pub(crate) fn new(kind: FindingKind, statement: impl Into<String>, rows: Vec<usize>) -> Self {
        Finding { kind, statement: statement.into(), rows }
    }
}

/// Numbers of rows as people count them, the first of many.
pub(crate) fn listed(rows: &[usize], names: &dyn Fn(usize) -> String) -> String {
    const MOST: usize = 8;
    let words: Vec<String> = rows.iter().take(MOST).map(|row| names(*row)).collect();
    let more = rows.len().saturating_sub(MOST);
    let text = words.join(", ");
    if more > 0 { format!("{text} and {more} more") } else { text }
}

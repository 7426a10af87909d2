//! Findings about the poses: a sentence each.

/// Subject of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FindingKind {
    /// A list is inverted, and was inverted back.
    Inverted,
    /// Camera and target lie as if they were exchanged.
    Exchanged,
    /// Rows that repeat earlier ones, and count once.
    Repeated,
    /// Pictures whose corners fit several poses, and another pose than the best agrees with the other pictures.
    OtherPose,
    /// Camera or target moved during the session; the longer part was taken.
    Moved,
    /// Poses of a flat board from the other of its two sides.
    Flipped,
    /// Rows that contradict all others.
    Outliers,
    /// The scale of the camera's lengths differs from that of the arm's.
    Scale,
    /// The pictures hardly determine the lens, or a different lens than the arm's poses do.
    Lens,
    /// Further poses would help.
    MissingMoves,
    /// The poses do not fit together.
    Inconsistent,
}

impl FindingKind {
    /// Word in files.
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

/// A finding, with a remedy.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Subject.
    pub kind: FindingKind,
    /// A sentence.
    pub statement: String,
    /// Rows, from 0; empty for all.
    pub rows: Vec<usize>,
}

impl Finding {
    pub(crate) fn new(kind: FindingKind, statement: impl Into<String>, rows: Vec<usize>) -> Self {
        Finding { kind, statement: statement.into(), rows }
    }
}

/// Row numbers as in messages, the first of many.
pub(crate) fn list_rows(rows: &[usize], names: &dyn Fn(usize) -> String) -> String {
    const MOST: usize = 8;
    let words: Vec<String> = rows.iter().take(MOST).map(|row| names(*row)).collect();
    let more = rows.len().saturating_sub(MOST);
    let text = words.join(", ");
    if more > 0 { format!("{text} and {more} more") } else { text }
}

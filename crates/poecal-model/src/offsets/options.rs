//! Options of the explanation of offsets.

/// State of one end of the robot in the explanation of a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndConstraint {
    /// Both robots have the same frame there.
    Kept,
    /// The frame is estimated with the offsets.
    Free,
}

impl EndConstraint {
    /// The word used in files and options: `kept` or `free`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            EndConstraint::Kept => "kept",
            EndConstraint::Free => "free",
        }
    }
}

/// Number of configurations in which the tips are compared: the remaining error is within 1 %.
const CONFIGURATIONS: usize = 10_000;

/// Options of [`explain`](super::explain).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OffsetOptions {
    /// Base frame: free if the actual robot's is a choice.
    pub base: EndConstraint,
    /// Tip frame: free if the tool was changed or refitted.
    pub tip: EndConstraint,
    /// Number of random configurations in which the tips are compared.
    pub configurations: usize,
    /// Seed of these.
    pub seed: u64,
}

impl Default for OffsetOptions {
    fn default() -> Self {
        OffsetOptions { base: EndConstraint::Kept, tip: EndConstraint::Kept, configurations: CONFIGURATIONS, seed: 1 }
    }
}

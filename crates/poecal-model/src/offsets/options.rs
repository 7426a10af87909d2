//! Options of the explanation of offsets.

/// State of one end of the robot in the explanation of a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Both robots have the same frame there.
    Kept,
    /// The frame is estimated with the offsets.
    Free,
}

impl End {
    /// The word used in files and options: `kept` or `free`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            End::Kept => "kept",
            End::Free => "free",
        }
    }
}

/// Number of configurations in which the tips are compared: the remaining error is within 1 %.
const CONFIGURATIONS: usize = 10_000;

/// Options of [`explain`](super::explain).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OffsetOptions {
    /// Base frame: free if the actual robot's is a choice.
    pub base: End,
    /// Tip frame: free if the tool was changed or refitted.
    pub tip: End,
    /// Number of random configurations in which the tips are compared.
    pub configurations: usize,
    /// Seed of these.
    pub seed: u64,
}

impl Default for OffsetOptions {
    fn default() -> Self {
        OffsetOptions { base: End::Kept, tip: End::Kept, configurations: CONFIGURATIONS, seed: 1 }
    }
}

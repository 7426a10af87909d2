//! What may move while offsets are explained.

/// Whether one end of the robot may move to explain a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Both robots have the same frame there.
    Kept,
    /// The frame is found with the offsets.
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

/// Configurations in which the tips are compared: what remains is within 1 %.
const CONFIGURATIONS: usize = 10_000;

/// Options of [`explain`](super::explain).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OffsetOptions {
    /// The base frame: free where the actual robot's is a choice.
    pub base: End,
    /// The tip frame: free where the tool was changed or refitted.
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

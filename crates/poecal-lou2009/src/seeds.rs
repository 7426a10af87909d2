//! Seeds of all random numbers, derived from one.

/// Purpose of a stream of random numbers.
#[derive(Clone, Copy)]
pub(super) enum SeedPurpose {
    /// Configurations of the runs.
    Runs,
    /// Noise of the runs.
    RunNoise,
    /// Configurations of the many noisy fits.
    Fits,
    /// Noise of one of these.
    FitNoise,
    /// A random truth.
    Truth,
    /// Configurations of its measurements.
    TruthRows,
}

/// The seed of a stream: other purposes, indices and roots lead to unrelated ones.
pub(super) fn derive_seed(root: u64, purpose: SeedPurpose, index: u64) -> u64 {
    mix(mix(mix(root) ^ purpose as u64) ^ index)
}

/// A step of splitmix64.
fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_those_of_splitmix64() {
        // First outputs of the published generator for the seed 0.
        assert_eq!(mix(0), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix(0x9e37_79b9_7f4a_7c15), 0x6e78_9e6a_a1b9_65f4);
    }

    #[test]
    fn no_two_streams_have_the_same_seed() {
        let purposes = [
            SeedPurpose::Runs,
            SeedPurpose::RunNoise,
            SeedPurpose::Fits,
            SeedPurpose::FitNoise,
            SeedPurpose::Truth,
            SeedPurpose::TruthRows,
        ];
        let mut seeds: Vec<u64> = (0..20)
            .flat_map(|root| purposes.map(|purpose| (root, purpose)))
            .flat_map(|(root, purpose)| (0..100).map(move |index| derive_seed(root, purpose, index)))
            .collect();
        let count = seeds.len();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), count);
    }
}

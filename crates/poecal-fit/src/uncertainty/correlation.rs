//! Unknowns that are determined only together.

/// Correlation from which a pair of unknowns is named.
const NAMED: f64 = 0.95;
/// Largest number of pairs that are named.
const MOST: usize = 20;

/// Correlations of unknowns, `ρ = σᵢⱼ/(σᵢ σⱼ)`, by their blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlations {
    /// For each block and each up to it: the largest size of a correlation between unknowns of the two, 0 to 1.
    pub largest: Vec<Vec<f64>>,
    /// Pairs of unknowns (by index) with a correlation of 0.95 and more, of either sign, the strongest first; at most 20.
    pub pairs: Vec<(usize, usize, f64)>,
    /// Number of such pairs.
    pub count: usize,
}

impl Correlations {
    /// Correlations of a covariance (row-major); `blocks` has the block of each unknown.
    #[must_use]
    pub fn from_covariance(covariance: &[f64], blocks: &[usize]) -> Self {
        let n = blocks.len();
        let variance = |k: usize| covariance.get(k * n + k).copied().unwrap_or(0.0);
        let count = blocks.iter().max().map_or(0, |most| most + 1);
        let mut largest: Vec<Vec<f64>> = (0..count).map(|block| vec![0.0; block + 1]).collect();
        let mut pairs = Vec::new();
        for (i, j) in (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))) {
            let scale = (variance(i) * variance(j)).sqrt();
            let Some(shared) = covariance.get(i * n + j).filter(|_| scale > 0.0) else { continue };
            let found = (shared / scale).clamp(-1.0, 1.0);
            let (a, b) = (blocks[i].max(blocks[j]), blocks[i].min(blocks[j]));
            largest[a][b] = largest[a][b].max(found.abs());
            if found.abs() >= NAMED {
                pairs.push((i, j, found));
            }
        }
        pairs.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()).then((a.0, a.1).cmp(&(b.0, b.1))));
        let count = pairs.len();
        pairs.truncate(MOST);
        Correlations { largest, pairs, count }
    }
}

#[cfg(test)]
mod tests {
    use super::Correlations;

    #[test]
    fn what_is_known_only_together_is_a_pair() {
        let found = Correlations::from_covariance(&[4.0, 1.94, 1.94, 1.0], &[0, 1]);
        assert_eq!((found.pairs[0].0, found.pairs[0].1, found.count), (0, 1, 1));
        assert!((found.largest[1][0] - 0.97).abs() < 1e-12);
    }
}

//! Clusters of neighbouring configurations: a test for errors that neighbours share, which are not noise.

use nalgebra::DMatrix;

use super::factor;
use super::view::FitView;
use poecal_model::measurement::MANY_ROWS;
use poecal_numerics::linalg;
use poecal_numerics::solve::{LeastSquares, NormalEquations};

/// Significance of a figure: standard deviations beyond its mean in white noise.
pub(crate) const SIGNIFICANT: f64 = 3.0;
/// Largest number of clusters.
const CLUSTERS: usize = 16;

/// `Σ gᵀ H⁻¹ g` over clusters, with the gradient g of a cluster's rows, over its expectation in white noise: the cluster-robust covariance
/// over the ordinary one, averaged over all directions (liang1986, theory.md §9 (41)). `None` if it is not significant.
pub(crate) fn inflation(
    view: &FitView<'_>,
    whole: &NormalEquations,
    clusters: impl Fn(&FitView<'_>, usize) -> Vec<Vec<u32>>,
) -> Option<f64> {
    let n = whole.dim();
    if n == 0 || whole.residuals < 2 * n {
        return None;
    }
    let variance = view.variance;
    let factor = factor(&whole.gram, n, view.prior, variance)?;
    let inverse = DMatrix::from_vec(n, n, linalg::inverse(&factor));
    let count = (whole.residuals / n).clamp(2, CLUSTERS);
    let (mut found, mut expected, mut spread) = (0.0, 0.0, 0.0);
    for cluster in clusters(view, count) {
        let part = view.problem(cluster).normal(view.estimate);
        let solved = linalg::cholesky_solve(&factor, &part.gradient);
        found += solved.iter().zip(&part.gradient).map(|(a, b)| a * b).sum::<f64>();
        let (mean, square) = share_of(&inverse, &part.gram);
        expected += mean * variance;
        spread += 2.0 * square * variance * variance;
    }
    let ratio = found / expected;
    (ratio.is_finite() && ratio > 1.0 + SIGNIFICANT * spread.sqrt() / expected).then_some(ratio)
}

/// `tr(D)` and `tr(D²)` of `D = H_c - H_c²` with the `H_c = H⁻¹ N_c` of theory.md §9 (41), from the inverse of H and the upper triangle of
/// `N_c` (row-major). They are the mean and half the variance of `gᵀ H⁻¹ g` of a cluster with information `N_c`, in white noise of
/// variance 1.
fn share_of(inverse: &DMatrix<f64>, part: &[f64]) -> (f64, f64) {
    let n = inverse.nrows();
    let h = inverse * DMatrix::from_fn(n, n, |i, j| part[i.min(j) * n + i.max(j)]);
    let d = &h - &h * &h;
    (d.trace(), d.dot(&d.transpose()))
}

/// About `count` clusters: rows are halved at the median of the joint that moves most in them, rows of one configuration together.
pub(crate) fn clusters(view: &FitView<'_>, count: usize) -> Vec<Vec<u32>> {
    let spans = view.spans(view.rows);
    let is_many = view.rows.len() > MANY_ROWS;
    let configurations = if is_many { Vec::new() } else { view.session.data.configurations(view.rows) };
    let whole =
        if is_many { view.rows.chunks(1).collect() } else { configurations.iter().map(Vec::as_slice).collect() };
    let mut clusters: Vec<Vec<&[u32]>> = vec![whole];
    while clusters.len() < count {
        // The largest is split; of equal ones the first, so that the order is defined.
        let Some(largest) = (0..clusters.len()).max_by_key(|&k| (clusters[k].len(), usize::MAX - k)) else {
            break;
        };
        if clusters[largest].len() < 2 {
            break;
        }
        let first = clusters.swap_remove(largest);
        let here = view.spans(&first.iter().map(|rows| rows[0]).collect::<Vec<u32>>());
        let share = |joint: usize| if spans[joint] > 0.0 { here[joint] / spans[joint] } else { 0.0 };
        let widest = (0..here.len()).max_by(|&a, &b| share(a).total_cmp(&share(b)).then(b.cmp(&a))).unwrap_or(0);
        let middle = first.len() / 2;
        let mut values: Vec<(f64, &[u32])> = first.iter().map(|&rows| (view.values(rows[0])[widest], rows)).collect();
        values.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(b.1)));
        let (low, high) = values.split_at(middle);
        clusters.extend([low, high].map(|half| half.iter().map(|&(_, rows)| rows).collect()));
    }
    let mut clusters: Vec<Vec<u32>> = clusters.into_iter().map(|rows| rows.concat()).collect();
    clusters.iter_mut().for_each(|cluster| cluster.sort_unstable());
    clusters
}

/// About `count` clusters of consecutive rows, in the order of the data.
pub(crate) fn in_order(view: &FitView<'_>, count: usize) -> Vec<Vec<u32>> {
    let mut rows = view.rows.to_vec();
    rows.sort_unstable();
    rows.chunks(rows.len().div_ceil(count.max(1)).max(1)).map(<[u32]>::to_vec).collect()
}

//! Sizes of the terms' priors, by cross-validation from shared information (theory.md §6, *Corrections*).

use super::{CorrectionModel, Sizes, TermGroup};
use crate::calibration::fit::Task;
use crate::estimate::Estimate;
use crate::linalg;
use crate::measurement::Noise;
use crate::parameters::{Parameter, Subject};
use crate::problem::Problem;
use crate::solve::{LeastSquares, Normal};
use crate::threads;

/// Sizes that are tried, radians; those of moments reach farther.
const OF_MOMENTS: &[f64] = &[0.0, 3e-4, 1e-3, 3e-3, 1e-2];
const OF_VALUES: &[f64] = &[0.0, 3e-5, 1e-4, 3e-4, 1e-3];
/// Groups whose sizes are chosen in turn; those of gravity are of one size.
const CHOSEN: [(&[TermGroup], &[f64]); 4] = [
    (&[TermGroup::Sag, TermGroup::Tilt], OF_MOMENTS),
    (&[TermGroup::Ratio], OF_VALUES),
    (&[TermGroup::Harmonics], OF_VALUES),
    (&[TermGroup::Wobble], OF_VALUES),
];
/// Rounds of choosing each group's size in turn.
const SWEEPS: usize = 2;
/// Weight of the squared distance of a size from the common one, in decades: the prior of the choice.
const PULL: f64 = 0.1;
/// What leaving a group out counts at most, and what taking in one counts that is commonly left out.
const LEFT_OUT: f64 = 0.1;
const TAKEN_IN: f64 = 0.02;
/// What geometry alone may lose and is taken still.
const GEOMETRY: f64 = 0.03;
/// Fewest configurations from which sizes are chosen.
const FEWEST: usize = 8;
/// Rounding of the information that elimination leaves, as a share of the largest.
const ROUNDING: f64 = 1e-13;
/// Configurations of which the information of all counts half: what rows share beyond the terms does not average out.
pub(super) const HALF: f64 = 500.0;

/// Sizes that were tried.
///
/// ```
/// use poecal::calibration::{Sizes, TriedSizes};
/// let tried = TriedSizes { sizes: Sizes::COMMON, left_out: -0.1, score: -0.1 };
/// assert_eq!(tried.left_out, tried.score);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriedSizes {
    /// The sizes.
    pub sizes: Sizes,
    /// Mean over the parts that were left out of the logarithm of their mean squared whitened residual.
    pub left_out: f64,
    /// The same with the prior of the choice: less is better.
    pub score: f64,
}

/// The choice, and all that was tried.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    pub(crate) sizes: Sizes,
    pub(crate) tried: Vec<TriedSizes>,
}

/// Chooses sizes by leaving parts of the rows out; the common ones where nothing can be left out, none of very few configurations.
/// `estimate` is a fit with all groups.
pub(crate) fn choose(
    task: &Task<'_>,
    model: &CorrectionModel,
    (estimate, noise): (&Estimate, Noise),
    (sample, parts): &(Vec<u32>, Vec<Vec<u32>>),
) -> Choice {
    let configurations = task.session.data.configurations(sample).len();
    if configurations < FEWEST {
        return Choice { sizes: Sizes::NONE, tried: Vec::new() };
    }
    let Some(shared) = Shared::new(task, model, estimate, noise, sample, parts) else {
        return Choice { sizes: Sizes::COMMON, tried: Vec::new() };
    };
    let few = 1.0 / configurations as f64;
    let mut tried: Vec<TriedSizes> = Vec::new();
    let mut score = |sizes: Sizes| match tried.iter().find(|it| it.sizes == sizes) {
        Some(known) => *known,
        None => {
            let left_out = shared.left_out(&sizes);
            tried.push(TriedSizes { sizes, left_out, score: left_out + distance(&sizes, 6.0 * few) });
            tried[tried.len() - 1]
        }
    };
    let common = score(Sizes::COMMON);
    let mut best = common;
    for _ in 0..SWEEPS {
        let before = best.sizes;
        for (groups, sizes) in CHOSEN {
            for &size in sizes {
                let mut other = best.sizes;
                groups.iter().for_each(|&group| other[group] = size);
                let found = score(other);
                if found.score < best.score {
                    best = found;
                }
            }
        }
        if best.sizes == before {
            break;
        }
    }
    let geometry = score(Sizes::NONE);
    // Terms that visibly harm where nothing is to be found, and are not missed. Measurements without noise leave nothing to choose by.
    let loses_little = geometry.left_out <= best.left_out + GEOMETRY.max(1.5 * few);
    let is_harmed = common.left_out > geometry.left_out + 3.0 * few;
    if best.score.is_finite() && loses_little && is_harmed {
        best = geometry;
    }
    Choice { sizes: best.sizes, tried }
}

/// Information of the terms with all other unknowns eliminated, of each part that is left out.
struct Shared {
    parts: Vec<LeftOutPart>,
    /// Of each term: its group, its share of the group's variance, its coefficient, and its scale.
    terms: Vec<TermUnknown>,
}

#[derive(Clone, Copy)]
struct TermUnknown {
    group: TermGroup,
    share: f64,
    coefficient: f64,
    scale: f64,
}

/// Quadratic forms of the terms' steps: the fit of the other rows, `½ tᵀSt - sᵀt`, and the squared residuals of the part, with its device
/// frames fitted, `c - bᵀt + ½ tᵀQt`.
struct LeftOutPart {
    information: Vec<f64>,
    pull: Vec<f64>,
    cost: f64,
    gradient: Vec<f64>,
    gram: Vec<f64>,
    numbers: usize,
}

impl Shared {
    fn new(
        task: &Task<'_>,
        model: &CorrectionModel,
        estimate: &Estimate,
        noise: Noise,
        sample: &[u32],
        parts: &[Vec<u32>],
    ) -> Option<Self> {
        let free = task.free(estimate);
        let information = |rows: &[u32]| -> Normal {
            let problem = Problem::new(task.session, rows.to_vec(), free.clone(), noise);
            match task.weights {
                Some(weights) => problem.with_weights(weights).normal(estimate),
                None => problem.normal(estimate),
            }
        };
        let layout = Problem::new(task.session, Vec::new(), free.clone(), noise).layout().clone();
        let n = layout.dim();
        let (mut known, mut devices, mut own, mut terms) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let priors: Vec<_> = model.terms().zip(model.groups.iter().zip(model.shares())).collect();
        for (parameter, places) in layout.parameters() {
            let at = |(place, _): &(usize, f64)| *place;
            let group = match parameter {
                Parameter::ValueTerm(it) => priors.iter().find(|(of, _)| *of == (it.joint, it.term)),
                Parameter::ScrewAxis(_)
                | Parameter::OtherScrew(_)
                | Parameter::TargetPlace(_)
                | Parameter::TargetFrame(_)
                | Parameter::DeviceFrame(_) => None,
            };
            if let (Some(((joint, term), (group, share))), Some(&(place, scale))) = (group, places.first()) {
                own.push(place);
                let coefficient = estimate.coefficient(*joint, *term);
                terms.push(TermUnknown { group: **group, share: *share, coefficient, scale });
                continue;
            }
            if matches!(parameter.model().subject(), Subject::Instrument(_)) {
                devices.extend(places.iter().map(at));
            }
            known.extend(places.iter().map(at));
        }
        let mut all = information(sample);
        let deflation = 1.0 / (1.0 + task.session.data.configurations(sample).len() as f64 / HALF);
        let of_prior = |normal: &mut Normal| {
            if let Some((prior, weight)) = task.prior {
                prior.clone().without_terms().add(estimate, &layout, weight / deflation, normal);
            }
        };
        all.cost = 0.0;
        let each = threads::map_parts(parts.len(), |at| {
            let part = information(parts.get(at)?);
            let mut rest = all.clone();
            rest.gram.iter_mut().zip(&part.gram).for_each(|(all, part)| *all -= part);
            rest.gradient.iter_mut().zip(&part.gradient).for_each(|(all, part)| *all -= part);
            of_prior(&mut rest);
            let found = reduced(n, (&known, &own, &devices), &rest, &part)?;
            Some(LeftOutPart {
                information: found.information.iter().map(|it| it * deflation).collect(),
                pull: found.pull.iter().map(|it| it * deflation).collect(),
                ..found
            })
        });
        let parts: Vec<LeftOutPart> = each.into_iter().flatten().collect();
        (!parts.is_empty()).then_some(Shared { parts, terms })
    }

    /// Mean over the parts of the logarithm of their mean squared residual.
    fn left_out(&self, sizes: &Sizes) -> f64 {
        let logs = threads::map_parts(self.parts.len(), |at| {
            let part = self.parts.get(at)?;
            let square = 2.0 * part.cost_without(&self.terms, sizes)? / part.numbers.max(1) as f64;
            Some(square.max(f64::MIN_POSITIVE).ln())
        });
        let count = logs.len() as f64;
        // A system that is not positive definite is no choice.
        logs.into_iter().sum::<Option<f64>>().map_or(f64::INFINITY, |sum| sum / count)
    }
}

/// Prior of the choice.
fn distance(sizes: &Sizes, of_none: f64) -> f64 {
    let of = |group: TermGroup| match (sizes[group], Sizes::COMMON[group]) {
        (0.0, 0.0) => 0.0,
        (0.0, _) => PULL * LEFT_OUT.min(of_none),
        (size, 0.0) => TAKEN_IN + PULL * (size / Sizes::ALL[group]).log10().powi(2),
        (size, common) => PULL * (size / common).log10().powi(2),
    };
    TermGroup::ALL.into_iter().map(of).sum()
}

impl LeftOutPart {
    /// Half the squared residuals of the part by the fit of the other rows with these sizes.
    fn cost_without(&self, terms: &[TermUnknown], sizes: &Sizes) -> Option<f64> {
        let n = terms.len();
        let is_used = |&at: &usize| sizes[terms[at].group] > 0.0;
        let used: Vec<usize> = (0..n).filter(is_used).collect();
        let m = used.len();
        // A term that is left out steps back to zero.
        let mut step: Vec<f64> = terms.iter().map(|it| -it.coefficient * it.scale).collect();
        used.iter().for_each(|&at| step[at] = 0.0);
        if m > 0 {
            // In units of the sizes, so that the prior is 1.
            let unit: Vec<f64> = used
                .iter()
                .map(|&at| sizes[terms[at].group] * terms[at].share.sqrt() * terms[at].scale)
                .collect();
            let (mut gram, mut right) = (vec![0.0; m * m], Vec::with_capacity(m));
            for (i, &a) in used.iter().enumerate() {
                let row = &self.information[a * n..(a + 1) * n];
                for (j, &b) in used.iter().enumerate().skip(i) {
                    gram[i * m + j] = unit[i] * unit[j] * row[b];
                }
                let others = linalg::dot(row, &step);
                right.push(
                    unit[i] * (self.pull[a] - others) - terms[a].coefficient * terms[a].scale / unit[i],
                );
            }
            let largest = gram.iter().step_by(m + 1).fold(0.0, |largest: f64, it| largest.max(*it));
            let factor = linalg::cholesky(&gram, m, 1.0 + ROUNDING * largest)?;
            let found =
                linalg::cholesky_solve(&factor, &right).into_iter().zip(&unit).map(|(it, unit)| it * unit);
            used.iter().zip(found).for_each(|(&at, found)| step[at] = found);
        }
        let quadratic: f64 = self
            .gram
            .chunks_exact(n)
            .zip(&step)
            .map(|(row, own)| own * row.iter().zip(&step).map(|(gram, step)| gram * step).sum::<f64>())
            .sum();
        let linear: f64 = self.gradient.iter().zip(&step).map(|(gradient, step)| gradient * step).sum();
        Some((self.cost - linear + 0.5 * quadratic).max(0.0))
    }
}

/// Eliminates all unknowns but the terms: `rest` by its optimum, and `part` at that optimum, with the device frames fitted to it.
fn reduced(
    n: usize,
    (known, own, devices): (&[usize], &[usize], &[usize]),
    rest: &Normal,
    part: &Normal,
) -> Option<LeftOutPart> {
    let of = |normal: &Normal, a: usize, b: usize| normal.gram[a.min(b) * n + a.max(b)];
    let (k, m) = (known.len(), own.len());
    let mut gram = vec![0.0; k * k];
    for (i, &a) in known.iter().enumerate() {
        for (j, &b) in known.iter().enumerate().skip(i) {
            gram[i * k + j] = of(rest, a, b);
        }
    }
    let largest = gram.iter().step_by(k + 1).fold(0.0, |largest: f64, it| largest.max(*it));
    let factor = linalg::cholesky(&gram, k, 1e-3 * ROUNDING * largest)?;
    // How the other unknowns follow each term, `W = G⁻¹ C`, and where they are without: `u = G⁻¹ g`.
    let follow: Vec<Vec<f64>> = own
        .iter()
        .map(|&b| linalg::cholesky_solve(&factor, &known.iter().map(|&a| of(rest, a, b)).collect::<Vec<_>>()))
        .collect();
    let still = linalg::cholesky_solve(&factor, &known.iter().map(|&a| rest.gradient[a]).collect::<Vec<_>>());
    let (mut information, mut pull) = (vec![0.0; m * m], vec![0.0; m]);
    for (i, &a) in own.iter().enumerate() {
        let column: Vec<f64> = known.iter().map(|&it| of(rest, it, a)).collect();
        for j in i..m {
            let found = of(rest, a, own[j]) - linalg::dot(&column, &follow[j]);
            (information[i * m + j], information[j * m + i]) = (found, found);
        }
        pull[i] = rest.gradient[a] - linalg::dot(&column, &still);
    }
    // Of the part, the device frames are fitted.
    let d = devices.len();
    let mut frame = vec![0.0; d * d];
    for (i, &a) in devices.iter().enumerate() {
        for (j, &b) in devices.iter().enumerate().skip(i) {
            frame[i * d + j] = of(part, a, b);
        }
    }
    let least = 1e-9 * (0..d).map(|i| frame[i * d + i]).fold(0.0, f64::max);
    let frame = if d > 0 { Some(linalg::cholesky(&frame, d, least)?) } else { None };
    // Columns of the part along each term with its followers, and along the step `still`.
    let dense: Vec<f64> = (0..n * n).map(|at| of(part, at / n, at % n)).collect();
    let times = |x: &[f64]| -> Vec<f64> { dense.chunks_exact(n).map(|row| linalg::dot(row, x)).collect() };
    let spread = |of_known: &[f64], sign: f64, term: Option<usize>| {
        let mut x = vec![0.0; n];
        known.iter().zip(of_known).for_each(|(&at, value)| x[at] = sign * value);
        if let Some(at) = term {
            x[at] = 1.0;
        }
        x
    };
    let columns: Vec<Vec<f64>> =
        own.iter().zip(&follow).map(|(&at, follow)| spread(follow, -1.0, Some(at))).collect();
    let products: Vec<Vec<f64>> = columns.iter().map(|column| times(column)).collect();
    let start = spread(&still, 1.0, None);
    let moved = times(&start);
    let gradient: Vec<f64> =
        part.gradient.iter().zip(&moved).map(|(gradient, moved)| gradient - moved).collect();
    let mut cost = part.cost - linalg::dot(&part.gradient, &start) + 0.5 * linalg::dot(&start, &moved);
    let on_frame = |x: &[f64]| -> Vec<f64> { devices.iter().map(|&at| x[at]).collect() };
    let fitted = |x: &[f64]| {
        frame.as_ref().map_or_else(Vec::new, |factor| linalg::cholesky_solve(factor, &on_frame(x)))
    };
    let by_frame: Vec<Vec<f64>> = products.iter().map(|it| fitted(it)).collect();
    let of_start = fitted(&gradient);
    cost -= 0.5 * linalg::dot(&on_frame(&gradient), &of_start);
    let mut left = LeftOutPart {
        information,
        pull,
        cost,
        gradient: vec![0.0; m],
        gram: vec![0.0; m * m],
        numbers: part.residuals,
    };
    for i in 0..m {
        left.gradient[i] =
            linalg::dot(&columns[i], &gradient) - linalg::dot(&on_frame(&products[i]), &of_start);
        let own_frame = on_frame(&products[i]);
        for j in i..m {
            let found = linalg::dot(&columns[i], &products[j]) - linalg::dot(&own_frame, &by_frame[j]);
            (left.gram[i * m + j], left.gram[j * m + i]) = (found, found);
        }
    }
    Some(left)
}

//! Pictures of a test of ISO 9283: the cube with its errors as arrows, and the scatter at each pose.

use maud::Markup;
use nalgebra::Vector3;

use super::super::html::plots;
use super::super::sides::{SideView, views};
use crate::plot::ArmSeries;
use poecal_calibrate::{FigureName, Iso9283, PoseCluster};

/// Enlargements of errors, and the share of the cube that the longest arrow may take.
const ENLARGED: [f64; 4] = [100.0, 10.0, 1.0, 0.1];
const LONGEST: f64 = 0.5;
/// Share of the cube's half side at which poses are (clause 6.8.3).
const INSIDE: f64 = 0.8;
/// Number of line segments that approximate a circle.
const RIM: usize = 48;
/// Length of an arrow's head, and the tangent of half its angle.
const HEAD: f64 = 0.25;
const SLANT: f64 = 0.4;

/// The cube from two sides, with the error of each barycentre enlarged: measured, before, and predicted for corrected commands.
pub(crate) fn cube(found: &Iso9283, before: Option<&Iso9283>) -> Markup {
    let places: Vec<Vector3<f64>> = found.clusters.iter().map(|it| 1e3 * it.commanded_m).collect();
    let (low, high) = corners(&places);
    let [measured, earlier] = [Some(found), before].map(|it| it.map(errors).unwrap_or_default());
    let predicted: Vec<PlacedError> = before
        .unwrap_or(found)
        .clusters
        .iter()
        .filter_map(|it| Some((1e3 * it.commanded_m, 1e3 * it.corrected_m?)))
        .collect();
    let longest = measured.iter().chain(&earlier).chain(&predicted).map(|it| it.1.norm()).fold(0.0, f64::max);
    let most = LONGEST * (high - low).max();
    let factor = ENLARGED.into_iter().find(|it| it * longest <= most).unwrap_or(ENLARGED[3]);
    let series = [("measured", 0, &measured), ("before", 1, &earlier), ("predicted", 2, &predicted)];
    let drawn = |view: &SideView| {
        let flat = |at: &Vector3<f64>| view.project(at);
        let points = places.iter().map(flat).collect();
        let labels = found.clusters.iter().map(|it| it.pose.clone()).collect();
        let box_lines = outline(flat(&low), flat(&high));
        let cube = ArmSeries { name: "poses".to_owned(), style: 3, lines: box_lines, is_thin: true, points, labels };
        let arrows = |(name, style, errors): (&str, usize, &Vec<PlacedError>)| {
            let own = errors.iter().flat_map(|(at, error)| arrow(flat(at), flat(&(at + factor * error))));
            ArmSeries { name: name.to_owned(), style, lines: own.collect(), ..ArmSeries::default() }
        };
        let own = series.into_iter().filter(|it| !it.2.is_empty()).map(arrows);
        std::iter::once(cube).chain(own).collect()
    };
    let what = "the box about the poses, and the error of each barycentre as an arrow";
    let caption = format!(
        "Arrows: from the commanded position to the barycentre, {factor} times as long. The box has the poses of ISO 9283 at 10 % of its diagonal from its \
         vertices."
    );
    plots(&views("Accuracy", what, "mm", drawn), caption)
}

/// A commanded position and an error there, millimetres.
type PlacedError = (Vector3<f64>, Vector3<f64>);

/// Commanded positions with errors of barycentres.
fn errors(of: &Iso9283) -> Vec<PlacedError> {
    of.clusters.iter().map(|it| (1e3 * it.commanded_m, 1e3 * it.barycentre_m())).collect()
}

/// Two opposite vertices of the box whose poses these are.
fn corners(places: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let first = places.first().copied().unwrap_or_default();
    let low = places.iter().fold(first, |a, b| a.inf(b));
    let high = places.iter().fold(first, |a, b| a.sup(b));
    let (middle, half) = (0.5 * (low + high), 0.5 / INSIDE * (high - low));
    (middle - half, middle + half)
}

/// The four sides of a box.
fn outline(low: [f64; 2], high: [f64; 2]) -> Vec<[[f64; 2]; 2]> {
    let around = [low, [high[0], low[1]], high, [low[0], high[1]]];
    (0..4).map(|k| [around[k], around[(k + 1) % 4]]).collect()
}

/// A shaft with its head.
fn arrow(from: [f64; 2], to: [f64; 2]) -> Vec<[[f64; 2]; 2]> {
    let [across, up] = [HEAD * (to[0] - from[0]), HEAD * (to[1] - from[1])];
    let side = |sign: f64| [to[0] - across - sign * SLANT * up, to[1] - up + sign * SLANT * across];
    vec![[from, to], [to, side(1.0)], [to, side(-1.0)]]
}

/// Measured positions about the barycentre of each pose from two sides, with their ellipses and the sphere of RP.
pub(crate) fn scatter(found: &Iso9283, before: Option<&Iso9283>) -> Markup {
    let earlier = |own: &PoseCluster| before?.clusters.iter().find(|it| it.pose == own.pose);
    let all: Vec<Markup> = found
        .clusters
        .iter()
        .flat_map(|own| {
            let drawn = |view: &SideView| {
                let now = cloud("measured", 0, own, view, true);
                let then = earlier(own).map(|it| cloud("before", 1, it, view, false));
                std::iter::once(now).chain(then).chain(sphere(found, &own.pose)).collect()
            };
            views(
                &own.pose,
                "measured positions about their barycentre, their ellipse, and the circle of RP",
                "mm",
                drawn,
            )
        })
        .collect();
    let lines = if before.is_some() { " The other ellipse is that of the test before." } else { "" };
    let caption = format!(
        "Dots: measured positions, less the barycentre of their pose. Ellipse: the next cycle lies in it with 95 % probability, if positions are normally \
         distributed. Circle: RP.{lines}"
    );
    plots(&all, caption)
}

/// Positions of a pose less their barycentre, millimetres, with their ellipse.
fn cloud(name: &str, style: usize, of: &PoseCluster, view: &SideView, has_points: bool) -> ArmSeries {
    let middle = view.project(&of.barycentre_m());
    let less = |[a, b]: [f64; 2]| [1e3 * (a - middle[0]), 1e3 * (b - middle[1])];
    let rim: Vec<[f64; 2]> = of.ellipse_m(view.axes).into_iter().map(less).collect();
    let lines = rim.iter().zip(rim.iter().skip(1)).map(|(a, b)| [*a, *b]).collect();
    let points = of.errors_m.iter().filter(|_| has_points).map(|it| less(view.project(it))).collect();
    ArmSeries { name: name.to_owned(), style, lines, points, ..ArmSeries::default() }
}

/// The sphere about the barycentre whose radius is RP, millimetres.
fn sphere(found: &Iso9283, pose: &str) -> Option<ArmSeries> {
    let radius = 1e3 * found.of_name(FigureName::Rp, false).find(|it| it.pose == pose)?.measured.found;
    let rim = |k: usize| {
        let (s, c) = (std::f64::consts::TAU * k as f64 / RIM as f64).sin_cos();
        [radius * c, radius * s]
    };
    let lines = (0..RIM).map(|k| [rim(k), rim(k + 1)]).collect();
    Some(ArmSeries { name: "RP".to_owned(), style: 3, lines, is_thin: true, ..ArmSeries::default() })
}

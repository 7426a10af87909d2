//! Markers on one body, identified by the constant distances between them: exchanged names, and markers without a name.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use poecal_numerics::distributions::median;

/// Position of each marker in a frame, metres; `None` if it was not seen.
pub type MarkerPositions = Vec<Option<Vector3<f64>>>;

/// Fewest markers that their distances identify.
pub const FEWEST_MARKERS: usize = 3;
/// Largest number of markers of a body, and of positions in a frame: the search is among all orders of them.
const MOST: usize = 12;
const MOST_PLACES: usize = 24;
/// Largest number of frames from which distances are taken, and fewest in which two markers were seen together.
const SOME: usize = 600;
const TOGETHER: usize = 10;
/// Share of the frames in which a distance is the usual one.
const SHARE: f64 = 0.6;
/// Largest deviation of a distance from the usual one: times its scatter, and at least and at most, metres.
const TIMES: f64 = 5.0;
const LEAST_M: f64 = 5e-4;
const MOST_M: f64 = 5e-3;
/// Median deviation of normal noise, in standard deviations.
const MEDIAN_DEVIATION: f64 = 0.6745;
/// Fewest markers that identify one without a name: two distances.
const WITNESSES: usize = 2;

/// Markers of one body.
#[derive(Clone, Debug)]
struct MarkerGroup {
    markers: Vec<usize>,
    /// For each pair, the usual distance and its largest deviation.
    usual: Vec<Vec<(f64, f64)>>,
}

/// Markers identified by the distances between them, by frame.
#[derive(Clone, Debug, Default)]
pub struct RenamedMarkers {
    /// For a frame with wrong names, the column at whose position each marker of the body is, if there is one.
    pub frames: BTreeMap<usize, BTreeMap<usize, Option<usize>>>,
    /// Markers of the body.
    pub markers: Vec<usize>,
}

impl MarkerGroup {
    /// The largest group of some columns that keep their distances.
    fn from_columns(frames: &[MarkerPositions], columns: &[usize]) -> Option<Self> {
        let step = frames.len().div_ceil(SOME).max(1);
        let distances = |a: usize, b: usize| -> Vec<f64> {
            let apart = |frame: &MarkerPositions| Some(((*frame.get(a)?)? - (*frame.get(b)?)?).norm());
            frames.iter().step_by(step).filter_map(apart).collect()
        };
        let usual = |a: usize, b: usize| {
            let all = distances(a, b);
            let middle = median(all.iter().copied()).filter(|_| all.len() >= TOGETHER)?;
            let scatter = median(all.iter().map(|it| (it - middle).abs()))? / MEDIAN_DEVIATION;
            let off = (TIMES * scatter).clamp(LEAST_M, MOST_M);
            let near = all.iter().filter(|it| (**it - middle).abs() <= off).count();
            (near as f64 >= SHARE * all.len() as f64).then_some((middle, off))
        };
        let seen = |column: usize| frames.iter().filter(|it| it.get(column).is_some_and(Option::is_some)).count();
        let mut columns: Vec<usize> = columns.to_vec();
        columns.sort_by_key(|it| (std::cmp::Reverse(seen(*it)), *it));
        let known: BTreeMap<(usize, usize), (f64, f64)> = (columns.iter().enumerate())
            .flat_map(|(at, a)| columns.iter().skip(at + 1).map(move |b| (*a, *b)))
            .filter_map(|(a, b)| Some(((a, b), usual(a, b)?)))
            .collect();
        let of = |a: usize, b: usize| known.get(&(a, b)).or_else(|| known.get(&(b, a))).copied();
        let grown = |first: &usize| {
            let mut group = vec![*first];
            for column in &columns {
                let fits = group.iter().all(|it| it != column && of(*it, *column).is_some());
                if fits && group.len() < MOST {
                    group.push(*column);
                }
            }
            group
        };
        let groups: Vec<Vec<usize>> = columns.iter().map(grown).collect();
        let largest = groups.iter().map(Vec::len).max().filter(|it| *it >= FEWEST_MARKERS)?;
        let mut markers = groups.into_iter().find(|it| it.len() == largest)?;
        markers.sort_unstable();
        let row = |a: &usize| markers.iter().map(|b| of(*a, *b).unwrap_or_default()).collect();
        let usual = markers.iter().map(row).collect();
        Some(MarkerGroup { markers, usual })
    }

    /// True if two positions may be those of two markers, by their numbers in the group.
    fn fits(&self, (a, at): (usize, Vector3<f64>), (b, other): (usize, Vector3<f64>)) -> bool {
        let usual = self.usual.get(a).and_then(|it| it.get(b));
        usual.is_some_and(|(usual, off)| ((at - other).norm() - usual).abs() <= *off)
    }

    /// Column of each marker's position, if the distances decide it; `None` if all names are right.
    fn sorted(&self, frame: &MarkerPositions, others: &[usize]) -> Option<Vec<Option<usize>>> {
        let place = |column: usize| *frame.get(column)?;
        let own: Vec<(usize, usize)> =
            self.markers.iter().copied().enumerate().filter(|it| place(it.1).is_some()).collect();
        let is_right = own.iter().enumerate().all(|(k, one)| {
            own.iter().take(k).all(|other| match (place(one.1), place(other.1)) {
                (Some(at), Some(other_at)) => self.fits((one.0, at), (other.0, other_at)),
                _ => true,
            })
        });
        let unnamed: Vec<usize> = others.iter().copied().filter(|it| place(*it).is_some()).collect();
        let is_whole = own.len() == self.markers.len();
        if is_right && (is_whole || unnamed.is_empty() || own.len() < WITNESSES) {
            return None;
        }
        let places: Vec<(usize, Vector3<f64>)> = (own.iter().map(|it| it.1).chain(unnamed))
            .filter_map(|column| Some((column, place(column)?)))
            .take(MOST_PLACES)
            .collect();
        let mut search =
            MarkerSearch { group: self, places: &places, taken: Vec::new(), best: None, count: 0, is_unclear: false };
        search.next();
        let found = search.best.filter(|_| search.count >= FEWEST_MARKERS && !search.is_unclear);
        if is_right {
            // Without a found marker there is no wrong name.
            let named: Vec<Option<usize>> = self.markers.iter().map(|it| place(*it).is_some().then_some(*it)).collect();
            return found.filter(|it| {
                *it != named && named.iter().zip(it).all(|(named, found)| named.is_none() || named == found)
            });
        }
        Some(found.unwrap_or_else(|| vec![None; self.markers.len()]))
    }
}

/// A search for the positions of markers.
struct MarkerSearch<'g> {
    group: &'g MarkerGroup,
    /// Columns and positions.
    places: &'g [(usize, Vector3<f64>)],
    /// Column and position of each marker so far.
    taken: Vec<Option<(usize, Vector3<f64>)>>,
    /// Columns of the largest number of markers, their number, and whether others are as good.
    best: Option<Vec<Option<usize>>>,
    count: usize,
    is_unclear: bool,
}

impl MarkerSearch<'_> {
    /// Assigns the next marker to each possible position, or to none.
    fn next(&mut self) {
        let marker = self.taken.len();
        let count = self.taken.iter().flatten().count();
        let left = self.group.markers.len() - marker;
        if count + left < self.count {
            return;
        }
        if left == 0 {
            self.is_unclear = self.best.is_some() && count == self.count;
            if !self.is_unclear {
                self.best = Some(self.taken.iter().map(|it| it.map(|it| it.0)).collect());
                self.count = count;
            }
            return;
        }
        let may_be = |taken: &[Option<(usize, Vector3<f64>)>], (column, place): (usize, Vector3<f64>)| {
            taken.iter().enumerate().all(|(other, it)| {
                it.is_none_or(|it| it.0 != column && self.group.fits((marker, place), (other, it.1)))
            })
        };
        let possible: Vec<_> = self.places.iter().copied().filter(|it| may_be(&self.taken, *it)).collect();
        for place in possible.into_iter().map(Some).chain([None]) {
            self.taken.push(place);
            self.next();
            self.taken.pop();
        }
    }
}

impl RenamedMarkers {
    /// Markers in some columns of one body, identified by their distances; the positions of `others` may be theirs too. `None` if no three of
    /// them keep their distances.
    #[must_use]
    pub fn from_frames(frames: &[MarkerPositions], columns: &[usize], others: &[usize]) -> Option<Self> {
        let group = MarkerGroup::from_columns(frames, columns)?;
        let others: Vec<usize> = others.iter().copied().filter(|it| !group.markers.contains(it)).collect();
        let mut found = RenamedMarkers { markers: group.markers.clone(), ..RenamedMarkers::default() };
        for (at, frame) in frames.iter().enumerate() {
            let Some(sorted) = group.sorted(frame, &others) else { continue };
            found.frames.insert(at, group.markers.iter().copied().zip(sorted).collect());
        }
        Some(found)
    }

    /// Column at whose position a marker is in a frame.
    #[must_use]
    pub fn place_of(&self, frame: usize, column: usize) -> Option<usize> {
        self.frames.get(&frame).and_then(|it| it.get(&column)).copied().unwrap_or(Some(column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_arm::lie::rotation;

    /// A body that turns and moves: its markers with noise, in frames.
    fn simulate_markers(markers: &[Vector3<f64>], frames: usize, noise_m: f64, seed: u64) -> Vec<MarkerPositions> {
        let mut state = seed;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let frame = |at: usize| {
            let time = 0.02 * at as f64;
            let turn = rotation::exp(&Vector3::new((0.7 * time).sin(), (0.4 * time).cos(), 0.3 * time));
            let place = Vector3::new(time.sin(), (0.6 * time).cos(), 1.0 + 0.3 * (0.9 * time).sin());
            let mut seen = |it: &Vector3<f64>| {
                // The sum of three is nearly normal; its deviation is a half.
                let noise = Vector3::from_fn(|_, _| 2.0 * noise_m * (random() + random() + random()));
                Some(turn * it + place + noise)
            };
            markers.iter().map(&mut seen).collect()
        };
        (0..frames).map(frame).collect()
    }

    #[test]
    fn exchanged_names_are_put_back_and_lost_ones_found() {
        let (mut right, mut wrong, mut ghosts, mut left) = (0, 0, 0, 0);
        for seed in 0..20_u64 {
            let spread = |k: u64| {
                let angle = (seed * 5 + k) as f64 * 2.399;
                Vector3::new(0.05 * angle.cos() + 0.011 * k as f64, 0.07 * angle.sin(), 0.013 * (k * k) as f64)
            };
            let markers: Vec<Vector3<f64>> = (0..4 + seed % 2).map(spread).collect();
            let count = markers.len();
            let mut frames = simulate_markers(&markers, 400, 2e-4, seed + 1);
            // Two columns have no name: one with positions of a marker that lost its own, and one of a static object.
            for frame in &mut frames {
                frame.extend([None, Some(Vector3::new(3.0, 2.0, 1.0))]);
            }
            let truth = frames.clone();
            for frame in &mut frames[100..140] {
                frame.swap(0, 1);
            }
            for frame in &mut frames[200..230] {
                frame.swap(2, count);
            }
            for frame in &mut frames[300..310] {
                // A ghost in place of a marker.
                frame[3] = frame[3].map(|it| it + Vector3::new(0.03, 0.02, 0.0));
            }
            let columns: Vec<usize> = (0..count).collect();
            let found = RenamedMarkers::from_frames(&frames, &columns, &[count, count + 1]).unwrap();
            for (at, frame) in frames.iter().enumerate() {
                for (marker, expected) in truth[at].iter().enumerate().take(count) {
                    let place = found.place_of(at, marker).and_then(|it| frame[it]);
                    match place {
                        None => left += 1,
                        Some(it) if Some(it) == *expected => right += 1,
                        Some(_) if marker == 3 && (300..310).contains(&at) => ghosts += 1,
                        Some(_) => wrong += 1,
                    }
                }
            }
            assert_eq!(found.markers, columns, "{seed}");
        }
        println!(
            "{right} places are those of their markers, {wrong} are not, {ghosts} of 200 ghosts are taken, {left} are left out"
        );
        assert_eq!(wrong, 0);
        // A ghost may be as far from three others as its marker, by chance.
        assert!(ghosts <= 4, "{ghosts}");
        // These are the ghosts, and frames in which two orders fit within the noise.
        assert!((196..300).contains(&left), "{left}");
    }

    #[test]
    fn markers_that_move_by_themselves_are_no_body() {
        let mut frames = simulate_markers(&[Vector3::zeros(), Vector3::x() * 0.1], 200, 1e-4, 3);
        for (at, frame) in frames.iter_mut().enumerate() {
            frame.push(Some(Vector3::new(0.001 * at as f64, 0.0, 0.0)));
        }
        assert!(RenamedMarkers::from_frames(&frames, &[0, 1, 2], &[]).is_none());
    }

    #[test]
    fn what_is_alike_both_ways_is_not_decided() {
        // The triangle is isosceles: no distance reveals the exchange of its equal vertices, and both reveal the ghost of its apex.
        let markers = [Vector3::new(-0.05, 0.0, 0.0), Vector3::new(0.05, 0.0, 0.0), Vector3::new(0.0, 0.12, 0.0)];
        let mut frames = simulate_markers(&markers, 200, 1e-4, 4);
        frames[50].swap(0, 1);
        let found = RenamedMarkers::from_frames(&frames, &[0, 1, 2], &[]).unwrap();
        assert!(found.frames.is_empty(), "{:?}", found.frames);
        frames[60].swap(0, 2);
        let found = RenamedMarkers::from_frames(&frames, &[0, 1, 2], &[]).unwrap();
        assert_eq!(found.frames.keys().copied().collect::<Vec<_>>(), [60]);
        assert_eq!(found.frames[&60].values().copied().collect::<Vec<_>>(), [None; 3]);
    }
}

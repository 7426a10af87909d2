//! Work in parts, side by side where there are several threads.

use std::cmp::Ordering;

use rayon::prelude::*;

/// Threads that may be asked for: more than any machine has use for, and each has a stack of its own.
pub const MOST_THREADS: usize = 256;
/// Items that one thread sorts or looks at as fast as several.
const FEW: usize = 8192;

/// Whether there are several threads, and so many items are worth waking them.
fn are_worth_it(items: usize) -> bool {
    items > FEW && rayon::current_num_threads() > 1
}

/// What each of so many parts comes to, in their order whatever the number of threads. One part alone, or one thread, is not worth
/// waking anybody.
pub(crate) fn map_parts<T: Send>(count: usize, part: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    if count > 1 && rayon::current_num_threads() > 1 {
        // Whoever is done first takes the next part, one at a time: rayon would give out a quarter of them together.
        (0..count).into_par_iter().with_max_len(1).map(part).collect()
    } else {
        (0..count).map(part).collect()
    }
}

/// The same of parts that each look at so many items: few of them are not worth waking anybody either.
pub(crate) fn map_parts_of<T: Send>(
    items: usize,
    count: usize,
    part: impl Fn(usize) -> T + Sync + Send,
) -> Vec<T> {
    if items > FEW { map_parts(count, part) } else { (0..count).map(part).collect() }
}

/// What two pieces of work come to, which are done at the same time where there are several threads.
pub(crate) fn both<A: Send, B: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if rayon::current_num_threads() > 1 { rayon::join(first, second) } else { (first(), second()) }
}

/// Work on so many items, done by one of the threads that share its parts: where there are many, the others need not be waited for from
/// outside, part after part.
pub(crate) fn among_them<T: Send>(items: usize, work: impl FnOnce() -> T + Send) -> T {
    if are_worth_it(items) { rayon::scope(|_| work()) } else { work() }
}

/// Sorts items of which no two are equal, or equal ones cannot be told apart.
pub(crate) fn sort_by<T: Send>(items: &mut [T], compare: impl Fn(&T, &T) -> Ordering + Sync) {
    if are_worth_it(items.len()) {
        items.par_sort_unstable_by(compare);
    } else {
        items.sort_unstable_by(compare);
    }
}

/// What each run of so many items comes to, in their order; `part` is told which run it is.
pub(crate) fn map_chunks<S: Sync, T: Send>(
    items: &[S],
    size: usize,
    part: impl Fn(usize, &[S]) -> T + Sync + Send,
) -> Vec<T> {
    map_parts(items.len().div_ceil(size), |index| {
        part(index, &items[index * size..items.len().min((index + 1) * size)])
    })
}

/// What each run of so many items comes to, one after the other.
pub(crate) fn concat_chunks<S: Sync, T: Send>(
    items: &[S],
    size: usize,
    part: impl Fn(usize, &[S]) -> Vec<T> + Sync + Send,
) -> Vec<T> {
    let mut parts = map_chunks(items, size, part).into_iter();
    let Some(mut all) = parts.next() else { return Vec::new() };
    all.reserve_exact(parts.as_slice().iter().map(Vec::len).sum());
    parts.for_each(|part| all.extend(part));
    all
}

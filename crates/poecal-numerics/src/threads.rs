//! Work in parts, in parallel if there are several threads.

use std::cmp::Ordering;

use rayon::prelude::*;

/// Largest number of threads that may be requested: more than any machine can use, and each has a stack of its own.
pub const MOST_THREADS: usize = 256;
/// Number of threads that share the work.
#[must_use]
pub fn threads_now() -> usize {
    rayon::current_num_threads()
}

/// Number of items that one thread sorts or reads as fast as several.
const FEW: usize = 8192;

/// True if parallel work pays for this many items.
fn are_worth_it(items: usize) -> bool {
    items > FEW && rayon::current_num_threads() > 1
}

/// Maps the numbers of `count` parts, results in their order for any number of threads. Runs serially with one part or one thread.
pub fn map_parts<T: Send>(count: usize, part: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    if count > 1 && rayon::current_num_threads() > 1 {
        // A thread that is done takes the next part, one at a time: rayon would distribute a quarter of them together.
        (0..count).into_par_iter().with_max_len(1).map(part).collect()
    } else {
        (0..count).map(part).collect()
    }
}

/// [`map_parts`] for parts that read `items` items together. Runs serially for up to `FEW` items.
pub fn map_parts_of<T: Send>(items: usize, count: usize, part: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    if items > FEW { map_parts(count, part) } else { (0..count).map(part).collect() }
}

/// Results of two pieces of work, done in parallel if there are several threads.
pub fn run_both<A: Send, B: Send>(first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B + Send) -> (A, B) {
    if rayon::current_num_threads() > 1 { rayon::join(first, second) } else { (first(), second()) }
}

/// Runs `work` on a pool thread, if it is about many items, so that nested parallel calls do not block the caller.
pub fn in_pool<T: Send>(items: usize, work: impl FnOnce() -> T + Send) -> T {
    if are_worth_it(items) { rayon::scope(|_| work()) } else { work() }
}

/// Sorts items of which no two are equal, or equal ones are indistinguishable.
pub fn sort_by<T: Send>(items: &mut [T], compare: impl Fn(&T, &T) -> Ordering + Sync) {
    if are_worth_it(items.len()) {
        items.par_sort_unstable_by(compare);
    } else {
        items.sort_unstable_by(compare);
    }
}

/// Maps runs of `size` items, results in their order; `part` takes the index of the run.
pub fn map_chunks<S: Sync, T: Send>(items: &[S], size: usize, part: impl Fn(usize, &[S]) -> T + Sync + Send) -> Vec<T> {
    map_parts(items.len().div_ceil(size), |index| {
        part(index, &items[index * size..items.len().min((index + 1) * size)])
    })
}

/// Concatenated results of each run of `size` items.
pub fn concat_chunks<S: Sync, T: Send>(
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

/// Fills runs of `size` items; `part` takes the index of the run.
pub fn fill_chunks<T: Send>(items: &mut [T], size: usize, part: impl Fn(usize, &mut [T]) + Sync + Send) {
    if items.len() > size && rayon::current_num_threads() > 1 {
        items.par_chunks_mut(size).with_max_len(1).enumerate().for_each(|(index, some)| part(index, some));
    } else {
        items.chunks_mut(size).enumerate().for_each(|(index, some)| part(index, some));
    }
}

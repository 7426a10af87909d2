//! Work in parts, side by side where there are several threads.

use rayon::prelude::*;

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

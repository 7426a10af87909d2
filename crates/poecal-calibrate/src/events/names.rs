//! Names of devices and targets before and after an event.

/// Name of the only device if no row names it.
pub(crate) const DEVICE: &str = "device";

/// The next name of the same thing: `tool.2`, `tool.3`.
pub(crate) fn next_of<'n>(name: &str, known: impl Iterator<Item = &'n String>) -> String {
    let (base, _) = family(name);
    let own = known.map(|it| family(it)).filter(|(other, _)| *other == base);
    let last = own.map(|(_, number)| number).max().unwrap_or(1);
    format!("{base}.{}", last + 1)
}

/// Name before any event, and number in the order of time: `tool.2` is `tool` and 2.
pub fn family(name: &str) -> (&str, usize) {
    let parts = name.rsplit_once('.').and_then(|(base, number)| Some((base, number.parse().ok()?)));
    parts.filter(|(base, number)| *number > 1 && !base.is_empty()).unwrap_or((name, 1))
}

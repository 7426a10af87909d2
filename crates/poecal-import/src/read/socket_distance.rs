//! Known distances between sockets, in their typed form.

use std::collections::BTreeMap;
use std::str::FromStr;

use poecal_model::measurement::KnownLength;
use poecal_numerics::error::{Error, ErrorKind, Result, first_few};
use poecal_numerics::named_unit::positive_length_m;

/// Known distances between the sockets of each `place`: `50mm` between its two, or by pairs of names, `A-B=50mm,B-C=70mm`; each may state its
/// standard deviation, `50mm+-0.02mm`.
#[derive(Clone, Debug, PartialEq)]
pub struct SocketDistances {
    /// The pair as typed, `None` for the only pair; distance and standard deviation, metres.
    pairs: Vec<(Option<String>, f64, f64)>,
}

impl FromStr for SocketDistances {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let pair = |part: &str| {
            let (pair, length) = match part.split_once('=') {
                Some((pair, length)) if pair.contains('-') => (Some(pair.trim().to_owned()), length),
                Some(_) => return Err(bad(part)),
                None => (None, part),
            };
            let (length, sigma) = length.split_once("+-").map_or((length, None), |(a, b)| (a, Some(b)));
            let sigma_m = sigma.map_or(Ok(KnownLength::SIGMA_M), |sigma| metres(sigma, part))?;
            Ok((pair, metres(length, part)?, sigma_m))
        };
        let pairs: Vec<(Option<String>, f64, f64)> =
            text.split(',').map(|part| pair(part.trim())).collect::<Result<_>>()?;
        if pairs.len() > 1 && pairs.iter().any(|(pair, ..)| pair.is_none()) {
            return Err(bad(text));
        }
        Ok(SocketDistances { pairs })
    }
}

/// A length above 0, with its unit.
fn metres(text: &str, whole: &str) -> Result<f64> {
    positive_length_m(text)?.ok_or_else(|| bad(whole))
}

fn bad(text: &str) -> Error {
    ErrorKind::Option.error(format!(
        "found `{text}` as the distance of sockets, expected one like 50mm, or pairs by name like A-B=50mm,B-C=70mm"
    ))
}

/// The sockets of each `place`, with the index of their stations.
pub(crate) type Sockets = BTreeMap<String, Vec<(String, usize)>>;

impl SocketDistances {
    /// The lengths between the sockets that were read.
    pub(crate) fn lengths(&self, sockets: &Sockets) -> Result<Vec<KnownLength>> {
        let mut found = Vec::new();
        for (pair, length_m, sigma_m) in &self.pairs {
            let before = found.len();
            for (place, own) in sockets {
                let stations = match pair {
                    None => match own.as_slice() {
                        [(_, a), (_, b)] => Some([*a, *b]),
                        [] | [_] => None,
                        more => return Err(too_many(place, more)),
                    },
                    Some(pair) => find_station_pair(pair, own),
                };
                let length = |stations| KnownLength { stations, length_m: *length_m, sigma_m: *sigma_m };
                found.extend(stations.map(length));
            }
            if found.len() == before {
                let names: Vec<String> = sockets.values().flatten().map(|(name, _)| name.clone()).collect();
                return ErrorKind::Option.refuse(match (pair, names.as_slice()) {
                    (_, []) => "found a distance of sockets and no row that names a socket, expected a column `socket`"
                        .to_owned(),
                    (Some(pair), names) => format!(
                        "found the sockets `{pair}` and no place that has both, expected two of {}",
                        first_few(names)
                    ),
                    (None, _) => {
                        "found a distance of sockets and only one socket in each place, expected two".to_owned()
                    }
                });
            }
        }
        Ok(found)
    }
}

fn too_many(place: &str, sockets: &[(String, usize)]) -> Error {
    let names: Vec<String> = sockets.iter().map(|(name, _)| name.clone()).collect();
    let place = if place.is_empty() { String::new() } else { format!(" in the place `{place}`") };
    ErrorKind::Option.error(format!(
        "found the sockets {}{place} and one distance, expected the distances of pairs by name, like `{}-{}=50mm`",
        first_few(&names),
        names.first().map_or("A", String::as_str),
        names.get(1).map_or("B", String::as_str)
    ))
}

/// The stations of a pair by name; names may contain hyphens.
fn find_station_pair(pair: &str, sockets: &[(String, usize)]) -> Option<[usize; 2]> {
    let station = |name: &str| sockets.iter().find(|(known, _)| known == name.trim()).map(|(_, at)| *at);
    pair.match_indices('-').find_map(|(at, _)| {
        let both = station(&pair[..at]).zip(station(&pair[at + 1..]));
        both.filter(|(a, b)| a != b).map(|(a, b)| [a, b])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_one_or_of_pairs_by_name() {
        let pairs = |text: &str| text.parse::<SocketDistances>().unwrap().pairs;
        assert_eq!(pairs("50mm"), [(None, 0.05, KnownLength::SIGMA_M)]);
        let named = pairs("A-B=50mm,B-C=70.1mm+-0.05mm");
        assert_eq!(named[0], (Some("A-B".to_owned()), 0.05, KnownLength::SIGMA_M));
        assert_eq!(named[1].0.as_deref(), Some("B-C"));
        assert!((named[1].1 - 0.0701).abs() < 1e-15 && (named[1].2 - 5e-5).abs() < 1e-15, "{named:?}");
        for bad in ["50", "A=50mm", "50mm,B-C=70mm", "A-B=-50mm", ""] {
            assert!(bad.parse::<SocketDistances>().is_err(), "{bad}");
        }
    }
}

//! Positions of the section `/POS`.

use super::super::parsed_program::Number;
use super::super::scan::{Token, TokenKind, bracket, signed_number};
use super::FanucConfiguration;

/// A position.
#[derive(Clone, Debug)]
pub(crate) struct Position {
    pub(crate) number: u32,
    pub(crate) line: usize,
    /// Name in the text: `P[3:above]`.
    pub(crate) name: String,
    /// Its groups of axes, with their numbers; 0 for contents without a group.
    pub(crate) groups: Vec<(u32, PositionGroup)>,
}

/// Contents of a position for a group.
#[derive(Clone, Debug)]
pub(crate) enum PositionGroup {
    Joints(Vec<Number>, Vec<Option<Number>>),
    Pose(Box<GroupPose>),
    /// Neither, with the reason.
    Unknown(&'static str),
}

/// A pose.
#[derive(Clone, Debug, Default)]
pub(crate) struct GroupPose {
    /// Numbers of the user frame and the tool; `None` if they are not stated, or for `F`: any.
    pub(crate) frame: Option<u32>,
    pub(crate) tool: Option<u32>,
    pub(crate) configuration: Option<FanucConfiguration>,
    /// X, Y, Z, W, P, R, and the turn numbers of the configuration.
    pub(crate) numbers: Vec<Number>,
    /// External axes, in rad and m; `None` for those without a number.
    pub(crate) external: Vec<Option<Number>>,
}

/// Positions from a byte on; `line` is its line.
pub(crate) fn positions(text: &[u8], start: usize, line: usize) -> Vec<Position> {
    let all: Vec<Token> =
        super::tokens(text, start..text.len(), line).filter(|it| it.kind != TokenKind::LineEnd).collect();
    let mut out = Vec::new();
    let mut rest = &all[..];
    while let Some((word, after)) = rest.split_first() {
        rest = after;
        if !word.is_word(text, "P") {
            continue;
        }
        let Some(found) = position(text, word, after) else { continue };
        rest = found.1;
        out.push(found.0);
    }
    out
}

/// Largest number of tokens of a position's number and name.
const LONGEST_HEAD: usize = 80;

/// The position that begins with this word, and the tokens behind it.
fn position<'t>(text: &[u8], word: &Token, after: &'t [Token]) -> Option<(Position, &'t [Token])> {
    let near = after.get(..after.len().min(LONGEST_HEAD))?;
    let (index, rest) = bracket(near, b'[', b']')?;
    let body = after.get(near.len() - rest.len()..)?;
    let number = super::whole_number(index.get(..1)?)?;
    let (inner, rest) = braces(body)?;
    let end = body.first()?.range.start;
    let name = String::from_utf8_lossy(text.get(word.range.start..end)?).trim().to_owned();
    let mut groups = Vec::new();
    let mut at = 0;
    while at < inner.len() {
        let is_head = |token: &Token| token.kind == TokenKind::Word && is_group(token.text(text));
        let next = inner.iter().skip(at + 1).position(is_head).map_or(inner.len(), |it| at + 1 + it);
        let part = inner.get(at..next).unwrap_or_default();
        // The head of a group, `GP1 :`.
        if part.first().is_some_and(is_head) {
            let head = part.first().map_or("", |it| it.text(text));
            let number = head.get(2..).and_then(|it| it.parse().ok()).unwrap_or(0);
            groups.push((number, group(text, part.get(2..).unwrap_or_default())));
        } else {
            groups.push((0, PositionGroup::Unknown("not understood: no group of axes is named")));
        }
        at = next;
    }
    Some((Position { number, line: word.line, name, groups }, rest))
}

/// The tokens between braces, and those behind; `None` if the closing brace is missing.
fn braces(tokens: &[Token]) -> Option<(&[Token], &[Token])> {
    if !tokens.first()?.is(b'{') {
        return None;
    }
    let inner = tokens.get(1..)?;
    let end = inner
        .iter()
        .position(|it| it.is(b'}') || it.is(b'{'))
        .filter(|it| inner.get(*it).is_some_and(|it| it.is(b'}')))?;
    Some((inner.get(..end)?, inner.get(end + 1..)?))
}

fn is_group(word: &str) -> bool {
    let number = word.get(2..).filter(|_| word.get(..2).is_some_and(|it| it.eq_ignore_ascii_case("GP")));
    number.is_some_and(|it| !it.is_empty() && it.bytes().all(|it| it.is_ascii_digit()))
}

/// A group by its entries `NAME = NUMBER unit` and `NAME : VALUE`.
fn group(text: &[u8], tokens: &[Token]) -> PositionGroup {
    const SHAPE: &str = "not understood: not written as X, Y, Z, W, P, R or as J1, J2, … with numbers";
    let mut pose = GroupPose::default();
    let mut joints = Vec::new();
    let mut place: [Option<Number>; 6] = Default::default();
    for entry in entries(tokens) {
        let [name, _, value @ ..] = entry else { return PositionGroup::Unknown(SHAPE) };
        let name = name.text(text).to_ascii_uppercase();
        let number = |units: &[(&str, f64)]| {
            let (unit, number) = value.split_last()?;
            let scale = units.iter().find(|(it, _)| unit.is_word(text, it))?.1;
            Some(Number { scale, ..signed_number(number)? })
        };
        const ANGLE: (&str, f64) = ("deg", 1.0);
        const LENGTH: (&str, f64) = ("mm", 1.0);
        if let Some(at) = ["X", "Y", "Z", "W", "P", "R"].iter().position(|it| *it == name) {
            let Some(found) = number(&[if at < 3 { LENGTH } else { ANGLE }]) else {
                return PositionGroup::Unknown("it has no numbers: not taught");
            };
            place[at] = Some(found);
        } else if name == "UF" {
            pose.frame = super::whole_number(value);
        } else if name == "UT" {
            pose.tool = super::whole_number(value);
        } else if name == "CONFIG" {
            let inside = match value {
                [open, inside @ .., close] if open.is(QUOTE) && close.is(QUOTE) => inside,
                _ => continue,
            };
            let Some((configuration, turns)) = FanucConfiguration::read(text, inside) else { continue };
            pose.configuration = Some(configuration);
            pose.numbers = turns;
        } else if let Some(of) = name.strip_prefix('J').and_then(|it| it.parse::<usize>().ok()) {
            match number(&[("deg", 1_f64.to_radians()), ("mm", 1e-3)]) {
                Some(found) if of == joints.len() + 1 => joints.push(found),
                _ => return PositionGroup::Unknown("it has no numbers: not taught"),
            }
        } else if name.strip_prefix('E').is_some_and(|it| it.parse::<usize>().is_ok()) {
            pose.external.push(number(&[("deg", 1_f64.to_radians()), ("mm", 1e-3)]));
        } else {
            return PositionGroup::Unknown(SHAPE);
        }
    }
    let turns = std::mem::take(&mut pose.numbers);
    let place: Option<Vec<Number>> = place.into_iter().collect();
    match (place, joints.is_empty()) {
        (Some(place), true) => {
            pose.numbers = place.into_iter().chain(turns).collect();
            PositionGroup::Pose(Box::new(pose))
        }
        (None, false) => PositionGroup::Joints(joints, pose.external),
        _ => PositionGroup::Unknown(SHAPE),
    }
}

const QUOTE: u8 = b'\'';

/// Entries between commas outside of quotes.
fn entries(tokens: &[Token]) -> impl Iterator<Item = &[Token]> {
    let mut is_quoted = false;
    let ends = tokens.split(move |it| {
        is_quoted ^= it.is(QUOTE);
        it.is(b',') && !is_quoted
    });
    ends.filter(|it| !it.is_empty())
}

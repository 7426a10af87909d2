//! Instructions of RAPID that move the robot, and the positions of their arguments.

use super::super::parsed_program::Number;
use super::super::scan::{Token, TokenKind, cut, signed_number};
use super::tokens::{ASSIGN, lower_case};

/// Position of an instruction's tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ToolArgument {
    /// The argument at this index.
    Place(usize),
    /// The last argument.
    Last,
}

/// Arguments of an instruction, counted without optional ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ArgumentLayout {
    /// True if its target is a `jointtarget`.
    pub(crate) is_joints: bool,
    /// True if joints move independently (`ConfJ`), false on lines or arcs (`ConfL`).
    pub(crate) is_free: bool,
    /// Indices of its targets, in the order in which they are reached.
    pub(crate) targets: &'static [usize],
    /// Index of the argument that it sets.
    pub(crate) sets: Option<usize>,
    pub(crate) tool: ToolArgument,
}

/// The arguments of an instruction (its name in lower case) that moves the robot to targets.
pub(crate) fn layout(name: &str) -> Option<ArgumentLayout> {
    use ToolArgument::{Last, Place};
    let (targets, tool): (&'static [usize], ToolArgument) = match name {
        "movej" | "movel" | "moveabsj" | "movejdo" | "moveldo" | "movejao" | "movelao" | "movejgo" | "movelgo"
        | "movejsync" | "movelsync" | "trigglios" => (&[0], Place(3)),
        "movec" | "movecdo" | "movecao" | "movecgo" | "movecsync" => (&[0, 1], Place(4)),
        "triggj" | "triggl" | "triggabsj" => (&[0], Place(4)),
        "triggc" => (&[0, 1], Place(5)),
        "searchl" => (&[2], Place(4)),
        "searchc" => (&[2, 3], Place(5)),
        "arcl" | "arclstart" | "arclend" | "spotl" | "spotj" | "paintl" | "displ" => (&[0], Last),
        "arcc" | "arccstart" | "arccend" | "paintc" | "dispc" => (&[0, 1], Last),
        _ => return None,
    };
    let is_joints = matches!(name, "moveabsj" | "triggabsj");
    let sets = matches!(name, "searchl" | "searchc").then_some(1);
    let is_free = name.starts_with("movej") || matches!(name, "triggj" | "spotj");
    Some(ArgumentLayout { is_joints, is_free, targets, sets, tool })
}

/// An instruction's name in lower case and its arguments.
#[derive(Clone, Debug)]
pub(crate) struct Instruction<'a> {
    pub(crate) name: String,
    pub(crate) arguments: Vec<&'a [Token]>,
    /// Optional arguments: their names in lower case, and their values.
    pub(crate) options: Vec<(String, &'a [Token])>,
}

impl<'a> Instruction<'a> {
    /// The instruction of a statement's tokens; `None` if it does not begin with a word, or if its brackets do not match.
    pub(crate) fn from_tokens(tokens: &'a [Token], text: &[u8]) -> Option<Self> {
        let (first, rest) = tokens.split_first()?;
        if first.kind != TokenKind::Word {
            return None;
        }
        let mut out = Instruction { name: lower_case(text, first), arguments: Vec::new(), options: Vec::new() };
        for part in cut(rest, b',')? {
            let mut pieces = cut(part, b'\\')?.into_iter();
            let argument = pieces.next().unwrap_or_default();
            if !argument.is_empty() {
                out.arguments.push(argument);
            }
            for option in pieces {
                if let Some((name, value)) = option.split_first() {
                    let value = value.split_first().filter(|(it, _)| it.is(ASSIGN));
                    out.options.push((lower_case(text, name), value.map_or(&[], |(_, value)| value)));
                }
            }
        }
        Some(out)
    }

    /// The value of an option, if it exists.
    pub(crate) fn option(&self, name: &str) -> Option<&'a [Token]> {
        self.options.iter().find(|(it, _)| it == name).map(|(_, value)| *value)
    }
}

/// Form of a target in the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TargetNotation<'a> {
    /// A name in lower case, and its indices if it is an element of an array: `None` for indices that are no numbers.
    Name(String, Option<Vec<Option<usize>>>),
    /// Numbers in the move.
    Numbers(&'a [Token]),
    /// Offset of a target by `Offs` or `RelTool`.
    Relative(Box<TargetNotation<'a>>),
    /// Anything else.
    Computed,
}

/// The form of a target in these tokens.
pub(crate) fn argument<'a>(tokens: &'a [Token], text: &[u8]) -> TargetNotation<'a> {
    argument_in(tokens, text, 0)
}

fn argument_in<'a>(tokens: &'a [Token], text: &[u8], depth: usize) -> TargetNotation<'a> {
    match tokens {
        [name] if name.kind == TokenKind::Word => TargetNotation::Name(lower_case(text, name), None),
        [name, open, inner @ .., close] if name.kind == TokenKind::Word && open.is(b'{') && close.is(b'}') => {
            let Some(parts) = cut(inner, b',') else { return TargetNotation::Computed };
            let whole = |it: &Number| it.value.fract() == 0.0 && (1.0..1e9).contains(&it.value);
            let index = |part: &[Token]| signed_number(part).filter(whole).map(|it| it.value as usize);
            TargetNotation::Name(lower_case(text, name), Some(parts.into_iter().map(index).collect()))
        }
        [name, open, inner @ .., close]
            if name.kind == TokenKind::Word && open.is(b'(') && close.is(b')') && depth < 8 =>
        {
            let first = cut(inner, b',').and_then(|it| it.first().copied());
            match (lower_case(text, name).as_str(), first) {
                ("offs" | "reltool", Some(first)) => {
                    TargetNotation::Relative(Box::new(argument_in(first, text, depth + 1)))
                }
                _ => TargetNotation::Computed,
            }
        }
        [open, .., close] if open.is(b'[') && close.is(b']') => TargetNotation::Numbers(tokens),
        _ => TargetNotation::Computed,
    }
}

//! Values of KRL that are stated in numbers, and the variables that have them.

use std::collections::BTreeMap;

use super::super::axes::ControllerAxes;
use super::super::parsed_program::Number;
use super::super::scan::{
    LexicalRules, Scanner, Token, TokenKind, bracket, is_one_of, outside_brackets, parts, signed_number,
};
use super::reason;
use super::status::Status;

/// Kind and contents of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum KrlValue {
    /// A pose: X, Y, Z, A, B, C, then S and T as far as they are stated.
    Pose(Vec<Number>, Status),
    /// Joints: a number for each reading.
    Joints(Vec<Number>),
    /// An aggregate of a target that cannot be taken, with the reason.
    Broken(&'static str),
    /// Tool and base of a point of an inline form.
    Place(ToolAndBase),
    /// A variable, or an element of one.
    Name(String),
    /// Anything else.
    Other,
}

/// Tool and base by their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ToolAndBase {
    pub(crate) tool: Option<i64>,
    pub(crate) base: Option<i64>,
    /// True if the tool is stationary and the workpiece moves.
    pub(crate) is_external: bool,
}

/// A variable of a file.
#[derive(Clone, Debug)]
pub(crate) struct KrlVariable {
    pub(crate) assignments: usize,
    pub(crate) line: usize,
    pub(crate) value: KrlValue,
    /// Name in the text.
    pub(crate) name: String,
    /// True if it is declared as a frame.
    pub(crate) is_frame: bool,
}

/// The variables of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct KrlVariables {
    /// Variables by name in capitals.
    pub(crate) known: BTreeMap<String, KrlVariable>,
    /// True if the file is a list of data.
    pub(crate) is_data: bool,
    /// True if the file moves the robot's base.
    pub(crate) moves_root: bool,
}

/// Name and assigned value of a statement: name, true if only a part is assigned, its first token, and the value.
pub(crate) struct Assignment<'t> {
    pub(crate) key: String,
    pub(crate) is_part: bool,
    pub(crate) name: &'t Token,
    pub(crate) is_frame: bool,
    pub(crate) value: &'t [Token],
}

/// The assignment of a statement, if it is one.
pub(crate) fn assignment<'t>(text: &[u8], tokens: &'t [Token]) -> Option<Assignment<'t>> {
    let (equals, _) = outside_brackets(tokens).find(|(_, it)| it.is(b'='))?;
    let (left, value) = (&tokens[..equals], &tokens[equals + 1..]);
    // `DECL GLOBAL E6POS XP1`: the name is the last word before an index or a part.
    let words = left.iter().take_while(|it| it.kind == TokenKind::Word).count();
    let at = words.checked_sub(1)?;
    let name = left.get(at)?;
    let is_frame = left[..at].iter().any(|it| it.is_word(text, "FRAME"));
    let index = bracket(&left[words..], b'[', b']');
    let is_part = !index.map_or(&left[words..], |it| it.1).is_empty();
    Some(Assignment { key: key(text, name, index.map(|it| it.0)), is_part, name, is_frame, value })
}

/// The name of a variable in capitals, with its index, `*` if that is no number.
pub(crate) fn key(text: &[u8], name: &Token, index: Option<&[Token]>) -> String {
    let name = name.text(text).to_ascii_uppercase();
    match index {
        None => name,
        Some([Token { kind: TokenKind::Number(value, 0), .. }]) => format!("{name}[{value}]"),
        Some(_) => format!("{name}[*]"),
    }
}

/// Statements that compare, and assign nothing.
const CONDITIONS: &str = "IF WHILE UNTIL WAIT FOR SIGNAL INTERRUPT TRIGGER ON_ERROR_PROCEED";

impl KrlVariables {
    /// The variables of a text.
    pub(crate) fn from_text(text: &[u8], rules: &LexicalRules, axes: &ControllerAxes) -> Self {
        let mut out = KrlVariables::default();
        let mut scanner = Scanner::new(text, rules);
        let mut tokens = Vec::new();
        while scanner.statement(&mut tokens).is_some() {
            let Some(first) = tokens.first() else { continue };
            if ["DEF", "DEFFCT", "GLOBAL"].iter().any(|it| first.is_word(text, it))
                && let Some(open) = tokens.iter().position(|it| it.is(b'('))
            {
                for parameter in tokens[open..].iter().filter(|it| it.kind == TokenKind::Word) {
                    out.assign(&key(text, parameter, None), text, parameter, KrlValue::Other, 2, false);
                }
                continue;
            }
            out.is_data |= first.is_word(text, "DEFDAT");
            let word = first.text(text).to_ascii_uppercase();
            if super::MOTIONS.iter().any(|(it, _)| *it == word) || is_one_of(CONDITIONS, &word) {
                continue;
            }
            out.hand_over(text, &tokens);
            if let Some(it) = assignment(text, &tokens) {
                out.moves_root |= it.key == "$ROBROOT";
                let value = if it.is_part { KrlValue::Other } else { value(text, it.value, axes) };
                let times = if it.is_part { 2 } else { 1 };
                out.assign(&it.key, text, it.name, value, times, it.is_frame);
            }
        }
        out
    }

    /// Counts variables that are passed to a routine as changed.
    fn hand_over(&mut self, text: &[u8], tokens: &[Token]) {
        for (at, token) in tokens.iter().enumerate().filter(|(_, it)| it.kind == TokenKind::Word) {
            let Some((inside, _)) = bracket(&tokens[at + 1..], b'(', b')') else { continue };
            if token.is_word(text, "BAS") {
                continue;
            }
            for argument in parts(inside) {
                if let [name, rest @ ..] = argument
                    && name.kind == TokenKind::Word
                    && (rest.is_empty() || rest[0].is(b'['))
                {
                    let index = bracket(rest, b'[', b']').map(|it| it.0);
                    self.assign(&key(text, name, index), text, name, KrlValue::Other, 2, false);
                }
            }
        }
    }

    fn assign(&mut self, key: &str, text: &[u8], name: &Token, value: KrlValue, times: usize, is_frame: bool) {
        let name_as_written = match key.find('[') {
            Some(at) => format!("{}{}", name.text(text), &key[at..]),
            None => name.text(text).to_owned(),
        };
        let new = || KrlVariable { assignments: 0, line: name.line, value, name: name_as_written, is_frame };
        self.known.entry(key.to_owned()).or_insert_with(new).assignments += times;
    }

    /// The variable by a name in capitals, if it is assigned once, else the reason why it has no value.
    pub(crate) fn of_name(&self, key: &str) -> Result<&KrlVariable, &'static str> {
        let base = key.split('[').next().unwrap_or(key);
        let is_written = |key: String| self.known.contains_key(&key);
        if key.ends_with("[*]") {
            return Err(reason::COMPUTED);
        }
        match self.known.get(key) {
            None => Err(reason::ABSENT),
            Some(it) if it.assignments > 1 => Err(reason::SEVERAL),
            // An element may be written by a computed index, or with all other elements.
            Some(_) if key != base && (is_written(format!("{base}[*]")) || is_written(base.to_owned())) => {
                Err(reason::SEVERAL)
            }
            Some(it) => Ok(it),
        }
    }

    /// Tool and base of a point by its name in capitals.
    pub(crate) fn place(&self, key: &str) -> Option<ToolAndBase> {
        let KrlValue::Place(place) = self.of_name(key).ok()?.value else { return None };
        Some(place)
    }
}

/// Kind and contents of an expression.
pub(crate) fn value(text: &[u8], tokens: &[Token], axes: &ControllerAxes) -> KrlValue {
    match tokens {
        [name] if name.kind == TokenKind::Word => KrlValue::Name(key(text, name, None)),
        [name, rest @ ..] if name.kind == TokenKind::Word => match bracket(rest, b'[', b']') {
            Some((index, [])) => KrlValue::Name(key(text, name, Some(index))),
            _ => KrlValue::Other,
        },
        _ => match bracket(tokens, b'{', b'}') {
            Some((inside, [])) => aggregate(text, inside, axes),
            _ => KrlValue::Other,
        },
    }
}

/// Fields of an aggregate: the name of each in capitals, its number if it is one, and its tokens.
struct AggregateFields<'t>(Vec<(String, Option<Number>, &'t [Token])>);

impl<'t> AggregateFields<'t> {
    /// The fields of an aggregate without its brackets; `None` if a field occurs twice, or has no name.
    fn from_tokens(text: &[u8], inside: &'t [Token]) -> Option<Self> {
        let inside = match inside {
            [kind, colon, rest @ ..] if kind.kind == TokenKind::Word && colon.is(b':') => rest,
            all => all,
        };
        let mut fields = AggregateFields(Vec::new());
        for part in parts(inside) {
            let [name, value @ ..] = part else { return None };
            let name = name.text(text).to_ascii_uppercase();
            if fields.get(&name).is_some() {
                return None;
            }
            fields.0.push((name, signed_number(value).or_else(|| bits(text, value)), value));
        }
        Some(fields)
    }

    /// The number of a field, if it is one, and its tokens.
    fn get(&self, name: &str) -> Option<(Option<&Number>, &'t [Token])> {
        self.0.iter().find(|it| it.0 == name).map(|it| (it.1.as_ref(), it.2))
    }

    /// The number of a field, or the reason why there is none.
    fn number(&self, name: &str, absent: &'static str) -> Result<Number, &'static str> {
        self.get(name).ok_or(absent)?.0.cloned().ok_or(reason::EXPRESSIONS)
    }

    /// Number of fields that are axes of a letter.
    fn axes(&self, letter: u8) -> usize {
        self.0.iter().filter(|it| is_axis(&it.0, letter)).count()
    }

    /// True if external axes are not zero that are neither of the model nor among these names.
    fn has_external(&self, axes: &ControllerAxes, names: &[String]) -> bool {
        let is_known = |name: &str| names.iter().any(|it| it.eq_ignore_ascii_case(name));
        let is_of_model = |name: &str| (1..=axes.external.len()).any(|it| name == format!("E{it}"));
        let mut external = self.0.iter().filter(|it| is_axis(&it.0, b'E') && !is_known(&it.0) && !is_of_model(&it.0));
        external.any(|it| it.1.as_ref().is_none_or(|number| number.value != 0.0))
    }
}

fn aggregate(text: &[u8], inside: &[Token], axes: &ControllerAxes) -> KrlValue {
    let Some(fields) = AggregateFields::from_tokens(text, inside) else { return KrlValue::Other };
    let has = |name: &str| fields.get(name).is_some();
    let found = if has("TOOL_NO") || has("BASE_NO") {
        return KrlValue::Place(place(text, &fields));
    } else if POSE.into_iter().any(has) {
        pose(&fields, axes)
    } else if fields.axes(b'A') > 0 {
        joints(&fields, axes)
    } else {
        return KrlValue::Other;
    };
    found.unwrap_or_else(KrlValue::Broken)
}

/// Fields of a frame.
const POSE: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

fn is_axis(name: &str, letter: u8) -> bool {
    matches!(name.as_bytes(), [first, b'1'..=b'9'] if *first == letter)
}

/// A number in bits, `'B0101'`, or in base 16, `'H1F'`.
fn bits(text: &[u8], tokens: &[Token]) -> Option<Number> {
    let [token] = tokens else { return None };
    let text: String = token.text(text).split_whitespace().collect();
    let inside = text.strip_prefix('\'')?.strip_suffix('\'')?;
    let (letter, digits) = (inside.get(..1)?, inside.get(1..)?);
    let base = match letter {
        "B" | "b" => 2,
        "H" | "h" => 16,
        _ => return None,
    };
    let value = u32::from_str_radix(digits, base).ok()?;
    Some(Number { range: token.range.clone(), value: f64::from(value), decimals: 0, scale: 1.0 })
}

fn place(text: &[u8], fields: &AggregateFields<'_>) -> ToolAndBase {
    let number = |name: &str| {
        let number = fields.get(name)?.0?;
        (number.value.fract() == 0.0).then_some(number.value as i64)
    };
    let mode = fields.get("IPO_FRAME");
    let is_external = mode.is_some_and(|it| !it.1.iter().any(|word| word.is_word(text, "BASE")));
    ToolAndBase { tool: number("TOOL_NO"), base: number("BASE_NO"), is_external }
}

fn pose(fields: &AggregateFields<'_>, axes: &ControllerAxes) -> Result<KrlValue, &'static str> {
    let number = |name: &str| fields.number(name, reason::PARTIAL);
    let mut numbers = POSE.into_iter().map(number).collect::<Result<Vec<_>, _>>()?;
    if fields.has_external(axes, &[]) {
        return Err(reason::EXTERNAL);
    }
    let mut words = [None, None];
    for (word, name) in words.iter_mut().zip(["S", "T"]) {
        let Some((number, _)) = fields.get(name) else { continue };
        let is_whole = |it: &&Number| it.value >= 0.0 && it.value.fract() == 0.0;
        let number = number.filter(is_whole).ok_or(reason::EXPRESSIONS)?;
        *word = Some(number.value as u32);
        numbers.push(number.clone());
    }
    // A frame has neither.
    if fields.axes(b'E') > 0 || words.iter().any(Option::is_some) {
        for it in 1..=axes.external.len() {
            let number = fields.number(&format!("E{it}"), reason::NO_EXTERNAL)?;
            numbers.push(Number { scale: 1e-3, ..number });
        }
    }
    Ok(KrlValue::Pose(numbers, Status { status: words[0], turn: words[1] }))
}

fn joints(fields: &AggregateFields<'_>, axes: &ControllerAxes) -> Result<KrlValue, &'static str> {
    if fields.has_external(axes, &axes.names) {
        return Err(reason::EXTERNAL);
    }
    let names: Vec<String> = axes.names.iter().map(|it| it.to_ascii_uppercase()).collect();
    let is_named = names.iter().all(|it| is_axis(it, b'A') || is_axis(it, b'E'));
    if !is_named && axes.external.is_empty() && axes.count() != 6 {
        return Err(reason::COUNT);
    }
    let mut numbers = Vec::new();
    for (index, own) in names.iter().enumerate() {
        let external = axes.external.iter().position(|it| *it == index);
        let before = axes.external.iter().filter(|it| **it < index).count();
        let name = match external {
            _ if is_named => own.clone(),
            Some(external) => format!("E{}", external + 1),
            None => format!("A{}", index + 1 - before),
        };
        let scale = axes.scale(index, 1.0_f64.to_radians(), 1e-3);
        numbers.push(Number { scale, ..fields.number(&name, reason::PARTIAL)? });
    }
    let is_own = |&it: &usize| if is_named { is_axis(&names[it], b'A') } else { !axes.external.contains(&it) };
    let own = (0..axes.count()).filter(is_own).count();
    if fields.axes(b'A') == own { Ok(KrlValue::Joints(numbers)) } else { Err(reason::COUNT) }
}

//! Joint readings as controllers and ROS list them: FANUC's position registers (posreg.va), Stäubli's data of a program (.dtx), telegrams of KUKA's
//! sensor interface (RSI), and `ros2 topic echo --csv` of joint states.

use std::collections::BTreeMap;

use super::axes::{AxisValue, AxisWords, ListedConfiguration, make_table};
use super::made_table::{CellValue, FileLine, MadeTable, Refusal, TableColumn};
use super::words::{cells, lines, number, quote_names};
use super::{FileForm, OpeningContext};
use crate::Separator;

pub(crate) const FANUC: FileForm = FileForm { title: "position registers of FANUC", is_it: is_fanuc, table: of_fanuc };
pub(crate) const STAUBLI: FileForm =
    FileForm { title: "joint data of Stäubli (VAL3)", is_it: is_staubli, table: of_staubli };
pub(crate) const KUKA: FileForm =
    FileForm { title: "telegrams of KUKA's sensor interface (RSI)", is_it: is_kuka, table: of_kuka };
pub(crate) const ECHO: FileForm =
    FileForm { title: "joint states of `ros2 topic echo --csv`", is_it: is_echo, table: of_echo };

/// Number of lines in which a form is sought.
const FIRST: usize = 60;
/// Largest number of axes for which angles are filled in.
const MOST_AXES: u8 = 64;
/// Names of the axes, and of the records that have them.
const FANUC_WORDS: AxisWords = AxisWords { own: "J", external: "EXT", all: "configurations" };
const STAUBLI_WORDS: AxisWords = AxisWords { own: "j", external: "", all: "configurations" };
const KUKA_WORDS: AxisWords = AxisWords { own: "A", external: "E", all: "telegrams" };

fn is_fanuc(text: &str, _: &OpeningContext<'_>) -> bool {
    // A controller's web page has tags before it.
    let mut first = lines(text).take(FIRST);
    first.any(|(line, it)| it.contains("[*POSREG*]") || line == 1 && it.contains("$POSREG"))
}

/// Reads `[1,4] = 'name'`, then `J1 = 10.000 deg …`; other registers are poses, of other groups, or not initialised.
fn of_fanuc(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let mut listed: Vec<ListedConfiguration<'_>> = Vec::new();
    let mut poses = 0;
    let mut is_first_group = false;
    for (line, content) in lines(text) {
        let trimmed = content.trim();
        if let Some((place, rest)) = trimmed.strip_prefix('[').and_then(|it| it.split_once(']'))
            && let Some((group, at)) = place.split_once(',')
        {
            is_first_group = group.trim() == "1";
            let own = rest.split('\'').nth(1).unwrap_or_default();
            let name = if own.is_empty() { format!("PR{at}") } else { own.to_owned() };
            if !rest.contains('=') {
                return FileLine(line).refuse(format!("found the register `{name}` cut off, expected a whole file"));
            }
            if is_first_group {
                listed.push(ListedConfiguration::new(line, name));
            }
        }
        let Some(last) = listed.last_mut().filter(|_| is_first_group) else { continue };
        poses += usize::from(trimmed.starts_with("X:"));
        let mut words = trimmed.split([' ', '=', ':']).filter(|it| !it.is_empty());
        while let Some(word) = words.next().filter(|_| !trimmed.starts_with('[')) {
            let numbered = |before: &str| word.strip_prefix(before).and_then(|it| it.parse().ok());
            let Some((of, axis)) = (numbered("J").map(|it| (&mut last.own, it)))
                .or_else(|| numbered("EXT").map(|it| (&mut last.external, it)))
            else {
                continue;
            };
            let (Some(value), Some(unit @ ("deg" | "mm"))) = (words.next(), words.next()) else {
                return FileLine(line).refuse(format!(
                    "found {word} of `{}` without its unit, expected deg or mm behind the number: the file is cut off",
                    last.name
                ));
            };
            of.insert(axis, AxisValue { value, unit: Some(unit) });
        }
    }
    // A pose has no angle of a joint, but may have external axes.
    let (with, without): (Vec<_>, Vec<_>) = listed.into_iter().partition(|it| !it.own.is_empty());
    let mut made = make_table(&with, TableColumn::from("id"), &FANUC_WORDS, opening)?;
    if !without.is_empty() {
        made.say(format!("left out {} registers that are poses ({poses}) or not initialized", without.len()));
    }
    Ok(made)
}

/// The values of the attributes with this letter and a number in the text of an element, by their number.
fn numbered_values(element: &str, letter: char) -> BTreeMap<u8, AxisValue<'_>> {
    let attributes = element.split_whitespace().filter_map(|it| it.split_once('='));
    attributes
        .filter_map(|(name, value)| {
            let value = value.trim_matches(['"', '\'', '/', '>']);
            Some((name.strip_prefix(letter)?.parse().ok()?, AxisValue { value, unit: None }))
        })
        .collect()
}

fn is_staubli(text: &str, _: &OpeningContext<'_>) -> bool {
    text.contains("staubli.com")
        && lines(text).take(FIRST).any(|it| it.1.contains("<Database"))
        && text.contains("type=\"joint")
}

/// Reads `<Data name="…" type="jointRx"> <Value key="0" j1="…" …/>`; newer files leave out angles that are zero.
fn of_staubli(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let mut arrays: Vec<(&str, Vec<ListedConfiguration<'_>>)> = Vec::new();
    let mut is_joints = false;
    for (line, content) in lines(text) {
        for element in content.split('<') {
            let attribute = |name: &str| element.split_once(&format!(" {name}=\""))?.1.split('"').next();
            if element.starts_with("Data ") {
                is_joints =
                    attribute("type").is_some_and(|it| it.starts_with("joint")) || element.contains(" type=\"joint");
                if is_joints {
                    arrays.push((attribute("name").unwrap_or_default(), Vec::new()));
                }
            } else if element.starts_with("Value ")
                && is_joints
                && let Some((name, listed)) = arrays.last_mut()
            {
                if !element.contains('>') {
                    return FileLine(line)
                        .refuse("found a `Value` without its `>`, expected it in the same line: the file is cut off");
                }
                let own = numbered_values(element, 'j');
                let name = format!("{name}[{}]", attribute("key").unwrap_or_default());
                listed.push(ListedConfiguration { own, ..ListedConfiguration::new(line, name) });
            }
        }
    }
    let longest = arrays.iter().map(|it| it.1.len()).max().unwrap_or_default();
    let at = arrays.iter().position(|it| it.1.len() == longest).unwrap_or_default();
    let left = quote_names(arrays.iter().enumerate().filter(|it| it.0 != at).map(|it| it.1.0));
    let (name, listed) = arrays.get_mut(at).map_or(("", &mut [][..]), |it| (it.0, it.1.as_mut_slice()));
    let zeros = fill(name, listed)?;
    let mut made = make_table(listed, TableColumn::from("id"), &STAUBLI_WORDS, opening)?;
    made.say(format!("of the array `{name}`"));
    if zeros > 0 {
        made.say(format!("{zeros} angles that are left out taken as 0"));
    }
    if !left.is_empty() {
        made.say(format!("left out {left}"));
    }
    Ok(made)
}

/// Fills in 0 for angles that an array leaves out, and counts them.
fn fill(name: &str, listed: &mut [ListedConfiguration<'_>]) -> Result<usize, Refusal> {
    let last = listed.iter().filter_map(|it| it.own.keys().max()).max().copied().unwrap_or_default();
    let mut count = 0;
    for axis in 1..=last.min(MOST_AXES) {
        let without = listed.iter_mut().filter(|it| !it.own.contains_key(&axis)).map(|it| {
            it.own.insert(axis, AxisValue { value: "0", unit: None });
        });
        let zeros = without.count();
        if zeros == listed.len() {
            return Refusal::refuse_whole(format!(
                "found no angle j{axis} in any value of `{name}`, expected it in one at least: if it is 0 throughout, write j{axis}=\"0\""
            ));
        }
        count += zeros;
    }
    Ok(count)
}

fn is_kuka(text: &str, _: &OpeningContext<'_>) -> bool {
    lines(text).take(FIRST).any(|it| it.1.contains("<AIPos ")) && text.contains("<Rob ")
}

/// Reads `<AIPos A1="…" …/>`, `<EIPos E1="…" …/>` of external axes, and `<IPOC>` with the controller's time in milliseconds.
fn of_kuka(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let mut listed: Vec<ListedConfiguration<'_>> = Vec::new();
    let (mut own, mut external) = (BTreeMap::new(), BTreeMap::new());
    for (line, content) in lines(text) {
        for element in content.split('<') {
            match element.split([' ', '>']).next() {
                Some("AIPos") => own = numbered_values(element, 'A'),
                Some("EIPos") => external = numbered_values(element, 'E'),
                Some("IPOC") => {
                    let time = element.split_once('>').map_or("", |it| it.1.trim()).to_owned();
                    let (own, external) = (std::mem::take(&mut own), std::mem::take(&mut external));
                    listed.push(ListedConfiguration { line, name: time, own, external });
                }
                _ => {}
            }
        }
    }
    if listed.is_empty() {
        return Refusal::refuse_whole("found no telegram with AIPos and IPOC, expected both of each");
    }
    let mut made = make_table(&listed, TableColumn::from("time").in_unit("ms"), &KUKA_WORDS, opening)?;
    made.say("axes (AIPos) in deg, times (IPOC) in ms");
    Ok(made)
}

/// Names of a line of joint states, behind seconds, nanoseconds and the name of a frame.
fn echo_names<'t>(cells: &[&'t str]) -> Option<Vec<&'t str>> {
    let is_whole =
        |at: usize| cells.get(at).is_some_and(|it| !it.is_empty() && it.bytes().all(|it| it.is_ascii_digit()));
    let names: Vec<&str> =
        cells.iter().skip(3).take_while(|it| number(it).is_none() && !it.is_empty()).copied().collect();
    (is_whole(0) && is_whole(1) && !names.is_empty() && cells.len() >= 3 + 2 * names.len()).then_some(names)
}

fn is_echo(text: &str, opening: &OpeningContext<'_>) -> bool {
    let Some(line) = lines(text).next() else { return false };
    let names = echo_names(&cells(line.1, Separator::Comma));
    names.is_some_and(|names| opening.robot.joint_reading_names().iter().any(|it| names.contains(&it.as_str())))
}

fn of_echo(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let joints = opening.robot.joint_reading_names();
    let columns = std::iter::once(TableColumn::from("time").in_unit("s"));
    let mut made = MadeTable::new(1, columns.chain(opening.joint_columns("rad")));
    for (line, content) in lines(text) {
        let cells = cells(content, Separator::Comma);
        let Some(names) = echo_names(&cells) else {
            return FileLine(line).refuse("found a line that is no joint state, expected seconds, nanoseconds, a frame, names of joints and their positions");
        };
        // Positions are behind the names, then velocities and efforts if there are any.
        let beyond = cells.iter().skip(3 + names.len()).filter(|it| !it.is_empty()).count();
        if beyond == 0 || beyond % names.len() != 0 {
            return FileLine(line).refuse(format!(
                "found {beyond} numbers behind the names of {} joints, expected as many or a multiple",
                names.len()
            ));
        }
        let value = |at: usize| cells.get(at).copied().and_then(number);
        let time = value(0).zip(value(1)).map_or(CellValue::Empty, |(s, ns)| CellValue::Number(s + 1e-9 * ns));
        let mut row = vec![time];
        for joint in &joints {
            let Some(at) = names.iter().position(|it| it == joint) else {
                return FileLine(line)
                    .refuse(format!("found no joint `{joint}` among {}, expected it", quote_names(&names)));
            };
            row.push(CellValue::cell_at(&cells, 3 + names.len() + at));
        }
        made.row(line, row);
    }
    made.say(format!("{} joint states by the names in each line, in rad and m", made.rows()));
    Ok(made)
}

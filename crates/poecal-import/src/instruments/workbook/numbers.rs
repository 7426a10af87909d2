//! Cells of workbooks without another reader: stored numbers, shared texts, and the styles that mark dates.

use calamine::{Data, ExcelDateTime, ExcelDateTimeType};
use poecal_storage::containers::fields::ByteFields;

/// Data that the cells of a workbook share.
#[derive(Default)]
pub(crate) struct WorkbookContext {
    pub(crate) texts: Vec<String>,
    /// Formats of the workbook itself, by number.
    pub(crate) formats: Vec<(u16, String)>,
    pub(crate) is_1904: bool,
    /// True for each style whose cells are dates.
    dates: Vec<bool>,
}

impl WorkbookContext {
    /// Takes the styles of cells, by the numbers of their formats.
    pub(crate) fn take_styles(&mut self, styles: &[u16]) {
        let is_date = |style: &u16| {
            let stated = self.formats.iter().rev().find(|it| it.0 == *style);
            stated.map_or(matches!(style, 14..=22 | 27..=36 | 45..=47 | 50..=58), |it| is_of_dates(&it.1))
        };
        self.dates = styles.iter().map(is_date).collect();
    }

    /// A number with a style.
    pub(crate) fn number(&self, value: f64, style: u16) -> Option<Data> {
        let is_date = self.dates.get(usize::from(style)).copied().unwrap_or_default();
        let date = || ExcelDateTime::new(value, ExcelDateTimeType::DateTime, self.is_1904);
        value.is_finite().then(|| if is_date { Data::DateTime(date()) } else { Data::Float(value) })
    }

    /// The shared text whose number comes next.
    pub(crate) fn text(&self, fields: &mut ByteFields<'_>) -> Option<Data> {
        self.texts.get(fields.index()?).cloned().map(Data::String)
    }
}

/// A number in eight bytes.
pub(crate) fn read_long(fields: &mut ByteFields<'_>) -> Option<f64> {
    fields.u64().map(f64::from_bits)
}

/// A number in four bytes: an integer or the upper half of a number, maybe hundredths.
pub(crate) fn read_short(fields: &mut ByteFields<'_>) -> Option<f64> {
    let bits = fields.u32()?;
    let value =
        if bits & 2 != 0 { f64::from(bits.cast_signed() >> 2) } else { f64::from_bits(u64::from(bits & !3) << 32) };
    Some(if bits & 1 != 0 { value / 100.0 } else { value })
}

/// A text of `count` letters of two bytes.
pub(crate) fn read_wide(fields: &mut ByteFields<'_>, count: usize) -> Option<String> {
    let pairs = fields.bytes(count.checked_mul(2)?)?.chunks_exact(2);
    let units: Vec<u16> = pairs.filter_map(|it| ByteFields(it).u16()).collect();
    Some(String::from_utf16_lossy(&units))
}

/// True if a format of numbers is one of dates or times: it has a letter of these outside of quotes and brackets.
fn is_of_dates(format: &str) -> bool {
    let (mut quote, mut bracket, mut is_escaped) = (false, false, false);
    format.chars().any(|letter| {
        if std::mem::take(&mut is_escaped) {
            return false;
        }
        match letter {
            '"' => quote = !quote,
            '\\' | '_' | '*' if !quote => is_escaped = true,
            '[' if !quote => bracket = true,
            ']' if !quote => bracket = false,
            _ => {}
        }
        !quote && !bracket && matches!(letter.to_ascii_lowercase(), 'd' | 'm' | 'y' | 'h' | 's')
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_of_dates_have_letters_of_them() {
        for format in ["yyyy-mm-dd", "[h]:mm", "d/m/yy h:mm", "mm:ss.0"] {
            assert!(is_of_dates(format), "{format}");
        }
        for format in ["General", "0.00", "0.00E+00", "[Red]0.0", "0 \"days\"", "0\\d", "_s0"] {
            assert!(!is_of_dates(format), "{format}");
        }
    }
}

//! Numbers and texts of messages of ROS 2: CDR (XCDR1), of either byte order.

use poecal_storage::containers::mcap::LONGEST_NAME;

/// Bytes of the head; values are aligned from behind it.
const HEAD: usize = 4;

/// A message, read from its beginning on.
#[derive(Clone, Debug)]
pub(crate) struct CdrReader<'m> {
    /// The bytes behind the head.
    bytes: &'m [u8],
    at: usize,
    is_little: bool,
}

impl<'m> CdrReader<'m> {
    /// The values of a message; an error states what was found.
    pub(crate) fn new(message: &'m [u8]) -> Result<Self, String> {
        let Some((head, bytes)) = message.split_at_checked(HEAD) else {
            return Err(format!("{} bytes", message.len()));
        };
        match head {
            [0, order @ (0 | 1), ..] => Ok(CdrReader { bytes, at: 0, is_little: *order == 1 }),
            [high, low, ..] => Err(format!("the encapsulation 0x{high:02X}{low:02X}")),
            _ => Err("no head".to_owned()),
        }
    }

    /// The next bytes, behind the padding that aligns them.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let start = self.at.next_multiple_of(N);
        let found = self.bytes.get(start..).and_then(<[u8]>::first_chunk);
        let found = *found.ok_or_else(|| self.end())?;
        self.at = start + N;
        Ok(if self.is_little { found } else { reversed(found) })
    }

    /// Description of a message that ends too soon.
    fn end(&self) -> String {
        format!("its end after {} bytes", HEAD + self.bytes.len())
    }

    pub(crate) fn u32(&mut self) -> Result<u32, String> {
        self.take().map(u32::from_le_bytes)
    }

    pub(crate) fn i32(&mut self) -> Result<i32, String> {
        self.take().map(i32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Result<f64, String> {
        self.take().map(f64::from_le_bytes)
    }

    /// An array of `N` numbers.
    pub(crate) fn array<const N: usize>(&mut self) -> Result<[f64; N], String> {
        let mut found = [0.0; N];
        for it in &mut found {
            *it = self.f64()?;
        }
        Ok(found)
    }

    /// The number of elements of a sequence, each of at least `least` bytes.
    pub(crate) fn count(&mut self, least: usize) -> Result<usize, String> {
        let count = self.u32()? as usize;
        let rest = self.bytes.len().saturating_sub(self.at);
        if count.saturating_mul(least) > rest {
            return Err(format!("a sequence of {count} in the last {rest} bytes"));
        }
        Ok(count)
    }

    /// A sequence of numbers.
    pub(crate) fn numbers(&mut self) -> Result<Vec<f64>, String> {
        (0..self.count(8)?).map(|_| self.f64()).collect()
    }

    /// A text, without the zero at its end: the name of a frame or joint.
    pub(crate) fn text(&mut self) -> Result<&'m str, String> {
        let size = self.u32()? as usize;
        let own = self.at.checked_add(size).and_then(|end| self.bytes.get(self.at..end));
        let own = own.ok_or_else(|| self.end())?;
        if size > LONGEST_NAME {
            return Err(format!("a name of {size} bytes"));
        }
        self.at += size;
        let text = own.strip_suffix(&[0]).unwrap_or(own);
        std::str::from_utf8(text).map_err(|_| "a text that is no UTF-8".to_owned())
    }

    /// A sequence of texts.
    pub(crate) fn texts(&mut self) -> Result<Vec<&'m str>, String> {
        (0..self.count(4)?).map(|_| self.text()).collect()
    }
}

fn reversed<const N: usize>(mut bytes: [u8; N]) -> [u8; N] {
    bytes.reverse();
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values of both byte orders: those of four bytes, and one of eight behind its padding.
    #[test]
    fn values_are_aligned_from_behind_the_head() {
        let little = [
            &[0, 1, 0, 0][..],
            &[3, 0, 0, 0, b'a', b'b', 0],
            // Aligned to four.
            &[0],
            &[0xFE, 0xFF, 0xFF, 0xFF],
            // Aligned to eight.
            &[0, 0, 0, 0],
            &1.5_f64.to_le_bytes(),
            &[2, 0, 0, 0, 0, 0, 0, 0],
            &2.0_f64.to_le_bytes(),
            &3.0_f64.to_le_bytes(),
        ]
        .concat();
        let big = [
            &[0, 0, 0, 0][..],
            &[0, 0, 0, 3, b'a', b'b', 0],
            &[0],
            &[0xFF, 0xFF, 0xFF, 0xFE],
            &[0, 0, 0, 0],
            &1.5_f64.to_be_bytes(),
            &[0, 0, 0, 2, 0, 0, 0, 0],
            &2.0_f64.to_be_bytes(),
            &3.0_f64.to_be_bytes(),
        ]
        .concat();
        for bytes in [little, big] {
            let mut cdr = CdrReader::new(&bytes).unwrap();
            assert_eq!(cdr.text(), Ok("ab"));
            assert_eq!(cdr.i32(), Ok(-2));
            assert_eq!(cdr.f64(), Ok(1.5));
            assert_eq!(cdr.numbers(), Ok(vec![2.0, 3.0]));
            assert!(cdr.f64().is_err());
        }
    }

    #[test]
    fn lengths_that_are_none_are_errors() {
        for (bytes, found) in [
            (&[0, 1, 0][..], "3 bytes"),
            (&[0, 7, 0, 0], "the encapsulation 0x0007"),
            (&[0, 1, 0, 0, 1], "its end after 5 bytes"),
            (&[0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF], "its end after 8 bytes"),
            (&[0, 1, 0, 0, 1, 0, 0, 0, 0xFF], "a text that is no UTF-8"),
        ] {
            assert_eq!(CdrReader::new(bytes).and_then(|mut it| it.text().map(str::len)), Err(found.to_owned()));
        }
        let huge = [0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0];
        let refused = Err("a sequence of 4294967295 in the last 4 bytes".to_owned());
        assert_eq!(CdrReader::new(&huge).and_then(|mut it| it.numbers()), refused);
        assert!(CdrReader::new(&huge).and_then(|mut it| it.texts().map(|it| it.len())).is_err());
    }
}

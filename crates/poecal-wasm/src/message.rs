//! Requests and answers as bytes.
//!
//! Numbers are `u32`, lowest byte first. A text or file is its length and its bytes, a list its count and its entries. A request is the
//! list of words, the input, and the list of files, each a path and its bytes. An answer is the exit code, standard output, standard
//! error, the list of files written, and the list of those removed.

use crate::{Answer, RunRequest};

/// Rest that is not read yet.
struct RemainingBytes<'a>(&'a [u8]);

impl<'a> RemainingBytes<'a> {
    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (first, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(first)
    }

    fn number(&mut self) -> Option<usize> {
        let bytes = self.bytes(4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(bytes)).ok()
    }

    fn block(&mut self) -> Option<&'a [u8]> {
        let length = self.number()?;
        self.bytes(length)
    }

    fn text(&mut self) -> Option<String> {
        String::from_utf8(self.block()?.to_vec()).ok()
    }
}

/// The request in these bytes; `None` if they contain none.
#[must_use]
pub fn decode(bytes: &[u8]) -> Option<RunRequest> {
    let mut rest = RemainingBytes(bytes);
    let mut request = RunRequest::default();
    for _ in 0..rest.number()? {
        request.words.push(rest.text()?);
    }
    request.input = rest.block()?.to_vec();
    for _ in 0..rest.number()? {
        request.files.push((rest.text()?, rest.block()?.to_vec()));
    }
    rest.0.is_empty().then_some(request)
}

/// Adds a number. 32 bits suffice for counts in a module of 4 GiB.
fn number(out: &mut Vec<u8>, number: usize) {
    out.extend(u32::try_from(number).unwrap_or(u32::MAX).to_le_bytes());
}

fn block(out: &mut Vec<u8>, bytes: &[u8]) {
    number(out, bytes.len());
    out.extend_from_slice(bytes);
}

/// An answer as bytes.
#[must_use]
pub fn encode(answer: &Answer) -> Vec<u8> {
    let mut out = Vec::new();
    number(&mut out, usize::from(answer.said.code));
    block(&mut out, answer.said.out.as_bytes());
    block(&mut out, answer.said.err.as_bytes());
    number(&mut out, answer.written.len());
    for (path, bytes) in &answer.written {
        block(&mut out, path.as_bytes());
        block(&mut out, bytes);
    }
    number(&mut out, answer.removed.len());
    answer.removed.iter().for_each(|path| block(&mut out, path.as_bytes()));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_its_lengths_and_bytes() {
        assert_eq!(encode(&Answer::default()), [0; 20]);
        let mut answer = Answer { removed: vec!["a".to_owned()], ..Answer::default() };
        answer.said.code = 2;
        let expected = [[2, 0, 0, 0], [0; 4], [0; 4], [0; 4], [1, 0, 0, 0], [1, 0, 0, 0]].concat();
        assert_eq!(encode(&answer), [expected.as_slice(), b"a"].concat());
    }
}

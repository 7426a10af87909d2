//! Numbers in a sequence of bytes, little endian.

/// The remaining bytes.
#[derive(Clone, Copy)]
pub struct ByteFields<'b>(pub &'b [u8]);

impl<'b> ByteFields<'b> {
    /// The next `count` bytes.
    pub fn bytes(&mut self, count: usize) -> Option<&'b [u8]> {
        let (found, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(found)
    }

    /// Bytes preceded by their number.
    #[cfg(feature = "bags")]
    pub fn counted_bytes(&mut self) -> Option<&'b [u8]> {
        let count = self.u64()?;
        self.bytes(usize::try_from(count).ok()?)
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.try_into().ok()
    }

    /// A byte.
    pub fn u8(&mut self) -> Option<u8> {
        self.take().map(u8::from_le_bytes)
    }

    /// A number of two bytes.
    pub fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    /// A number of four bytes.
    pub fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    /// A number of eight bytes.
    pub fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    /// A number of four bytes, as an index.
    pub fn index(&mut self) -> Option<usize> {
        usize::try_from(self.u32()?).ok()
    }
}

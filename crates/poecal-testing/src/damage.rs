//! Damage of binary files.

/// Passes on each text of bytes that differs from a whole one in a single byte, and each beginning of it.
pub fn read_damaged(whole: &[u8], mut read: impl FnMut(&[u8])) {
    let mut bytes = whole.to_vec();
    for at in 0..whole.len() {
        for byte in [0, 1, 0x7F, 0x80, 0xFF, whole[at] ^ 1] {
            bytes[at] = byte;
            read(&bytes);
        }
        bytes[at] = whole[at];
        read(&whole[..at]);
    }
}

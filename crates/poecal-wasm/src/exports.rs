//! Interface of the module to JavaScript. The caller obtains memory by `allocate`, writes a request there, and calls `run`, which returns the address
//! of an answer: its length as a number of 32 bits, and its bytes. `release` frees memory of either.
#![expect(unsafe_code, reason = "places in the memory come from JavaScript, and are what `allocate` and `run` gave")]

use std::alloc::{Layout, alloc, dealloc};
use std::sync::{Mutex, PoisonError};

use crate::{decode, encode};

/// Message of the last panic, with its length before it.
static LAST_WORDS: Mutex<Vec<u8>> = Mutex::new(Vec::new());

fn layout(length: usize) -> Option<Layout> {
    // An empty layout has no address of its own.
    Layout::from_size_align(length.max(1), 1).ok()
}

/// Memory of this number of bytes; null if there is none left.
#[unsafe(no_mangle)]
extern "C" fn allocate(length: usize) -> *mut u8 {
    // SAFETY: the layout has at least one byte.
    layout(length).map_or(std::ptr::null_mut(), |layout| unsafe { alloc(layout) })
}

/// Frees memory.
///
/// # Safety
/// It came from [`allocate`] of this length, or from [`run`] with the length of the answer and its head, and is not used any more.
#[unsafe(no_mangle)]
unsafe extern "C" fn release(place: *mut u8, length: usize) {
    if let Some(layout) = layout(length).filter(|_| !place.is_null()) {
        // SAFETY: as the caller promises.
        unsafe { dealloc(place, layout) };
    }
}

/// Bytes with their length before them.
fn with_head(bytes: &[u8]) -> Vec<u8> {
    let mut all = u32::try_from(bytes.len()).unwrap_or(u32::MAX).to_le_bytes().to_vec();
    all.extend_from_slice(bytes);
    all
}

/// Runs a request; null if the bytes are none.
///
/// # Safety
/// `place` came from [`allocate`] of this length, and the bytes are written.
#[unsafe(no_mangle)]
unsafe extern "C" fn run(place: *const u8, length: usize) -> *mut u8 {
    listen();
    // SAFETY: as the caller promises.
    let bytes = unsafe { std::slice::from_raw_parts(place, length) };
    let Some(request) = decode(bytes) else { return std::ptr::null_mut() };
    let answer = with_head(&encode(&crate::run(request)));
    // The caller has to name the length, so there is no more memory than that.
    Box::into_raw(answer.into_boxed_slice()).cast()
}

/// Keeps the message of a panic, since the module ends by it, and only its memory can still be read.
fn listen() {
    std::panic::set_hook(Box::new(|panic| {
        *LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner) = with_head(panic.to_string().as_bytes());
    }));
}

/// Address of the message of the last panic, its length before it; null if there was none.
#[unsafe(no_mangle)]
extern "C" fn last_words() -> *const u8 {
    let words = LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner);
    if words.is_empty() { std::ptr::null() } else { words.as_ptr() }
}

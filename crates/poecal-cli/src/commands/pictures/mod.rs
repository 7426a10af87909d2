//! Commands about pictures.

#[cfg(any(unix, windows))]
pub(crate) mod board;
#[cfg(any(unix, windows))]
pub(crate) mod detect;
#[cfg(any(unix, windows))]
pub(crate) mod photograph;

//! Commands about pictures.

pub(crate) mod board;
pub(crate) mod detect;
pub(crate) mod photograph;

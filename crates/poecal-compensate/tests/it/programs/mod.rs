//! Programs in the languages of controllers.

mod expected;
mod fanuc;
mod krl;
mod rapid;
mod slots;
mod urscript;

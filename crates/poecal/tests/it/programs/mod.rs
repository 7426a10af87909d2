//! Programs in the languages of controllers.

mod krl;
mod slots;
mod urscript;

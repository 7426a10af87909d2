//! Programs in the languages of controllers.

mod expected;
mod fanuc;
mod rapid;

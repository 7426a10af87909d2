//! The `poecal` program.

fn main() -> std::process::ExitCode {
    poecal_cli::run(std::env::args_os())
}

//! `fumarole`: every paper, devices, comparisons.

fn main() -> std::process::ExitCode {
    fumarole::cli::umbrella()
}

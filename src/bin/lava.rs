//! `lava`: the paper's own benchmark binary.

fn main() -> std::process::ExitCode {
    fumarole::cli::binary::<fumarole::papers::lava::setup::Setup>()
}

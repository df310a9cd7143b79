//! Exit codes: what a script can rely on.

use std::fmt;

use super::outcome;
use crate::file::OutputError;
use crate::measure::Error;
use crate::measure::compare::CompareError;
use crate::report::json::ReadError;
use crate::{gpu, image};

/// Why a command ended without doing all that was asked.
#[derive(Debug)]
pub enum Failure {
    /// Exit code 1: it failed while running.
    Running(String),
    /// Exit code 2: bad arguments or bad input.
    Input(String),
    /// Exit code 3: no usable Vulkan device.
    NoDevice(String),
    /// Exit code 4: `compare` found a regression; its report is already printed.
    Regression,
}

impl Failure {
    /// The exit code of a program that ends so, 1 to 4.
    pub fn code(&self) -> u8 {
        match self {
            Failure::Running(_) => 1,
            Failure::Input(_) => 2,
            Failure::NoDevice(_) => 3,
            Failure::Regression => 4,
        }
    }

    /// The same of one of several, which the message begins with.
    pub fn of(self, whose: &str) -> Self {
        match self {
            Failure::Running(message) => Failure::Running(format!("{whose}: {message}")),
            Failure::Input(message) => Failure::Input(format!("{whose}: {message}")),
            Failure::NoDevice(message) => Failure::NoDevice(format!("{whose}: {message}")),
            Failure::Regression => Failure::Regression,
        }
    }

    /// Prints the error's one line on standard error and gives the exit code.
    pub fn report(self) -> u8 {
        let code = self.code();
        let (Failure::Running(message) | Failure::Input(message) | Failure::NoDevice(message)) = self else {
            return code;
        };
        /// Characters; a library's message may quote a whole file.
        const LONGEST: usize = 2_000;
        let mut line = joined(&message);
        if let Some((end, _)) = line.char_indices().nth(LONGEST) {
            line.truncate(end);
            line.push_str("...");
        }
        outcome::say(&format!("error: {line}"));
        code
    }
}

/// One line of a message, whatever a library put into it. Spaces in a line may be those of a file's name.
fn joined(message: &str) -> String {
    let lines = message.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ")
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Running(message) | Failure::Input(message) | Failure::NoDevice(message) => {
                formatter.write_str(message)
            }
            Failure::Regression => Ok(()),
        }
    }
}

impl From<clap::Error> for Failure {
    fn from(error: clap::Error) -> Self {
        Failure::Input(error.to_string())
    }
}

impl From<gpu::Error> for Failure {
    fn from(error: gpu::Error) -> Self {
        use gpu::Error as E;
        let message = error.to_string();
        match error {
            E::NoLoader { .. } | E::NoInstance { .. } | E::NoDevice { .. } => {
                Failure::NoDevice(message + &memory_limit().unwrap_or_default())
            }
            E::NoValidationLayer => Failure::NoDevice(message),
            E::MissingFeature { .. } => Failure::NoDevice(message),
            E::UnknownDevice { .. }
            | E::AmbiguousDevice { .. }
            | E::Limit { .. }
            | E::Filling { .. }
            | E::Shader { .. }
            | E::Capture { .. } => Failure::Input(message),
            E::OutOfMemory { .. } | E::Allocation { .. } => {
                Failure::Running(message + &memory_limit().unwrap_or_default())
            }
            E::Vulkan { .. }
            | E::ReadBeforeWrite { .. }
            | E::InUse { .. }
            | E::Foreign { .. }
            | E::HostAccess { .. }
            | E::Unsupported { .. }
            | E::Pass { .. }
            | E::BeyondEnd { .. }
            | E::Interrupted
            | E::Validation { .. } => Failure::Running(message),
        }
    }
}

/// The limit of this process's memory as the end of a message: where a driver finds too little, it is none to the loader.
#[cfg(unix)]
fn memory_limit() -> Option<String> {
    use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit};
    let (bytes, _) = getrlimit(Resource::RLIMIT_AS).ok().filter(|(bytes, _)| *bytes != RLIM_INFINITY)?;
    Some(format!("; or raise the limit of memory, {} MiB (ulimit -v), which may be too low", bytes >> 20))
}

/// No other system has that limit.
#[cfg(not(unix))]
fn memory_limit() -> Option<String> {
    None
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Gpu(error) => error.into(),
            Error::Image(error) => error.into(),
            Error::Parameter(error) => Failure::Input(format!("--{error}")),
            Error::Scene(crate::scene::Error::Interrupted { .. }) => Failure::Running(error.to_string()),
            Error::Scene(_) | Error::Output(_) | Error::Input(_) => Failure::Input(error.to_string()),
            Error::Plot(_) | Error::Law(_) | Error::Interrupted | Error::Shared => Failure::Running(error.to_string()),
        }
    }
}

#[cfg(feature = "window")]
impl From<crate::window::Error> for Failure {
    fn from(error: crate::window::Error) -> Self {
        use crate::window::Error as E;
        let message = error.to_string();
        match error {
            E::Gpu(error) => error.into(),
            E::NoDisplay { .. } | E::Refused { code: 3, .. } => Failure::NoDevice(message),
            E::Controls { .. } | E::Refused { code: 2, .. } => Failure::Input(message),
            E::Worker { .. } | E::Refused { .. } | E::Loop { .. } => Failure::Running(message),
        }
    }
}

impl From<image::Error> for Failure {
    fn from(error: image::Error) -> Self {
        Failure::Input(error.to_string())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Failure::Input(error.to_string())
    }
}

impl From<CompareError> for Failure {
    fn from(error: CompareError) -> Self {
        Failure::Input(error.to_string())
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Failure::Input(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_joined_and_names_are_as_they_are() {
        assert_eq!(joined("writing a  b\t.png: no\n\n   space  "), "writing a  b\t.png: no space");
    }
}

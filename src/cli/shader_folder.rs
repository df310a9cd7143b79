//! `--shader-dir`: a process of its own compiles the folder first, within limits. A short text can take all memory, stack or time
//! of a compiler, and what ends a compiler would end the program.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::failure::Failure;
use super::outcome;
use super::processes::finish_within;
use super::watch::interrupted;
use crate::gpu;
use crate::measure::Error;

/// First argument of that process. It is no verb of the user's.
const VERB: &str = "compile-shaders";
/// Before a shader's name on its standard error, where the shader is begun.
const BEGUN: &str = "compiling: ";
/// Until all are compiled, whatever else the machine does; where processor time cannot be limited, the only limit.
const PATIENCE: Duration = Duration::from_secs(600);

/// Programs that give their arguments to [`answer`], and so may be started with [`VERB`]. One that has us as a library may not.
static ANSWERS: OnceLock<()> = OnceLock::new();

/// Compiles and ends, where the program was started for that. To be called first in `main`.
pub fn answer() -> Option<ExitCode> {
    let _ = ANSWERS.set(());
    let mut arguments = std::env::args_os().skip(1);
    if arguments.next()? != VERB {
        return None;
    }
    let (folder, None) = (PathBuf::from(arguments.next()?), arguments.next()) else { return None };
    let mut limits = None;
    let compiled = gpu::Replacements::read_with(Some(&folder), &mut |shader, text_bytes| {
        let limits = limits.get_or_insert_with(|| {
            gpu::warm_up_compilers();
            Limits::of_process()
        });
        outcome::say(&format!("{BEGUN}{shader}"));
        limits.set_for(text_bytes);
    });
    Some(ExitCode::from(if compiled.is_ok() { 0 } else { 2 }))
}

/// Tries whether the compilers live through the shaders of a folder. What they refuse is for the caller, who compiles them again, to tell.
///
/// # Errors
/// [`Failure::Input`] with the shader at which a compiler came to its end.
pub fn check(folder: Option<&Path>) -> Result<(), Failure> {
    let (Some(folder), Some(())) = (folder, ANSWERS.get()) else { return Ok(()) };
    let failed = |e: std::io::Error| Failure::Running(format!("compiling shaders in a fresh process: {e}"));
    let mut command = Command::new(std::env::current_exe().map_err(failed)?);
    command.args([OsString::from(VERB), folder.into()]).stdin(Stdio::null());
    let ended = finish_within(&mut command, interrupted(), Some(Instant::now() + PATIENCE)).map_err(failed)?;
    if matches!(ended.status.code(), Some(0 | 2)) {
        return Ok(());
    }
    if interrupted().load(Ordering::Relaxed) {
        return Err(Error::Interrupted.into());
    }
    let shader = ended.last_after(BEGUN).unwrap_or("its first shader");
    Err(Failure::Input(format!(
        "shader {}: {shader} brought a compiler to its end ({}): its text asks for more memory ({} MiB and {TIMES_TEXT} times the \
         text), stack or processor time ({SECONDS} s) than one gets here; make it simpler",
        folder.display(),
        ended.status,
        SPARE_BYTES >> 20,
    )))
}

/// Memory beside the program's own, the compilers' tables and that for the texts.
const SPARE_BYTES: u64 = 64 << 20;
/// Bytes of memory for each byte of the texts after their includes.
const TIMES_TEXT: u64 = 16;
/// Processor time of one shader, seconds.
const SECONDS: u64 = 2;

/// Limits of this process, raised with each shader.
struct Limits {
    /// Writable memory of its own that the process may have, where the system tells how much that is.
    #[cfg_attr(not(unix), expect(dead_code, reason = "there are no such limits"))]
    bytes: Option<u64>,
}

impl Limits {
    /// Those of a process whose compilers have their tables, which are larger than what a shader takes.
    fn of_process() -> Limits {
        // Linux alone has it.
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let data = status.lines().find_map(|line| line.strip_prefix("VmData:")?.trim().strip_suffix("kB"));
        let own_kib = data.and_then(|kib| kib.trim().parse::<u64>().ok());
        Limits { bytes: own_kib.map(|kib| (kib << 10) + SPARE_BYTES) }
    }

    /// Lets one more shader be compiled. What cannot be limited is not: the compilers are at their work all the same.
    #[cfg(unix)]
    fn set_for(&mut self, text_bytes: usize) {
        use nix::sys::resource::{Resource, UsageWho, getrlimit, getrusage, setrlimit};
        let limit = |resource, limit: u64| {
            let _ = getrlimit(resource).and_then(|(_, hard)| setrlimit(resource, limit.min(hard), hard));
        };
        if let Some(bytes) = &mut self.bytes {
            *bytes += TIMES_TEXT * text_bytes as u64;
            limit(Resource::RLIMIT_DATA, *bytes);
        }
        if let Ok(usage) = getrusage(UsageWho::RUSAGE_SELF) {
            let seconds = usage.user_time().tv_sec() + usage.system_time().tv_sec();
            // Each of the two is cut to whole seconds, and so is the limit.
            limit(Resource::RLIMIT_CPU, seconds.unsigned_abs() + 2 + SECONDS);
        }
        // A compiler's end leaves no file.
        limit(Resource::RLIMIT_CORE, 0);
    }

    #[cfg(not(unix))]
    fn set_for(&mut self, _: usize) {}
}

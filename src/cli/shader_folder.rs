//! `--shader-dir`: a process of its own compiles the folder, within limits. A short text can take all memory, stack or time of a
//! compiler, and what ends a compiler would end the program.

use std::ffi::OsString;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::failure::Failure;
use super::processes::finish_within;
use super::watch::interrupted;
use crate::gpu;
use crate::measure::Error;

/// First argument of that process. It is no verb of the user's.
const VERB: &str = "compile-shaders";
/// Exit code for a folder that is refused.
const REFUSED: i32 = 2;
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
        // Who started this may be gone: what is compiled then is for nobody.
        if writeln!(io::stderr(), "{BEGUN}{}", shader.escape_debug()).is_err() {
            std::process::exit(1);
        }
        limits.set_for(text_bytes);
    });
    // What does not arrive is compiled once more.
    let handed_over = compiled.map(|compiled| compiled.hand_over(BufWriter::new(io::stdout())));
    Some(ExitCode::from(handed_over.map_or_else(|error| Failure::from(error).report(), |_| 0)))
}

/// Compiles the shaders of a folder for this process, so that nothing in them ends it.
///
/// # Errors
/// [`Failure::Input`] for a folder that is refused, and for a shader at which a compiler came to its end; [`Failure::Running`] where
/// that cannot be found out.
pub fn check(folder: Option<&Path>) -> Result<(), Failure> {
    let (Some(folder), Some(())) = (folder, ANSWERS.get()) else { return Ok(()) };
    let compiling = format!("compiling the shaders of {} in a fresh process", folder.display());
    let failed =
        |e: io::Error| Failure::Running(format!("{compiling}: {e}; let another process be started and try again"));
    let mut command = Command::new(std::env::current_exe().map_err(failed)?);
    command.args([OsString::from(VERB), folder.into()]).stdin(Stdio::null()).stdout(Stdio::piped());
    let ended = finish_within(&mut command, interrupted(), Some(Instant::now() + PATIENCE)).map_err(failed)?;
    match ended.status.code() {
        Some(0) => {
            gpu::take_compiled(&ended.output);
            return Ok(());
        }
        // Told in the words that it would have here.
        Some(REFUSED) => return Err(ended.failure(ended.message())),
        _ => {}
    }
    if interrupted().load(Ordering::Relaxed) {
        return Err(Error::Interrupted.into());
    }
    let Some(shader) = ended.last_after(BEGUN).filter(|_| !ended.is_late) else {
        let reason = if ended.is_late { format!("{} s were not enough", PATIENCE.as_secs()) } else { ended.message() };
        return Err(Failure::Running(format!(
            "{compiling}: {reason}; try again, or with fewer shaders that are changed"
        )));
    };
    Err(Failure::Input(format!(
        "shader {}: {shader} brought a compiler to its end ({}): its text asks for more memory ({} MiB and {TIMES_TEXT} times the \
         text), stack or processor time ({SECONDS} s) than one gets here; make it simpler",
        folder.display(),
        ended.status,
        SPARE_BYTES >> 20,
    )))
}

/// Memory beside the program's own, the compilers' tables, the built-in binaries and that for the texts.
const SPARE_BYTES: u64 = 64 << 20;
/// Bytes of memory for each byte of the texts after their includes.
const TIMES_TEXT: u64 = 16;
/// Processor time of one shader, seconds.
const SECONDS: u64 = 2;

/// Stack that the program may have in use where it compiles.
#[cfg(unix)]
const USED_STACK_BYTES: u64 = 1 << 20;

/// Sets a limit of this process by the one it has, no higher than it may be. One that cannot be set is not: the compilers are at
/// their work all the same.
#[cfg(unix)]
fn limit(resource: nix::sys::resource::Resource, of: impl FnOnce(u64) -> u64) {
    use nix::sys::resource::{getrlimit, setrlimit};
    let _ = getrlimit(resource).and_then(|(soft, hard)| setrlimit(resource, of(soft).min(hard), hard));
}

/// Limits of this process, raised with each shader.
struct Limits {
    /// Writable memory of its own that the process may have, where the system tells how much that is.
    #[cfg_attr(not(unix), expect(dead_code, reason = "there are no such limits"))]
    bytes: Option<u64>,
}

impl Limits {
    /// Those of a process whose compilers have their tables, which are larger than what a shader takes.
    fn of_process() -> Limits {
        #[cfg(unix)]
        {
            use nix::sys::resource::Resource;
            // Where it started this, the program compiles on a stack that is in use already.
            limit(Resource::RLIMIT_STACK, |bytes| bytes - (bytes / 4).min(USED_STACK_BYTES));
            // A compiler's end leaves no file.
            limit(Resource::RLIMIT_CORE, |_| 0);
        }
        // Linux alone has it.
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let data = status.lines().find_map(|line| line.strip_prefix("VmData:")?.trim().strip_suffix("kB"));
        let own_kib = data.and_then(|kib| kib.trim().parse::<u64>().ok());
        // Of unchanged shaders they are copied.
        let built_in_bytes = gpu::built_in_shader_bytes();
        Limits { bytes: own_kib.map(|kib| (kib << 10) + built_in_bytes + SPARE_BYTES) }
    }

    /// Lets one more shader be compiled.
    #[cfg(unix)]
    fn set_for(&mut self, text_bytes: usize) {
        use nix::sys::resource::{Resource, UsageWho, getrusage};
        if let Some(bytes) = &mut self.bytes {
            *bytes += TIMES_TEXT * text_bytes as u64;
            limit(Resource::RLIMIT_DATA, |_| *bytes);
        }
        if let Ok(usage) = getrusage(UsageWho::RUSAGE_SELF) {
            let seconds = usage.user_time().tv_sec() + usage.system_time().tv_sec();
            // Each of the two is cut to whole seconds, and so is the limit.
            limit(Resource::RLIMIT_CPU, |_| seconds.unsigned_abs() + 2 + SECONDS);
        }
    }

    #[cfg(not(unix))]
    fn set_for(&mut self, _: usize) {}
}

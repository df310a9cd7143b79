//! The programs as the tests run them, and their output.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::common::beside_others;

/// The smallest scene that still has every pass, on one device.
pub const SCENE: &str = "--size 96x64 --map-size 64 --water-triangles 500 --planes 5";
/// The shortest measurement.
pub const ONCE: &str = "--frames 2 --repeat 1 --warmup 1 --no-limits";

/// Far above what any of these runs takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// Index, UUID or part of the name of the device that the tests run on.
pub fn device() -> String {
    env::var("FUMAROLE_TEST_DEVICE").unwrap_or_else(|_| "llvmpipe".to_owned())
}

/// A command line in the making. It runs in an empty folder of its own unless told otherwise, so that nothing that it
/// writes under a relative name stays in the repository.
pub struct Program {
    command: Command,
}

/// The paper's own binary.
pub fn caustics(arguments: &str) -> Program {
    Program::new(env!("CARGO_BIN_EXE_caustics")).args(arguments)
}

/// As [`caustics`].
pub fn lava(arguments: &str) -> Program {
    Program::new(env!("CARGO_BIN_EXE_lava")).args(arguments)
}

/// As [`caustics`].
pub fn gas(arguments: &str) -> Program {
    Program::new(env!("CARGO_BIN_EXE_gas")).args(arguments)
}

/// As [`caustics`].
pub fn terrain(arguments: &str) -> Program {
    Program::new(env!("CARGO_BIN_EXE_terrain")).args(arguments)
}

/// As [`caustics`].
pub fn burning(arguments: &str) -> Program {
    Program::new(env!("CARGO_BIN_EXE_burning")).args(arguments)
}

/// The umbrella.
pub fn fumarole(arguments: &str) -> Program {
    Program::new(env!("CARGO_BIN_EXE_fumarole")).args(arguments)
}

impl Program {
    fn new(path: &str) -> Self {
        let mut command = Command::new(path);
        // Meshes and layouts of tests are no use to whoever runs them.
        let cache = concat!(env!("CARGO_TARGET_TMPDIR"), "/cache");
        let state = concat!(env!("CARGO_TARGET_TMPDIR"), "/state");
        command
            .stdin(Stdio::null())
            .env_remove("NO_COLOR")
            .env_remove("VK_ADD_LAYER_PATH")
            .env("XDG_CACHE_HOME", cache)
            .env("XDG_STATE_HOME", state);
        Program { command }
    }

    /// Appends words, parted by spaces.
    pub fn args(mut self, words: &str) -> Self {
        self.command.args(words.split_whitespace());
        self
    }

    /// Appends one argument, which may hold anything.
    pub fn arg(mut self, argument: impl AsRef<OsStr>) -> Self {
        self.command.arg(argument);
        self
    }

    /// Appends the tiny scene and the device of the tests.
    pub fn tiny(self) -> Self {
        self.tiny_but("")
    }

    /// Appends `options`, and of the tiny scene and the device of the tests what they do not set themselves.
    pub fn tiny_but(self, options: &str) -> Self {
        let given: Vec<&str> = options.split_whitespace().collect();
        let words: Vec<&str> = SCENE.split_whitespace().collect();
        let kept = words.chunks(2).filter(|option| !given.contains(&option[0]));
        let program = kept.fold(self.args(options), |program, option| program.arg(option[0]).arg(option[1]));
        if given.contains(&"--device") { program } else { program.on_test_device() }
    }

    pub fn on_test_device(self) -> Self {
        self.arg("--device").arg(device())
    }

    pub fn env(mut self, name: &str, value: impl AsRef<OsStr>) -> Self {
        self.command.env(name, value);
        self
    }

    /// Runs without a variable of the environment.
    pub fn without(mut self, name: &str) -> Self {
        self.command.env_remove(name);
        self
    }

    /// Runs in `folder`, which outlives it: `fumarole-out/` and relative names land there.
    pub fn inside(mut self, folder: &Path) -> Self {
        self.command.current_dir(folder);
        self
    }

    /// Runs it by another program, which is given its command line after words of its own.
    pub fn under(self, words: &str) -> Self {
        let mut words = words.split_whitespace();
        let mut command = Command::new(words.next().expect("a program"));
        command.args(words).arg(self.command.get_program()).args(self.command.get_args()).stdin(Stdio::null());
        for (name, value) in self.command.get_envs() {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        if let Some(folder) = self.command.get_current_dir() {
            command.current_dir(folder);
        }
        Program { command }
    }

    /// The command for a shell, each word quoted.
    pub fn for_shell(&self) -> String {
        let words = std::iter::once(self.command.get_program()).chain(self.command.get_args());
        let quoted = words.map(|word| format!("'{}'", word.to_str().unwrap().replace('\'', r"'\''")));
        quoted.collect::<Vec<_>>().join(" ")
    }

    /// Starts it in a process group of its own, as a terminal does.
    pub fn start(mut self) -> Running {
        use std::os::unix::process::CommandExt;
        self.command.process_group(0);
        let text = format!("{:?}", self.command);
        let own = self.command.get_current_dir().is_none().then(folder);
        if let Some(own) = &own {
            self.command.current_dir(own);
        }
        let mut child = self.command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let stdout = collect(child.stdout.take().unwrap());
        let stderr = collect(child.stderr.take().unwrap());
        Running { child, text, own, stdout, stderr }
    }

    /// Runs it to its end.
    pub fn run(self) -> Ended {
        beside_others(|| self.start().end())
    }
}

fn collect(mut pipe: impl Read + Send + 'static) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        pipe.read_to_end(&mut bytes).unwrap();
        String::from_utf8(bytes).expect("the programs print UTF-8")
    })
}

/// A started program; ended when dropped.
pub struct Running {
    child: Child,
    text: String,
    own: Option<tempfile::TempDir>,
    stdout: thread::JoinHandle<String>,
    stderr: thread::JoinHandle<String>,
}

impl Running {
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    pub fn has_ended(&mut self) -> bool {
        self.child.try_wait().unwrap().is_some()
    }

    /// Waits for its end.
    ///
    /// # Panics
    /// When it takes too long.
    pub fn end(mut self) -> Ended {
        let deadline = Instant::now() + PATIENCE;
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            if Instant::now() > deadline {
                self.child.kill().unwrap();
                panic!("{} has not ended after {PATIENCE:?}", self.text);
            }
            thread::sleep(Duration::from_millis(3));
        };
        let (stdout, stderr) = (self.stdout.join().unwrap(), self.stderr.join().unwrap());
        Ended { text: self.text, own: self.own, status, stdout, stderr }
    }
}

/// End of a program.
pub struct Ended {
    text: String,
    own: Option<tempfile::TempDir>,
    pub status: ExitStatus,
    pub stdout: String,
    pub stderr: String,
}

impl Ended {
    fn story(&self) -> String {
        format!("{}\n{}\n--- stdout\n{}\n--- stderr\n{}", self.text, self.status, self.stdout, self.stderr)
    }

    /// Asserts that it did all that was asked.
    pub fn succeeded(self) -> Self {
        assert_eq!(self.status.code(), Some(0), "{}", self.story());
        self
    }

    /// Asserts the exit code, nothing on standard output, no file in its own folder, and one clear line on standard error
    /// that holds every one of `parts`.
    pub fn refused(self, code: i32, parts: &[&str]) {
        assert_eq!(self.status.code(), Some(code), "{}", self.story());
        assert_eq!(self.stdout, "", "{}", self.story());
        assert_eq!(self.stderr.lines().count(), 1, "one line: {}", self.story());
        self.names(parts);
    }

    /// Asserts exit code 2 and the usage error of the argument parser, which may take several lines.
    pub fn misused(self, parts: &[&str]) {
        assert_eq!(self.status.code(), Some(2), "{}", self.story());
        assert_eq!(self.stdout, "", "{}", self.story());
        self.names(parts);
    }

    fn names(&self, parts: &[&str]) {
        assert!(self.stderr.starts_with("error: ") && self.stderr.ends_with('\n'), "{}", self.story());
        assert!(!self.stderr.contains("panicked"), "{}", self.story());
        // The folder of results is made before what they are of.
        let is_empty = |folder: PathBuf| folder.is_dir() && entries(&folder).is_empty();
        let left = self.own.as_ref().map(|own| (own.path(), entries(own.path())));
        let is_left = left.is_some_and(|(own, names)| names.iter().any(|name| !is_empty(own.join(name))));
        assert!(!is_left, "it left files: {}", self.story());
        for part in parts {
            assert!(self.stderr.contains(part), "{part:?} is missing: {}", self.story());
        }
    }

    /// Standard output as one JSON document.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {}", self.story()))
    }
}

/// A folder of a test's own, removed at its end.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Writes a file in `folder`.
pub fn file(folder: &tempfile::TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

pub fn read_json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Names of all files in `folder`, sorted.
pub fn entries(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

pub fn sha256(path: &Path) -> String {
    Sha256::digest(fs::read(path).unwrap()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Asserts that a record meets the checked-in schema.
pub fn assert_schema(record: &Value) {
    let schema = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.bench-1.json"));
    let validator = jsonschema::validator_for(&serde_json::from_str(schema).unwrap()).unwrap();
    let errors: Vec<String> = validator.iter_errors(record).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:#?}");
}

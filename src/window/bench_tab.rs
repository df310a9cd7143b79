//! A benchmark of what is seen, started from the window: the very command line that a shell would run.

use std::io::{self, BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use egui::{Context, Grid, ScrollArea, Ui};

use super::interface::{CommandUse, Interface};
use super::passes_panel::milliseconds;
use super::program;
use super::protocol::{Request, Verb};
use crate::gpu::for_another_process;
use crate::report::{Record, Run, json};

/// The benchmark that runs, or ran last.
#[derive(Default)]
pub struct Bench {
    running: Option<Running>,
    record: Option<Record>,
    /// File of the record.
    path: Option<PathBuf>,
    problem: Option<String>,
}

/// A benchmark that runs. It ends when this is dropped.
struct Running {
    child: Child,
    started: Instant,
    path: PathBuf,
    /// Reads standard error, on which a full pipe would hold it up, and gives its last line.
    last_line: Option<JoinHandle<Option<String>>>,
}

impl Running {
    fn start(mut command: Command, path: PathBuf) -> io::Result<Self> {
        // The record of one before would else be taken for that of one that fails.
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        let child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
        let mut running = Running { child, started: Instant::now(), path, last_line: None };
        if let Some(errors) = running.child.stderr.take() {
            running.last_line = Some(thread::Builder::new().name("errors".into()).spawn(|| last_line(errors))?);
        }
        Ok(running)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill().and_then(|()| self.child.wait().map(drop));
    }
}

/// The last line of a text, of which no more than its begin is kept.
fn last_line(text: impl Read) -> Option<String> {
    /// Bytes of a line; a library's message may quote a whole file.
    const LONGEST: u64 = 2_000;
    let (mut text, mut last, mut line) = (BufReader::new(text), None, Vec::new());
    while text.by_ref().take(LONGEST).read_until(b'\n', &mut line).is_ok_and(|read_bytes| read_bytes > 0) {
        let is_cut = !line.ends_with(b"\n") && text.skip_until(b'\n').is_ok_and(|left_bytes| left_bytes > 0);
        let end = if is_cut { "..." } else { "" };
        last = Some(format!("{}{end}", String::from_utf8_lossy(&line).trim_end()));
        line.clear();
    }
    last
}

/// The program with these arguments, and `--json FILE` behind them; and that file.
fn command(arguments: &[String]) -> io::Result<(Command, PathBuf)> {
    let folder = PathBuf::from("fumarole-out");
    std::fs::create_dir_all(&folder)?;
    let path = folder.join(format!("window-bench-{}.json", std::process::id()));
    let mut command = Command::new(program::umbrella()?);
    command.args(arguments).arg("--quiet").arg("--json").arg(&path);
    for_another_process(&mut command);
    Ok((command, path))
}

impl Bench {
    /// Runs the program with these arguments, unless a benchmark runs, which would write the same file.
    pub fn start(&mut self, arguments: Vec<String>) {
        if self.running.is_some() {
            return;
        }
        self.problem = None;
        self.record = None;
        match command(&arguments).and_then(|(command, path)| Running::start(command, path)) {
            Ok(running) => self.running = Some(running),
            Err(error) => self.problem = Some(format!("starting the benchmark: {error}")),
        }
    }

    /// Looks whether it has ended.
    pub fn poll(&mut self, context: &Context) {
        let Some(running) = &mut self.running else { return };
        match running.child.try_wait() {
            Ok(None) => context.request_repaint_after(Duration::from_millis(500)),
            ended => {
                if let Some(running) = self.running.take() {
                    self.end(running, ended.ok().flatten().is_some_and(|status| status.success()));
                }
                context.request_repaint();
            }
        }
    }

    fn end(&mut self, mut running: Running, has_succeeded: bool) {
        let record = json::read(&running.path);
        if !has_succeeded {
            let last = running.last_line.take().and_then(|reader| reader.join().ok().flatten());
            self.problem = Some(format!("benchmark: {}", last.as_deref().unwrap_or("it ended without a word")));
        } else if let Err(error) = &record {
            self.problem = Some(format!("benchmark: {error}"));
        }
        self.record = record.ok();
        self.path = Some(std::mem::take(&mut running.path));
    }
}

/// The button and the last record.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    ui.horizontal_wrapped(|ui| {
        match &face.bench.running {
            None => {
                let start = ui.button("Run bench").on_hover_text(
                    "Times what is seen with the exact command of \"as bench\", in a process of its own; the clock pauses",
                );
                if start.clicked() {
                    face.ask(Request::Pause);
                    face.ask_command(Verb::Bench, CommandUse::Bench);
                }
            }
            Some(running) => {
                ui.spinner();
                ui.label(format!("running for {:.0} s", running.started.elapsed().as_secs_f32()));
                if ui.button("Stop").clicked() {
                    face.bench.running = None;
                }
            }
        }
        if let Some(problem) = &face.bench.problem {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        if let Some(path) = face.bench.path.as_ref().filter(|_| face.bench.record.is_some()) {
            ui.weak(format!("record: {}", path.display()));
        }
    });
    let Some(record) = &face.bench.record else { return };
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            for (index, run) in record.runs.iter().enumerate() {
                Grid::new(("record", index)).striped(true).show(ui, |ui| show_run(ui, run));
                ui.separator();
            }
        });
    });
}

fn show_run(ui: &mut Ui, run: &Run) {
    ui.strong(run.variant.as_str());
    ui.monospace(milliseconds(run.median_frame_ms()));
    ui.weak("ms a frame");
    ui.end_row();
    for pass in &run.passes {
        ui.label(pass.name.as_str());
        for time in [&pass.gpu_ms, &pass.host_ms] {
            ui.monospace(milliseconds(time.as_ref().map(|time| time.median)));
        }
        ui.end_row();
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn running(script: &str) -> Bench {
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script]);
        Bench { running: Some(Running::start(command, "no-such.json".into()).unwrap()), ..Bench::default() }
    }

    #[test]
    fn one_that_says_more_than_a_pipe_holds_ends_and_its_last_line_is_told() {
        let mut bench = running("head -c 200000 /dev/zero | tr '\\000' '\\n' >&2; echo out of paper >&2; exit 1");
        let (context, started) = (Context::default(), Instant::now());
        while bench.running.is_some() {
            assert!(started.elapsed() < Duration::from_secs(20), "it stays");
            thread::sleep(Duration::from_millis(2));
            bench.poll(&context);
        }
        assert_eq!(bench.problem.as_deref(), Some("benchmark: out of paper"));
    }

    #[test]
    fn of_a_line_without_an_end_the_begin_is_told() {
        let mut endless = io::Cursor::new(b"first\n").chain(io::repeat(b'x').take(1 << 26));
        let line = last_line(&mut endless).unwrap();
        assert!(line.len() < 3_000 && line.capacity() < 10_000 && line.ends_with("xxx..."), "{}", line.len());
        assert_eq!(last_line(&b"one\ntwo  \n"[..]).as_deref(), Some("two"));
        assert_eq!(last_line(&b"one\ntwo"[..]).as_deref(), Some("two"));
        assert_eq!(last_line(&b""[..]), None);
    }

    #[test]
    fn one_that_fails_shows_no_record_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        std::fs::write(&path, "{}").unwrap();
        let mut command = Command::new("/bin/sh");
        command.args(["-c", "exit 1"]);
        let mut running = Running::start(command, path).unwrap();
        running.child.wait().unwrap();
        let mut bench = Bench::default();
        bench.end(running, false);
        assert_eq!(bench.record, None);
        assert!(bench.problem.is_some());
    }

    #[test]
    fn one_whose_record_is_too_large_to_be_read_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        let mut running = Running::start(Command::new("true"), path.clone()).unwrap();
        assert!(running.child.wait().unwrap().success());
        std::fs::File::create(&path).unwrap().set_len(8 << 30).unwrap();
        let mut bench = Bench::default();
        bench.end(running, true);
        assert_eq!(bench.record, None);
        let problem = bench.problem.unwrap();
        assert!(problem.starts_with("benchmark: ") && problem.contains("exceed the limit"), "{problem}");
    }

    #[test]
    fn while_one_runs_no_other_is_started() {
        let mut bench = running("exec sleep 100");
        let id = |bench: &Bench| bench.running.as_ref().map(|running| running.child.id());
        let first = id(&bench);
        bench.start(Vec::new());
        assert_eq!((id(&bench), bench.problem.as_deref()), (first, None));
    }
}

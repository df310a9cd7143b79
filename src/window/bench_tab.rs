//! A benchmark of what is seen, started from the window: the very command line that a shell would run.

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use egui::{Context, Grid, ScrollArea, Ui};
use serde_json::Value;

use super::interface::{CommandUse, Interface};
use super::passes_panel::milliseconds;
use super::program;
use super::protocol::{Request, Verb};
use crate::gpu::for_another_process;

/// The benchmark that runs, or ran last.
#[derive(Default)]
pub struct Bench {
    running: Option<Running>,
    record: Option<Value>,
    /// File of the record.
    path: Option<PathBuf>,
    problem: Option<String>,
}

struct Running {
    child: Child,
    started: Instant,
    path: PathBuf,
}

impl Bench {
    /// Runs the program with these arguments, and `--json FILE` behind them.
    pub fn start(&mut self, arguments: Vec<String>) {
        self.problem = None;
        self.record = None;
        if let Err(error) = self.try_start(&arguments) {
            self.problem = Some(format!("starting the benchmark: {error}"));
        }
    }

    fn try_start(&mut self, arguments: &[String]) -> std::io::Result<()> {
        let folder = PathBuf::from("fumarole-out");
        std::fs::create_dir_all(&folder)?;
        let path = folder.join(format!("window-bench-{}.json", std::process::id()));
        let mut command = Command::new(program::umbrella()?);
        command.args(arguments).arg("--quiet").arg("--json").arg(&path);
        for_another_process(&mut command);
        let child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
        self.running = Some(Running { child, started: Instant::now(), path });
        Ok(())
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

    fn end(&mut self, running: Running, has_succeeded: bool) {
        let Running { mut child, path, .. } = running;
        let record = std::fs::read(&path).ok().and_then(|text| serde_json::from_slice(&text).ok());
        if !has_succeeded || record.is_none() {
            let mut words = String::new();
            if let Some(mut errors) = child.stderr.take() {
                let _ = std::io::Read::read_to_string(&mut errors, &mut words);
            }
            let last = words.lines().last().unwrap_or("it ended without a word");
            self.problem = Some(format!("benchmark: {last}"));
        }
        self.record = record;
        self.path = Some(path);
    }

    fn stop(&mut self) {
        if let Some(mut running) = self.running.take() {
            let _ = running.child.kill().and_then(|()| running.child.wait().map(drop));
        }
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.stop();
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
                    face.bench.stop();
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
    let runs = record["runs"].as_array().map(Vec::as_slice).unwrap_or_default();
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            for (index, run) in runs.iter().enumerate() {
                Grid::new(("record", index)).striped(true).show(ui, |ui| show_run(ui, run));
                ui.separator();
            }
        });
    });
}

fn show_run(ui: &mut Ui, run: &Value) {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    ui.strong(text(&run["variant"]));
    ui.monospace(milliseconds(run["frame_ms"]["median"].as_f64()));
    ui.weak("ms a frame");
    ui.end_row();
    for pass in run["passes"].as_array().into_iter().flatten() {
        ui.label(text(&pass["name"]));
        ui.monospace(milliseconds(pass["gpu_ms"]["median"].as_f64()));
        ui.monospace(milliseconds(pass["host_ms"]["median"].as_f64()));
        ui.end_row();
    }
}

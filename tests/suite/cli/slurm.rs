//! A film on a real Slurm of one node: 24 frames by 6 tasks, one of them killed, equal to the film of one process.

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::program::{device, entries, file, folder, gas};
use crate::common::beside_others;

/// From the start of the node to its end, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(180);

fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("dist/slurm").join(name)
}

fn succeeded(output: Output) -> String {
    let [out, errors] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(output.status.success(), "{}\n{out}\n{errors}", output.status);
    out
}

/// Command that runs another as root: slurmd starts tasks of any user.
fn as_root() -> Command {
    let is_root = fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0);
    let mut command = Command::new(if is_root { "env" } else { "sudo" });
    command.args(if is_root { &[][..] } else { &["-n", "env"] });
    command
}

/// A node that runs until it is dropped, or the tests end in whatever way: its standard input ends with them.
struct Node {
    process: Child,
    folder: TempDir,
}

impl Node {
    fn start() -> Self {
        let folder = folder();
        let mut command = as_root();
        command.arg(script("node")).arg(folder.path().join("node"));
        // A signal from the terminal reaches it through its input alone, in time to end its daemons.
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).process_group(0).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let node = Node { process, folder };
        assert_eq!(line.trim(), format!("export SLURM_CONF={}", node.configuration().display()));
        node
    }

    fn configuration(&self) -> PathBuf {
        self.folder.path().join("node/slurm.conf")
    }

    fn run(&self, command: &mut Command) -> Output {
        command.env("SLURM_CONF", self.configuration()).output().unwrap()
    }

    /// Numbers of the processes that have the configuration in their environment.
    fn processes(&self) -> Vec<String> {
        let mark = format!("SLURM_CONF={}", self.configuration().display());
        let processes = fs::read_dir("/proc").unwrap().map(|entry| entry.unwrap().path());
        let is_of_node = |path: &PathBuf| {
            fs::read(path.join("environ")).is_ok_and(|e| e.split(|&byte| byte == 0).any(|v| v == mark.as_bytes()))
        };
        processes.filter(is_of_node).map(|path| path.file_name().unwrap().to_string_lossy().into_owned()).collect()
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        drop(self.process.stdin.take());
        let _ended = self.process.wait();
    }
}

const FILM: &str = "render --frame 0..24 --size 90x63 --preset fig-7 --frame-step 20 --quiet";

/// The program, but the first time that it is task 4 it leaves two of four frames unfinished, says so and hangs.
fn hanging(folder: &TempDir) -> PathBuf {
    let program = env!("CARGO_BIN_EXE_fumarole");
    let text = format!(
        "#!/usr/bin/env bash\n\
         set -e\n\
         {program} \"$@\"\n\
         here=$(dirname \"$0\")\n\
         [ \"${{SLURM_ARRAY_TASK_ID:-}}\" = 4 ] && mkdir \"$here/first\" 2>/dev/null || exit 0\n\
         rm \"$here\"/film/parts/*-001[89].png.part.json\n\
         touch \"$here/hangs\"\n\
         exec sleep 600\n"
    );
    let path = file(folder, "hanging", text);
    fs::set_permissions(&path, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    path
}

#[test]
fn a_film_of_an_array_is_that_of_one_process_though_a_task_is_killed() {
    let out = folder();
    gas(FILM).arg("--out").arg(out.path().join("whole")).on_test_device().run().succeeded();
    let program = hanging(&out);
    beside_others(|| {
        let begun = Instant::now();
        let node = Node::start();
        let film = out.path().join("film");
        let words: Vec<&str> = FILM.split(' ').collect();
        let submit = |more: &[&str]| {
            let mut command = Command::new(script("submit"));
            command.env("FUMAROLE", &program).arg("6").arg(&film).arg("gas").args(&words).args(["--device", &device()]);
            node.run(command.args(more))
        };
        succeeded(submit(&[]));
        let job = fs::read_to_string(film.join("submitted")).unwrap().trim().to_owned();
        let running = node.run(Command::new(script("collect")).arg(&film));
        assert_eq!(running.status.code(), Some(75), "{}", String::from_utf8_lossy(&running.stdout));
        while !out.path().join("hangs").exists() {
            assert!(begun.elapsed() < PATIENCE, "task 4 did not run");
            thread::sleep(Duration::from_millis(50));
        }
        let drawn = |number: u32| {
            fs::metadata(film.join(format!("parts/gas-surfaces-{number:04}.png"))).unwrap().modified().unwrap()
        };
        let [kept, lost] = [17, 18].map(drawn);
        succeeded(node.run(Command::new("scancel").args(["--signal=KILL", "--full"]).arg(format!("{job}_4"))));
        let collected = succeeded(node.run(Command::new(script("collect")).arg("--wait").arg(&film)));
        assert!(collected.contains("tasks 4 left parts missing; submitting them again"), "{collected}");
        assert!(drawn(17) == kept && drawn(18) > lost);

        let whole = out.path().join("whole");
        assert_eq!(entries(&film.join("whole")), entries(&whole));
        assert_eq!(entries(&whole).len(), 24);
        for name in entries(&whole) {
            assert!(
                fs::read(whole.join(&name)).unwrap() == fs::read(film.join("whole").join(&name)).unwrap(),
                "{name}"
            );
        }
        // Collecting again changes nothing, and another film needs another folder.
        succeeded(node.run(Command::new(script("collect")).arg(&film)));
        let other = submit(&["--seed", "2"]);
        assert_eq!(other.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&other.stderr).contains("other work"));
        drop(node);
        println!("the film took {:.0} s on the node", begun.elapsed().as_secs_f64());
        assert!(begun.elapsed() < PATIENCE, "{:?}", begun.elapsed());
    });
}

/// A node whose tests were killed, and one that was killed itself, leave nothing that runs, and another one starts.
#[test]
fn a_node_leaves_nothing_however_it_ends() {
    beside_others(|| {
        let mut nodes = [Node::start(), Node::start()];
        succeeded(nodes[0].run(Command::new("sbatch").args(["--output=/dev/null", "--wrap=sleep 600"])));
        let [ended, killed] = &mut nodes;
        drop(ended.process.stdin.take());
        ended.process.wait().unwrap();
        let process = fs::read_to_string(killed.folder.path().join("node/pid")).unwrap();
        as_root().args(["kill", "-KILL", process.trim()]).status().unwrap();
        killed.process.wait().unwrap();
        let begun = Instant::now();
        while nodes.iter().any(|node| !node.processes().is_empty()) {
            assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", nodes.each_ref().map(Node::processes));
            thread::sleep(Duration::from_millis(50));
        }
    });
}

#[test]
fn submissions_that_cannot_work_are_refused() {
    let out = folder();
    let submit = |arguments: &[&str]| {
        let mut command = Command::new(script("submit"));
        command
            .args(arguments)
            .env("FUMAROLE", env!("CARGO_BIN_EXE_fumarole"))
            .current_dir(out.path())
            .output()
            .unwrap()
    };
    for arguments in
        [&["0", "film", "gas"][..], &["6"], &["x", "film", "gas"], &["2", "film", "gas", "render", "--shard", "0/2"]]
    {
        let output = submit(arguments);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{arguments:?}");
        assert!(!output.stderr.is_empty());
    }
    assert_eq!(entries(out.path()), [""; 0]);
    let collected = Command::new(script("collect")).arg(out.path()).output().unwrap();
    assert_eq!(collected.status.code(), Some(2));
}

/// A task tries three times, but not what another try would not mend, and gives the program its shard.
#[test]
fn a_task_that_fails_tries_again() {
    for (ends, code, calls) in
        [("1 139 0", 0, 3), ("1 1 1", 1, 3), ("0", 0, 1), ("2", 2, 1), ("3", 3, 1), ("1 2", 2, 2)]
    {
        let out = folder();
        let text = "#!/usr/bin/env bash\nhere=$(dirname \"$0\")\necho \"$@\" >>\"$here/calls\"\n\
                    ends=($ENDS)\nexit \"${ends[$(($(wc -l <\"$here/calls\") - 1))]}\"\n";
        let program = file(&out, "flaky", text);
        fs::set_permissions(&program, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
        let job = format!(
            "tasks=6\nfumarole={}\nsbatch_options=\narguments=(gas render --frame 0..24 )\n",
            program.display()
        );
        file(&out, "job", job);
        let mut task = Command::new(script("task"));
        let ended = task.arg(out.path()).env("SLURM_ARRAY_TASK_ID", "4").env("ENDS", ends).output().unwrap();
        assert_eq!(ended.status.code(), Some(code), "{ends}");
        let called = fs::read_to_string(out.path().join("calls")).unwrap();
        let words = format!("gas render --shard 4/6 --out {}/parts --frame 0..24", out.path().display());
        assert_eq!(called.lines().collect::<Vec<_>>(), vec![words.as_str(); calls], "{ends}");
    }
}

//! Shaders that are saved while the worker draws.

use std::fs;
use std::path::Path;

use fumarole::window::protocol::Event;

use super::scene::{Worker, picture, rendered, set, small};
use crate::common::beside_others;

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (path, target) = (entry.as_ref().unwrap().path(), to.join(entry.unwrap().file_name()));
        if path.is_dir() { copy(&path, &target) } else { fs::write(&target, fs::read(&path).unwrap()).unwrap() }
    }
}

#[test]
fn a_saved_shader_is_seen_and_a_broken_one_named_with_its_line() {
    beside_others(|| {
        let folder = tempfile::tempdir().unwrap();
        let shaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        copy(&shaders.join("common"), &folder.path().join("common"));
        copy(&shaders.join("gas"), &folder.path().join("gas"));
        let path = folder.path().join("gas/view.frag");
        let original = fs::read_to_string(&path).unwrap();
        let (body, _) = original.rsplit_once('}').unwrap();
        let ending = |ending: &str| fs::write(&path, format!("{body}{ending}\n}}\n")).unwrap();
        let option = format!("--shader-dir {}", folder.path().display());

        let mut worker = Worker::start("gas", &format!("{} {option}", small("gas")));
        let first = picture(&worker.frame_after(0), 0);
        assert!(first == rendered("gas", small("gas")));
        ending("    no_such_value = 1;");
        let line = body.lines().count() + 1;
        loop {
            if let Event::Failed { id, problem } = worker.next() {
                assert_eq!(id, 0);
                assert!(problem.contains(&format!("gas/view.frag:{line}")), "{problem}");
                assert!(problem.contains("no_such_value"), "{problem}");
                break;
            }
        }
        // As does one that would bring the compiler down, and the worker with it.
        let doubled: String = (1..40).map(|i| format!("#define A{i} A{0} A{0}\n", i - 1)).collect();
        fs::write(&path, format!("#version 450\n#define A0 a+=1;\n{doubled}void main() {{ int a = 1; A39 }}\n"))
            .unwrap();
        loop {
            if let Event::Failed { problem, .. } = worker.next()
                && !problem.contains("no_such_value")
            {
                assert!(problem.contains("gas/view.frag brought a compiler to its end"), "{problem}");
                break;
            }
        }
        // The old one goes on.
        let moved = picture(&worker.frame_of(set("camera", "-1,3,9,0,0.5,0")), 0);
        assert!(moved == rendered("gas", &format!("{} --camera=-1,3,9,0,0.5,0", small("gas"))));

        let output = original.lines().find(|line| line.contains("out vec")).expect("an output");
        let name = output.trim_end_matches(';').rsplit(' ').next().unwrap();
        ending(&format!("    {name}.rgb = vec3(1.0) - {name}.rgb;"));
        let serial = worker.events.iter().filter(|event| matches!(event, Event::Frame(_))).count();
        let changed = loop {
            if let Event::Frame(frame) = worker.next() {
                break picture(&frame, 0);
            }
        };
        assert!(changed != moved, "after {serial} frames");
        assert!(changed == rendered("gas", &format!("{} --camera=-1,3,9,0,0.5,0 {option}", small("gas"))));
        worker.quit();
    });
}

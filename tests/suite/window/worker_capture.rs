//! RenderDoc, where it is in the worker's process, and where it is not.

use std::path::Path;
use std::process::Command;

use fumarole::window::protocol::{Event, Request};

use super::scene::Worker;
use crate::common::beside_others;

#[test]
fn a_frame_is_captured_where_renderdoc_is_loaded() {
    beside_others(|| {
        let mut worker = Worker::small("gas");
        worker.frame_after(0);
        assert!(worker.refusal_of(Request::Capture).contains("RenderDoc"));
        assert!(worker.events.iter().any(|event| matches!(event, Event::Ready(ready) if !ready.can_capture)));
        worker.quit();

        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("librenderdoc.so");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/window/renderdoc.c");
        let mut compiler = Command::new("cc");
        compiler.args(["-shared", "-fPIC", "-Wl,-soname,librenderdoc.so", "-o"]).arg(&library).arg(source);
        let compiled = compiler.status().unwrap();
        assert!(compiled.success(), "the tests need a C compiler, as the build does");
        let mut worker = Worker::preloaded("gas", &library);
        let frame = worker.frame_after(0);
        assert!(worker.events.iter().any(|event| matches!(event, Event::Ready(ready) if ready.can_capture)));
        for number in 0..2 {
            worker.client.send(Request::Capture);
            let files = worker.wait_for(|event| match event {
                Event::Kept(files) => Some(files.clone()),
                _ => None,
            });
            assert_eq!(files, [format!("frame{number}.rdc")]);
        }
        let again = worker.frame_of(Request::After(None));
        assert_eq!(
            again.sides[0].picture.as_ref().unwrap().block.bytes,
            frame.sides[0].picture.as_ref().unwrap().block.bytes
        );
        worker.quit();
    });
}

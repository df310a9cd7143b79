//! RenderDoc, where it is in the worker's process, and where it is not.

use fumarole::window::protocol::{Event, Request};

use super::scene::Worker;
use crate::cli::depth::renderdoc;
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
        renderdoc(folder.path());
        let mut worker = Worker::under_renderdoc("gas", folder.path());
        let frame = worker.frame_after(0);
        assert!(worker.events.iter().any(|event| matches!(event, Event::Ready(ready) if ready.can_capture)));
        for number in 0..2 {
            worker.client.send(Request::Capture);
            let files = worker.wait_for(|event| match event {
                Event::Kept(files) => Some(files.clone()),
                _ => None,
            });
            let file = folder.path().join(format!("capture_frame{number}.rdc"));
            assert!(file.is_file() && files == [file.display().to_string()], "{files:?}");
        }
        let again = worker.frame_of(Request::After(None));
        assert_eq!(
            again.sides[0].picture.as_ref().unwrap().block.bytes,
            frame.sides[0].picture.as_ref().unwrap().block.bytes
        );
        worker.quit();
    });
}

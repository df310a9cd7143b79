//! A file that is dropped on the window, by the protocol that desktops speak (XDND).

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode, SelectionNotifyEvent, WindowClass,
};
use x11rb::wrapper::ConnectionExt as _;

use super::display::{Display, Window, wait};
use super::scene::small;
use crate::common::beside_others;

/// Offers `path` to the window, drops it, and answers until the window has taken it.
fn drop_file(display: &Display, window: &Window<'_>, path: &str, (x, y): (i16, i16)) {
    let connection = &display.connection;
    let source = connection.generate_id().unwrap();
    let aux = CreateWindowAux::new();
    let class = WindowClass::INPUT_OUTPUT;
    connection.create_window(0, source, display.root, 0, 0, 1, 1, 0, class, 0, &aux).unwrap().check().unwrap();
    let selection = display.atom("XdndSelection");
    connection.set_selection_owner(source, selection, 0_u32).unwrap().check().unwrap();
    let list = display.atom("text/uri-list");
    let place = (u32::from(x as u16) << 16) | u32::from(y as u16);
    let copy = display.atom("XdndActionCopy");
    let send = |name: &str, data: [u32; 4]| {
        let [a, b, c, d] = data;
        let event = ClientMessageEvent::new(32, window.id, display.atom(name), [source, a, b, c, d]);
        connection.send_event(false, window.id, EventMask::NO_EVENT, event).unwrap().check().unwrap();
    };
    send("XdndEnter", [5 << 24, list, 0, 0]);
    send("XdndPosition", [0, place, 0, copy]);
    let (status, finished) = (display.atom("XdndStatus"), display.atom("XdndFinished"));
    let mut has_dropped = false;
    wait("the end of the drop", || {
        while let Some(event) = connection.poll_for_event().unwrap() {
            match event {
                Event::SelectionRequest(request) => {
                    let text = format!("file://{path}\r\n");
                    let (requestor, property) = (request.requestor, request.property);
                    let kept =
                        connection.change_property8(PropMode::REPLACE, requestor, property, list, text.as_bytes());
                    kept.unwrap().check().unwrap();
                    let answer = SelectionNotifyEvent {
                        response_type: x11rb::protocol::xproto::SELECTION_NOTIFY_EVENT,
                        sequence: 0,
                        time: request.time,
                        requestor,
                        selection,
                        target: request.target,
                        property,
                    };
                    let mask = EventMask::NO_EVENT;
                    connection.send_event(false, requestor, mask, answer).unwrap().check().unwrap();
                }
                Event::ClientMessage(message) if message.type_ == status && !has_dropped => {
                    has_dropped = true;
                    send("XdndDrop", [0, 0, 0, 0]);
                }
                Event::ClientMessage(message) if message.type_ == finished => return Some(()),
                _ => {}
            }
        }
        None
    });
}

#[test]
fn a_mesh_that_is_dropped_is_drawn() {
    beside_others(|| {
        let display = Display::start();
        let mut window = Window::open(&display, &format!("caustics {}", small("caustics")));
        window.wait_for_frame(0);
        let mesh = window.folder.path().join("pyramid.obj");
        let text = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0.5 1 0.5\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 4 3 2 1\n";
        std::fs::write(&mesh, text).unwrap();
        let middle = window.middle("picture");
        drop_file(&display, &window, mesh.to_str().unwrap(), middle);
        window.wait("the mesh among the parameters", |window| window.says("pyramid.obj").then_some(()));
        window.close().succeeded();
    });
}

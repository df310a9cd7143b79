//! The loop of events: what happens to the window goes to the interface, what the interface asks for goes to the worker,
//! and a frame is drawn when something has changed.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_winit::accesskit_winit;
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::window::{Fullscreen, Window, WindowId};

use super::client::Client;
use super::controls;
use super::error::Error;
use super::event_loop::event_loop;
use super::interface::{Interface, Wish};
use super::layout::Layout;
use super::protocol::{Ended, Event};
use super::screen::{Drawn, Screen};
use crate::gpu::live::LiveObjects;
use crate::gpu::swapchain::PresentMode;

/// Options of a window.
#[derive(Debug, Clone)]
pub struct Options {
    /// Names of the papers, in the order of their list.
    pub papers: Vec<&'static str>,
    /// The paper that is shown first.
    pub paper: String,
    /// Arguments of the first worker behind the verb: the paper's options.
    pub arguments: Vec<OsString>,
    /// Those that a worker of any paper gets.
    pub common: Vec<OsString>,
    /// Frame that is shown first.
    pub frame: u32,
    /// The window fills its display.
    pub is_fullscreen: bool,
    /// Way of presenting.
    pub present_mode: PresentMode,
    /// Size of text and controls, on top of the display's own scale.
    pub scale: f32,
    /// Plays from the start, and ends after so many frames of the paper.
    pub exit_after: Option<u32>,
    /// The validation layer is on, in the window as in the worker.
    pub validate: bool,
    /// File that tells where the window's controls are.
    pub controls: Option<PathBuf>,
}

/// Time from one layout of the panels to the next while nothing but the paper's pictures and their numbers go on: nobody
/// reads numbers that change more often.
const LAYOUT_PAUSE: Duration = Duration::from_millis(100);

/// Events that wake the loop, beside the display's own events.
#[derive(Debug)]
pub enum Wake {
    /// The worker has said something.
    Worker,
    /// The display's assistive tools want something.
    Accessibility(accesskit_winit::Event),
    /// Ctrl-C, or a signal that ends the program.
    Quit,
}

impl From<accesskit_winit::Event> for Wake {
    fn from(event: accesskit_winit::Event) -> Self {
        Wake::Accessibility(event)
    }
}

/// Opens the window, and returns when its user closes it. `on_quit` is given what ends the window from elsewhere.
///
/// # Errors
/// [`Error::NoDisplay`] without a display; [`Error::Refused`] where the first worker refuses; any error of the Vulkan
/// layer, as a lost device.
pub fn run(options: Options, on_quit: impl FnOnce(Box<dyn Fn() + Send>)) -> Result<(), Error> {
    crate::gpu::draw_in_place();
    let events = event_loop()?;
    let proxy = events.create_proxy();
    let quit = proxy.clone();
    // A loop that has ended hears nothing, and needs nothing.
    on_quit(Box::new(move || drop(quit.send_event(Wake::Quit))));
    let mut application = Application { options, proxy, open: None, failure: None, live: None };
    let ended = events.run_app(&mut application);
    let Application { open, failure, live, options, .. } = application;
    let said = open.as_ref().and_then(|open| open.validation_message());
    let messages = open.as_ref().map(|open| open.screen.device().instance().clone());
    drop(open);
    if let Some(failure) = failure {
        return Err(failure);
    }
    ended.map_err(|error| Error::Loop { reason: error.to_string() })?;
    if let Some(instance) = messages {
        instance.check_messages()?;
    }
    if let Some(first) = said {
        return Err(crate::gpu::Error::Validation { count: 1, first }.into());
    }
    let alive = live.map(|live| live.alive()).unwrap_or_default();
    if options.validate && !alive.is_empty() {
        return Err(Error::Loop { reason: format!("objects were left alive: {alive:?}") });
    }
    Ok(())
}

struct Application {
    options: Options,
    proxy: EventLoopProxy<Wake>,
    open: Option<Open>,
    failure: Option<Error>,
    live: Option<Arc<LiveObjects>>,
}

/// The open window.
struct Open {
    client: Option<Client>,
    interface: Interface,
    input: egui_winit::State,
    context: egui::Context,
    screen: Screen,
    window: Arc<Window>,
    next_frame: Option<Instant>,
    frames_left: Option<u32>,
    had_worker: bool,
    /// The display's scale, as it was last told.
    scale: f64,
    /// A frame is asked of the display.
    is_due: bool,
    /// More has happened than new pictures.
    needs_layout: bool,
    /// When the panels were laid out last.
    laid_out: Option<Instant>,
    controls: Option<PathBuf>,
}

/// Continuation of the window, or its end.
enum Flow {
    On,
    Ended,
}

impl Application {
    fn open(&self, events: &ActiveEventLoop) -> Result<Open, Error> {
        let options = &self.options;
        let layout = Layout::load();
        let (width, height) = layout.window_size;
        let attributes = Window::default_attributes()
            .with_title("fumarole")
            .with_inner_size(winit::dpi::LogicalSize::new(width, height))
            .with_min_inner_size(winit::dpi::PhysicalSize::new(1, 1))
            .with_fullscreen(options.is_fullscreen.then_some(Fullscreen::Borderless(None)))
            // Assistive tools want to know a window before it is seen.
            .with_visible(false);
        let window = events
            .create_window(attributes)
            .map_err(|error| Error::NoDisplay { reason: format!("making a window: {error}") })?;
        let window = Arc::new(window);
        let screen = Screen::new(&window, options.validate, options.present_mode)?;
        let context = egui::Context::default();
        if options.controls.is_some() {
            context.enable_accesskit();
        }
        context.set_zoom_factor(options.scale);
        let mut input = egui_winit::State::new(
            context.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            window.theme(),
            Some(screen.most_texels()),
        );
        input.init_accesskit(events, &window, self.proxy.clone());
        window.set_visible(true);
        let mut interface = Interface::new(&context, options.papers.clone(), &options.paper, layout);
        interface.begin(options.frame, options.exit_after.is_some());
        let mut arguments = options.common.clone();
        arguments.extend(options.arguments.iter().cloned());
        Ok(Open {
            client: Some(self.worker(&options.paper, &arguments)?),
            interface,
            input,
            context,
            screen,
            scale: window.scale_factor(),
            window,
            next_frame: None,
            frames_left: options.exit_after,
            had_worker: false,
            is_due: false,
            needs_layout: true,
            laid_out: None,
            controls: options.controls.clone(),
        })
    }

    fn worker(&self, paper: &str, options: &[OsString]) -> Result<Client, Error> {
        let no_worker = |error: std::io::Error| Error::Worker { reason: error.to_string() };
        let mut arguments: Vec<OsString> = vec![paper.into(), "worker".into()];
        arguments.extend(options.iter().cloned());
        let program = super::program::umbrella().map_err(no_worker)?;
        let proxy = self.proxy.clone();
        // A loop that has ended hears nothing, and needs nothing.
        Client::spawn(&program, &arguments, move || drop(proxy.send_event(Wake::Worker))).map_err(no_worker)
    }

    /// Draws a frame, and does what the interface wishes.
    fn frame(&mut self, events: &ActiveEventLoop) -> Result<Flow, Error> {
        let Some(open) = &mut self.open else { return Ok(Flow::On) };
        if let Flow::Ended = open.hear()? {
            return Ok(Flow::Ended);
        }
        let wishes = open.draw()?;
        // One number for all, the last: no value is taken for heard before its own request is.
        let mut last = None;
        for wish in wishes {
            match wish {
                Wish::Ask(request) => {
                    let client = self.open.as_mut().and_then(|open| open.client.as_mut());
                    last = client.map(|client| client.send(request)).or(last);
                }
                Wish::Paper(paper) => self.start(&paper, &[])?,
                Wish::Restart(paper) => {
                    let arguments = self.options.arguments.clone();
                    let own = if paper == self.options.paper { arguments } else { Vec::new() };
                    self.start(&paper, &own)?;
                }
                Wish::Fullscreen => {
                    if let Some(open) = &self.open {
                        let full = open.window.fullscreen().is_none().then_some(Fullscreen::Borderless(None));
                        open.window.set_fullscreen(full);
                    }
                }
                Wish::Quit => return Ok(Flow::Ended),
            }
        }
        if let (Some(open), Some(id)) = (&mut self.open, last) {
            open.interface.has_sent(id);
        }
        self.schedule(events);
        Ok(Flow::On)
    }

    /// Another worker takes the place of the one that is there.
    fn start(&mut self, paper: &str, own: &[OsString]) -> Result<(), Error> {
        if let Some(open) = &mut self.open {
            open.client = None;
        }
        let mut arguments = self.options.common.clone();
        arguments.extend(own.iter().cloned());
        let client = self.worker(paper, &arguments)?;
        if let Some(open) = &mut self.open {
            open.client = Some(client);
        }
        Ok(())
    }

    fn schedule(&self, events: &ActiveEventLoop) {
        let next = self.open.as_ref().and_then(|open| open.next_frame);
        events.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }

    fn end(&mut self, events: &ActiveEventLoop, failure: Option<Error>) {
        if self.failure.is_none() {
            self.failure = failure;
        }
        if let Some(open) = &mut self.open {
            let size = open.window.inner_size().to_logical::<f32>(open.scale);
            // The size of a display is no window's.
            let is_window = open.window.fullscreen().is_none();
            open.interface.remember(if is_window { (size.width, size.height) } else { (0.0, 0.0) });
        }
        events.exit();
    }
}

impl Open {
    /// Takes what the worker has said.
    fn hear(&mut self) -> Result<Flow, Error> {
        while let Some(event) = self.client.as_mut().and_then(Client::try_receive) {
            match &event {
                Event::Ready(_) => self.had_worker = true,
                Event::Ended(ended) if !self.had_worker || self.frames_left.is_some() => return Err(refused(ended)),
                // Nobody reads it in a window that is to end by itself.
                Event::Failed { problem, .. } if self.frames_left.is_some() => {
                    return Err(Error::Refused { message: problem.clone(), code: 1 });
                }
                Event::Frame(_) => {
                    if let Some(left) = &mut self.frames_left {
                        *left = left.saturating_sub(1);
                    }
                }
                _ => {}
            }
            self.needs_layout |= !self.interface.is_going_on(&event);
            self.interface.take(event);
            if self.frames_left == Some(0) {
                return Ok(Flow::Ended);
            }
        }
        Ok(Flow::On)
    }

    /// Draws what has changed: the panels with all that is in them, or new pictures alone.
    fn draw(&mut self) -> Result<Vec<Wish>, Error> {
        self.is_due = false;
        let next_layout = self.laid_out.map(|laid_out| laid_out + LAYOUT_PAUSE).filter(|_| !self.needs_layout);
        match next_layout.filter(|next| *next > Instant::now()) {
            Some(next) => {
                self.draw_pictures()?;
                self.next_frame = Some(self.next_frame.map_or(next, |earlier| earlier.min(next)));
                Ok(Vec::new())
            }
            None => self.draw_panels(),
        }
    }

    /// Shows the pictures that have come where the panels were laid out last.
    fn draw_pictures(&mut self) -> Result<(), Error> {
        let started = Instant::now();
        self.interface.update_pictures(&self.context);
        let changes = self.context.tex_manager().write().take_delta();
        self.screen.update(&changes)?;
        let pixels_per_point = self.context.pixels_per_point();
        let prepared = started.elapsed();
        let drawn = self.screen.draw_textures(|shapes| self.context.tessellate(shapes, pixels_per_point))?;
        self.screen.free(&changes);
        if let Drawn::Yes(painted) = drawn {
            self.interface.drew(prepared + painted, false);
        }
        self.take_messages();
        Ok(())
    }

    fn draw_panels(&mut self) -> Result<Vec<Wish>, Error> {
        self.needs_layout = false;
        let started = Instant::now();
        self.laid_out = Some(started);
        let mut input = self.input.take_egui_input(&self.window);
        super::scale::correct(&mut input, self.scale, self.window.scale_factor());
        let interface = &mut self.interface;
        let output = self.context.run(input, |context| interface.show(context));
        self.screen.update(&output.textures_delta)?;
        let pixels_per_point = output.pixels_per_point;
        let laid_out = started.elapsed();
        let tessellate = |shapes| self.context.tessellate(shapes, pixels_per_point);
        let drawn = self.screen.draw(pixels_per_point, output.shapes, tessellate)?;
        self.screen.free(&output.textures_delta);
        self.take_messages();
        if let Some(path) = &self.controls
            && let Some(update) = &output.platform_output.accesskit_update
        {
            controls::write(path, update, pixels_per_point)?;
        }
        self.input.handle_platform_output(&self.window, output.platform_output);
        let delay = output.viewport_output.get(&egui::ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        self.next_frame = delay.filter(|delay| *delay < Duration::from_secs(3600)).map(|delay| Instant::now() + delay);
        match drawn {
            Drawn::Yes(painted) => self.interface.drew(laid_out + painted, true),
            Drawn::Later { is_soon: true } => {
                let soon = Instant::now() + Duration::from_millis(50);
                self.next_frame = Some(self.next_frame.map_or(soon, |next| next.min(soon)));
            }
            Drawn::Unchanged | Drawn::Later { .. } => {}
        }
        Ok(self.interface.wishes())
    }

    /// Takes what the validation layer has said of the window's own drawing.
    fn take_messages(&mut self) {
        let messages = self.screen.device().instance().take_messages();
        if !messages.is_empty() {
            self.interface.take(Event::Validation(messages.iter().map(ToString::to_string).collect()));
            self.needs_layout = true;
            self.ask();
        }
    }

    fn validation_message(&self) -> Option<String> {
        self.interface.session().validation.first().cloned()
    }

    /// Asks the display for a frame.
    fn ask(&mut self) {
        if !std::mem::replace(&mut self.is_due, true) {
            self.window.request_redraw();
        }
    }
}

fn refused(ended: &Ended) -> Error {
    let words = || ended.stderr.iter().rev().filter(|line| !line.trim().is_empty());
    let last = words().find(|line| line.starts_with("error: ") && !line.contains("--help")).or_else(|| words().next());
    let message = last.map_or("the program that draws for the window ended without a word", |line| line.as_str());
    let message = message.strip_prefix("error: ").unwrap_or(message).to_owned();
    Error::Refused { message, code: ended.code.filter(|&code| code != 0).unwrap_or(1) }
}

impl ApplicationHandler<Wake> for Application {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match self.open(events) {
            Ok(mut open) => {
                self.live = Some(open.screen.device().live().clone());
                open.ask();
                self.open = Some(open);
            }
            Err(failure) => self.end(events, Some(failure)),
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, wake: Wake) {
        match wake {
            Wake::Quit => self.end(events, None),
            Wake::Worker => self.wake(events),
            Wake::Accessibility(event) => {
                if let Some(open) = &mut self.open {
                    match event.window_event {
                        accesskit_winit::WindowEvent::InitialTreeRequested => open.context.enable_accesskit(),
                        accesskit_winit::WindowEvent::ActionRequested(request) => {
                            open.input.on_accesskit_action_request(request);
                        }
                        accesskit_winit::WindowEvent::AccessibilityDeactivated => open.context.disable_accesskit(),
                    }
                    open.needs_layout = true;
                    open.ask();
                }
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match &event {
            WindowEvent::CloseRequested => return self.end(events, None),
            WindowEvent::RedrawRequested => {
                if !open.is_due {
                    // The display asks by itself: it has lost what it showed.
                    open.screen.exposed();
                }
                match self.frame(events) {
                    Ok(Flow::On) => {}
                    Ok(Flow::Ended) => self.end(events, None),
                    Err(failure) => self.end(events, Some(failure)),
                }
                return;
            }
            WindowEvent::ScaleFactorChanged { scale_factor, inner_size_writer } => {
                // Under X11, winit tells of it again when the window manager answers, and would have the window grow twice.
                if std::mem::replace(&mut open.scale, *scale_factor) == *scale_factor {
                    drop(inner_size_writer.clone().request_inner_size(open.window.inner_size()));
                }
                open.screen.resized();
                open.needs_layout = true;
                open.ask();
            }
            WindowEvent::Resized(_) => {
                open.screen.resized();
                open.needs_layout = true;
                open.ask();
            }
            WindowEvent::Occluded(false) => {
                open.screen.exposed();
                open.ask();
            }
            _ => {}
        }
        if open.input.on_window_event(&open.window, &event).repaint {
            open.needs_layout = true;
            open.ask();
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if let Some(open) = &mut self.open
            && open.next_frame.is_some_and(|next| next <= Instant::now())
        {
            open.next_frame = None;
            open.needs_layout = true;
            open.ask();
        }
        self.schedule(events);
    }
}

impl Application {
    /// The worker has said something. A window that the display does not ask to draw, as a hidden one, hears it as well.
    fn wake(&mut self, events: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        match open.hear() {
            Ok(Flow::On) => open.ask(),
            Ok(Flow::Ended) => self.end(events, None),
            Err(failure) => self.end(events, Some(failure)),
        }
    }
}

//! The interface as a whole: its panels, and what it wishes of the worker and the window. It knows neither: events come in,
//! wishes go out.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use egui::{CentralPanel, Context, Rangef, RichText, SidePanel, TopBottomPanel, Vec2};

use super::bench_tab::Bench;
use super::keep_tab::Saving;
use super::layout::{Comparison, Layout, Theme};
use super::pictures::Pictures;
use super::protocol::{
    Assignment, Event, Frame, MeasureChoice, Picture, Request, TargetChoice, TargetShape, ThumbnailChoice, Verb,
};
use super::sent::Sent;
use super::session::Session;
use super::{camera, compare, drawer, keys, parameters_panel, passes_panel, picture_view, target_view, top_bar};

/// Fractions that the panels take of the window's width and height at most.
const PASSES_SHARE: f32 = 0.36;
const PARAMETERS_SHARE: f32 = 0.28;
const DRAWER_SHARE: f32 = 0.4;

/// A wish of the interface.
#[derive(Debug, Clone, PartialEq)]
pub enum Wish {
    /// A request to the worker.
    Ask(Request),
    /// Another paper.
    Paper(String),
    /// A new worker of this paper, in place of one that has ended.
    Restart(String),
    /// All of the display, or a window again.
    Fullscreen,
    /// The end.
    Quit,
}

/// Contents of the middle of the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    Picture,
    Target,
}

/// Use of the answer with a command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CommandUse {
    Copy,
    Bench,
}

/// The interface.
pub struct Interface {
    /// Names of the papers that there are.
    pub(super) papers: Vec<&'static str>,
    /// Name of the paper that is shown.
    pub(super) paper: String,
    /// The state of the worker, as it has told.
    pub(super) session: Session,
    /// Values that the worker has yet to hear of.
    pub(super) sent: Sent,
    /// Panels, theme and scale, kept from one start to the next.
    pub(super) layout: Layout,
    /// Textures of the pictures that are shown.
    pub(super) pictures: Pictures,
    /// Contents of the middle of the window.
    pub(super) shown: Shown,
    /// Index of the pass that is looked at.
    pub(super) pass: Option<usize>,
    /// The intermediate target that is looked at.
    pub(super) target: Option<TargetChoice>,
    /// Number of passes after which the frame ends; none for a whole frame.
    pub(super) after: Option<u32>,
    /// Kinds of frames that are measured while the clock stands.
    pub(super) measure: MeasureChoice,
    /// Zoom and place of the picture.
    pub(super) picture_view: picture_view::PictureView,
    /// Zoom, place and range of the target.
    pub(super) target_view: target_view::TargetView,
    /// The camera while it moves.
    pub(super) flight: camera::Flight,
    /// Text that is being typed into fields of parameters.
    pub(super) fields: parameters_panel::Fields,
    /// Text that is being typed for files to keep.
    pub(super) saving: Saving,
    /// The benchmark that runs, or ran last.
    pub(super) bench: Bench,
    /// The frame's number while it is being typed.
    pub(super) frame_text: Option<String>,
    /// Use of the next answer with a command line.
    pub(super) command_use: CommandUse,
    /// A line for the user: what was copied or written.
    pub(super) note: Option<String>,
    /// When it was made.
    pub(super) opened: Instant,
    /// The table of keys is open.
    pub(super) has_keys: bool,
    /// Width and height of the window in points.
    screen: Vec2,
    /// The plots of times stay as they are.
    pub(super) is_plot_paused: bool,
    /// Line under the picture: place and value at the pointer.
    pub(super) pointed: String,
    /// The window's own last times in milliseconds, of frames whose panels were laid out.
    pub(super) interface_ms: VecDeque<f32>,
    /// As `interface_ms`, of frames that showed new pictures alone.
    pub(super) pictures_ms: VecDeque<f32>,
    /// Requests at the start, once the worker is ready.
    first: Vec<Request>,
    wishes: Vec<Wish>,
}

impl Interface {
    /// The interface of a window that begins with `paper`.
    pub fn new(context: &Context, papers: Vec<&'static str>, paper: &str, layout: Layout) -> Self {
        apply_theme(context, layout.theme);
        context.all_styles_mut(|style| {
            style.spacing.item_spacing = egui::vec2(6.0, 4.0);
            style.interaction.tooltip_delay = 0.3;
        });
        // The window's own keys do this.
        context.options_mut(|options| options.zoom_with_keyboard = true);
        Interface {
            papers,
            paper: paper.to_owned(),
            session: Session::default(),
            sent: Sent::default(),
            measure: MeasureChoice { times: 0, counters: false },
            layout,
            pictures: Pictures::default(),
            shown: Shown::Picture,
            pass: None,
            target: None,
            after: None,
            picture_view: Default::default(),
            target_view: Default::default(),
            flight: Default::default(),
            fields: Default::default(),
            saving: Default::default(),
            bench: Default::default(),
            frame_text: None,
            command_use: CommandUse::Copy,
            note: None,
            opened: Instant::now(),
            has_keys: false,
            screen: Vec2::ZERO,
            is_plot_paused: false,
            pointed: String::new(),
            interface_ms: VecDeque::new(),
            pictures_ms: VecDeque::new(),
            first: Vec::new(),
            wishes: Vec::new(),
        }
    }

    /// Requests a frame, and that the clock plays, once the worker is ready.
    pub fn begin(&mut self, frame: u32, is_playing: bool) {
        if frame > 0 {
            self.first.push(Request::GoTo(frame));
        }
        if is_playing {
            self.first.push(Request::Play);
        }
    }

    /// The worker as far as it has told.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Takes an event of the worker over.
    pub fn take(&mut self, event: Event) {
        if let Event::Ready(_) = event {
            let mut first = std::mem::take(&mut self.first);
            // What is looked at is asked of every worker, also of one that takes the place of another.
            first.push(Request::Difference(self.layout.comparison == Comparison::Difference));
            first.extend(self.after.map(|after| Request::After(Some(after))));
            first.extend(self.target.clone().map(|target| Request::Target(Some(target))));
            first.push(Request::Memory);
            first.push(Request::Measure(self.measure));
            first.into_iter().for_each(|request| self.ask(request));
        }
        let is_built = matches!(event, Event::Built(_));
        let has_picture = matches!(event, Event::Frame(_));
        self.sent.hear(&event);
        let answer = self.session.take(event);
        if has_picture {
            self.pictures.is_new = true;
        }
        if is_built {
            self.ask(Request::Memory);
            self.check_choices();
        }
        match answer {
            Some(Event::Command(arguments)) => self.answered(arguments),
            Some(Event::Kept(files)) => self.note = Some(format!("wrote {}", summary(&files))),
            Some(Event::Measuring(measure)) => self.measure = measure,
            _ => {}
        }
    }

    /// Other targets and passes may be there now.
    fn check_choices(&mut self) {
        let Some(built) = self.session.side_built(0) else { return };
        let (pass_count, names) = (built.passes.len(), &built.targets);
        if self.pass.is_some_and(|pass| pass >= pass_count) {
            self.pass = None;
        }
        let is_there = self.target.as_ref().is_none_or(|target| names.iter().any(|one| one.name == target.name));
        if !is_there {
            self.look_at(None);
        }
        if self.after.is_some_and(|after| after as usize >= pass_count) {
            self.set_after(None);
        }
    }

    fn answered(&mut self, arguments: Vec<String>) {
        match self.command_use {
            CommandUse::Copy => {
                let words = std::iter::once("fumarole".to_owned()).chain(arguments);
                let line = shlex::try_join(words.collect::<Vec<_>>().iter().map(String::as_str)).unwrap_or_default();
                self.note = Some(format!("copied: {line}"));
                self.pictures.to_copy = Some(line);
            }
            CommandUse::Bench => self.bench.start(arguments),
        }
    }

    /// A frame of the interface took so long, with its panels laid out or of new pictures alone.
    pub fn drew(&mut self, time: Duration, is_laid_out: bool) {
        let last_ms = if is_laid_out { &mut self.interface_ms } else { &mut self.pictures_ms };
        last_ms.push_back(time.as_secs_f32() * 1e3);
        if last_ms.len() > 120 {
            last_ms.pop_front();
        }
    }

    /// Wishes since the last call.
    pub fn wishes(&mut self) -> Vec<Wish> {
        std::mem::take(&mut self.wishes)
    }

    /// The requests that were wished for have been sent, the last as number `id`.
    pub fn has_sent(&mut self, id: u64) {
        self.sent.number(id);
    }

    /// Remembers the layout.
    pub fn remember(&mut self, window_size: (f32, f32)) {
        if window_size.0 >= 1.0 && window_size.1 >= 1.0 {
            self.layout.window_size = window_size;
        }
        self.layout.save();
    }

    pub(super) fn wish(&mut self, wish: Wish) {
        self.wishes.push(wish);
    }

    pub(super) fn ask(&mut self, request: Request) {
        self.sent.ask(&request);
        self.wishes.push(Wish::Ask(request));
    }

    /// The clock plays, or is about to.
    pub(super) fn is_playing(&self) -> bool {
        self.sent.is_playing().unwrap_or_else(|| self.session.is_playing())
    }

    pub(super) fn set(&mut self, name: &str, values: Vec<String>) {
        self.ask(Request::Set(vec![Assignment { name: name.to_owned(), values }]));
    }

    pub(super) fn ask_command(&mut self, verb: Verb, command_use: CommandUse) {
        self.command_use = command_use;
        self.ask(Request::Command(verb));
    }

    pub(super) fn set_after(&mut self, after: Option<u32>) {
        if self.after != after {
            self.after = after;
            self.ask(Request::After(after));
        }
    }

    pub(super) fn look_at(&mut self, target: Option<TargetChoice>) {
        self.shown = if target.is_some() { Shown::Target } else { Shown::Picture };
        if self.target != target {
            self.target.clone_from(&target);
            self.target_view.reset();
            self.ask(Request::Target(target));
        }
    }

    /// Looks at a pass: its targets come as thumbnails, the first of them large; without one, the picture is back.
    pub(super) fn select_pass(&mut self, pass: Option<usize>) {
        self.pass = pass;
        let names = pass.map(|pass| self.targets_of(pass)).unwrap_or_default();
        // Rather a picture than a table.
        let large = names.iter().find(|name| self.is_image(name)).or(names.first()).cloned();
        self.look_at(large.map(|name| TargetChoice { side: 0, name, layer: 0, first_row: 0 }));
        let choice = (!names.is_empty()).then_some(ThumbnailChoice { side: 0, names, longest_px: 160 });
        self.ask(Request::Thumbnails(choice));
    }

    fn is_image(&self, name: &str) -> bool {
        let target = self.session.side_built(0).and_then(|built| built.targets.iter().find(|one| one.name == name));
        target.is_some_and(|target| matches!(target.shape, TargetShape::Image { .. }))
    }

    /// Names of the targets that a pass writes, then of those that it reads.
    fn targets_of(&self, pass: usize) -> Vec<String> {
        let Some(built) = self.session.side_built(0) else { return Vec::new() };
        let Some(info) = built.passes.get(pass) else { return Vec::new() };
        let mut names: Vec<String> = Vec::new();
        for &index in info.written_targets.iter().chain(&info.read_targets) {
            if let Some(target) = built.targets.get(index).filter(|target| !names.contains(&target.name)) {
                names.push(target.name.clone());
            }
        }
        names
    }

    pub(super) fn change_paper(&mut self, paper: &str) {
        self.paper = paper.to_owned();
        let validation = std::mem::take(&mut self.session.validation);
        (self.session, self.sent) = (Session { validation, ..Session::default() }, Sent::default());
        self.pictures = Pictures::default();
        (self.pass, self.after, self.target, self.shown) = (None, None, None, Shown::Picture);
        self.fields = Default::default();
        self.picture_view = Default::default();
        (self.note, self.frame_text) = (None, None);
        self.wish(Wish::Paper(paper.to_owned()));
    }

    pub(super) fn restart(&mut self) {
        let paper = self.paper.clone();
        self.session = Session { validation: std::mem::take(&mut self.session.validation), ..Session::default() };
        self.sent = Sent::default();
        // Its small pictures come when it is chosen again; a second side may be gone.
        self.pass = None;
        if self.target.as_ref().is_some_and(|target| target.side > 0) {
            (self.target, self.shown) = (None, Shown::Picture);
        }
        self.wish(Wish::Restart(paper));
    }

    /// Takes over the pictures that have come.
    pub fn update_pictures(&mut self, context: &Context) {
        self.pictures.update(context, &self.session);
    }

    /// True for an event that changes nothing but pictures of the same sizes, and numbers that nobody reads as fast as they
    /// come. To be asked before the event is taken.
    pub fn is_going_on(&self, event: &Event) -> bool {
        match event {
            Event::Frame(next) => {
                let is_alike = self.session.frame.as_ref().is_some_and(|last| sizes(last) == sizes(next));
                // A target is drawn with the panels round it.
                is_alike && next.is_playing && (next.target.is_none() || self.shown == Shown::Picture)
            }
            Event::Times(_) => !self.session.times.is_empty(),
            Event::Progress(next) => {
                self.session.progress.as_ref().is_some_and(|last| last.what == next.what && next.done < next.total)
            }
            _ => false,
        }
    }

    /// Lays all panels out.
    pub fn show(&mut self, context: &Context) {
        keys::handle(context, self);
        parameters_panel::take_dropped(context, self);
        self.update_pictures(context);
        if let Some(line) = self.pictures.to_copy.take() {
            context.copy_text(line);
        }
        TopBottomPanel::top("top").show(context, |ui| top_bar::show(ui, self));
        TopBottomPanel::bottom("status").show(context, |ui| top_bar::show_status(ui, self));
        self.show_panels(context);
        let frame = egui::Frame::central_panel(&context.style()).inner_margin(4.0);
        CentralPanel::default().frame(frame).show(context, |ui| self.show_middle(ui));
        self.pictures.fit(context, &self.session);
        keys::show_list(context, self);
        self.bench.poll(context);
    }

    /// The panels, as large as their user has made them, as far as a small window leaves the middle some room.
    fn show_panels(&mut self, context: &Context) {
        let screen = context.content_rect().size();
        let is_resized = std::mem::replace(&mut self.screen, screen) != screen;
        // Of a window that changes, they take the sizes that they would have in a larger one again.
        let range = |wanted: f32, (least, most): (f32, f32)| {
            let most = most.max(least);
            let shown = wanted.clamp(least, most);
            (shown, if is_resized { Rangef::point(shown) } else { Rangef::new(least, most) })
        };
        let changed = |drawn: f32, shown: f32, wanted: &mut f32| {
            if (drawn - shown).abs() > 0.5 {
                *wanted = drawn;
            }
        };
        if self.layout.has_drawer {
            let (shown, range) = range(self.layout.drawer_height, (60.0, screen.y * DRAWER_SHARE));
            let panel = TopBottomPanel::bottom("drawer").resizable(true).default_height(shown).height_range(range);
            let drawn = panel.show(context, |ui| drawer::show(ui, self)).response.rect.height();
            changed(drawn, shown, &mut self.layout.drawer_height);
        }
        if self.layout.has_passes {
            let (shown, range) = range(self.layout.passes_width, (160.0, screen.x * PASSES_SHARE));
            let panel = SidePanel::left("passes").resizable(true).default_width(shown).width_range(range);
            let drawn = panel.show(context, |ui| passes_panel::show(ui, self)).response.rect.width();
            changed(drawn, shown, &mut self.layout.passes_width);
        }
        if self.layout.has_parameters {
            let (shown, range) = range(self.layout.parameters_width, (160.0, screen.x * PARAMETERS_SHARE));
            let panel = SidePanel::right("parameters").resizable(true).default_width(shown).width_range(range);
            let drawn = panel.show(context, |ui| parameters_panel::show(ui, self)).response.rect.width();
            changed(drawn, shown, &mut self.layout.parameters_width);
        }
    }

    fn show_middle(&mut self, ui: &mut egui::Ui) {
        if let Some(problem) = self.session.problem.clone() {
            let mut is_read = false;
            egui::Frame::group(ui.style()).show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    is_read = ui.small_button("x").on_hover_text("Take this message away").clicked();
                    ui.label(RichText::new(problem).color(ui.visuals().error_fg_color).monospace());
                });
            });
            if is_read {
                self.session.problem = None;
            }
        }
        if let Some(ended) = self.session.ended.clone() {
            egui::Frame::group(ui.style()).show(ui, |ui| {
                ui.label(RichText::new(ending(&ended)).color(ui.visuals().error_fg_color));
                ended.stderr.iter().for_each(|line| drop(ui.monospace(line)));
                if ui.button("Start it again").clicked() {
                    self.restart();
                }
            });
        }
        match self.shown {
            Shown::Target => target_view::show(ui, self),
            Shown::Picture if self.session.shows_both() => compare::show(ui, self),
            Shown::Picture => picture_view::show(ui, self),
        }
    }
}

/// The pictures of a frame, and their sizes.
fn sizes(frame: &Frame) -> impl PartialEq + use<> {
    let size = |picture: Option<&Picture>| picture.map(|picture| (picture.width, picture.height));
    let large = frame.sides.iter().map(|side| side.picture.as_ref());
    let large = large.chain([frame.difference.as_ref().map(|difference| &difference.picture)]).map(size);
    let small = frame.thumbnails.iter().map(|thumbnail| (thumbnail.name.clone(), size(thumbnail.picture.as_ref())));
    (large.collect::<Vec<_>>(), small.collect::<Vec<_>>())
}

/// The end of a worker in words.
fn ending(ended: &super::protocol::Ended) -> String {
    match (ended.signal, ended.code) {
        (Some(signal), _) => format!("The program that draws was ended by signal {signal}."),
        (None, Some(code)) => format!("The program that draws ended with exit code {code}."),
        (None, None) => "The program that draws has ended.".to_owned(),
    }
}

/// The files in few words.
fn summary(files: &[String]) -> String {
    match files {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [first, .., last] => format!("{} files, {first} to {last}", files.len()),
    }
}

/// Colours of the window.
pub(super) fn apply_theme(context: &Context, theme: Theme) {
    context.set_theme(match theme {
        Theme::System => egui::ThemePreference::System,
        Theme::Light => egui::ThemePreference::Light,
        Theme::Dark => egui::ThemePreference::Dark,
    });
}

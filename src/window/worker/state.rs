//! The worker's state: what is set, what is made of it, what is shown, and what comes next.

use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use super::choice::{Choice, Resolved};
use super::inbox::Inbox;
use super::outbox::{Exchange, Outbox};
use super::shaders::{Libraries, Shaders};
use super::side::Side;
use super::times::Times;
use super::wanted::{Clock, Wanted};
use super::{AHEAD, due, is_fatal, keep};
use crate::gpu::physical::DeviceType;
use crate::gpu::{FrameSample, Mode};
use crate::measure::machine::{Machine, MachineOptions};
use crate::measure::parameter::Given;
use crate::measure::study::Study;
use crate::measure::{Error, Paper, Variant};
use crate::report::record::Limits;
use crate::window::protocol::{Built, Event, MeasureChoice, Numbered, Progress, Request, Setup, Work};

/// Time in which the files of one saving change.
const SAVING: Duration = Duration::from_millis(60);

/// The worker.
pub struct State<S: Study> {
    // Before the machine, which they are made on.
    /// Pictures side by side, each with its paper's set-up.
    pub(super) sides: Vec<Side<S>>,
    /// Shader libraries, and the watch over their folder.
    pub(super) shaders: Shaders,
    /// The device with its recorder.
    pub(super) machine: Machine,
    /// Options of the machine, as they were given.
    pub(super) options: MachineOptions,
    /// The choice that is asked for.
    pub(super) choice: Choice,
    /// The choice that the sides are made of.
    pub(super) made: Option<Choice>,
    /// Shaders that were compiled anew since, and what was made of them.
    pub(super) replaced: Option<(Libraries, Option<Choice>)>,
    /// Wishes of the window: target, measurements, end of the frame.
    pub(super) wanted: Wanted,
    /// Time of the paper.
    pub(super) clock: Clock,
    /// Measured times of each side.
    pub(super) times: Vec<Times>,
    /// Events to the window.
    pub(super) outbox: Outbox,
    /// Requests of the window.
    pub(super) inbox: Inbox,
    /// The file that pictures go through.
    pub(super) exchange: Exchange,
    /// Number of the last frame that was told.
    pub(super) serial: u64,
    /// Number of the last frame that the window has taken.
    pub(super) taken: u64,
    /// Number of the last request that was heeded.
    pub(super) heeds: u64,
    /// The sides are not of the choice that is asked for.
    pub(super) needs_build: bool,
    /// The frame that is shown is not of the wishes.
    pub(super) needs_frame: bool,
    /// No frame was shown since the sides were made.
    pub(super) is_new: bool,
    /// Number of the frame that is shown.
    pub(super) shown: u32,
    /// A state is on its way to the frame that is wanted.
    pub(super) is_replaying: bool,
    /// The shown part of a frame has changed since the last was told.
    pub(super) wants_more: bool,
    /// Requests that take long, in turn.
    pub(super) jobs: Vec<Numbered>,
    /// Warnings that were told.
    pub(super) warned: Vec<String>,
    /// Milliseconds of each side's last plain frame.
    pub(super) frame_ms: Vec<f64>,
    /// The device's own, once they are measured.
    pub(super) limits: Option<Limits>,
}

impl<S: Study> State<S> {
    pub fn new(
        machine: Machine,
        options: MachineOptions,
        shaders: Shaders,
        choice: Choice,
        outbox: Outbox,
        inbox: Inbox,
        exchange: Exchange,
    ) -> Self {
        State {
            sides: Vec::new(),
            shaders,
            machine,
            options,
            choice,
            made: None,
            replaced: None,
            wanted: Wanted::default(),
            clock: Clock { at: 0.0, speed: 1.0, is_playing: false, moved: None },
            times: Vec::new(),
            outbox,
            inbox,
            exchange,
            serial: 0,
            taken: 0,
            heeds: 0,
            needs_build: true,
            needs_frame: true,
            is_new: false,
            shown: 0,
            is_replaying: false,
            wants_more: false,
            jobs: Vec::new(),
            warned: Vec::new(),
            frame_ms: Vec::new(),
            limits: None,
        }
    }

    /// Heeds requests and draws, until nobody wants more.
    ///
    /// # Errors
    /// Of a lost device.
    pub fn serve(&mut self) -> Result<(), Error> {
        if let Some(trouble) = self.shaders.trouble.take() {
            self.outbox.tell(&Event::Warning(trouble));
        }
        loop {
            let Some(mut requests) = self.inbox.take(self.idle_until()) else { return Ok(()) };
            let is_reload = |numbered: &Numbered| numbered.request == Request::Reload;
            if requests.iter().any(is_reload) {
                // Saving is many changes of files.
                thread::sleep(SAVING);
                requests.extend(self.inbox.take(Some(Instant::now())).into_iter().flatten());
                let last = requests.iter().rposition(is_reload);
                let mut index = 0;
                requests.retain(|numbered| {
                    index += 1;
                    !is_reload(numbered) || Some(index - 1) == last
                });
            }
            for numbered in requests {
                self.heed(numbered)?;
            }
            self.step()?;
            self.tell_validation();
        }
    }

    /// When there is something to do without a request; `None`: never.
    fn idle_until(&self) -> Option<Instant> {
        let may_draw = self.serial - self.taken < AHEAD && !self.sides.is_empty();
        if self.needs_build || !self.jobs.is_empty() || (may_draw && (self.needs_frame || self.measured().is_some())) {
            return Some(Instant::now());
        }
        if self.clock.is_playing && may_draw { due(self.clock.moved).or_else(|| Some(Instant::now())) } else { None }
    }

    /// Does what comes next.
    fn step(&mut self) -> Result<(), Error> {
        if std::mem::take(&mut self.needs_build) {
            let built = self.build();
            let replaced = self.replaced.take();
            if let Err(error) = built {
                if let Some((libraries, made)) = replaced {
                    self.shaders.restore(libraries);
                    self.made = made;
                }
                self.fail(self.heeds, error)?;
                // What could be made is what is set.
                if let Some(made) = self.made.clone() {
                    self.choice = made;
                    // One side may have taken over what the other could not.
                    let old = self.choice.resolve::<S>();
                    if !old.and_then(|old| self.take_over(&old)).unwrap_or(false) {
                        (self.made, self.needs_build) = (None, true);
                    }
                    self.tell_setup();
                }
            }
        }
        let is_ahead = self.serial - self.taken >= AHEAD;
        if !is_ahead && self.clock.is_playing && due(self.clock.moved).is_none_or(|due| due <= Instant::now()) {
            let before = self.clock.number();
            // The first picture is that of the frame where it starts.
            if self.clock.moved.is_some() && !self.needs_frame {
                self.clock.at += self.clock.speed;
            }
            self.clock.moved = Some(Instant::now());
            self.needs_frame |= self.clock.number() != before;
        }
        if self.needs_frame && !is_ahead && !self.sides.is_empty() {
            match self.show() {
                Ok(true) => self.needs_frame = false,
                // Something else is wanted; it stays to be drawn.
                Ok(false) => {}
                Err(error) => {
                    self.needs_frame = false;
                    self.clock.is_playing = false;
                    self.fail(self.heeds, error)?;
                }
            }
        }
        for job in std::mem::take(&mut self.jobs) {
            if let Err(error) = self.work(&job.request) {
                self.fail(job.id, error)?;
            }
        }
        if let Some((index, mode)) = self.measured().filter(|_| !self.needs_frame)
            && let Err(error) = self.measure(index, mode)
        {
            self.stop_measuring();
            self.fail(self.heeds, error)?;
        }
        Ok(())
    }

    /// Gives up times and counters, and tells of it.
    pub(super) fn stop_measuring(&mut self) {
        let MeasureChoice { times, counters } = std::mem::take(&mut self.wanted.measure);
        if times > 0 || counters {
            self.outbox.tell(&Event::Measuring(self.wanted.measure));
        }
    }

    pub(super) fn fail(&self, id: u64, error: Error) -> Result<(), Error> {
        if is_fatal(&error) {
            return Err(error);
        }
        let problem = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        self.outbox.tell(&Event::Failed { id, problem });
        Ok(())
    }

    /// Takes a request: sets what it sets, and keeps for later what it wants done.
    fn heed(&mut self, numbered: Numbered) -> Result<(), Error> {
        let Numbered { id, request } = numbered;
        self.heeds = self.heeds.max(id);
        let number = self.clock.number();
        match &request {
            Request::Set(assignments) => {
                let mut choice = self.choice.clone();
                let set = assignments.iter().try_for_each(|assignment| choice.set::<S>(assignment));
                return self.choose(id, set.map(|()| choice));
            }
            Request::Preset(preset) => {
                let mut choice = self.choice.clone();
                choice.preset = preset.clone();
                choice.typed.retain(|typed| typed.name == "size");
                for side in &mut choice.sides {
                    (side.preset, side.variant) = (None, None);
                }
                return self.choose(id, Ok(choice));
            }
            Request::Sides(sides) => {
                let problem = || Error::Input("one side is shown, or two".to_owned());
                let choice = match sides.len() {
                    1 | 2 => Ok(Choice { sides: sides.clone(), ..self.choice.clone() }),
                    _ => Err(problem()),
                };
                return self.choose(id, choice);
            }
            Request::Play => {
                self.clock.is_playing = true;
                self.clock.moved = None;
                self.needs_frame = true;
            }
            Request::Pause => {
                self.clock.is_playing = false;
                self.needs_frame = true;
            }
            Request::Step(frames) => {
                self.clock.is_playing = false;
                self.clock.at = f64::from(number.saturating_add_signed(*frames));
                self.needs_frame = true;
            }
            Request::Speed(speed) => {
                if *speed > 0.0 && *speed <= 1000.0 {
                    self.clock.speed = *speed;
                } else {
                    let problem = format!("a speed of {speed} is not above 0 and at most 1000");
                    return self.fail(id, Error::Input(problem));
                }
            }
            Request::GoTo(number) => {
                self.clock.at = f64::from(*number);
                self.needs_frame = true;
            }
            Request::After(passes) => {
                self.wanted.after = *passes;
                (self.needs_frame, self.wants_more) = (true, true);
            }
            Request::Target(target) => {
                self.wanted.target = target.clone();
                (self.needs_frame, self.wants_more) = (true, true);
            }
            Request::Thumbnails(thumbnails) => {
                self.wanted.thumbnails = thumbnails.clone();
                (self.needs_frame, self.wants_more) = (true, true);
            }
            Request::Difference(has_difference) => {
                self.wanted.has_difference = *has_difference;
                (self.needs_frame, self.wants_more) = (true, true);
            }
            Request::Measure(measure) => {
                self.wanted.measure = MeasureChoice { times: measure.times.min(100), ..*measure };
                self.times = self.sides.iter().map(|_| Times::default()).collect();
            }
            Request::Reload => match self.shaders.reload() {
                Ok(libraries) => {
                    self.replaced.get_or_insert((libraries, self.made.take()));
                    self.needs_build = true;
                }
                Err(error) => return self.fail(id, error),
            },
            Request::Taken(serial) => {
                self.taken = self.taken.max(*serial);
                self.exchange.free(self.taken);
            }
            Request::Limits | Request::Memory | Request::Command(_) | Request::Keep(_) | Request::Capture => {
                self.jobs.push(Numbered { id, request });
            }
            Request::Cancel => return self.stop(id),
            // The end is the inbox's.
            Request::Quit => {}
        }
        Ok(())
    }

    /// Takes a choice that can be resolved, and tells of one that cannot.
    fn choose(&mut self, id: u64, choice: Result<Choice, Error>) -> Result<(), Error> {
        match choice.and_then(|choice| choice.resolve::<S>().map(|_| choice)) {
            Ok(choice) => {
                self.choice = choice;
                self.needs_build = true;
                Ok(())
            }
            Err(error) => {
                self.fail(id, error)?;
                self.tell_setup();
                Ok(())
            }
        }
    }

    /// Makes the sides of what is asked for, as far as they are not there. Those that are stay until then.
    fn build(&mut self) -> Result<(), Error> {
        let resolved = self.choice.resolve::<S>()?;
        if self.made.as_ref() == Some(&self.choice) {
            self.tell_setup();
            return Ok(());
        }
        if self.made.is_none() || !self.take_over(&resolved)? {
            let count = resolved.len() as u64;
            let tell = |done| self.outbox.tell(&Event::Progress(Progress { what: Work::Build, done, total: count }));
            tell(0);
            let mut sides = Vec::new();
            for (index, resolved) in resolved.iter().enumerate() {
                let name = resolved.variant.as_str();
                // Two sides of one variant have resources of different names.
                let label = if index == 0 { name.to_owned() } else { format!("{name}-b") };
                let shaders: Arc<_> = self.shaders.of(resolved.compiler)?;
                sides.push(Side::new(&self.machine, shaders, resolved.clone(), &label)?);
                tell(index as u64 + 1);
            }
            self.machine.device.wait_idle()?;
            self.sides = sides;
            self.frame_ms = vec![0.0; self.sides.len()];
        }
        self.made = Some(self.choice.clone());
        self.times = self.sides.iter().map(|_| Times::default()).collect();
        (self.is_new, self.needs_frame) = (true, true);
        self.tell_setup();
        Ok(())
    }

    /// Gives the sides that are there what differs; false where one must be made anew.
    fn take_over(&mut self, resolved: &[Resolved<S>]) -> Result<bool, Error> {
        if resolved.len() != self.sides.len() {
            return Ok(false);
        }
        for (side, new) in self.sides.iter_mut().zip(resolved) {
            let old = &side.resolved;
            if (old.variant, old.compiler, &old.preset) != (new.variant, new.compiler, &new.preset) {
                return Ok(false);
            }
            let names = S::parameters();
            let differ = old.values().into_iter().zip(new.values()).zip(names).filter(|((old, new), _)| old != new);
            let changed: Given = differ.map(|(_, parameter)| parameter.name.to_owned()).collect();
            if !changed.is_within(&[]) && !side.reconfigure(new, &changed)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn tell_setup(&self) {
        let sides = self.sides.iter().map(|side| side.resolved.describe(&self.choice, side.paper.camera())).collect();
        self.outbox.tell(&Event::Setup(Setup { heeds: self.heeds, preset: self.choice.preset.clone(), sides }));
    }

    /// Draws the frame that the clock shows and tells of it. False when something else is wanted by now.
    fn show(&mut self) -> Result<bool, Error> {
        let number = self.clock.number();
        let mut samples = Vec::new();
        let measure = self.wanted.measure;
        let is_measured = self.clock.is_playing && (measure.times > 0 || measure.counters);
        self.share_device(!is_measured);
        for index in 0..self.sides.len() {
            let mode = match &self.times[index] {
                times if is_measured => times.following(measure.counters),
                _ => Mode::Plain,
            };
            let Some(sample) = self.draw(index, number, self.wanted.after, (mode, false))? else { return Ok(false) };
            if is_measured && self.wanted.after.is_none() {
                self.times[index].take(mode, &sample, measure.times.max(1));
            }
            if mode == Mode::Plain && self.wanted.after.is_none() {
                self.frame_ms[index] = sample.frame_ms;
            }
            samples.push(sample);
        }
        if std::mem::take(&mut self.is_new) {
            let sides = self.sides.iter().map(Side::built).collect();
            self.outbox.tell(&Event::Built(Built { heeds: self.heeds, sides }));
        }
        let frame = self.next_frame(number, &samples)?;
        (self.shown, self.wants_more) = (number, false);
        self.outbox.tell(&Event::Frame(Box::new(frame)));
        if self.clock.is_playing && (self.wanted.measure.times > 0 || self.wanted.measure.counters) {
            self.tell_times();
        }
        for side in &self.sides {
            keep::news(side, &mut self.warned)
                .into_iter()
                .for_each(|warning| self.outbox.tell(&Event::Warning(warning)));
        }
        Ok(true)
    }

    /// Draws a side, and tells how far a replay is. `None` when something else is wanted by now.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub(super) fn draw(
        &mut self,
        index: usize,
        number: u32,
        after: Option<u32>,
        how: (Mode, bool),
    ) -> Result<Option<FrameSample>, Error> {
        let (inbox, outbox) = (&self.inbox, &self.outbox);
        let mut most = 0;
        let proceed = |left: u32| {
            most = most.max(u64::from(left));
            outbox.tell(&Event::Progress(Progress { what: Work::Replay, done: most - u64::from(left), total: most }));
            !inbox.is_stale()
        };
        let side = &mut self.sides[index];
        let drawn = match after {
            None => side.draw(&mut self.machine, number, how, proceed)?,
            Some(passes) => side.draw_first(&mut self.machine, number, passes, proceed)?,
        };
        self.is_replaying = drawn.is_none();
        if most > 0 && drawn.is_some() {
            self.outbox.tell(&Event::Progress(Progress { what: Work::Replay, done: most, total: most }));
        }
        Ok(drawn)
    }

    /// Has the window draw between two passes of a frame, on a device that does one thing after the other; a processor does
    /// both at once. Frames that are timed are whole.
    pub(super) fn share_device(&mut self, is_wanted: bool) {
        let is_cpu = self.machine.device.physical().device_type == DeviceType::Cpu;
        self.machine.recorder.submit_by_pass(is_wanted && !is_cpu);
    }

    fn tell_validation(&self) {
        let messages = self.machine.device.instance().take_messages();
        if !messages.is_empty() {
            self.outbox.tell(&Event::Validation(messages.iter().map(ToString::to_string).collect()));
        }
    }
}

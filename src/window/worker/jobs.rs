//! Jobs of a window beside frames: times, limits, memory, command lines, files.

use std::path::Path;

use super::side::Side;
use super::state::State;
use super::times::Times;
use super::{command, keep, process};
use crate::gpu::live::MemoryUse;
use crate::gpu::physical::DeviceType;
use crate::gpu::{Mode, RenderDoc};
use crate::measure::study::Study;
use crate::measure::{Error, limits};
use crate::window::protocol::{
    DeviceLimits, Event, Keep, MeasureChoice, Memory, Progress, Request, ResourceMemory, Work,
};

impl<S: Study> State<S> {
    /// Does what a request wants done beside frames.
    ///
    /// # Errors
    /// Those of the work.
    pub(super) fn work(&mut self, request: &Request) -> Result<(), Error> {
        let event = match request {
            Request::Limits => {
                let tell = |done| {
                    self.outbox.tell(&Event::Progress(Progress { what: Work::Limits, done, total: 1 }));
                };
                tell(0);
                let found = limits::measure(&mut self.machine)?;
                tell(1);
                let told = DeviceLimits {
                    copy_gb_s: found.copy_gb_s,
                    fma_gflops: found.fma_gflops,
                    fill_gpix_s: found.fill_gpix_s,
                    blend_gpix_s: found.blend_gpix_s,
                };
                self.limits = Some(found);
                self.tell_times();
                Event::Limits(told)
            }
            Request::Memory => Event::Memory(self.memory()),
            Request::Command(verb) => {
                let sides: Vec<_> = self.sides.iter().map(|side| side.resolved.clone()).collect();
                Event::Command(command::line(*verb, self.clock.number(), &self.choice, &sides, &self.options))
            }
            Request::Keep(keep) => Event::Kept(self.keep(keep)?),
            Request::Capture => {
                let renderdoc = RenderDoc::attach()?;
                self.share_device(false);
                let (number, count) = (self.clock.number(), self.sides.len());
                let file = renderdoc.capture(None, || {
                    let draw = |index| self.draw(index, number, None, (Mode::Plain, true)).map(drop);
                    (0..count).try_for_each(draw)
                })?;
                Event::Kept(vec![file.display().to_string()])
            }
            _ => return Ok(()),
        };
        self.outbox.tell(&event);
        Ok(())
    }

    /// The side and the mode of the next frame that is recorded for times alone: while the clock stands.
    pub(super) fn measured(&self) -> Option<(usize, Mode)> {
        let MeasureChoice { times, counters } = self.wanted.measure;
        if self.clock.is_playing {
            return None;
        }
        let wanted = |(index, of): (usize, &Times)| Some((index, of.wanted(times, counters)?));
        // In turn, so that drift hits all alike.
        let lacking = self.times.iter().enumerate().filter_map(wanted);
        lacking.min_by_key(|(index, _)| (self.times[*index].taken(), *index))
    }

    /// Records that frame.
    ///
    /// # Errors
    /// Of a lost device.
    pub(super) fn measure(&mut self, index: usize, mode: Mode) -> Result<(), Error> {
        let number = self.clock.number();
        self.share_device(false);
        let Some(sample) = self.draw(index, number, None, (mode, true))? else { return Ok(()) };
        self.times[index].take(mode, &sample, self.wanted.measure.times.max(1));
        self.tell_times();
        Ok(())
    }

    pub(super) fn tell_times(&self) {
        let most = self.wanted.measure.times;
        let is_cpu = self.machine.device.physical().device_type == DeviceType::Cpu;
        let told =
            |(times, side): (&Times, &Side<S>)| times.told(&side.pass_names(), most, self.limits.as_ref(), is_cpu);
        self.outbox.tell(&Event::Times(self.times.iter().zip(&self.sides).map(told).collect()));
    }

    /// Gives up a replay that is under way: the frame that is shown stays, and the clock goes back to it.
    pub(super) fn stop(&mut self, id: u64) -> Result<(), Error> {
        if !std::mem::take(&mut self.is_replaying) {
            return Ok(());
        }
        let number = self.clock.number();
        // What was made anew has shown nothing yet. Else a target, or whatever was asked for on the way, is shown of the frame
        // that stays, unless it was on the way there that it was stopped.
        self.needs_frame = self.is_new || (self.wants_more && number != self.shown);
        self.clock.at = if self.is_new { 0.0 } else { f64::from(self.shown) };
        self.clock.is_playing = false;
        self.stop_measuring();
        let problem = format!("stopped on the way to frame {number}; frame {} stays", self.clock.number());
        self.fail(id, Error::Input(problem))
    }

    fn keep(&mut self, keep: &Keep) -> Result<Vec<String>, Error> {
        let (Keep::Picture { side, file }
        | Keep::Target { side, file, .. }
        | Keep::ContactSheet { side, file }
        | Keep::Film { side, file, .. }) = keep;
        let State { sides, machine, inbox, outbox, .. } = self;
        let side = sides.get_mut(*side).ok_or_else(|| Error::Input(format!("there is no side {side}")))?;
        let path = Path::new(file);
        match keep {
            Keep::Picture { .. } => keep::picture(machine, side, path)?,
            Keep::Target { name, .. } => keep::target(machine, side, name, path)?,
            Keep::ContactSheet { .. } => keep::sheet(machine, side, path)?,
            Keep::Film { first, end, .. } => {
                self.needs_frame = true;
                let total = u64::from(end.saturating_sub(*first));
                let tell = |done| outbox.tell(&Event::Progress(Progress { what: Work::Film, done, total }));
                let files = keep::film(machine, side, (*first, *end), path, |done| {
                    tell(u64::from(done));
                    !inbox.is_cancelled()
                });
                tell(total);
                return files;
            }
        }
        Ok(vec![file.clone()])
    }

    fn memory(&self) -> Memory {
        let live = self.machine.device.live();
        let memory = &self.machine.device.physical().memory;
        let heaps = &memory.memory_heaps[..memory.memory_heap_count as usize];
        let resource =
            |used: MemoryUse| ResourceMemory { name: used.name, bytes: used.bytes, is_host_visible: used.host_visible };
        Memory {
            resources: live.memory().into_iter().map(resource).collect(),
            total_bytes: live.total_bytes(),
            peak_bytes: live.peak_bytes(),
            heap_bytes: heaps.iter().map(|heap| heap.size).max().unwrap_or(0),
            process_bytes: process::resident_bytes(),
        }
    }
}

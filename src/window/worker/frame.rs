//! A frame for the window: pictures, the difference, a target, small pictures.

use super::look;
use super::outbox::Exchange;
use super::state::State;
use crate::gpu::FrameSample;
use crate::image::{Rgba8, compare, preview};
use crate::measure::Error;
use crate::measure::study::Study;
use crate::window::protocol::{self, Difference, Event, SideFrame, Thumbnail};

impl<S: Study> State<S> {
    /// The frame that is drawn, under the next number. One that fails leaves neither its number nor its blocks behind: the
    /// window never hears of it, and so never takes it.
    ///
    /// # Errors
    /// Those of the Vulkan layer, and of a file that cannot grow.
    pub(super) fn next_frame(&mut self, number: u32, samples: &[FrameSample]) -> Result<protocol::Frame, Error> {
        self.serial += 1;
        self.frame(number, samples).inspect_err(|_| {
            self.exchange.withdraw(self.serial);
            self.serial -= 1;
        })
    }

    /// The frame of the last number, with all that is wanted beside its picture.
    fn frame(&mut self, number: u32, samples: &[FrameSample]) -> Result<protocol::Frame, Error> {
        let State { sides, machine, exchange, serial, wanted, outbox, .. } = self;
        let serial = *serial;
        let pictures = sides.iter().map(|side| side.picture(machine)).collect::<Result<Vec<_>, _>>()?;
        let mut shown = Vec::new();
        for ((side, sample), (picture, frame_ms)) in sides.iter().zip(samples).zip(pictures.iter().zip(&self.frame_ms))
        {
            let picture = picture.as_ref().map(|picture| look::picture(exchange, serial, picture)).transpose()?;
            shown.push(SideFrame { picture, frame_ms: *frame_ms, written: side.written(wanted.after.map(|_| sample)) });
        }
        let told = |problem: Error| outbox.tell(&Event::Failed { id: self.heeds, problem: problem.to_string() });
        // The picture is there whatever else is not.
        let difference = match pictures.as_slice() {
            [Some(left), Some(right)] if wanted.has_difference => {
                difference(exchange, serial, left, right).map_err(told).ok()
            }
            _ => None,
        };
        let target = wanted.target.as_ref().and_then(|choice| {
            let side = sides.get(choice.side)?;
            let is_written = shown[choice.side].written.contains(&choice.name);
            let raster = side.values(machine, &choice.name).map_err(told).ok()??;
            look::target(exchange, serial, choice, &raster, is_written).map_err(told).ok()
        });
        let mut thumbnails = Vec::new();
        if let Some(choice) = &wanted.thumbnails
            && let Some(side) = sides.get(choice.side)
        {
            for name in &choice.names {
                let small = side.values(machine, name).and_then(|raster| {
                    let small = raster.map(|raster| preview(&raster, choice.longest_px.clamp(1, 1024))).transpose()?;
                    small.map(|small| look::picture(exchange, serial, &small)).transpose()
                });
                thumbnails.push(Thumbnail { name: name.clone(), picture: small.map_err(told).unwrap_or(None) });
            }
        }
        Ok(protocol::Frame {
            serial,
            heeds: self.heeds,
            number,
            is_playing: self.clock.is_playing,
            speed: self.clock.speed,
            after: wanted.after,
            sides: shown,
            difference,
            target,
            thumbnails,
        })
    }
}

fn difference(exchange: &mut Exchange, serial: u64, left: &Rgba8, right: &Rgba8) -> Result<Difference, Error> {
    let found = compare::compare(left, right, None)?;
    let map = compare::heat_map(left.width(), left.height(), &compare::distances(left, right)?)?;
    let picture = look::picture(exchange, serial, &map)?;
    Ok(Difference { picture, mean: found.mean, p99: found.p99, max: found.max })
}

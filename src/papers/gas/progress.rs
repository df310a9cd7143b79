//! Work that one dispatch does not finish: a driver may end loops, and no dispatch is to be long. Each pixel's state is
//! kept for the next dispatch of the pass, whose number is raised until the last one leaves nothing.

use std::sync::Arc;

use ash::vk;
use bytemuck::Zeroable;

use super::context::Context;
use crate::gpu::transfer::{read_buffer, update, upload};
use crate::gpu::{Buffer, Error, ShaderLibrary};
use crate::{host_block, named};

host_block! {
    /// The state of a pixel, as `progress.glsl` describes it.
    pub struct StateBlock {
        words: [u32; 12],
    }
}

host_block! {
    /// Work that is left after the last dispatch of each pass.
    pub struct UnfinishedBlock {
        /// The dispatches after which some pixel was not finished, 0 where all are.
        unfinished: [u32; 4],
        /// 1 where a dispatch got no further with some pixel.
        stuck: [u32; 4],
    }
}

/// Most dispatches of a pass for one band, which keeps command buffers short of a minute's recording.
const MOST_CALLS: u32 = 4096;

/// Growth of the dispatches of a pass that lacks some.
const GROWTH: u32 = 4;

named! {
    /// The passes that carry work on, as `progress.glsl` numbers them.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Carried {
        Sort = "sort",
        Volume = "volume",
        LightAttenuation = "light-attenuation",
        Resolve = "resolve",
    }
}

impl Carried {
    /// Advice in messages that makes less work of it.
    fn remedy(self) -> &'static str {
        match self {
            Carried::Sort | Carried::Resolve => "give a larger `size` or an `object` of fewer triangles",
            Carried::Volume | Carried::LightAttenuation => {
                "lower `steps` or `samples`, or with `march` delta `tau`, `opaque` or `power`"
            }
        }
    }
}

/// The states of a band's pixels.
pub struct Progress {
    /// Of each pixel, a [`StateBlock`].
    pub states: Arc<Buffer>,
    /// One [`UnfinishedBlock`].
    pub unfinished: Arc<Buffer>,
}

impl Progress {
    /// # Errors
    /// [`Error::Limit`] for a picture beyond what the device binds.
    pub fn new(context: &Context<'_>, pixel_count: u64) -> Result<Self, Error> {
        let zeros = [0; size_of::<UnfinishedBlock>()];
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        Ok(Progress {
            states: context.storage::<StateBlock>("progress", pixel_count)?,
            unfinished: upload(context.shaders.device(), &context.name("unfinished"), usage, &zeros)?,
        })
    }
}

/// The dispatches of each pass for a band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Calls([u32; 4]);

impl Calls {
    /// One each, which most scenes need.
    pub const ONCE: Calls = Calls([1; 4]);

    pub fn of(self, pass: Carried) -> u32 {
        self.0[pass as usize]
    }

    /// More of those that left pixels unfinished; nothing where all are finished. What follows on a pass that is unfinished is
    /// not judged: a list that is half in order may have no end.
    ///
    /// # Errors
    /// [`Error::Pass`] where more dispatches do not help, or are too many.
    pub fn raised(self, shaders: &ShaderLibrary, progress: &Progress) -> Result<Option<Self>, Error> {
        let bytes = read_buffer(shaders.device(), &progress.unfinished)?;
        let Some(found) = bytemuck::pod_collect_to_vec::<u8, UnfinishedBlock>(&bytes).first().copied() else {
            return Ok(None);
        };
        let mut raised = self;
        let mut is_fed = true;
        for pass in Carried::ALL {
            let (calls, at) = (self.of(pass), pass as usize);
            let error = |problem: String| {
                Err(Error::Pass { pass: pass.as_str().to_owned(), problem: format!("{problem}; {}", pass.remedy()) })
            };
            // A list gets further by a link in each dispatch, or waits for one beside it that uses the iterations up.
            let is_stuck = found.stuck[at] != 0 && pass != Carried::Sort;
            if is_fed && is_stuck {
                let pixels = unfinished_pixels(shaders, progress, pass)?;
                return error(format!(
                    "one step of {pixels} takes more iterations than are allowed (65536, on some devices fewer)"
                ));
            }
            if found.unfinished[at] == calls {
                if is_fed && calls >= MOST_CALLS {
                    let pixels = unfinished_pixels(shaders, progress, pass)?;
                    return error(format!("{calls} dispatches do not finish {pixels}"));
                }
                raised.0[at] = calls.saturating_mul(GROWTH).min(MOST_CALLS);
                is_fed = false;
            }
        }
        if raised == self {
            return Ok(None);
        }
        // What got no further for want of other passes' work may do so now.
        update(&progress.unfinished, bytemuck::bytes_of(&UnfinishedBlock::zeroed()))?;
        Ok(Some(raised))
    }
}

/// The pixels that a pass has not finished, in words: those of the last band, where it has any.
fn unfinished_pixels(shaders: &ShaderLibrary, progress: &Progress, pass: Carried) -> Result<String, Error> {
    let states: Vec<StateBlock> = bytemuck::pod_collect_to_vec(&read_buffer(shaders.device(), &progress.states)?);
    let of_pass = pass as u32 + 1;
    Ok(match states.iter().filter(|state| state.words[11] == of_pass).count() {
        0 => "some pixel".to_owned(),
        1 => "1 pixel".to_owned(),
        count => format!("{count} pixels"),
    })
}

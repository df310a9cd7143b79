//! Query pools: timestamps and counters.

use std::sync::Arc;

use ash::vk;

use super::device::Device;
use super::error::{Context, Error};
use super::live::Kind;

/// The quantity that a pool of queries counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Counter {
    Timestamps,
    /// Samples that passed all tests.
    Samples,
    /// Assembled primitives, vertex-stage invocations, clipped primitives, fragment-stage invocations. Compute invocations
    /// have a pool of their own: counting them beside graphics work alone brings one driver down.
    Graphics,
    /// Compute-stage invocations.
    Compute,
}

impl Counter {
    fn values(self) -> usize {
        if self == Counter::Graphics { 4 } else { 1 }
    }
}

/// A pool of queries used from the front on, reset on the host.
pub(crate) struct QueryPool {
    /// The pool.
    pub raw: vk::QueryPool,
    device: Arc<Device>,
    counter: Counter,
    capacity: u32,
    used: u32,
    /// Queries from the front on that are reset, or used.
    ready: u32,
    values: Vec<u64>,
}

/// Queries that are reset at once when a frame wants more than any before it: a pool holds far more than most.
const RESET_TOGETHER: u32 = 256;

impl QueryPool {
    pub fn new(device: &Arc<Device>, counter: Counter, capacity: u32) -> Result<Self, Error> {
        let (kind, statistics) = match counter {
            Counter::Timestamps => (vk::QueryType::TIMESTAMP, vk::QueryPipelineStatisticFlags::empty()),
            Counter::Samples => (vk::QueryType::OCCLUSION, vk::QueryPipelineStatisticFlags::empty()),
            Counter::Graphics => (
                vk::QueryType::PIPELINE_STATISTICS,
                vk::QueryPipelineStatisticFlags::VERTEX_SHADER_INVOCATIONS
                    | vk::QueryPipelineStatisticFlags::INPUT_ASSEMBLY_PRIMITIVES
                    | vk::QueryPipelineStatisticFlags::CLIPPING_PRIMITIVES
                    | vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS,
            ),
            Counter::Compute => {
                (vk::QueryType::PIPELINE_STATISTICS, vk::QueryPipelineStatisticFlags::COMPUTE_SHADER_INVOCATIONS)
            }
        };
        let info =
            vk::QueryPoolCreateInfo::default().query_type(kind).query_count(capacity).pipeline_statistics(statistics);
        // SAFETY: the device is alive; statistics are asked for only where the feature was found and enabled.
        let raw = unsafe { device.raw.create_query_pool(&info, None) }.context("creating", "a query pool")?;
        device.live().add(Kind::QueryPool);
        Ok(QueryPool {
            raw,
            device: device.clone(),
            counter,
            capacity,
            used: 0,
            ready: 0,
            values: vec![0; capacity as usize * counter.values()],
        })
    }

    /// Starts over; nothing recorded with this pool is in flight.
    pub fn reset(&mut self) {
        if self.used > 0 {
            // SAFETY: the fence of the last submission was waited for, so no query of this pool is in use.
            unsafe { self.device.raw.reset_query_pool(self.raw, 0, self.used) };
            self.used = 0;
        }
    }

    /// The next query, or `None` when the pool is spent.
    pub fn take(&mut self) -> Option<u32> {
        if self.used == self.capacity {
            return None;
        }
        if self.used == self.ready {
            let count = RESET_TOGETHER.min(self.capacity - self.ready);
            // SAFETY: these queries lie behind all that were ever taken, so none of them is in use.
            unsafe { self.device.raw.reset_query_pool(self.raw, self.ready, count) };
            self.ready += count;
        }
        self.used += 1;
        Some(self.used - 1)
    }

    /// The values of the queries used so far, `values()` a query.
    pub fn read(&mut self) -> Result<&[u64], Error> {
        let count = self.used as usize * self.counter.values();
        if self.used > 0 {
            // vkGetQueryPoolResults wants the stride of one query: ash derives it from the element type, so queries of
            // several values are read one by one.
            let per_query = self.counter.values();
            let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
            for query in 0..self.used {
                let at = query as usize * per_query;
                let target = &mut self.values[at..at + per_query];
                // SAFETY: the query was recorded and its submission has finished; the slice holds its values.
                unsafe {
                    (self.device.raw.fp_v1_0().get_query_pool_results)(
                        self.device.raw.handle(),
                        self.raw,
                        query,
                        1,
                        std::mem::size_of_val(target),
                        target.as_mut_ptr().cast(),
                        std::mem::size_of_val(target) as vk::DeviceSize,
                        flags,
                    )
                }
                .result()
                .context("reading", "a query pool")?;
            }
        }
        Ok(&self.values[..count])
    }
}

impl Drop for QueryPool {
    fn drop(&mut self) {
        // SAFETY: the recorder that owns this pool waits for its last submission before it drops.
        unsafe { self.device.raw.destroy_query_pool(self.raw, None) };
        self.device.live().remove(Kind::QueryPool);
    }
}

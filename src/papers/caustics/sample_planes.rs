//! Pass `sample-planes` (sections 4.2.1 and 5.2.1): each receiver's box, aligned with the light and sliced uniformly:
//! what the level map calls its reference planes.

use std::sync::Arc;

use super::parameters::Parameters;
use super::receiver::LitReceiver;
use crate::gpu::{Frame, PassInfo};

/// The pass.
pub struct SamplePlanes {
    info: Arc<PassInfo>,
    planes: u32,
}

impl SamplePlanes {
    pub fn new(parameters: &Parameters) -> Self {
        let info = PassInfo::host("sample-planes", "4.2.1", &["receiver"], &["planes"]);
        SamplePlanes { info, planes: parameters.planes }
    }

    /// Aligns and slices every box anew.
    pub fn record(&self, frame: &mut Frame<'_>, receivers: &mut [LitReceiver]) {
        frame.host(&self.info, || receivers.iter_mut().for_each(|lit| lit.slice(self.planes)));
    }
}

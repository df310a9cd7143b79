//! Pass `reference-planes` (section 4.2.1): each receiver's box, aligned with the light and sliced uniformly.

use std::sync::Arc;

use super::receiver::LitReceiver;
use crate::gpu::{Frame, PassInfo};

/// The pass.
pub struct ReferencePlanes {
    info: Arc<PassInfo>,
}

impl ReferencePlanes {
    pub fn new() -> Self {
        let info = PassInfo::host("reference-planes", "4.2.1", &["receiver"], &["planes"]);
        ReferencePlanes { info }
    }

    /// Aligns and slices every box anew.
    pub fn record(&self, frame: &mut Frame<'_>, receivers: &mut [LitReceiver]) {
        frame.host(&self.info, || receivers.iter_mut().for_each(|lit| lit.slice(lit.planes)));
    }
}

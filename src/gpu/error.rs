//! Errors of the Vulkan layer. Every message names the operation, the object and the way out.

use ash::vk;

/// An error of the Vulkan layer.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(
        "loading the Vulkan loader: {reason}; install it (Debian, Ubuntu: apt-get install libvulkan1) or the GPU vendor's driver"
    )]
    NoLoader {
        /// The system's message on the library.
        reason: String,
    },
    #[error(
        "creating a Vulkan instance: {reason}; check that a driver is installed (Debian, Ubuntu: apt-get install mesa-vulkan-drivers)"
    )]
    NoInstance {
        /// Vulkan's result, or the version, extension or handle that is missing.
        reason: String,
    },
    #[error("looking for a Vulkan device: {reason}; `fumarole devices` lists what is there")]
    NoDevice {
        /// Vulkan's result, or why none of the devices serves.
        reason: String,
    },
    #[error(
        "enabling validation: the layer VK_LAYER_KHRONOS_validation is not installed; install it (Debian, Ubuntu: apt-get install vulkan-validationlayers) or leave --validate out"
    )]
    NoValidationLayer,
    #[error("choosing a device: {wanted:?} names none of: {present}; give an index, a part of a name or a UUID")]
    UnknownDevice {
        /// Index, part of a name or UUID that the user gave.
        wanted: String,
        /// Devices that are there, as one text.
        present: String,
    },
    #[error("choosing a device: {wanted:?} names several: {matching}; give the index or the UUID")]
    AmbiguousDevice {
        /// Part of a name that the user gave.
        wanted: String,
        /// Devices that have it, as one text.
        matching: String,
    },
    #[error("using device {device}: it lacks {missing}; choose another with --device")]
    MissingFeature {
        /// The driver's name for the device.
        device: String,
        /// Features that it lacks, as one text.
        missing: String,
    },
    #[error("{object}: {what} {wanted} is beyond this device's limit of {limit}; lower it")]
    Limit {
        /// Resource or pass that is too large; the parameter that sets its size may follow.
        object: String,
        /// Quantity that is compared, with its unit.
        what: &'static str,
        /// Value of the quantity.
        wanted: u64,
        /// Greatest value that the device allows.
        limit: u64,
    },
    #[error("{}{object}: out of memory; lower the sizes or choose a device with more", allocating(*bytes))]
    OutOfMemory {
        /// Resource that was to be made.
        object: String,
        /// Size of the allocation that failed; 0 where the driver tells none.
        bytes: u64,
    },
    #[error("{operation} {object}: {result}")]
    Vulkan {
        /// The operation as a participle, such as `creating image`.
        operation: &'static str,
        /// Name of the object that it was done to.
        object: String,
        /// Result code of the call.
        result: vk::Result,
    },
    #[error("allocating memory for {object}: {reason}")]
    Allocation {
        /// Resource whose memory was to be allocated.
        object: String,
        /// Message of the allocator.
        reason: String,
    },
    #[error("pass {pass}: reads {resource}, which no pass has written")]
    ReadBeforeWrite {
        /// Name of the pass that reads.
        pass: String,
        /// Name of the resource whose contents are undefined.
        resource: String,
    },
    #[error(
        "pass {pass}: {resource} is in use by a frame, a copy or a reader that has not finished; let that finish first"
    )]
    InUse {
        /// Name of the pass, or of the copy, that wants it too.
        pass: String,
        /// Name of the resource that an unfinished submission holds.
        resource: String,
    },
    #[error("pass {pass}: {object} belongs to another device; make it on this one")]
    Foreign {
        /// Name of the pass, or of the operation.
        pass: String,
        /// Name of the object of another device.
        object: String,
    },
    #[error("{object}: neither this layer nor this device has {problem}")]
    Unsupported {
        /// Name of the object that was to be made.
        object: String,
        /// Feature or combination that is missing.
        problem: String,
    },
    #[error("host access to {object}: {problem}")]
    HostAccess {
        /// Name of the buffer.
        object: String,
        /// Reason why the host may not read or write there.
        problem: String,
    },
    #[error("filling {object}: {reason}")]
    Filling {
        /// Name of the resource that the host fills.
        object: String,
        /// Reason why there is nothing to fill it with, and the way out.
        reason: String,
    },
    #[error("pass {pass}: it lies behind the end that this frame was given")]
    BeyondEnd {
        /// Name of the pass that the host would have waited for.
        pass: String,
    },
    #[error("interrupted between two submissions of a frame")]
    Interrupted,
    #[error("pass {pass}: {problem}")]
    Pass {
        /// Name of the pass.
        pass: String,
        /// The fault in its description or in its recording.
        problem: String,
    },
    #[error("shader {name}: {problem}")]
    Shader {
        /// Path of the shader under `shaders/`, or folder of those that replace them.
        name: String,
        /// The fault, with file and line where a compiler names them.
        problem: String,
    },
    #[error(
        "capturing a frame: {reason}; start the program from RenderDoc, or as `renderdoccmd capture PROGRAM OPTIONS`"
    )]
    Capture {
        /// Reason why RenderDoc captured nothing.
        reason: String,
    },
    #[error("validation: {} message(s), the first: {first}", count)]
    Validation {
        /// Messages of the layer, 1 or more.
        count: usize,
        /// Text of the first one, with the names of its objects.
        first: String,
    },
}

/// Begin of the message on memory; a driver that ran out of it elsewhere tells no size.
fn allocating(bytes: u64) -> String {
    if bytes == 0 { String::new() } else { format!("allocating {bytes} bytes for ") }
}

impl Error {
    /// Names the parameter by which a user lowers what is beyond a limit, beside the object.
    pub fn set_by(self, parameter: &str) -> Self {
        match self {
            Error::Limit { object, what, wanted, limit } => {
                Error::Limit { object: format!("{object} (`{parameter}`)"), what, wanted, limit }
            }
            other => other,
        }
    }

    /// Wraps a result code that the caller has no better word for.
    pub(crate) fn vulkan(operation: &'static str, object: impl Into<String>, result: vk::Result) -> Self {
        let object = object.into();
        match result {
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => {
                Error::OutOfMemory { object: format!("{object} ({operation})"), bytes: 0 }
            }
            _ => Error::Vulkan { operation, object, result },
        }
    }
}

/// Names operation and object on a raw Vulkan result.
pub(crate) trait Context<T> {
    fn context(self, operation: &'static str, object: impl Into<String>) -> Result<T, Error>;

    /// Of what is asked before there is a device: an [`Error::NoDevice`] whatever the reason.
    fn before_a_device(self, operation: &'static str, object: &str) -> Result<T, Error>;
}

impl<T> Context<T> for Result<T, vk::Result> {
    fn context(self, operation: &'static str, object: impl Into<String>) -> Result<T, Error> {
        self.map_err(|result| Error::vulkan(operation, object, result))
    }

    fn before_a_device(self, operation: &'static str, object: &str) -> Result<T, Error> {
        self.map_err(|result| Error::NoDevice { reason: format!("{operation} {object}: {result}") })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_of_no_known_size_is_told_without_one() {
        for result in [vk::Result::ERROR_OUT_OF_DEVICE_MEMORY, vk::Result::ERROR_OUT_OF_HOST_MEMORY] {
            let error = Err::<(), _>(result).context("creating buffer", "water").unwrap_err();
            let told = "water (creating buffer): out of memory; lower the sizes or choose a device with more";
            assert_eq!(error.to_string(), told, "{result}");
        }
        let error = |bytes| Error::OutOfMemory { object: "water".to_owned(), bytes }.to_string();
        assert!(!error(0).contains("allocating"), "{}", error(0));
        assert!(error(1).starts_with("allocating 1 bytes for water: "), "{}", error(1));
    }
}

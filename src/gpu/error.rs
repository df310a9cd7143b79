//! Errors of the Vulkan layer. Every message names the operation, the object and the way out.

use ash::vk;

/// An error of the Vulkan layer.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(
        "loading the Vulkan loader: {reason}; install it (Debian, Ubuntu: apt-get install libvulkan1) or the GPU vendor's driver"
    )]
    NoLoader { reason: String },
    #[error(
        "creating a Vulkan instance: {reason}; check that a driver is installed (Debian, Ubuntu: apt-get install mesa-vulkan-drivers)"
    )]
    NoInstance { reason: String },
    #[error("looking for a Vulkan device: {reason}; `fumarole devices` lists what is there")]
    NoDevice { reason: String },
    #[error(
        "enabling validation: the layer VK_LAYER_KHRONOS_validation is not installed; install it (Debian, Ubuntu: apt-get install vulkan-validationlayers) or leave --validate out"
    )]
    NoValidationLayer,
    #[error("choosing a device: {wanted:?} names none of: {present}; give an index, a part of a name or a UUID")]
    UnknownDevice { wanted: String, present: String },
    #[error("choosing a device: {wanted:?} names several: {matching}; give the index or the UUID")]
    AmbiguousDevice { wanted: String, matching: String },
    #[error("using device {device}: it lacks {missing}; choose another with --device")]
    MissingFeature { device: String, missing: String },
    #[error("{object}: {what} {wanted} is beyond this device's limit of {limit}; lower it")]
    Limit { object: String, what: &'static str, wanted: u64, limit: u64 },
    #[error("{}{object}: out of memory; lower the sizes or choose a device with more", allocating(*bytes))]
    OutOfMemory { object: String, bytes: u64 },
    #[error("{operation} {object}: {result}")]
    Vulkan { operation: &'static str, object: String, result: vk::Result },
    #[error("allocating memory for {object}: {reason}")]
    Allocation { object: String, reason: String },
    #[error("pass {pass}: reads {resource}, which no pass has written")]
    ReadBeforeWrite { pass: String, resource: String },
    #[error(
        "pass {pass}: {resource} is in use by a frame, a copy or a reader that has not finished; let that finish first"
    )]
    InUse { pass: String, resource: String },
    #[error("pass {pass}: {object} belongs to another device; make it on this one")]
    Foreign { pass: String, object: String },
    #[error("{object}: neither this layer nor this device has {problem}")]
    Unsupported { object: String, problem: String },
    #[error("host access to {object}: {problem}")]
    HostAccess { object: String, problem: String },
    #[error("pass {pass}: it lies behind the end that this frame was given")]
    BeyondEnd { pass: String },
    #[error("interrupted between two submissions of a frame")]
    Interrupted,
    #[error("pass {pass}: {problem}")]
    Pass { pass: String, problem: String },
    #[error("shader {name}: {problem}")]
    Shader { name: String, problem: String },
    #[error(
        "capturing a frame: {reason}; start the program from RenderDoc, or as `renderdoccmd capture PROGRAM OPTIONS`"
    )]
    Capture { reason: String },
    #[error("validation: {} message(s), the first: {first}", count)]
    Validation { count: usize, first: String },
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

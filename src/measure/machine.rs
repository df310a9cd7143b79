//! The machine that measures: one device, its shaders, its recorder, and their description for the record.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use super::error::Error as InputError;
use crate::content;
use crate::gpu::physical::{DeviceType, choose};
use crate::gpu::{Compiler, Device, Error, Feature, Instance, PhysicalDevice, Recorder, Replacements, ShaderLibrary};
use crate::report::environment;
use crate::report::record::{self, DeviceKind, Environment, Validation};

/// A user's choices about the machine.
#[derive(Debug, Clone, Default)]
pub struct MachineOptions {
    /// Index, part of the name, or UUID.
    pub device: Option<String>,
    /// The validation layer with synchronization validation; any message is a failure.
    pub validate: bool,
    /// Compiler of the SPIR-V.
    pub compiler: Compiler,
    /// Shaders compiled at start in place of the built-in ones.
    pub shader_dir: Option<PathBuf>,
    /// Number of this process among several fresh ones, from 0.
    pub process: u32,
    /// Keep what the driver's compiler tells of pipelines.
    pub is_profiled: bool,
}

impl MachineOptions {
    /// SHA-256 of the shaders that stand in for the built-in ones; none without any.
    ///
    /// # Errors
    /// [`InputError::Input`] for shaders that cannot be read.
    pub fn shaders_sha256(&self) -> Result<Option<String>, InputError> {
        let sha256 = |folder: &PathBuf| {
            content::folder_sha256(folder)
                .map_err(|e| InputError::Input(format!("reading the shaders under {}: {e}", folder.display())))
        };
        self.shader_dir.as_ref().map(sha256).transpose()
    }
}

/// An open machine.
pub struct Machine {
    /// Records and times frames on the device's queue.
    pub recorder: Recorder,
    /// Modules of the chosen compiler.
    pub shaders: ShaderLibrary,
    /// The open device.
    pub device: Arc<Device>,
    /// RFC 3339, when it was opened.
    opened: String,
    /// Number of this process among several fresh ones, from 0.
    pub process: u32,
    /// Warnings of what it has drawn as pictures.
    pub drawn: Drawn,
}

/// Warnings of papers that were drawn, each once; clones share them.
#[derive(Debug, Clone, Default)]
pub struct Drawn(Arc<Mutex<Vec<String>>>);

impl Drawn {
    /// Adds a paper's.
    pub fn add(&self, warnings: Vec<String>) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for warning in warnings {
            if !all.contains(&warning) {
                all.push(warning);
            }
        }
    }

    /// All of them.
    pub fn warnings(&self) -> Vec<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Machine {
    /// Opens the device that the options name, or the best one that has `needed`.
    ///
    /// # Errors
    /// Any error of the Vulkan layer, [`Error::Shader`] for a shader directory that does not compile.
    pub fn open(options: &MachineOptions, needed: &[Feature]) -> Result<Self, Error> {
        // A folder that is refused needs no device.
        let replacements = Replacements::read(options.shader_dir.as_deref())?;
        let instance = Instance::new(options.validate)?;
        let physical = choose(PhysicalDevice::enumerate(&instance)?, options.device.as_deref(), needed)?;
        let physical = if options.is_profiled { physical.profiled() } else { physical };
        let device = Device::open(&instance, physical)?;
        Ok(Machine {
            recorder: Recorder::new(&device)?,
            shaders: ShaderLibrary::with(&device, options.compiler, replacements),
            device,
            opened: environment::date(),
            process: options.process,
            drawn: Drawn::default(),
        })
    }

    /// One line that names the device.
    pub fn description(&self) -> String {
        let p = self.device.physical();
        format!("{} ({}, {} {})", p.name, p.device_type.as_str(), p.driver_name, p.driver_info)
    }

    /// Device, host and build for the record.
    pub fn environment(&self) -> Environment {
        let physical = self.device.physical();
        let bits = physical.queue.map(|q| q.1).filter(|&bits| bits > 0);
        let some = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        Environment {
            date: self.opened.clone(),
            device: record::Device {
                name: physical.name.clone(),
                kind: device_kind(physical.device_type),
                uuid: Some(physical.uuid_text()),
                driver: some(&physical.driver_name),
                driver_version: some(&physical.driver_info),
                api_version: physical.api_version_text(),
                timestamp_period: bits.map(|_| f64::from(physical.limits.timestamp_period)),
                timestamp_bits: bits,
            },
            host: environment::host(),
            loader: Some(self.device.instance().loader_version()),
            layers: self.device.instance().layers().to_vec(),
            build: environment::build(),
        }
    }

    /// State of the validation layer; fails if it had a message.
    ///
    /// # Errors
    /// [`Error::Validation`].
    pub fn check_validation(&self) -> Result<Validation, Error> {
        let instance = self.device.instance();
        instance.check_messages()?;
        Ok(if instance.validates() { Validation::Clean } else { Validation::Off })
    }

    /// Doubts about figures of this machine, one line each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if cfg!(debug_assertions) {
            warnings.push("debug build: host times are not those of a release build".to_owned());
        }
        if self.device.instance().validates() {
            warnings.push("the validation layer is on: times include it".to_owned());
        }
        for variable in ["VK_INSTANCE_LAYERS", "VK_LOADER_LAYERS_ENABLE"] {
            if let Some(layers) = std::env::var_os(variable).filter(|v| !v.is_empty()) {
                warnings.push(format!("foreign layers are on ({variable}={})", layers.to_string_lossy()));
            }
        }
        let is_cpu = self.device.physical().device_type == DeviceType::Cpu;
        let threads = std::env::var_os("LP_NUM_THREADS");
        if is_cpu && environment::lp_num_threads().is_none() {
            let what = threads
                .map_or_else(|| " is not set".to_owned(), |text| format!("={} is no number", text.to_string_lossy()));
            warnings.push(format!("LP_NUM_THREADS{what}: the driver takes as many threads as it likes"));
        }
        if self.device.physical().queue.is_none_or(|(_, bits)| bits == 0) {
            warnings.push("the device has no timestamps: GPU times are absent".to_owned());
        }
        let physical = self.device.physical();
        if !physical.has(Feature::PipelineStatistics) {
            warnings
                .push("the device has no pipeline statistics: vertices, primitives and invocations are absent".into());
        }
        if !physical.has(Feature::PreciseOcclusion) {
            warnings.push("the device has no exact counts of samples: samples passed are absent".to_owned());
        }
        warnings
    }
}

/// The record's name for a device's type.
pub fn device_kind(device_type: DeviceType) -> DeviceKind {
    match device_type {
        DeviceType::Discrete => DeviceKind::Discrete,
        DeviceType::Integrated => DeviceKind::Integrated,
        DeviceType::Virtual => DeviceKind::Virtual,
        DeviceType::Cpu => DeviceKind::Cpu,
        DeviceType::Other => DeviceKind::Other,
    }
}

//! One configuration of a paper, measured in one or more variants.

use std::sync::Arc;
use std::time::Instant;

use super::assembly::{self, RunMetadata, assemble};
use super::error::Error;
use super::estimate::Estimate;
use super::limits;
use super::machine::Machine;
use super::measure::{Measurement, Schedule, Watch, measure};
use super::study::Study;
use crate::gpu::live::MemoryUse;
use crate::gpu::physical::DeviceType;
use crate::gpu::{self, Device, Recorder, ShaderLibrary};
use crate::measure::{Paper, Variant};
use crate::report::environment;
use crate::report::record::{InputFile, Limits, Loading, Run};
use crate::report::trace::TraceRun;
use crate::scene::loading::LoadParts;
use crate::scene::{notes, source_sha256};

/// The input of a study with the time that loading it took.
pub struct Loaded<S: Study> {
    /// The input, loaded and placed.
    pub scene: S::Scene,
    /// Milliseconds of loading it.
    pub load_ms: f64,
    /// Times of the steps of loading its mesh files; none where there are none.
    pub loading: Option<Loading>,
    /// Notes on what readers passed over in its files, a line each.
    pub notes: Vec<String>,
}

/// Loads a study's input.
///
/// # Errors
/// As [`Study::load`].
pub fn load<S: Study>(study: &S) -> Result<Loaded<S>, Error> {
    LoadParts::take();
    notes::take();
    let started = Instant::now();
    let scene = study.load()?;
    let load_ms = started.elapsed().as_secs_f64() * 1e3;
    let parts = LoadParts::take();
    let loading = Loading {
        bytes: parts.bytes,
        read_ms: parts.read_ms,
        weld_ms: parts.weld_ms,
        normals_ms: parts.normals_ms,
        optimise_ms: parts.optimise_ms,
        cache_ms: parts.cache_ms,
        from_cache: parts.from_cache,
    };
    let has_files = parts.bytes > 0 || parts.from_cache > 0;
    Ok(Loaded { scene, load_ms, loading: has_files.then_some(loading), notes: notes::take() })
}

/// Measures papers, each with the shaders that it is made of, again and again until their buffers suffice. First use is that
/// of the first time.
///
/// # Errors
/// [`Error::Interrupted`] where a paper has no whole frame; any error of the Vulkan layer.
pub fn measure_settled(
    device: &Device,
    recorder: &mut Recorder,
    papers: &mut [(&mut dyn Paper, &ShaderLibrary)],
    schedule: Schedule,
    watch: &mut Watch<'_>,
) -> Result<Vec<Measurement>, Error> {
    let mut first_frame_ms: Option<Vec<f64>> = None;
    loop {
        let mut measured: Vec<&mut dyn Paper> = Vec::with_capacity(papers.len());
        for (paper, _) in papers.iter_mut() {
            measured.push(&mut **paper);
        }
        let mut measurements = measure(recorder, &mut measured, schedule, watch)?;
        device.wait_idle()?;
        if measurements.iter().any(|m| m.frame_ms.is_empty()) {
            return Err(Error::Interrupted);
        }
        // Passes that are made anew find compiled what the first ones had to wait for.
        let first_frame_ms =
            first_frame_ms.get_or_insert_with(|| measurements.iter().map(|one| one.first_frame_ms).collect());
        let mut are_settled = true;
        for (paper, shaders) in papers.iter_mut() {
            are_settled &= paper.settle(shaders)?;
        }
        if are_settled {
            for (measurement, first_ms) in measurements.iter_mut().zip(first_frame_ms) {
                measurement.first_frame_ms = *first_ms;
            }
            return Ok(measurements);
        }
    }
}

/// Triangles of files that are read before it is known what device there is: moments.
pub const QUICKLY_READ: u64 = 1 << 20;

/// Loads a study's input and opens the device. Of large files the device comes first: what it cannot hold is refused
/// unread.
///
/// # Errors
/// As [`Study::load`] and [`Machine::open`]; [`gpu::Error::Limit`] by the parameter.
pub fn load_for<S: Study>(
    study: &S,
    variants: &[S::Variant],
    open: impl FnOnce() -> Result<Machine, gpu::Error>,
) -> Result<(Loaded<S>, Machine), Error> {
    let triangles = study.promised_triangles()?;
    if triangles < QUICKLY_READ {
        let loaded = load(study)?;
        return Ok((loaded, open()?));
    }
    let machine = open()?;
    for &variant in variants {
        study.foresee(triangles, variant).check(&machine.device, variant.as_str())?;
    }
    Ok((load(study)?, machine))
}

/// A variant with its resources, and what they cost.
pub struct Built<S: Study> {
    /// The variant.
    pub variant: S::Variant,
    /// Its resources, ready to record frames.
    pub paper: S::Paper,
    /// Milliseconds of making them, pipelines included.
    pub build_ms: f64,
    /// Every live resource of the variant, without its prefix: as it was made, or as it was last [weighed](Self::weigh).
    pub memory: Vec<MemoryUse>,
    /// Greatest number of bytes allocated for it while it was made, or at any time since that it was weighed.
    pub peak_bytes: u64,
    /// Prefix of its resources' names.
    prefix: String,
}

impl<S: Study> Built<S> {
    /// Looks at its resources again: a paper may replace its buffers by larger ones as frames ask for more.
    pub fn weigh(&mut self, machine: &Machine) {
        self.memory = memory_of(machine, &self.prefix);
        self.peak_bytes = self.peak_bytes.max(self.memory.iter().map(|resource| resource.bytes).sum());
    }
}

/// Every live resource whose name begins with the prefix, without it.
fn memory_of(machine: &Machine, prefix: &str) -> Vec<MemoryUse> {
    let mut memory = machine.device.live().memory();
    memory.retain_mut(|resource| match resource.name.strip_prefix(prefix) {
        Some(name) => {
            resource.name = name.to_owned();
            true
        }
        None => false,
    });
    memory
}

/// Makes the resources of a variant.
///
/// # Errors
/// [`Error::Gpu`]; a limit by its parameter for what is larger than the device, before anything is allocated.
pub fn build<S: Study>(machine: &Machine, study: &S, scene: &S::Scene, variant: S::Variant) -> Result<Built<S>, Error> {
    build_as(machine, study, scene, variant, variant.as_str())
}

/// The same, under a label that no other has.
fn build_as<S: Study>(
    machine: &Machine,
    study: &S,
    scene: &S::Scene,
    variant: S::Variant,
    label: &str,
) -> Result<Built<S>, Error> {
    let live = Arc::clone(machine.device.live());
    let before: u64 = live.memory().iter().map(|m| m.bytes).sum();
    live.reset_peak();
    let started = Instant::now();
    study.estimate(&machine.device, scene, variant).check(&machine.device, variant.as_str())?;
    let made = study.make(&machine.shaders, label, scene, variant);
    let paper = made.map_err(|error| machine.shaders.blamed(error))?;
    let build_ms = started.elapsed().as_secs_f64() * 1e3;
    let prefix = format!("{label}/");
    let memory = memory_of(machine, &prefix);
    Ok(Built { variant, paper, build_ms, memory, peak_bytes: live.peak_bytes() - before, prefix })
}

/// A configuration to measure, with its [alternatives](Study::alternatives).
pub struct Bench<'a, S: Study> {
    /// The configuration.
    pub study: &'a S,
    /// Its input.
    pub loaded: &'a Loaded<S>,
    /// Variants to interleave, at least one.
    pub variants: &'a [S::Variant],
    /// Frames and repetitions.
    pub schedule: Schedule,
    /// The device's own limits, where they were measured.
    pub limits: Option<&'a Limits>,
}

/// Identity of every file that a study's parameters name.
///
/// # Errors
/// [`Error::Input`] for a file that cannot be read.
pub fn inputs<S: Study>(study: &S) -> Result<Vec<InputFile>, Error> {
    let files = S::parameters().iter().flat_map(|parameter| parameter.files(study)).collect::<Vec<_>>();
    files
        .into_iter()
        .map(|path| {
            let sha256 = source_sha256(&path)
                .map_err(|e| Error::Input(format!("reading {} again for its identity: {e}", path.display())))?;
            Ok(InputFile { path: path.display().to_string(), sha256 })
        })
        .collect()
}

/// One variant's run with its trace.
pub struct VariantRun {
    /// The record's run.
    pub run: Run,
    /// Timeline of its measured frames.
    pub trace: TraceRun,
}

impl<S: Study> Bench<'_, S> {
    /// Measures the variants, interleaved; each in all alternatives, one after the other.
    ///
    /// # Errors
    /// [`Error::Gpu`]; [`Error::Interrupted`] when not one frame was measured.
    pub fn measure(&self, machine: &mut Machine, watch: &mut Watch<'_>) -> Result<Vec<VariantRun>, Error> {
        self.measure_and(machine, watch, |_, _| Ok(()))
    }

    /// The same, with a look at each variant's resources after the measured loop.
    ///
    /// # Errors
    /// Those of [`Bench::measure`], and of `inspect`.
    pub fn measure_and(
        &self,
        machine: &mut Machine,
        watch: &mut Watch<'_>,
        mut inspect: impl FnMut(&mut Machine, &mut S::Paper) -> Result<(), Error>,
    ) -> Result<Vec<VariantRun>, Error> {
        let Bench { study, loaded, variants, schedule, .. } = *self;
        let started = environment::instant();
        // As they were loaded: who changes a file meanwhile changes nothing that is measured.
        let inputs = inputs(study)?;
        let studies = study.alternatives();
        let sides = variants.iter().flat_map(|&variant| studies.iter().map(move |study| (study, variant)));
        let estimates = sides.clone().map(|(study, variant)| study.estimate(&machine.device, &loaded.scene, variant));
        Estimate::all(estimates).check(&machine.device, "all variants together")?;
        let mut built = sides
            .clone()
            .enumerate()
            .map(|(number, (study, variant))| {
                let label = match studies.len() {
                    1 => variant.as_str().to_owned(),
                    _ => format!("{}-{number}", variant.as_str()),
                };
                // What it costs to make it holds all its pipelines, also those that a variant before it has made.
                machine.shaders.forget_pipelines();
                build_as(machine, study, &loaded.scene, variant, &label)
            })
            .collect::<Result<Vec<_>, _>>()?;
        machine.device.wait_idle()?;
        let stamp_floor_ms = machine.recorder.timestamp_floor_ms()?;
        let mut papers: Vec<(&mut dyn Paper, _)> =
            built.iter_mut().map(|b| (&mut b.paper as &mut dyn Paper, &machine.shaders)).collect();
        let measurements = measure_settled(&machine.device, &mut machine.recorder, &mut papers, schedule, watch)?;
        built.iter_mut().for_each(|built| built.weigh(machine));
        let mut measured: Vec<_> = built.into_iter().zip(measurements).collect();
        let metrics = study.metrics(machine, &mut measured)?;
        measured.iter_mut().try_for_each(|(built, _)| inspect(machine, &mut built.paper))?;
        let validation = machine.check_validation()?;
        let of_limits = self.limits.and_then(limits::warning).into_iter().collect();
        let warnings = [machine.warnings(), of_limits, loaded.notes.clone()].concat();
        let identity = study.identity();
        let runs = measured.iter().zip(metrics).zip(sides).map(|(((built, measurement), metrics), (study, _))| {
            let metadata = RunMetadata {
                paper: S::PAPER,
                variant: built.variant.as_str().to_owned(),
                identity: identity.clone(),
                process: machine.process,
                config: study.config(&loaded.scene, &built.paper),
                inputs: inputs.clone(),
                started: started.clone(),
                load_ms: loaded.load_ms,
                loading: loaded.loading.clone(),
                build_ms: built.build_ms,
                memory: built.memory.clone(),
                peak_bytes: built.peak_bytes,
                results: metrics.results,
                limits: self.limits.cloned(),
                stamp_floor_ms,
                is_cpu: machine.device.physical().device_type == DeviceType::Cpu,
                validation,
                warnings: warnings.iter().cloned().chain(metrics.warnings).collect(),
            };
            let name = format!("{} {} {}", S::PAPER, built.variant.as_str(), study.summary());
            VariantRun { run: assemble(metadata, measurement, schedule), trace: assembly::trace(name, measurement) }
        });
        Ok(runs.collect())
    }
}

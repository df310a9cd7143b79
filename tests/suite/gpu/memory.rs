//! Memory from frame to frame: lavapipe compiles a shader anew for the values of uniform blocks and push constants on
//! which alone one of its conditions depends, and keeps every copy. Each variant runs in a process of its own, whose
//! resident memory is nobody else's.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::process::Command;

use fumarole::gpu::physical::choose;
use fumarole::gpu::{Compiler, Device, Instance, Mode, PhysicalDevice, Recorder, ShaderLibrary};
use fumarole::measure::parameter::Given;
use fumarole::measure::study::{Study, Visitor};
use fumarole::measure::{Error, Paper, Variant};
use fumarole::papers::{self, burning, caustics, gas, lava, terrain};

use crate::cli::{burning_materials, program};
use crate::common::{beside_others, wanted_device};

/// Paper, variant and parameters that the process is to run.
const VARIABLE: &str = "FUMAROLE_TEST_MEMORY";
/// Frames until pipelines, pools and the allocator have what they keep, and those that are looked at.
const WARMUP: u32 = 40;
const FRAMES: u32 = 300;
/// Most that they may leave behind.
const LIMIT_KB: i64 = 1024;

/// A fire of few particles and blocks: shaders are compiled anew for values, whatever they work on.
const FIRE: &str = "size=32x24 blocks=5x5x5 fire=200 smoke=100 levels=2 first-frame=60 speed=0.3";

#[test]
fn gas_needs_no_more_memory_from_frame_to_frame() {
    stays_flat::<gas::setup::Setup>("size=24x16 steps=6 table=8 froxels=9x7x8");
}

#[test]
fn burning_needs_no_more_memory_from_frame_to_frame() {
    stays_flat::<burning::setup::Setup>(&format!("{FIRE} triangles=600"));
}

#[test]
fn caustics_needs_no_more_memory_from_frame_to_frame() {
    stays_flat::<caustics::setup::Setup>("mesh=box size=32x24 map-size=32 water-triangles=200 planes=5 levels=8");
}

#[test]
fn lava_needs_no_more_memory_from_frame_to_frame() {
    stays_flat::<lava::setup::Setup>("size=32x24 particles=2000 density=24x8x8 radius=0.2 splats=60x15");
}

#[test]
fn terrain_needs_no_more_memory_from_frame_to_frame() {
    stays_flat::<terrain::setup::Setup>("size=32x24 resolution=64");
}

/// Here and below: options that bring shaders or buffers of their own.
#[test]
fn gas_by_other_ways_needs_no_more_memory_from_frame_to_frame() {
    let eight = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/volumes/eight.nrrd");
    let file = format!("steps=6 volume-filter=tricubic volume-file={eight}");
    for (variant, options) in [
        // Paths at random take long, however few the pixels.
        ("table", "size=9x6 march=delta bricks=8 lists=tiles"),
        ("table", "steps=12 density-cache=8 skip-empty=0 bricks=8 lists=k:8"),
        ("traced", file.as_str()),
        ("froxel", &format!("froxels=9x7x8 volume-temperature=0 volume-unfit=clamp {file}")),
        ("table", "steps=12 volume-scale=3"),
    ] {
        is_flat::<gas::setup::Setup>(variant, &format!("size=24x16 table=8 frame-step=1 {options}"));
    }
}

#[test]
fn lava_by_other_ways_needs_no_more_memory_from_frame_to_frame() {
    for (variant, options) in [
        ("gpu-driven", "simulation=sph surface=top object=box"),
        ("paper", "simulation=sph color=blackbody border=0 shading=particles geometry-stage=false"),
        ("gpu-driven", "surface-draw=splats shading=heights"),
        ("gpu-driven", "simulation=sph rheology=basalt surface=crossing skin=0.02"),
    ] {
        let scene = "size=32x24 particles=500 density=24x8x8 radius=0.2 splats=30x8";
        is_flat::<lava::setup::Setup>(variant, &format!("{scene} {options}"));
    }
}

#[test]
fn caustics_by_other_ways_needs_no_more_memory_from_frame_to_frame() {
    for (variant, options) in [
        ("culled", "cull=groups floor=true mrt=false intensity=vertex"),
        ("level-map-smart", "smart-placement=kept camera=below"),
        ("level-map", "water-map=volcano water-map-range=0.1 water-map-spacing=0.01"),
        ("hit", "floor=true shadows=true fresnel=true"),
    ] {
        let scene = "mesh=box size=32x24 map-size=32 water-triangles=200 planes=5 levels=8";
        is_flat::<caustics::setup::Setup>(variant, &format!("{scene} {options}"));
    }
}

#[test]
fn burning_by_other_ways_needs_no_more_memory_from_frame_to_frame() {
    for (variant, options) in [
        ("shell", "look=dissertation shading=wire time-division=2 preload=false"),
        ("melting", "evaporation=0.1 shading=normals"),
        ("shell", "smoke-as=volume fire-light=4"),
        ("solid", "collapse=false ground=false material=plain shading=blocks retire-at=0.4"),
        ("low-poly", "lod=1 fire=0 smoke=0 shading=areas"),
    ] {
        is_flat::<burning::setup::Setup>(variant, &format!("{FIRE} mesh=box {options}"));
    }
}

#[test]
fn smart_culling_needs_no_more_memory_from_frame_to_frame() {
    let scene = "mesh=box size=32x24 map-size=32 water-triangles=200 planes=5 levels=8";
    is_flat::<caustics::setup::Setup>("culled", &format!("{scene} smart=true shadows=true fresnel=true coverage=2"));
}

#[test]
fn hidden_surfaces_need_no_more_memory_from_frame_to_frame() {
    let scene = "mesh=teapot size=32x24 map-size=32 water-triangles=200";
    is_flat::<caustics::setup::Setup>("hit", &format!("{scene} layers=3 shadows=true"));
}

#[test]
fn materials_need_no_more_memory_from_frame_to_frame() {
    let folder = program::folder();
    let mesh = program::file(&folder, "pot.obj", burning_materials::pot());
    let materials = program::file(&folder, "pot.toml", "[[material]]\nkind = \"metal\"\nparts = [\"tin\"]\n");
    let files = format!("mesh={} materials={}", mesh.display(), materials.display());
    is_flat::<burning::setup::Setup>("low-poly", &format!("{FIRE} {files}"));
}

#[test]
fn terrain_by_other_ways_needs_no_more_memory_from_frame_to_frame() {
    for (variant, options) in [
        ("gpu-fragment", "base=earth shadows=true drape=slope object=sphere"),
        ("dda-fragment", "base=earth shadows=true drape=slope"),
        ("dda-compute", "shadows=true lod=exact"),
        ("dda-fragment", "start=rays"),
        ("gpu-compute", "base=cylinder:100000 shadows=true drape=contours"),
        ("mesh-lod", "base=earth drape=contours"),
        ("tiled-compute", "base=earth shadows=true interpolation=bicubic"),
        ("mesh", "map=volcano drape=hypsometric shadows=true object=box"),
        ("gpu-fragment", "drape=hypsometric voids=hole lod=exact normals=nodes interpolation=bicubic"),
    ] {
        is_flat::<terrain::setup::Setup>(variant, &format!("size=32x24 resolution=64 {options}"));
    }
}

/// `parameters` make the frames of every variant short.
fn stays_flat<S: Study>(parameters: &str) {
    S::Variant::ALL.iter().for_each(|variant| is_flat::<S>(variant.as_str(), parameters));
}

/// Fails where the frames of a variant leave 1 MB behind.
fn is_flat<S: Study>(variant: &str, parameters: &str) {
    let name = format!("{} {variant} {parameters}", S::PAPER);
    let grown_kb = beside_others(|| growth_kb(&name));
    println!("{name}: {grown_kb} kB in {FRAMES} frames");
    assert!(grown_kb < LIMIT_KB, "{name}: {grown_kb} kB in {FRAMES} frames");
}

/// Output of a process that runs [`frames_of_a_process`].
fn growth_kb(name: &str) -> i64 {
    let test = ["--exact", "gpu::memory::frames_of_a_process", "--nocapture"];
    let mut program = Command::new(env::current_exe().unwrap());
    // What was freed goes back to the system: glibc keeps more of it the more it has seen, in steps of hundreds of kB.
    program.args(test).env("MALLOC_TRIM_THRESHOLD_", "4096");
    let output = program.env(VARIABLE, name).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let said = text.lines().find_map(|line| line.strip_prefix("grown kB: "));
    let failure = || panic!("{name}: {text}{}", String::from_utf8_lossy(&output.stderr));
    said.and_then(|kb| kb.parse().ok()).unwrap_or_else(failure)
}

/// In a process of the tests above: the frames that the environment names. By itself: the measure sees what is kept.
#[test]
fn frames_of_a_process() {
    let Ok(wanted) = env::var(VARIABLE) else {
        let before_kb = resident_kb();
        let kept = std::hint::black_box(vec![1u8; 256 << 20]);
        assert!(resident_kb() - before_kb > 128 << 10, "{} bytes are kept", kept.len());
        return;
    };
    let words: Vec<&str> = wanted.split(' ').collect();
    papers::each(&mut Run { paper: words[0], variant: words[1], parameters: &words[2..] }).unwrap();
}

struct Run<'a> {
    paper: &'a str,
    variant: &'a str,
    parameters: &'a [&'a str],
}

impl Visitor for Run<'_> {
    type Error = Error;

    fn visit<S: Study>(&mut self) -> Result<(), Error> {
        if self.paper == S::PAPER {
            let variant =
                S::Variant::ALL.iter().find(|v| v.as_str() == self.variant).expect("the paper has the variant");
            println!("\ngrown kB: {}", grown_kb::<S>(*variant, self.parameters)?);
        }
        Ok(())
    }
}

/// Resident memory that the frames after the warm-up add to the process, of the main job's set-up.
fn grown_kb<S: Study>(variant: S::Variant, parameters: &[&str]) -> Result<i64, Error> {
    let mut study = S::quick();
    for parameter in parameters {
        let (name, value) = parameter.split_once('=').expect("name=value");
        let declared = S::parameters().into_iter().find(|p| p.name == name).expect("the paper has the parameter");
        declared.set(&mut study, &[OsStr::new(value)]).expect("it is a value of it");
    }
    let given: Given = parameters.iter().filter_map(|p| p.split_once('=')).map(|(name, _)| name.to_owned()).collect();
    study.resolve(&given)?;
    let study = study.alternatives().swap_remove(0);
    let scene = study.load()?;
    // Without the validation layer, which keeps what it has seen.
    let instance = Instance::new(false)?;
    let physical = choose(PhysicalDevice::enumerate(&instance)?, Some(&wanted_device()), S::NEEDS)?;
    let device = Device::open(&instance, physical)?;
    let shaders = ShaderLibrary::new(&device, Compiler::Glslang, None)?;
    let mut paper = study.make(&shaders, "test", &scene, variant)?;
    let mut recorder = Recorder::new(&device)?;
    loop {
        paper.restart()?;
        for number in 0..WARMUP {
            recorder.run(Mode::Plain, |frame| paper.record(frame, number))?;
        }
        if paper.settle(&shaders)? {
            break;
        }
    }
    let before_kb = resident_kb();
    for number in WARMUP..WARMUP + FRAMES {
        recorder.run(Mode::Plain, |frame| paper.record(frame, number))?;
    }
    Ok(resident_kb() - before_kb)
}

/// Resident memory of this process but that of files, whose pages the system drops and reads again as it likes.
fn resident_kb() -> i64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let of = |name: &str| status.lines().find_map(|line| line.strip_prefix(name)).unwrap();
    let kb = |name| of(name).trim().trim_end_matches(" kB").parse::<i64>().unwrap();
    kb("RssAnon:") + kb("RssShmem:")
}

//! Each limit that sizes are compared with, lowered: each paper keeps to it, or refuses by name.

use std::collections::BTreeMap;

use super::masks::ONE_FRAME;
use super::{Layer, PAPERS, Paper};
use crate::cli::program;
use crate::cli::program::Ended;

/// Limits lower than Vulkan lets any device have, or as low as that where the papers meet those, with the initials of the
/// papers whose smallest scenes meet them.
const LIMITS: [(&str, &str); 45] = [
    ("max-image-dimension-2d=16", "lgcbt"),
    ("max-image-dimension-3d=2", "g"),
    ("max-image-array-layers=1", "ct"),
    ("max-framebuffer-size=16", "lgcbt"),
    ("max-viewport-dimensions=8", "lgcbt"),
    ("max-color-attachments=1", "lct"),
    ("max-storage-buffer-range=64", "lgcbt"),
    ("max-uniform-buffer-range=16", "lgcbt"),
    ("max-push-constants-size=4", "lgcbt"),
    ("max-buffer-size=64", "lgcbt"),
    ("max-sampler-allocation-count=0", "lc"),
    ("max-memory-allocation-count=1", "lgcbt"),
    ("max-compute-work-group-count=1", "lgcbt"),
    ("max-compute-work-group-invocations=16", "lgcbt"),
    ("max-compute-work-group-invocations=128", "cb"),
    ("max-compute-work-group-size=4", "lgcbt"),
    ("max-compute-work-group-size=128", "cb"),
    ("max-compute-shared-memory-size=8", "cb"),
    ("max-draw-indexed-index-value=10", ""),
    ("max-point-size=1", "l"),
    ("max-vertex-input-attributes=1", "ct"),
    ("max-vertex-input-binding-stride=8", "lct"),
    ("max-vertex-output-components=3", "lgcbt"),
    ("max-geometry-shader-invocations=0", "lg"),
    ("max-geometry-input-components=3", "l"),
    ("max-geometry-output-components=3", "lg"),
    ("max-geometry-output-vertices=2", "lg"),
    ("max-geometry-total-output-components=8", "lg"),
    ("max-fragment-input-components=3", "lgcbt"),
    ("max-fragment-output-attachments=0", "lgcbt"),
    ("max-fragment-combined-output-resources=0", "lgcbt"),
    ("max-fragment-combined-output-resources=4", "g"),
    ("max-per-stage-resources=1", "lgcbt"),
    ("max-per-stage-descriptor-samplers=0", "lc"),
    ("max-per-stage-descriptor-uniform-buffers=0", "lgcbt"),
    ("max-per-stage-descriptor-storage-buffers=0", "lgcbt"),
    ("max-per-stage-descriptor-storage-buffers=4", "lgcb"),
    ("max-per-stage-descriptor-sampled-images=0", "lgcbt"),
    ("max-per-stage-descriptor-storage-images=0", "lgbt"),
    ("max-descriptor-set-samplers=0", "lc"),
    ("max-descriptor-set-uniform-buffers=0", "lgcbt"),
    ("max-descriptor-set-storage-buffers=0", "lgcbt"),
    ("max-descriptor-set-storage-buffers=12", "gb"),
    ("max-descriptor-set-sampled-images=0", "lgcbt"),
    ("max-descriptor-set-storage-images=0", "lgbt"),
];

/// The other limits as low as Vulkan 1.3 lets a device have them, alignments as large, and descriptors of all stages for three
/// of them. No paper meets them.
const LOWEST: &str = "max-image-dimension-2d=4096,max-image-dimension-3d=256,max-image-array-layers=256,\
                      max-framebuffer-size=4096,max-viewport-dimensions=4096,max-color-attachments=4,\
                      max-storage-buffer-range=134217728,max-uniform-buffer-range=16384,max-push-constants-size=128,\
                      max-buffer-size=1073741824,max-sampler-allocation-count=4000,max-memory-allocation-count=4096,\
                      max-compute-work-group-count=65535,max-compute-shared-memory-size=16384,max-point-size=64,\
                      max-vertex-input-attributes=16,max-vertex-input-bindings=16,max-vertex-input-binding-stride=2048,\
                      max-vertex-input-attribute-offset=2047,max-vertex-output-components=64,\
                      max-geometry-shader-invocations=32,max-geometry-input-components=64,\
                      max-geometry-output-components=64,max-geometry-output-vertices=256,\
                      max-geometry-total-output-components=1024,max-fragment-input-components=64,\
                      max-fragment-output-attachments=4,max-bound-descriptor-sets=4,max-per-stage-resources=128,\
                      max-per-stage-descriptor-samplers=16,max-per-stage-descriptor-uniform-buffers=12,\
                      max-per-stage-descriptor-sampled-images=16,max-per-stage-descriptor-storage-images=4,\
                      max-descriptor-set-samplers=48,max-descriptor-set-uniform-buffers=36,\
                      max-descriptor-set-storage-buffers=24,max-descriptor-set-sampled-images=48,\
                      max-descriptor-set-storage-images=12,\
                      min-uniform-buffer-offset-alignment=256,min-storage-buffer-offset-alignment=256,\
                      buffer-image-granularity=131072,non-coherent-atom-size=256";

/// True of one line on an object, and a figure beyond what the lesser device allows: `limit` is its name and value.
fn names_object_and_figure(line: &str, limit: &str) -> bool {
    let message = line.strip_prefix("error: ").and_then(|line| line.split_once(" is beyond this device's limit of "));
    let Some((wanted, allowed)) = message else { return false };
    let number = |text: Option<&str>| text.and_then(|text| text.parse::<u64>().ok());
    let figures = [wanted.rsplit(' ').next(), allowed.split(';').next(), limit.rsplit('=').next()].map(number);
    let [Some(wanted_value), Some(allowed_value), Some(lowered)] = figures else { return false };
    let has_object = wanted.split_once(": ").is_some_and(|(object, what)| !object.is_empty() && what.contains(' '));
    // Four components make up a location.
    let lowered = if wanted.contains("count of locations that a stage") { lowered / 4 } else { lowered };
    has_object && allowed_value == lowered && wanted_value > lowered && line.lines().count() == 1
}

/// Pictures of every variant, by their names.
type Pictures = BTreeMap<String, Vec<u8>>;

/// A run of every variant on a device of some lowered limits, and its pictures.
fn drawn_within(paper: &Paper, layer: &Layer, limits: &str) -> (Ended, Pictures) {
    let out = program::folder();
    let program = paper.run("bench --variant all --quiet --json --image a.png").args(ONE_FRAME).inside(out.path());
    let ended = layer.before(program, true).env("FUMAROLE_LAYER_LIMITS", limits).run();
    let read = |name: String| (name.clone(), std::fs::read(out.path().join(name)).unwrap());
    (ended, program::entries(out.path()).into_iter().map(read).collect())
}

/// Number of refusals of a paper, and what is wrong. The limits that it meets are lowered one at a time, the others all at once;
/// where it goes on, its pictures are those of the whole device.
fn within_each_limit(paper: &Paper) -> (usize, Vec<String>) {
    let layer = Layer::new();
    let (whole, pictures) = drawn_within(paper, &layer, "");
    whole.succeeded();
    assert!(!pictures.is_empty(), "{} has no pictures", paper.name);
    let meets = |papers: &str| papers.contains(&paper.name[..1]);
    let (met, others): (Vec<_>, Vec<_>) = LIMITS.into_iter().partition(|(_, papers)| meets(papers));
    // Of a limit that is named twice the layer takes the first.
    let others: Vec<&str> = others.into_iter().map(|(limit, _)| limit).chain([LOWEST]).collect();
    let (together, found) = drawn_within(paper, &layer, &others.join(","));
    let (mut refusals, mut wrong) = (0, Vec::new());
    if together.status.code() != Some(0) || found != pictures {
        wrong.push(format!("{} on the least device: {}", paper.name, together.stderr));
    }
    for (limit, _) in met {
        let (ended, found) = drawn_within(paper, &layer, limit);
        let code = ended.status.code();
        refusals += usize::from(code != Some(0));
        // Another device than that of the tests may meet fewer, as one without geometry stages.
        let is_right = match code {
            Some(0) => found == pictures,
            _ => code == Some(2) && names_object_and_figure(&ended.stderr, limit),
        };
        if !is_right {
            wrong.push(format!("{} with {limit}: {code:?}: {}", paper.name, ended.stderr));
        }
    }
    (refusals, wrong)
}

#[test]
fn each_paper_keeps_to_lowered_limits() {
    let each = std::thread::scope(|scope| {
        let papers = PAPERS.each_ref().map(|paper| scope.spawn(move || within_each_limit(paper)));
        papers.map(|paper| paper.join().unwrap())
    });
    let refusals: usize = each.iter().map(|(refusals, _)| refusals).sum();
    let wrong: Vec<&String> = each.iter().flat_map(|(_, wrong)| wrong).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    let met: usize = LIMITS.iter().map(|(_, papers)| papers.len()).sum();
    assert!(refusals > met / 2, "{refusals} refusals of {met}");
}

/// The needs of a run are known before the device is asked for any of them.
#[test]
fn what_no_device_holds_is_refused_before_memory_is_asked_for() {
    let layer = Layer::new();
    for (paper, options, part) in [
        ("lava", "--density 1x67108864x1", "--density"),
        ("gas", "--size 16000x16000", "--size"),
        ("caustics", "--map-size 16384 --planes 256 --variant volumetric", "--map-size"),
        ("burning", "--size 16000x16000", "--size"),
        ("terrain", "--resolution 65536", "--resolution"),
    ] {
        let paper = PAPERS.iter().find(|known| known.name == paper).unwrap();
        // A measurement looks at the device itself first.
        let ended = layer.least(paper.bare("render --quiet --image a.png").args(options)).run();
        let report = layer.report(&ended);
        ended.refused(2, &[part]);
        for call in ["vkAllocateMemory", "vkCreateBuffer", "vkCreateImage", "vkQueueSubmit2"] {
            assert_eq!(report.count(call), 0, "{} {options}: {call}", paper.name);
        }
    }
}

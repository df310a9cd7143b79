//! Devices that lack something or have more, and calls that fail: the programs run with `tests/layer` before the driver.

mod calls;
mod files;
pub mod lent;
mod limits;
mod masks;
mod rounds;

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

pub use self::calls::FAILURES;
use crate::cli::program::{self, Ended, Program, file};
use crate::drivers::layer_manifest;

/// A paper's program and the smallest scene with every pass.
pub struct Paper {
    pub name: &'static str,
    program: fn(&str) -> Program,
    scene: &'static str,
}

pub const PAPERS: [Paper; 5] = [
    Paper {
        name: "lava",
        program: program::lava,
        scene: "--size 32x24 --particles 100 --radius 0.3 --density 8x4x4 --splats 10x5 --splat-radius 0.2",
    },
    Paper { name: "gas", program: program::gas, scene: "--size 24x16 --steps 4 --table 4 --froxels 9x7x8" },
    Paper {
        name: "caustics",
        program: program::caustics,
        scene: "--size 32x24 --map-size 16 --water-triangles 100 --planes 3 --mesh box",
    },
    Paper {
        name: "burning",
        program: program::burning,
        scene: "--size 24x16 --blocks 2x2x2 --fire 20 --smoke 10 --speed 1 --flammability 10 --mesh sphere --triangles 100 \
                --first-frame 30 --levels 1",
    },
    Paper { name: "terrain", program: program::terrain, scene: "--size 32x24 --resolution 9" },
];

impl Paper {
    pub fn run(&self, verb: &str) -> Program {
        self.bare(verb).args(self.scene)
    }

    /// Without the scene.
    fn bare(&self, verb: &str) -> Program {
        (self.program)(verb).on_test_device()
    }
}

/// The limits that refusals are tested by, so that they do not depend on the device at hand: the least that Vulkan 1.3 lets
/// a device have.
const LEAST: &str = "max-image-dimension-2d=4096,max-image-array-layers=256,max-framebuffer-size=4096,\
                     max-storage-buffer-range=134217728,max-buffer-size=1073741824,max-point-size=64";

/// Name of the layer in its manifest.
const LAYER: &str = "VK_LAYER_FUMAROLE_test";
const VALIDATION: &str = "VK_LAYER_KHRONOS_validation";

/// The library of `tests/layer`, which `cargo test` builds beside the programs.
///
/// # Panics
/// It is not built.
fn library() -> PathBuf {
    let programs = Path::new(env!("CARGO_BIN_EXE_fumarole")).parent().unwrap();
    let library = programs.join("examples/libtest_layer.so");
    assert!(library.exists(), "{} is missing: cargo build --release --locked --example test_layer", library.display());
    library
}

/// The layer's manifest, with more said of it.
fn manifest(more: serde_json::Value) -> String {
    let mut layer = serde_json::json!({
        "name": LAYER,
        "type": "GLOBAL",
        "library_path": library(),
        "api_version": "1.3.0",
        "implementation_version": "1",
        "description": "Failing calls and lesser devices for the tests of fumarole",
    });
    let more = more.as_object().cloned().unwrap_or_default();
    layer.as_object_mut().unwrap().extend(more);
    serde_json::json!({ "file_format_version": "1.2.0", "layer": layer }).to_string()
}

/// A folder with the layer's manifest, and its report; another with that of the Khronos layer. The loader (1.3.239) takes
/// layers in the order in which it finds their manifests, whatever the order of their names: the folder that is searched
/// first holds the layer that is next to the program.
pub struct Layer {
    folder: TempDir,
    validation: TempDir,
}

impl Layer {
    pub fn new() -> Self {
        let folder = program::folder();
        file(&folder, "test_layer.json", manifest(serde_json::json!({})));
        let validation = program::folder();
        layer_manifest(&validation, Path::new("libVkLayer_khronos_validation.so"));
        Layer { folder, validation }
    }

    fn report_path(&self) -> PathBuf {
        self.folder.path().join("report")
    }

    /// Variables of a program with the layer next to the driver, `validated` with the Khronos layer above it.
    pub fn environment(&self, validated: bool) -> Vec<(&'static str, OsString)> {
        // Mesa's implicit layer makes calls of its own, whose failures it hides from the program.
        let mut set = vec![("FUMAROLE_LAYER_REPORT", self.report_path().into()), ("NODEVICE_SELECT", "1".into())];
        if validated {
            let folders = std::env::join_paths([self.validation.path(), self.folder.path()]).unwrap();
            set.extend([("VK_LAYER_PATH", folders), ("VK_INSTANCE_LAYERS", format!("{VALIDATION}:{LAYER}").into())]);
        } else {
            set.extend([("VK_ADD_LAYER_PATH", self.folder.path().into()), ("VK_INSTANCE_LAYERS", LAYER.into())]);
        }
        set
    }

    /// Runs with the layer next to the program, among those that the loader takes unasked: their extensions of the instance
    /// are the only ones of layers that it lists.
    pub fn with_extensions(&self, program: Program, extensions: &[&str]) -> Program {
        let of = |name: &&str| serde_json::json!({ "name": name, "spec_version": "1" });
        let more = serde_json::json!({
            "disable_environment": { "FUMAROLE_LAYER_IS_OFF": "1" },
            "instance_extensions": extensions.iter().map(of).collect::<Vec<_>>(),
        });
        let folder = self.folder.path().join("vulkan/implicit_layer.d");
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("test_layer.json"), manifest(more)).unwrap();
        let program = program.env("XDG_DATA_HOME", self.folder.path()).env("NODEVICE_SELECT", "1");
        program.env("FUMAROLE_LAYER_REPORT", self.report_path())
    }

    /// Runs with the layer next to the driver, `validated` with the Khronos layer above it.
    pub fn before(&self, program: Program, validated: bool) -> Program {
        let program =
            self.environment(validated).into_iter().fold(program, |program, (name, value)| program.env(name, value));
        if validated { program.args("--validate") } else { program }
    }

    /// Runs with the layer next to the program, and the Khronos layer of a library below it.
    pub fn above(&self, library: &Path, program: Program) -> Program {
        layer_manifest(&self.validation, library);
        let folders = std::env::join_paths([self.folder.path(), self.validation.path()]).unwrap();
        let program = program.args("--validate").env("VK_LAYER_PATH", folders).env("NODEVICE_SELECT", "1");
        program.env("VK_INSTANCE_LAYERS", format!("{LAYER}:{VALIDATION}"))
    }

    /// Submissions that were counted in a program that has ended.
    ///
    /// # Panics
    /// When it ended without ending its instance.
    pub fn submissions(&self) -> usize {
        let text = fs::read_to_string(self.report_path()).unwrap();
        text.lines().find_map(|line| line.strip_prefix("call vkQueueSubmit2 ")?.parse().ok()).unwrap()
    }

    /// Runs on a device with the least limits, whatever the one of the tests has.
    pub fn least(&self, program: Program) -> Program {
        self.before(program, false).env("FUMAROLE_LAYER_LIMITS", LEAST)
    }

    /// Number of each call, the name of the one that failed, and what was alive at the end.
    ///
    /// # Panics
    /// When the program ended without ending its instance.
    pub fn report(&self, ended: &Ended) -> Report {
        let path = self.report_path();
        let text = fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("no report: {error}: {}: {}", ended.status, ended.stderr));
        fs::remove_file(path).unwrap();
        Report::of(&text)
    }
}

pub struct Report {
    /// Calls that return a result by their names, and how often each was made.
    pub calls: Vec<(String, usize)>,
    pub failed: Option<String>,
    /// Kinds and numbers of objects.
    pub alive: Vec<String>,
    /// A call that a played extension forbids.
    pub misuses: Vec<String>,
    /// Frames whose end was told by `VK_EXT_frame_boundary`.
    pub frames: u64,
    /// Labels round commands, in the order of their first use.
    pub labels: Vec<String>,
    /// Names of pipelines.
    pub pipelines: Vec<String>,
}

impl Report {
    /// The report as the layer wrote it.
    fn of(text: &str) -> Self {
        let field = |name: &str| text.lines().find_map(|line| line.strip_prefix(name)).map(str::to_owned);
        let fields = |name: &str| -> Vec<String> {
            text.lines().filter_map(|line| line.strip_prefix(name)).map(str::to_owned).collect()
        };
        let calls = fields("call ").into_iter().map(|line| {
            let (name, count) = line.split_once(' ').unwrap();
            (name.to_owned(), count.parse().unwrap())
        });
        Report {
            calls: calls.collect(),
            failed: field("failed "),
            alive: fields("alive "),
            misuses: fields("misuse "),
            frames: field("frames ").unwrap().parse().unwrap(),
            labels: fields("label "),
            pipelines: fields("pipeline "),
        }
    }

    /// Number of times that a call was made.
    pub fn count(&self, name: &str) -> usize {
        self.calls.iter().find(|(called, _)| called == name).map_or(0, |(_, count)| *count)
    }
}

//! The programs on a second driver, SwiftShader, and under a current Khronos layer. Both come with Debian's
//! chromium-common and with other systems' Chromium: `./setup.sh --tests` installs them. They have no manifests of use to
//! others, so that these tests write their own.
//!
//! Messages known to be false: of Debian's layer, 1.3.239, one of a device without `maintenance4`, see `faults::masks`; of
//! Chromium 156's, which is 1.4.364, those of its heuristic, which compares what shaders write by whole bindings
//! (github.com/KhronosGroup/Vulkan-ValidationLayers/issues/11715).

mod layer;
mod options;
mod sample;
mod swiftshader;

use std::env;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::cli::program::{self, Program, file};

/// Folders in which the systems' Chromium lies: Debian and Arch, Fedora, openSUSE.
const FOLDERS: [&str; 3] = ["/usr/lib/chromium", "/usr/lib64/chromium-browser", "/usr/lib64/chromium"];
/// Another folder with both libraries.
const FOLDER_VARIABLE: &str = "FUMAROLE_TEST_LIBRARIES";

/// A paper as these tests run it: its program, and a scene small enough for a slow driver, in which a different pixel at an
/// edge weighs little.
struct Paper {
    program: fn(&str) -> Program,
    /// Value of `--variant`.
    variants: &'static str,
    scene: &'static str,
    /// False where calls of one pass write disjoint parts of a buffer: the layer's heuristic knows whole bindings only.
    compares_shader_accesses: bool,
}

const LAVA: Paper = Paper {
    program: program::lava,
    variants: "all",
    scene: "--size 160x120 --particles 1000 --radius 0.3 --density 24x12x12 --splats 80x20 --splat-radius 0.2",
    compares_shader_accesses: true,
};
const GAS: Paper = Paper {
    program: program::gas,
    variants: "all",
    scene: "--size 90x62 --steps 8 --table 8",
    compares_shader_accesses: false,
};
const CAUSTICS: Paper = Paper {
    program: program::caustics,
    variants: "all",
    scene: "--size 160x120 --map-size 64 --water-triangles 500 --planes 5",
    compares_shader_accesses: true,
};
/// Planes that the device places.
const CAUSTICS_SMART: Paper =
    Paper { variants: "culled", scene: "--size 160x120 --map-size 64 --water-triangles 500 --smart", ..CAUSTICS };
const BURNING: Paper = Paper {
    program: program::burning,
    variants: "all",
    scene: "--size 160x120 --blocks 3x3x3 --fire 60 --smoke 30 --speed 1 --flammability 10 --mesh sphere --triangles 120 \
            --first-frame 30",
    compares_shader_accesses: true,
};
const TERRAIN: Paper =
    Paper { program: program::terrain, variants: "all", scene: "--size 160x120", compares_shader_accesses: true };

/// The papers with scenes of a moment.
const TINY: [(&str, Paper); 5] = [
    (
        "lava",
        Paper {
            scene: "--size 32x24 --particles 100 --radius 0.3 --density 8x4x4 --splats 10x5 --splat-radius 0.2",
            ..LAVA
        },
    ),
    ("gas", Paper { scene: "--size 24x16 --table 4 --steps 4 --froxels 9x7x8", ..GAS }),
    (
        "caustics",
        Paper {
            scene: "--size 32x24 --map-size 16 --water-triangles 100 --planes 3 --levels 8 --mesh box",
            ..CAUSTICS
        },
    ),
    (
        "burning",
        Paper {
            scene: "--size 24x16 --blocks 2x2x2 --fire 20 --smoke 10 --speed 1 --flammability 10 --first-frame 30 --levels 1 \
                    --mesh sphere --triangles 100",
            ..BURNING
        },
    ),
    ("terrain", Paper { scene: "--size 32x24 --resolution 9", ..TERRAIN }),
];

impl Paper {
    fn run(&self, verb: &str) -> Program {
        (self.program)(verb).args(self.scene)
    }

    /// Runs under the current layer; accesses of shaders to buffers are compared too, which it does not do by itself.
    fn under_current_layer(&self, program: Program, folder: &TempDir) -> Program {
        layer_manifest(folder, &library("libVkLayer_khronos_validation.so"));
        let program = program.args("--validate").env("VK_LAYER_PATH", folder.path());
        let heuristic = self.compares_shader_accesses.to_string();
        program.env("VK_SYNCVAL_SHADER_ACCESSES_HEURISTIC", heuristic)
    }

    /// Names of the paper's variants.
    fn variants(&self) -> Vec<String> {
        let listed =
            self.run("passes --json").args("--variant").arg(self.variants).on_test_device().run().succeeded().json();
        let variants = listed.as_array().unwrap().iter();
        variants.map(|variant| variant["variant"].as_str().unwrap().to_owned()).collect()
    }
}

/// # Panics
/// The library is not installed: a test never passes for want of it.
pub fn library(name: &str) -> PathBuf {
    let folders = env::var(FOLDER_VARIABLE).into_iter().chain(FOLDERS.map(str::to_owned));
    let mut paths = folders.map(|folder| Path::new(&folder).join(name));
    let found = paths.find(|path| path.exists());
    found.unwrap_or_else(|| {
        panic!("{name} is missing: run ./setup.sh --tests, or name its folder with {FOLDER_VARIABLE}")
    })
}

/// A manifest of SwiftShader, for `VK_DRIVER_FILES`.
pub fn driver_manifest(folder: &TempDir) -> PathBuf {
    let library = library("libvk_swiftshader.so");
    let icd = serde_json::json!({ "library_path": library, "api_version": "1.3.0" });
    let manifest = serde_json::json!({ "file_format_version": "1.0.0", "ICD": icd });
    file(folder, "swiftshader.json", manifest.to_string())
}

/// Writes a manifest of the layer in `library` into a folder for `VK_LAYER_PATH`.
pub fn layer_manifest(folder: &TempDir, library: &Path) {
    let extension = |name: &str, version: &str| serde_json::json!({ "name": name, "spec_version": version });
    let layer = serde_json::json!({
        "name": "VK_LAYER_KHRONOS_validation",
        "type": "GLOBAL",
        "library_path": library,
        "api_version": "1.4.0",
        "implementation_version": "1",
        "description": "Khronos validation layer",
        "instance_extensions": [
            extension("VK_EXT_debug_report", "9"),
            extension("VK_EXT_debug_utils", "2"),
            extension("VK_EXT_validation_features", "6"),
        ],
    });
    let manifest = serde_json::json!({ "file_format_version": "1.2.0", "layer": layer });
    file(folder, "VkLayer_khronos_validation.json", manifest.to_string());
}

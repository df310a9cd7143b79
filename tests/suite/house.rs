//! Rules of the house that no compiler holds: files of at most 500 lines, doc comments that name what they document and leave
//! no field out, arrows between modules, passes in files of their names, loops that pages bound, a test for each misuse of the
//! Vulkan layer, calls that can be made to fail, and no test's files in the repository.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cli::program::fumarole;

/// All that lies in the repository's root, but for hidden files and what is built or measured there.
const ROOT: [&str; 19] = [
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "assets",
    "benches",
    "build.rs",
    "dist",
    "docs",
    "fuzz",
    "rustfmt.toml",
    "schema",
    "setup.sh",
    "shaders",
    "src",
    "tests",
];

/// Options of each paper, in whose frames every pass of it occurs.
const FRAMES: [(&str, &str); 16] = [
    ("lava", "--size 64x48 --particles 400 --radius 0.3 --density 16x8x8 --splats 40x10 --variant all --object teapot"),
    (
        "lava",
        "--size 64x48 --particles 400 --radius 0.3 --density 16x8x8 --simulation sph --rheology basalt --object box \
         --variant gpu-driven",
    ),
    (
        "lava",
        "--size 64x48 --particles 400 --radius 0.3 --density 16x8x8 --splats 40x10 --splat-shading deferred --culling facing",
    ),
    ("gas", "--size 45x31 --steps 8 --table 8 --variant all"),
    ("gas", "--size 45x31 --steps 8 --table 8 --lists tiles --density-cache 8 --skip-empty 0"),
    ("caustics", "--size 96x64 --map-size 64 --water-triangles 500 --planes 5 --variant all"),
    (
        "caustics",
        "--size 96x64 --map-size 64 --water-triangles 500 --no-mrt --coverage 2 --shadows --variant level-map",
    ),
    ("caustics", "--size 96x64 --map-size 64 --water-triangles 500 --smart --variant culled"),
    ("caustics", "--size 96x64 --map-size 64 --water-triangles 500 --layers 2 --variant hit"),
    ("burning", "--size 48x32 --blocks 3x3x3 --mesh sphere --triangles 300 --levels 1 --variant all"),
    (
        "burning",
        "--size 48x32 --blocks 3x3x3 --mesh sphere --triangles 300 --levels 1 --no-preload --smoke-as volume --variant shell",
    ),
    ("burning", "--size 48x32 --blocks 3x3x3 --mesh sphere --triangles 300 --levels 1 --variant melting"),
    ("burning", "--size 48x32 --blocks 3x3x3 --mesh sphere --triangles 300 --levels 1 --shading wire --variant shell"),
    ("terrain", "--size 48x32 --resolution 64 --variant all"),
    ("terrain", "--size 48x32 --resolution 64 --shadows --object teapot --variant gpu-compute,cpu"),
    ("terrain", "--size 48x32 --resolution 64 --shadows --variant mesh"),
];

/// Every source file below a folder of the repository.
fn sources(folder: &str) -> Vec<PathBuf> {
    let mut open = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                found.push(path);
            }
        }
    }
    assert!(found.len() > 3, "{folder}");
    found
}

#[test]
fn nothing_strange_lies_in_the_root() {
    let names = fs::read_dir(env!("CARGO_MANIFEST_DIR")).unwrap().map(|entry| entry.unwrap().file_name());
    let names = names.map(|name| name.into_string().unwrap());
    let mut found: Vec<String> =
        names.filter(|name| !name.starts_with('.') && name != "target" && name != "fumarole-out").collect();
    found.sort();
    assert_eq!(found, ROOT, "left: what a test or a program has written, or ROOT lacks it");
}

/// The fuzz program has a lock file of its own, which nothing else builds with.
#[test]
fn the_fuzz_programs_lock_file_has_what_the_program_depends_on() {
    let read = |name: &str| fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap();
    let (manifest, lock) = (read("Cargo.toml"), read("fuzz/Cargo.lock"));
    let start = lock.find("name = \"fumarole\"").unwrap();
    let locked = &lock[start..start + lock[start..].find(']').unwrap()];
    let dependencies = manifest.lines().skip_while(|line| *line != "[dependencies]").skip(1);
    let names: Vec<&str> = dependencies
        .take_while(|line| !line.starts_with('['))
        .filter(|line| !line.contains("optional = true"))
        .filter_map(|line| Some(line.split_once(" = ")?.0))
        .collect();
    assert!(names.len() > 30, "{names:?}");
    // With a version where there are several.
    let is_locked = |name: &&&str| [' ', '"'].iter().any(|end| locked.contains(&format!("\"{name}{end}")));
    let missing: Vec<_> = names.iter().filter(|name| !is_locked(name)).collect();
    assert!(missing.is_empty(), "in fuzz, `cargo metadata` writes them into the lock file: {missing:?}");
}

#[test]
fn no_file_has_more_than_500_lines() {
    let mut long = Vec::new();
    for path in ["src", "tests", "benches"].into_iter().flat_map(sources) {
        let lines = fs::read_to_string(&path).unwrap().lines().count();
        if lines > 500 {
            long.push(format!("{}: {lines} lines", path.display()));
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
}

#[test]
fn doc_comments_name_what_they_document() {
    let mut questions = Vec::new();
    for path in ["src", "tests", "benches"].into_iter().flat_map(sources) {
        for (number, line) in (1..).zip(fs::read_to_string(&path).unwrap().lines()) {
            let line = line.trim_start();
            let Some(text) = line.strip_prefix("/// ").or_else(|| line.strip_prefix("//! ")) else { continue };
            let first: String = text.chars().take_while(|c| c.is_alphabetic()).collect();
            if ["What", "Whether", "Where", "How", "Which"].contains(&first.as_str()) {
                questions.push(format!("{}:{number}: {line}", path.display()));
            }
        }
    }
    assert!(questions.is_empty(), "{}", questions.join("\n"));
}

#[test]
fn fields_that_others_see_are_documented() {
    let mut bare = Vec::new();
    for path in sources("src") {
        let text = fs::read_to_string(&path).unwrap();
        let (mut in_struct, mut is_documented) = (false, false);
        for (number, line) in (1..).zip(text.lines().map(str::trim)) {
            let is_seen = line.starts_with("pub ") || line.starts_with("pub(");
            let opens = line.split_whitespace().any(|word| word == "struct") && line.ends_with('{');
            if !line.starts_with("//") && opens {
                in_struct = true;
            } else if line == "}" {
                in_struct = false;
            } else if in_struct && is_seen && !is_documented {
                bare.push(format!("{}:{number}: {line}", path.display()));
            }
            is_documented = line.starts_with("///") || (line.starts_with("#[") && is_documented);
        }
    }
    assert!(bare.is_empty(), "{}", bare.join("\n"));
}

/// A module, and those that it knows nothing of.
const ARROWS: [(&str, &[&str]); 8] = [
    ("src/shader_build", &["cli", "window", "papers", "measure", "report", "gpu", "scene", "image"]),
    ("src/gpu", &["cli", "window", "papers", "measure", "report", "scene", "image"]),
    ("src/scene", &["cli", "window", "papers", "measure", "report", "gpu", "image"]),
    ("src/image", &["cli", "window", "papers", "measure", "report", "gpu", "scene"]),
    ("src/report", &["cli", "window", "papers", "measure", "gpu", "scene"]),
    ("src/measure", &["cli", "window", "papers"]),
    ("src/papers", &["cli", "window"]),
    ("src/window", &["cli", "papers"]),
];

/// Of papers the command line knows the list alone, and papers know no option's spelling.
#[test]
fn arrows_point_one_way() {
    let is_no_name = |c: char| !c.is_ascii_alphanumeric() && c != '_';
    let mut wrong = Vec::new();
    let mut look = |folder: &str, is_wrong: &dyn Fn(&str) -> bool| {
        for path in sources(folder) {
            // Tests, and what is made for them, may ask what they like.
            if ["tests.rs", "example.rs"].iter().any(|name| path.ends_with(name)) {
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            let (mut is_of_tests, mut begins) = (false, false);
            for (number, line) in (1..).zip(text.lines()) {
                begins = begins || line == "#[cfg(test)]";
                if begins && !line.starts_with('#') {
                    (begins, is_of_tests) = (false, line.ends_with('{'));
                } else if !begins && !is_of_tests && is_wrong(line) {
                    wrong.push(format!("{}:{number}: {line}", path.display()));
                }
                is_of_tests = is_of_tests && line != "}";
            }
        }
    };
    for (folder, unknown) in ARROWS {
        let names = |line: &str, module: &&str| {
            let listed = line
                .strip_prefix("use crate::{")
                .is_some_and(|list| list.split(is_no_name).any(|name| name == *module));
            listed || line.contains(&format!("crate::{module}::")) || line.contains(&format!("crate::{module};"))
        };
        look(folder, &|line| unknown.iter().any(|module| names(line, module)));
    }
    let names = ["lava", "gas", "caustics", "burning", "terrain"];
    look("src/cli", &|line| names.iter().any(|paper| line.contains(&format!("papers::{paper}"))));
    look("src/papers", &|line| line.split("--").skip(1).any(|after| after.starts_with(|c: char| c.is_alphabetic())));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Input may lengthen a loop whose end is no number, and drivers end loops: the paper's page says what bounds it.
#[test]
fn loops_that_may_be_long_stand_on_their_pages() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut missing, mut sections) = (Vec::new(), String::new());
    for paper in ["lava", "gas", "caustics", "burning", "terrain"] {
        let page = fs::read_to_string(root.join(format!("docs/{paper}.md"))).unwrap();
        let (_, section) = page.split_once("\n## Loops\n").unwrap_or_else(|| panic!("{paper}: no loops"));
        let section = section.split("\n## ").next().unwrap();
        let files = fs::read_dir(root.join("shaders").join(paper)).unwrap();
        let files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
        assert!(files.len() > 20, "{paper}");
        for path in files {
            let text = fs::read_to_string(&path).unwrap();
            let name = path.file_name().unwrap().to_str().unwrap();
            let is_long = text.lines().any(may_be_long);
            if is_long && !section.contains(&format!("`{name}`")) {
                missing.push(format!("docs/{paper}.md: {name}"));
            }
        }
        sections.push_str(section);
    }
    for path in fs::read_dir(root.join("shaders/common")).unwrap().map(|file| file.unwrap().path()) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let is_long = fs::read_to_string(&path).unwrap().lines().any(may_be_long);
        if is_long && !sections.contains(&format!("`{name}`")) {
            missing.push(name.to_owned());
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// True for a line of a shader with a loop of which no end is made of numbers and of constants' names, in capitals.
fn may_be_long(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    if code.contains("while (") {
        return true;
    }
    let Some((_, head)) = code.split_once("for (") else { return false };
    let is_constant = |end: &str| {
        let end = end.replace("uint(", "").replace("int(", "");
        end.contains(char::is_alphanumeric) && !end.trim().trim_end_matches('u').contains(char::is_lowercase)
    };
    let ends = head.split(';').nth(1).unwrap_or_default().split("&&");
    !ends.filter_map(|condition| condition.split_once('<')).any(|(_, end)| is_constant(end))
}

#[test]
fn passes_stand_in_files_of_their_names() {
    for paper in ["lava", "gas", "caustics", "burning", "terrain"] {
        let files = sources(&format!("src/papers/{paper}"));
        let stems: BTreeSet<&str> = files.iter().filter_map(|path| path.file_stem()?.to_str()).collect();
        let mut passes = BTreeSet::new();
        for (_, options) in FRAMES.iter().filter(|(of, _)| *of == paper) {
            let listed =
                fumarole(&format!("{paper} passes --json {options}")).on_test_device().run().succeeded().json();
            let variants = listed.as_array().unwrap().iter();
            let of_variants = variants.flat_map(|variant| variant["passes"].as_array().unwrap());
            passes.extend(of_variants.map(|pass| pass["name"].as_str().unwrap().to_owned()));
        }
        assert!(passes.len() > 10, "{paper}: {passes:?}");
        for pass in &passes {
            assert!(stems.contains(pass.replace('-', "_").as_str()), "{paper}: no file of the pass {pass}");
        }
    }
}

/// Commands that return a result, by the bindings' declarations, each under the name of its method.
fn fallible_commands() -> BTreeMap<String, String> {
    // What other systems alone build with need not be there.
    let rustc = Command::new("rustc").arg("-vV").output().unwrap();
    let rustc = String::from_utf8(rustc.stdout).unwrap();
    let host = rustc.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let metadata = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--format-version",
            "1",
            "--offline",
            "--locked",
            "--filter-platform",
            host,
            "--manifest-path",
        ])
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"))
        .output()
        .unwrap();
    assert!(metadata.status.success(), "{}", String::from_utf8_lossy(&metadata.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&metadata.stdout).unwrap();
    let ash = metadata["packages"].as_array().unwrap().iter().find(|package| package["name"] == "ash").unwrap();
    let folder = Path::new(ash["manifest_path"].as_str().unwrap()).parent().unwrap().join("src/vk");
    let mut commands = BTreeMap::new();
    for file in ["features.rs", "extensions.rs"] {
        let text = fs::read_to_string(folder.join(file)).unwrap();
        for declaration in text.split("pub type PFN_vk").skip(1) {
            let (declaration, _) = declaration.split_once(';').unwrap();
            let (name, _) = declaration.split_once([' ', '=']).unwrap();
            if declaration.trim_end().ends_with("-> Result") {
                // `CreateSwapchainKHR` is `create_swapchain`.
                let stem = name.trim_end_matches(|c: char| c.is_ascii_uppercase());
                let small = |c: char| if c.is_uppercase() { format!("_{}", c.to_lowercase()) } else { c.to_string() };
                let method: String = stem.chars().map(small).collect();
                commands.insert(method.trim_start_matches('_').to_owned(), format!("vk{name}"));
            }
        }
    }
    commands
}

/// The tests' layer makes calls fail by their names: one that it does not know would never.
#[test]
fn each_call_that_returns_a_result_can_be_made_to_fail() {
    /// Calls that fail by other ways: the loader's answers before there is a layer, the two whose failures the layer makes where it
    /// joins the chain, and those of extensions that it plays itself.
    const OTHERWISE: [&str; 9] = [
        "enumerate_instance_extension_properties",
        "enumerate_instance_layer_properties",
        "create_instance",
        "create_device",
        "acquire_profiling_lock",
        "enumerate_physical_device_queue_family_performance_query_counters",
        "get_pipeline_executable_internal_representations",
        "get_pipeline_executable_properties",
        "get_pipeline_executable_statistics",
    ];
    let read = |folder| sources(folder).iter().map(|path| fs::read_to_string(path).unwrap()).collect::<String>();
    let code = read("src/gpu") + &read("src/window");
    let calls = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/layer/calls.rs")).unwrap();
    let (_, list) = calls.split_once("const RESULTS").unwrap();
    let stem = |name: &str| name.trim_end_matches(|c: char| c.is_ascii_uppercase()).to_owned();
    let known: BTreeSet<String> = list.split(';').nth(1).unwrap().split('"').skip(1).step_by(2).map(stem).collect();
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    // A method, or a pointer in brackets.
    let name = |at: usize| code[..at].trim_end_matches(')').rsplit(|c| !is_part(c)).next();
    let called: BTreeSet<&str> = code.match_indices('(').filter_map(|(at, _)| name(at)).collect();
    let commands = fallible_commands();
    assert!(commands.len() > 200, "{}", commands.len());
    let of_ours = commands.iter().filter(|(method, _)| called.contains(&***method));
    let (listed, others): (Vec<_>, Vec<_>) = of_ours.partition(|(_, command)| known.contains(&stem(command)));
    let others: BTreeSet<&str> = others.into_iter().map(|(method, _)| method.as_str()).collect();
    assert!(listed.len() > 35, "{listed:?}");
    assert_eq!(others, BTreeSet::from(OTHERWISE), "RESULTS of tests/layer/calls.rs lacks what is on the left alone");
}

#[test]
fn each_misuse_of_the_layer_names_the_tests_that_try_it() {
    let files: Vec<PathBuf> = ["src/gpu", "tests/suite"].into_iter().flat_map(sources).collect();
    let has_test = |path: &PathBuf, test: &str| {
        let text = fs::read_to_string(path).unwrap();
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        lines.windows(2).any(|pair| pair[0] == "#[test]" && pair[1].starts_with(&format!("fn {test}(")))
    };
    let is_test = |name: &str| {
        name.split_once("::").is_some_and(|(file, test)| {
            let mut named = files.iter().filter(|path| path.file_stem().is_some_and(|stem| stem == file));
            named.any(|path| has_test(path, test))
        })
    };
    let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/src/gpu/mod.rs")).unwrap();
    let (_, table) = page.split_once("//! | --- | --- | --- | --- |\n").unwrap();
    let mut lines = 0;
    for line in table.lines().map_while(|line| line.strip_prefix("//! | ")) {
        let cells: Vec<&str> = line.split(" | ").collect();
        assert_eq!(cells.len(), 4, "{line}");
        let tests: Vec<&str> = cells[3].split('`').skip(1).step_by(2).collect();
        assert!(!tests.is_empty(), "tried by no test: {line}");
        let missing: Vec<&&str> = tests.iter().filter(|name| !is_test(name)).collect();
        assert!(missing.is_empty(), "no such tests: {missing:?}");
        lines += 1;
    }
    assert!(lines >= 35, "{lines} lines");
}

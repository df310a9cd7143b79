//! `fumarole devices`, and `--device`.

use std::fs;
use std::path::PathBuf;

use super::program::{ONCE, SCENE, caustics, device, file, folder, fumarole};

#[test]
fn devices_are_listed_with_what_the_papers_find() {
    let listed = fumarole("devices --json").run().succeeded().json();
    let text = fumarole("devices").run().succeeded();
    assert_eq!(text.stderr, "");
    assert!(!listed.as_array().unwrap().is_empty());
    for found in listed.as_array().unwrap() {
        let name = found["name"].as_str().unwrap();
        let heading = format!("{}: {name}", found["index"]);
        for part in [heading.as_str(), found["uuid"].as_str().unwrap(), found["api_version"].as_str().unwrap()] {
            assert!(text.stdout.contains(part), "{part}\n{}", text.stdout);
        }
        let paper = &found["papers"]["caustics"];
        assert_eq!(paper["capable"], paper["lacks"].as_array().unwrap().is_empty(), "{name}");
        assert!(paper["needs"].as_array().unwrap().contains(&"blend-r32f".into()), "{name}");
        assert!(found["features"]["synchronization2"].is_boolean(), "{name}");
    }
}

#[test]
fn a_device_is_chosen_by_index_uuid_or_part_of_its_name() {
    let listed = fumarole("devices --json").run().succeeded().json();
    let of_tests = listed.as_array().unwrap().iter().find(|found| {
        let is = |field: &str, text: &str| found[field].as_str().unwrap().to_lowercase().contains(text);
        let wanted = device().to_lowercase();
        found["index"].as_u64() == wanted.parse().ok() || is("name", &wanted) || is("uuid", &wanted)
    });
    let of_tests = of_tests.expect("the device of the tests is there");
    let uuid = of_tests["uuid"].as_str().unwrap();
    for wanted in [of_tests["index"].to_string(), uuid.to_owned(), uuid.replace('-', "").to_uppercase()] {
        let program = caustics("bench --json --quiet --variant level-map").args(SCENE).args(ONCE);
        let ended = program.arg("--device").arg(&wanted).run().succeeded();
        assert_eq!(ended.json()["environment"]["device"]["uuid"], uuid, "{wanted}");
        assert_eq!(ended.stderr, "");
    }
}

#[test]
fn an_unknown_device_is_refused_with_those_that_are_there() {
    for wanted in ["no-such-device", "99", ""] {
        let program = caustics("bench").args(SCENE).args(ONCE).arg("--device").arg(wanted);
        program.run().refused(2, &[&format!("{wanted:?}"), "0: "]);
    }
}

/// Two manifests of lavapipe's driver are two devices to the loader, alike in all but their index.
#[test]
fn an_ambiguous_device_is_refused_with_those_that_it_names() {
    let folders = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"].map(PathBuf::from);
    let mut manifests = folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
    let lavapipe = manifests.find(|entry| entry.file_name().to_string_lossy().contains("lvp"));
    let manifest = fs::read(lavapipe.expect("lavapipe's manifest is installed").path()).unwrap();
    let out = folder();
    let two = [file(&out, "one.json", &manifest), file(&out, "two.json", &manifest)];
    let two = two.map(|path| path.to_str().unwrap().to_owned()).join(":");
    let program =
        || caustics("bench").args(SCENE).args(ONCE).env("VK_ICD_FILENAMES", &two).env("VK_DRIVER_FILES", &two);
    program().args("--device llvmpipe").run().refused(2, &["\"llvmpipe\"", "0: ", "1: ", "index"]);
    program().args("--device 1").run().succeeded();
}

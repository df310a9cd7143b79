//! Costs of a refusal by the readers of materials, bodies, parts of films and records, of much in few bytes.

use super::hostile_cost::{black_png, refused, refused_of};
use super::hostile_readers::{PART, STRESS, STRESS_READERS, TABLES, VERDICTS, with, with_items};
use super::program::{burning, fumarole, terrain};

const WOOD: &str = "[[material]]\nkind = \"wood\"\n";

#[test]
fn materials_of_many_tables() {
    let materials = || burning("render --mesh box --materials");
    let toml = |text: &str, parts: &[&str]| refused(materials, "a.toml", text.as_bytes(), parts);
    const MOST: usize = 96 << 10;
    toml(&"x".repeat(MOST + 1), &["98305 bytes", "limit of 98304"]);
    let deep = format!("{{{}a=0}},", "a.".repeat(70));
    for item in [&deep[..], "{a=0},", "{a.b=0},", "{a={}},", "[0],", "[[]],", "[\"\"],", "0,"] {
        let most = MOST / item.len() - 4;
        toml(&format!("x = [{}]", item.repeat(most)), &["line 1", "unknown field \"x\""]);
    }
    let tables: String = (0..600).map(|i| format!("a{i:x}{}=0\n", ".a".repeat(70))).collect();
    toml(&tables, &["line 1", "unknown field \"a0\""]);
}

/// Names times parts of a mesh are no work.
#[test]
fn materials_of_many_parts() {
    let object = || burning("render --mesh a.obj --materials");
    let parts = |names: &str| {
        let mut mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
        mesh.extend((0..60_000).map(|i| format!("g {i:x}{names}\nf 1 2 3\n")));
        mesh.into_bytes()
    };
    let asked = |name: &str| {
        format!("{WOOD}parts = [{}\"no\"]", format!("\"{name}\",").repeat(if name == "all" { 16_000 } else { 13_000 }))
            .into_bytes()
    };
    for (names, name) in [("", "e000"), (" all", "all")] {
        refused_of(object, &[("a.toml", &asked(name)), ("a.obj", &parts(names))], &["line 3", "no part \"no\""]);
    }
}

/// The picture is looked at when all else is right.
#[test]
fn materials_of_a_large_texture() {
    let text = format!("texture = \"a.png\"\n{WOOD}rho = 2");
    let files = [("a.toml", text.as_bytes()), ("a.png", &black_png(8_192))];
    refused_of(|| burning("render --mesh sphere --materials"), &files, &["line 4", "rho 2"]);
}

#[test]
fn bodies_of_short_lines() {
    let csv = |text: &[u8], part: &str| refused(|| terrain("collide --bodies"), "a.csv", text, &[part]);
    for count in [2_000_000, 2_700_000] {
        csv(&[&b"1,2,3,4\n".repeat(count)[..], b"x"].concat(), &format!("line {}: it has 1 field", count + 1));
    }
    // Too short for a body each.
    csv(&b"1\n".repeat(10_000_000), "line 1: it has 1 field");
    let map = || terrain("collide --bodies a.csv --map");
    let files = [("a.asc", &b"x"[..]), ("a.csv", &b"1,2,3,4\n".repeat(2_000_000))];
    refused_of(map, &files, &["a.asc"]);
}

#[test]
fn parts_of_films_with_much_in_them() {
    let assemble = || fumarole("assemble");
    let parameters: String = (0..1_400_000).map(|i| format!("\"{i:x}\":\"\",")).collect();
    let part = with(PART, "\"particles\"", &format!("{parameters}\"particles\""));
    refused(assemble, "parts/a.png.part.json", &part, &["lack rows"]);
    let whole = with(PART, "\"frames\":[0,4]", "\"frames\":[3,4]");
    let whole = with(&String::from_utf8(whole).unwrap(), "\"rows\":[2,8]", "\"rows\":[0,8]");
    let files = [("parts/a.png.part.json", &whole[..]), ("parts/f-0003.rows-2-8.png", &black_png(8_192))];
    refused_of(assemble, &files, &["not the picture that was drawn"]);
}

#[test]
fn comparisons_and_tables_of_many_values() {
    let report = |bytes: &[u8], part| refused(|| fumarole("report"), "a.json", bytes, &["a.json", part]);
    for (item, count) in [("[\"\"]", 2_100_000), ("[\"\",\"\"]", 1_800_000), ("[\"\",\"\",\"\",\"\",\"\"]", 900_000)] {
        report(&with_items(VERDICTS, "\"a_commands\":[", item, count), "a_commands");
    }
    for (item, count) in [("[0],", 2_000_000), ("[],", 4_200_000), ("{\"a\":0},", 1_500_000), ("\"a\",", 4_000_000)] {
        let tree = with(VERDICTS, "\"config\":{", &format!("\"config\":{{\"x\":[{}0],", item.repeat(count)));
        report(&with(&String::from_utf8(tree).unwrap(), "\"only_in_b\":[", "\"only_in_b\":[0"), "too many values");
    }
    let nested = format!("{}0{}", "{\"a\":".repeat(100), "}".repeat(100));
    for (item, count) in [("{\"a\":0}", 2_000_000), (nested.as_str(), 27_000), ("{\"a\":[0]}", 1_600_000)] {
        report(&with_items(TABLES, "\"rows\":[", item, count), "too many values");
    }
}

#[test]
fn records_of_many_small_things() {
    for (program, name) in STRESS_READERS {
        let stress = |bytes: &[u8], part| refused(program, name, bytes, &["a", part]);
        stress(&with_items(STRESS, "\"command\":[", "\"a\"", 8_400_000), "too many values");
        let pass = r#"{"name":"","kind":"host","calls":1}"#;
        stress(&with_items(STRESS, "\"passes\":[", pass, 600_000), "too many values");
        stress(&with_items(STRESS, "\"costs\":[", r#"{"name":""}"#, 2_000_000), "costs[");
        let series = r#"{"variant":"","steps":[],"costs":[{"name":""}]}"#;
        stress(&with_items(STRESS, "\"series\":[", series, 500_000), "series[");
        let run = format!(
            r#"{{"value":1,"amount":1,"wall_s":1,"not_finite":{{}},"run":{{"paper":"","variant":"","config":{{}},"width":1,
            "height":1,"seed":1,"warmup":1,"frames":1,"repeat":1,"process":0,"passes":[{pass}],"memory":
            {{"by_resource":[]}},"results":{{}},"validation":"off","warnings":[]}}}}"#
        );
        stress(&with_items(STRESS, "\"steps\":[", &run, 60_000), "steps[");
        let profile = format!(
            "\"profile\":{{\"pass\":\"\",\"compilers\":[{}0]}},",
            r#"{"compiler":"","binaries":[]},"#.repeat(800_000)
        );
        stress(&with(STRESS, "\"experiment\":null,", &format!("\"experiment\":null,{profile}")), "compilers[");
    }
}

/// Without all threads that are wanted there is one, and without that a line that says so.
#[cfg(target_os = "linux")]
#[test]
fn few_threads() {
    let out = super::program::folder();
    std::fs::write(out.path().join("a.csv"), "1,2,3,4\n1,2,3\n").unwrap();
    let program = terrain("collide --bodies").arg(out.path().join("a.csv")).for_shell();
    let run = |limit_kib: u32| {
        let script = format!("ulimit -c 0; ulimit -d {limit_kib}; timeout -s KILL 60 {program}");
        let mut shell = std::process::Command::new("sh");
        shell.arg("-c").arg(&script).env("RAYON_NUM_THREADS", "1000");
        let output = shell.output().unwrap();
        assert_ne!(output.status.code(), Some(137), "{limit_kib} KiB");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = run(128 << 10);
    assert!(code == Some(2) && text.contains("line 2: it has 3 fields") && text.lines().count() == 1, "{text}");
    // From too little for the program up to room for a thread of 2 MiB.
    let refused: Vec<String> =
        (1..24).map(|of| run(of << 8)).filter(|(code, _)| *code == Some(1)).map(|(_, text)| text).collect();
    assert!(refused.iter().any(|text| text.contains("starting a thread")), "{refused:?}");
    assert!(refused.iter().all(|text| text.starts_with("error: ") && text.lines().count() == 1), "{refused:?}");
}

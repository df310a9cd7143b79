//! `burning --materials`: files of materials, good and bad, with meshes of every kind that knows parts or colours.

use std::fs;

use super::program::{ONCE, burning, folder};

const SMALL: &str = "--size 48x32 --blocks 3x3x3 --fire 60 --smoke 30 --speed 1 --flammability 10";

/// Two boxes of several statements each, one on the other.
pub fn pot() -> String {
    let mut text = String::new();
    for (number, (name, y)) in
        [("o pot\ng base stand\nusemtl clay", 0.0), ("o lid\nusemtl tin # bright", 1.0)].iter().enumerate()
    {
        let first = 8 * number;
        text.push_str(name);
        text.push('\n');
        for corner in 0..8 {
            let [x, up, z] = [corner & 1, corner >> 1 & 1, corner >> 2];
            text.push_str(&format!("v {x} {} {z} {} 0 {}\n", f64::from(up) + y, 1 - number, number));
        }
        for face in ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"] {
            let corners: Vec<String> =
                face.split(' ').map(|c| (c.parse::<usize>().unwrap() + first).to_string()).collect();
            text.push_str(&format!("f {}\n", corners.join(" ")));
        }
    }
    text
}

#[test]
fn parts_and_colours_of_files_have_their_constants() {
    let out = folder();
    let write = |name: &str, text: &str| fs::write(out.path().join(name), text).unwrap();
    write("pot.obj", &pot());
    write(
        "names.toml",
        "[[material]]\nkind = \"metal\"\nparts = [\"tin\"]\n\n[[material]]\nkind = \"paper\"\nparts = [\"stand\"]\nrho = 0.25\n",
    );
    write(
        "colours.toml",
        "[[material]]\nkind = \"metal\"\ncolor = [0, 0, 1]\n[[material]]\nkind = \"paper\"\ncolor = [0.9, 0, 0]\nrho = 0.25\n",
    );
    let mut records = Vec::new();
    for file in ["names.toml", "colours.toml"] {
        let bench =
            burning("bench --json --quiet --variant low-poly --levels 1 --first-frame 40").args(SMALL).args(ONCE);
        let bench = bench.args("--mesh pot.obj --materials").arg(file).on_test_device().inside(out.path());
        let run = bench.run().succeeded().json()["runs"][0].clone();
        let substances = run["config"]["substances"].as_array().unwrap().clone();
        let kinds: Vec<&str> = substances.iter().map(|s| s["kind"].as_str().unwrap()).collect();
        assert_eq!(kinds, ["own", "metal", "paper"]);
        assert_eq!((&substances[2]["rho"], &substances[2]["flammability"]), (&0.25.into(), &15.into()));
        let [own, metal, paper] = [0, 1, 2].map(|k| substances[k]["vertices"].as_u64().unwrap());
        // The lid stands on the pot: where they meet, metal stays.
        assert!(own == 0 && metal == 26 && paper == 26 - 9, "{own} {metal} {paper}");
        assert_eq!(run["config"]["materials_sha256"].as_str().unwrap().len(), 64);
        assert!(run["results"]["removed_triangles"].as_u64().unwrap() > 0);
        records.push((run["results"]["live_vertices"].clone(), substances));
    }
    assert!(records[0] == records[1]);
}

#[test]
fn bad_materials_are_refused_with_their_line() {
    let out = folder();
    let write = |name: &str, text: &[u8]| fs::write(out.path().join(name), text).unwrap();
    write("pot.obj", pot().as_bytes());
    write("kind.toml", b"# stone does not burn\n[[material]]\nkind = \"stone\"\n");
    write("part.toml", b"[[material]]\nkind = \"wood\"\nparts = [\"handle\"]\n");
    write("color.toml", b"[[material]]\nkind = \"wood\"\ncolor = [0, 1, 0]\n");
    write("empty.toml", b"");
    write("latin.toml", b"# caf\xe9\n");
    write("large.toml", "#".repeat((96 << 10) + 1).as_bytes());
    let deep = format!("a = {}", "[".repeat(98_000));
    write("deep.toml", deep.as_bytes());
    for (mesh, options, parts) in [
        ("pot.obj", "kind.toml", &["kind.toml", "line 3", "stone", "metal"][..]),
        ("pot.obj", "part.toml", &["part.toml", "line 3", "handle", "pot", "\"stand\"", "tin"]),
        ("box", "part.toml", &["part.toml", "line 3", "box"]),
        ("box", "color.toml", &["color.toml", "line 3", "no colours"]),
        ("pot.obj", "empty.toml", &["empty.toml", "[[material]]"]),
        ("pot.obj", "latin.toml", &["latin.toml", "UTF-8"]),
        ("pot.obj", "large.toml", &["large.toml", "98305"]),
        ("pot.obj", "deep.toml", &["deep.toml", "line 1"]),
        ("pot.obj", "gone.toml", &["gone.toml"]),
        ("pot.obj", ".", &["the materials .", "regular file"]),
    ] {
        let render = burning("render --quiet").args(SMALL).args("--mesh").arg(mesh).args("--materials").arg(options);
        render.on_test_device().inside(out.path()).run().refused(2, parts);
    }
    let both = burning("render --quiet --materials kind.toml --triangles 300").on_test_device().inside(out.path());
    both.run().misused(&["--materials", "--triangles"]);
    // A preset that asks for a count knows no parts either.
    let preset = burning("render --quiet --preset 3.8 --materials kind.toml").on_test_device().inside(out.path());
    preset.run().refused(2, &["--materials", "--triangles"]);
}

//! Comparison of all but times: differences that are told, and those that are refused.

use super::*;
use crate::report::record::{DeviceKind, ImageFile, InputFile, ShaderBinary};

#[test]
fn files_count_by_their_content() {
    let with_file = |path: &str, sha256: &str| {
        let mut run = run_of(&[5.0; 4]);
        run.config.insert("mesh".to_owned(), json!([path]));
        run.inputs = vec![InputFile { path: path.to_owned(), sha256: sha256.to_owned() }];
        vec![input(path, vec![run])]
    };
    let a = with_file("a/bunny.ply", "11");
    assert_eq!(verdict(&a, &with_file("b/bunny.ply", "11")), Verdict::Same);
    let changed = compare(&a, &with_file("a/bunny.ply", "22"), &Options::default()).unwrap_err().to_string();
    assert!(changed.contains("config.mesh is [\"sha256:11\"]"), "{changed}");

    // A number of triangles or a place behind the path, a file within an object, and one that no parameter names.
    let values: [fn(&str) -> Value; 4] = [
        |path| json!([format!("{path}:20000")]),
        |path| json!(format!("{path}@1,2,3")),
        |path| json!([{"source": path, "columns": 3}]),
        |_| json!({"name": "water", "range": [0, 1]}),
    ];
    for value in values {
        let of = |path: &str, sha256: &str| {
            let mut run = run_of(&[5.0; 4]);
            run.config.insert("input".to_owned(), value(path));
            run.inputs = vec![InputFile { path: path.to_owned(), sha256: sha256.to_owned() }];
            vec![input(path, vec![run])]
        };
        let a = of("a/water.png", "11");
        assert_eq!(verdict(&a, &of("b/water.png", "11")), Verdict::Same);
        let changed = compare(&a, &of("a/water.png", "22"), &Options::default()).unwrap_err().to_string();
        assert!(changed.contains("11") && changed.contains("22"), "{changed}");
    }
}

#[test]
fn what_differs_beside_the_times_is_listed_first() {
    let a = [input("a.json", vec![with_passes(&[5.0; 4], &[1.0; 4], &[1.0; 4])])];
    let mut b = a.clone();
    b[0].name = "b.json".to_owned();
    b[0].record.environment.device.driver_version = Some("Mesa 25".to_owned());
    b[0].record.environment.device.kind = DeviceKind::Discrete;
    b[0].record.environment.device.driver = Some("another".to_owned());
    b[0].record.environment.host.kernel = Some("7.0".to_owned());
    b[0].record.environment.host.cpu_governor = Some("powersave".to_owned());
    b[0].record.environment.host.variables.insert("LP_NATIVE_VECTOR_WIDTH".to_owned(), "128".to_owned());
    b[0].record.environment.build.executable_sha256 = Some("4".repeat(64));
    let of_all = |record: &mut Record, compiler: &str| {
        record.runs[0].passes.iter_mut().for_each(|pass| pass.shader_compiler = Some(compiler.to_owned()));
    };
    of_all(&mut b[0].record, "naga");
    let picture = |sha256: &str| Some(ImageFile { path: "a.png".to_owned(), sha256: sha256.to_owned() });
    b[0].record.runs[0].image = picture("2");
    let shader = |sha256: &str| {
        vec![ShaderBinary { name: "s.comp".to_owned(), sha256: sha256.to_owned(), bytes: None, instructions: None }]
    };
    let mut a = a;
    of_all(&mut a[0].record, "glslang");
    a[0].record.runs[0].image = picture("1");
    a[0].record.runs[0].passes[1].shaders = shader("1");
    b[0].record.runs[0].passes[1].shaders = shader("2");
    let comparison = compared(&a, &b, None);
    let whats: Vec<&str> = comparison.differences.iter().map(|difference| difference.what.as_str()).collect();
    let expected = [
        "SPIR-V of gas slices splat: s.comp",
        "build.executable_sha256",
        "device.driver",
        "device.driver_version",
        "device.type",
        "host.cpu_governor",
        "host.kernel",
        "host.variables.LP_NATIVE_VECTOR_WIDTH",
        "picture of gas slices",
        "shader_compiler of gas slices cluster",
        "shader_compiler of gas slices splat",
    ];
    assert_eq!(whats, expected);
    let text = render(&comparison, Style::default());
    assert!(text.contains("picture of gas slices differs"), "{text}");
    let first: Vec<&str> = text.lines().take(1 + expected.len()).collect();
    assert_eq!(first[0], "what is compared");
    for part in [
        "device.type: A cpu, B discrete",
        "shader_compiler of gas slices splat: A glslang, B naga",
        "host.cpu_governor: A unknown, B powersave",
        "host.variables.LP_NATIVE_VECTOR_WIDTH: A unset, B 128",
        "build.executable_sha256: A",
    ] {
        assert!(first[1..].iter().any(|line| line.contains(part)), "{part} in {text}");
    }
    a[0].record.runs[0].image = None;
    let text = render(&compared(&a, &b, None), Style::default());
    assert!(!text.contains("picture of"), "{text}");
    // Of what is not compared, another variant and a pass that one side lacks, nothing is said.
    b[0].record.runs[0].passes[1].name = "drawn".to_owned();
    let mut other = b[0].record.runs[0].clone();
    other.variant = "none".to_owned();
    b[0].record.runs.push(other);
    let comparison = compared(&a, &b, None);
    let of_drawing = comparison.differences.iter().map(|one| one.what.as_str()).filter(|what| what.contains(" of "));
    assert_eq!(of_drawing.collect::<Vec<_>>(), ["shader_compiler of gas slices cluster"]);
    // A stage that the pass has on one side.
    a[0].record.runs[0].passes[0].shaders = shader("1");
    let text = render(&compared(&a, &b, None), Style::default());
    assert!(text.contains("SPIR-V of gas slices cluster: s.comp: A alone has one"), "{text}");
}

/// Of many passes the compiler that all were compiled by is named, not how many differ.
#[test]
fn compilers_of_many_passes_are_named_once() {
    let compiled = |name: &str, compilers: &[&str]| {
        let of = |(index, compiler): (usize, &&str)| {
            let pass = example::pass(&format!("pass-{index}"), PassKind::Graphics);
            Pass { shader_compiler: Some((*compiler).to_owned()), ..pass }
        };
        [input(name, vec![Run { passes: compilers.iter().enumerate().map(of).collect(), ..run_of(&[5.0; 4]) }])]
    };
    let text = |b: &[&str]| {
        let comparison = compared(&compiled("a.json", &["glslang"; 6]), &compiled("b.json", b), None);
        render(&comparison, Style::default())
    };
    assert!(text(&["naga"; 6]).contains("shader compilers of 6 passes: A glslang, B naga"));
    assert!(text(&["naga", "other"].repeat(3)).contains("shader compilers: 6 differ"));
}

#[test]
fn the_same_runs_in_another_order_are_no_difference() {
    let run = |planes: u32, sha256: &str| {
        let mut run = with_passes(&[5.0; 4], &[1.0; 4], &[1.0; 4]);
        run.config.insert("planes".to_owned(), planes.into());
        run.image = Some(ImageFile { path: format!("{planes}.png"), sha256: sha256.to_owned() });
        run
    };
    let runs = vec![run(3, "b"), run(11, "a")];
    let a = [input("a.json", runs.clone())];
    let b = [input("b.json", runs.into_iter().rev().collect())];
    assert_eq!(compared(&a, &b, None).differences.len(), 0);
}

use serde_json::Value;

use super::*;
use crate::measure::statistics::summarize;
use crate::report::example;
use crate::report::record::{CompiledPass, CompiledStage, CounterReading, CounterReadings, Profile, StageStatistic};
use crate::report::table::Align;

fn contents() -> Contents {
    Contents {
        title: "fumarole".to_owned(),
        records: vec![Source { name: "a.json".to_owned(), record: example::full(), pictures: vec![] }],
        ..Contents::default()
    }
}

#[test]
fn the_pages_numbers_are_the_records() {
    let text = page(&contents());
    let record = example::full();
    for pass in &record.runs[0].passes {
        assert!(text.contains(&format!("<td>{}</td>", pass.name)), "{text}");
        for time in [&pass.gpu_ms, &pass.host_ms, &pass.wait_ms].into_iter().flatten() {
            assert!(text.contains(&format!("data-value=\"{}\"", time.median)), "{} of {}", time.median, pass.name);
        }
        for count in pass.statistics.iter().flat_map(|counts| [counts.vertices, counts.fragments]).flatten() {
            assert!(text.contains(&format!("data-value=\"{count}\"")), "{count}");
        }
    }
    for part in ["data-value=\"5\"", "LP_NUM_THREADS is not set", "Mesa 22.3.6", "gas bench", "\"planes\"", "30 planes"]
    {
        let part = part.replace("\"planes\"", "planes");
        assert!(text.contains(&part), "{part}");
    }
}

#[test]
fn the_command_can_be_copied_into_a_shell() {
    let mut contents = contents();
    contents.records[0].record.command = ["fumarole", "ab", "--b", "--seed 2", "it's"].map(str::to_owned).to_vec();
    let text = page(&contents);
    // The quotation marks are escaped as HTML has it.
    assert!(text.contains("fumarole ab --b '--seed 2' &quot;it's&quot;"), "{text}");
}

#[test]
fn nothing_is_loaded_and_only_the_pages_own_script_runs() {
    let text = page(&contents());
    for attribute in ["http://", "https://", "src=\"//", "@import", "url("] {
        assert!(!text.contains(attribute), "{attribute}");
    }
    assert!(text.contains("default-src 'none'"));
    assert_eq!(text.matches("<script>").count(), 1);
}

#[test]
fn runs_of_one_variant_are_told_apart_by_their_parameters_and_sizes() {
    let mut contents = contents();
    let runs = &mut contents.records[0].record.runs;
    let first = runs.remove(0);
    for (planes, width, process) in [(7, 800, 0), (11, 800, 0), (11, 640, 0), (7, 800, 1), (11, 800, 1), (7, 800, 1)] {
        let mut run = Run { width, process, ..first.clone() };
        run.config.insert("planes".to_owned(), planes.into());
        runs.push(run);
    }
    contents.records[0].pictures = vec![Picture { run: 1, png: vec![], difference: None }];
    let text = page(&contents);
    let navigation = text.split_once("<nav").unwrap().1.split_once("</nav>").unwrap().0;
    // What differs in its size alone is called by it, too.
    let labels = ["planes 7", "planes 11: 800 × 600", "planes 11: 640 × 600"];
    for (at, label) in labels.iter().enumerate() {
        let link = format!("<a href=\"#run-0-{at}\">gas slices, figure-7, {label}</a>");
        assert!(navigation.contains(&link), "{link} in {navigation}");
    }
    assert_eq!(navigation.matches("<a ").count(), 3, "{navigation}");
    for title in ["planes 7: 800 × 600", "planes 11: 640 × 600", "planes 11: 800 × 600, process 1"] {
        assert!(text.contains(&format!("<h3>gas slices, figure-7, {title}</h3>")), "{title}");
    }
    assert!(text.contains("<figcaption>gas slices, figure-7, planes 11: 800 × 600</figcaption>"), "{text}");
    assert!(text.contains("<summary>2 runs of it by other processes</summary>"));
    assert!(text.contains("<summary>1 run of it by other processes</summary>"));
    // What one process measured twice are two, for neither stands for the other.
    let mut twice = self::contents();
    let runs = &mut twice.records[0].record.runs;
    runs.push(runs[0].clone());
    let text = page(&twice);
    assert!(!text.contains("class=\"processes\"") && text.contains("href=\"#run-0-1\""));
    assert!(!text.contains("href=\"#record-0\""), "one record needs no link");
    twice.records.push(Source { name: "b.json".to_owned(), record: example::full(), pictures: vec![] });
    let text = page(&twice);
    for (at, name) in ["a.json", "b.json"].iter().enumerate() {
        assert!(text.contains(&format!("<a href=\"#record-{at}\">{name}:</a>")), "{text}");
        assert!(text.contains(&format!("<section class=\"record\" id=\"record-{at}\">")), "{text}");
    }
}

/// A record with a profile of all that there is.
fn profiled() -> Record {
    let mut record = example::full();
    let run = &mut record.runs[0];
    run.passes[1].gpu_ms = summarize(&[1.0, 1.0, 1.0, 1.75, 2.0]);
    let stage = CompiledStage {
        name: "vertex".to_owned(),
        description: "the vertex stage".to_owned(),
        subgroup_size: 32,
        statistics: vec![StageStatistic { name: "registers".to_owned(), value: "24".to_owned() }],
        texts: [("SASS".to_owned(), "MOV".to_owned())].into(),
    };
    let counter = CounterReading {
        name: "cycles".to_owned(),
        category: "shader".to_owned(),
        description: "of the clock".to_owned(),
        unit: "1".to_owned(),
        scope: "command".to_owned(),
        is_mean: false,
        value: Some(77.into()),
    };
    let compiled = CompiledPass {
        compiler: "glslang".to_owned(),
        fallback: Some("an atomic".to_owned()),
        gpu_ms: summarize(&[1.0, 2.0]),
        binaries: run.passes[1].shaders.clone(),
        stages: Some(vec![stage]),
        counters: Some(CounterReadings {
            replays: 3,
            recordings: 2,
            counters: vec![counter],
            left_out: vec!["rare".to_owned()],
        }),
    };
    run.profile = Some(Profile {
        pass: "splat".to_owned(),
        compilers: vec![compiled],
        performance_counters: Some(vec!["cycles".to_owned(), "rare".to_owned()]),
        counters_unread: None,
    });
    record
}

#[test]
fn a_profile_shows_its_distribution_and_says_what_is_not_there() {
    let shown = |change: &dyn Fn(&mut Profile)| {
        let mut contents = contents();
        contents.records[0].record = profiled();
        change(contents.records[0].record.runs[0].profile.as_mut().unwrap());
        page(&contents)
    };
    let text = shown(&|_| {});
    // Three of the lowest of ten bins from 1 to 2 ms, one of that from 1.7 on and one of the highest, which has the end.
    let drawing = text.split_once("<svg class=\"distribution\"").unwrap().1.split_once("</svg>").unwrap().0;
    let counts = [3, 0, 0, 0, 0, 0, 0, 1, 0, 1];
    for (bin, count) in counts.iter().enumerate() {
        let title = format!("<title>from {:.4} ms: {count}</title>", 1.0 + 0.1 * bin as f64);
        assert!(drawing.contains(&title), "{title} in {drawing}");
    }
    assert_eq!(drawing.matches("<rect").count(), counts.len());
    let heights = drawing.matches("height=\"80.00\"").count();
    assert_eq!((heights, drawing.matches("height=\"26.67\"").count()), (1, 2), "a third as high: {drawing}");
    for part in [
        "GPU time of 5 frames, ms: min 1.0000, median 1.0000, MAD 0.0000, max 2.0000",
        "counters: calls 30, vertices 90000, fragments 1600000",
        "at most 4096 and 2048; not certain: density",
        "bound by vertices (ms at the limits: memory 0.2500, vertices 0.5000)",
        "of frame 0, replayed 3 times; the pass is recorded 2 times in it",
        "replays: rare",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    for absent in ["the device has none", "tells neither", "not read"] {
        assert!(!text.contains(absent), "{absent}");
    }
    let text = shown(&|profile| {
        profile.performance_counters = None;
        profile.compilers[0].counters = None;
        profile.compilers[0].stages = None;
    });
    for part in ["(VK_KHR_performance_query): the device has none", "the device tells neither registers, spills"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let text = shown(&|profile| {
        profile.counters_unread = Some("the lock is taken".to_owned());
        profile.compilers[0].counters = None;
    });
    for part in ["not read: the lock is taken", "that the device has: cycles, rare"] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// Every text of a record, and every key that is not a field's name.
fn hostile_texts(value: &mut Value, path: &str, hostile: &str) {
    // Words of the schema, which hold nothing else.
    const WORDS: [&str; 4] = ["/schema", "/type", "/kind", "/validation"];
    const FREE: [&str; 5] = ["/config", "/results", "/variables", "/samples", "/texts"];
    match value {
        Value::String(text) if !WORDS.iter().any(|word| path.ends_with(word)) => *text = format!("{hostile}{path}"),
        Value::Array(items) => {
            items.iter_mut().enumerate().for_each(|(at, item)| hostile_texts(item, &format!("{path}/{at}"), hostile));
        }
        Value::Object(fields) => {
            fields.iter_mut().for_each(|(name, field)| hostile_texts(field, &format!("{path}/{name}"), hostile));
            if FREE.iter().any(|name| path.ends_with(name)) {
                let values: Vec<Value> = fields.values().cloned().collect();
                fields.extend(values.into_iter().map(|value| (format!("{hostile}{path}"), value)));
            }
        }
        _ => {}
    }
}

/// Whatever text a record holds, wherever it holds it.
#[test]
fn no_text_of_a_record_is_markup() {
    let hostile = "<img src=x onerror=alert(1)>\"'";
    let mut document = serde_json::to_value(profiled()).unwrap();
    hostile_texts(&mut document, "", hostile);
    let mut contents = contents();
    contents.records[0].record = serde_json::from_value(document.clone()).unwrap();
    let run = &mut contents.records[0].record.runs[0];
    // The pass that is profiled is found by its name.
    run.profile.as_mut().unwrap().pass = run.passes[1].name.clone();
    let text = page(&contents);
    assert!(!text.contains("<img") && !text.contains("\"'/"), "{text}");
    let escaped = "&lt;img src=x onerror=alert(1)&gt;&quot;'";
    let mut places = vec![];
    texts_of(&document, &mut places);
    // What the page leaves to the record.
    let unseen = [
        "/runs/0/started",
        "/runs/0/image/path",
        "/runs/0/image/sha256",
        "/runs/0/passes/1/shaders/0/name",
        "/runs/0/passes/1/shaders/0/sha256",
        "/runs/0/profile/pass",
        "/runs/0/profile/compilers/0/binaries/0/sha256",
        "/runs/0/profile/performance_counters/0",
        "/runs/0/profile/performance_counters/1",
    ];
    for place in places.iter().filter_map(|text| text.strip_prefix(hostile)) {
        let is_shown = text.contains(&format!("{escaped}{place}")) || text.contains(&format!("\\&quot;'{place}"));
        assert_eq!(is_shown, !unseen.contains(&place), "{place}");
    }
    assert!(places.len() > 40, "{places:?}");
}

/// Of what a browser would not show, or would show in another order.
#[test]
fn no_text_of_a_record_hides_or_turns_about() {
    let hostile = "\u{1b}[2J\0\u{9b}\u{202e}\u{2066}\r";
    let mut document = serde_json::to_value(profiled()).unwrap();
    hostile_texts(&mut document, "", hostile);
    let mut contents = contents();
    contents.title = hostile.to_owned();
    contents.warnings = vec![hostile.to_owned()];
    contents.records[0].name = hostile.to_owned();
    contents.records[0].record = serde_json::from_value(document).unwrap();
    let stages = contents.records[0].record.runs[0].profile.as_mut().unwrap().compilers[0].stages.as_mut().unwrap();
    stages[0].texts.insert("SASS".to_owned(), "MOV\tR1,\tR2\nEXIT".to_owned());
    let text = page(&contents);
    let is_shown = |letter: char| "\n\t".contains(letter) || !(letter.is_control() || hostile.contains(letter));
    let hidden: Vec<char> = text.chars().filter(|letter| letter.is_control() || !letter.is_ascii()).collect();
    assert!(hidden.iter().all(|letter| is_shown(*letter)), "{hidden:?}");
    let escapes = "\\u001b[2J\\u0000\\u009b\\u202e\\u2066\\u000d";
    for place in ["</title>", "/runs/0/variant", "/runs/0/passes/0/name", "/environment/device/name"] {
        assert!(text.contains(&format!("{escapes}{place}")), "{place}");
    }
    assert!(text.contains("<pre>MOV\tR1,\tR2\nEXIT</pre>"));
    // The policy lets this very script run.
    assert!(text.contains(include_str!("script.js")) && text.contains(include_str!("style.css")));
}

fn texts_of(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::String(text) => found.push(text.clone()),
        Value::Array(items) => items.iter().for_each(|item| texts_of(item, found)),
        Value::Object(fields) => {
            found.extend(fields.keys().cloned());
            fields.values().for_each(|field| texts_of(field, found));
        }
        _ => {}
    }
}

/// Names of files and what is made beside the record.
#[test]
fn nothing_around_a_hostile_record_is_markup() {
    let hostile = "<script>alert(1)</script>\"'><img src=x onerror=alert(1)>";
    let mut contents = contents();
    contents.records[0].name = hostile.to_owned();
    let mut table = Table::new(&[(hostile, Align::Left)]);
    table.push(vec![hostile.to_owned()]);
    contents.verdicts = vec![Section {
        title: hostile.to_owned(),
        commands: vec![(hostile.to_owned(), vec![hostile.to_owned()])],
        lines: vec![hostile.to_owned()],
        table: Some(table),
    }];
    let svg = b"<svg onload='alert(1)'/>".to_vec();
    contents.plots = vec![Plot { name: hostile.to_owned(), svg, command: vec![hostile.to_owned()] }];
    contents.pairs = vec![Pair { title: hostile.to_owned(), pngs: [vec![], vec![]], mean: 0.0, p99: 0.0 }];
    let mut document = example::tables();
    document.command = vec![hostile.to_owned()];
    document.experiment = hostile.to_owned();
    document.environment.device.name = hostile.to_owned();
    document.table.title = hostile.to_owned();
    document.table.columns.push(hostile.to_owned());
    document.table.rows[0].0.insert(hostile.to_owned(), hostile.into());
    document.table.rows[1].0.insert("mesh".to_owned(), hostile.into());
    contents.tables = vec![TableSource { name: hostile.to_owned(), document }];
    contents.warnings = vec![hostile.to_owned()];
    let text = page(&contents);
    assert_eq!(text.matches("<script>").count(), 1, "{text}");
    assert!(!text.contains("<img src=x"), "{text}");
    assert!(!text.contains("\"'>"), "attributes are quoted");
    assert!(!text.contains("<svg onload"), "a plot is an image");
}

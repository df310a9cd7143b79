use super::*;
use crate::report::example;
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
fn a_hostile_record_is_text() {
    let hostile = "<script>alert(1)</script>\"'><img src=x onerror=alert(1)>";
    let mut contents = contents();
    let source = &mut contents.records[0];
    source.name = hostile.to_owned();
    source.record.command = vec![hostile.to_owned()];
    source.record.environment.device.name = hostile.to_owned();
    source.record.environment.host.variables.insert(hostile.to_owned(), hostile.to_owned());
    let run = &mut source.record.runs[0];
    run.variant = hostile.to_owned();
    run.warnings = vec![hostile.to_owned()];
    run.config.insert(hostile.to_owned(), hostile.into());
    run.results.insert(hostile.to_owned(), hostile.into());
    run.passes[1].name = hostile.to_owned();
    run.memory.by_resource[0].name = hostile.to_owned();
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

//! A timeline in Chrome's trace event format, for chrome://tracing and Perfetto.
//!
//! Every run is a process with tracks of the host's work, of its waits and of the GPU; every event is complete (`"ph": "X"`). Format: "Trace
//! Event Format", Google, 2016.

use serde_json::{Map, Value, json};

/// One run's timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceRun {
    /// Name of the trace's process: paper, variant and configuration.
    pub name: String,
    /// In any order.
    pub events: Vec<TraceEvent>,
    /// Measured frames that have no events, being too many for a viewer.
    pub frames_left_out: u64,
}

/// One span of time on a track.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceEvent {
    /// Name of the pass or of the host's work.
    pub name: String,
    /// Track that shows it.
    pub track: Track,
    /// Microseconds since an origin common to both tracks of all runs.
    pub start_us: f64,
    /// Microseconds, at least 0.
    pub duration_us: f64,
    /// Shown when the event is selected.
    pub args: Map<String, Value>,
}

/// Clock whose spans a track shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Track {
    /// Work of the host.
    Host,
    /// Waits of the host for the device.
    Wait,
    /// Work of the device.
    Gpu,
}

impl Track {
    const ALL: [Self; 3] = [Self::Host, Self::Wait, Self::Gpu];

    fn id(self) -> u32 {
        match self {
            Self::Host => 1,
            Self::Wait => 2,
            Self::Gpu => 3,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::Wait => "wait",
            Self::Gpu => "GPU",
        }
    }
}

/// The trace file's text. An event whose start is not finite, or whose duration is negative or not finite, cannot be
/// drawn and is left out.
pub fn to_string(runs: &[TraceRun]) -> String {
    let mut events = vec![];
    for (index, run) in runs.iter().enumerate() {
        let process = index + 1;
        events.push(metadata("process_name", process, 0, json!({"name": run.name})));
        let order = json!({"sort_index": index});
        events.push(metadata("process_sort_index", process, 0, order));
        for track in Track::ALL {
            let name = json!({"name": track.name()});
            events.push(metadata("thread_name", process, track.id(), name));
            let order = json!({"sort_index": track.id()});
            events.push(metadata("thread_sort_index", process, track.id(), order));
        }
        let drawable = run
            .events
            .iter()
            .filter(|event| event.start_us.is_finite() && event.duration_us.is_finite() && event.duration_us >= 0.0);
        events.extend(drawable.map(|event| {
            json!({
                "name": event.name, "ph": "X", "cat": event.track.name(), "pid": process, "tid": event.track.id(),
                "ts": event.start_us, "dur": event.duration_us, "args": event.args,
            })
        }));
    }
    let lines: Vec<String> = events.iter().map(Value::to_string).collect();
    let other = json!({"frames_left_out": runs.iter().map(|run| run.frames_left_out).sum::<u64>()});
    let events = lines.join(",\n");
    format!("{{\"displayTimeUnit\": \"ms\", \"otherData\": {other}, \"traceEvents\": [\n{events}\n]}}\n")
}

fn metadata(name: &str, process: usize, thread: u32, args: Value) -> Value {
    json!({"name": name, "ph": "M", "pid": process, "tid": thread, "args": args})
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(name: &str, track: Track, start_us: f64, duration_us: f64) -> TraceEvent {
        TraceEvent {
            name: name.to_owned(),
            track,
            start_us,
            duration_us,
            args: Map::from_iter([("calls".to_owned(), Value::from(3))]),
        }
    }

    #[test]
    fn events_stand_on_named_tracks() {
        let runs = ["gas \"slices\"", "gas splats"].map(|name| TraceRun {
            name: name.to_owned(),
            events: vec![
                event("record", Track::Host, 0.5, 10.0),
                event("splat", Track::Gpu, 12.0, 30.25),
                event("never", Track::Gpu, f64::NAN, 1.0),
                event("backwards", Track::Gpu, 1.0, -1.0),
            ],
            frames_left_out: 0,
        });
        let trace: Value = serde_json::from_str(&to_string(&runs)).unwrap();
        let events = trace["traceEvents"].as_array().unwrap();
        let of_kind = |kind: &str| -> Vec<&Value> { events.iter().filter(|event| event["ph"] == kind).collect() };
        let complete = of_kind("X");
        assert_eq!(complete.len(), 4);
        let splat = complete[3];
        assert_eq!(splat["name"], "splat");
        assert_eq!((&splat["ts"], &splat["dur"]), (&json!(12.0), &json!(30.25)));
        assert_eq!(splat["args"]["calls"], 3);
        let name_of = |what: &str, event: &Value| {
            of_kind("M")
                .into_iter()
                .find(|name| {
                    name["name"] == what
                        && name["pid"] == event["pid"]
                        && (what == "process_name" || name["tid"] == event["tid"])
                })
                .map(|name| name["args"]["name"].clone())
        };
        assert_eq!(name_of("thread_name", splat), Some(json!("GPU")));
        assert_eq!(name_of("process_name", splat), Some(json!("gas splats")));
        assert_eq!(name_of("thread_name", complete[0]), Some(json!("host")));
        assert_eq!(name_of("process_name", complete[0]), Some(json!("gas \"slices\"")));
    }

    #[test]
    fn no_runs_are_still_a_trace() {
        let trace: Value = serde_json::from_str(&to_string(&[])).unwrap();
        assert_eq!((&trace["traceEvents"], &trace["otherData"]["frames_left_out"]), (&json!([]), &json!(0)));
    }
}

//! Events of the worker beside pictures: two sides, values, times, files, command lines.

use std::fs;
use std::path::Path;
use std::process::Command;

use fumarole::image::{compare, read_png};
use fumarole::window::protocol::{
    Event, Keep, MeasureChoice, Request, SideChoice, TargetChoice, ThumbnailChoice, ValueKind, Verb,
};

use super::scene::{Worker, picture, pixels, program, rendered, set, small, variant, words};
use crate::common::{beside_others, wanted_device};

#[test]
fn two_sides_stand_at_one_camera_and_clock_with_their_difference() {
    beside_others(|| {
        let mut worker = Worker::small("caustics");
        worker.frame_after(0);
        worker.client.send(Request::Difference(true));
        worker.client.send(Request::Sides(vec![variant("level-map"), variant("stencil")]));
        worker.client.send(set("camera", "0.5,4,3,0,-2,0"));
        let frame = worker.frame_of(Request::GoTo(2));
        let options = format!("{} --camera=0.5,4,3,0,-2,0 --frame 2", small("caustics"));
        let sides = [picture(&frame, 0), picture(&frame, 1)];
        for (side, variant) in sides.iter().zip(["level-map", "stencil"]) {
            assert!(*side == rendered("caustics", &format!("{options} --variant {variant}")), "{variant}");
        }
        let expected = compare(&sides[0], &sides[1], None).unwrap();
        let difference = frame.difference.expect("a difference");
        assert_eq!((difference.mean, difference.p99, difference.max), (expected.mean, expected.p99, expected.max));
        assert!(expected.mean > 0.0);
        let distances = compare::distances(&sides[0], &sides[1]).unwrap();
        assert!(pixels(&difference.picture) == compare::heat_map(64, 48, &distances).unwrap());

        let naga = SideChoice { compiler: Some("naga".into()), ..variant("level-map") };
        let frame = worker.frame_of(Request::Sides(vec![variant("level-map"), naga]));
        assert!(picture(&frame, 1) == rendered("caustics", &format!("{options} --shader-compiler naga")));
        let of_preset = SideChoice { preset: Some("5-1".into()), ..variant("level-map") };
        let frame = worker.frame_of(Request::Sides(vec![variant("level-map"), of_preset]));
        let preset = rendered("caustics", &format!("{options} --preset 5-1 --variant level-map"));
        assert!(picture(&frame, 1) == preset, "a side of a preset");
        worker.quit();
    });
}

#[test]
fn values_are_those_of_dump_and_statistics_are_theirs() {
    beside_others(|| {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("dump.npy");
        let dump = |paper: &str, target: &str| -> Vec<u8> {
            let options = format!("{paper} render --quiet {} --image", small(paper));
            let mut command = Command::new(program());
            command.args(words(&options)).arg(folder.path().join("x.png")).arg("--device").arg(wanted_device());
            let ended = command.arg("--dump").arg(format!("{target}={}", file.display())).output().unwrap();
            assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
            fs::read(&file).unwrap()
        };
        for (paper, target, kind) in [
            ("caustics", "caustics-map", ValueKind::F32),
            ("caustics", "water", ValueKind::F32),
            ("lava", "normal-height", ValueKind::F32),
            ("burning", "labels", ValueKind::U32),
            ("terrain", "picture", ValueKind::U8),
        ] {
            let mut worker = Worker::small(paper);
            worker.frame_after(0);
            let choice = TargetChoice { side: 0, name: target.into(), layer: 0, first_row: 0 };
            let frame = worker.frame_of(Request::Target(Some(choice)));
            let values = frame.target.expect("the target");
            assert_eq!((values.kind, values.is_written), (kind, true), "{paper} {target}");
            let dumped = dump(paper, target);
            assert!(dumped.ends_with(&values.block.bytes), "{paper} {target}: other bytes than --dump");
            assert!(values.block.bytes.len() + 512 > dumped.len(), "{paper} {target}: a part");
            if kind == ValueKind::F32 && values.channels == 1 {
                let floats: Vec<f32> = bytemuck::pod_collect_to_vec(&values.block.bytes);
                let columns = values.statistics.len();
                for (column, statistics) in values.statistics.iter().enumerate() {
                    let of: Vec<f32> = floats.iter().copied().skip(column).step_by(columns).collect();
                    let counted = statistics.count + statistics.masked + statistics.not_finite;
                    assert_eq!(counted, of.len() as u64);
                    assert_eq!(statistics.histogram.iter().sum::<u64>(), statistics.count);
                    let (Some(min), Some(max)) = (statistics.min, statistics.max) else { continue };
                    assert!(of.iter().any(|&v| f64::from(v) == min) && of.iter().any(|&v| f64::from(v) == max));
                }
            }
            let names = vec![target.to_owned(), "picture".to_owned()];
            let frame = worker.frame_of(Request::Thumbnails(Some(ThumbnailChoice { side: 0, names, longest_px: 16 })));
            for thumbnail in &frame.thumbnails {
                let small = thumbnail.picture.as_ref().expect("a thumbnail");
                assert!(small.width.max(small.height) <= 16 && small.width.min(small.height) >= 1);
                assert_eq!(small.block.bytes.len(), (4 * small.width * small.height) as usize);
            }
            worker.quit();
        }
    });
}

#[test]
fn times_come_on_request_and_then_there_is_peace() {
    beside_others(|| {
        for paper in ["lava", "caustics"] {
            let mut worker = Worker::small(paper);
            let shown = worker.frame_after(0);
            worker.client.send(Request::Measure(MeasureChoice { times: 3, counters: true }));
            let times = worker.wait_for(|event| match event {
                Event::Times(sides) if sides[0].samples == 0 => {
                    // Host work alone is no part of a sum that is not known.
                    assert!(sides[0].passes.iter().all(|pass| pass.fraction.is_none()), "{paper}: {sides:?}");
                    None
                }
                Event::Times(sides) if sides[0].samples == 3 => {
                    let is_counted = |pass: &fumarole::window::protocol::PassTimes| pass.counters.is_some();
                    sides[0].passes.iter().any(is_counted).then(|| sides[0].clone())
                }
                _ => None,
            });
            let built = worker.events.iter().find_map(|event| match event {
                Event::Built(built) => Some(built.sides[0].passes.clone()),
                _ => None,
            });
            let names: Vec<String> = built.unwrap().into_iter().map(|pass| pass.name).collect();
            assert_eq!(times.passes.iter().map(|pass| pass.name.clone()).collect::<Vec<_>>(), names, "{paper}");
            assert!(times.frame_ms.is_some_and(|ms| ms > 0.0));
            assert!(times.passes.iter().all(|pass| pass.gpu_ms.or(pass.host_ms).is_some()), "{paper}: {times:?}");
            let sum: f64 = times.passes.iter().filter_map(|pass| pass.fraction).sum();
            assert!((sum - 1.0).abs() < 1e-9, "{sum}");
            // Frames for times are not shown, and nothing is drawn when all samples are there.
            std::thread::sleep(std::time::Duration::from_millis(500));
            while let Some(event) = worker.client.try_receive() {
                assert!(matches!(event, Event::Times(_)), "{event:?}");
            }
            let again = worker.frame_of(Request::After(None));
            assert_eq!(again.serial, shown.serial + 1);
            assert!(picture(&again, 0) == picture(&shown, 0), "{paper}");
            worker.quit();
        }
    });
}

#[test]
fn the_clock_plays_and_requests_in_a_burst_are_one_frame() {
    beside_others(|| {
        let mut worker = Worker::small("gas");
        let first = worker.frame_after(0);
        let mut last = 0;
        for step in 0..300 {
            last = worker.client.send(set("camera", &format!("-1,3,{},0,0.5,0", 9.0 + 0.01 * f64::from(step))));
        }
        let frame = worker.frame_after(last);
        assert!(frame.serial - first.serial < 40, "{} frames for a burst", frame.serial - first.serial);
        let options = format!("{} --camera=-1,3,{},0,0.5,0", small("gas"), 9.0 + 0.01 * 299.0);
        assert!(picture(&frame, 0) == rendered("gas", &options), "the last of them");

        worker.client.send(Request::Speed(2.0));
        let id = worker.client.send(Request::Play);
        let numbers: Vec<u32> = (0..4).map(|_| worker.frame_after(id).number).collect();
        assert_eq!(numbers, [0, 2, 4, 6]);
        let paused = worker.frame_of(Request::Pause);
        assert!(!paused.is_playing && paused.number >= 6);
        worker.quit();
    });
}

/// A frame of a film, as its planes say it by the recommendation, in floating point.
fn decoded(planes: [&[u8]; 3]) -> Vec<[f64; 3]> {
    let pixel = |((y, cb), cr): ((&u8, &u8), &u8)| {
        let (y, cb, cr) = (f64::from(*y) - 16.0, f64::from(*cb) - 128.0, f64::from(*cr) - 128.0);
        let (y, cb, cr) = (y * 255.0 / 219.0, cb * 255.0 / 224.0, cr * 255.0 / 224.0);
        let (r, b) = (y + 1.402 * cr, y + 1.772 * cb);
        [r, (y - 0.299 * r - 0.114 * b) / 0.587, b]
    };
    planes[0].iter().zip(planes[1]).zip(planes[2]).map(pixel).collect()
}

fn check_film(bytes: &[u8], first: u32) {
    let header = b"YUV4MPEG2 W64 H48 F30:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
    let frames = bytes.strip_prefix(header.as_slice()).expect("a header");
    let plane = 64 * 48;
    let frames: Vec<&[u8]> = frames.chunks(6 + 3 * plane).collect();
    assert_eq!(frames.len(), 3);
    for (frame, number) in frames.iter().zip(first..) {
        let planes = frame.strip_prefix(b"FRAME\n".as_slice()).expect("a frame's header");
        let found = decoded([&planes[..plane], &planes[plane..2 * plane], &planes[2 * plane..]]);
        let expected = rendered("lava", &format!("{} --frame {number}", small("lava")));
        for (found, expected) in found.iter().zip(expected.pixels().chunks_exact(4)) {
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - f64::from(*expected)).abs() < 2.5, "{found} for {expected}");
            }
        }
    }
}

#[test]
fn what_is_kept_is_what_is_seen() {
    beside_others(|| {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name).display().to_string();
        let mut worker = Worker::small("lava");
        let shown = picture(&worker.frame_after(0), 0);
        let mut kept = |keep: Keep| {
            worker.client.send(Request::Keep(keep));
            worker.wait_for(|event| match event {
                Event::Kept(files) => Some(files.clone()),
                _ => None,
            })
        };
        assert_eq!(kept(Keep::Picture { side: 0, file: file("a.png") }), [file("a.png")]);
        assert!(read_png(Path::new(&file("a.png"))).unwrap() == shown);
        kept(Keep::Target { side: 0, name: "density".into(), file: file("density.npy") });
        assert!(fs::read(file("density.npy")).unwrap().starts_with(b"\x93NUMPY"));
        kept(Keep::ContactSheet { side: 0, file: file("sheet.png") });
        let sheet = read_png(Path::new(&file("sheet.png"))).unwrap();
        // The picture and eight targets in three rows.
        assert_eq!((sheet.width(), sheet.height()), (3 * 256, 3 * 256));
        let (first, row) = ((256 - 48) / 2 * 768 * 4 + (256 - 64) / 2 * 4, 64 * 4);
        assert_eq!(sheet.pixels()[first..first + row], shown.pixels()[..row]);
        kept(Keep::Film { side: 0, first: 1, end: 4, file: file("film.y4m") });
        check_film(&fs::read(file("film.y4m")).unwrap(), 1);
        let frames = kept(Keep::Film { side: 0, first: 0, end: 2, file: file("film.png") });
        assert_eq!(frames, [file("film-0000.png"), file("film-0001.png")]);
        assert!(read_png(Path::new(&frames[0])).unwrap() == shown);
        // The clock stays where it was.
        let frame = worker.frame_of(Request::After(None));
        assert!(frame.number == 0 && picture(&frame, 0) == shown);
        worker.quit();

        let options = format!("lava render --quiet {} --frame 1..4 --film", small("lava"));
        let mut command = Command::new(program());
        command.args(words(&options)).arg(file("render.y4m")).arg("--device").arg(wanted_device());
        let ended = command.current_dir(folder.path()).output().unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
        assert!(fs::read(file("render.y4m")).unwrap() == fs::read(file("film.y4m")).unwrap());
        assert!(!folder.path().join("fumarole-out").exists(), "a film is no pictures");
    });
}

#[test]
fn a_command_line_draws_what_is_seen() {
    beside_others(|| {
        let cases = [
            ("caustics", "--preset 5-1 --planes 9", vec![set("camera", "-0.5,4,3,0,-2,0"), set("shadows", "true")]),
            ("lava", "", vec![set("color", "0.1,0.2,0.9")]),
            ("terrain", "--variant gpu-fragment", vec![set("camera", "-5000,6000,9000,0,500,0")]),
        ];
        for (paper, options, changes) in cases {
            let mut worker = Worker::start(paper, &format!("{} {options}", small(paper)));
            worker.frame_after(0);
            for change in changes {
                worker.client.send(change);
            }
            let frame = worker.frame_of(Request::GoTo(2));
            worker.client.send(Request::Command(Verb::Render));
            let line = worker.wait_for(|event| match event {
                Event::Command(line) => Some(line.clone()),
                _ => None,
            });
            assert_eq!(&line[..2], [paper, "render"]);
            let file = tempfile::NamedTempFile::with_suffix(".png").unwrap();
            let ended = Command::new(program()).args(&line).arg("--image").arg(file.path()).output().unwrap();
            assert!(ended.status.success(), "{line:?}: {}", String::from_utf8_lossy(&ended.stderr));
            assert!(read_png(file.path()).unwrap() == picture(&frame, 0), "{line:?}");
            worker.client.send(Request::Command(Verb::Bench));
            let line = worker.wait_for(|event| match event {
                Event::Command(line) => Some(line.clone()),
                _ => None,
            });
            let once = ["--frames", "1", "--repeat", "1", "--warmup", "1", "--no-limits", "--quiet"];
            let ended = Command::new(program()).args(&line).args(once).output().unwrap();
            assert!(ended.status.success(), "{line:?}: {}", String::from_utf8_lossy(&ended.stderr));
            worker.quit();
        }
    });
}

#[test]
fn limits_and_memory_are_told() {
    beside_others(|| {
        let mut worker = Worker::small("gas");
        worker.frame_after(0);
        worker.client.send(Request::Memory);
        let memory = worker.wait_for(|event| match event {
            Event::Memory(memory) => Some(memory.clone()),
            _ => None,
        });
        let sum: u64 = memory.resources.iter().map(|resource| resource.bytes).sum();
        assert!(sum == memory.total_bytes && memory.peak_bytes >= sum && memory.heap_bytes > sum);
        assert!(memory.process_bytes.is_none_or(|bytes| bytes > 1 << 20));
        worker.client.send(Request::Limits);
        let limits = worker.wait_for(|event| match event {
            Event::Limits(limits) => Some(*limits),
            _ => None,
        });
        assert!([limits.copy_gb_s, limits.fma_gflops, limits.fill_gpix_s].iter().all(|rate| rate.unwrap() > 0.0));
        // Each pass against them, as a record has it.
        worker.client.send(Request::Measure(MeasureChoice { times: 1, counters: true }));
        let passes = worker.wait_for(|event| match event {
            Event::Times(sides) => {
                let is_whole = sides[0].samples == 1 && sides[0].passes.iter().any(|pass| pass.counters.is_some());
                is_whole.then(|| sides[0].passes.clone())
            }
            _ => None,
        });
        let known = passes.iter().filter(|pass| pass.floor_ms.is_some_and(|ms| ms > 0.0) && pass.bound.is_some());
        assert!(known.count() >= passes.len() / 2, "{passes:?}");
        worker.quit();
    });
}

//! `terrain` of maps in tiles through the binary: what the record says of them, and what has no room.

use super::program::{ONCE, caustics, entries, file, folder, terrain};
use super::terrain::small;
use crate::faults::Layer;

/// The measurement waits until no tile is missing, and says how many there are and how long that took.
#[test]
fn a_measurement_waits_for_all_tiles() {
    let bench = "bench --json --quiet --resolution 1025 --tile-memory 2 --variant gpu-compute,tiled-compute";
    let report = small(bench).args(ONCE).run().succeeded().json();
    let runs = report["runs"].as_array().unwrap();
    let (whole, tiled) = (&runs[0], &runs[1]);
    assert!(whole["results"]["tiles"].is_null(), "{}", whole["results"]);
    let tiles = &tiled["results"]["tiles"];
    let number = |name: &str| tiles[name].as_u64().unwrap_or_else(|| panic!("no {name} in {tiles}"));
    assert_eq!((number("tiles"), number("missing")), (127, 0));
    assert!((8..=64).contains(&number("held")) && number("loaded") >= number("held"), "{tiles}");
    assert!(number("exchanges") >= 1 && tiles["loading_ms"].as_f64().unwrap() > 0.0, "{tiles}");
    for same in ["steps_per_ray", "hit_share", "levels"] {
        assert_eq!(whole["results"][same], tiled["results"][same], "{same}");
    }
    assert_eq!(tiled["config"]["tile_memory"], 2);
    let bytes = |run: &serde_json::Value, name: &str| {
        let all = run["memory"]["by_resource"].as_array().unwrap();
        all.iter()
            .filter(|of| of["name"].as_str().unwrap().contains(name))
            .map(|of| of["bytes"].as_u64().unwrap())
            .sum::<u64>()
    };
    let (levels, pool) = (bytes(whole, "/levels"), bytes(tiled, "/tiles"));
    assert!(levels > 4 << 20 && pool > 1 << 20 && pool <= 5 << 19, "{levels} and {pool} bytes");
}

/// Pictures of both variants are one; a pool that is too small for a picture is told of.
#[test]
fn pools_without_room_are_told_of() {
    let out = folder();
    let render = |options: &str| {
        let render = format!("render --resolution 1025 --lod exact --camera top {options}");
        small(&render).inside(out.path()).run()
    };
    render("--variant gpu-compute --image whole.png").succeeded();
    let tiled = render("--variant tiled-compute --tile-memory 8 --image tiled.png").succeeded();
    assert!(!tiled.stderr.contains("tile-memory"), "{}", tiled.stderr);
    let read = |name: &str| std::fs::read(out.path().join(name)).unwrap();
    assert!(read("whole.png") == read("tiled.png"));
    // Of four maps each has the coarsest levels all the same.
    let four = "--map volcano --map volcano --map volcano --map volcano";
    for options in ["", four] {
        let lacking =
            render(&format!("{options} --variant tiled-compute --tile-memory 1 --image small.png")).succeeded();
        assert!(
            lacking.stderr.contains("lack room") && lacking.stderr.contains("raise --tile-memory"),
            "{}",
            lacking.stderr
        );
    }
    render("--variant tiled-compute --tile-memory 0 --image none.png").refused(2, &["--tile-memory 0", "1 to 65536"]);
}

/// More memory than one image has room for is no error, and is told of.
#[test]
fn pools_end_with_the_images_of_the_device() {
    let out = folder();
    let layer = Layer::new();
    // An image of 4096 x 4096 texels holds 1024 of the 1372 tiles, for which this memory has room.
    let render = |options: &str| {
        let render = format!("render --resolution 4096 --variant tiled-compute --image x.png {options}");
        layer.least(small(&render).inside(out.path())).run().succeeded().stderr
    };
    let said = render("--tile-memory 64");
    assert!(said.contains("--tile-memory 64") && said.contains("lie in one image"), "{said}");
    let said = render("--tile-memory 16");
    assert!(!said.contains("--tile-memory"), "{said}");
}

/// Every stall of a flight is counted, and no picture is shown with a hole.
#[test]
fn a_flight_counts_its_stalls() {
    let out = folder();
    let flight = "experiment flight --resolution 1025 --lod exact --tile-memory 2 --frames 5 --out .";
    let path = "--camera=-4500,1500,4500,-4000,0,3500 --to=4000,1500,-2500,4500,0,-3500";
    let ended = small(flight).args(path).inside(out.path()).run().succeeded();
    assert!(ended.stderr.contains("of 5 pictures waited for tiles"), "{}", ended.stderr);
    assert_eq!(entries(out.path()), ["terrain-flight.csv", "terrain-flight.json", "terrain-flight.svg"]);
    let text = std::fs::read_to_string(out.path().join("terrain-flight.csv")).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(
        head,
        ["picture", "frame ms", "marks ms", "stalls", "stall ms", "tiles loaded", "tiles held", "tiles missing"]
    );
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 5);
    for row in &rows {
        assert!(row[1] > 0.0 && row[2] > 0.0 && row[6] <= 64.0 && row[7] == 0.0, "{row:?}");
        assert!((row[3] > 0.0) == (row[4] > 0.0) && (row[3] > 0.0) == (row[5] > 0.0), "{row:?}");
    }
    assert!(rows.iter().filter(|row| row[3] > 0.0).count() >= 2, "{rows:?}");
    small("experiment flight --counts 3").run().refused(2, &["--counts", "this experiment has none"]);
}

/// Nothing of the map is held, and the picture is that of the whole one; the file of tiles is made once, made anew where it is
/// damaged, and told of where a tile in it is.
#[test]
fn streamed_maps_come_from_a_file_that_is_made_once() {
    let out = folder();
    let kept = || {
        let folder = out.path().join("fumarole/tiles");
        if folder.exists() { entries(&folder) } else { Vec::new() }
    };
    let render = |options: &str| {
        let render = format!("render --quiet --lod exact --camera top {options}");
        small(&render).inside(out.path()).env("XDG_CACHE_HOME", out.path()).run()
    };
    let read = |name: &str| std::fs::read(out.path().join(name)).unwrap();
    let streamed = "--resolution 1025 --stream --variant tiled-compute --tile-memory 8 --image streamed.png";
    render("--resolution 1025 --variant gpu-compute --image whole.png").succeeded();
    render(&format!("{streamed} --no-cache")).succeeded();
    assert!(read("whole.png") == read("streamed.png") && kept().is_empty());
    for damage in ["", "head", "end"] {
        let path = kept().first().map(|name| out.path().join("fumarole/tiles").join(name));
        match (damage, path) {
            ("head", Some(path)) => {
                let mut bytes = std::fs::read(&path).unwrap();
                bytes[50] ^= 1;
                std::fs::write(&path, bytes).unwrap();
            }
            ("end", Some(path)) => {
                let bytes = std::fs::metadata(&path).unwrap().len();
                std::fs::File::options().write(true).open(&path).unwrap().set_len(bytes / 2).unwrap();
            }
            _ => {}
        }
        std::fs::remove_file(out.path().join("streamed.png")).unwrap();
        render(streamed).succeeded();
        assert!(read("whole.png") == read("streamed.png"), "{damage}");
        let kept = kept();
        assert!(kept.len() == 1 && kept[0].ends_with(".tiles"), "{damage}: {kept:?}");
    }
    // The head is sound, and a tile is not: no picture, one line, and the next run makes the file anew.
    let path = out.path().join("fumarole/tiles").join(&kept()[0]);
    let mut bytes = std::fs::read(&path).unwrap();
    // The data are the last three quarters.
    let middle = bytes.len() / 2;
    bytes[middle..].fill(9);
    std::fs::write(&path, bytes).unwrap();
    render(streamed).refused(2, &["filling", "tile ", "its checksum is another", "start again"]);
    assert!(kept().is_empty());
    render(streamed).succeeded();
    assert!(read("whole.png") == read("streamed.png"));
    // Another exaggeration is another map.
    render(&format!("{streamed} --exaggeration 2")).succeeded();
    assert_eq!(kept().len(), 2);
}

/// Maps of files, mosaics and folders of tiles pass through the file of tiles as they are read whole, over flat and round bases.
#[test]
fn streamed_files_show_what_they_show_whole() {
    let out = folder();
    let (side, corner) = (150, "yllcorner 4000000\ncellsize 30");
    let mut parts = String::new();
    for (name, column) in [("west.asc", 0), ("east.asc", side - 1)] {
        let height = |i: i32| {
            (300.0 + 200.0 * (0.05 * f64::from(column + i % side)).sin() * (0.04 * f64::from(i / side)).cos()).round()
        };
        let rows: String = (0..side * side).map(|i| format!("{} ", height(i))).collect();
        let x = 500_000 + 30 * column;
        file(&out, name, format!("ncols {side}\nnrows {side}\nxllcorner {x}\n{corner}\n{rows}\n"));
        parts += &format!(
            "<SimpleSource><SourceFilename relativeToVRT=\"1\">{name}</SourceFilename><SourceBand>1</SourceBand>\
             <SrcRect xOff=\"0\" yOff=\"0\" xSize=\"{side}\" ySize=\"{side}\"/>\
             <DstRect xOff=\"{column}\" yOff=\"0\" xSize=\"{side}\" ySize=\"{side}\"/></SimpleSource>"
        );
    }
    let mosaic = format!(
        "<VRTDataset rasterXSize=\"{}\" rasterYSize=\"{side}\"><GeoTransform>500000, 30, 0, {}, 0, -30</GeoTransform>\
         <VRTRasterBand dataType=\"Int16\" band=\"1\">{parts}</VRTRasterBand></VRTDataset>",
        2 * side - 1,
        4_000_000 + 30 * side
    );
    file(&out, "mosaic.vrt", mosaic);
    std::fs::create_dir(out.path().join("tiles")).unwrap();
    for (name, column) in [("N37E138", 0), ("N37E139", 1200)] {
        let height =
            |i: i32| (900.0 + 400.0 * (0.01 * f64::from(column + i % 1201)).sin()) as i16 + (i / 1201 % 97) as i16;
        let samples: Vec<u8> = (0..1201 * 1201).flat_map(|i| height(i).to_be_bytes()).collect();
        file(&out, &format!("tiles/{name}.hgt"), samples);
    }
    let read = |name: &str| std::fs::read(out.path().join(name)).unwrap();
    let jacksboro = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/maps/jacksboro.tif");
    for map in [jacksboro, "mosaic.vrt", "tiles"] {
        for base in ["plane", "earth"] {
            let render = |options: &str| {
                let render = format!("render --quiet --map {map} --base {base} --no-cache {options}");
                small(&render).inside(out.path()).run().succeeded();
            };
            render("--variant gpu-compute --image whole.png");
            render("--variant tiled-compute --stream --tile-memory 16 --image streamed.png");
            assert!(read("whole.png") == read("streamed.png"), "{map} on {base}");
        }
    }
}

/// Only a GeoTIFF has overviews, and those that it has.
#[test]
fn overviews_are_those_of_a_geotiff() {
    let jacksboro = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/maps/jacksboro.tif");
    let render = |options: &str| small(&format!("render --quiet --image x.png --overview 1 {options}")).run();
    render("").refused(2, &["--overview 1", "only a GeoTIFF", "--map"]);
    render("--map maunga-whau").refused(2, &["--overview 1", "only a GeoTIFF", "maunga-whau"]);
    render(&format!("--map {jacksboro}")).refused(2, &["jacksboro.tif", "it has 0 overviews"]);
}

/// A file whose spacing no map may have is drawn with one that is given, and as a file of that.
#[test]
fn a_spacing_stands_in_for_that_of_the_file() {
    let out = folder();
    for (name, cell) in [("near.asc", "1e-9"), ("like.asc", "10")] {
        let corner = "xllcorner 500000\nyllcorner 4000000\n";
        file(&out, name, format!("ncols 3\nnrows 3\n{corner}cellsize {cell}\n1 2 3\n4 5 9\n7 8 9\n"));
    }
    let picture = |map: &str, options: &str| {
        let render = format!("render --quiet --image {map}.png --map {map}.asc {options}");
        small(&render).inside(out.path()).env("XDG_CACHE_HOME", out.path()).run()
    };
    let read = |name: &str| std::fs::read(out.path().join(name)).unwrap();
    for options in ["--variant gpu-compute", "--variant tiled-compute --stream"] {
        picture("near", options).refused(2, &["near.asc: cellsize: it makes samples lie"]);
        picture("near", &format!("{options} --spacing 10")).succeeded();
        picture("like", options).succeeded();
        assert!(read("near.png") == read("like.png"), "{options}");
    }
    let water = || caustics("render --quiet --image w.png --water-map near.asc").inside(out.path()).tiny();
    water().run().refused(2, &["near.asc: cellsize: it makes samples lie"]);
    water().args("--water-map-spacing 5").run().succeeded();
}

/// Variants and options that need the samples themselves are refused.
#[test]
fn what_needs_samples_is_not_streamed() {
    let render =
        |options: &str| small(&format!("render --quiet --resolution 65 --stream {options} --image x.png")).run();
    render("--variant gpu-compute").refused(2, &["variant gpu-compute holds whole maps", "tiled-compute", "--stream"]);
    render("--variant cpu").refused(2, &["variant cpu holds whole maps"]);
    render("--variant tiled-compute --object teapot@0,0,0,100").refused(2, &["--object", "--stream"]);
    render("--variant tiled-compute --voids hole").refused(2, &["--voids", "--base-level"]);
    terrain("collide --segment 0,3000,0,2000,0,500 --stream").run().misused(&["--stream"]);
}

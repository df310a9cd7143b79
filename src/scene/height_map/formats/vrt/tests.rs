use super::super::geotiff_check::tests::{SIDE, packed};
use super::*;
use std::fs;

/// A part of 3 x 2 samples of 10 m, as GDAL writes one.
fn part(name: &str, (column, row): (u32, u32), (from, size): ((u32, u32), (u32, u32))) -> String {
    format!(
        "<SimpleSource>\n<SourceFilename relativeToVRT=\"1\">{name}</SourceFilename>\n<SourceBand>1</SourceBand>\n\
         <SrcRect xOff=\"{}\" yOff=\"{}\" xSize=\"{}\" ySize=\"{}\" />\n\
         <DstRect xOff=\"{column}\" yOff=\"{row}\" xSize=\"{}\" ySize=\"{}\" />\n</SimpleSource>\n",
        from.0, from.1, size.0, size.1, size.0, size.1
    )
}

fn mosaic((width, height): (u32, u32), parts: &str) -> String {
    format!(
        "<VRTDataset rasterXSize=\"{width}\" rasterYSize=\"{height}\">\n\
         <GeoTransform> 1000.0, 10.0, 0.0, 2000.0, 0.0, -10.0</GeoTransform>\n\
         <VRTRasterBand dataType=\"Int16\" band=\"1\">\n<NoDataValue>-9999</NoDataValue>\n{parts}</VRTRasterBand>\n</VRTDataset>\n"
    )
}

/// West and east share a column; the middle's middle sample is void in one and known in the other.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let grid = |name: &str, x: u32, rows: &str| {
        let head = format!("ncols 3\nnrows 2\nxllcorner {x}\nyllcorner 1980\ncellsize 10\nNODATA_value -9999\n");
        fs::write(folder.path().join(name), head + rows).unwrap();
    };
    grid("west.asc", 1000, "1 2 -9999\n4 5 6\n");
    grid("east.asc", 1020, "3 7 8\n-9999 -9999 9\n");
    folder
}

fn load_text(folder: &Path, text: &str) -> Result<HeightMap, Error> {
    let path = folder.join("all.vrt");
    fs::write(&path, text).unwrap();
    super::super::load(&path, 0)
}

#[test]
fn parts_lie_where_the_mosaic_says() {
    let folder = folder();
    let all = ((0, 0), (3, 2));
    let parts = part("west.asc", (0, 0), all) + &part("east.asc", (2, 0), all);
    let map = load_text(folder.path(), &mosaic((5, 2), &parts)).unwrap();
    assert_eq!((map.width(), map.height(), map.voids()), (5, 2, 1));
    let row = |row| (0..5).map(|column| map.height_m(column, row)).collect::<Vec<_>>();
    assert_eq!(row(0), [1.0, 2.0, 3.0, 7.0, 8.0]);
    assert_eq!([0, 1, 2, 4].map(|column| map.height_m(column, 1)), [4.0, 5.0, 6.0, 9.0]);
    assert!(matches!(map.samples(), Samples::Steps { step_m: 1.0, .. }));
    let place = map.coordinates().unwrap();
    assert_eq!((place.north_west, place.step), (DVec2::new(1005.0, 1995.0), DVec2::splat(10.0)));
    assert_eq!(map.spacing_m(), DVec2::splat(10.0));
    // What says that heights are metres changes nothing.
    let plain = "<Offset>0</Offset><Scale>1</Scale><UnitType>metre</UnitType></VRTRasterBand>";
    let text = mosaic((5, 2), &parts).replacen("</VRTRasterBand>", plain, 1);
    assert_eq!(load_text(folder.path(), &text).unwrap(), map);
    // A rectangle of a part, and its place by the part that it comes from.
    let parts = part("east.asc", (0, 0), ((1, 0), (2, 2)));
    let map = load_text(folder.path(), &mosaic((2, 2), &parts)).unwrap();
    assert_eq!((map.height_m(0, 0), map.height_m(1, 0), map.height_m(1, 1)), (7.0, 8.0, 9.0));
    assert_eq!(map.coordinates().unwrap().north_west, DVec2::new(1035.0, 1995.0));
    assert_eq!(
        super::parts(&folder.path().join("all.vrt")),
        [fs::canonicalize(folder.path().join("east.asc")).unwrap()]
    );
}

#[test]
fn what_would_change_heights_or_lies_elsewhere_is_refused() {
    let folder = folder();
    let all = ((0, 0), (3, 2));
    let (west, east) = (part("west.asc", (0, 0), all), part("east.asc", (2, 0), all));
    let good = mosaic((5, 2), &(west.clone() + &east));
    let with = |from: &str, to: &str| good.replacen(from, to, 1);
    fs::write(folder.path().join("nested.vrt"), &good).unwrap();
    let over = |side: u32| part("west.asc", (0, 0), ((0, 0), (side, side)));
    for (text, expected) in [
        ("<a>".to_owned(), "all.vrt: "),
        ("<a/>".to_owned(), "line 1: a: it is no VRTDataset"),
        (with("rasterXSize=\"5\"", "rasterXSize=\"0\""), "line 1: VRTDataset: it has 0 x 2 samples"),
        (with("rasterXSize=\"5\"", "rasterXSize=\"x\""), "rasterXSize is \"x\""),
        (with("rasterXSize=\"5\"", ""), "it has no rasterXSize"),
        (with("rasterXSize=\"5\"", "rasterXSize=\"4\""), "DstRect: it leaves the raster"),
        (mosaic((60_000, 60_000), &west), "its parts cover 6 of 60000 x 60000 samples"),
        (with(" 10.0, 0.0, 2000", " 10.0, 1.0, 2000"), "line 2: GeoTransform: it is not north up"),
        (with(" 10.0, 0.0, 2000", " 11.0, 0.0, 2000"), "not as far apart as its GeoTransform says"),
        (with("-9999</NoDataValue>", "none</NoDataValue>"), "NoDataValue: it is \"none\", not a number"),
        (with("</VRTDataset>", "<MaskBand><VRTRasterBand/></MaskBand></VRTDataset>"), "MaskBand: it hides samples"),
        (with("<NoDataValue>", "<Scale>0.1</Scale>\n<NoDataValue>"), "line 4: Scale: it changes heights"),
        (with("<NoDataValue>", "<Offset>5</Offset>\n<NoDataValue>"), "line 4: Offset: it changes heights"),
        (with("<NoDataValue>", "<UnitType>ft</UnitType>\n<NoDataValue>"), "UnitType: its heights are in \"ft\"; write"),
        (with("<VRTRasterBand ", "<VRTRasterBand subClass=\"VRTDerivedRasterBand\" "), "its subClass is"),
        (with("</VRTRasterBand>", "</VRTRasterBand><VRTRasterBand/>"), "it is a second band"),
        (mosaic((5, 2), ""), "it has no SimpleSource"),
        (with("relativeToVRT=\"1\"", "relativeToVRT=\"0\""), "line 6: SourceFilename: it is not relative"),
        (with("<SourceBand>1", "<SourceBand>2"), "it is band \"2\""),
        (with("<SourceBand>", "<ScaleRatio>2</ScaleRatio><SourceBand>"), "ScaleRatio: it changes heights"),
        (good.replace("SimpleSource", "KernelFilteredSource"), "KernelFilteredSource: SimpleSource and"),
        (mosaic((4_096, 4_096), &(0..80).map(|cut| over(4_096 - cut)).collect::<String>()), "leave out those"),
        (mosaic((5, 2), &(west.clone() + &east).repeat(13)), "to and fro between its 2 files, 26 times"),
        (with("west.asc", &"w".repeat(2_000)), "no name of a file"),
        (
            with("<DstRect xOff=\"0\" yOff=\"0\" xSize=\"3\"", "<DstRect xOff=\"0\" yOff=\"0\" xSize=\"4\""),
            "nothing is resampled",
        ),
        (with("<SrcRect xOff=\"0\"", "<SrcRect xOff=\"0.5\""), "xOff is 0.5; whole samples alone"),
        (
            with("<SrcRect xOff=\"0\"", "<SrcRect xOff=\"1\""),
            "line 5: its SrcRect leaves west.asc, which has 3 x 2 samples",
        ),
        (with("west.asc", "north.asc"), "north.asc: "),
        (with("west.asc", " "), "line 6: SourceFilename: it names no file"),
        (with("west.asc", "../west.asc"), "../west.asc: it lies outside"),
        (with("west.asc", "nested.vrt"), "nested.vrt: a mosaic's parts are files of heights"),
        (
            mosaic((6, 2), &(west.clone() + &part("east.asc", (3, 0), all))),
            "east.asc does not lie where its DstRect says",
        ),
    ] {
        let message = load_text(folder.path(), &text).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected}: {message}");
    }
}

/// Of a part of far more bytes than its file has.
#[test]
fn what_is_packed_is_looked_through_before_any_of_it_is_kept() {
    let folder = folder();
    let path = folder.path().join("packed.tif");
    let last = (SIDE * SIDE - 1) as usize;
    let all = part("packed.tif", (0, 0), ((0, 0), (SIDE, SIDE)));
    let text = mosaic((SIDE, SIDE), &all);
    let voids = text.replace("-9999</NoDataValue>", "0</NoDataValue>");
    fs::write(&path, packed(0.0, last, 5.0)).unwrap();
    let options = MapOptions::default();
    for (voids, is_known) in [(vec![], true), (vec![0.0], true), (vec![5.0, 0.0], false)] {
        let (map, has_known) = first_look::look_through(&path, options, &voids).unwrap().unwrap();
        assert_eq!((map.width(), map.height(), map.samples().len(), has_known), (SIDE, SIDE, 0, is_known), "{voids:?}");
    }
    assert!(first_look::look_through(&folder.path().join("west.asc"), options, &[]).unwrap().is_none());
    assert!(first_look::unpacked(&path, options).unwrap().most_bytes > spare_bytes(fs::metadata(&path).unwrap().len()));
    let map = load_text(folder.path(), &text).unwrap();
    assert_eq!((map.width(), map.voids(), map.range_m()), (SIDE, 0, (0.0, 5.0)));
    let map = load_text(folder.path(), &voids).unwrap();
    assert_eq!((map.voids(), map.range_m()), (last as u64, (5.0, 5.0)));
    fs::write(&path, packed(0.0, last, 0.0)).unwrap();
    // A part whose voids are others than those of the first of its file.
    let other = all.replace("SimpleSource", "ComplexSource").replace("</Comp", "<NODATA>0</NODATA>\n</Comp");
    let map = load_text(folder.path(), &mosaic((SIDE, SIDE), &(other + &part("packed.tif", (0, 0), ((0, 0), (2, 2))))));
    let map = map.unwrap();
    assert_eq!((map.voids(), map.range_m()), (last as u64 - 3, (0.0, 0.0)));
    fs::write(folder.path().join("cut.asc"), "ncols 2\nnrows 2\n1 2 3").unwrap();
    let behind = |name: &str| part("packed.tif", (0, 0), ((0, 0), (2, 2))) + &part(name, (2, 0), ((0, 0), (2, 2)));
    for (text, expected) in [
        (voids, "all.vrt: all its samples are void"),
        (mosaic((4, 2), &behind("cut.asc")), "cut.asc: line 3: 3 heights for ncols"),
        (mosaic((SIDE + 1, 2), &part("packed.tif", (0, 0), ((0, 0), (SIDE + 1, 2)))), "SrcRect leaves packed.tif"),
    ] {
        let message = load_text(folder.path(), &text).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected}: {message}");
    }
}

#[test]
fn a_mosaic_places_parts_that_have_no_place() {
    let folder = folder();
    fs::write(folder.path().join("bare.asc"), "ncols 3\nnrows 2\n1 2 3\n4 5 6\n").unwrap();
    let text = mosaic((3, 2), &part("bare.asc", (0, 0), ((0, 0), (3, 2))));
    let placed = |text: &str| load_text(folder.path(), text).unwrap();
    let place = placed(&text).coordinates().unwrap();
    assert_eq!((place.north_west, place.step), (DVec2::new(1005.0, 1995.0), DVec2::splat(10.0)));
    assert_eq!(placed(&text).spacing_m(), DVec2::splat(10.0));
    // By the unit of its reference system, and in degrees.
    let srs = |wkt: &str| text.replacen("<GeoTransform>", &format!("<SRS>{wkt}</SRS><GeoTransform>"), 1);
    let feet = placed(&srs("PROJCS[&quot;x&quot;,UNIT[&quot;Foot&quot;,0.3048]]"));
    assert_eq!(feet.spacing_m(), DVec2::splat(3.048));
    let degrees = text.replace("1000.0, 10.0, 0.0, 2000.0, 0.0, -10.0", "7.0, 0.01, 0.0, 45.0, 0.0, -0.01");
    assert!(placed(&degrees).geographic().is_some());
    let far = text.replace("1000.0, 10.0, 0.0, 2000.0, 0.0, -10.0", "0.0, 1e7, 0.0, 0.0, 0.0, -1e7");
    let message = load_text(folder.path(), &far).unwrap_err().to_string();
    assert!(message.contains("all.vrt: GeoTransform: it makes samples lie"), "{message}");
    let bare = placed(&text.replace("GeoTransform", "Metadata"));
    assert_eq!((bare.coordinates(), bare.spacing_m()), (None, DVec2::ONE));
}

#[test]
fn a_spacing_of_the_users_stands_in_for_that_of_the_parts() {
    let folder = folder();
    let far = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1e300\n1 2 3\n4 5 6\n";
    fs::write(folder.path().join("far.asc"), far).unwrap();
    let text = mosaic((3, 2), &part("far.asc", (0, 0), ((0, 0), (3, 2))));
    let message = load_text(folder.path(), &text).unwrap_err().to_string();
    assert!(message.contains("far.asc: cellsize: it makes samples lie"), "{message}");
    let options = MapOptions { has_own_spacing: true, ..MapOptions::default() };
    let map = super::super::load(&folder.path().join("all.vrt"), options).unwrap();
    assert_eq!((map.range_m(), map.coordinates(), map.spacing_m()), ((1.0, 6.0), None, DVec2::ONE));
    // Beside a part that has a place, in either order.
    let all = ((0, 0), (3, 2));
    for (first, second, expected) in [
        ("west.asc", "far.asc", "far.asc has no place that a map may have, and the first part has one"),
        ("far.asc", "west.asc", "west.asc has a place, and the first part has none that a map may have"),
    ] {
        let text = mosaic((6, 2), &(part(first, (0, 0), all) + &part(second, (3, 0), all)));
        fs::write(folder.path().join("all.vrt"), text).unwrap();
        let message = super::super::load(&folder.path().join("all.vrt"), options).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

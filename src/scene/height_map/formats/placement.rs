//! Spacing of the samples of a raster with map coordinates.

use super::{check_unit, read_text};
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::height_map::grid::Placement;
use crate::scene::height_map::{Coordinates, Geographic, MapOptions};
use crate::scene::{Error, file, world_file};
use glam::DVec2;
use std::path::Path;

/// The unit of map coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unit {
    Degrees,
    /// So many metres.
    Metres(f64),
    /// Metres at the equator, of which those of the ground are a part everywhere else.
    WebMercator,
}

/// Steps of this size or more are taken for metres where nothing names the unit.
const COARSEST_DEG: f64 = 0.1;

/// Placement of a raster in map coordinates of an unnamed unit: the centre of its north-west sample, and the steps east
/// and south between samples.
pub(super) struct MapCoordinates {
    /// Centre of the north-west sample, x and y; `None` where the file does not say.
    pub(super) north_west: Option<DVec2>,
    /// Steps east and south between samples, both above 0.
    pub(super) step: DVec2,
    /// Samples in a row.
    pub(super) width: u32,
    /// Number of rows.
    pub(super) height: u32,
    /// Name of what states the steps in the file.
    pub(super) field: &'static str,
}

impl MapCoordinates {
    /// The same area in so many columns and rows, each sample in the middle of an equal part of it.
    pub(super) fn in_parts(self, width: u32, height: u32) -> Self {
        let parts = DVec2::new(self.width.into(), self.height.into()) / DVec2::new(width.into(), height.into());
        let step = self.step * parts;
        let inwards = (step - self.step) / 2.0 * DVec2::new(1.0, -1.0);
        MapCoordinates { north_west: self.north_west.map(|first| first + inwards), step, width, height, ..self }
    }

    /// The placement in the unit given; without one, coordinates that can be longitude and latitude in steps below 0.1
    /// degrees are taken for degrees, as GTOPO30 has them, and all others for metres.
    ///
    /// # Errors
    /// Steps that make samples lie outside [`HeightMap::SPACING_M`](crate::scene::HeightMap::SPACING_M).
    pub(super) fn placed(&self, unit: Option<Unit>) -> Result<Placement, Fault> {
        let corner = self.north_west.filter(|corner| {
            let cells = DVec2::new(self.width.into(), self.height.into()) - 1.0;
            let south_east = *corner + DVec2::new(1.0, -1.0) * self.step * cells;
            corner.min(south_east).cmpge(DVec2::new(-360.0, -91.0)).all()
                && corner.max(south_east).cmple(DVec2::new(360.0, 91.0)).all()
        });
        let guess = || match corner {
            Some(_) if self.step.max_element() < COARSEST_DEG => Unit::Degrees,
            _ => Unit::Metres(1.0),
        };
        let placement = match (unit.unwrap_or_else(guess), corner) {
            (Unit::Metres(metres), _) => {
                let coordinates = self.north_west.map(|north_west| Coordinates { north_west, step: self.step });
                Placement::Metres(self.step * metres, coordinates)
            }
            (Unit::WebMercator, _) => return Err(self.stretched()),
            (Unit::Degrees, Some(corner)) => {
                Placement::Degrees(Geographic { west_deg: corner.x, north_deg: corner.y, step_deg: self.step })
            }
            // Degrees somewhere off the Earth tell no latitude.
            (Unit::Degrees, None) => return Ok(Placement::Unknown),
        };
        placement.check(self.height, self.field).map(|()| placement)
    }

    /// Web Mercator: heights would stand on land that is too wide for them.
    fn stretched(&self) -> Fault {
        /// Of its sphere, metres.
        const RADIUS_M: f64 = 6_378_137.0;
        let middle_m = self.north_west.map(|first| first.y - self.step.y * (f64::from(self.height) - 1.0) / 2.0);
        let remedy = "write metres of the ground with gdalwarp -t_srs and a system for its place";
        let reason = match middle_m.filter(|middle_m| middle_m.is_finite()) {
            Some(middle_m) => {
                let cosine = 1.0 / (middle_m / RADIUS_M).cosh();
                let spacing_m = cosine * self.step.max_element();
                format!(
                    "a metre of Web Mercator is {cosine:.3} m of the ground at its middle; {remedy}, or give `spacing` \
                     {spacing_m:.6}, which holds there"
                )
            }
            None => format!("a metre of Web Mercator is less than one of the ground; {remedy}, or give `spacing`"),
        };
        Fault::new(Place::Part(self.field.to_owned()), reason)
    }

    /// As [`Self::placed`]; where samples have a spacing of the user's, steps that no map may have tell nothing.
    ///
    /// # Errors
    /// As [`Self::placed`], of a map without a spacing of the user's.
    pub(super) fn placed_or_spaced(&self, unit: Option<Unit>, has_own_spacing: bool) -> Result<Placement, Fault> {
        match self.placed(unit) {
            Err(_) if has_own_spacing => Ok(Placement::Unknown),
            placed => placed,
        }
    }
}

/// The placement that a world file beside a picture states, in the unit that a `.prj` beside it names, or else in its own; unknown
/// without a world file. The picture is the `whole` one, or an overview of it of so many columns and rows.
///
/// # Errors
/// Of the files beside it, and steps that make samples lie outside
/// [`HeightMap::SPACING_M`](crate::scene::HeightMap::SPACING_M): where samples have a spacing of the user's, neither.
pub(super) fn by_world_file(
    picture: &Path,
    own: Option<Unit>,
    whole: (u32, u32),
    (width, height): (u32, u32),
    options: MapOptions,
) -> Result<Placement, Error> {
    let read = || {
        let Some((path, Coordinates { north_west, step })) = world_file::beside(picture)? else {
            return Ok(Placement::Unknown);
        };
        let unit = beside(picture)?.or(own);
        let (north_west, (columns, rows)) = (Some(north_west), whole);
        let whole = MapCoordinates { north_west, step, width: columns, height: rows, field: "step" };
        let placed = whole.in_parts(width, height).placed(unit);
        placed.map_err(|fault| Error::Malformed { path, asset: Asset::WorldFile, fault })
    };
    if options.is_placed {
        return Ok(Placement::Unknown);
    }
    match read() {
        Err(_) if options.has_own_spacing => Ok(Placement::Unknown),
        placed => placed,
    }
}

/// The unit that the `.prj` file beside a raster names, if there is one.
pub(super) fn beside(raster: &Path) -> Result<Option<Unit>, Error> {
    for ending in ["prj", "PRJ"] {
        if let Some(path) = file::beside(raster, ending)? {
            let (file, _) = file::open(&path, Asset::HeightMap)?;
            let projection = read_text(file, &path)?;
            return match check_heights(&projection) {
                Ok(()) => Ok(unit(&projection)),
                Err(reason) => {
                    let fault = Fault::new(Place::Whole, reason);
                    Err(Error::Malformed { path, asset: Asset::HeightMap, fault })
                }
            };
        }
    }
    Ok(None)
}

/// Words at which a projection's text turns to the system of heights.
const OF_HEIGHTS: [&str; 3] = ["VERT_CS[", "VERTCS[", "VERTCRS["];

/// Passes for heights in metres, and for a projection that says nothing of heights.
pub(super) fn check_heights(projection: &str) -> Result<(), String> {
    let upper = projection.to_uppercase();
    let Some(at) = OF_HEIGHTS.iter().filter_map(|word| upper.find(word)).min() else { return Ok(()) };
    // Behind it, the unit of its axis: UNIT["name",metres], or LENGTHUNIT.
    let unit = upper[at..].split("UNIT[").nth(1).unwrap_or_default();
    let mut parts = unit.split([',', ']']);
    let name = parts.next().unwrap_or_default().trim().trim_matches('"').to_lowercase();
    match parts.next().and_then(|metres| metres.trim().parse::<f64>().ok()) {
        Some(metres) if metres != 1.0 => check_unit(&name),
        _ => Ok(()),
    }
}

/// The unit in a projection's text: well-known text, or the older lines of keywords that GTOPO30 ships.
pub(super) fn unit(projection: &str) -> Option<Unit> {
    let upper = projection.to_uppercase();
    if upper.contains("PROJCS") || upper.contains("PROJCRS") {
        // Heights may have a system of their own behind it.
        let end = OF_HEIGHTS.iter().filter_map(|word| upper.find(word)).min();
        let projected = &upper[..end.unwrap_or(upper.len())];
        if ["PSEUDO-MERCATOR", "MERCATOR_AUXILIARY_SPHERE", "PSEUDO MERCATOR"]
            .iter()
            .any(|name| projected.contains(name))
        {
            return Some(Unit::WebMercator);
        }
        // The last unit is that of the projected coordinates: UNIT["name",metres].
        let unit = projected.rsplit("UNIT[").next().and_then(|tail| tail.split(',').nth(1));
        let digits = |text: &str| text.trim().trim_end_matches([']', ' ']).parse::<f64>().ok();
        let metres = unit.and_then(|tail| digits(tail.split(']').next().unwrap_or(tail)));
        return Some(Unit::Metres(metres.filter(|metres| metres.is_finite() && *metres > 0.0).unwrap_or(1.0)));
    }
    if ["GEOGCS", "GEOGCRS", "GEOGRAPHIC"].iter().any(|word| upper.contains(word)) {
        return Some(Unit::Degrees);
    }
    upper.contains("METERS").then_some(Unit::Metres(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::height_map::formats::load;

    #[test]
    fn projections_name_their_unit() {
        let geographic =
            r#"GEOGCS["GCS_WGS_1984",DATUM["D"],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]"#;
        assert_eq!(unit(geographic), Some(Unit::Degrees));
        assert_eq!(unit("Projection    GEOGRAPHIC\nDatum WGS84\nUnits  DD\n"), Some(Unit::Degrees));
        let projected = |unit: &str| format!(r#"PROJCS["x",{geographic},PROJECTION["y"],{unit}]"#);
        assert_eq!(unit(&projected(r#"UNIT["Meter",1.0]"#)), Some(Unit::Metres(1.0)));
        assert_eq!(
            unit(&projected(r#"UNIT["Foot_US",0.3048006096012192]"#)),
            Some(Unit::Metres(0.304_800_609_601_219_2))
        );
        assert_eq!(unit(&projected(r#"UNIT["broken""#)), Some(Unit::Metres(1.0)));
        let with_heights =
            format!(r#"COMPD_CS["y",{},VERT_CS["z",UNIT["metre",1]]]"#, projected(r#"UNIT["Foot",0.3048]"#));
        assert_eq!(unit(&with_heights), Some(Unit::Metres(0.3048)));
        let vertical = projected(r#"PARAMETER["Vertical_Perspective",1],UNIT["Foot",0.3048]"#);
        assert_eq!(unit(&vertical), Some(Unit::Metres(0.3048)));
        assert_eq!(unit("Projection UTM\nUnits METERS\n"), Some(Unit::Metres(1.0)));
        assert_eq!(unit("nothing"), None);
    }

    #[test]
    fn web_mercator_has_a_unit_of_its_own() {
        for name in [
            "WGS_1984_Web_Mercator_Auxiliary_Sphere\",PROJECTION[\"Mercator_Auxiliary_Sphere",
            "WGS 84 / Pseudo-Mercator",
        ] {
            assert_eq!(unit(&format!("PROJCS[\"{name}\",UNIT[\"Meter\",1.0]]")), Some(Unit::WebMercator), "{name}");
        }
        let grid = |north_west| MapCoordinates {
            north_west,
            step: DVec2::splat(200.0),
            width: 3,
            height: 3,
            field: "cellsize",
        };
        let message = grid(Some(DVec2::new(0.0, 200.0))).placed(Some(Unit::WebMercator)).unwrap_err().to_string();
        assert!(message.contains("is 1.000 m") && message.contains("`spacing` 200.000000"), "{message}");
        assert!(grid(None).placed(Some(Unit::WebMercator)).is_err());
        let own = grid(None).placed_or_spaced(Some(Unit::WebMercator), true);
        assert_eq!(own, Ok(Placement::Unknown));
    }

    #[test]
    fn heights_in_feet_are_refused_by_their_projection() {
        let compound = |unit: &str| {
            check_heights(&format!(
                "COMPD_CS[\"x\",PROJCS[\"y\",UNIT[\"Foot\",0.3048]],VERT_CS[\"z\",VERT_DATUM[\"d\",2005],{unit}]]"
            ))
        };
        assert_eq!(compound("UNIT[\"metre\",1.0,AUTHORITY[\"EPSG\",\"9001\"]]"), Ok(()));
        assert_eq!(compound("AXIS[\"Up\",UP]"), Ok(()));
        for unit in ["UNIT[\"Foot_US\",0.3048006096012192]", "LENGTHUNIT[\"foot\",0.3048]"] {
            assert!(compound(unit).unwrap_err().contains("its heights are in \"foot"), "{unit}");
        }
        assert_eq!(check_heights("PROJCS[\"y\",UNIT[\"Foot\",0.3048]]"), Ok(()));
    }

    #[test]
    fn parts_of_an_area_have_their_middles() {
        let north_west = Some(DVec2::new(100.5, 39.5));
        let fine = || MapCoordinates { north_west, step: DVec2::ONE, width: 8, height: 12, field: "cellsize" };
        let coarse = fine().in_parts(4, 3);
        assert_eq!((coarse.north_west, coarse.step), (Some(DVec2::new(101.0, 38.0)), DVec2::new(2.0, 4.0)));
        let same = fine().in_parts(8, 12);
        assert_eq!((same.north_west, same.step), (north_west, DVec2::ONE));
    }

    #[test]
    fn unnamed_units_follow_from_the_coordinates() {
        let grid = |west: f64, north: f64, step: f64| MapCoordinates {
            north_west: Some(DVec2::new(west, north)),
            step: DVec2::splat(step),
            width: 100,
            height: 100,
            field: "cellsize",
        };
        let degrees = grid(139.99, 40.0, 1.0 / 120.0);
        assert!(matches!(degrees.placed(None), Ok(Placement::Degrees(place)) if place.north_deg == 40.0));
        let whole_earth = MapCoordinates { width: 36, height: 18, ..grid(-175.0, 85.0, 10.0) };
        assert!(matches!(whole_earth.placed(Some(Unit::Degrees)), Ok(Placement::Degrees(_))));
        let own = |grid: &MapCoordinates| grid.north_west.map(|north_west| Coordinates { north_west, step: grid.step });
        let doubled = Placement::Metres(DVec2::splat(1.0 / 60.0), own(&degrees));
        assert_eq!(degrees.placed(Some(Unit::Metres(2.0))), Ok(doubled));
        for metres in [grid(500_000.0, 4_000_000.0, 30.0), grid(0.0, 50.0, 1.0), grid(10.0, 90.0, 20.0)] {
            assert_eq!(metres.placed(None), Ok(Placement::Metres(metres.step, own(&metres))));
        }
        assert_eq!(grid(900.0, 0.0, 0.01).placed(Some(Unit::Degrees)), Ok(Placement::Unknown));
        let nowhere = MapCoordinates { north_west: None, ..grid(0.0, 0.0, 0.01) };
        assert_eq!(nowhere.placed(None), Ok(Placement::Metres(nowhere.step, None)));
    }

    #[test]
    fn samples_lie_neither_too_near_nor_too_far_apart() {
        let grid = |step: f64| MapCoordinates {
            north_west: Some(DVec2::new(7.0, 45.0)),
            step: DVec2::splat(step),
            width: 4,
            height: 4,
            field: "cellsize",
        };
        for (step, unit, is_good) in [
            (1e-6, Unit::Metres(1.0), true),
            (1e6, Unit::Metres(1.0), true),
            (1e-300, Unit::Metres(1.0), false),
            (1e300, Unit::Metres(1.0), false),
            (1e300, Unit::Metres(1e300), false),
            (5e5, Unit::Metres(3.0), false),
            (1e-11, Unit::Degrees, false),
            (1e-10, Unit::Degrees, true),
            (20.0, Unit::Degrees, true),
        ] {
            let placed = grid(step).placed(Some(unit));
            assert_eq!(placed.is_ok(), is_good, "{step:?} {unit:?}");
            let Err(fault) = placed else { continue };
            let message = fault.to_string();
            let is_said = message.starts_with("cellsize: it makes samples lie ")
                && message.contains("; they have to lie 0.000001 to 1000000");
            assert!(is_said && message.len() < 160, "{message}");
        }
    }

    /// GDAL takes a world file's lines for the middle of the first texel, and a projection beside it for their unit.
    #[test]
    fn pictures_lie_where_their_world_files_say() {
        let folder = tempfile::tempdir().unwrap();
        let asset = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/maps").join(name);
        let copy = |from: &str, name: &str| {
            let path = folder.path().join(name);
            std::fs::copy(asset(from), &path).unwrap();
            path
        };
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        let png = copy("topobathy-2000m-uint16.png", "land.png");
        assert_eq!(load(&png, 0).unwrap().coordinates(), None);
        write("land.pgw", "30\n0\n0\n-20\n2500000\n6400000\n");
        let map = load(&png, 0).unwrap();
        let place = Coordinates { north_west: DVec2::new(2.5e6, 6.4e6), step: DVec2::new(30.0, 20.0) };
        assert_eq!((map.coordinates(), map.spacing_m()), (Some(place), place.step));
        write("land.prj", r#"PROJCS["p",UNIT["Foot",0.3048]]"#);
        assert_eq!(load(&png, 0).unwrap().spacing_m(), place.step * 0.3048);
        write("land.pgw", "1e-6\n0\n0\n-20\n2500000\n6400000\n");
        let error = load(&png, 0).unwrap_err().to_string();
        assert!(error.contains("world file ") && error.contains("land.pgw: step: it makes samples lie"), "{error}");
        assert_eq!(
            load(&png, MapOptions { has_own_spacing: true, ..MapOptions::default() }).unwrap().coordinates(),
            None
        );
        write("land.pgw", "30\n0\n");
        let error = load(&png, 0).unwrap_err().to_string();
        assert!(error.contains("land.pgw: it has 2 numbers"), "{error}");

        // A TIFF's own place is the one that holds.
        let placed = copy("topobathy-int16.tif", "placed.tif");
        write("placed.tfw", "30\n0\n0\n-20\n2500000\n6400000\n");
        assert_eq!(
            load(&placed, 0).unwrap().coordinates(),
            load(&asset("topobathy-int16.tif"), 0).unwrap().coordinates()
        );
        let bare = folder.path().join("bare.tif");
        let mut file = tiff::encoder::TiffEncoder::new(std::fs::File::create(&bare).unwrap()).unwrap();
        file.write_image::<tiff::encoder::colortype::Gray8>(3, 2, &[1, 2, 3, 4, 5, 6]).unwrap();
        write("bare.TFW", "0.01 0 0 -0.02 11 46");
        let map = load(&bare, 0).unwrap();
        let place = map.geographic().unwrap();
        assert_eq!((place.west_deg, place.north_deg, place.step_deg), (11.0, 46.0, DVec2::new(0.01, 0.02)));
        // In a mosaic that states a place itself, nothing else is asked.
        let source = "<SimpleSource><SourceFilename relativeToVRT='1'>bare.tif</SourceFilename><SrcRect xOff='0' yOff='0' \
                      xSize='3' ySize='2'/><DstRect xOff='0' yOff='0' xSize='3' ySize='2'/></SimpleSource>";
        let mosaic = |place: &str| {
            write(
                "all.vrt",
                &format!(
                    "<VRTDataset rasterXSize='3' rasterYSize='2'>{place}<VRTRasterBand>{source}</VRTRasterBand></VRTDataset>"
                ),
            );
            load(&folder.path().join("all.vrt"), 0).unwrap()
        };
        assert_eq!(mosaic("").geographic(), Some(place));
        assert_eq!(mosaic("<GeoTransform>5e5, 7, 0, 6e6, 0, -7</GeoTransform>").spacing_m(), DVec2::splat(7.0));
        let rows = crate::scene::RowSource::geotiff(&bare, MapOptions::default()).unwrap().unwrap();
        assert_eq!((rows.map().geographic(), rows.map().spacing_m()), (Some(place), map.spacing_m()));
    }
}

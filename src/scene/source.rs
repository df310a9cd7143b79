use crate::scene::loading::{Conditions, MeshOptions, timed};
use crate::scene::{Error, Mesh, divided, formats, notes, shapes};
use glam::{UVec2, Vec2};
use std::convert::Infallible;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Source of a mesh: one of the built-in ones or a file.
///
/// As text: `teapot`, `sphere`, `box`, `bunny` or `plane`; anything else is a path, so that a file named
/// `box` is `./box`. Each may be followed by `:N`, and is then divided into N triangles or a few more.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum MeshSource {
    /// [`shapes::teapot`].
    Teapot,
    /// [`shapes::sphere`] of 32 slices and 32 stacks, 1,984 triangles.
    Sphere,
    /// [`shapes::cuboid`].
    Box,
    /// The Stanford bunny, scanned: 3,674 triangles, built in from `assets/meshes/bunny.obj`.
    Bunny,
    /// [`shapes::plane`], 2 m x 2 m in 32 x 32 cells.
    Plane,
    /// An OBJ, PLY, STL, glTF or GLB file, told apart by the file's ending.
    File(PathBuf),
    /// Another source, [divided] into at least so many triangles.
    Divided(Box<MeshSource>, u64),
}

impl MeshSource {
    /// Most triangles that a mesh is divided into: twice the largest that any paper holds on a large device.
    pub const MOST_DIVIDED: u64 = 200_000_000;

    /// Refuses a name with a number of triangles behind a colon that no mesh is divided into.
    fn check_division(path: &Path) -> Result<(), Error> {
        let text = path.to_string_lossy();
        let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        let is_division = text.rsplit_once(':').is_some_and(|(mesh, count)| !mesh.is_empty() && is_number(count));
        if is_division && std::fs::symlink_metadata(path).is_err() {
            return Err(Error::Division { path: path.to_owned(), most: Self::MOST_DIVIDED });
        }
        Ok(())
    }

    /// The mesh with at least `triangles`; one that was to be divided already, by the new number.
    pub fn divided(&self, triangles: u64) -> Self {
        match self {
            Self::Divided(source, _) => source.divided(triangles),
            whole => Self::Divided(Box::new(whole.clone()), triangles),
        }
    }

    /// The file that it is read from, if it is.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Divided(source, _) => source.path(),
            _ => None,
        }
    }

    /// Builds the shape or reads the file.
    ///
    /// # Errors
    /// For files only: one that cannot be read, has an unknown ending, is malformed, or holds no
    /// triangle.
    pub fn load(&self) -> Result<Mesh, Error> {
        self.load_with(&MeshOptions::default())
    }

    /// As [`MeshSource::load`], with other options.
    ///
    /// # Errors
    /// As [`MeshSource::load`]; [`Error::Interrupted`].
    pub fn load_with(&self, options: &MeshOptions) -> Result<Mesh, Error> {
        self.load_under(options, Conditions::current())
    }

    /// As [`MeshSource::load_with`], for whoever waits and with a cache, or none, of its own.
    ///
    /// # Errors
    /// As [`MeshSource::load_with`].
    pub fn load_under(&self, options: &MeshOptions, conditions: &Conditions) -> Result<Mesh, Error> {
        let mut mesh = match self {
            Self::Teapot => shapes::teapot(),
            Self::Sphere => shapes::sphere(32, 32),
            Self::Box => shapes::cuboid(),
            Self::Bunny => formats::bunny()?,
            Self::Plane => shapes::plane(Vec2::splat(2.0), UVec2::splat(32)),
            Self::File(path) => {
                Self::check_division(path)?;
                return formats::load(path, options, conditions);
            }
            Self::Divided(source, triangles) => {
                let whole = MeshOptions { is_optimised: false, ..*options };
                let whole = source.load_under(&whole, conditions)?;
                if whole.triangle_count() as u64 > *triangles {
                    notes::tell(format!("{self}: it has {} triangles, and is not divided", whole.triangle_count()));
                }
                divided(&whole, *triangles)
            }
        };
        if options.is_optimised {
            timed(|parts| &mut parts.optimise_ms, || mesh.optimise_order());
        }
        Ok(mesh)
    }

    /// Triangles that a file says it has, where it says so before they come, and at least those that a mesh is divided into.
    ///
    /// # Errors
    /// As [`MeshSource::load`], of what stands before the triangles.
    pub fn promised_triangles(&self) -> Result<Option<u64>, Error> {
        match self {
            Self::File(path) => {
                Self::check_division(path)?;
                formats::promised_triangles(path)
            }
            Self::Divided(source, triangles) => Ok(source.promised_triangles()?.max(Some(*triangles))),
            _ => Ok(None),
        }
    }
}

/// Triangles that these are known to have before they are loaded.
///
/// # Errors
/// As [`MeshSource::promised_triangles`].
pub fn promised_triangles<'a>(sources: impl IntoIterator<Item = &'a MeshSource>) -> Result<u64, Error> {
    sources.into_iter().map(|source| Ok(source.promised_triangles()?.unwrap_or(0))).sum()
}

impl FromStr for MeshSource {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        if let Some((source, count)) = text.rsplit_once(':')
            && let Some(triangles) = count.parse().ok().filter(|count| (1..=Self::MOST_DIVIDED).contains(count))
            && !source.is_empty()
            && !count.starts_with('+')
        {
            let Ok(source) = source.parse::<Self>();
            return Ok(source.divided(triangles));
        }
        Ok(match text {
            "teapot" => Self::Teapot,
            "sphere" => Self::Sphere,
            "box" => Self::Box,
            "bunny" => Self::Bunny,
            "plane" => Self::Plane,
            path => Self::File(path.into()),
        })
    }
}

impl fmt::Display for MeshSource {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Teapot => formatter.write_str("teapot"),
            Self::Sphere => formatter.write_str("sphere"),
            Self::Box => formatter.write_str("box"),
            Self::Bunny => formatter.write_str("bunny"),
            Self::Plane => formatter.write_str("plane"),
            Self::File(path) => path.display().fmt(formatter),
            Self::Divided(source, triangles) => write!(formatter, "{source}:{triangles}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::error::Asset;

    #[test]
    fn text_round_trips() {
        for text in ["teapot", "sphere", "box", "bunny", "plane", "meshes/a.obj", "./box", ""] {
            let Ok(source) = text.parse::<MeshSource>();
            assert_eq!(source.to_string(), text);
            let is_file = matches!(source, MeshSource::File(_));
            assert_eq!(is_file, !["teapot", "sphere", "box", "bunny", "plane"].contains(&text));
        }
    }

    #[test]
    fn a_number_divides_and_a_path_with_a_colon_stays_one() {
        for (text, expected) in [
            ("bunny:8000", MeshSource::Bunny.divided(8000)),
            ("a.obj:12", MeshSource::File("a.obj".into()).divided(12)),
            ("a:b.obj", MeshSource::File("a:b.obj".into())),
            ("bunny:0", MeshSource::File("bunny:0".into())),
            (":12", MeshSource::File(":12".into())),
            ("bunny:+12", MeshSource::File("bunny:+12".into())),
            ("bunny:200000001", MeshSource::File("bunny:200000001".into())),
        ] {
            let Ok(source) = text.parse::<MeshSource>();
            assert_eq!((&source, source.to_string().as_str()), (&expected, text));
        }
        let Ok(source) = "bunny:8000".parse::<MeshSource>();
        assert_eq!(source.load().unwrap().triangle_count(), 3 * 3674);
        assert_eq!(source.divided(9).to_string(), "bunny:9");
    }

    #[test]
    fn misspelt_names_and_numbers_are_told_what_there_is() {
        let of = |text: &str| {
            let Ok(source) = text.parse::<MeshSource>();
            let errors = [source.load().unwrap_err(), source.promised_triangles().unwrap_err()];
            let [one, other] = errors.map(|error| error.to_string());
            assert_eq!(one, other);
            one
        };
        let names = Asset::Mesh.built_in().unwrap();
        for name in names.split(", ") {
            let Ok(source) = name.parse::<MeshSource>();
            assert!(source.path().is_none(), "{name}");
        }
        for text in ["bunnny", "bunnny:100", ":12", ""] {
            let message = of(text);
            assert!(message.contains(names) && message.contains(".obj"), "{message}");
        }
        for text in ["bunny:0", "bunny:99999999999999999999", "a.obj:200000001"] {
            let message = of(text);
            assert!(message.contains(text) && message.contains("1 to 200000000"), "{message}");
        }
        assert!(of("bunny.xyz").contains("unknown file ending \"xyz\""));
    }

    #[test]
    fn shapes_load_valid_with_their_counts() {
        for (text, triangles) in [("teapot", 6_320), ("sphere", 1_984), ("box", 12), ("bunny", 3_674), ("plane", 2_048)]
        {
            let Ok(source) = text.parse::<MeshSource>();
            let mesh = source.load().unwrap();
            mesh.validate().unwrap();
            assert_eq!((mesh.name.as_str(), mesh.triangle_count()), (text, triangles));
        }
    }
}

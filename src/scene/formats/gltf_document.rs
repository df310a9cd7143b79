//! The document of a glTF file, refused before it is read where it would take far more memory than its text.

use crate::scene::error::{Fault, Place};
use ::gltf::{Document, json};
use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, MapAccess, Visitor};
use serde_json::{Value, from_slice};
use std::fmt;

/// Bytes that one object of the document can take in memory.
const OBJECT_BYTES: usize = 512;
/// Most bytes of memory for each of the text, and as many more.
const PER_BYTE: usize = 16;
const SPARE_BYTES: usize = 64 << 20;

/// Beginnings of the names of extensions that change how surfaces look, of which nothing is read.
const OF_LOOKS: [&str; 3] = ["KHR_materials_", "KHR_texture_", "KHR_lights_"];

/// The lists whose parts the library takes for something larger than their text.
#[derive(Deserialize)]
struct Outline {
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    #[expect(dead_code)]
    materials: Vec<Object>,
    #[serde(default)]
    #[expect(dead_code)]
    samplers: Vec<Object>,
}

#[derive(Deserialize)]
struct Accessor {
    #[serde(default)]
    min: Bound,
    #[serde(default)]
    max: Bound,
}

/// Numbers of the least or the largest element, which the library takes for a tree of any values.
#[derive(Default)]
struct Bound(u8);

impl Bound {
    /// Of the widest element, a matrix.
    const MOST: usize = 16;

    /// Memory of its list, which grows by doubling.
    fn bytes(&self) -> usize {
        if self.0 == 0 { 0 } else { size_of::<Value>() * usize::from(self.0).next_power_of_two().max(4) }
    }
}

impl<'de> Deserialize<'de> for Bound {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // A list of nothing takes no memory.
        let count = Option::<Vec<Number>>::deserialize(deserializer)?.map_or(0, |numbers| numbers.len());
        if count > Self::MOST {
            return Err(D::Error::invalid_length(count, &"at most 16 numbers"));
        }
        Ok(Bound(count as u8))
    }
}

/// A number, or `null`, which some write for one that is not finite.
struct Number;

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Option::<f64>::deserialize(deserializer).map(|_| Number)
    }
}

/// An object and no list, which the library would take for one without any field.
struct Object;

impl<'de> Deserialize<'de> for Object {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Fields;
        impl<'de> Visitor<'de> for Fields {
            type Value = Object;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Object, A::Error> {
                while fields.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
                Ok(Object)
            }
        }
        deserializer.deserialize_map(Fields)
    }
}

/// Refuses a document of so many objects and bounds that they would take far more memory than its text.
fn check_memory(text: &[u8], outline: &Outline) -> Result<(), Fault> {
    let objects = text.iter().filter(|byte| **byte == b'{').count();
    let bounds: usize = outline.accessors.iter().map(|accessor| accessor.min.bytes() + accessor.max.bytes()).sum();
    if objects * OBJECT_BYTES + bounds > PER_BYTE * text.len() + SPARE_BYTES {
        let reason = format!("its {} bytes of JSON hold {objects} objects, too many for that size", text.len());
        return Err(Fault::new(Place::Whole, reason));
    }
    Ok(())
}

/// Other files that a document names; the rest of it is passed over.
#[derive(Deserialize)]
struct Named {
    #[serde(default)]
    buffers: Vec<NamedBuffer>,
}

#[derive(Deserialize)]
struct NamedBuffer {
    uri: Option<String>,
}

/// The URIs of a document's buffers, in their order; none of a text that its reader refuses for what it would take.
pub fn buffer_uris(text: &[u8]) -> Vec<String> {
    let named = || -> Option<Named> {
        check_memory(text, &from_slice(text).ok()?).ok()?;
        from_slice(text).ok()
    };
    named().into_iter().flat_map(|named| named.buffers).filter_map(|buffer| buffer.uri).collect()
}

/// True for a text that says that it is of version 1.
fn is_version_1(text: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct Root {
        asset: Asset,
    }
    #[derive(Deserialize)]
    struct Asset {
        version: Version,
    }
    from_slice(text).is_ok_and(|root: Root| root.asset.version.0)
}

/// A text, and in early files a number; true for one that begins with 1.
struct Version(bool);

impl<'de> Deserialize<'de> for Version {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct First;
        impl Visitor<'_> for First {
            type Value = Version;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("a version")
            }

            fn visit_str<E>(self, text: &str) -> Result<Version, E> {
                Ok(Version(text.starts_with('1')))
            }

            fn visit_u64<E>(self, number: u64) -> Result<Version, E> {
                Ok(Version(number.to_string().starts_with('1')))
            }

            fn visit_f64<E>(self, number: f64) -> Result<Version, E> {
                Ok(Version(number.to_string().starts_with('1')))
            }
        }
        deserializer.deserialize_any(First)
    }
}

/// Passes for what a reader of version 2.0 may read.
fn check_version(asset: &json::Asset) -> Result<(), Fault> {
    let refused = |version: &str, what: &str| {
        let version: String = version.chars().take(40).collect();
        let reason = format!("its {what} is {version:?}, and glTF 2.0 is read; export it as that");
        Fault::new(Place::Part("asset".to_owned()), reason)
    };
    let numbers = |version: &str| {
        let (major, minor) = version.split_once('.').unwrap_or((version, "0"));
        Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
    };
    // Later ones of the same major number are read by what they have in common.
    if numbers(&asset.version).is_none_or(|(major, _)| major != 2) {
        return Err(refused(&asset.version, "version"));
    }
    match &asset.min_version {
        Some(least) if numbers(least).is_none_or(|least| least > (2, 0)) => Err(refused(least, "minVersion")),
        _ => Ok(()),
    }
}

pub(super) fn foreign(error: ::gltf::Error) -> Fault {
    Fault::foreign(Place::Whole, &format!("it is no valid glTF: {error}"))
}

/// The document of a text, which is no container, even where it begins like one.
pub(super) fn read_document(text: &[u8]) -> Result<Document, Fault> {
    let invalid = |error: serde_json::Error| {
        let reason = "it is glTF 1.0, whose meshes are written otherwise; convert it to 2.0";
        if is_version_1(text) { Fault::new(Place::Whole, reason) } else { foreign(error.into()) }
    };
    check_memory(text, &from_slice(text).map_err(invalid)?)?;
    // Not by the library's reader of files, which takes text that begins like a binary file for another.
    let mut json: json::Root = from_slice(text).map_err(invalid)?;
    check_version(&json.asset)?;
    // The library knows none of them, and calls a file with any invalid.
    json.extensions_required.retain(|name| !OF_LOOKS.iter().any(|begin| name.starts_with(begin)));
    if let Some(name) = json.extensions_required.first() {
        let name: String = name.chars().take(40).collect();
        let reason = format!("it requires the extension {name:?}, which is not read; export it without");
        return Err(Fault::new(Place::Whole, reason));
    }
    // The validation that follows looks at the accessor of the positions before it looks whether
    // there is one.
    let accessor_count = json.accessors.len();
    for (number, mesh) in json.meshes.iter().enumerate() {
        let mut accessors = mesh.primitives.iter().flat_map(|p| p.attributes.values());
        if let Some(index) = accessors.find(|index| index.value() >= accessor_count) {
            let reason = format!("it names accessor {index}, but there are {accessor_count}");
            return Err(Fault::new(Place::Part(format!("mesh {number}")), reason));
        }
    }
    Document::from_json(json).map_err(foreign)
}

//! Lists, texts and values of any shape in a document, no more of them than its size lets expect: `[],` is three bytes of
//! JSON and a hundred in memory.

use std::cell::Cell;
use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

thread_local! {
    /// Bytes that what is read here may still take, of the document that this thread reads.
    static LEFT: Cell<usize> = const { Cell::new(usize::MAX) };
}

/// Bytes of an entry of an object, with its share of the table of hashes.
const ENTRY_BYTES: usize = size_of::<(u64, String, Value)>() + 16;

/// Reads a document of `size_bytes`, which may take 64 MiB and 16 times its size: three quarters of that for what is read
/// here, the others for its text and its numbers.
pub(super) fn within<T>(size_bytes: usize, read: impl FnOnce() -> T) -> T {
    LEFT.set(size_bytes.saturating_mul(16).saturating_add(64 << 20) / 4 * 3);
    let read = read();
    LEFT.set(usize::MAX);
    read
}

fn spend<E: Error>(bytes: usize) -> Result<(), E> {
    let left = LEFT.get().checked_sub(bytes).ok_or_else(|| E::custom("too many values for a file of its size"))?;
    LEFT.set(left);
    Ok(())
}

/// As [`spend`], for a text with what the allocator adds; an empty one is not allocated.
fn spend_text<E: Error>(text: &str) -> Result<(), E> {
    spend(if text.is_empty() { 0 } else { text.len().max(16) + 16 })
}

/// An object of values of any shape.
///
/// # Errors
/// Anything but an object, and more values than the document may have.
pub(crate) fn object<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Map<String, Value>, D::Error> {
    // It may stand in a list, which grows by doubling.
    spend(2 * size_of::<Value>())?;
    match Any.deserialize(deserializer)? {
        Value::Object(map) => Ok(map),
        _ => Err(D::Error::custom("an object is needed")),
    }
}

/// A list.
///
/// # Errors
/// Anything but a list, and more items than the document may have.
pub(crate) fn list<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    List(PhantomData).deserialize(deserializer)
}

/// A list of texts.
///
/// # Errors
/// As [`list`].
pub(super) fn texts<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    List(Text).deserialize(deserializer)
}

/// As [`texts`]; absent for `null`.
///
/// # Errors
/// As [`list`].
pub(super) fn texts_if_any<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<String>>, D::Error> {
    #[derive(Deserialize)]
    #[serde(transparent)]
    struct Texts(#[serde(deserialize_with = "texts")] Vec<String>);
    Ok(Option::<Texts>::deserialize(deserializer)?.map(|texts| texts.0))
}

/// A list of lists of texts.
///
/// # Errors
/// As [`list`].
pub(crate) fn lists_of_texts<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Vec<String>>, D::Error> {
    List(List(Text)).deserialize(deserializer)
}

#[derive(Clone, Copy)]
struct Text;

impl<'de> DeserializeSeed<'de> for Text {
    type Value = String;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<String, D::Error> {
        let text = String::deserialize(deserializer)?;
        spend_text(&text)?;
        Ok(text)
    }
}

/// A list of what a seed reads.
#[derive(Clone, Copy)]
struct List<S>(S);

impl<'de, S: DeserializeSeed<'de> + Copy> DeserializeSeed<'de> for List<S> {
    type Value = Vec<S::Value>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de, S: DeserializeSeed<'de> + Copy> Visitor<'de> for List<S> {
    type Value = Vec<S::Value>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a sequence")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Self::Value, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element_seed(self.0)? {
            if list.len() == list.capacity() {
                // It takes room for four, and then for twice as many.
                spend(list.capacity().max(4) * size_of::<S::Value>())?;
            }
            list.push(item);
        }
        Ok(list)
    }
}

#[derive(Clone, Copy)]
struct Any;

impl<'de> DeserializeSeed<'de> for Any {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Any {
    type Value = Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a value")
    }

    fn visit_unit<E: Error>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Ok(Number::from_f64(value).map_or(Value::Null, Value::Number))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Value, E> {
        spend_text(value)?;
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, items: A) -> Result<Value, A::Error> {
        List(Any).visit_seq(items).map(Value::Array)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(key) = entries.next_key_seed(Text)? {
            match map.len() {
                0 => spend(4 * ENTRY_BYTES)?,
                // As a list, and a little earlier.
                count if count >= 4 && count.is_power_of_two() => spend(count * ENTRY_BYTES)?,
                _ => {}
            }
            map.insert(key, entries.next_value_seed(Any)?);
        }
        Ok(map.into())
    }
}

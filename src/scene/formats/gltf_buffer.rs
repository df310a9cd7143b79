use crate::file;
use crate::scene::error::{Fault, Place};
use ::gltf::Document;
use ::gltf::buffer::Source;
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Some exporters leave the padding out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The buffers of a document, which may share a file.
#[derive(Default)]
pub(super) struct Buffers<'a> {
    /// Bytes and the length that the document claims, which they have.
    buffers: Vec<(Rc<Cow<'a, [u8]>>, usize)>,
    files: HashMap<PathBuf, Rc<Cow<'a, [u8]>>>,
    /// The file that each URI means: asking the system takes far longer than reading the URI.
    paths: HashMap<String, PathBuf>,
}

impl<'a> Buffers<'a> {
    /// Reads all buffers: the binary chunk, data in the document, and files below `directory`, each once.
    pub fn read(document: &Document, mut chunk: Option<Cow<'a, [u8]>>, directory: &Path) -> Result<Self, Fault> {
        let mut read = Buffers::default();
        for buffer in document.buffers() {
            let fault = |reason| Fault::new(Place::Part(format!("buffer {}", buffer.index())), reason);
            let bytes = match buffer.source() {
                Source::Bin => {
                    Rc::new(chunk.take().ok_or_else(|| fault("the file has no binary chunk for it".to_owned()))?)
                }
                Source::Uri(uri) => read.resolve(uri, directory).map_err(fault)?,
            };
            if bytes.len() < buffer.length() {
                return Err(fault(format!("it claims {} bytes, but there are {}", buffer.length(), bytes.len())));
            }
            read.buffers.push((bytes, buffer.length()));
        }
        Ok(read)
    }

    /// The bytes of a buffer; none of one that is not there.
    pub fn get(&self, index: usize) -> Option<&[u8]> {
        self.buffers.get(index).and_then(|(bytes, length)| bytes.get(..*length))
    }

    /// Bytes of all files and all data, each counted once.
    pub fn total_bytes(&self) -> usize {
        let shared: usize = self.files.values().map(|bytes| bytes.len()).sum();
        let own = self.buffers.iter().filter(|(bytes, _)| Rc::strong_count(bytes) == 1);
        shared + own.map(|(bytes, _)| bytes.len()).sum::<usize>()
    }

    fn resolve(&mut self, uri: &str, directory: &Path) -> Result<Rc<Cow<'a, [u8]>>, String> {
        let shown = |error: std::io::Error| Fault::foreign(Place::Whole, &error).reason;
        if let Some(data) = uri.strip_prefix("data:") {
            let (_, encoded) = data.split_once(";base64,").ok_or("its data URI is not encoded as base64")?;
            let bytes = BASE64.decode(encoded);
            return bytes
                .map(|bytes| Rc::new(bytes.into()))
                .map_err(|_| "its data URI is damaged: it is no base64".to_owned());
        }
        if uri.contains(':') {
            return Err("only data URIs and relative paths are supported".to_owned());
        }
        let path = match self.paths.get(uri) {
            Some(path) => path.clone(),
            None => {
                let name = percent_decoded(uri).ok_or("its path is not valid percent-encoded UTF-8")?;
                let path = file::below(directory, Path::new(&name)).map_err(shown)?;
                self.paths.insert(uri.to_owned(), path.clone());
                path
            }
        };
        if let Some(known) = self.files.get(&path) {
            return Ok(known.clone());
        }
        let bytes: Rc<Cow<'a, [u8]>> = Rc::new(file::read(&path, super::MAX_FILE_BYTES).map_err(shown)?.into());
        self.files.insert(path, bytes.clone());
        Ok(bytes)
    }
}

/// The name of a file that a URI tells; absent where it is not percent-encoded UTF-8.
pub fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        rest = after;
        if *first != b'%' {
            bytes.push(*first);
            continue;
        }
        let (digits, after) = rest.split_at_checked(2)?;
        bytes.push(u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?);
        rest = after;
    }
    String::from_utf8(bytes).ok()
}

//! Numbers out of buffers, with every offset checked.

use std::collections::HashMap;
use std::ops::{Deref, Range};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use base64::Engine as _;

use super::{Accessor, Document, SparsePart};
use crate::boundary::{format, mtl};

/// Numbers that may be decoded whatever the size of the file: room for instances, and accessors that are zero by default.
/// A tenth would refuse scenes with many instances; ten times, a file of a few lines could take gigabytes.
const FREE_NUMBERS: usize = 16 << 20;

/// The buffers of a document, loaded when first asked for.
pub(super) struct Buffers<'a> {
    folder: PathBuf,
    document: &'a Document,
    binary: Option<&'a [u8]>,
    loaded: HashMap<&'a str, Rc<Vec<u8>>>,
    /// How many more numbers may be decoded: instances and defaults make more of a file than it holds.
    budget: usize,
}

/// Bytes within the file itself, or within one that it refers to.
pub(super) enum Bytes<'a> {
    /// Of the GLB's own chunk.
    Own(&'a [u8]),
    /// A range, in bounds, of another file or a data URI.
    Other(Rc<Vec<u8>>, Range<usize>),
}

impl Deref for Bytes<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Own(bytes) => bytes,
            Self::Other(bytes, range) => bytes.get(range.clone()).unwrap_or_default(),
        }
    }
}

/// `[count * width]` numbers of an accessor.
pub(super) struct Numbers {
    /// How many for each element.
    pub width: usize,
    /// Normalized integers are divided already.
    pub values: Vec<f64>,
}

impl Numbers {
    /// How many elements.
    pub fn count(&self) -> usize {
        self.values.len() / self.width
    }
}

impl<'a> Buffers<'a> {
    /// None loaded yet.
    pub fn new(path: &Path, document: &'a Document, binary: Option<&'a [u8]>, file_size: usize) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        Self {
            folder,
            document,
            binary,
            loaded: HashMap::new(),
            budget: FREE_NUMBERS.saturating_add(file_size.saturating_mul(16)),
        }
    }

    /// The bytes of a data URI or of a file.
    pub fn resource(&mut self, uri: &'a str) -> Result<Rc<Vec<u8>>, String> {
        if let Some(bytes) = self.loaded.get(uri) {
            return Ok(Rc::clone(bytes));
        }
        let bytes = if let Some(data) = uri.strip_prefix("data:") {
            data_uri(data).ok_or("a data URI in it is malformed; export the scene again")?
        } else {
            let missing = || format!("the file {uri} it refers to is missing; put it beside, or export as GLB");
            let file = mtl::find(&self.folder, &percent_decoded(uri))
                .or_else(|| mtl::find(&self.folder, uri))
                .ok_or_else(missing)?;
            format::load(&file).map_err(|error| error.to_string())?
        };
        self.budget = self.budget.saturating_add(bytes.len().saturating_mul(16));
        let bytes = Rc::new(bytes);
        self.loaded.insert(uri, Rc::clone(&bytes));
        Ok(bytes)
    }

    /// Accounts for numbers, or bytes, that are made of the buffers' content otherwise.
    pub fn spend(&mut self, bytes: usize) -> Result<(), String> {
        self.budget = self.budget.checked_sub(bytes).ok_or("it unfolds to many times its own size, more than can be real; reduce the instances or export the scene again")?;
        Ok(())
    }

    /// The bytes of a buffer view.
    pub fn view(&mut self, index: usize) -> Result<Bytes<'a>, String> {
        let document = self.document;
        let view = document
            .buffer_views
            .get(index)
            .ok_or_else(|| no_such("buffer view", index, document.buffer_views.len()))?;
        let buffer =
            document.buffers.get(view.buffer).ok_or_else(|| no_such("buffer", view.buffer, document.buffers.len()))?;
        let range = view.byte_offset..view.byte_offset.saturating_add(view.byte_length);
        let short = |length: usize| {
            format!(
                "buffer view {index} ends at byte {}, but buffer {} has {length}; get the whole file again",
                range.end, view.buffer
            )
        };
        match &buffer.uri {
            None => {
                let bytes = self
                    .binary
                    .filter(|_| view.buffer == 0)
                    .ok_or_else(|| format!("buffer {} has no content; export the scene again", view.buffer))?;
                bytes.get(range.clone()).map(Bytes::Own).ok_or_else(|| short(bytes.len()))
            }
            Some(uri) => {
                let bytes = self.resource(uri)?;
                if bytes.len() < buffer.byte_length {
                    return Err(format!(
                        "buffer {} should have {} bytes and has {}; get the whole file again",
                        view.buffer,
                        buffer.byte_length,
                        bytes.len()
                    ));
                }
                match bytes.get(range.clone()) {
                    Some(_) => Ok(Bytes::Other(bytes, range)),
                    None => Err(short(bytes.len())),
                }
            }
        }
    }

    /// How many elements an accessor has.
    pub fn count(&self, index: usize) -> Result<usize, String> {
        let accessors = &self.document.accessors;
        accessors.get(index).map(|a| a.count).ok_or_else(|| no_such("accessor", index, accessors.len()))
    }

    /// The numbers of an accessor, sparse ones filled in.
    pub fn numbers(&mut self, index: usize) -> Result<Numbers, String> {
        let document = self.document;
        let accessor =
            document.accessors.get(index).ok_or_else(|| no_such("accessor", index, document.accessors.len()))?;
        let width = match accessor.shape.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            other => return Err(format!("accessor {index} has the unknown type \"{other}\"; export the scene again")),
        };
        let total = accessor.count.saturating_mul(width);
        self.budget = self.budget.checked_sub(total).ok_or_else(|| {
            format!("accessor {index} claims {} elements, more than can be real; reduce the instances or export the scene again", accessor.count)
        })?;
        let mut values = match accessor.buffer_view {
            Some(view) => self.decode(index, accessor, view, width)?,
            None => vec![0.0; total],
        };
        if let Some(sparse) = &accessor.sparse {
            self.budget = self
                .budget
                .checked_sub(sparse.count.saturating_mul(width))
                .ok_or("its sparse accessors claim more than can be real")?;
            let part = |part: &SparsePart, component_type: u32, normalized: bool| Accessor {
                byte_offset: part.byte_offset,
                component_type,
                normalized,
                count: sparse.count,
                ..Accessor::default()
            };
            let indices = part(&sparse.indices, sparse.indices.component_type, false);
            let indices = self.decode(index, &indices, sparse.indices.buffer_view, 1)?;
            let replacements = part(&sparse.values, accessor.component_type, accessor.normalized);
            let replacements = self.decode(index, &replacements, sparse.values.buffer_view, width)?;
            for (&at, replacement) in indices.iter().zip(replacements.chunks_exact(width)) {
                let at = at as usize;
                let slot = at.checked_mul(width).and_then(|start| values.get_mut(start..start + width));
                slot.ok_or_else(|| {
                    format!("accessor {index} replaces element {at} of {}; export the scene again", accessor.count)
                })?
                .copy_from_slice(replacement);
            }
        }
        Ok(Numbers { width, values })
    }

    /// The numbers a dense accessor describes.
    fn decode(&mut self, index: usize, accessor: &Accessor, view: usize, width: usize) -> Result<Vec<f64>, String> {
        type Decode = fn(&[u8]) -> f64;
        let (size, largest, decode): (usize, f64, Decode) = match accessor.component_type {
            5120 => (1, 127.0, |b| f64::from(b[0] as i8)),
            5121 => (1, 255.0, |b| f64::from(b[0])),
            5122 => (2, 32767.0, |b| f64::from(i16::from_le_bytes([b[0], b[1]]))),
            5123 => (2, 65535.0, |b| f64::from(u16::from_le_bytes([b[0], b[1]]))),
            5125 => (4, f64::from(u32::MAX), |b| f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
            5126 => (4, 1.0, |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
            other => {
                return Err(format!("accessor {index} has the unknown component type {other}; export the scene again"));
            }
        };
        let bytes = self.view(view)?;
        let element = size * width;
        let stride = self.document.buffer_views[view]
            .byte_stride
            .filter(|&s| s >= element && accessor.count > 0)
            .unwrap_or(element);
        let needed = match accessor.count {
            0 => 0,
            count => (count - 1).saturating_mul(stride).saturating_add(element).saturating_add(accessor.byte_offset),
        };
        if needed > bytes.len() {
            return Err(format!(
                "accessor {index} needs {needed} bytes of buffer view {view}, which has {}; get the whole file again",
                bytes.len()
            ));
        }
        let divisor = if accessor.normalized { largest } else { 1.0 };
        let mut values = Vec::with_capacity(accessor.count * width);
        for i in 0..accessor.count {
            let at = accessor.byte_offset + i * stride;
            // The rule of the specification: signed normalized integers do not go below -1.
            let number = |b: &[u8]| if accessor.normalized { (decode(b) / divisor).max(-1.0) } else { decode(b) };
            values.extend(bytes[at..at + element].chunks_exact(size).map(number));
        }
        Ok(values)
    }
}

/// A sentence about an index that is out of range.
pub(super) fn no_such(what: &str, index: usize, count: usize) -> String {
    format!("it refers to {what} {index}, but there are {count}; export the scene again")
}

/// What follows `data:`.
fn data_uri(data: &str) -> Option<Vec<u8>> {
    let (head, body) = data.split_once(',')?;
    if head.ends_with(";base64") {
        let lenient = base64::engine::GeneralPurposeConfig::new()
            .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent);
        let engine = base64::engine::GeneralPurpose::new(&base64::alphabet::STANDARD, lenient);
        engine.decode(percent_decoded(body).trim()).ok()
    } else {
        Some(percent_decoded(body).into_bytes())
    }
}

/// `%20` is a space; what is no such escape stays.
pub(super) fn percent_decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let hex = bytes
            .get(at + 1..at + 3)
            .and_then(|h| std::str::from_utf8(h).ok())
            .and_then(|h| u8::from_str_radix(h, 16).ok());
        match (bytes[at], hex) {
            (b'%', Some(byte)) => {
                out.push(byte);
                at += 3;
            }
            (byte, _) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

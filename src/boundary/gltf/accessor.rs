//! Numbers out of buffers: the `gltf` crate decodes, once it is sure that it stays within them.
//!
//! Through its accessors rather than its reader of primitives, which panics on component types that the specification does not
//! allow (joints in floating point) and takes those of `KHR_mesh_quantization` for single precision.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use base64::Engine as _;
use gltf::accessor::sparse::{IndexType, Sparse};
use gltf::accessor::util::{ItemIter, SparseIndicesIter};
use gltf::accessor::{DataType, Dimensions, Item, Iter};
use gltf::buffer::{Source, View};
use gltf::json::validation::Checked;
use gltf::{Accessor, Buffer};

use crate::boundary::{format, mtl};

/// Numbers that may be decoded whatever the size of the file: room for instances, and accessors that are zero by default.
/// A tenth would refuse scenes with many instances; ten times, a file of a few lines could take gigabytes.
const FREE_NUMBERS: usize = 16 << 20;

/// The buffers of a document, loaded when first asked for.
pub(super) struct Buffers<'a> {
    folder: PathBuf,
    document: &'a gltf::Document,
    binary: Option<&'a [u8]>,
    loaded: HashMap<&'a str, Vec<u8>>,
    /// How many more numbers may be decoded: instances and defaults make more of a file than it holds.
    budget: usize,
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
    pub fn new(path: &Path, document: &'a gltf::Document, binary: Option<&'a [u8]>, file_size: usize) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let budget = FREE_NUMBERS.saturating_add(file_size.saturating_mul(16));
        Self { folder, document, binary, loaded: HashMap::new(), budget }
    }

    /// The bytes of a data URI or of a file.
    pub fn resource(&mut self, uri: &'a str) -> Result<&[u8], String> {
        if !self.loaded.contains_key(uri) {
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
            self.loaded.insert(uri, bytes);
        }
        Ok(&self.loaded[uri])
    }

    /// Accounts for numbers, or bytes, that are made of the buffers' content otherwise.
    pub fn spend(&mut self, bytes: usize) -> Result<(), String> {
        self.budget = self.budget.checked_sub(bytes).ok_or("it unfolds to many times its own size, more than can be real; reduce the instances or export the scene again")?;
        Ok(())
    }

    /// The bytes of a buffer view.
    pub fn view(&mut self, view: &View<'a>) -> Result<&[u8], String> {
        let buffer = view.buffer();
        let index = buffer.index();
        let bytes = match buffer.source() {
            Source::Bin => {
                let chunk = self.binary.filter(|_| index == 0);
                chunk.ok_or_else(|| format!("buffer {index} has no content; export the scene again"))?
            }
            Source::Uri(uri) => self.resource(uri)?,
        };
        let short = |what: String, length: usize| {
            format!("{what} byte {length}, but buffer {index} has {}; get the whole file again", bytes.len())
        };
        if matches!(buffer.source(), Source::Uri(_)) && bytes.len() < buffer.length() {
            return Err(short("it says that it ends at".into(), buffer.length()));
        }
        let end = view.offset().saturating_add(view.length());
        bytes.get(view.offset()..end).ok_or_else(|| short(format!("buffer view {} ends at", view.index()), end))
    }

    /// The bytes of a buffer that [`Self::view`] has loaded, as the crate asks for them.
    fn loaded(&self, buffer: &Buffer<'a>) -> Option<&[u8]> {
        match buffer.source() {
            Source::Bin => self.binary.filter(|_| buffer.index() == 0),
            Source::Uri(uri) => self.loaded.get(uri).map(Vec::as_slice),
        }
    }

    /// What the elements of an accessor are.
    ///
    /// # Errors
    ///
    /// Types that glTF does not have; the crate panics when asked for them.
    pub fn shape(&self, accessor: &Accessor<'a>) -> Result<Dimensions, String> {
        let index = accessor.index();
        let said = &self.document.as_json().accessors[index];
        let unknown = |what: &str| format!("accessor {index} has an unknown {what}; export the scene again");
        let Checked::Valid(shape) = said.type_ else { return Err(unknown("type")) };
        let of_indices = said.sparse.as_ref().map(|sparse| sparse.indices.component_type);
        if matches!(said.component_type, Checked::Invalid) || matches!(of_indices, Some(Checked::Invalid)) {
            return Err(unknown("component type"));
        }
        Ok(shape)
    }

    /// The numbers of an accessor, sparse ones filled in.
    pub fn numbers(&mut self, accessor: &Accessor<'a>) -> Result<Numbers, String> {
        let index = accessor.index();
        let width = self.shape(accessor)?.multiplicity();
        let count = accessor.count();
        let total = count.saturating_mul(width);
        self.budget = self.budget.checked_sub(total).ok_or_else(|| {
            format!("accessor {index} claims {count} elements, more than can be real; reduce the instances or export the scene again")
        })?;
        if count == 0 {
            return Ok(Numbers { width, values: Vec::new() });
        }
        if let Some(view) = accessor.view() {
            self.check(index, &view, accessor.offset(), count, accessor.size())?;
        }
        if let Some(sparse) = accessor.sparse() {
            self.check_sparse(accessor, &sparse)?;
        }
        let get = |buffer: Buffer<'a>| self.loaded(&buffer);
        let is_normalized = accessor.normalized();
        // The rule of the specification: signed normalized integers do not go below -1.
        let scaled = |value: f64, one: f64| if is_normalized { (value / one).max(-1.0) } else { value };
        let values = match accessor.data_type() {
            DataType::I8 => decode(accessor, get, |v: i8| scaled(v.into(), 127.0)),
            DataType::U8 => decode(accessor, get, |v: u8| scaled(v.into(), 255.0)),
            DataType::I16 => decode(accessor, get, |v: i16| scaled(v.into(), 32767.0)),
            DataType::U16 => decode(accessor, get, |v: u16| scaled(v.into(), 65535.0)),
            DataType::U32 => decode(accessor, get, |v: u32| scaled(v.into(), u32::MAX.into())),
            DataType::F32 => decode(accessor, get, |v: f32| v.into()),
        };
        // An accessor without a view is all zeros.
        Ok(Numbers { width, values: values.unwrap_or_else(|| vec![0.0; total]) })
    }

    /// Whether so many elements of a size lie within a view: the crate trusts offsets, counts and strides.
    fn check(
        &mut self,
        accessor: usize,
        view: &View<'a>,
        offset: usize,
        count: usize,
        size: usize,
    ) -> Result<(), String> {
        let stride = view.stride().unwrap_or(size);
        let view_index = view.index();
        let there = self.view(view)?.len();
        if stride < size {
            return Err(format!(
                "accessor {accessor} has elements of {size} bytes, but buffer view {view_index} one every {stride}; export the scene again"
            ));
        }
        let needed = (count - 1).saturating_mul(stride).saturating_add(size).saturating_add(offset);
        if needed > there {
            return Err(format!(
                "accessor {accessor} needs {needed} bytes of buffer view {view_index}, which has {there}; get the whole file again"
            ));
        }
        Ok(())
    }

    /// Whether the replaced elements of an accessor exist and come in order: the crate passes over others in silence.
    fn check_sparse(&mut self, accessor: &Accessor<'a>, sparse: &Sparse<'a>) -> Result<(), String> {
        let (index, count) = (accessor.index(), sparse.count());
        self.budget = self
            .budget
            .checked_sub(count.saturating_mul(accessor.size()))
            .ok_or("its sparse accessors claim more than can be real; export the scene again")?;
        let (indices, values) = (sparse.indices(), sparse.values());
        let size = indices.index_type().size();
        self.check(index, &values.view(), values.offset(), count, accessor.size())?;
        self.check(index, &indices.view(), indices.offset(), count, size)?;
        let view = indices.view();
        let bytes = &self.view(&view)?[indices.offset()..];
        let stride = view.stride().unwrap_or(size);
        let replaced = match indices.index_type() {
            IndexType::U8 => SparseIndicesIter::U8(ItemIter::new(bytes, stride)),
            IndexType::U16 => SparseIndicesIter::U16(ItemIter::new(bytes, stride)),
            IndexType::U32 => SparseIndicesIter::U32(ItemIter::new(bytes, stride)),
        };
        let mut next = 0;
        for at in replaced.take(count).map(|at| at as usize) {
            if at < next || at >= accessor.count() {
                return Err(format!(
                    "accessor {index} replaces element {at} of {}, after element {}; export the scene again",
                    accessor.count(),
                    next
                ));
            }
            next = at + 1;
        }
        Ok(())
    }
}

/// All numbers of a checked accessor; `None` without any bytes.
fn decode<'a, 's, T: Item + Copy>(
    accessor: &Accessor<'a>,
    get: impl Clone + Fn(Buffer<'a>) -> Option<&'s [u8]>,
    number: impl Fn(T) -> f64,
) -> Option<Vec<f64>> {
    let accessor = accessor.clone();
    Some(match accessor.dimensions() {
        Dimensions::Scalar => Iter::<T>::new(accessor, get)?.map(number).collect(),
        Dimensions::Vec2 => Iter::<[T; 2]>::new(accessor, get)?.flatten().map(number).collect(),
        Dimensions::Vec3 => Iter::<[T; 3]>::new(accessor, get)?.flatten().map(number).collect(),
        Dimensions::Vec4 => Iter::<[T; 4]>::new(accessor, get)?.flatten().map(number).collect(),
        Dimensions::Mat2 => Iter::<[[T; 2]; 2]>::new(accessor, get)?.flatten().flatten().map(number).collect(),
        Dimensions::Mat3 => Iter::<[[T; 3]; 3]>::new(accessor, get)?.flatten().flatten().map(number).collect(),
        Dimensions::Mat4 => Iter::<[[T; 4]; 4]>::new(accessor, get)?.flatten().flatten().map(number).collect(),
    })
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

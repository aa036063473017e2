//! The tables of a PLY: every element and property, known or not, text or binary.
//!
//! `serde-ply` reads header and rows, into columns: properties keep their order and type to be written again. A header's claims
//! are held against the length of the file before; nothing is reserved by them.
//!
//! Why not `ply-rs-bw`: it refuses what writers write. A text with `nan` or `.5` among its numbers, a property named
//! `velocity.x`, or a comment in Latin-1 (`# größer`) is an error for the whole file.

use std::fmt::{self, Display, Write as _};
use std::io::Read as _;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_ply::{PlyFormat, PlyReader, PropertyType, ScalarType};

/// How the numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// Text.
    Ascii,
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    /// `char`.
    I8,
    /// `uchar`.
    U8,
    /// `short`.
    I16,
    /// `ushort`.
    U16,
    /// `int`.
    I32,
    /// `uint`.
    U32,
    /// `float`.
    F32,
    /// `double`.
    F64,
}

/// A whole PLY.
#[derive(Debug, Clone)]
pub(crate) struct PlyTable {
    /// How its numbers are written.
    pub encoding: Encoding,
    /// `comment` and `obj_info` lines, whole.
    pub comments: Vec<String>,
    /// Its elements, in order.
    pub elements: Vec<Element>,
}

/// `element vertex 8`.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    /// `vertex`, `face`, …
    pub name: String,
    /// Rows.
    pub count: usize,
    /// Columns.
    pub properties: Vec<Property>,
}

/// `property float x`, `property list uchar int vertex_indices`.
#[derive(Debug, Clone)]
pub(crate) struct Property {
    /// Its name.
    pub name: String,
    /// The type of its numbers.
    pub scalar: Scalar,
    /// For a list, the type of the length.
    pub length: Option<Scalar>,
    /// `[count]`, or all lists one after the other. A double holds each of the types exactly.
    pub values: Vec<f64>,
    /// For a list, `[count + 1]`.
    pub starts: Vec<usize>,
}

impl Scalar {
    fn name(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uchar",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The largest value, for colours; `None` for floating point.
    pub fn largest(self) -> Option<f64> {
        match self {
            Self::F32 | Self::F64 => None,
            Self::I8 => Some(f64::from(i8::MAX)),
            Self::U8 => Some(f64::from(u8::MAX)),
            Self::I16 => Some(f64::from(i16::MAX)),
            Self::U16 => Some(f64::from(u16::MAX)),
            Self::I32 => Some(f64::from(i32::MAX)),
            Self::U32 => Some(f64::from(u32::MAX)),
        }
    }

    /// Appends a number. Casts saturate; the values came from this type.
    fn encode(self, value: f64, encoding: Encoding, out: &mut Vec<u8>) {
        let start = out.len();
        match self {
            Self::I8 => out.push(value as i8 as u8),
            Self::U8 => out.push(value as u8),
            Self::I16 => out.extend((value as i16).to_le_bytes()),
            Self::U16 => out.extend((value as u16).to_le_bytes()),
            Self::I32 => out.extend((value as i32).to_le_bytes()),
            Self::U32 => out.extend((value as u32).to_le_bytes()),
            Self::F32 => out.extend((value as f32).to_le_bytes()),
            Self::F64 => out.extend(value.to_le_bytes()),
        }
        if encoding == Encoding::Big {
            out[start..].reverse();
        }
    }
}

impl From<ScalarType> for Scalar {
    fn from(scalar: ScalarType) -> Self {
        match scalar {
            ScalarType::I8 => Self::I8,
            ScalarType::U8 => Self::U8,
            ScalarType::I16 => Self::I16,
            ScalarType::U16 => Self::U16,
            ScalarType::I32 => Self::I32,
            ScalarType::U32 => Self::U32,
            ScalarType::F32 => Self::F32,
            ScalarType::F64 => Self::F64,
        }
    }
}

impl PlyTable {
    /// Reads header and rows.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let (head, body, comments) = header(bytes)?;
        let reader = PlyReader::from_reader(head.as_bytes()).map_err(|why| {
            format!("its header is broken: {}; repair it or export the mesh again", short(&plain(why)))
        })?;
        let mut table = Self::claimed(&reader, comments);
        table.check_claims(body.len())?;
        // The last number of a text may lack its space.
        let end: &[u8] = if table.encoding == Encoding::Ascii { b"\n" } else { b"" };
        let mut reader = PlyReader::from_reader(head.as_bytes().chain(body).chain(end))
            .map_err(|why| format!("{}; repair it", short(&plain(why))))?;
        reader.deserialize_map(Elements(&mut table.elements)).map_err(plain)?;
        Ok(table)
    }

    /// The elements a header announces, still empty.
    fn claimed<R: std::io::BufRead>(reader: &PlyReader<R>, comments: Vec<String>) -> Self {
        let header = reader.header();
        let encoding = match header.format {
            PlyFormat::Ascii => Encoding::Ascii,
            PlyFormat::BinaryLittleEndian => Encoding::Little,
            PlyFormat::BinaryBigEndian => Encoding::Big,
        };
        let property = |property: &serde_ply::PlyProperty| {
            let (length, scalar) = match property.property_type {
                PropertyType::Scalar(scalar) => (None, scalar),
                PropertyType::List { count_type, data_type } => (Some(count_type.into()), data_type),
            };
            let starts = if length.is_some() { vec![0] } else { Vec::new() };
            Property { name: property.name.clone(), scalar: scalar.into(), length, values: Vec::new(), starts }
        };
        let element = |element: &serde_ply::ElementDef| Element {
            name: element.name.clone(),
            count: element.count,
            properties: element.properties.iter().map(property).collect(),
        };
        Self { encoding, comments, elements: header.elem_defs.iter().map(element).collect() }
    }

    /// Whether so many rows can be in so many bytes.
    fn check_claims(&self, bytes: usize) -> Result<(), String> {
        // The last number of a text may lack its space.
        let mut left = bytes.saturating_add(1);
        for element in &self.elements {
            let smallest: usize = element.properties.iter().map(|p| p.length.unwrap_or(p.scalar).bytes()).sum();
            let least = if self.encoding == Encoding::Ascii { 2 * element.properties.len() } else { smallest };
            left = left.checked_sub(element.count.saturating_mul(least)).ok_or_else(|| {
                let (count, name) = (element.count, short(&element.name));
                format!(
                    "the header claims {count} {name} rows, but only {} bytes are left; get the whole file again",
                    left.saturating_sub(1)
                )
            })?;
        }
        Ok(())
    }

    /// An element by name.
    pub fn element(&self, name: &str) -> Option<&Element> {
        self.elements.iter().find(|e| e.name == name)
    }

    /// The file.
    pub fn write(&self) -> Vec<u8> {
        let encoding = match self.encoding {
            Encoding::Ascii => "ascii",
            Encoding::Little => "binary_little_endian",
            Encoding::Big => "binary_big_endian",
        };
        let mut head = format!("ply\nformat {encoding} 1.0\n");
        for comment in &self.comments {
            let _ = writeln!(head, "{comment}");
        }
        for element in &self.elements {
            let _ = writeln!(head, "element {} {}", element.name, element.count);
            for property in &element.properties {
                let _ = match property.length {
                    Some(length) => {
                        writeln!(head, "property list {} {} {}", length.name(), property.scalar.name(), property.name)
                    }
                    None => writeln!(head, "property {} {}", property.scalar.name(), property.name),
                };
            }
        }
        head.push_str("end_header\n");
        let mut out = head.into_bytes();
        for element in &self.elements {
            element.write(self.encoding, &mut out);
        }
        out
    }
}

impl Element {
    /// A column by name.
    pub fn property(&self, name: &str) -> Option<&Property> {
        self.properties.iter().find(|p| p.name == name)
    }

    fn write(&self, encoding: Encoding, out: &mut Vec<u8>) {
        for row in 0..self.count {
            let line = out.len();
            for property in &self.properties {
                if let Some(length) = property.length {
                    put(length, property.list(row).len() as f64, encoding, out);
                }
                for &value in property.row(row) {
                    put(property.scalar, value, encoding, out);
                }
            }
            if encoding == Encoding::Ascii {
                out.truncate(if out.len() > line { out.len() - 1 } else { line });
                out.push(b'\n');
            }
        }
    }
}

fn put(scalar: Scalar, value: f64, encoding: Encoding, out: &mut Vec<u8>) {
    match (encoding, scalar) {
        (Encoding::Ascii, Scalar::F32) => out.extend_from_slice(format!("{} ", value as f32).as_bytes()),
        (Encoding::Ascii, _) => out.extend_from_slice(format!("{value} ").as_bytes()),
        _ => scalar.encode(value, encoding, out),
    }
}

impl Property {
    /// A column of plain numbers.
    pub fn column(name: &str, scalar: Scalar, values: Vec<f64>) -> Self {
        Self { name: name.into(), scalar, length: None, values, starts: Vec::new() }
    }

    /// The list of one row; empty for a plain number.
    pub fn list(&self, row: usize) -> &[f64] {
        match (self.starts.get(row), self.starts.get(row + 1)) {
            (Some(&from), Some(&to)) => self.values.get(from..to).unwrap_or_default(),
            _ => &[],
        }
    }

    fn row(&self, row: usize) -> &[f64] {
        if self.length.is_some() { self.list(row) } else { self.values.get(row..=row).unwrap_or_default() }
    }
}

/// The header with its lines in order, the rows after it, and `comment` and `obj_info` lines.
///
/// The crate wants UTF-8 and lines that end as on Unix; comments come in any encoding, and from any system.
fn header(bytes: &[u8]) -> Result<(String, &[u8], Vec<String>), String> {
    let (mut head, mut comments) = (String::new(), Vec::new());
    let mut at = 0;
    while let Some(end) = bytes[at..].iter().position(|&b| b == b'\n' || b == b'\r') {
        let line = String::from_utf8_lossy(&bytes[at..at + end]);
        at += end + if bytes[at + end..].starts_with(b"\r\n") { 2 } else { 1 };
        match line.split_whitespace().next() {
            Some("comment" | "obj_info") => comments.push(line.into_owned()),
            Some("end_header") => return Ok((head + "end_header\n", &bytes[at..], comments)),
            _ => {
                head.push_str(&line);
                head.push('\n');
            }
        }
    }
    Err("the header has no end_header; get the whole file again".into())
}

/// What the crate says, without saying each time that it says it.
fn plain(why: impl Display) -> String {
    let why = why.to_string();
    let why = why.trim_start_matches("Error while deserializing ply: ");
    if why == "failed to fill whole buffer" { "the file ends".into() } else { why.into() }
}

/// The start of something the file says, which may be of any length.
fn short(text: &str) -> String {
    text.chars().take(60).collect()
}

/// Reads all elements.
struct Elements<'t>(&'t mut [Element]);

impl<'de> Visitor<'de> for Elements<'_> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str("elements")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        for element in self.0 {
            map.next_key::<IgnoredAny>()?;
            map.next_value_seed(Rows(element))?;
        }
        Ok(())
    }
}

/// Reads the rows of one element.
struct Rows<'t>(&'t mut Element);

impl<'de> DeserializeSeed<'de> for Rows<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Rows<'_> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str("rows")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<(), A::Error> {
        let Element { name, count, properties } = self.0;
        // Rows of nothing end at once, however many are claimed.
        for row in 0..if properties.is_empty() { 0 } else { *count } {
            rows.next_element_seed(Row(properties)).map_err(|why| {
                A::Error::custom(format!(
                    "{} {row}, {}; get the whole file again or repair that row",
                    short(name),
                    plain(why)
                ))
            })?;
        }
        Ok(())
    }
}

/// Reads one row.
struct Row<'t>(&'t mut [Property]);

impl<'de> DeserializeSeed<'de> for Row<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Row<'_> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str("properties")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        for property in self.0 {
            map.next_key::<IgnoredAny>()?;
            map.next_value_seed(&mut *property).map_err(|why| {
                A::Error::custom(format!("property {}: {}", short(&property.name), short(&plain(why))))
            })?;
        }
        Ok(())
    }
}

impl<'de> DeserializeSeed<'de> for &mut Property {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

/// Appends one number, or one list.
impl<'de> Visitor<'de> for &mut Property {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str("numbers")
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<(), E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<(), E> {
        self.visit_f64(value as f64)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<(), E> {
        self.values.push(value);
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        while let Some(value) = list.next_element()? {
            self.values.push(value);
        }
        self.starts.push(self.values.len());
        Ok(())
    }
}

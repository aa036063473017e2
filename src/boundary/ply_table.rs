//! The tables of a PLY: every element and property, known or not, text or binary.
//!
//! Own code rather than a crate: properties must keep their order and type to be written again, and a header's claims must
//! not be believed before the bytes are there. Nothing is reserved by a claim; rows are read until they end.

use std::fmt::Write as _;

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
    fn named(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

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

    /// A number from at most eight bytes, least significant first.
    fn decode(self, bytes: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = bytes;
        match self {
            Self::I8 => f64::from(a as i8),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(bytes),
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

/// Where the next number comes from.
struct Numbers<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
}

impl Numbers<'_> {
    fn next(&mut self, scalar: Scalar) -> Result<f64, String> {
        if self.encoding == Encoding::Ascii {
            let start = self.bytes.iter().position(|b| !b.is_ascii_whitespace()).ok_or("the file ends")?;
            let rest = &self.bytes[start..];
            let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
            let word = String::from_utf8_lossy(&rest[..end]);
            self.bytes = &rest[end..];
            let value: f64 =
                word.parse().map_err(|_| format!("\"{}\" is no number", word.chars().take(20).collect::<String>()))?;
            return Ok(if scalar == Scalar::F32 { f64::from(value as f32) } else { value });
        }
        let size = scalar.bytes();
        let (number, rest) = self.bytes.split_at_checked(size).ok_or("the file ends")?;
        self.bytes = rest;
        let mut eight = [0; 8];
        eight[..size].copy_from_slice(number);
        if self.encoding == Encoding::Big {
            eight[..size].reverse();
        }
        Ok(scalar.decode(eight))
    }
}

impl PlyTable {
    /// Reads header and rows.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let (mut table, body) = header(bytes)?;
        let mut numbers = Numbers { encoding: table.encoding, bytes: &bytes[body..] };
        for element in &mut table.elements {
            element.read(&mut numbers)?;
        }
        Ok(table)
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

    fn read(&mut self, numbers: &mut Numbers) -> Result<(), String> {
        let smallest: usize = self.properties.iter().map(|p| p.length.unwrap_or(p.scalar).bytes()).sum();
        let least = if numbers.encoding == Encoding::Ascii { 2 * self.properties.len() } else { smallest };
        // The last number of a text may lack its space.
        if self.count.saturating_mul(least) > numbers.bytes.len() + 1 {
            let left = numbers.bytes.len();
            return Err(format!(
                "the header claims {} {} rows, but only {left} bytes are left; get the whole file again",
                self.count, self.name
            ));
        }
        if self.properties.is_empty() {
            return Ok(());
        }
        for row in 0..self.count {
            for property in &mut self.properties {
                property.read(numbers).map_err(|why| {
                    format!(
                        "{} {row}, property {}: {why}; get the whole file again or repair that row",
                        self.name, property.name
                    )
                })?;
            }
        }
        Ok(())
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

    fn read(&mut self, numbers: &mut Numbers) -> Result<(), String> {
        let Some(length) = self.length else {
            self.values.push(numbers.next(self.scalar)?);
            return Ok(());
        };
        let length = numbers.next(length)?;
        if !(0.0..=f64::from(u32::MAX)).contains(&length) || length.fract() != 0.0 {
            return Err(format!("a list cannot have {length} entries"));
        }
        for _ in 0..length as usize {
            self.values.push(numbers.next(self.scalar)?);
        }
        self.starts.push(self.values.len());
        Ok(())
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

/// The header, and where the rows start.
fn header(bytes: &[u8]) -> Result<(PlyTable, usize), String> {
    let mut table = PlyTable { encoding: Encoding::Ascii, comments: Vec::new(), elements: Vec::new() };
    let mut at = 0;
    let mut number = 0;
    while let Some(end) = bytes[at..].iter().position(|&b| b == b'\n' || b == b'\r') {
        let line = String::from_utf8_lossy(&bytes[at..at + end]);
        at += end + if bytes[at + end..].starts_with(b"\r\n") { 2 } else { 1 };
        number += 1;
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["ply"] | [] => {}
            ["comment" | "obj_info", ..] => table.comments.push(line.into_owned()),
            ["format", "ascii", _] => table.encoding = Encoding::Ascii,
            ["format", "binary_little_endian", _] => table.encoding = Encoding::Little,
            ["format", "binary_big_endian", _] => table.encoding = Encoding::Big,
            ["element", name, count] => {
                let count = count.parse().map_err(|_| {
                    format!("line {number}: \"{count}\" is no number of {name} rows; repair the header")
                })?;
                table.elements.push(Element { name: (*name).into(), count, properties: Vec::new() });
            }
            ["property", types @ .., name] => {
                let unknown =
                    || format!("line {number}: \"{line}\" has a type that PLY does not know; repair the header");
                let (length, scalar) = match types {
                    ["list", length, scalar] => (Some(Scalar::named(length).ok_or_else(unknown)?), scalar),
                    [scalar] => (None, scalar),
                    _ => return Err(unknown()),
                };
                let scalar = Scalar::named(scalar).ok_or_else(unknown)?;
                let element = table
                    .elements
                    .last_mut()
                    .ok_or_else(|| format!("line {number}: a property before any element; repair the header"))?;
                let starts = if length.is_some() { vec![0] } else { Vec::new() };
                element.properties.push(Property { name: (*name).into(), scalar, length, values: Vec::new(), starts });
            }
            ["end_header"] => return Ok((table, at)),
            _ => {
                return Err(format!(
                    "line {number}: \"{}\" is no line of a PLY header; repair it",
                    line.chars().take(40).collect::<String>()
                ));
            }
        }
    }
    Err("the header has no end_header; get the whole file again".into())
}

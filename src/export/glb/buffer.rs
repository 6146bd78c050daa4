//! The one buffer of a GLB: where things lie in it, and writing them there.

use std::ops::Range;

use super::document::{self as json, Accessor, BufferView, Document};
use crate::geometry::Bounds;

/// One attribute of a vertex.
#[derive(Clone, Copy)]
pub struct Attribute {
    /// Its name in the file.
    pub name: &'static str,
    /// Component type of glTF.
    pub component: u32,
    /// Whether integers stand for fractions.
    pub normalized: bool,
    /// `SCALAR`, `VEC3`, ...
    pub shape: &'static str,
    /// Bytes; a multiple of 4.
    pub size: u32,
}

impl Attribute {
    /// Of 32-bit floats.
    pub const fn floats(name: &'static str, count: u32) -> Self {
        let shape = match count {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            _ => "VEC4",
        };
        Self { name, component: json::F32, normalized: false, shape, size: 4 * count }
    }
}

/// Where the vertices and the indices of one primitive lie.
pub struct Slot {
    /// Bytes of the vertices, then of the indices.
    pub bytes: Range<usize>,
    /// How many of these are vertices.
    pub vertex_bytes: usize,
    /// Bytes per vertex.
    pub stride: usize,
    /// Its attributes, for the primitive.
    pub attributes: Vec<(&'static str, u32)>,
    /// The accessor of its indices.
    pub indices: u32,
}

/// The plan of the buffer; it is allocated when everything has its place.
#[derive(Default)]
pub struct Plan {
    /// Bytes given away so far.
    length: u64,
}

impl Plan {
    /// A place for `vertices` interleaved vertices, the first attribute of which is the position, and for `indices`.
    pub fn primitive(
        &mut self,
        document: &mut Document,
        attributes: &[Attribute],
        vertices: u64,
        indices: u64,
    ) -> Slot {
        let stride: u32 = attributes.iter().map(|a| a.size).sum();
        let (vertex_bytes, index_bytes) = (vertices * u64::from(stride), indices * 4);
        let start = self.length;
        let mut view = |length, stride, target| {
            document.buffer_views.push(BufferView {
                buffer: 0,
                byte_offset: self.length,
                byte_length: length,
                byte_stride: stride,
                target: Some(target),
            });
            self.length += length;
            document.buffer_views.len() as u32 - 1
        };
        let vertex_view = view(vertex_bytes, Some(stride), json::VERTICES);
        let index_view = view(index_bytes, None, json::INDICES);
        let mut accessor = |buffer_view, byte_offset, component_type, normalized, count, shape| {
            let (min, max, sparse, buffer_view) = (None, None, None, Some(buffer_view));
            let accessor =
                Accessor { buffer_view, byte_offset, component_type, normalized, count, shape, min, max, sparse };
            document.accessors.push(accessor);
            document.accessors.len() as u32 - 1
        };
        let mut offset = 0;
        let attributes: Vec<_> = attributes
            .iter()
            .map(|a| {
                let index = accessor(vertex_view, offset, a.component, a.normalized, vertices, a.shape);
                offset += u64::from(a.size);
                (a.name, index)
            })
            .collect();
        let indices = accessor(index_view, 0, json::U32, false, indices, "SCALAR");
        // Until the bounds are known, the longest text that they can have keeps their place.
        let longest = glam::DVec3::splat(-f64::MIN_POSITIVE);
        if let Some(accessor) = attributes.first().and_then(|&(_, i)| document.accessors.get_mut(i as usize)) {
            (accessor.min, accessor.max) = (Some(longest.to_array().into()), Some(longest.to_array().into()));
        }
        Slot {
            bytes: start as usize..self.length as usize,
            vertex_bytes: vertex_bytes as usize,
            stride: stride as usize,
            attributes,
            indices,
        }
    }

    /// A place for a file in the file, such as a picture: (its bytes, its buffer view).
    pub fn blob(&mut self, document: &mut Document, length: usize) -> (Range<usize>, u32) {
        self.aimed(document, length, None)
    }

    /// The same for what a graphics card is to take in that role (`VERTICES`, `INDICES`).
    pub fn aimed(&mut self, document: &mut Document, length: usize, target: Option<u32>) -> (Range<usize>, u32) {
        let start = self.length;
        document.buffer_views.push(BufferView {
            buffer: 0,
            byte_offset: start,
            byte_length: length as u64,
            byte_stride: None,
            target,
        });
        self.length += (length as u64).next_multiple_of(4);
        (start as usize..start as usize + length, document.buffer_views.len() as u32 - 1)
    }

    /// Bytes of the whole buffer.
    pub fn length(&self) -> u64 {
        self.length
    }
}

impl Slot {
    /// Tells the file the bounds of the positions.
    pub fn set_bounds(&self, document: &mut Document, bounds: Bounds) {
        if let Some((_, index)) = self.attributes.first() {
            let accessor = &mut document.accessors[*index as usize];
            accessor.min = Some(bounds.min.as_dvec3().to_array().into());
            accessor.max = Some(bounds.max.as_dvec3().to_array().into());
        }
    }
}

/// Writes little-endian numbers one after the other into a slice.
pub struct Pen<'a>(pub &'a mut [u8]);

impl Pen<'_> {
    /// Some bytes.
    pub fn bytes<const N: usize>(&mut self, bytes: [u8; N]) {
        if let Some((place, rest)) = std::mem::take(&mut self.0).split_first_chunk_mut() {
            *place = bytes;
            self.0 = rest;
        }
    }

    /// As many bytes as there are.
    pub fn slice(&mut self, bytes: &[u8]) {
        if let Some((place, rest)) = std::mem::take(&mut self.0).split_at_mut_checked(bytes.len()) {
            place.copy_from_slice(bytes);
            self.0 = rest;
        }
    }

    /// A float.
    pub fn float(&mut self, x: f32) {
        self.bytes(x.to_le_bytes());
    }

    /// Three floats.
    pub fn vec3(&mut self, v: glam::Vec3) {
        self.float(v.x);
        self.float(v.y);
        self.float(v.z);
    }

    /// A fraction 0..=1 as two bytes.
    pub fn fraction(&mut self, x: f32) {
        self.bytes(((x.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16).to_le_bytes());
    }

    /// An index.
    pub fn index(&mut self, i: u32) {
        self.bytes(i.to_le_bytes());
    }
}

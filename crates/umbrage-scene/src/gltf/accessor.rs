//! Accessors: typed arrays in a buffer view, plain, interleaved or sparse.
//!
//! Takes an accessor's index; gives its elements as f32 vectors or as indices. Invariant: nothing
//! is allocated before the elements are known to lie inside their buffer view and inside the
//! [`Budget`](crate::budget::Budget). Source: glTF 2.0 specification, sections 3.6.2 and 3.11.

use super::Context;
use super::schema::{Accessor, Sparse};
use crate::SceneError;

/// Type of one component, by the number that the file gives.
#[derive(Clone, Copy, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(code: u32) -> Result<Self, String> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(format!("unknown component type {code}")),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The component at the start of `b`, which has at least [`Component::size`] bytes.
    fn float(self, b: &[u8], normalized: bool) -> f32 {
        let (value, most) = match self {
            Self::I8 => (f32::from(b[0] as i8), 127.0),
            Self::U8 => (f32::from(b[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => (
                u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32,
                u32::MAX as f32,
            ),
            Self::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        };
        if normalized {
            (value / most).max(-1.0)
        } else {
            value
        }
    }

    /// The same as an index; only for unsigned components.
    fn index(self, b: &[u8]) -> u32 {
        match self {
            Self::U8 => u32::from(b[0]),
            Self::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
            _ => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    fn is_index(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

/// Elements of one size, `stride` bytes apart.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..self.count).map(move |i| &bytes[i * stride..i * stride + size])
    }
}

impl Context<'_> {
    /// All elements of accessor `index` as vectors of `N` floats; `from` names who asks.
    pub(super) fn vectors<const N: usize>(
        &mut self,
        index: usize,
        from: impl FnOnce() -> String,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let accessor = self.resolve(&self.root.accessors, index, "accessor", from)?;
        let expected = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        if accessor.shape != expected {
            let what = format!("type {} where {expected} is needed", accessor.shape);
            return Err(self.broken(index, what));
        }
        let component =
            Component::new(accessor.component_type).map_err(|what| self.broken(index, what))?;
        let size = component.size();
        let read = |b: &[u8]| -> [f32; N] {
            std::array::from_fn(|i| component.float(&b[i * size..], accessor.normalized))
        };
        self.read(index, size * N, read)
    }

    /// All elements of accessor `index` as indices.
    pub(super) fn indices(
        &mut self,
        index: usize,
        from: impl FnOnce() -> String,
    ) -> Result<Vec<u32>, SceneError> {
        let accessor = self.resolve(&self.root.accessors, index, "accessor", from)?;
        let component =
            Component::new(accessor.component_type).map_err(|what| self.broken(index, what))?;
        if accessor.shape != "SCALAR" || !component.is_index() {
            let what = "indices must be unsigned scalars".to_owned();
            return Err(self.broken(index, what));
        }
        self.read(index, component.size(), |b| component.index(b))
    }

    /// Reads an accessor whose elements take `size` bytes; zeros where it has no buffer view.
    fn read<T: Copy + Zero>(
        &mut self,
        index: usize,
        size: usize,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, SceneError> {
        let accessor = &self.root.accessors[index];
        let bytes = size_of::<T>();
        let item = || format!("accessor {index}");
        if accessor.buffer_view.is_some() {
            self.plain(accessor, size)
                .map_err(|what| self.broken(index, what))?;
        }
        self.budget.take(accessor.count, bytes, &self.path, item)?;
        let broken = |what| self.broken(index, what);
        let mut values: Vec<T> = match accessor.buffer_view {
            Some(_) => self
                .plain(accessor, size)
                .map_err(broken)?
                .iter()
                .map(&read)
                .collect(),
            None => vec![T::ZERO; accessor.count as usize],
        };
        if let Some(sparse) = &accessor.sparse {
            self.scatter(sparse, size, read, &mut values)
                .map_err(broken)?;
        }
        Ok(values)
    }

    /// The elements of the accessor's own buffer view.
    fn plain(&self, accessor: &Accessor, size: usize) -> Result<Elements<'_>, String> {
        let view = accessor.buffer_view.ok_or("it has no buffer view")?;
        self.elements(view, accessor.byte_offset, accessor.count, size)
    }

    /// Overwrites the elements that a sparse accessor lists.
    fn scatter<T>(
        &self,
        sparse: &Sparse,
        size: usize,
        read: impl Fn(&[u8]) -> T,
        values: &mut [T],
    ) -> Result<(), String> {
        let component = Component::new(sparse.indices.component_type)?;
        if !component.is_index() {
            return Err("sparse indices must be unsigned".to_owned());
        }
        let (at, from) = (&sparse.indices, &sparse.values);
        let at = self.elements(
            at.buffer_view,
            at.byte_offset,
            sparse.count,
            component.size(),
        )?;
        let from = self.elements(from.buffer_view, from.byte_offset, sparse.count, size)?;
        let len = values.len();
        for (at, from) in at.iter().zip(from.iter()) {
            let at = component.index(at);
            let value = values.get_mut(at as usize);
            *value.ok_or_else(|| format!("sparse index {at} beyond its {len} elements"))? =
                read(from);
        }
        Ok(())
    }

    /// `count` elements of `size` bytes in a buffer view, checked to lie inside it.
    fn elements(
        &self,
        view_index: usize,
        offset: u64,
        count: u64,
        size: usize,
    ) -> Result<Elements<'_>, String> {
        let bytes = self.view(view_index)?;
        let stride = self.root.buffer_views[view_index].byte_stride.unwrap_or(0);
        let stride = if stride == 0 { size as u64 } else { stride };
        if stride < size as u64 {
            return Err(format!(
                "stride {stride} is less than an element's {size} bytes"
            ));
        }
        let end = match count.checked_sub(1) {
            None => Some(offset),
            Some(last) => last
                .checked_mul(stride)
                .and_then(|start| start.checked_add(offset)?.checked_add(size as u64)),
        };
        let end = end.filter(|&end| end <= bytes.len() as u64).ok_or_else(|| {
            let len = bytes.len();
            format!("{count} elements from byte {offset} exceed the {len} bytes of buffer view {view_index}")
        })?;
        Ok(Elements {
            bytes: &bytes[offset as usize..end as usize],
            stride: stride as usize,
            size,
            count: count as usize,
        })
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<&[u8], String> {
        let views = &self.root.buffer_views;
        let view = views.get(index).ok_or_else(|| {
            format!(
                "buffer view {index} does not exist, there are {}",
                views.len()
            )
        })?;
        let buffer = self.buffers.get(view.buffer).ok_or_else(|| {
            let count = self.root.buffers.len();
            format!(
                "buffer {} of buffer view {index} does not exist, there are {count}",
                view.buffer
            )
        })?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let end = end
            .filter(|&end| end <= buffer.len() as u64)
            .ok_or_else(|| {
                format!(
                    "buffer view {index} exceeds the {} bytes of buffer {}",
                    buffer.len(),
                    view.buffer
                )
            })?;
        Ok(&buffer[view.byte_offset as usize..end as usize])
    }

    fn broken(&self, index: usize, what: String) -> SceneError {
        let name = self.root.accessors[index].name.clone().unwrap_or_default();
        SceneError::Accessor {
            path: self.path.clone(),
            accessor: index,
            name,
            what,
        }
    }
}

/// What elements without data are.
trait Zero {
    const ZERO: Self;
}

impl Zero for u32 {
    const ZERO: Self = 0;
}

impl<const N: usize> Zero for [f32; N] {
    const ZERO: Self = [0.0; N];
}

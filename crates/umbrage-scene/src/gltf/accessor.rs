//! Accessors: typed arrays in a buffer view, plain, interleaved or sparse.
//!
//! Takes an accessor's index; gives its elements as f32 vectors or as indices. Invariant: nothing
//! is allocated before the elements are known to lie inside their buffer view and inside the
//! [`Budget`](crate::budget::Budget); the iterators of the `gltf` package, which do not check, are
//! made only then. Source: glTF 2.0 specification, sections 3.6.2 and 3.11.

use gltf::accessor::Item;
use gltf::accessor::util::ItemIter;
use gltf::json::accessor::sparse::Sparse;
use gltf::json::accessor::{ComponentType, GenericComponentType, IndexComponentType, Type};
use gltf::json::validation::Checked;

use super::Context;
use crate::SceneError;

/// Elements `stride` bytes apart; the last ends where the bytes end.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    /// Every element as `N` components of type `T`.
    fn read<T: Item, V: Default, const N: usize>(
        &self,
        convert: impl Fn(T) -> V,
    ) -> impl Iterator<Item = [V; N]> {
        let from = |byte| self.bytes.get(byte..).unwrap_or_default();
        let component = |i| ItemIter::<T>::new(from(i * size_of::<T>()), self.stride);
        let mut components: [ItemIter<'a, T>; N] = std::array::from_fn(component);
        let mut next = move || {
            components
                .each_mut()
                .map(|c| c.next().map_or(V::default(), &convert))
        };
        (0..self.count).map(move |_| next())
    }
}

impl Context<'_> {
    /// All elements of accessor `index` as vectors of `N` floats, or as matrices for 16; `from`
    /// names who asks.
    pub(super) fn vectors<const N: usize>(
        &mut self,
        index: usize,
        from: impl FnOnce() -> String,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let accessor = self.resolve(&self.root.accessors, index, "accessor", from)?;
        let expected = match N {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            _ => Type::Mat4,
        };
        if accessor.type_ != Checked::Valid(expected) {
            let found = match accessor.type_ {
                Checked::Valid(found) => format!("{found:?}"),
                Checked::Invalid => "unknown".to_owned(),
            };
            let what = format!("type {found} where {expected:?} is needed");
            return Err(self.broken(index, what));
        }
        let normal = |value: f32, most: f32| match accessor.normalized {
            true => (value / most).max(-1.0),
            false => value,
        };
        match self.component(index)? {
            ComponentType::I8 => self.read(index, |v: i8| normal(v.into(), 127.0)),
            ComponentType::U8 => self.read(index, |v: u8| normal(v.into(), 255.0)),
            ComponentType::I16 => self.read(index, |v: i16| normal(v.into(), 32767.0)),
            ComponentType::U16 => self.read(index, |v: u16| normal(v.into(), 65535.0)),
            ComponentType::U32 => self.read(index, |v: u32| normal(v as f32, u32::MAX as f32)),
            ComponentType::F32 => self.read(index, |v: f32| v),
        }
    }

    /// All elements of accessor `index` as indices.
    pub(super) fn indices(
        &mut self,
        index: usize,
        from: impl FnOnce() -> String,
    ) -> Result<Vec<u32>, SceneError> {
        let accessor = self.resolve(&self.root.accessors, index, "accessor", from)?;
        let scalar = accessor.type_ == Checked::Valid(Type::Scalar);
        let values: Vec<[u32; 1]> = match self.component(index)? {
            ComponentType::U8 if scalar => self.read(index, |v: u8| v.into()),
            ComponentType::U16 if scalar => self.read(index, |v: u16| v.into()),
            ComponentType::U32 if scalar => self.read(index, |v: u32| v),
            _ => return Err(self.broken(index, "indices must be unsigned scalars".to_owned())),
        }?;
        Ok(values.into_flattened())
    }

    /// All elements of accessor `index` as four joint numbers; `from` names who asks.
    pub(super) fn joints(
        &mut self,
        index: usize,
        from: impl FnOnce() -> String,
    ) -> Result<Vec<[u16; 4]>, SceneError> {
        let accessor = self.resolve(&self.root.accessors, index, "accessor", from)?;
        let four = accessor.type_ == Checked::Valid(Type::Vec4);
        match self.component(index)? {
            ComponentType::U8 if four => self.read(index, |v: u8| v.into()),
            ComponentType::U16 if four => self.read(index, |v: u16| v),
            _ => Err(self.broken(
                index,
                "joints must be four unsigned bytes or shorts".to_owned(),
            )),
        }
    }

    fn component(&self, index: usize) -> Result<ComponentType, SceneError> {
        match self.root.accessors[index].component_type {
            Checked::Valid(GenericComponentType(component)) => Ok(component),
            Checked::Invalid => Err(self.broken(index, "unknown component type".to_owned())),
        }
    }

    /// Reads an accessor of `N` components of type `T`; zeros where it has no buffer view.
    fn read<T: Item, V: Copy + Default, const N: usize>(
        &mut self,
        index: usize,
        convert: impl Fn(T) -> V,
    ) -> Result<Vec<[V; N]>, SceneError> {
        let accessor = &self.root.accessors[index];
        let (count, size) = (accessor.count.0, size_of::<T>() * N);
        self.plain(index, size)?;
        let item = || format!("accessor {index}");
        self.budget
            .take(count, size_of::<[V; N]>(), &self.path, item)?;
        let mut values = match self.plain(index, size)? {
            Some(elements) => elements.read(&convert).collect(),
            None => vec![[V::default(); N]; count as usize],
        };
        if let Some(sparse) = &accessor.sparse {
            self.sparse(sparse, convert, &mut values)
                .map_err(|what| self.broken(index, what))?;
        }
        Ok(values)
    }

    /// The elements of the accessor's own buffer view, if it has one.
    fn plain(&self, index: usize, size: usize) -> Result<Option<Elements<'_>>, SceneError> {
        let accessor = &self.root.accessors[index];
        let Some(view) = accessor.buffer_view else {
            return Ok(None);
        };
        let offset = accessor.byte_offset.unwrap_or_default().0;
        self.elements(view.value(), offset, accessor.count.0, size)
            .map(Some)
            .map_err(|what| self.broken(index, what))
    }

    /// Overwrites the elements that a sparse accessor lists.
    fn sparse<T: Item, V: Default, const N: usize>(
        &self,
        sparse: &Sparse,
        convert: impl Fn(T) -> V,
        values: &mut [[V; N]],
    ) -> Result<(), String> {
        let Checked::Valid(IndexComponentType(component)) = sparse.indices.component_type else {
            return Err("sparse indices must be unsigned".to_owned());
        };
        let (at, from, count) = (&sparse.indices, &sparse.values, sparse.count.0);
        let size = component.size();
        let at = self.elements(at.buffer_view.value(), at.byte_offset.0, count, size)?;
        let size = size_of::<T>() * N;
        let from = self.elements(from.buffer_view.value(), from.byte_offset.0, count, size)?;
        let from = from.read(convert);
        match component {
            ComponentType::U8 => scatter(at.read(|v: u8| v.into()), from, values),
            ComponentType::U16 => scatter(at.read(|v: u16| v.into()), from, values),
            _ => scatter(at.read(|v: u32| v), from, values),
        }
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
        let stride = self.root.buffer_views[view_index].byte_stride;
        let stride = stride.map_or(0, |s| s.0 as u64);
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
            count: count as usize,
        })
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<&[u8], String> {
        let views = &self.root.buffer_views;
        let view = views.get(index).ok_or_else(|| {
            let count = views.len();
            format!("buffer view {index} does not exist, there are {count}")
        })?;
        let number = view.buffer.value();
        let buffer = self.buffers.get(number).ok_or_else(|| {
            let count = self.root.buffers.len();
            format!("buffer {number} of buffer view {index} does not exist, there are {count}")
        })?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0);
        let end = end.filter(|&end| end <= buffer.len() as u64);
        let end = end.ok_or_else(|| {
            let len = buffer.len();
            format!("buffer view {index} exceeds the {len} bytes of buffer {number}")
        })?;
        Ok(&buffer[start as usize..end as usize])
    }

    fn broken(&self, index: usize, what: String) -> SceneError {
        SceneError::Accessor {
            path: self.path.clone(),
            accessor: index,
            name: super::name_or(&self.root.accessors[index].name, "accessor", index),
            what,
        }
    }
}

/// Writes `from` to the places `at`.
fn scatter<V, const N: usize>(
    at: impl Iterator<Item = [u32; 1]>,
    from: impl Iterator<Item = [V; N]>,
    values: &mut [[V; N]],
) -> Result<(), String> {
    let len = values.len();
    for ([at], from) in at.zip(from) {
        let value = values.get_mut(at as usize);
        *value.ok_or_else(|| format!("sparse index {at} beyond its {len} elements"))? = from;
    }
    Ok(())
}

//! Arrays of a [`World`](super::World): owned, or a read-only part of a mapped file.
//!
//! Whoever reads one sees a slice either way; whoever writes gets a copy of its own first. All of
//! the crate's `unsafe` for mapped files is here.
#![allow(unsafe_code, reason = "a map is borrowed without a lifetime")]

use std::fmt;
use std::fs::File;
use std::io;
use std::ops::{Deref, Range};
use std::ptr::NonNull;
use std::sync::Arc;

use bytemuck::CheckedBitPattern;
use memmap2::{Mmap, MmapMut};

/// A list of plain values, read as a slice.
///
/// Built worlds own their lists. Those of an opened world are parts of its file, shared by clones
/// and paged in by the system as they are read.
pub struct Array<T>(Storage<T>);

enum Storage<T> {
    Owned(Vec<T>),
    Mapped(Mapped<T>),
}

impl<T> Array<T> {
    /// The list to write to. A mapped one is copied first: its file never changes.
    pub fn to_mut(&mut self) -> &mut Vec<T>
    where
        T: Clone,
    {
        if let Storage::Mapped(mapped) = &self.0 {
            self.0 = Storage::Owned(mapped.slice().to_vec());
        }
        match &mut self.0 {
            Storage::Owned(list) => list,
            Storage::Mapped(_) => unreachable!("made owned above"),
        }
    }

    /// Whether it is part of a file, with no memory of its own.
    pub fn is_mapped(&self) -> bool {
        matches!(self.0, Storage::Mapped(_))
    }
}

impl<T> Deref for Array<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        match &self.0 {
            Storage::Owned(list) => list,
            Storage::Mapped(mapped) => mapped.slice(),
        }
    }
}

impl<T> From<Vec<T>> for Array<T> {
    fn from(list: Vec<T>) -> Self {
        Self(Storage::Owned(list))
    }
}

impl<T> Default for Array<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T: Clone> Clone for Array<T> {
    fn clone(&self) -> Self {
        Self(match &self.0 {
            Storage::Owned(list) => Storage::Owned(list.clone()),
            Storage::Mapped(mapped) => Storage::Mapped(Mapped {
                slice: mapped.slice,
                file: mapped.file.clone(),
            }),
        })
    }
}

impl<T: fmt::Debug> fmt::Debug for Array<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<T: PartialEq> PartialEq for Array<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<'a, T> IntoIterator for &'a Array<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// A whole file, mapped read-only.
///
/// Whoever maps a file promises that nobody changes it in place while it is mapped: saved worlds
/// are replaced by renaming, which leaves the mapped one as it was.
#[derive(Clone, Debug)]
pub(super) struct MappedFile(Arc<Mmap>);

impl MappedFile {
    pub(super) fn new(file: &File) -> io::Result<Self> {
        // SAFETY: the promise above; the map is read-only and private to this module, which hands
        // out nothing that outlives it.
        let map = unsafe { Mmap::map(file)? };
        Ok(Self(Arc::new(map)))
    }

    /// A file that is in memory already, as a map of its own; `bytes` must not be empty.
    pub(super) fn copied(bytes: &[u8]) -> io::Result<Self> {
        let mut map = MmapMut::map_anon(bytes.len())?;
        map.copy_from_slice(bytes);
        Ok(Self(Arc::new(map.make_read_only()?)))
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// The values in a range of bytes; `None` if it leaves the file, is not aligned, holds no
    /// whole number of them, or one has bits that are no value of its type.
    pub(super) fn array<T: CheckedBitPattern>(&self, bytes: Range<usize>) -> Option<Array<T>> {
        let slice = bytemuck::checked::try_cast_slice(self.0.get(bytes)?).ok()?;
        Some(Array(Storage::Mapped(Mapped {
            slice: NonNull::from(slice),
            file: self.clone(),
        })))
    }
}

struct Mapped<T> {
    /// Part of `file`.
    slice: NonNull<[T]>,
    file: MappedFile,
}

impl<T> Mapped<T> {
    #[inline]
    fn slice(&self) -> &[T] {
        // SAFETY: made in `MappedFile::array` from a slice of valid values in a map that does not
        // move, is never written, and is kept alive by `self.file`.
        unsafe { self.slice.as_ref() }
    }
}

// SAFETY: a shared reference to a slice in all but its lifetime, and a shared owner of the map.
unsafe impl<T: Sync> Send for Mapped<T> {}
// SAFETY: as above.
unsafe impl<T: Sync> Sync for Mapped<T> {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Casting;

    fn mapped(name: &str, bytes: &[u8]) -> MappedFile {
        let name = format!("umbrage-array-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::write(&path, bytes).unwrap();
        let file = MappedFile::new(&File::open(&path).unwrap()).unwrap();
        // Unix keeps a mapped file; elsewhere it stays in the temporary folder.
        let _ = std::fs::remove_file(&path);
        file
    }

    #[test]
    fn mapped_reads_as_owned_and_copies_when_written() {
        let list = vec![[1u32, 2], [3, 4], [5, 6]];
        let file = mapped("copies", bytemuck::cast_slice(&list));
        let array = file.array::<[u32; 2]>(0..24).unwrap();
        assert!(array.is_mapped() && array == list.clone().into());
        let mut written = array.clone();
        drop(file);
        written.to_mut()[1] = [7, 7];
        assert!(!written.is_mapped());
        assert_eq!(
            (&written[..], &array[..]),
            (&[[1, 2], [7, 7], [5, 6]][..], &list[..])
        );
        assert_eq!((&array).into_iter().count(), 3);
    }

    #[test]
    fn bytes_that_are_no_values_are_refused() {
        let file = mapped("refused", &[1, 2, 3, 0, 4, 0, 0, 0]);
        assert_eq!(file.array::<Casting>(0..4).unwrap().len(), 4);
        assert!(file.array::<Casting>(0..5).is_none(), "4 is no rule");
        assert!(file.array::<u32>(0..9).is_none(), "past the end");
        assert!(file.array::<u32>(1..5).is_none(), "not aligned");
        assert!(file.array::<u32>(0..7).is_none(), "not whole");
        assert!(file.array::<u32>(4..4).is_some_and(|none| none.is_empty()));
    }
}

//! Many short lists in one long array, each of which can be replaced without moving the others.
//!
//! A list that outgrows its room moves to the end; once half of the array is gaps, they are closed.
//! Every write is remembered by page, so that a copy of the array (on a GPU, say) can be brought up
//! to date by what changed, by any number of readers.

use std::ops::Range;

use crate::stamp;

/// Where a list lies.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) first: u32,
    length: u32,
    room: u32,
}

/// What state of which array a copy was made of; the default is of none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Version {
    array: u64,
    stamp: u64,
}

/// What is known about an array of blocks.
#[derive(Debug, Default)]
pub(super) struct Store {
    /// Items in gaps.
    gaps: usize,
    /// When each page was last written.
    pages: Vec<u64>,
    /// Of the last write, to this array and no other.
    version: Version,
}

/// A clone goes its own way: it is another array.
impl Clone for Store {
    fn clone(&self) -> Self {
        Self {
            gaps: self.gaps,
            pages: self.pages.clone(),
            version: Version {
                array: stamp::next(),
                ..self.version
            },
        }
    }
}

/// Items a page: large enough to keep the list short, small enough to upload for one light.
const PAGE: usize = 256;
/// Rooms are multiples of this, so that a list that varies a little stays where it is.
const GRAIN: usize = 16;
/// Gaps below this are not worth closing.
const FEW: usize = 1 << 14;

impl Store {
    /// Replaces the items of `block`.
    pub(super) fn put<T: Copy + Default>(
        &mut self,
        array: &mut Vec<T>,
        block: &mut Block,
        items: &[T],
        stamp: u64,
    ) {
        if items.len() > block.room as usize {
            self.free(block);
            block.first = array.len() as u32;
            block.room = items.len().next_multiple_of(GRAIN) as u32;
            array.resize(array.len() + block.room as usize, T::default());
        }
        block.length = items.len() as u32;
        let range = block.first as usize..block.first as usize + items.len();
        array[range.clone()].copy_from_slice(items);
        self.written(range, stamp);
    }

    /// Leaves a gap where `block` was.
    pub(super) fn free(&mut self, block: &mut Block) {
        self.gaps += block.room as usize;
        *block = Block::default();
    }

    /// Closes the gaps if they are half of the array; says whether it did.
    pub(super) fn compact<'a, T: Copy + Default>(
        &mut self,
        array: &mut Vec<T>,
        blocks: impl Iterator<Item = &'a mut Block>,
        stamp: u64,
    ) -> bool {
        if self.gaps < FEW || 2 * self.gaps < array.len() {
            return false;
        }
        let old = std::mem::take(array);
        *self = Self::default();
        for block in blocks {
            let items = &old[block.first as usize..][..block.length as usize];
            *block = Block::default();
            self.put(array, block, items, stamp);
        }
        true
    }

    fn written(&mut self, range: Range<usize>, stamp: u64) {
        if range.is_empty() {
            return;
        }
        let last = (range.end - 1) / PAGE;
        self.pages.resize(self.pages.len().max(last + 1), 0);
        self.pages[range.start / PAGE..=last].fill(stamp);
        self.version.stamp = stamp;
        if self.version.array == 0 {
            self.version.array = stamp::next();
        }
    }

    /// Of the last write.
    pub(super) fn version(&self) -> Version {
        self.version
    }

    /// Runs of items on pages written after `copied`, in an array of `length`.
    pub(super) fn since(
        &self,
        copied: Version,
        length: usize,
    ) -> impl Iterator<Item = Range<usize>> {
        let copied = match copied.array == self.version.array {
            true => copied.stamp,
            false => 0,
        };
        let mut page = 0;
        std::iter::from_fn(move || {
            let stale = |p: usize| self.pages.get(p).is_some_and(|&at| at > copied);
            if self.version.stamp <= copied {
                return None;
            }
            while page < self.pages.len() && !stale(page) {
                page += 1;
            }
            let first = page;
            while stale(page) {
                page += 1;
            }
            (page > first).then(|| first * PAGE..(page * PAGE).min(length))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A copy brought up to date by `since` equals the array, through growth and compaction.
    #[test]
    fn a_copy_follows_every_change() {
        let (mut store, mut array, mut copy) = (Store::default(), Vec::new(), Vec::new());
        let mut blocks: Vec<Block> = vec![Block::default(); 40];
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); 40];
        let (mut state, mut seen, mut compacted) = (1u64, Version::default(), 0);
        for round in 1..400u64 {
            for _ in 0..3 {
                state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(99);
                let (at, length) = ((state >> 33) as usize % 40, (state >> 45) as usize % 900);
                lists[at] = (0..length as u32)
                    .map(|i| i ^ (state >> 20) as u32)
                    .collect();
                store.put(&mut array, &mut blocks[at], &lists[at], round);
            }
            compacted += u32::from(store.compact(&mut array, blocks.iter_mut(), round));
            copy.resize(array.len(), 0);
            for range in store.since(seen, array.len()) {
                copy[range.clone()].copy_from_slice(&array[range]);
            }
            seen = store.version();
            for (block, list) in blocks.iter().zip(&lists) {
                let held = &copy[block.first as usize..][..block.length as usize];
                assert_eq!(held, &list[..]);
            }
            assert_eq!(store.since(seen, array.len()).count(), 0);
        }
        assert!(compacted > 0 && array.len() < 200_000);
    }
}

//! An array on the GPU in as many storage buffers as it takes.
//!
//! Takes bytes and which of them changed; gives windows of equally many bytes, of which the last may
//! be shorter, each a [`Growing`] buffer that one binding holds.

use std::ops::Range;

use wgpu::{Buffer, BufferUsages, Device, Queue};

use crate::RenderError;
use crate::buffers::{Growing, Written};

#[derive(Debug)]
pub(crate) struct Split {
    label: &'static str,
    usage: BufferUsages,
    windows: Vec<Growing>,
    /// Bytes a window; `None` if one holds all.
    size: Option<usize>,
    /// Whether windows may be added.
    is_open: bool,
}

impl Split {
    /// An array in `count` windows of `size` bytes.
    pub(crate) fn fixed(
        device: &Device,
        label: &'static str,
        count: u32,
        size: Option<usize>,
    ) -> Result<Self, RenderError> {
        let mut split = Self {
            label,
            usage: BufferUsages::empty(),
            windows: Vec::new(),
            size,
            is_open: false,
        };
        for _ in 0..count {
            split.add(device)?;
        }
        Ok(split)
    }

    /// An array in as many windows of `size` bytes as it takes, and at least one.
    pub(crate) fn open(
        device: &Device,
        label: &'static str,
        size: usize,
        usage: BufferUsages,
    ) -> Result<Self, RenderError> {
        let mut split = Self {
            label,
            usage,
            windows: Vec::new(),
            size: Some(size),
            is_open: true,
        };
        split.add(device)?;
        Ok(split)
    }

    fn add(&mut self, device: &Device) -> Result<(), RenderError> {
        let mut window = Growing::new(device, self.label, self.usage)?;
        window.most = self.size.map_or(u64::MAX, |size| size as u64);
        self.windows.push(window);
        Ok(())
    }

    pub(crate) fn buffers(&self) -> impl ExactSizeIterator<Item = &Buffer> {
        self.windows.iter().map(|window| &window.buffer)
    }

    /// The buffer of a window, or of the last if there are fewer.
    pub(crate) fn buffer(&self, window: usize) -> &Buffer {
        &self.windows[window.min(self.windows.len() - 1)].buffer
    }

    /// Makes room for `needed` bytes.
    pub(crate) fn reserve(
        &mut self,
        device: &Device,
        needed: usize,
    ) -> Result<Written, RenderError> {
        let mut written = Written::default();
        for (number, share) in self.shares(needed).enumerate() {
            written.replaced |= self.open_window(device, number)?;
            written.replaced |= self.windows[number].reserve(device, share.len() as u64)?;
        }
        Ok(written)
    }

    /// Brings it up to date with `bytes`, of which only `changed` differ from what it was given
    /// last.
    pub(crate) fn write_changed(
        &mut self,
        device: &Device,
        queue: &Queue,
        bytes: &[u8],
        changed: impl Iterator<Item = Range<usize>>,
    ) -> Result<Written, RenderError> {
        let changed: Vec<Range<usize>> = changed.collect();
        let mut written = Written::default();
        for (number, share) in self.shares(bytes.len()).enumerate() {
            written.replaced |= self.open_window(device, number)?;
            let (start, end) = (share.start, share.end);
            let within = changed.iter().map(|r| r.start.max(start)..r.end.min(end));
            let within = within.filter(|r| !r.is_empty());
            let within = within.map(|r| r.start - start..r.end - start);
            let window = &mut self.windows[number];
            written += window.write_changed(device, queue, &bytes[share], within)?;
        }
        Ok(written)
    }

    /// Writes `bytes` unless it holds them already.
    pub(crate) fn write(
        &mut self,
        device: &Device,
        queue: &Queue,
        bytes: &[u8],
    ) -> Result<Written, RenderError> {
        let mut written = Written::default();
        for (number, share) in self.shares(bytes.len()).enumerate() {
            written.replaced |= self.open_window(device, number)?;
            written += self.windows[number].write(device, queue, &bytes[share])?;
        }
        Ok(written)
    }

    /// What each window holds of so many bytes.
    fn shares(&self, bytes: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        let size = self.size.unwrap_or(bytes.max(1));
        (0..bytes.div_ceil(size)).map(move |i| i * size..bytes.min((i + 1) * size))
    }

    /// Sees to it that there is a window of this number; true if it is new.
    fn open_window(&mut self, device: &Device, number: usize) -> Result<bool, RenderError> {
        if number < self.windows.len() {
            return Ok(false);
        }
        if !self.is_open {
            return Err(RenderError::WorldOutgrown {
                what: self.label,
                windows: self.windows.len(),
            });
        }
        self.add(device)?;
        Ok(true)
    }
}

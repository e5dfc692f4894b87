//! Storage buffers that follow arrays on the CPU, upload what changed, and grow.

use std::ops::Range;

use wgpu::{Buffer, BufferUsages, Device, Queue};

use crate::RenderError;

/// The most bytes that a storage buffer may have on `device`, if `needed` are no more.
pub fn check_storage(device: &Device, what: &'static str, needed: u64) -> Result<u64, RenderError> {
    let limits = device.limits();
    let limit = limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size);
    if needed > limit {
        return Err(RenderError::BufferTooLarge {
            what,
            needed,
            limit,
        });
    }
    Ok(limit)
}

/// A storage buffer that follows an array on the CPU and is replaced only when it must grow.
#[derive(Debug)]
pub(crate) struct Growing {
    label: &'static str,
    usage: BufferUsages,
    pub(crate) buffer: Buffer,
    /// What it holds, where the caller has no other way of knowing.
    copy: Vec<u8>,
}

/// What a write did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Written {
    /// Bytes handed to the queue.
    pub(crate) bytes: u64,
    /// The buffer was replaced, so that bind groups must be too.
    pub(crate) replaced: bool,
}

impl std::ops::AddAssign for Written {
    fn add_assign(&mut self, other: Self) {
        self.bytes += other.bytes;
        self.replaced |= other.replaced;
    }
}

impl Growing {
    pub(crate) fn new(device: &Device, label: &'static str, usage: BufferUsages) -> Self {
        let usage = usage | BufferUsages::STORAGE | BufferUsages::COPY_DST;
        Self {
            label,
            usage,
            buffer: allocate(device, label, 4096, usage),
            copy: Vec::new(),
        }
    }

    /// Makes room for `needed` bytes; true if the buffer was replaced and so holds nothing.
    pub(crate) fn reserve(&mut self, device: &Device, needed: u64) -> Result<bool, RenderError> {
        let limit = check_storage(device, self.label, needed)?;
        let short = needed > self.buffer.size();
        if short {
            let size = (needed + needed / 2).next_multiple_of(256).min(limit & !3);
            self.buffer = allocate(device, self.label, size, self.usage);
        }
        Ok(short)
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
        if self.reserve(device, bytes.len() as u64)? {
            queue.write_buffer(&self.buffer, 0, bytes);
            return Ok(Written {
                bytes: bytes.len() as u64,
                replaced: true,
            });
        }
        let mut written = Written::default();
        for range in changed {
            queue.write_buffer(&self.buffer, range.start as u64, &bytes[range.clone()]);
            written.bytes += range.len() as u64;
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
        if self.copy == bytes {
            return Ok(Written::default());
        }
        let whole = std::iter::once(0..bytes.len());
        let written = self.write_changed(device, queue, bytes, whole)?;
        self.copy.clear();
        self.copy.extend_from_slice(bytes);
        Ok(written)
    }
}

fn allocate(device: &Device, label: &'static str, size: u64, usage: BufferUsages) -> Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}

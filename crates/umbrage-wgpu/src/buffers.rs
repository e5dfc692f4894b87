//! Storage buffers that follow arrays on the CPU, upload what changed, and grow.

use std::ops::Range;
use std::task::{Context, Poll, Waker};

use wgpu::{Buffer, BufferUsages, Device, Limits, Queue};

use crate::RenderError;

/// The most bytes that a storage buffer may have, and the name of the limit that says so.
pub(crate) fn binding_limit(limits: &Limits) -> (u64, &'static str) {
    let binding = (
        limits.max_storage_buffer_binding_size,
        "max_storage_buffer_binding_size",
    );
    binding.min((limits.max_buffer_size, "max_buffer_size"))
}

/// The most bytes that a storage buffer may have on `device`, if `needed` are no more.
pub fn check_storage(device: &Device, what: &'static str, needed: u64) -> Result<u64, RenderError> {
    let (limit, limit_name) = binding_limit(&device.limits());
    if needed > limit {
        return Err(RenderError::BufferTooLarge {
            what,
            needed,
            limit_name,
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
    /// It never grows beyond this, and needs not.
    pub(crate) most: u64,
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
    pub(crate) fn new(
        device: &Device,
        label: &'static str,
        usage: BufferUsages,
    ) -> Result<Self, RenderError> {
        let usage = usage | BufferUsages::STORAGE | BufferUsages::COPY_DST;
        Ok(Self {
            label,
            usage,
            buffer: allocate(device, label, 4096, usage)?,
            most: u64::MAX,
            copy: Vec::new(),
        })
    }

    /// Makes room for `needed` bytes; true if the buffer was replaced and so holds nothing.
    pub(crate) fn reserve(&mut self, device: &Device, needed: u64) -> Result<bool, RenderError> {
        let limit = check_storage(device, self.label, needed)?;
        let short = needed > self.buffer.size();
        if short {
            let size = (needed + needed / 2)
                .next_multiple_of(256)
                .min(limit.min(self.most) & !3);
            self.buffer = allocate(device, self.label, size, self.usage)?;
            self.copy.clear();
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

fn allocate(
    device: &Device,
    label: &'static str,
    size: u64,
    usage: BufferUsages,
) -> Result<Buffer, RenderError> {
    let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    });
    match captured(scope) {
        Some(_) => Err(RenderError::NoMemory {
            what: label,
            bytes: size,
        }),
        None => Ok(buffer),
    }
}

/// What a scope has caught. Everywhere but in a browser that is known at once; there an error is
/// the host's to see.
pub fn captured(scope: wgpu::ErrorScopeGuard) -> Option<wgpu::Error> {
    let found = std::pin::pin!(scope.pop());
    let mut context = Context::from_waker(Waker::noop());
    match found.poll(&mut context) {
        Poll::Ready(error) => error,
        Poll::Pending => None,
    }
}

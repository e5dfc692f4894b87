//! Storage buffers: the world's, written once, and the frame's, which grow.

use wgpu::util::DeviceExt as _;
use wgpu::{Buffer, BufferUsages, Device, Queue};

use crate::RenderError;

/// A read-only storage buffer with `bytes` in it; never empty, because a binding cannot be.
pub(crate) fn storage(
    device: &Device,
    label: &'static str,
    bytes: &[u8],
) -> Result<Buffer, RenderError> {
    check_size(device, label, bytes.len() as u64)?;
    let contents = if bytes.is_empty() { &[0; 16] } else { bytes };
    Ok(
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
        }),
    )
}

fn check_size(device: &Device, what: &'static str, needed: u64) -> Result<(), RenderError> {
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
    Ok(())
}

/// A storage buffer that is rewritten each frame and replaced only when it must grow.
#[derive(Debug)]
pub(crate) struct Growing {
    label: &'static str,
    pub(crate) buffer: Buffer,
}

impl Growing {
    pub(crate) fn new(device: &Device, label: &'static str) -> Self {
        Self {
            label,
            buffer: Self::allocate(device, label, 4096),
        }
    }

    /// Writes `bytes`; true if the buffer was replaced, so that bind groups must be too.
    pub(crate) fn write(
        &mut self,
        device: &Device,
        queue: &Queue,
        bytes: &[u8],
    ) -> Result<bool, RenderError> {
        let needed = bytes.len() as u64;
        check_size(device, self.label, needed)?;
        let replaced = needed > self.buffer.size();
        if replaced {
            let limits = device.limits();
            let limit = limits
                .max_storage_buffer_binding_size
                .min(limits.max_buffer_size);
            let size = (needed + needed / 2).next_multiple_of(256).min(limit & !3);
            self.buffer = Self::allocate(device, self.label, size);
        }
        if needed > 0 {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
        Ok(replaced)
    }

    fn allocate(device: &Device, label: &'static str, size: u64) -> Buffer {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }
}

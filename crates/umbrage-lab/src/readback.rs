//! Textures back to the CPU.

use crate::gpu::{Gpu, GpuError};

/// Reads level 0 of a 2D texture; rows are tightly packed in the result.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
    let size = texture.size();
    let texel = texture.format().block_copy_size(None).unwrap_or(4);
    let row = size.width * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let bytes = u64::from(padded) * u64::from(size.height);
    gpu.check_buffer("pixels read back", bytes)?;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("readback"),
        });
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: None,
            },
        },
        size,
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = read_buffer(gpu, &buffer)?;
    Ok(bytes
        .chunks(padded as usize)
        .flat_map(|line| &line[..row as usize])
        .copied()
        .collect())
}

/// Records a copy of a buffer that [`read_items`] can read once the encoder is submitted.
pub(crate) fn record_copy(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    buffer: &wgpu::Buffer,
) -> wgpu::Buffer {
    let readable = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readable copy"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    encoder.copy_buffer_to_buffer(buffer, 0, &readable, 0, readable.size());
    readable
}

/// Reads the whole items that a mappable buffer holds.
pub(crate) fn read_items<T: bytemuck::Pod>(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
) -> Result<Vec<T>, GpuError> {
    let bytes = read_buffer(gpu, buffer)?;
    let whole = bytes.len() / size_of::<T>() * size_of::<T>();
    Ok(bytemuck::pod_collect_to_vec(&bytes[..whole]))
}

/// Reads a mappable buffer.
pub fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let lost = |e: String| gpu.lost_or(GpuError::Readback(e));
    let slice = buffer.slice(..);
    let (send, receive) = std::sync::mpsc::channel();
    slice.map_async(wgpu::MapMode::Read, move |result| {
        // The receiver lives until poll has returned.
        let _ = send.send(result);
    });
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|e| lost(e.to_string()))?;
    receive
        .recv()
        .map_err(|e| lost(e.to_string()))?
        .map_err(|e| lost(e.to_string()))?;
    let bytes = slice
        .get_mapped_range()
        .map_err(|e| lost(e.to_string()))?
        .to_vec();
    buffer.unmap();
    Ok(bytes)
}

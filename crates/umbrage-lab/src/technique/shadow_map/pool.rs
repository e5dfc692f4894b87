//! Depth textures within a budget: who has one keeps it while it is in view.

use wgpu::{TextureFormat, TextureUsages, TextureView};

use crate::gpu::{Gpu, GpuError};

/// Bytes that all maps may take together, scratch maps included; less where the device gives less.
pub(super) const BUDGET: u64 = 2 << 30;
/// Most maps that lights beyond the budget share, and the share of the budget that they may take.
const SCRATCH_MAPS: u64 = 8;
const SCRATCH_SHARE: u64 = 4;

/// Depth of one light, from one to six faces.
pub(super) const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// One light's depth texture.
#[derive(Debug)]
pub(super) struct Map {
    /// All faces, to read.
    pub(super) all: TextureView,
    /// Each face, to draw.
    pub(super) faces: Vec<TextureView>,
    bytes: u64,
}

impl Map {
    /// `None` if the device has no memory for it.
    fn new(gpu: &Gpu, texels: u32, faces: u32) -> Option<Self> {
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow map"),
            size: wgpu::Extent3d {
                width: texels,
                height: texels,
                depth_or_array_layers: faces,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        if pollster::block_on(scope.pop()).is_some() {
            return None;
        }
        let view = |dimension, first, count| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("shadow map"),
                dimension: Some(dimension),
                base_array_layer: first,
                array_layer_count: Some(count),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        Some(Self {
            all: view(wgpu::TextureViewDimension::D2Array, 0, faces),
            faces: (0..faces)
                .map(|face| view(wgpu::TextureViewDimension::D2, face, 1))
                .collect(),
            bytes: bytes(texels, faces),
        })
    }
}

/// Of a map.
pub(super) fn bytes(texels: u32, faces: u32) -> u64 {
    4 * u64::from(texels) * u64::from(texels) * u64::from(faces)
}

/// All maps of one size.
#[derive(Debug)]
pub(super) struct Pool {
    texels: u32,
    budget: u64,
    held: u64,
    free: Vec<Map>,
    /// For lights beyond the budget, each for six faces.
    pub(super) scratch: Vec<Map>,
}

impl Pool {
    pub(super) fn new(texels: u32, budget: u64) -> Self {
        Self {
            texels,
            budget,
            held: 0,
            free: Vec::new(),
            scratch: Vec::new(),
        }
    }

    /// Bytes of all maps there are.
    pub(super) fn held(&self) -> u64 {
        self.held
    }

    /// Bytes that there may be.
    pub(super) fn budget(&self) -> u64 {
        self.budget
    }

    /// Bytes that can still be taken.
    pub(super) fn room(&self) -> u64 {
        let free: u64 = self.free.iter().map(|map| map.bytes).sum();
        self.budget.saturating_sub(self.held) + free
    }

    /// Gives the scratch maps to lights, since there are enough for all.
    pub(super) fn free_scratch(&mut self) {
        self.free.append(&mut self.scratch);
    }

    /// A map of its own for a light, if there is one left.
    pub(super) fn take(&mut self, gpu: &Gpu, faces: u32) -> Option<Map> {
        let of_faces = |map: &Map| map.faces.len() == faces as usize;
        if let Some(at) = self.free.iter().position(of_faces) {
            return Some(self.free.swap_remove(at));
        }
        while self.held + bytes(self.texels, faces) > self.budget {
            self.held -= self.free.pop()?.bytes;
        }
        let map = Map::new(gpu, self.texels, faces);
        match &map {
            Some(map) => self.held += map.bytes,
            None => self.budget = self.held,
        }
        map
    }

    /// Takes a map back.
    pub(super) fn give(&mut self, map: Map) {
        self.free.push(map);
    }

    /// Makes the scratch maps, before maps are taken for lights that need `wanted` bytes, more
    /// than there are.
    pub(super) fn make_scratch(&mut self, gpu: &Gpu, wanted: u64) -> Result<(), GpuError> {
        if wanted <= self.budget || !self.scratch.is_empty() {
            return Ok(());
        }
        let cube = bytes(self.texels, 6);
        let count = (self.budget / SCRATCH_SHARE / cube).clamp(1, SCRATCH_MAPS);
        for _ in 0..count {
            // The first is beyond the budget, if need be: without it no light can be drawn.
            let map = match self.scratch.is_empty() {
                true => Map::new(gpu, self.texels, 6),
                false => self.take(gpu, 6),
            };
            let first = self.scratch.is_empty();
            match map {
                Some(map) => {
                    self.held += if first { map.bytes } else { 0 };
                    self.scratch.push(map);
                }
                None if first => {
                    return Err(GpuError::NoMemory {
                        what: "a shadow map",
                        bytes: cube,
                    });
                }
                None => break,
            }
        }
        Ok(())
    }
}

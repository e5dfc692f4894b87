//! How much memory the geometry of one file may take.
//!
//! A small file can name one accessor or place one mesh a million times, or declare an accessor of
//! zeros that has no data at all, so what is expanded is counted before it is allocated. Invariant:
//! the vectors of all meshes and the soup of all instances together never take more than the limit.
//! Real scenes take up to 13 times their size.

use std::path::Path;

use glam::Vec3;

use crate::{Instance, Scene, SceneError, Soup};

/// Any file may expand to this, in bytes: some five million triangles, whose world then fits 2 GiB.
const FLOOR: u64 = 1 << 29;
/// Beyond it, to this many times its real size, buffers included.
const FACTOR: u64 = 64;

/// Bytes granted so far, and the most that will be.
pub(crate) struct Budget {
    used: u64,
    limit: u64,
}

impl Budget {
    /// For a file that holds `bytes` in all.
    pub(crate) fn new(bytes: u64) -> Self {
        Self {
            used: 0,
            limit: FLOOR.max(bytes.saturating_mul(FACTOR)),
        }
    }

    /// Grants the soup of all instances, or refuses.
    pub(crate) fn take_flattened(&mut self, scene: &Scene, path: &Path) -> Result<(), SceneError> {
        let used = || {
            let mesh = |i: &Instance| scene.meshes.get(i.mesh as usize);
            scene.instances.iter().filter_map(mesh)
        };
        let shaded = used().any(|mesh| !mesh.normals.is_empty());
        let textured = used().any(|mesh| !mesh.uvs.is_empty());
        let triangle = Soup::triangle_bytes(shaded, textured);
        for (item, mesh) in used().enumerate() {
            let name = || format!("instance {item} of {}, flattened,", scene.instances.len());
            // Positions and, far from the origin, what f32 leaves of them.
            self.take(
                mesh.positions.len() as u64,
                2 * size_of::<Vec3>(),
                path,
                name,
            )?;
            self.take(mesh.triangles.len() as u64, triangle, path, name)?;
        }
        Ok(())
    }

    /// Grants `count` items of `size` bytes for `item`, or refuses.
    pub(crate) fn take(
        &mut self,
        count: u64,
        size: usize,
        path: &Path,
        item: impl FnOnce() -> String,
    ) -> Result<(), SceneError> {
        let bytes = self.used.saturating_add(count.saturating_mul(size as u64));
        if bytes > self.limit {
            let (path, item, limit) = (path.to_owned(), item(), self.limit);
            return Err(SceneError::TooLarge {
                path,
                item,
                bytes,
                limit,
            });
        }
        self.used = bytes;
        Ok(())
    }
}

//! How the world's arrays are cut where one binding cannot hold them: into windows of equally many
//! items, each a storage buffer of its own, all of them bound at once.
//!
//! Takes a device's limits and a world; gives how many windows each array needs, and the WGSL by
//! which shaders find an item in them. An array in one window is read without any choice, so that
//! worlds which fit pay nothing.

use std::fmt::Write as _;

use umbrage_core::world::World;
use wgpu::{Device, Limits};

use crate::RenderError;
use crate::buffers::binding_limit;

/// Storage buffers beside the world that the library's own vertex shaders read, and its compute
/// shaders, which read no triangles.
const BESIDE: [u32; 2] = [4, 6];

/// In how many windows a world's arrays are, as [`RendererOptions`](crate::RendererOptions) wants
/// to know: pipelines depend on it. One each unless a world needs more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorldWindows {
    pub(crate) positions: Windows,
    pub(crate) edges: Windows,
    pub(crate) corners: Windows,
    /// Whether vertices have residuals.
    pub(crate) residuals: bool,
}

/// In how many windows an array is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Windows {
    pub(crate) count: u32,
    /// Items a window, as a power of two; of no meaning for one window.
    pub(crate) shift: u32,
}

impl Default for Windows {
    fn default() -> Self {
        Self { count: 1, shift: 0 }
    }
}

/// The most items of `item` bytes that a window of so many bytes holds, as a power of two.
pub(crate) fn shift_of(bytes: u64, item: u64) -> u32 {
    (bytes / item).max(1).ilog2().min(31)
}

fn vertex_bytes(residuals: bool) -> usize {
    if residuals { 24 } else { 12 }
}

impl Windows {
    fn of(limit: u64, items: usize, item: u64) -> Self {
        if items as u64 * item <= limit {
            return Self::default();
        }
        let shift = shift_of(limit, item);
        Self {
            count: (items as u64).div_ceil(1 << shift) as u32,
            shift,
        }
    }

    /// Items a window, or `None` if one holds all.
    pub(crate) fn items(self) -> Option<usize> {
        (self.count > 1).then(|| 1 << self.shift)
    }
}

impl WorldWindows {
    /// What `world` needs on `device`.
    ///
    /// # Errors
    /// If that is more storage buffers than a shader stage can have.
    pub fn of(device: &Device, world: &World) -> Result<Self, RenderError> {
        let limits = device.limits();
        let (limit, _) = binding_limit(&limits);
        let residuals = !world.residuals.is_empty();
        let windows = Self {
            positions: Windows::of(limit, world.positions.len(), vertex_bytes(residuals) as u64),
            edges: Windows::of(limit, world.edges.vertices.len(), 8),
            corners: Windows::of(limit, 3 * world.triangles.len(), 4),
            residuals,
        };
        windows.check(&limits)?;
        Ok(windows)
    }

    /// Storage buffers that vertex shaders read the world from; the host's own come on top.
    pub fn storage_buffers(&self) -> u32 {
        self.positions.count + self.edges.count + self.corners.count
    }

    /// Bytes of a vertex.
    pub(crate) fn vertex_bytes(&self) -> usize {
        vertex_bytes(self.residuals)
    }

    /// Whether each array is in one buffer.
    pub fn is_whole(&self) -> bool {
        self.storage_buffers() == 3
    }

    fn check(&self, limits: &Limits) -> Result<(), RenderError> {
        let [vertex, compute] = BESIDE;
        let in_compute = self.positions.count + self.edges.count + compute;
        let needed = in_compute.max(self.storage_buffers() + vertex);
        let stage = limits.max_storage_buffers_per_shader_stage;
        let group = limits.max_bindings_per_bind_group;
        let too_many = |limit_name, limit, needed| RenderError::TooManyWindows {
            needed,
            limit_name,
            limit,
            window: binding_limit(limits).0,
        };
        if needed > stage {
            let name = "max_storage_buffers_per_shader_stage";
            return Err(too_many(name, stage, needed));
        }
        if self.storage_buffers() + 1 > group {
            let name = "max_bindings_per_bind_group";
            return Err(too_many(name, group, self.storage_buffers() + 1));
        }
        Ok(())
    }

    /// Declarations of the arrays, in bind group `group` from binding 1 on, and a function for each
    /// that gives an item.
    pub(crate) fn wgsl(&self, group: u32) -> String {
        let mut source = String::new();
        let mut binding = 1;
        let positions = match self.residuals {
            true => &BOTH,
            false => &POSITIONS,
        };
        for (array, windows) in [
            (positions, self.positions),
            (&EDGES, self.edges),
            (&CORNERS, self.corners),
        ] {
            array.declare(&mut source, windows, group, &mut binding);
        }
        source
    }
}

/// An array of the world as shaders see it.
struct Array {
    about: &'static str,
    name: &'static str,
    element: &'static str,
    function: &'static str,
    gives: &'static str,
    /// Statements that give item `i` of the window `$`.
    item: &'static str,
}

const POSITIONS: Array = Array {
    about: "Where a vertex is in the world.",
    name: "umbrage_positions",
    element: "f32",
    function: "umbrage_place",
    gives: "UmbragePlace",
    item: "return UmbragePlace(vec3f($[3u * i], $[3u * i + 1u], $[3u * i + 2u]), vec3f(0.0));",
};

const BOTH: Array = Array {
    item: "return UmbragePlace(\
        vec3f($[6u * i], $[6u * i + 1u], $[6u * i + 2u]), \
        vec3f($[6u * i + 3u], $[6u * i + 4u], $[6u * i + 5u]));",
    ..POSITIONS
};

const EDGES: Array = Array {
    about: "The two vertices of an edge.",
    name: "umbrage_edges",
    element: "vec2u",
    function: "umbrage_edge",
    gives: "vec2u",
    item: "return $[i];",
};

const CORNERS: Array = Array {
    about: "The vertex at a corner: three times a triangle's number, plus 0, 1 or 2.",
    name: "umbrage_corners",
    element: "u32",
    function: "umbrage_corner",
    gives: "u32",
    item: "return $[i];",
};

impl Array {
    fn declare(&self, source: &mut String, windows: Windows, group: u32, binding: &mut u32) {
        let Self {
            about,
            name,
            element,
            function,
            gives,
            ..
        } = self;
        let item = |window: u32| self.item.replace('$', &format!("{name}_{window}"));
        let last = windows.count - 1;
        for window in 0..=last {
            // A string takes all that is written to it.
            let _ = writeln!(
                source,
                "@group({group}) @binding({binding}) \
                 var<storage, read> {name}_{window}: array<{element}>;",
            );
            *binding += 1;
        }
        let body = match last {
            0 => format!("    let i = number;\n    {}\n", item(0)),
            _ => {
                let cases: String = (0..last)
                    .map(|window| format!("        case {window}u: {{ {} }}\n", item(window)))
                    .collect();
                format!(
                    "    let i = number & {mask}u;\n    switch number >> {shift}u {{\n\
                     {cases}        default: {{ {} }}\n    }}\n",
                    item(last),
                    mask = (1u64 << windows.shift) - 1,
                    shift = windows.shift,
                )
            }
        };
        let _ = writeln!(
            source,
            "\n// {about}\nfn {function}(number: u32) -> {gives} {{\n{body}}}\n"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_is_whole_until_it_passes_the_limit() {
        assert_eq!(Windows::of(1200, 100, 12), Windows::default());
        // 64 positions a window, the largest power of two that fits.
        let cut = Windows::of(1200, 101, 12);
        assert_eq!(cut, Windows { count: 2, shift: 6 });
        assert_eq!(Windows::of(1200, 129, 12).count, 3);
    }

    #[test]
    fn a_world_that_needs_more_windows_than_a_stage_can_bind_says_so() {
        let windows = WorldWindows {
            corners: Windows { count: 3, shift: 6 },
            ..WorldWindows::default()
        };
        let limits = Limits {
            max_storage_buffers_per_shader_stage: 8,
            ..Limits::default()
        };
        let error = windows.check(&limits).unwrap_err().to_string();
        assert!(error.contains("max_storage_buffers_per_shader_stage"));
        assert!(error.contains("9 storage buffers"), "{error}");
        assert!(WorldWindows::default().check(&limits).is_ok());
    }
}

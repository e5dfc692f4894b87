//! What a loader skipped or repaired: oddities that are no reason to refuse a file.

/// Counts of what was skipped or repaired, with a sentence for the first few of them.
///
/// All zero for a file without oddities, except [`LoadReport::nodes`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadReport {
    /// Nodes of the scene that were visited; not an oddity.
    pub nodes: u64,
    /// Primitives left out: points and lines, or primitives without positions.
    pub skipped_primitives: u64,
    /// Vertices or indices left over that make no whole triangle.
    pub leftover_vertices: u64,
    /// Normal or texture coordinate arrays left out: wrong count, wrong type.
    pub dropped_attributes: u64,
    /// Normals that were not finite or of zero length; the face's normal stands in.
    pub repaired_normals: u64,
    /// Rotations that were not unit quaternions, or matrices whose last row is not 0 0 0 1.
    pub repaired_transforms: u64,
    /// Cameras left out: orthographic, or without a usable angle of view.
    pub skipped_cameras: u64,
    /// Lights left out: of an unknown type.
    pub skipped_lights: u64,
    /// Light values that were out of bounds: colour, intensity, range, cone angles, direction.
    pub repaired_lights: u64,
    /// Lights renamed so that names are unique.
    pub renamed_lights: u64,
    /// Material values out of bounds, or unknown alpha modes.
    pub repaired_materials: u64,
    /// Images that are not there, or that their material does not reach.
    pub missing_images: u64,
    /// Images that are there but could not be decoded.
    pub unreadable_images: u64,
    /// Nodes with a skin that cannot be followed, drawn where they stand: a mesh without joints, or
    /// joints that are not in the scene.
    pub ignored_skins: u64,
    /// Vertices whose weights did not sum to 1 or were negative.
    pub repaired_weights: u64,
    /// Vertices that follow more than four joints: the four heaviest were kept.
    pub dropped_influences: u64,
    /// Animation channels left out: morph weights, nodes that are not in the scene or have a matrix,
    /// values that cannot be read.
    pub skipped_channels: u64,
    /// Animations and skins left out because their JSON lacks what glTF demands.
    pub skipped_rigs: u64,
    /// Primitives with morph targets, drawn without them.
    pub ignored_morphs: u64,
    /// Nodes with `EXT_mesh_gpu_instancing`, drawn once.
    pub ignored_instancing: u64,
    /// Nodes that `KHR_node_visibility` hides, left out with all below them.
    pub hidden_nodes: u64,
    /// Material libraries of an OBJ file that are not there or not readable.
    pub missing_libraries: u64,
    /// Material names of an OBJ file that no library defines.
    pub missing_materials: u64,
    /// OBJ faces with fewer than three corners.
    pub skipped_faces: u64,
    /// OBJ statements that were skipped: curves, surfaces, unknown words.
    pub skipped_statements: u64,
    /// Bytes after the end of a GLB container, or chunks of unknown type.
    pub ignored_chunks: u64,
    /// One sentence for each of the first [`LoadReport::MAX_NOTES`] oddities.
    pub notes: Vec<String>,
}

impl LoadReport {
    /// Most sentences that are kept in [`LoadReport::notes`].
    pub const MAX_NOTES: usize = 32;

    /// Keeps `sentence` if there is room; it is only built then.
    pub(crate) fn note(&mut self, sentence: impl FnOnce() -> String) {
        if self.notes.len() < Self::MAX_NOTES {
            self.notes.push(sentence());
        }
    }

    /// Every count that is not zero, with its name: a table for a person.
    pub fn oddities(&self) -> Vec<(&'static str, u64)> {
        [
            ("skipped_primitives", self.skipped_primitives),
            ("leftover_vertices", self.leftover_vertices),
            ("dropped_attributes", self.dropped_attributes),
            ("repaired_normals", self.repaired_normals),
            ("repaired_transforms", self.repaired_transforms),
            ("skipped_cameras", self.skipped_cameras),
            ("skipped_lights", self.skipped_lights),
            ("repaired_lights", self.repaired_lights),
            ("renamed_lights", self.renamed_lights),
            ("repaired_materials", self.repaired_materials),
            ("missing_images", self.missing_images),
            ("unreadable_images", self.unreadable_images),
            ("ignored_skins", self.ignored_skins),
            ("repaired_weights", self.repaired_weights),
            ("dropped_influences", self.dropped_influences),
            ("skipped_channels", self.skipped_channels),
            ("skipped_rigs", self.skipped_rigs),
            ("ignored_morphs", self.ignored_morphs),
            ("ignored_instancing", self.ignored_instancing),
            ("hidden_nodes", self.hidden_nodes),
            ("missing_libraries", self.missing_libraries),
            ("missing_materials", self.missing_materials),
            ("skipped_faces", self.skipped_faces),
            ("skipped_statements", self.skipped_statements),
            ("ignored_chunks", self.ignored_chunks),
        ]
        .into_iter()
        .filter(|&(_, count)| count > 0)
        .collect()
    }
}

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
    /// Arrays of normals, texture coordinates, joints or weights left out: wrong count, wrong type.
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
    /// Animations left out because their JSON lacks what glTF demands, and all skins if one does.
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
        let mut counts = self.clone();
        let counts = counts.counts().map(|(name, count)| (name, *count));
        counts.into_iter().filter(|&(_, n)| n > 0).collect()
    }

    /// Adds what was found in a file that is placed in this one, whose name is `name`.
    pub(crate) fn add(&mut self, name: &str, mut other: LoadReport) {
        self.nodes += other.nodes;
        for ((_, ours), (_, theirs)) in self.counts().into_iter().zip(other.counts()) {
            *ours += *theirs;
        }
        for sentence in other.notes {
            self.note(|| format!("{name}: {sentence}"));
        }
    }

    /// Every count of oddities.
    fn counts(&mut self) -> [(&'static str, &mut u64); 25] {
        [
            ("skipped_primitives", &mut self.skipped_primitives),
            ("leftover_vertices", &mut self.leftover_vertices),
            ("dropped_attributes", &mut self.dropped_attributes),
            ("repaired_normals", &mut self.repaired_normals),
            ("repaired_transforms", &mut self.repaired_transforms),
            ("skipped_cameras", &mut self.skipped_cameras),
            ("skipped_lights", &mut self.skipped_lights),
            ("repaired_lights", &mut self.repaired_lights),
            ("renamed_lights", &mut self.renamed_lights),
            ("repaired_materials", &mut self.repaired_materials),
            ("missing_images", &mut self.missing_images),
            ("unreadable_images", &mut self.unreadable_images),
            ("ignored_skins", &mut self.ignored_skins),
            ("repaired_weights", &mut self.repaired_weights),
            ("dropped_influences", &mut self.dropped_influences),
            ("skipped_channels", &mut self.skipped_channels),
            ("skipped_rigs", &mut self.skipped_rigs),
            ("ignored_morphs", &mut self.ignored_morphs),
            ("ignored_instancing", &mut self.ignored_instancing),
            ("hidden_nodes", &mut self.hidden_nodes),
            ("missing_libraries", &mut self.missing_libraries),
            ("missing_materials", &mut self.missing_materials),
            ("skipped_faces", &mut self.skipped_faces),
            ("skipped_statements", &mut self.skipped_statements),
            ("ignored_chunks", &mut self.ignored_chunks),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_placed_adds_every_count_and_names_itself() {
        let mut one = LoadReport::default();
        assert_eq!(one.oddities(), []);
        for (number, (_, count)) in (1..).zip(one.counts()) {
            *count = number;
        }
        let counts = one.oddities();
        assert_eq!(counts.len(), one.counts().len());
        one.note(|| "a light is of no known type".to_owned());
        let mut both = one.clone();
        both.add("man", one.clone());
        for ((name, n), (found, twice)) in counts.iter().zip(both.oddities()) {
            assert_eq!((*name, 2 * n), (found, twice));
        }
        assert_eq!(both.notes[1], "man: a light is of no known type");
        for _ in 0..LoadReport::MAX_NOTES {
            both.add("man", one.clone());
        }
        assert_eq!(both.notes.len(), LoadReport::MAX_NOTES);
    }
}

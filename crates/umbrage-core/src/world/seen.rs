//! What changed in a world since somebody last looked.
//!
//! Takes the world as it is; gives the boxes of what moved, before and after. Whoever keeps
//! something for a light (its volume, its shadow map) makes it anew if the light changed, if the
//! fixed triangles did, or if one of these boxes is in its reach.

use glam::Vec3;

use super::{EMPTY_BOX, World};

/// The world as it was at the last look; the default has seen none.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    stamp: u64,
    fixed: u64,
    /// When each object had last changed, and its box.
    objects: Vec<(u64, [Vec3; 2])>,
}

/// What changed between two looks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// The fixed triangles did: it is another world.
    pub fixed: bool,
    /// Boxes of the objects that moved, came or went, before and after; some may be empty.
    pub boxes: Vec<[Vec3; 2]>,
}

impl Seen {
    /// Takes in the world as it is.
    pub fn update(&mut self, world: &World) -> Changes {
        let mut changes = Changes {
            fixed: self.fixed != world.fixed_stamp,
            boxes: Vec::new(),
        };
        if self.stamp == world.stamp {
            return changes;
        }
        let moved = &mut changes.boxes;
        // A world of fewer objects than the last, as of an undo, has lost those.
        let common = world.objects.len().min(self.objects.len());
        moved.extend(self.objects.drain(common..).map(|(_, bounds)| bounds));
        self.objects.resize(world.objects.len(), (0, EMPTY_BOX));
        for (seen, object) in self.objects.iter_mut().zip(&world.objects) {
            if seen.0 != object.changed {
                moved.extend([seen.1, object.bounds]);
                *seen = (object.changed, object.bounds);
            }
        }
        (self.stamp, self.fixed) = (world.stamp, world.fixed_stamp);
        changes
    }
}

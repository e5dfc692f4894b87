//! Rays through the hierarchy.
//!
//! Takes a ray in f64; gives the slots of the leaves that it may meet. Invariant: the slab test only
//! ever errs towards visiting, so no rounding loses a triangle.
//! Source: Ize 2013, "Robust BVH Ray Traversal" (padding of the slab distances).

use std::ops::ControlFlow;

use glam::DVec3;

use super::{Box3, Bvh};

const STACK_SIZE: usize = 96;
/// Relative error bound of a slab distance: three roundings, and one more for the direction, are
/// 4 * 2^-53; this is eight times that.
const SLAB_PAD: f64 = 1.0 / (1u64 << 48) as f64;
/// A direction component below this moves less than any f32 coordinate can tell.
const PARALLEL: f64 = 1e-150;

impl Bvh {
    /// Visits the slots of every leaf whose box the ray `origin + t * direction`,
    /// `0 <= t <= t_max`, may meet, roughly from near to far. The visitor gets a slot, and gives
    /// the new `t_max`, or breaks.
    pub(crate) fn visit(
        &self,
        origin: DVec3,
        direction: DVec3,
        mut t_max: f64,
        mut visitor: impl FnMut(usize, f64) -> ControlFlow<(), f64>,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let slab = Slab::new(origin, direction);
        let mut stack = [(0u32, 0f64); STACK_SIZE];
        let mut height = 0;
        let push = |stack: &mut [(u32, f64); STACK_SIZE], height: &mut usize, entry| {
            stack[*height] = entry;
            *height += 1;
        };
        if let Some(t) = slab.entry(&self.nodes[0].bounds, t_max) {
            push(&mut stack, &mut height, (0, t));
        }
        while height > 0 {
            height -= 1;
            let (index, entry) = stack[height];
            if entry > t_max {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                for slot in node.first..node.first + node.count {
                    match visitor(slot as usize, t_max) {
                        ControlFlow::Continue(t) => t_max = t,
                        ControlFlow::Break(()) => return,
                    }
                }
                continue;
            }
            let (left, right) = (node.first, node.first + 1);
            let near = slab.entry(&self.nodes[left as usize].bounds, t_max);
            let far = slab.entry(&self.nodes[right as usize].bounds, t_max);
            match (near, far) {
                (Some(a), Some(b)) if a <= b => {
                    push(&mut stack, &mut height, (right, b));
                    push(&mut stack, &mut height, (left, a));
                }
                (Some(a), Some(b)) => {
                    push(&mut stack, &mut height, (left, a));
                    push(&mut stack, &mut height, (right, b));
                }
                (Some(a), None) => push(&mut stack, &mut height, (left, a)),
                (None, Some(b)) => push(&mut stack, &mut height, (right, b)),
                (None, None) => {}
            }
        }
    }
}

/// A ray made ready for boxes.
struct Slab {
    origin: DVec3,
    inverse: DVec3,
    parallel: [bool; 3],
}

impl Slab {
    fn new(origin: DVec3, direction: DVec3) -> Self {
        let parallel = direction.to_array().map(|d| d.abs() < PARALLEL);
        Self {
            origin,
            inverse: direction.recip(),
            parallel,
        }
    }

    /// Where the ray enters the box, rounded down, if it may do so before `t_max`.
    #[inline]
    fn entry(&self, bounds: &Box3, t_max: f64) -> Option<f64> {
        let (mut near, mut far) = (0.0, t_max);
        for axis in 0..3 {
            let below = f64::from(bounds.min[axis]) - self.origin[axis];
            let above = f64::from(bounds.max[axis]) - self.origin[axis];
            if self.parallel[axis] {
                if below > 1e-100 || above < -1e-100 {
                    return None;
                }
                continue;
            }
            let (a, b) = (below * self.inverse[axis], above * self.inverse[axis]);
            let (enter, leave) = if a < b { (a, b) } else { (b, a) };
            near = f64::max(near, enter - enter.abs() * SLAB_PAD);
            far = f64::min(far, leave + leave.abs() * SLAB_PAD);
        }
        (near <= far).then_some(near)
    }
}

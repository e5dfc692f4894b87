//! Checks a hierarchy against the triangles it was built from.

use glam::DVec3;

use super::{Box3, Bvh};

/// What is wrong with a hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Invalid {
    /// The slot lies in no leaf, or in more than one.
    Slot { slot: usize, leaves: u32 },
    /// The triangle in this slot sticks out of an ancestor's box.
    Outside { slot: usize, node: usize },
    /// The node is reached twice, or never.
    Node { node: usize, times: u32 },
}

impl Bvh {
    /// Whether every slot lies in exactly one leaf, and in the box of each of its ancestors.
    pub(crate) fn validate(&self, corners: &[[DVec3; 3]], order: &[u32]) -> Result<(), Invalid> {
        let mut leaves = vec![0; order.len()];
        let mut times = vec![0; self.nodes.len()];
        let mut open = Vec::new();
        if !self.nodes.is_empty() {
            open.push((0usize, Vec::new()));
        }
        while let Some((node, mut path)) = open.pop() {
            times[node] += 1;
            if times[node] > 1 {
                break;
            }
            path.push(node);
            let (first, count) = (
                self.nodes[node].first as usize,
                self.nodes[node].count as usize,
            );
            if count == 0 {
                open.push((first, path.clone()));
                open.push((first + 1, path));
                continue;
            }
            for slot in first..first + count {
                leaves[slot] += 1;
                for &ancestor in &path {
                    let Box3 { min, max } = self.nodes[ancestor].bounds;
                    let inside = corners[order[slot] as usize]
                        .iter()
                        .all(|c| c.cmpge(min.as_dvec3()).all() && c.cmple(max.as_dvec3()).all());
                    if !inside {
                        return Err(Invalid::Outside {
                            slot,
                            node: ancestor,
                        });
                    }
                }
            }
        }
        if let Some(node) = times.iter().position(|&n| n != 1) {
            return Err(Invalid::Node {
                node,
                times: times[node],
            });
        }
        match leaves.iter().position(|&n| n != 1) {
            Some(slot) => Err(Invalid::Slot {
                slot,
                leaves: leaves[slot],
            }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip(count: u32) -> (Vec<[DVec3; 3]>, Vec<u32>) {
        let corners = (0..count)
            .map(|k| [0.0, 1.0, 2.5].map(|x| DVec3::new(f64::from(k) + x, x * x, f64::from(k % 7))))
            .collect();
        (corners, (0..count).collect())
    }

    #[test]
    fn builds_are_valid_at_every_size() {
        for count in [0, 1, 2, 4, 5, 63, 1024, 1025, 9000] {
            let (corners, mut order) = strip(count);
            let bvh = Bvh::build(&corners, &mut order);
            assert_eq!(bvh.validate(&corners, &order), Ok(()));
            order.sort_unstable();
            assert!(order.iter().enumerate().all(|(k, &t)| k == t as usize));
        }
    }

    #[test]
    fn broken_hierarchies_are_found() {
        let (corners, mut order) = strip(100);
        let bvh = Bvh::build(&corners, &mut order);
        let mut shrunk = bvh.clone();
        shrunk.nodes[1].bounds.max.x -= 0.5;
        let found = shrunk.validate(&corners, &order);
        assert!(
            matches!(found, Err(Invalid::Outside { node: 1, .. })),
            "{found:?}"
        );
        let mut lost = bvh.clone();
        let leaf = lost.nodes.iter().position(|n| n.count > 1).unwrap();
        lost.nodes[leaf].count -= 1;
        assert!(matches!(
            lost.validate(&corners, &order),
            Err(Invalid::Slot { leaves: 0, .. })
        ));
        let mut twice = bvh;
        twice.nodes[0].first = 3;
        assert!(matches!(
            twice.validate(&corners, &order),
            Err(Invalid::Node { .. })
        ));
    }
}

//! Every invariant of a [`World`], checked from scratch. Debug builds run it after each build.

use thiserror::Error;

use super::World;
use super::clusters::LANES;

/// A broken invariant, with the item at fault.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum WorldFault {
    /// Parallel arrays differ in length.
    #[error("array {array} has {found} entries for {expected} triangles")]
    Length {
        /// Which array.
        array: &'static str,
        /// Its length.
        found: usize,
        /// Triangles.
        expected: usize,
    },
    /// A triangle's use of an edge does not join its own corners in its own direction.
    #[error("side {side} of triangle {triangle} does not match its edge {edge}")]
    EdgeUse {
        /// Triangle.
        triangle: usize,
        /// 0, 1 or 2.
        side: usize,
        /// Edge it claims.
        edge: u32,
    },
    /// Two edges join the same vertices, or one is stored upper vertex first.
    #[error("edge {edge} is not unique or not ordered")]
    EdgeNotUnique {
        /// Edge.
        edge: usize,
    },
    /// Edges or vertices are not numbered by first use.
    #[error("{what} {number} is used before lower numbers are")]
    NotFirstUse {
        /// "edge" or "vertex".
        what: &'static str,
        /// Its number.
        number: u32,
    },
    /// Two vertices have the same position.
    #[error("vertices {first} and {second} stand at the same place")]
    NotWelded {
        /// One.
        first: u32,
        /// The other.
        second: u32,
    },
    /// A cluster is wrong about who else is on a side's edge.
    #[error("the cluster of triangle {triangle} is wrong about the edge of its side {side}")]
    Cluster {
        /// Triangle.
        triangle: u32,
        /// 0, 1 or 2.
        side: usize,
    },
    /// A triangle leaves the box of a node above it.
    #[error("triangle {triangle} leaves the box of node {node} above it")]
    OutsideBox {
        /// Triangle.
        triangle: u32,
        /// Node.
        node: usize,
    },
    /// A node's range is not the ranges of its children in order.
    #[error("node {node} does not cover exactly its children's triangles")]
    Range {
        /// Node.
        node: usize,
    },
}

impl World {
    /// Checks every invariant; cost is linear times the depth of the tree.
    pub fn validate(&self) -> Result<(), WorldFault> {
        self.validate_topology()?;
        self.validate_welded()
    }

    /// All but that positions are distinct, which those of an object that deforms need not be.
    pub(super) fn validate_topology(&self) -> Result<(), WorldFault> {
        self.validate_lengths()?;
        self.validate_edges()?;
        self.validate_vertices()?;
        self.validate_clusters()?;
        self.validate_tree()
    }

    fn validate_lengths(&self) -> Result<(), WorldFault> {
        let expected = self.triangles.len();
        for (array, found) in [
            ("source", self.source.len()),
            ("casting", self.casting.len()),
        ] {
            if found != expected {
                return Err(WorldFault::Length {
                    array,
                    found,
                    expected,
                });
            }
        }
        let expected = expected.div_ceil(LANES);
        for (array, found) in [
            ("edges.sides", self.edges.sides.len()),
            ("planes", self.planes.clusters.len()),
            ("clusters", self.clusters.len()),
        ] {
            if found != expected {
                return Err(WorldFault::Length {
                    array,
                    found,
                    expected,
                });
            }
        }
        Ok(())
    }

    fn validate_edges(&self) -> Result<(), WorldFault> {
        let mut next = 0;
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for (side, u) in self
                .edges
                .of_triangle(triangle as u32)
                .into_iter()
                .enumerate()
            {
                let along = [corners[side], corners[(side + 1) % 3]];
                let Some(&[low, high]) = self.edges.vertices.get(u.edge() as usize) else {
                    return Err(WorldFault::EdgeUse {
                        triangle,
                        side,
                        edge: u.edge(),
                    });
                };
                let stored = if u.sign() > 0 {
                    [low, high]
                } else {
                    [high, low]
                };
                if stored != along {
                    return Err(WorldFault::EdgeUse {
                        triangle,
                        side,
                        edge: u.edge(),
                    });
                }
                if u.edge() > next {
                    return Err(WorldFault::NotFirstUse {
                        what: "edge",
                        number: u.edge(),
                    });
                }
                next = next.max(u.edge() + 1);
            }
        }
        let mut order: Vec<usize> = (0..self.edges.vertices.len()).collect();
        order.sort_unstable_by_key(|&e| self.edges.vertices[e]);
        for pair in order.windows(2) {
            if self.edges.vertices[pair[0]] == self.edges.vertices[pair[1]] {
                return Err(WorldFault::EdgeNotUnique { edge: pair[1] });
            }
        }
        match self.edges.vertices.iter().position(|v| v[0] >= v[1]) {
            Some(edge) => Err(WorldFault::EdgeNotUnique { edge }),
            None => Ok(()),
        }
    }

    /// A side has a partner, or needs a counter, exactly as the number and winding of the
    /// triangles on its edge say.
    fn validate_clusters(&self) -> Result<(), WorldFault> {
        let mut on_edge = vec![Vec::new(); self.edges.vertices.len()];
        for t in 0..self.triangles.len() as u32 {
            for (k, u) in self.edges.of_triangle(t).into_iter().enumerate() {
                on_edge[u.edge() as usize].push((t, k, u.sign()));
            }
        }
        for &(t, k, sign) in on_edge.iter().flatten() {
            let at = &self.clusters[t as usize / LANES].sides[k];
            let (lane, bit) = (t as usize % LANES, 1 << (t as usize % LANES));
            let edge = self.edges.of_triangle(t)[k].edge();
            let partner = match on_edge[edge as usize][..] {
                [(a, _, s), (b, _, r)] if s != r && a as usize / LANES == b as usize / LANES => {
                    Some(if a == t && s == sign { b } else { a })
                }
                _ => None,
            };
            let alone = on_edge[edge as usize].len() == 1;
            let as_stored = (at.paired & bit != 0).then_some(usize::from(at.partner[lane]));
            let shared = at.shared & bit != 0;
            if as_stored != partner.map(|p| p as usize % LANES)
                || shared != (partner.is_none() && !alone)
            {
                return Err(WorldFault::Cluster {
                    triangle: t,
                    side: k,
                });
            }
        }
        Ok(())
    }

    fn validate_vertices(&self) -> Result<(), WorldFault> {
        let mut next = 0;
        for &v in self.triangles.iter().flatten() {
            if v > next || v as usize >= self.positions.len() {
                return Err(WorldFault::NotFirstUse {
                    what: "vertex",
                    number: v,
                });
            }
            next = next.max(v + 1);
        }
        Ok(())
    }

    fn validate_welded(&self) -> Result<(), WorldFault> {
        let key = |v: u32| self.places().at(v).to_array().map(f64::to_bits);
        let mut order: Vec<u32> = (0..self.positions.len() as u32).collect();
        order.sort_unstable_by_key(|&v| key(v));
        for pair in order.windows(2) {
            if key(pair[0]) == key(pair[1]) {
                return Err(WorldFault::NotWelded {
                    first: pair[0],
                    second: pair[1],
                });
            }
        }
        Ok(())
    }

    fn validate_tree(&self) -> Result<(), WorldFault> {
        let nodes = &self.bvh.nodes;
        let whole = nodes.first().map_or(0..0, super::Node::range);
        if whole != (0..self.triangles.len() as u32) {
            return Err(WorldFault::Range { node: 0 });
        }
        for (i, node) in nodes.iter().enumerate() {
            for triangle in node.range() {
                let inside = self.corners(triangle).iter().all(|p| {
                    p.cmpge(node.min.as_dvec3()).all() && p.cmple(node.max.as_dvec3()).all()
                });
                if !inside {
                    return Err(WorldFault::OutsideBox { triangle, node: i });
                }
            }
            if !node.is_leaf() {
                let first = &nodes[i + 1];
                let second = &nodes[node.second as usize];
                let joined = first.first == node.first
                    && second.first == first.first + first.count
                    && first.count + second.count == node.count;
                if !joined {
                    return Err(WorldFault::Range { node: i });
                }
            }
        }
        Ok(())
    }
}

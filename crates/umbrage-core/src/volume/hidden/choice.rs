//! Which of the hidden casters to leave out: those whose absence leaves the fewest quads.
//!
//! Takes casters with marks; takes the mark from those that are better left in. Any set of hidden
//! casters may be dropped, but one whose neighbours stay leaves its edges open. The number of
//! quads is the sum over edges of |counter|. An edge of two hidden casters wound alike costs a
//! quad if one of them stays and the other goes, an edge of one hidden caster costs according to
//! what else is on it: so the best set is a minimum cut. Where more than two casters share an edge
//! the cost need not have that form; single changes that lower the true sum follow.

use super::Found;
use super::cut::MinimumCut;
use crate::volume::{QuadRange, QuadReach};
use crate::world::World;

/// What an edge's quad costs if it may touch the light's reach, and if not.
const COST: [i32; 2] = [16, 1];
/// Passes of single changes at most.
const PASSES: usize = 4;

/// Scratch.
#[derive(Debug, Default)]
pub(super) struct Choice {
    /// By world edge: 1 + index into `edges`; 0 between calls.
    slots: Vec<u32>,
    edges: Vec<HiddenEdge>,
    nodes: Vec<Node>,
    cut: MinimumCut,
}

/// An edge of a hidden caster.
#[derive(Clone, Copy, Debug)]
struct HiddenEdge {
    edge: u32,
    cost: i32,
    /// Sum of the signs of the casters that are not hidden; later also of those that stay.
    counter: i32,
    /// How many hidden casters use it; the first two, as node and side.
    users: u32,
    first: [(u32, u8); 2],
    /// Sum of the signs of the hidden casters.
    hidden: i32,
}

/// A hidden caster.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Its number among the casters.
    caster: u32,
    /// Its edges, and its sign on them.
    edges: [u32; 3],
    signs: [i32; 3],
    stays: bool,
}

impl Choice {
    /// Takes the mark `hidden` from casters that are better left in.
    pub(super) fn choose(&mut self, world: &World, reach: &QuadReach, found: &mut [Found]) {
        self.collect(world, reach, found);
        self.count_others(world, found);
        let all = self.edges.iter();
        let before: i64 = all.map(|e| e.cost_at(e.counter + e.hidden)).sum();
        self.fill_cut();
        self.cut.solve();
        for (i, node) in (0u32..).zip(&mut self.nodes) {
            if self.cut.stays(i) {
                node.change(&mut self.edges);
            }
        }
        self.improve();
        let after: i64 = self.edges.iter().map(|e| e.cost_at(e.counter)).sum();
        let worse = after > before;
        for node in &self.nodes {
            found[node.caster as usize].hidden = !(worse || node.stays);
        }
        for edge in &self.edges {
            self.slots[edge.edge as usize] = 0;
        }
    }

    /// Hidden casters and their edges.
    fn collect(&mut self, world: &World, reach: &QuadReach, found: &[Found]) {
        self.slots.resize(world.edges.vertices.len(), 0);
        self.edges.clear();
        self.nodes.clear();
        for (caster, found) in (0u32..).zip(found).filter(|(_, found)| found.hidden) {
            let mut node = Node {
                caster,
                edges: [0; 3],
                signs: [0; 3],
                stays: false,
            };
            let uses = world.edges.of_triangle(found.triangle.triangle());
            for (k, u) in (0u8..).zip(uses) {
                let slot = &mut self.slots[u.edge() as usize];
                if *slot == 0 {
                    let ends = world.edges.vertices[u.edge() as usize];
                    let range = reach.of_edge(ends.map(|v| world.places().at(v)));
                    self.edges.push(HiddenEdge {
                        edge: u.edge(),
                        cost: COST[usize::from(range != QuadRange::Reach)],
                        counter: 0,
                        users: 0,
                        first: [(0, 0); 2],
                        hidden: 0,
                    });
                    *slot = self.edges.len() as u32;
                }
                let edge = &mut self.edges[*slot as usize - 1];
                if let Some(first) = edge.first.get_mut(edge.users as usize) {
                    *first = (self.nodes.len() as u32, k);
                }
                edge.users += 1;
                let sign = u.sign() * found.triangle.coefficient();
                edge.hidden += sign;
                node.edges[k as usize] = *slot - 1;
                node.signs[k as usize] = sign;
            }
            self.nodes.push(node);
        }
    }

    /// What casters that are not hidden leave on these edges.
    fn count_others(&mut self, world: &World, found: &[Found]) {
        for found in found.iter().filter(|found| !found.hidden) {
            for u in world.edges.of_triangle(found.triangle.triangle()) {
                let slot = self.slots[u.edge() as usize];
                if slot != 0 {
                    self.edges[slot as usize - 1].counter +=
                        u.sign() * found.triangle.coefficient();
                }
            }
        }
    }

    /// Costs of edges as gains and links.
    fn fill_cut(&mut self) {
        self.cut.reset(self.nodes.len());
        for edge in self.edges.iter().filter(|edge| edge.is_link()) {
            self.cut.link(edge.first, edge.cost);
        }
        for (i, node) in (0u32..).zip(&self.nodes) {
            for (e, sign) in node.edges.into_iter().zip(node.signs) {
                let edge = &self.edges[e as usize];
                if !edge.is_link() && !edge.is_open(sign) {
                    let change = (edge.counter + sign).abs() - edge.counter.abs();
                    self.cut.add_gain(i, -edge.cost * change);
                }
            }
        }
    }

    /// Changes single casters as long as that lowers the sum.
    fn improve(&mut self) {
        for _ in 0..PASSES {
            let mut changed = false;
            for node in &mut self.nodes {
                let way = node.way();
                let sides = node.edges.into_iter().zip(node.signs);
                let change: i32 = sides
                    .map(|(e, sign)| {
                        let edge = &self.edges[e as usize];
                        edge.cost * ((edge.counter + way * sign).abs() - edge.counter.abs())
                    })
                    .sum();
                if change < 0 {
                    node.change(&mut self.edges);
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
    }
}

impl HiddenEdge {
    /// Cost of a counter.
    fn cost_at(&self, counter: i32) -> i64 {
        i64::from(self.cost) * i64::from(counter.abs())
    }

    /// Whether it joins two hidden casters wound alike and nothing else counts on it.
    fn is_link(&self) -> bool {
        self.users == 2 && self.hidden == 0 && self.counter == 0
    }

    /// Whether what a caster of that sign changes depends on other hidden ones.
    fn is_open(&self, sign: i32) -> bool {
        let alone = self.users == 1 || self.users == 2 && self.hidden == 0;
        !alone && self.counter == -sign
    }
}

impl Node {
    /// +1 if it would come, -1 if it would go.
    fn way(&self) -> i32 {
        if self.stays { -1 } else { 1 }
    }

    /// Comes or goes.
    fn change(&mut self, edges: &mut [HiddenEdge]) {
        let way = self.way();
        self.stays = !self.stays;
        for (e, sign) in self.edges.into_iter().zip(self.signs) {
            edges[e as usize].counter += way * sign;
        }
    }
}

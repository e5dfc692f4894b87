//! Which of the hidden casters to leave out: those whose absence leaves the fewest quads.
//!
//! Takes casters with verdicts; gives the set to drop. Any set of hidden casters may be dropped,
//! but one whose neighbours stay leaves its edges open. The number of quads is the sum over edges
//! of |counter|. An edge between two hidden casters wound alike costs a quad if one of them stays
//! and the other goes, an edge with one hidden caster costs according to what else is on it: so
//! the best set is a minimum cut, found here by blocking flows (Dinic 1970) with at most three
//! arcs a node. Edges of more than two casters need not fit that model: single flips that lower
//! the true sum follow.

use super::Found;
use crate::volume::{QuadRange, QuadReach};
use crate::world::World;

/// What an edge's quad costs if it may touch the light's reach, and if not.
const COST: [i32; 2] = [16, 1];
/// Blocking flows at most; whatever cut is found by then is used.
const FLOWS: usize = 64;
const NONE: u32 = u32::MAX;
const UNREACHED: u32 = u32::MAX;

/// Scratch.
#[derive(Debug, Default)]
pub(super) struct Choice {
    /// By world edge: 1 + index into `edges`, 0 between calls.
    slots: Vec<u32>,
    edges: Vec<HiddenEdge>,
    nodes: Vec<Node>,
    level: Vec<u32>,
    next_arc: Vec<u8>,
    queue: Vec<u32>,
    path: Vec<(u32, u8)>,
}

/// An edge of a hidden caster.
#[derive(Clone, Copy, Debug)]
struct HiddenEdge {
    edge: u32,
    cost: i32,
    /// Sum of the signs of the casters that stay; later the counter.
    counter: i32,
    /// How many hidden casters use it; the first two, as node and side.
    users: u32,
    node: [u32; 2],
    side: [u8; 2],
}

/// A hidden caster.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Its number among the casters.
    caster: u32,
    /// Its edges, and its sign on them.
    edges: [u32; 3],
    signs: [i32; 3],
    /// What leaving it in saves; negative: costs. Later what flow leaves of it.
    gain: i32,
    arcs: [Arc; 3],
    stays: bool,
}

#[derive(Clone, Copy, Debug)]
struct Arc {
    to: u32,
    back: u8,
    room: i32,
}

impl Choice {
    /// Takes the mark `hidden` from casters that are better left in.
    pub(super) fn choose(&mut self, world: &World, reach: &QuadReach, found: &mut [Found]) {
        self.collect(world, reach, found);
        self.terms();
        for _ in 0..FLOWS {
            if !self.flow() {
                break;
            }
        }
        self.take_cut();
        self.flip();
        for node in &self.nodes {
            found[node.caster as usize].hidden = !node.stays;
        }
        for edge in &self.edges {
            self.slots[edge.edge as usize] = 0;
        }
    }

    fn collect(&mut self, world: &World, reach: &QuadReach, found: &[Found]) {
        self.slots.resize(world.edges.vertices.len(), 0);
        self.edges.clear();
        self.nodes.clear();
        for (number, caster) in (0u32..).zip(found) {
            if !caster.hidden {
                continue;
            }
            let mut node = Node {
                caster: number,
                edges: [0; 3],
                signs: [0; 3],
                gain: 0,
                arcs: [Arc {
                    to: NONE,
                    back: 0,
                    room: 0,
                }; 3],
                stays: false,
            };
            for (k, u) in world
                .edges
                .of_triangle(caster.triangle.triangle())
                .into_iter()
                .enumerate()
            {
                let slot = &mut self.slots[u.edge() as usize];
                if *slot == 0 {
                    let ends = world.edges.vertices[u.edge() as usize];
                    let range = reach.of_edge(ends.map(|v| world.positions[v as usize]));
                    self.edges.push(HiddenEdge {
                        edge: u.edge(),
                        cost: COST[usize::from(range != QuadRange::Reach)],
                        counter: 0,
                        users: 0,
                        node: [NONE; 2],
                        side: [0; 2],
                    });
                    *slot = self.edges.len() as u32;
                }
                let edge = &mut self.edges[*slot as usize - 1];
                if edge.users < 2 {
                    edge.node[edge.users as usize] = self.nodes.len() as u32;
                    edge.side[edge.users as usize] = k as u8;
                }
                edge.users += 1;
                node.edges[k] = *slot - 1;
                node.signs[k] = u.sign() * caster.triangle.coefficient();
            }
            self.nodes.push(node);
        }
        for caster in found.iter().filter(|caster| !caster.hidden) {
            for u in world.edges.of_triangle(caster.triangle.triangle()) {
                let slot = self.slots[u.edge() as usize];
                if slot != 0 {
                    self.edges[slot as usize - 1].counter +=
                        u.sign() * caster.triangle.coefficient();
                }
            }
        }
    }

    /// Costs of edges as gains and arcs.
    fn terms(&mut self) {
        for edge in &self.edges {
            let [i, j] = edge.node;
            let [k, l] = edge.side;
            let sign = |node: u32, side: u8| self.nodes[node as usize].signs[side as usize];
            if edge.users == 2 && edge.counter == 0 && sign(i, k) != sign(j, l) {
                let arc = |to, back| Arc {
                    to,
                    back,
                    room: edge.cost,
                };
                self.nodes[i as usize].arcs[k as usize] = arc(j, l);
                self.nodes[j as usize].arcs[l as usize] = arc(i, k);
            }
        }
        for node in &mut self.nodes {
            for k in 0..3 {
                let edge = &self.edges[node.edges[k] as usize];
                let sign = node.signs[k];
                node.gain -= if node.arcs[k].to != NONE {
                    0
                } else if edge.users > 1 && edge.counter == -sign {
                    // What the others do decides between -1 and +1.
                    0
                } else {
                    edge.cost * ((edge.counter + sign).abs() - edge.counter.abs())
                };
            }
        }
    }

    /// One blocking flow from nodes with gain to nodes with loss; false if there is no path.
    fn flow(&mut self) -> bool {
        self.queue.clear();
        self.level.clear();
        self.level.resize(self.nodes.len(), UNREACHED);
        for (i, node) in (0u32..).zip(&self.nodes) {
            if node.gain > 0 {
                self.level[i as usize] = 0;
                self.queue.push(i);
            }
        }
        let sources = self.queue.len();
        let mut at = 0;
        let mut last = UNREACHED;
        while at < self.queue.len() {
            let i = self.queue[at] as usize;
            at += 1;
            if self.level[i] >= last {
                break;
            }
            for arc in self.nodes[i].arcs {
                if arc.room > 0 && self.level[arc.to as usize] == UNREACHED {
                    self.level[arc.to as usize] = self.level[i] + 1;
                    self.queue.push(arc.to);
                    if self.nodes[arc.to as usize].gain < 0 {
                        last = last.min(self.level[i] + 1);
                    }
                }
            }
        }
        if last == UNREACHED {
            return false;
        }
        self.next_arc.clear();
        self.next_arc.resize(self.nodes.len(), 0);
        for source in 0..sources {
            self.push_from(self.queue[source]);
        }
        true
    }

    fn push_from(&mut self, source: u32) {
        self.path.clear();
        let mut at = source as usize;
        while self.nodes[source as usize].gain > 0 {
            if self.nodes[at].gain < 0 {
                let mut amount = self.nodes[source as usize].gain.min(-self.nodes[at].gain);
                for &(i, k) in &self.path {
                    amount = amount.min(self.nodes[i as usize].arcs[k as usize].room);
                }
                self.nodes[source as usize].gain -= amount;
                self.nodes[at].gain += amount;
                for &(i, k) in &self.path {
                    let arc = &mut self.nodes[i as usize].arcs[k as usize];
                    arc.room -= amount;
                    let (to, back) = (arc.to, arc.back);
                    self.nodes[to as usize].arcs[back as usize].room += amount;
                }
                self.path.clear();
                at = source as usize;
                continue;
            }
            let k = self.next_arc[at];
            if k == 3 {
                let Some((before, _)) = self.path.pop() else {
                    return;
                };
                at = before as usize;
                self.next_arc[at] += 1;
                continue;
            }
            let arc = self.nodes[at].arcs[k as usize];
            if arc.room > 0 && self.level[arc.to as usize] == self.level[at] + 1 {
                self.path.push((at as u32, k));
                at = arc.to as usize;
            } else {
                self.next_arc[at] += 1;
            }
        }
    }

    /// Casters that nodes with gain left can still reach stay.
    fn take_cut(&mut self) {
        self.queue.clear();
        for i in 0..self.nodes.len() {
            if self.nodes[i].gain > 0 {
                self.nodes[i].stays = true;
                self.queue.push(i as u32);
            }
        }
        while let Some(i) = self.queue.pop() {
            for arc in self.nodes[i as usize].arcs {
                if arc.room > 0 && !self.nodes[arc.to as usize].stays {
                    self.nodes[arc.to as usize].stays = true;
                    self.queue.push(arc.to);
                }
            }
        }
        for node in self.nodes.iter().filter(|node| node.stays) {
            for k in 0..3 {
                self.edges[node.edges[k] as usize].counter += node.signs[k];
            }
        }
    }

    /// Changes single casters as long as that lowers the sum.
    fn flip(&mut self) {
        for _ in 0..4 {
            let mut changed = false;
            for node in &mut self.nodes {
                let way = if node.stays { -1 } else { 1 };
                let change: i32 = (0..3)
                    .map(|k| {
                        let edge = &self.edges[node.edges[k] as usize];
                        let after = edge.counter + way * node.signs[k];
                        edge.cost * (after.abs() - edge.counter.abs())
                    })
                    .sum();
                if change < 0 {
                    changed = true;
                    node.stays = !node.stays;
                    for k in 0..3 {
                        self.edges[node.edges[k] as usize].counter += way * node.signs[k];
                    }
                }
            }
            if !changed {
                break;
            }
        }
    }
}

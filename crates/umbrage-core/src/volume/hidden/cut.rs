//! Minimum cut of a graph of at most three arcs a node, by blocking flows.
//!
//! Takes nodes with a gain for staying (negative: a loss) and arcs with a cost if one end stays
//! and the other goes; gives the set that stays, the smallest of those with the highest sum of
//! gains less costs. Source: Dinic, "Algorithm for solution of a problem of maximum flow in
//! networks with power estimation" (1970); the cut that the last search leaves behind.

const NONE: u32 = u32::MAX;

/// Blocking flows at most. Cut short, the result is a set like any other, only not the best.
const FLOWS: usize = 64;

/// The graph, and scratch.
#[derive(Debug, Default)]
pub(super) struct MinimumCut {
    nodes: Vec<Node>,
    level: Vec<u32>,
    next_arc: Vec<u8>,
    queue: Vec<u32>,
    path: Vec<(u32, u8)>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    /// What flow leaves of it.
    gain: i32,
    arcs: [Arc; 3],
    stays: bool,
}

#[derive(Clone, Copy, Debug)]
struct Arc {
    to: u32,
    /// Which of the other node's arcs runs back.
    back: u8,
    room: i32,
}

impl MinimumCut {
    /// As many nodes without gain or arcs, replacing what was there.
    pub(super) fn reset(&mut self, nodes: usize) {
        let arc = Arc {
            to: NONE,
            back: 0,
            room: 0,
        };
        self.nodes.clear();
        self.nodes.resize(
            nodes,
            Node {
                gain: 0,
                arcs: [arc; 3],
                stays: false,
            },
        );
    }

    /// Adds to what is gained if `node` stays.
    pub(super) fn add_gain(&mut self, node: u32, gain: i32) {
        self.nodes[node as usize].gain += gain;
    }

    /// Costs `cost` if one of two nodes stays and the other goes. Each is given with the number
    /// of its arc, below 3 and not yet taken.
    pub(super) fn link(&mut self, [(a, k), (b, l)]: [(u32, u8); 2], cost: i32) {
        let arc = |to, back| Arc {
            to,
            back,
            room: cost,
        };
        self.nodes[a as usize].arcs[k as usize] = arc(b, l);
        self.nodes[b as usize].arcs[l as usize] = arc(a, k);
    }

    /// Decides which nodes stay.
    pub(super) fn solve(&mut self) {
        for _ in 0..FLOWS {
            if !self.find_levels() {
                break;
            }
            self.next_arc.clear();
            self.next_arc.resize(self.nodes.len(), 0);
            for i in 0..self.nodes.len() as u32 {
                if self.level[i as usize] == 0 {
                    self.push_from(i);
                }
            }
        }
        self.take();
    }

    /// Whether `node` stays.
    pub(super) fn stays(&self, node: u32) -> bool {
        self.nodes[node as usize].stays
    }

    /// Steps from the nearest node with gain, up to the first with loss; false if there is none.
    fn find_levels(&mut self) -> bool {
        self.queue.clear();
        self.level.clear();
        self.level.resize(self.nodes.len(), NONE);
        for (i, node) in (0u32..).zip(&self.nodes) {
            if node.gain > 0 {
                self.level[i as usize] = 0;
                self.queue.push(i);
            }
        }
        let (mut at, mut last) = (0, NONE);
        while at < self.queue.len() {
            let i = self.queue[at] as usize;
            at += 1;
            if self.level[i] >= last {
                break;
            }
            for arc in self.nodes[i].arcs {
                if arc.room > 0 && self.level[arc.to as usize] == NONE {
                    self.level[arc.to as usize] = self.level[i] + 1;
                    self.queue.push(arc.to);
                    if self.nodes[arc.to as usize].gain < 0 {
                        last = last.min(self.level[i] + 1);
                    }
                }
            }
        }
        last != NONE
    }

    /// Sends the gain of `source` down the levels, path by path.
    fn push_from(&mut self, source: u32) {
        self.path.clear();
        let mut at = source as usize;
        while self.nodes[source as usize].gain > 0 {
            if self.nodes[at].gain < 0 {
                self.send(source as usize, at);
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

    /// As much as the path takes.
    fn send(&mut self, source: usize, sink: usize) {
        let ends = self.nodes[source].gain.min(-self.nodes[sink].gain);
        let rooms = self.path.iter();
        let rooms = rooms.map(|&(i, k)| self.nodes[i as usize].arcs[k as usize].room);
        let amount = rooms.fold(ends, i32::min);
        self.nodes[source].gain -= amount;
        self.nodes[sink].gain += amount;
        for &(i, k) in &self.path {
            let arc = &mut self.nodes[i as usize].arcs[k as usize];
            arc.room -= amount;
            let (to, back) = (arc.to as usize, arc.back as usize);
            self.nodes[to].arcs[back].room += amount;
        }
    }

    /// Nodes that gain left over can still reach stay.
    fn take(&mut self) {
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
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against all sets of up to ten nodes: strips of triangles and rings of them.
    #[test]
    fn no_set_is_better() {
        let mut state = 3u64;
        let mut below = move |n: u64| {
            state = state
                .wrapping_mul(0x5851_f42d_4c95_7f2d)
                .wrapping_add(0x1405_7b7e_f767_814f);
            (state >> 33) % n
        };
        let mut cut = MinimumCut::default();
        let (mut some, mut all) = (0, 0);
        for _ in 0..500 {
            let n = 3 + below(8) as u32;
            let gains: Vec<i32> = (0..n).map(|_| below(9) as i32 - 4).collect();
            let mut links = Vec::new();
            cut.reset(n as usize);
            for i in 0..n {
                cut.add_gain(i, gains[i as usize]);
                if i + 1 < n || below(2) == 0 {
                    links.push((i, (i + 1) % n, below(4) as i32));
                    cut.link([(i, 1), ((i + 1) % n, 0)], links[i as usize].2);
                }
            }
            if n > 5 {
                links.push((0, 4, 2));
                cut.link([(0, 2), (4, 2)], 2);
            }
            let value = |stays: &dyn Fn(u32) -> bool| {
                let gain: i32 = (0..n)
                    .filter(|&i| stays(i))
                    .map(|i| gains[i as usize])
                    .sum();
                let split = links.iter().filter(|(a, b, _)| stays(*a) != stays(*b));
                gain - split.map(|(.., cost)| cost).sum::<i32>()
            };
            cut.solve();
            let found = value(&|i| cut.stays(i));
            let best = (0..1u32 << n)
                .map(|set| value(&|i| set >> i & 1 == 1))
                .max();
            assert_eq!(Some(found), best);
            let staying = (0..n).filter(|&i| cut.stays(i)).count();
            some += usize::from(staying > 0);
            all += usize::from(staying == n as usize);
        }
        assert!(some > 250 && all < 250, "{some} {all}");
    }
}

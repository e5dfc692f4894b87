//! What turns a chain into quads: the library's way, its readable reference, and the baselines.

use umbrage_core::Light;
use umbrage_core::volume::{
    Chain, Crow, HiddenScratch, Quad, brute, counter, drop_hidden, plain_counter, range_first,
};
use umbrage_core::world::World;

/// What turns a light's chain into quads.
pub(super) trait Method {
    fn name(&self) -> &'static str;
    /// Appends the light's quads; may leave out casters.
    fn quads(
        &mut self,
        world: &World,
        light: &Light,
        chain: &mut Vec<Chain>,
        quads: &mut Vec<Quad>,
    );
    /// What edges and faces know of each other, in bytes, for the whole world.
    fn adjacency_bytes(&self, world: &World) -> usize;
}

/// All methods; `counter` first.
pub(super) fn all(world: &World) -> Vec<Box<dyn Method>> {
    vec![
        Box::new(CounterMethod::default()),
        Box::new(CutsMethod::default()),
        Box::new(PlainMethod::default()),
        Box::new(CrowMethod {
            crow: Crow::new(world),
            coefficients: vec![0; world.triangles.len()],
        }),
        Box::new(BruteMethod),
    ]
}

#[derive(Default)]
struct CounterMethod {
    counters: Vec<i32>,
    touched: Vec<Quad>,
}

impl Method for CounterMethod {
    fn name(&self) -> &'static str {
        "counter"
    }

    fn quads(&mut self, world: &World, _: &Light, chain: &mut Vec<Chain>, quads: &mut Vec<Quad>) {
        self.counters.resize(world.edges.vertices.len(), 0);
        counter(world, chain, &mut self.counters, &mut self.touched, quads);
    }

    fn adjacency_bytes(&self, world: &World) -> usize {
        size_of_val(&world.edges.sides[..]) + size_of_val(&world.clusters[..])
    }
}

/// The counter over the chain without hidden casters; of its quads, those that an eye within the
/// light's reach needs.
#[derive(Default)]
struct CutsMethod {
    counter: CounterMethod,
    hidden: HiddenScratch,
    scratch: Vec<Quad>,
}

impl Method for CutsMethod {
    fn name(&self) -> &'static str {
        "counter-cuts"
    }

    fn quads(
        &mut self,
        world: &World,
        light: &Light,
        chain: &mut Vec<Chain>,
        quads: &mut Vec<Quad>,
    ) {
        drop_hidden(world, light, chain, &mut self.hidden);
        let first = quads.len();
        self.counter.quads(world, light, chain, quads);
        let prefix = range_first(world, light, &mut quads[first..], &mut self.scratch);
        quads.truncate(first + prefix.reach as usize);
    }

    fn adjacency_bytes(&self, world: &World) -> usize {
        self.counter.adjacency_bytes(world)
    }
}

#[derive(Default)]
struct PlainMethod {
    counters: Vec<i32>,
}

impl Method for PlainMethod {
    fn name(&self) -> &'static str {
        "counter-plain"
    }

    fn quads(&mut self, world: &World, _: &Light, chain: &mut Vec<Chain>, quads: &mut Vec<Quad>) {
        self.counters.resize(world.edges.vertices.len(), 0);
        plain_counter(world, chain, &mut self.counters, quads);
    }

    fn adjacency_bytes(&self, world: &World) -> usize {
        size_of_val(&world.edges.sides[..])
    }
}

struct BruteMethod;

impl Method for BruteMethod {
    fn name(&self) -> &'static str {
        "brute"
    }

    fn quads(&mut self, world: &World, _: &Light, chain: &mut Vec<Chain>, quads: &mut Vec<Quad>) {
        brute(&world.edges, chain.iter().flat_map(Chain::triangles), quads);
    }

    fn adjacency_bytes(&self, _: &World) -> usize {
        0
    }
}

struct CrowMethod {
    crow: Crow,
    coefficients: Vec<i8>,
}

impl Method for CrowMethod {
    fn name(&self) -> &'static str {
        "crow"
    }

    fn quads(&mut self, world: &World, _: &Light, chain: &mut Vec<Chain>, quads: &mut Vec<Quad>) {
        self.crow
            .silhouette(world, chain, &mut self.coefficients, quads);
    }

    fn adjacency_bytes(&self, world: &World) -> usize {
        self.crow.bytes(world)
    }
}

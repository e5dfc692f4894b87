//! Meshes and materials that give many quads and little shadow, and double-sided ones that need
//! cast from their front alone.

use std::collections::HashMap;

use umbrage_core::Casting;
use umbrage_report::grouped;
use umbrage_report::profile::AdviceKind;

use super::Candidate;
use crate::setting::Setting;
use crate::verbs::profile::change::{Change, Group};
use crate::verbs::profile::measure::{Base, Work};

/// Most groups tried, of meshes and materials together and of double-sided materials.
const MOST: usize = 4;
/// A group with a smaller part of the cost is not worth trying.
const WORTH: f64 = 0.02;

pub(super) fn candidates(base: &Base, setting: &Setting) -> Vec<Candidate> {
    let casters = Casters::of(base, setting);
    let mut all = Vec::new();
    let all_cost: f64 = base
        .drawn
        .iter()
        .map(|&light| volume_cost(base, light))
        .sum();
    let mut groups: Vec<(Group, f64)> = casters.cost.iter().map(|(g, c)| (*g, *c)).collect();
    groups.sort_by(|a, b| b.1.total_cmp(&a.1).then(order(a.0).cmp(&order(b.0))));
    groups.retain(|(_, cost)| *cost > WORTH * all_cost);
    let is_double = |group: Group| match group {
        Group::Material(m) => setting.stage.scene.materials[m as usize].double_sided,
        Group::Mesh(_) => false,
    };
    let with = |group: Group| casters.lights.get(&group).cloned().unwrap_or_default();
    for &(group, _) in groups.iter().filter(|g| is_double(g.0)).take(MOST) {
        all.push(single_sided(group, with(group), setting));
    }
    // Where a mesh has one material of its own, the mesh.
    groups.dedup_by(|a, b| a.1 == b.1);
    for &(group, _) in groups.iter().take(MOST) {
        all.push(no_casting(group, with(group), setting));
    }
    all
}

fn order(group: Group) -> (u8, u32) {
    match group {
        Group::Mesh(mesh) => (0, mesh),
        Group::Material(material) => (1, material),
    }
}

fn volume_cost(base: &Base, light: usize) -> f64 {
    let figures = &base.lights[light];
    match figures.gpu {
        Some(gpu) => gpu.volume_us,
        None => figures.build.total_us(),
    }
}

/// What of the lights' volume costs falls to each group, and which lights have it in their volume.
struct Casters {
    cost: HashMap<Group, f64>,
    lights: HashMap<Group, Vec<usize>>,
}

impl Casters {
    /// By the triangles of each light's chain.
    fn of(base: &Base, setting: &Setting) -> Self {
        let stage = &setting.stage;
        let surfaces = stage.surfaces();
        let (mut cost, mut lights) = (HashMap::new(), HashMap::<Group, Vec<usize>>::new());
        for &light in &base.drawn {
            let mut counts: HashMap<Group, u32> = HashMap::new();
            for &triangle in &base.casters[light] {
                let Some(surface) = surfaces[triangle as usize].map(|s| s as usize) else {
                    continue;
                };
                let instance = stage.soup.instance[surface] as usize;
                let mesh = Group::Mesh(stage.scene.instances[instance].mesh);
                for group in [mesh, Group::Material(stage.soup.material[surface])] {
                    *counts.entry(group).or_default() += 1;
                }
            }
            let all = base.casters[light].len().max(1) as f64;
            for (group, count) in counts {
                let share = f64::from(count) / all;
                *cost.entry(group).or_default() += share * volume_cost(base, light);
                lights.entry(group).or_default().push(light);
            }
        }
        Self { cost, lights }
    }
}

/// Quads of the lights, before and after.
fn quads(base: &Base, after: &[Work], lights: &[usize]) -> [u64; 2] {
    let before = lights.iter().map(|&l| u64::from(base.lights[l].work.quads));
    let after = lights.iter().map(|&l| u64::from(after[l].quads));
    [before.sum(), after.sum()]
}

fn no_casting(group: Group, lights: Vec<usize>, setting: &Setting) -> Candidate {
    let (of, word) = (group.name(&setting.stage).to_owned(), group.word());
    let (name, count) = (of.clone(), lights.clone());
    let words = move |base: &Base, after: &[Work]| {
        let [before, now] = quads(base, after, &count);
        let share = 100.0 * (before as f64 - now as f64) / before.max(1) as f64;
        format!(
            "{share:.0}% of the quads of {} lights come from the {word} {name}: mark it non-casting.",
            grouped(count.len() as u64)
        )
    };
    Candidate {
        kind: AdviceKind::NoCasting,
        change: Change::Casting(group, Casting::None),
        least_quads: 0.1,
        lights,
        of,
        words: Box::new(words),
    }
}

fn single_sided(group: Group, lights: Vec<usize>, setting: &Setting) -> Candidate {
    let (of, word) = (group.name(&setting.stage).to_owned(), group.word());
    let (name, count) = (of.clone(), lights.clone());
    let words = move |base: &Base, after: &[Work]| {
        let [before, now] = quads(base, after, &count);
        format!(
            "the {word} {name} casts from both sides, and from its front alone the shadows would be the same, of {} quads instead of {}: let it cast single-sided.",
            grouped(now),
            grouped(before)
        )
    };
    Candidate {
        kind: AdviceKind::SingleSided,
        change: Change::Casting(group, Casting::Front),
        least_quads: 0.05,
        lights,
        of,
        words: Box::new(words),
    }
}

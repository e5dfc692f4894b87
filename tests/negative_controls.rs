//! The judge must go red: right data is right, and each single change to the plain data between
//! planning and drawing is found out.

mod common;

use common::{Found, Site, assert_exact, check, check_changed, room, staged};
use glam::Vec3;
use umbrage_core::View;
use umbrage_core::frame::{LightPath, Rect, SkipReason};
use umbrage_core::volume::{ChainTriangle, Quad, plain_counter};
use umbrage_core::world::{EdgeUse, LANES};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::stage::{Casters, StageLight};
use umbrage_truth::Mask;

const SIZE: [u32; 2] = [160, 120];

/// A room, one lamp near its ceiling, and an eye that sees most of the floor.
struct Control {
    site: Site,
    lights: Vec<StageLight>,
    view: View,
}

impl Control {
    fn new() -> Self {
        let site = Site::new(room::scene(), Casters::Both);
        let lights = staged([common::point(Vec3::new(0.3, 4.3, 0.9), 30.0)]);
        let view = site.look(Vec3::new(6.5, 4.2, 5.1), Vec3::new(-1.0, 0.5, -0.5), SIZE);
        Self { site, lights, view }
    }

    fn right(&self, method: Method) -> Found {
        let found = check(&self.site, &self.lights, &self.view, method);
        assert_exact("unchanged", &found);
        assert!(found.judgement.samples > 5_000);
        found
    }

    fn changed(&self, method: Method, change: impl FnOnce(&mut Lab)) -> Found {
        check_changed(&self.site, &self.lights, &self.view, method, change)
    }

    /// How many of `count` changes the judge finds out.
    fn red(&self, method: Method, count: usize, change: impl Fn(&mut Lab, usize)) -> usize {
        let is_red = |&i: &usize| self.changed(method, |lab| change(lab, i)).judgement.wrong > 0;
        (0..count).filter(is_red).count()
    }
}

fn remove_quad(lab: &mut Lab, quad: usize) {
    lab.volumes.quads.remove(quad);
    lab.volumes.lights[0].quads.end -= 1;
    lab.plan.lights[0].quads.end -= 1;
}

fn replace_quads(lab: &mut Lab, quads: Vec<Quad>) {
    let range = 0..quads.len() as u32;
    lab.volumes.lights[0].quads = range.clone();
    lab.plan.lights[0].quads = range;
    lab.volumes.quads = quads;
}

#[test]
fn one_quad_dropped() {
    let control = Control::new();
    for method in common::EXACT {
        let quads = control.right(method).plan.lights[0].quads.len();
        let red = control.red(method, quads, remove_quad);
        // Quads behind walls and under the floor meet no ray that counts.
        assert!(
            2 * red > quads,
            "{}: {red} of {quads} dropped quads found out",
            method.name()
        );
    }
}

#[test]
fn a_dropped_quad_opens_the_volume() {
    let control = Control::new();
    for quad in 0..control.right(Method::Counter).plan.lights[0].quads.len() {
        let found = control.changed(Method::Counter, |lab| remove_quad(lab, quad));
        assert!(!found.closed, "quad {quad}");
    }
}

#[test]
fn one_quad_turned_round() {
    let control = Control::new();
    for method in common::EXACT {
        let quads = control.right(method).plan.lights[0].quads.len();
        let turn = |lab: &mut Lab, quad: usize| {
            lab.volumes.quads[quad].0 = turned(lab.volumes.quads[quad].0);
        };
        let red = control.red(method, quads, turn);
        assert!(
            2 * red > quads,
            "{}: {red} of {quads} turned quads found out",
            method.name()
        );
        assert!(!control.changed(method, |lab| turn(lab, 0)).closed);
    }
}

fn turned(edge: EdgeUse) -> EdgeUse {
    EdgeUse::new(edge.edge(), edge.sign() > 0)
}

/// A triangle that casts is taken as one that does not: the volume is closed still, and wrong.
#[test]
fn one_facing_flipped() {
    let control = Control::new();
    let world = &control.site.stage.world;
    let chain: Vec<ChainTriangle> = {
        let mut lab = common::lab();
        lab.prepare(
            &control.site.stage,
            &control.lights,
            &control.view,
            Method::Counter,
        );
        lab.volumes.chain_triangles(0).collect()
    };
    let mut red = 0;
    for triangle in &chain {
        let (cluster, bit) = (
            triangle.triangle() / LANES as u32,
            1 << (triangle.triangle() % LANES as u32),
        );
        let found = control.changed(Method::Counter, |lab| {
            for part in lab
                .volumes
                .chains
                .iter_mut()
                .filter(|p| p.cluster == cluster)
            {
                part.wound &= !bit;
                part.reversed &= !bit;
            }
            let (mut counters, mut quads) = (vec![0; world.edges.vertices.len()], Vec::new());
            plain_counter(world, &lab.volumes.chains, &mut counters, &mut quads);
            replace_quads(lab, quads);
        });
        assert!(found.closed, "the boundary of any chain is closed");
        red += usize::from(found.judgement.wrong > 0);
    }
    // Walls shadow nothing that can be seen, and boxes have a front and a back that cast.
    assert!(
        red >= 4,
        "{red} of {} flipped facings found out",
        chain.len()
    );
}

#[test]
fn one_cap_removed() {
    let control = Control::new();
    let light = control.right(Method::CounterZFail).plan.lights[0].clone();
    for (name, range) in [("caps", light.caps), ("reversed caps", light.reversed_caps)] {
        assert!(!range.is_empty());
        let red = control.red(Method::CounterZFail, range.len(), |lab, i| {
            let light = &mut lab.plan.lights[0];
            let range = if name == "caps" {
                &mut light.caps
            } else {
                &mut light.reversed_caps
            };
            lab.plan
                .caps
                .swap(range.start as usize + i, range.end as usize - 1);
            range.end -= 1;
        });
        assert!(
            2 * red > range.len(),
            "{red} of {} removed {name} found out",
            range.len()
        );
    }
}

#[test]
fn eye_count_off_by_one() {
    let control = Control::new();
    for method in common::EXACT {
        let right = control.right(method).judgement;
        for step in [1u8, u8::MAX] {
            let found = control.changed(method, |lab| {
                let reference = &mut lab.plan.lights[0].stencil_reference;
                *reference = reference.wrapping_add(step);
            });
            assert!(
                found.judgement.wrong > right.samples / 4,
                "{}",
                method.name()
            );
        }
    }
}

/// What the scissor cuts off is not lit.
#[test]
fn scissor_shrunk() {
    let control = Control::new();
    for method in common::EXACT {
        let found = control.changed(method, |lab| {
            let scissor: &mut Rect = &mut lab.plan.lights[0].scissor;
            *scissor = Rect {
                x: scissor.x + 8,
                width: scissor.width - 8,
                ..*scissor
            };
        });
        assert!(found.judgement.wrong_shadowed > 0, "{}", method.name());
        assert_eq!(found.judgement.wrong_lit, 0);
    }
}

/// A light's own scissor is needed whole: the lamp here reaches a part of the picture only.
#[test]
fn small_scissor_shrunk() {
    let mut control = Control::new();
    control.lights = staged([common::point(Vec3::new(-0.75, 0.75, 1.25), 2.5)]);
    let light = check(
        &control.site,
        &control.lights,
        &control.view,
        Method::Counter,
    )
    .plan
    .lights[0]
        .clone();
    assert!(light.scissor.area() < Rect::full(&control.view).area());
    let margins: [fn(&mut Rect, u32); 4] = [
        |r, by| (r.x, r.width) = (r.x + by, r.width - by),
        |r, by| r.width -= by,
        |r, by| (r.y, r.height) = (r.y + by, r.height - by),
        |r, by| r.height -= by,
    ];
    let red = margins.iter().filter(|shrink| {
        let by = light.scissor.width.min(light.scissor.height) / 3;
        let found = control.changed(Method::Counter, |lab| {
            shrink(&mut lab.plan.lights[0].scissor, by);
        });
        found.judgement.wrong_shadowed > 0
    });
    assert_eq!(red.count(), 4);
}

#[test]
fn one_light_skipped() {
    let control = Control::new();
    let lit = control.right(Method::Counter).judgement;
    let found = control.changed(Method::Counter, |lab| {
        lab.plan.lights[0].path = LightPath::Skipped(SkipReason::OutsideView);
    });
    assert!(found.judgement.wrong_shadowed > lit.samples / 4);
}

/// The tolerance is a small part of a pixel: a mask shifted by a whole one is wrong, not
/// ambiguous.
#[test]
fn a_shift_by_a_pixel_is_wrong() {
    let control = Control::new();
    let found = control.right(Method::Counter);
    let [width, height] = SIZE;
    for (dx, dy) in [(1, 0), (0, 1)] {
        let mut shifted = Mask::new(SIZE, 1);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let from = (x.saturating_sub(dx), y.saturating_sub(dy));
            shifted.set(x, y, 0, found.mask.get(from.0, from.1, 0));
        }
        let judgement = common::judged(
            &control.site,
            &control.lights,
            &control.view,
            &shifted,
            &found.skipped,
        );
        assert!(judgement.wrong > 200, "{judgement:?}");
        assert!(20 * judgement.ambiguous < judgement.wrong, "{judgement:?}");
    }
}

/// A mask turned over is wrong nearly everywhere: little is called ambiguous.
#[test]
fn an_inverted_mask_is_wrong() {
    let control = Control::new();
    let found = control.right(Method::Counter);
    let inverted = Mask {
        words: found.mask.words.iter().map(|w| !w).collect(),
        ..found.mask.clone()
    };
    let judgement = common::judged(
        &control.site,
        &control.lights,
        &control.view,
        &inverted,
        &found.skipped,
    );
    assert_eq!(
        judgement.wrong + judgement.ambiguous,
        judgement.samples - found.judgement.ambiguous
    );
    assert!(
        10 * judgement.ambiguous < judgement.samples,
        "{judgement:?}"
    );
}

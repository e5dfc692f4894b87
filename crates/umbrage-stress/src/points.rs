//! Points in volume, against the oracle: no picture, no GPU.
//!
//! Takes a case; builds its world and volumes as the library does, with every step that skips work
//! and with none; gives how many points were asked and where the volume's own count (signed
//! crossings, see [`Surface`]) and the oracle's segment cast differ. With every step the count must
//! be above zero where the oracle meets a caster; with none it must be the number of casters. Also
//! asked: that volumes and their parts are closed in integers, that no part has more layers than its bits
//! count, that between two points in a light's reach the quads
//! kept for eyes in its reach suffice, and that the library's eye count is that of its volume.
//!
//! Where the two differ, the point is *ambiguous* if the oracle's own answer changes when the point
//! moves by [`TOLERANCE`] of its distance from the light (of the mesh's size, for a directional
//! light), in one of 26 directions; else it is *wrong*.

use glam::DVec3;
use umbrage_core::frame::eye_count::{EyeCount, eye_count};
use umbrage_core::volume::{
    Chain, ClosureFault, LayerLimit, Quad, VolumeBuilder, Volumes, check_closed,
};
use umbrage_core::world::{World, WorldError};
use umbrage_core::{Culls, Light};
use umbrage_truth::Oracle;

use crate::case::Case;
use crate::exact::Point;
use crate::rng::Random;
use crate::samples::{reaches, samples};
use crate::surface::{Hindrance, Surface};

/// Share of a point's distance from the light by which it may move: 2^-30. Both counts are exact for
/// the point's f64 numbers; what they may differ by is the oracle's rounding of what it touches,
/// 2^-50, and what the library calls a sliver when it looks for hidden casters.
pub const TOLERANCE: f64 = 1.0 / (1u64 << 30) as f64;

/// Steps of f64, as they are at a point's own coordinates, by which it moves at least: far from zero
/// the oracle knows no place, and this check no point, better than that.
const FEWEST_STEPS: f64 = 16.0;

/// A place where a volume is not what it must be.
#[derive(Clone, Debug, PartialEq)]
pub enum PointFault {
    /// The mesh is no world.
    Refused(WorldError),
    /// Caps and quads do not cancel.
    Open {
        /// Number of the light.
        light: usize,
        /// Where.
        fault: ClosureFault,
    },
    /// The count at a point is not the oracle's.
    Count {
        /// Number of the light.
        light: usize,
        /// Where.
        at: DVec3,
        /// Casters as the volume says.
        volume: i64,
        /// As the oracle says.
        oracle: u32,
    },
    /// The parts of a volume hold more than their bits, or are not the whole.
    Parts {
        /// Number of the light.
        light: usize,
        /// Where.
        at: DVec3,
        /// Casters as each part says.
        counts: Vec<i64>,
    },
    /// Two points in the light's reach differ by another count than the quads between them say.
    Between {
        /// Number of the light.
        light: usize,
        /// From where.
        from: DVec3,
        /// To where.
        to: DVec3,
    },
    /// The library's eye count is not that of its volume.
    Eye {
        /// Number of the light.
        light: usize,
        /// Number of the view.
        view: usize,
        /// What the library counts.
        counted: u32,
        /// What the volume says.
        volume: i64,
    },
}

/// What was found about a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointReport {
    /// Counts that were compared.
    pub samples: u64,
    /// Of these, differing beyond the tolerance.
    pub wrong: u64,
    /// Differing within it.
    pub ambiguous: u64,
    /// Points for which no ray could be counted: all of them run along edges.
    pub uncounted: u64,
    /// Volumes that are not closed.
    pub open: u64,
    /// The first fault, by light and point.
    pub fault: Option<PointFault>,
}

impl PointReport {
    fn wrong(&mut self, fault: PointFault) {
        self.wrong += 1;
        self.fault.get_or_insert(fault);
    }
}

/// Changes volumes by hand: what negative controls break them with.
pub type Tampering<'a> = &'a (dyn Fn(&World, &mut Volumes) + Sync);

/// Checks a case.
pub fn check(case: &Case) -> PointReport {
    check_tampered(case, &|_, _| ())
}

/// The same with volumes changed before they are looked at.
pub fn check_tampered(case: &Case, tamper: Tampering<'_>) -> PointReport {
    let mut report = PointReport::default();
    let world = match World::build(&case.mesh) {
        Ok(world) => world,
        Err(error) => {
            report.wrong(PointFault::Refused(error));
            return report;
        }
    };
    let oracle = Oracle::new(&case.mesh);
    for culls in [Culls::EVERY, Culls::NONE] {
        let mut volumes = Volumes::default();
        VolumeBuilder::new(culls).settle(&world, &case.lights, |_| true, &mut volumes);
        tamper(&world, &mut volumes);
        for (number, light) in case.lights.iter().enumerate() {
            let volume = &volumes.lights[number];
            let quads = volumes.quads_of(number);
            let needed = &quads[..quads.len().min(volume.in_range.reach as usize)];
            // The whole, and its parts.
            let whole = (volumes.chain_of(number), quads);
            let of_part = |part| (volumes.chain_of_part(part), volumes.quads_of_part(part));
            let parts: Vec<_> = volume.parts.iter().map(of_part).collect();
            for &(chain, quads) in [&whole].into_iter().chain(&parts) {
                let chain = chain.iter().flat_map(Chain::triangles);
                if let Err(fault) = check_closed(&world, chain, quads) {
                    report.open += 1;
                    let light = number;
                    report
                        .fault
                        .get_or_insert(PointFault::Open { light, fault });
                }
            }
            let surface = |(chain, quads): (&[Chain], &[Quad])| {
                Surface::new(
                    &world,
                    light,
                    quads,
                    chain.iter().flat_map(Chain::triangles),
                )
            };
            let asked = Asked {
                case,
                oracle: &oracle,
                light,
                number,
                all: surface(whole),
                in_reach: surface((whole.0, needed)),
                parts: parts.iter().copied().map(surface).collect(),
                exact_counts: culls == Culls::NONE,
            };
            asked.points(&mut report);
            let (chain, quads) = whole;
            for (view, eye) in case.views.iter().map(|view| view.eye).enumerate() {
                if let EyeCount::Exact(counted) = eye_count(&world, light, chain, quads, eye) {
                    asked.eye(view, eye, counted, &mut report);
                }
            }
        }
    }
    report
}

/// One light's volume.
struct Asked<'a> {
    case: &'a Case,
    oracle: &'a Oracle,
    light: &'a Light,
    number: usize,
    all: Surface,
    /// With the quads that eyes in its reach need.
    in_reach: Surface,
    parts: Vec<Surface>,
    exact_counts: bool,
}

/// Rays from a point in different directions.
const RAYS: usize = 2;

impl Asked<'_> {
    fn points(&self, report: &mut PointReport) {
        let mut random = Random::new(crate::rng::mix(self.case.sampling, self.number as u64));
        let mut last: Option<(DVec3, i64)> = None;
        let asked = self.case.points.iter().copied();
        let sampled = samples(self.case, self.light, &mut random);
        for at in asked.chain(sampled) {
            if !reaches(self.light, at) {
                continue;
            }
            let Some((at, counts)) = self.counts(at, &mut random) else {
                report.uncounted += 1;
                continue;
            };
            for count in counts {
                report.samples += 1;
                let truth = self.truth(at);
                if self.agrees(count, truth) {
                    continue;
                }
                if self.is_ambiguous(at, truth) {
                    report.ambiguous += 1;
                    continue;
                }
                report.wrong(PointFault::Count {
                    light: self.number,
                    at,
                    volume: count,
                    oracle: truth,
                });
            }
            self.parts(at, counts[0], &mut random, report);
            if let Some((from, before)) = last
                && let Ok(left) = self.in_reach.leaves(from, Point::Near(at))
            {
                report.samples += 1;
                if before - left != counts[0] {
                    report.wrong(PointFault::Between {
                        light: self.number,
                        from,
                        to: at,
                    });
                }
            }
            last = Some((at, counts[0]));
        }
    }

    /// Every part holds as many layers as its bits can count, and together they are the whole.
    fn parts(&self, at: DVec3, whole: i64, random: &mut Random, report: &mut PointReport) {
        if self.parts.is_empty() {
            return;
        }
        let direction = ray(random);
        let counted = self.parts.iter().map(|part| part.count(at, direction).ok());
        let Some(counts) = counted.collect::<Option<Vec<i64>>>() else {
            report.uncounted += 1;
            return;
        };
        report.samples += 1;
        let most = i64::from(LayerLimit::STENCIL.part);
        let fit = counts.iter().all(|count| (0..=most).contains(count));
        if !fit || counts.iter().sum::<i64>() != whole {
            report.wrong(PointFault::Parts {
                light: self.number,
                at,
                counts,
            });
        }
    }

    fn eye(&self, view: usize, eye: DVec3, counted: u32, report: &mut PointReport) {
        let mut random = Random::new(crate::rng::mix(self.case.sampling, !(view as u64)));
        let count = (0..4).find_map(|_| self.all.count(eye, ray(&mut random)).ok());
        let Some(volume) = count else {
            report.uncounted += 1;
            return;
        };
        report.samples += 1;
        if volume != i64::from(counted) {
            report.wrong(PointFault::Eye {
                light: self.number,
                view,
                counted,
                volume,
            });
        }
    }

    /// What the volume says at a point, along several rays. A point on the volume is moved by
    /// 2^-44 of the distances around, until it is off it.
    fn counts(&self, mut at: DVec3, random: &mut Random) -> Option<(DVec3, [i64; RAYS])> {
        let size = at.abs().max_element() + self.distance(at);
        for _ in 0..4 {
            let mut counts = [0; RAYS];
            let mut counted = 0;
            for _ in 0..3 * RAYS {
                match self.all.count(at, ray(random)) {
                    Ok(count) => {
                        counts[counted] = count;
                        counted += 1;
                        if counted == RAYS {
                            return Some((at, counts));
                        }
                    }
                    Err(Hindrance::RayOnEdge) => {}
                    Err(Hindrance::PointOnSurface) => break,
                }
            }
            at += ray(random) * (size / (1u64 << 44) as f64);
        }
        None
    }

    fn truth(&self, at: DVec3) -> u32 {
        match self.exact_counts {
            true => self.oracle.casters(at.to_array(), self.light),
            false => u32::from(self.oracle.is_occluded(at.to_array(), self.light)),
        }
    }

    fn agrees(&self, count: i64, truth: u32) -> bool {
        match self.exact_counts {
            true => count == i64::from(truth),
            false => count >= 0 && (count > 0) == (truth > 0),
        }
    }

    fn distance(&self, at: DVec3) -> f64 {
        match self.light.is_directional() {
            true => f64::from(self.case.size()),
            false => at.distance(self.light.position),
        }
    }

    fn is_ambiguous(&self, at: DVec3, truth: u32) -> bool {
        let rounding = FEWEST_STEPS * f64::EPSILON * at.abs().max_element();
        let step = (TOLERANCE * self.distance(at)).max(rounding);
        (0..27).any(|k| {
            let toward = DVec3::new((k % 3) as f64, (k / 3 % 3) as f64, (k / 9) as f64) - 1.0;
            self.truth(at + toward.normalize_or_zero() * step) != truth
        })
    }
}

/// A direction in general position.
fn ray(random: &mut Random) -> DVec3 {
    loop {
        let p = DVec3::from_array(std::array::from_fn(|_| 2.0 * random.unit() - 1.0));
        if (0.01..1.0).contains(&p.length_squared()) {
            return p;
        }
    }
}

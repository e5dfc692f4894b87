//! Rendered cases: masks of both exact methods against the oracle.
//!
//! Takes a case; draws it on one device that is kept, with pipelines that are kept, and judges each
//! mask as `umbrage check` does, with its tolerances. Lights in a placement that masks cannot show
//! ([`Limit`]) are left out and counted. Surfaces before the near plane are not judged: clamped to one
//! depth, which of them is seen is open.

use umbrage_core::frame::LightPath;
use umbrage_core::world::World;
use umbrage_core::{Light, View};
use umbrage_lab::gpu::{AdapterChoice, Gpu, GpuError};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::run::Run;
use umbrage_lab::stage::{Casters, Stage, StageError, StageLight};
use umbrage_truth::{Mask, Oracle, Verdicts};

use crate::case::Case;
use crate::file;
use crate::limits::Limit;

/// The methods that promise the oracle's shadows.
pub const METHODS: [Method; 2] = [Method::Counter, Method::CounterZFail];

/// Why a case could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// The device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The mesh.
    #[error(transparent)]
    Stage(#[from] StageError),
}

/// A mask that is wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskFault {
    /// Which.
    pub method: Method,
    /// Number of the view.
    pub view: usize,
    /// Number of the light.
    pub light: usize,
    /// Column and row of the firmest wrong pixel.
    pub pixel: [u32; 2],
    /// Wrong pixel-lights of this mask.
    pub wrong: u64,
}

/// What was found in the masks of a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaskReport {
    /// Masks that were drawn.
    pub masks: u64,
    /// Pixel-lights that were judged.
    pub samples: u64,
    /// Of these, wrong.
    pub wrong: u64,
    /// Of these, ambiguous.
    pub ambiguous: u64,
    /// Lights left out of a mask, by the order of [`Limit::ALL`].
    pub left_out: [u64; Limit::ALL.len()],
    /// The first mask that is wrong.
    pub fault: Option<MaskFault>,
}

/// A device with what is kept on it from case to case.
#[derive(Debug)]
pub struct Studio {
    lab: Lab,
    runs: Vec<(Method, Run)>,
}

impl Studio {
    /// Opens a device.
    pub fn open(adapter: &AdapterChoice) -> Result<Self, GpuError> {
        Ok(Self {
            lab: Lab::new(Gpu::open(adapter)?),
            runs: Vec::new(),
        })
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> &str {
        &self.lab.gpu().adapter
    }

    /// Draws and judges a case.
    pub fn check(&mut self, case: &Case) -> Result<MaskReport, DrawError> {
        let stage = stage(case)?;
        let oracle = Oracle::new(&case.mesh);
        let mut report = MaskReport::default();
        for (number, view) in case.views.iter().enumerate() {
            let limits: Vec<Option<Limit>> = case
                .lights
                .iter()
                .map(|light| Limit::of(case, light, view))
                .collect();
            let mut judged: Option<(Vec<usize>, Verdicts)> = None;
            for method in METHODS {
                let mut drawn = Vec::new();
                for (light, limit) in limits.iter().enumerate() {
                    match limit {
                        Some(limit) if !limit.is_drawn_by(method) => {
                            report.left_out[*limit as usize] += 1;
                        }
                        _ => drawn.push(light),
                    }
                }
                if drawn.is_empty() {
                    continue;
                }
                let lights: Vec<StageLight> =
                    drawn.iter().map(|&l| staged(l, case.lights[l])).collect();
                let mut mask = self.mask(&stage, &lights, view, method)?;
                report.masks += 1;
                let (_, verdicts) = match judged.take() {
                    Some(known) if known.0 == drawn => judged.insert(known),
                    _ => {
                        let plain: Vec<Light> = lights.iter().map(|l| l.light).collect();
                        let near = self.lab.near_clip();
                        let verdicts = Verdicts::new(&oracle, view, &plain, near, &|_, _| ());
                        judged.insert((drawn.clone(), verdicts))
                    }
                };
                let skipped: Vec<bool> = (0..lights.len())
                    .map(|light| matches!(self.lab.path(light), LightPath::Skipped(_)))
                    .collect();
                if view.near > 1e-4 * case.size() {
                    let near = self.lab.near_clip();
                    mask.trust_before_near(&oracle, view, near, &verdicts.mask());
                }
                let found = verdicts.judge(&oracle, &mask, &skipped);
                report.samples += found.samples;
                report.wrong += found.wrong;
                report.ambiguous += found.ambiguous;
                if let Some(worst) = found.worst.first()
                    && report.fault.is_none()
                {
                    report.fault = Some(MaskFault {
                        method,
                        view: number,
                        light: drawn[worst.light as usize],
                        pixel: [worst.x, worst.y],
                        wrong: found.wrong,
                    });
                }
            }
        }
        Ok(report)
    }

    fn mask(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        method: Method,
    ) -> Result<Mask, GpuError> {
        self.lab.prepare(stage, lights, view, method);
        let known = self.runs.iter().position(|(of, _)| *of == method);
        let known = match known {
            Some(known) => known,
            None => {
                let run = self.lab.masking(stage, view)?;
                self.runs.push((method, run));
                self.runs.len() - 1
            }
        };
        let run = &mut self.runs[known].1;
        self.lab.mask_in(run, stage, lights, view)
    }
}

/// The case as a host would stage it: by way of a scene, with the case's own casting rules.
fn stage(case: &Case) -> Result<Stage, StageError> {
    let scene = file::scene(case);
    let mut stage = Stage::new(scene, Casters::Material, Some(glam::DVec3::ZERO))?;
    if stage.mesh != case.mesh {
        stage.mesh = case.mesh.clone();
        stage.world = World::build(&stage.mesh).map_err(|error| StageError::World {
            scene: stage.scene.name.clone(),
            error,
        })?;
    }
    Ok(stage)
}

fn staged(number: usize, light: Light) -> StageLight {
    StageLight {
        name: format!("light_{number}"),
        light,
        power: glam::Vec3::ONE,
        cos_inner: 1.0,
    }
}

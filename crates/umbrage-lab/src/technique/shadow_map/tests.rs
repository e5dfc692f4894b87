use super::*;
use crate::gpu::AdapterChoice;
use crate::lab::{Lab, Method};
use crate::stage::{Casters, Stage, StageLight};
use glam::Vec3;
use umbrage_core::{LightShape, View};
use umbrage_truth::Mask;

const TEXELS: u32 = 256;

/// The mask by maps within a budget, drawn `frames` times, and what the technique says of itself.
fn mask(
    lab: &mut Lab,
    (stage, lights, view): (&Stage, &[StageLight], &View),
    budget: u64,
    frames: usize,
) -> (Mask, TechniqueReport) {
    lab.prepare(stage, lights, view, Method::ShadowMap { texels: TEXELS });
    let mut run = lab.masking(stage, view).expect("a renderer");
    let (gpu, shadows) = (lab.gpu(), &run.shadows);
    let maps = ShadowMap::with_budget(gpu, shadows, LightDraw::Mark, TEXELS, budget);
    run.technique = Box::new(maps.expect("it fits"));
    let mut last = None;
    for _ in 0..frames {
        let mask = lab.mask_in(&mut run, stage, lights, view);
        last = Some(mask.expect("the mask can be drawn and read"));
    }
    (last.expect("a frame"), run.technique.report())
}

/// Lights of every kind that have to share maps are lit as those that have one each.
#[test]
fn scratch_maps_draw_what_kept_maps_do() {
    let spec = "gen:city?triangles=3000&lights=24&seed=5&moon=1";
    let scene = umbrage_scene::open(spec, &()).expect("a city");
    let stage = Stage::new(scene, Casters::Both, None).expect("a stage");
    let mut lights = stage.lights(None);
    for (light, cos_outer) in lights.iter_mut().step_by(3).zip([0.1, 0.6, 0.9, 0.1, 0.7]) {
        let direction = Vec3::new(0.36, -0.8, 0.48);
        if light.kind() == "point" {
            light.light.shape = LightShape::Spot {
                direction,
                cos_outer,
            };
        }
    }
    let camera = &stage.scene.cameras[0];
    let (eye, ahead) = (stage.local(camera.position), camera.forward);
    let view = View::look_at(eye, eye + ahead, 1.2, 0.1, [160, 90]);
    let site = (&stage, &lights[..], &view);
    let gpu = Gpu::open(&AdapterChoice::Auto);
    let mut lab = Lab::new(gpu.unwrap_or_else(|error| panic!("{error}")));

    let (whole, report) = mask(&mut lab, site, BUDGET, 1);
    assert!(report.gpu_bytes < BUDGET);
    let cube = bytes(TEXELS, 6);
    for cubes in [0, 1, 5] {
        for frames in [1, 3] {
            let (shared, report) = mask(&mut lab, site, cubes * cube, frames);
            assert_eq!(shared.words, whole.words, "{cubes} cubes, {frames} frames");
            let lists = 4 * 3000 * 6 * lights.len() as u64;
            assert!(report.gpu_bytes <= cubes.max(1) * cube + lists);
        }
    }
    // And they have something to say.
    lab.prepare(&stage, &lights, &view, Method::None);
    let lit = lab.mask(&stage, &lights, &view).expect("a mask");
    assert_ne!(lit.words, whole.words);
}

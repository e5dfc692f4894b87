//! One device a test binary, small sites to stand on, and the judge over what the lab draws.
//!
//! Without an adapter every test fails with the lab's remedy; an error of the validation layer
//! panics, and so fails the test that caused it.
#![allow(dead_code)] // each test binary uses its own part

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use glam::{DAffine3, DVec3, Vec3};
use umbrage_core::frame::{FramePlan, LightPath};
use umbrage_core::volume::Volumes;
use umbrage_core::{Light, LightShape, View};
use umbrage_lab::gpu::{AdapterChoice, Gpu};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::stage::{Casters, Stage, StageLight};
use umbrage_scene::rig::Placement;
use umbrage_scene::{Instance, Material, Scene};
use umbrage_truth::{JudgeOptions, Judgement, Mask, Oracle, judge};

pub(crate) mod room;

/// The methods that promise the oracle's shadows.
pub(crate) const EXACT: [Method; 2] = [Method::Counter, Method::CounterZFail];

/// Every casting rule.
pub(crate) const CASTERS: [Casters; 4] = [
    Casters::Material,
    Casters::Both,
    Casters::Front,
    Casters::Back,
];

/// Largest share of samples that may be ambiguous, and the samples below which a share says
/// nothing.
const AMBIGUOUS_SHARE: f64 = 1e-3;
const FEW_SAMPLES: u64 = 20_000;

/// `release`, or `debug` where every validator runs.
pub(crate) fn by_profile<T>(release: T, debug: T) -> T {
    if cfg!(debug_assertions) {
        debug
    } else {
        release
    }
}

/// The binary's one lab, for one test at a time.
///
/// # Panics
/// Without a usable adapter, with the remedy.
pub(crate) fn lab() -> MutexGuard<'static, Lab> {
    static LAB: OnceLock<Mutex<Lab>> = OnceLock::new();
    LAB.get_or_init(|| match Gpu::open(&AdapterChoice::Auto) {
        Ok(gpu) => Mutex::new(Lab::new(gpu)),
        Err(error) => panic!("these tests need an adapter: {error}"),
    })
    .lock()
    .unwrap_or_else(PoisonError::into_inner)
}

/// A stage with its own lights and its oracle.
pub(crate) struct Site {
    pub(crate) stage: Stage,
    pub(crate) lights: Vec<StageLight>,
    pub(crate) oracle: Oracle,
}

impl Site {
    pub(crate) fn new(scene: Scene, casters: Casters) -> Self {
        let stage = Stage::new(scene, casters, None).expect("the scene can be staged");
        let (lights, oracle) = (stage.lights(None), Oracle::new(&stage.mesh));
        Self {
            stage,
            lights,
            oracle,
        }
    }

    /// A path or `gen:` specification.
    pub(crate) fn open(spec: &str, casters: Casters) -> Self {
        let scene = umbrage_scene::open(spec, &());
        Self::new(
            scene.unwrap_or_else(|error| panic!("{spec}: {error}")),
            casters,
        )
    }

    /// The view of the scene's first camera.
    pub(crate) fn first_camera(&self, size: [u32; 2]) -> View {
        let camera = &self.stage.scene.cameras[0];
        let [eye, ahead] = [camera.position, camera.position + camera.forward];
        let fovy_rad = camera.fovy_rad as f32;
        View::look_at(
            self.stage.local(eye),
            self.stage.local(ahead),
            fovy_rad,
            self.near(),
            size,
        )
    }

    pub(crate) fn look(
        &self,
        eye: impl Into<DVec3>,
        target: impl Into<DVec3>,
        size: [u32; 2],
    ) -> View {
        View::look_at(eye, target, 1.2, self.near(), size)
    }

    /// A near plane before everything that is worth seeing.
    pub(crate) fn near(&self) -> f32 {
        let root = &self.stage.world.bvh.nodes[0];
        (root.max - root.min).length() * 1e-6
    }

    /// A seeded eye just above a random triangle, looking towards another one: inside and outside
    /// of solids, near walls and far from them.
    pub(crate) fn seeded_view(&self, seed: u64, size: [u32; 2]) -> View {
        let mut random = Random(seed);
        let mesh = &self.stage.mesh;
        let mut center = || {
            let t = (random.bits() % mesh.triangles.len() as u64) as usize;
            let [a, b, c] = mesh.corners(t).map(DVec3::as_vec3);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            (
                (a + b + c) / 3.0,
                normal,
                (b - a).length().max((c - a).length()),
            )
        };
        let ((from, normal, length), (to, ..)) = (center(), center());
        self.look(from + normal * length * 0.4, to, size)
    }
}

/// What the judge said of one mask, and how it was drawn.
pub(crate) struct Found {
    pub(crate) judgement: Judgement,
    pub(crate) mask: Mask,
    pub(crate) plan: FramePlan,
    /// Which lights were left out, by the plan or by the GPU.
    pub(crate) skipped: Vec<bool>,
    /// Whether every volume is closed, counted in integers.
    pub(crate) closed: bool,
}

/// Draws the mask of `lights` in `view` and judges it.
pub(crate) fn check(site: &Site, lights: &[StageLight], view: &View, method: Method) -> Found {
    check_changed(site, lights, view, method, |_| ())
}

/// As [`check`], with the plain data changed between planning and drawing.
pub(crate) fn check_changed(
    site: &Site,
    lights: &[StageLight],
    view: &View,
    method: Method,
    change: impl FnOnce(&mut Lab),
) -> Found {
    let (mask, plan, skipped, closed) = {
        let mut lab = lab();
        lab.prepare(&site.stage, lights, view, method);
        change(&mut lab);
        let mask = lab.mask(&site.stage, lights, view);
        let closed = lab.volumes.check_closed(&site.stage.world).is_ok();
        // Nothing changed by hand is kept.
        lab.volumes = Volumes::default();
        (
            mask.expect("the mask can be drawn and read"),
            lab.plan.clone(),
            skipped(&lab),
            closed,
        )
    };
    Found {
        judgement: judged(site, lights, view, &mask, &skipped),
        skipped,
        mask,
        plan,
        closed,
    }
}

/// Which lights the last mask left out.
pub(crate) fn skipped(lab: &Lab) -> Vec<bool> {
    (0..lab.plan.lights.len())
        .map(|light| matches!(lab.path(light), LightPath::Skipped(_)))
        .collect()
}

/// The judge's word on a mask, drawn without the lights that were skipped.
pub(crate) fn judged(
    site: &Site,
    lights: &[StageLight],
    view: &View,
    mask: &Mask,
    skipped: &[bool],
) -> Judgement {
    let near = lab().near_clip();
    let options = JudgeOptions::default()
        .with_near(near)
        .with_skipped(skipped.to_vec());
    judge(
        &site.oracle,
        view,
        &plain(lights),
        mask,
        &options,
        &|_, _| (),
    )
}

/// Fails unless the mask is the oracle's, and the volumes are closed.
pub(crate) fn assert_exact(what: &str, found: &Found) {
    let j = &found.judgement;
    assert_eq!(
        j.wrong, 0,
        "{what}: of {} samples; worst {:?}",
        j.samples, j.worst
    );
    assert!(found.closed, "{what}: a volume is open");
    if j.samples >= FEW_SAMPLES {
        let share = j.ambiguous as f64 / j.samples as f64;
        assert!(
            share < AMBIGUOUS_SHARE,
            "{what}: {} of {} ambiguous",
            j.ambiguous,
            j.samples
        );
    }
}

/// The .glb files in the folder and in those below it, in order of their paths.
pub(crate) fn glb_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = folder.read_dir() else {
        return Vec::new();
    };
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("a readable folder").path()) {
        match path.extension() {
            _ if path.is_dir() => files.extend(glb_files(&path)),
            Some(end) if end == "glb" => files.push(path),
            _ => {}
        }
    }
    files.sort();
    files
}

/// A bundled file.
pub(crate) fn data(file: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("data")
        .join(file);
    umbrage_scene::load(&path, &()).unwrap_or_else(|error| panic!("{error}"))
}

/// Stormkeep, with a man who is about to walk across its lower hall.
pub(crate) fn walk() -> Scene {
    let mut scene = data("worlds/stormkeep.glb");
    let placement = Placement {
        at: DVec3::new(-970.0, -40.0, -1312.0),
        turn_rad: std::f64::consts::FRAC_PI_2,
        scale: 40.0,
        speed: 40.0,
    };
    scene.place(data("actors/cesium_man.glb"), &placement);
    scene
}

/// From where he is seen, and where to look.
pub(crate) const WALK: [Vec3; 2] = [
    Vec3::new(-840.0, 10.0, -1440.0),
    Vec3::new(-950.0, -12.0, -1312.0),
];

/// The lights as shadow system and oracle see them.
pub(crate) fn plain(lights: &[StageLight]) -> Vec<Light> {
    lights.iter().map(|l| l.light).collect()
}

/// Lights by shape, position and range, named by number.
pub(crate) fn staged(lights: impl IntoIterator<Item = Light>) -> Vec<StageLight> {
    let named = |(number, light)| StageLight {
        name: format!("light_{number}"),
        light,
        power: Vec3::ONE,
        cos_inner: 1.0,
    };
    lights.into_iter().enumerate().map(named).collect()
}

pub(crate) fn point(position: impl Into<DVec3>, range: f32) -> Light {
    Light {
        position: position.into(),
        range,
        shape: LightShape::Point,
    }
}

/// A scene of one mesh in world space. Materials: 0 single-sided, 1 double-sided.
pub(crate) fn scene_of(name: &str, mesh: umbrage_scene::Mesh) -> Scene {
    let material = |double_sided| Material {
        double_sided,
        ..Material::default()
    };
    Scene {
        name: name.to_owned(),
        meshes: vec![mesh],
        instances: vec![Instance {
            name: name.to_owned(),
            mesh: 0,
            transform: DAffine3::IDENTITY,
            ..Instance::default()
        }],
        materials: vec![material(false), material(true)],
        ..Scene::default()
    }
}

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [low, high).
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In the box from `low` to `high`.
    pub(crate) fn point(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        Vec3::new(
            self.between(low.x, high.x),
            self.between(low.y, high.y),
            self.between(low.z, high.z),
        )
    }
}

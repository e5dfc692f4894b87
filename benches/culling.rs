//! What each step that skips work saves, on whole frames.
//!
//! `cargo bench --bench culling [-- SCENE...]`: tables of frame time with every step, without each,
//! and without any, in turn in one run; and of what is drawn. Without scenes: the bundled worlds.
//! `cargo test --bench culling` draws everything once, small.

use umbrage_core::frame::LightPath;
use umbrage_core::{Cull, Culls, Light, View};
use umbrage_lab::auto_camera::auto_camera;
use umbrage_lab::gpu::{AdapterChoice, Gpu};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::stage::{Casters, Stage, StageLight};

const BUNDLED: [&str; 3] = ["facing_giants", "stormkeep", "colosseum"];

fn main() {
    let given = || std::env::args().skip(1);
    // Cargo says --bench where times are wanted.
    let smoke = !given().any(|arg| arg == "--bench");
    let mut scenes: Vec<String> = given().filter(|arg| !arg.starts_with("--")).collect();
    if scenes.is_empty() {
        let path = |name| format!("{}/data/worlds/{name}.glb", env!("CARGO_MANIFEST_DIR"));
        scenes = BUNDLED.map(path).to_vec();
    }
    let (size, rounds) = match smoke {
        true => ([64, 36], 1),
        false => ([1280, 720], 5),
    };
    let gpu = Gpu::open(&AdapterChoice::Auto).unwrap_or_else(|error| panic!("{error}"));
    let mut lab = Lab::new(gpu);
    println!(
        "{}, {}x{}, medians of {rounds}",
        lab.gpu().adapter,
        size[0],
        size[1]
    );
    for scene in scenes {
        let site = Site::open(&scene, size);
        let rows: Vec<Row> = sets()
            .into_iter()
            .map(|(name, set)| Row::new(name, set))
            .collect();
        site.print(&mut lab, rows, rounds);
    }
}

/// Every step, all but one, none.
fn sets() -> Vec<(String, Culls)> {
    let mut sets = vec![("every step".to_owned(), Culls::EVERY)];
    for step in Cull::ALL {
        sets.push((
            format!("without {}", step.name()),
            Culls::EVERY.without(step),
        ));
    }
    sets.push(("none".to_owned(), Culls::NONE));
    sets
}

struct Row {
    name: String,
    culls: Culls,
    frame_ms: Vec<f64>,
    lights: usize,
    /// Triangles in the volumes of these lights.
    casters: u64,
    quads: u64,
}

impl Row {
    fn new(name: String, culls: Culls) -> Self {
        Self {
            name,
            culls,
            frame_ms: Vec::new(),
            lights: 0,
            casters: 0,
            quads: 0,
        }
    }

    fn median(&self) -> f64 {
        let mut times = self.frame_ms.clone();
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }
}

struct Site {
    stage: Stage,
    lights: Vec<StageLight>,
    view: View,
}

impl Site {
    fn open(scene: &str, size: [u32; 2]) -> Self {
        let loaded = umbrage_scene::open(scene, &()).unwrap_or_else(|error| panic!("{error}"));
        let stage = Stage::new(loaded, Casters::Material, None).expect("a valid scene");
        let lights = stage.lights(None);
        let plain: Vec<Light> = lights.iter().map(|l| l.light).collect();
        let fovy = 60f32.to_radians();
        let stand = auto_camera(&stage.mesh, &plain, fovy, size[0] as f32 / size[1] as f32);
        let view = View::look_at(stand.eye, stand.target, fovy, 0.1, size);
        Self {
            stage,
            lights,
            view,
        }
    }

    fn print(&self, lab: &mut Lab, mut rows: Vec<Row>, rounds: usize) {
        for _ in 0..rounds {
            for row in &mut rows {
                lab.culls = row.culls;
                lab.render(&self.stage, &self.lights, &self.view, Method::Counter, 1)
                    .unwrap_or_else(|error| panic!("{error}"));
                row.frame_ms.push(lab.times.frame);
                row.lights = lab.lights_by_path()[..2].iter().sum();
                let drawn = |i: &usize| !matches!(lab.path(*i), LightPath::Skipped(_));
                let casters = |i: usize| u64::from(lab.volumes.lights[i].facing_triangles);
                row.casters = (0..self.lights.len()).filter(drawn).map(casters).sum();
                let numbers = 0..self.lights.len();
                row.quads = numbers.map(|i| u64::from(lab.quads_drawn(i))).sum();
            }
        }
        println!("\n{}, {} lights", self.stage.scene.name, self.lights.len());
        println!(
            "{:20}{:>10}{:>8}{:>9}{:>11}{:>11}",
            "", "frame ms", "share", "lights", "casters", "quads"
        );
        let every = rows[0].median();
        for row in &rows {
            let (name, ms) = (&row.name, row.median());
            let (share, lights, quads) = (ms / every, row.lights, row.quads);
            let casters = row.casters;
            println!("{name:20}{ms:10.1}{share:8.2}{lights:9}{casters:11}{quads:11}");
        }
        // All triangles that cast, of all lights: three quads and two caps each.
        let brute = 5 * rows.last().map_or(0, |none| none.casters);
        let drawn = rows[0].quads;
        let fraction = drawn as f64 / brute.max(1) as f64;
        println!("polygons: {drawn} of brute force's {brute} with caps, {fraction:.4}");
    }
}

//! What can be typed: verbs and options. `umbrage <verb> --help` is written here.

use std::num::{NonZeroU32, NonZeroUsize};
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use serde::Serialize;
use umbrage_lab::Culls;
use umbrage_lab::gpu::AdapterChoice;
use umbrage_stress::CaseId;

use crate::actor::ActorChoice;
use crate::error::CliError;
use crate::json;
use crate::values::{
    CameraChoice, Instructions, LightChoice, Method, NamedCamera, NoCull, Point, RangeChoice, Size,
    adapter, fps, metres, ratio, seconds, time, weld,
};
use umbrage_report::Table;
use umbrage_view::DebugView;

/// Exact shadows from hundreds of lights in large triangle worlds: renders them, measures them
/// against an oracle, and says which light costs what.
#[derive(Debug, Parser)]
#[command(name = "umbrage", version, after_help = OVERVIEW)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

const OVERVIEW: &str = "\
SCENE is a .glb, .gltf or .obj file, or a generated world: gen:NAME?key=value&...

First steps:
  umbrage render 'gen:city?triangles=1e5&lights=256' -o city.png
  umbrage inspect map.glb
  umbrage check map.glb --camera auto --size 640x360

Exit codes: 0 success, 1 a check failed, 2 bad input or usage, 3 no usable adapter or display";

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    Render(RenderArgs),
    Inspect(InspectArgs),
    Check(CheckArgs),
    Volumes(VolumesArgs),
    Bench(BenchArgs),
    Profile(ProfileArgs),
    Stress(StressArgs),
    // Boxed: it is far larger than the others.
    View(Box<WindowArgs>),
    Gen(GenArgs),
}

/// Draws the scene with the shadows of all its lights, as a PNG.
#[derive(Debug, Args)]
#[command(after_help = RENDER_EXAMPLES)]
pub(crate) struct RenderArgs {
    /// A .glb, .gltf or .obj file, or gen:NAME?key=value&...
    pub(crate) scene: String,
    /// The picture to write; with --heatmap, the heat map
    #[arg(short = 'o', long = "output", value_name = "FILE.png")]
    pub(crate) output: Option<PathBuf>,
    /// Write each light's shadow mask into this folder (white: lit), one PNG a light
    #[arg(long, value_name = "DIR")]
    pub(crate) mask_out: Option<PathBuf>,
    /// Draw a count for each pixel in false colours instead of the lit picture
    #[arg(long, value_enum, requires = "output")]
    pub(crate) heatmap: Option<Heatmap>,
    #[command(flatten)]
    pub(crate) common: Common,
}

const RENDER_EXAMPLES: &str = "\
Examples:
  umbrage render map.glb -o map.png
      The scene's own lights, from its first camera, or one found automatically
  umbrage render model.obj --lights 256:7 --camera 4,2,8,0,1,0 -o model.png
      256 lights placed by seed 7, seen from (4, 2, 8) towards (0, 1, 0)
  umbrage render map.glb --world map.world -o map.png
      The first run saves the built world, the next ones map it
  umbrage render map.glb --actor 'man.glb?at=3,0,-2&turn=90&speed=1.2' --time 2.5 -o walk.png
      A man set down at (3, 0, -2), facing +X, and three metres on from there
  umbrage render map.glb --heatmap overdraw -o heat.png --json - | jq .totals
      Where the fill goes, and the totals of the frame
  umbrage render map.glb --method none -o lit.png --json floor.json
      The same frame without shadows: the floor that every frame time is compared with";

/// What a heat map counts at each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Heatmap {
    /// Volume fragments drawn, of all lights
    Overdraw,
    /// Lights that reach the surface
    Lights,
    /// Volumes that enclose the surface, of all lights
    Layers,
    /// Fragments: volumes and lights together
    Cost,
}

/// Counts what a scene's triangles are made of, without drawing.
#[derive(Debug, Args)]
#[command(after_help = INSPECT_EXAMPLES)]
pub(crate) struct InspectArgs {
    /// A .glb, .gltf or .obj file, or gen:NAME?key=value&...
    pub(crate) scene: String,
    #[command(flatten)]
    pub(crate) results: ResultArgs,
    #[command(flatten)]
    pub(crate) world: WorldArgs,
    /// CPU threads [default: all cores]
    #[arg(long, help_heading = "Run", value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Changes nothing here, as --range
    #[arg(long, help_heading = IGNORED, value_name = "scene|N[:seed]|FILE.json")]
    pub(crate) lights: Option<LightChoice>,
    #[command(flatten)]
    pub(crate) ignored: Ignored,
}

const INSPECT_EXAMPLES: &str = "\
Nothing that is counted here is an error: open edges, edges of many triangles, opposite
winding, degenerate and duplicate triangles all cast exact shadows.

Blended triangles and what moves count too, so a scene with some needs a --world file of its own
here.

Examples:
  umbrage inspect map.glb
  umbrage inspect 'gen:soup?triangles=2000' --json - | jq .edges_by_triangles";

/// Compares a method's shadow masks with an exact ray cast, light by light and pixel by pixel.
#[derive(Debug, Args)]
#[command(after_help = CHECK_EXAMPLES)]
pub(crate) struct CheckArgs {
    /// A .glb, .gltf or .obj file, or gen:NAME?key=value&...
    pub(crate) scene: String,
    #[command(flatten)]
    pub(crate) common: Common,
}

const CHECK_EXAMPLES: &str = "\
A pixel-light on which method and oracle differ is ambiguous if the oracle's own verdict turns
when the eye ray moves by the stated tolerance; else it is wrong. Exit code 1 if any is wrong
and the method is an exact one, or its layers are within what the method's mask can represent.

Examples:
  umbrage check map.glb
  umbrage check map.glb --method shadowmap-1024 --json -
      How wrong cube maps of 1024 texels a side are on the same frame";

/// Generates volumes by every method, without drawing, and compares them.
#[derive(Debug, Args)]
#[command(after_help = VOLUMES_EXAMPLES)]
pub(crate) struct VolumesArgs {
    /// A .glb, .gltf or .obj file, or gen:NAME?key=value&...
    pub(crate) scene: String,
    /// Use no better instructions than these: portable, avx2 or avx512. Quads are the same [default:
    /// the best this processor has]
    #[arg(long, value_name = "NAME")]
    pub(crate) instructions: Option<Instructions>,
    #[command(flatten)]
    pub(crate) results: ResultArgs,
    #[command(flatten)]
    pub(crate) world: WorldArgs,
    /// Lights, as for render
    #[arg(
        long,
        help_heading = "World",
        value_name = "scene|N[:seed]|FILE.json",
        default_value = "scene"
    )]
    pub(crate) lights: LightChoice,
    /// Runs that times are medians over, after one warm-up
    #[arg(long, help_heading = "Run", value_name = "N", default_value = "5")]
    pub(crate) repeat: NonZeroUsize,
    /// CPU threads [default: all cores]
    #[arg(long, help_heading = "Run", value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) ignored: Ignored,
}

const VOLUMES_EXAMPLES: &str = "\
Examples:
  umbrage volumes map.glb
      Nanoseconds a candidate triangle, quads and polygons of counter, crow and brute
  umbrage volumes map.glb --range 1e30 --repeat 9 --json -
      Every triangle a candidate of every light";

/// Plots run time against error: every method on the same frames.
#[derive(Debug, Args)]
#[command(after_help = BENCH_EXAMPLES)]
pub(crate) struct BenchArgs {
    /// .glb, .gltf or .obj files, or gen:NAME?key=value&...
    #[arg(required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<String>,
    /// Write report.json, report.csv and index.html with plots, tables and pictures of what is
    /// wrong into this folder
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Methods between commas; those of --method. none is the floor that times are related to
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = DEFAULT_METHODS)]
    pub(crate) methods: Vec<Method>,
    /// Compare with the report.json of an earlier run with the same settings: exit code 1 if a method
    /// got slower or less exact by more than --ratio
    #[arg(long, value_name = "report.json")]
    pub(crate) baseline: Option<PathBuf>,
    /// What --baseline allows: 1.2 is a fifth more time. Times are multiples of none's; none's own, on
    /// the same processor and adapter, may grow by twice as much
    #[arg(long, value_name = "FACTOR", default_value = "1.2", value_parser = ratio, requires = "baseline")]
    pub(crate) ratio: f64,
    /// Times only: ask no oracle for errors
    #[arg(long)]
    pub(crate) no_oracle: bool,
    /// Time runs on from frame to frame, this many frames a second: what moves is posed, and what
    /// hangs on it made anew, within the frame's time. Errors are those of the first moment
    #[arg(long, value_name = "FPS", value_parser = fps)]
    pub(crate) play: Option<f32>,
    /// Seconds after which a row gets no more repeats
    #[arg(long, value_name = "SECONDS", default_value = "20", value_parser = seconds)]
    pub(crate) limit: f32,
    #[command(flatten)]
    pub(crate) results: ResultArgs,
    #[command(flatten)]
    pub(crate) world: WorldArgs,
    /// Lights of every scene, as for render
    #[arg(
        long,
        help_heading = "World",
        value_name = "scene|N[:seed]|FILE.json",
        default_value = "scene"
    )]
    pub(crate) lights: LightChoice,
    /// Picture size in pixels; may be given several times
    #[arg(
        long = "size",
        help_heading = "View",
        value_name = "WxH",
        default_value = "1280x720"
    )]
    pub(crate) sizes: Vec<Size>,
    /// Camera, as for render; may be given several times
    #[arg(
        long = "camera",
        help_heading = "View",
        value_name = "N|NAME|auto|x,y,z,tx,ty,tz[,fovy_deg]",
        allow_hyphen_values = true
    )]
    pub(crate) given_cameras: Vec<NamedCamera>,
    /// Distance of the near plane [default: the camera's, else at most 0.1]
    #[arg(long, help_heading = "View", value_name = "METRES", value_parser = metres)]
    pub(crate) near: Option<f32>,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

impl BenchArgs {
    /// The cameras, or the scene's own choice.
    pub(crate) fn cameras(&self) -> Vec<Option<NamedCamera>> {
        match &self.given_cameras[..] {
            [] => vec![None],
            given => given.iter().cloned().map(Some).collect(),
        }
    }
}

/// One of each kind.
const DEFAULT_METHODS: &str = "none,counter,counter-zfail,counter-finite,brute,crow,mask-alpha,\
                               half,quarter,shadowmap-256,shadowmap-512,shadowmap-1024,raytrace";

const BENCH_EXAMPLES: &str = "\
Every scene is seen by every camera at every size, and drawn there by every method. Errors are
counted against an exact ray cast of the same view, made once for all methods. Ctrl-C ends the
run with a valid report of what there is. Exit code 1 if a row fails, if a method that promises no
errors has some, or if the run ends early.

Examples:
  umbrage bench map.glb city.glb -o report
  umbrage bench map.glb --methods none,counter,shadowmap-1024,raytrace --repeat 9 -o report
  umbrage bench 'gen:city?triangles=1e4' 'gen:city?triangles=1e5' --size 640x360 --size 1280x720 -o scaling
      Rows that differ in one thing only become a plot of time over it
  umbrage bench map.glb --baseline report/report.json --ratio 1.15";

/// Says what each light costs, why, and what would make it cheaper.
#[derive(Debug, Args)]
#[command(after_help = PROFILE_EXAMPLES)]
pub(crate) struct ProfileArgs {
    /// A .glb, .gltf or .obj file, or gen:NAME?key=value&...
    pub(crate) scene: String,
    /// Write profile.json, trace.json (for Perfetto or chrome://tracing) and index.html with the
    /// tables, a plan of the scene and the costliest lights into this folder
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Apply each piece of advice in memory, and measure what it saves
    #[arg(long)]
    pub(crate) verify: bool,
    #[command(flatten)]
    pub(crate) common: Common,
}

const PROFILE_EXAMPLES: &str = "\
Ordinary frames are timed, undisturbed. In turn with them each light is built on one thread with a
clock between the stages, and drawn in passes of its own, several times over; --repeat is the number of
rounds, whose medians count. What the lights' figures leave of the frame is shown as a remainder.
Without timestamps there are no GPU figures.

Advice holds for the view at hand: a light may show elsewhere.

Examples:
  umbrage profile map.glb -o profile
      Then open profile/index.html
  umbrage profile map.glb --camera 3 --verify -o profile
      Predicted and measured savings side by side
  umbrage profile map.glb --json - | jq '.lights | sort_by(-.frame_us)[:5] | .[].name'";

/// Tries to break volumes and masks with seeded cases of hostile geometry, without a scene.
#[derive(Debug, Args)]
#[command(after_help = STRESS_EXAMPLES)]
pub(crate) struct StressArgs {
    /// Cases, dealt to the families in turn
    #[arg(long, value_name = "N", default_value = "2000")]
    pub(crate) cases: u64,
    /// Seeds the cases
    #[arg(long, value_name = "S", default_value = "1")]
    pub(crate) seed: u64,
    /// How many cases are drawn too, by counter and counter-zfail; with 0 no adapter is needed
    /// [default: one in 30]
    #[arg(long, value_name = "N")]
    pub(crate) render: Option<u64>,
    /// Begin no case later than this
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub(crate) time: Option<f32>,
    /// Only this family; may be given several times
    #[arg(long = "family", value_name = "NAME")]
    pub(crate) families: Vec<String>,
    /// One case again, by the name that a report gives it
    #[arg(long, value_name = "FAMILY:SEED", conflicts_with_all = ["cases", "seed", "families"])]
    pub(crate) case: Option<CaseId>,
    /// Write the first failures into this folder, each made as small as it still fails
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) results: ResultArgs,
    /// CPU threads; results are the same with any number [default: all cores]
    #[arg(long, help_heading = "Run", value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// As for render
    #[arg(long, help_heading = "Run", value_name = "auto|NAME|cpu", default_value = "auto", value_parser = adapter)]
    pub(crate) adapter: AdapterChoice,
}

const STRESS_EXAMPLES: &str = "\
Every case is checked on the CPU: volumes are closed in integers, and at sampled points the volume's
own count, by exact signed crossings of its polygons, is compared with the oracle's segment cast. A
point is ambiguous if the oracle's answer turns when it moves by 2^-30 of its distance from the
light. Drawn cases are judged as check does. Exit code 1 if anything is wrong or open.

Examples:
  umbrage stress
  umbrage stress --cases 100000 --render 3000 --seed 7 --json stress.json
  umbrage stress --family slivers --family lattice --render 0 --time 60
  umbrage stress --case soup:9e3779b97f4a7c15 -o failures";

/// Opens a window on the scene: fly through it, solo and mute its lights, see what each costs, and what
/// its shadow is made of.
#[derive(Debug, Args)]
#[command(after_help = VIEW_EXAMPLES)]
pub(crate) struct WindowArgs {
    /// A .glb, .gltf or .obj file, or gen:NAME?key=value&...
    pub(crate) scene: String,
    /// Debug view to begin with: lit, volumes, silhouettes, layers, lights, scissors, boxes, subset or
    /// wrong
    #[arg(long = "debug", value_name = "VIEW", default_value = "lit")]
    pub(crate) shown: DebugView,
    /// Name of the light to choose at the beginning
    #[arg(long, value_name = "LIGHT")]
    pub(crate) select: Option<String>,
    /// Write a picture of the window, panels included, and close it: once --frames are drawn, every
    /// light's cost is measured and what the debug view counts is there
    #[arg(long, value_name = "FILE.png")]
    pub(crate) screenshot: Option<PathBuf>,
    /// Frames before the screenshot
    #[arg(long, value_name = "N", default_value = "3", requires = "screenshot")]
    pub(crate) frames: NonZeroU32,
    #[command(flatten)]
    pub(crate) common: Common,
}

const VIEW_EXAMPLES: &str = "\
Keys: H in the window lists them. W A S D Q E fly, dragging looks around, the wheel changes speed;
1 to 9 choose a debug view; Up and Down choose a light, Space plays it alone, M mutes it; O compares
the view with the oracle. --size is the window's at the beginning; --repeat changes nothing here.

Examples:
  umbrage view map.glb
  umbrage view map.glb --debug volumes --select porch_lamp
      The shadow volume of one lamp
  umbrage view map.glb --debug wrong --screenshot wrong.png
      The window with every wrong pixel marked, as a picture
  xvfb-run umbrage view map.glb --screenshot window.png
      The same where there is no display";

/// Writes a generated world as a .glb file.
#[derive(Debug, Args)]
#[command(after_help = GEN_EXAMPLES)]
pub(crate) struct GenArgs {
    /// NAME?key=value&..., with or without gen: before it
    pub(crate) world: String,
    /// The file to write
    #[arg(short = 'o', long = "output", value_name = "FILE.glb")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) results: ResultArgs,
}

const GEN_EXAMPLES: &str = "\
Worlds: city?triangles=&lights=&seed=&moon=   soup?triangles=&lights=&seed=
        field?n=&lights=&seed=
Put the name in quotes: & and ? mean something to the shell.

Examples:
  umbrage gen 'city?triangles=1e6&lights=500' -o city.glb
  umbrage gen soup -o soup.glb";

/// Where results go.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Results")]
pub(crate) struct ResultArgs {
    /// Write machine-readable results; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// No tables, no progress bar
    #[arg(long, short = 'q')]
    pub(crate) quiet: bool,
}

impl ResultArgs {
    /// Whether tables are printed: they never mix with JSON on standard output.
    pub(crate) fn shows_tables(&self) -> bool {
        !self.quiet && !self.json.as_deref().is_some_and(json::is_stdout)
    }

    /// Prints `table` and writes `report`.
    pub(crate) fn show(&self, table: &Table, report: &impl Serialize) -> Result<(), CliError> {
        if self.shows_tables() {
            json::print(&table.to_string());
        }
        self.json
            .as_deref()
            .map_or(Ok(()), |path| json::write(path, report))
    }
}

const IGNORED: &str = "Accepted and ignored";

/// Common options that verbs which draw nothing accept, so that scripts can pass the same ones to
/// every verb, and do not look at.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = IGNORED)]
pub(crate) struct Ignored {
    /// Changes nothing here
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<Size>,
    /// Changes nothing here
    #[arg(
        long,
        value_name = "N|NAME|auto|x,y,z,tx,ty,tz[,fovy_deg]",
        allow_hyphen_values = true
    )]
    pub(crate) camera: Option<CameraChoice>,
    /// Changes nothing here
    #[arg(long, value_name = "NAME")]
    pub(crate) method: Option<Method>,
    /// Changes nothing here
    #[arg(long, value_name = "auto|NAME|cpu", value_parser = adapter)]
    pub(crate) adapter: Option<AdapterChoice>,
}

/// Options of the verbs that draw a scene.
#[derive(Clone, Debug, Args)]
pub(crate) struct Common {
    #[command(flatten)]
    pub(crate) results: ResultArgs,
    #[command(flatten)]
    pub(crate) world: WorldArgs,
    /// scene: its own lights, or 64 seeded ones where it has none; or a count with a seed to
    /// place them by; or a JSON array of lights
    #[arg(
        long,
        help_heading = "World",
        value_name = "scene|N[:seed]|FILE.json",
        default_value = "scene"
    )]
    pub(crate) lights: LightChoice,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    /// counter: z-pass from the eye count; counter-zfail: both caps for every light; none: no
    /// shadows.
    ///
    /// counter-finite: volumes that end outside the light's range; counter-finite-naive: at it, which
    /// is too near. brute: every triangle its own volume. crow: edges that point to two faces, right
    /// on two-manifolds. extrude: a static buffer that the vertex shader opens up, right on closed
    /// meshes; extrude-face-weights and extrude-vertex-weights turn the normals of skinned characters
    ///
    /// Without a stencil (Roettger, Irion and Ertl): mask-screen doubles and halves an 8-bit mask
    /// of three values, normalised by three rectangles; it can represent two layers on the way to a
    /// count, and beyond may show lit what is in shadow. mask-alpha: the same in the frame buffer's
    /// float alpha, whose exponent counts 16 layers; mask-max: 14, normalised by one rectangle with
    /// the maximum blend equation, and one more for black shadows. half, quarter: counted in the
    /// stencil at that part of the resolution, the mask filtered bilinearly; also mask-screen-half
    /// and so on
    ///
    /// shadowmap-N: cubes of N texels a side, 256 to 4096 in steps of 64, two by two texels filtered;
    /// one map for spots up to 80 degrees and for directional lights. raytrace: rays over the BVH,
    /// in a compute shader. oracle: the exact ray cast that the others are judged by, on the CPU
    #[arg(
        long,
        help_heading = "Run",
        value_name = "NAME",
        default_value = "counter"
    )]
    pub(crate) method: Method,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

/// What casts and what shines.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "World")]
pub(crate) struct WorldArgs {
    /// How far lights shine. auto: each light's own range, or where it has none the distance
    /// at which it falls below 0.01 lux
    #[arg(long, value_name = "auto|METRES", default_value = "auto")]
    pub(crate) range: RangeChoice,
    /// Which sides of triangles cast shadows; material: front of single-sided ones, both of
    /// double-sided ones. Blended ones are left out
    #[arg(long, value_enum, default_value_t = Casters::Material)]
    pub(crate) casters: Casters,
    /// World position that all others are taken relative to, as an engine does whose world is large:
    /// the scene then stands as far from zero as it stands from there. Where f32 is too coarse for
    /// that, positions are kept as two f32 [default: near the scene]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) origin: Option<Point>,
    /// Which vertices of what never moves are one: those at the same place, or those within a
    /// tolerance, which are moved onto each other; the oracle sees them moved. What moves is never
    /// welded by tolerance
    #[arg(long, value_name = "exact|METRES", default_value = "exact", value_parser = weld)]
    pub(crate) weld: f32,
    /// Keep the built world in this file: saved if it does not exist, else mapped, in milliseconds.
    /// It holds for one scene, --casters, --origin and --weld; for others it is refused. What moves
    /// is not in it
    #[arg(long = "world", value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
    /// Place a second file in the scene, once or many times: it stands at=X,Y,Z, turned about +Y by
    /// turn=DEGREES, scale=S times its size, and walks along its own heading (+Z before the turn)
    /// at speed=METRES a second; it plays its first animation. Its lights and cameras are left out. A
    /// generated world has a ? of its own first: gen:field?n=2?scale=2, or gen:field??scale=2
    #[arg(
        long = "actor",
        value_name = "FILE?at=X,Y,Z&turn=DEG&scale=S&speed=M_PER_S"
    )]
    pub(crate) actors: Vec<ActorChoice>,
    /// When: everything animated, and every --actor, is posed as it is this many seconds on.
    /// Animations loop. All frames of render, check and bench draw this one moment, but for those of
    /// bench --play, which begin with it
    #[arg(long, value_name = "SECONDS", default_value = "0", allow_hyphen_values = true, value_parser = time)]
    pub(crate) time: f64,
}

/// Where the eye is.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "View")]
pub(crate) struct ViewArgs {
    /// Picture size in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720")]
    pub(crate) size: Size,
    /// The scene's camera by number or name; auto: a standpoint that sees much lit surface; or
    /// eye and target in world metres [default: the scene's first camera, else auto]
    #[arg(
        long,
        value_name = "N|NAME|auto|x,y,z,tx,ty,tz[,fovy_deg]",
        allow_hyphen_values = true
    )]
    pub(crate) camera: Option<CameraChoice>,
    /// Distance of the near plane [default: the camera's, else at most 0.1]
    #[arg(long, value_name = "METRES", value_parser = metres)]
    pub(crate) near: Option<f32>,
}

/// How the work is done.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Run")]
pub(crate) struct RunArgs {
    /// What masks leave of a light in its shadow: nothing; an ambient term, in one more draw a
    /// light; or half of it. Other methods know black only. It is for pictures: check, which asks
    /// only where light is, takes black alone, and render --mask-out writes the same with all
    #[arg(long, value_enum, default_value_t = Shadows::Black)]
    pub(crate) shadows: Shadows,
    /// Frames that times are medians over, after one warm-up
    #[arg(long, value_name = "N", default_value = "5")]
    pub(crate) repeat: NonZeroUsize,
    /// Switch off a step that skips work: view, receivers, quads, hidden, range, cache, or all. No
    /// step changes a shadow, only what it costs
    #[arg(long, value_name = "STEP", value_delimiter = ',')]
    pub(crate) no_cull: Vec<NoCull>,
    /// CPU threads [default: all cores]
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// auto: the fastest; cpu: a software rasteriser; or part of an adapter's name
    #[arg(long, value_name = "auto|NAME|cpu", default_value = "auto", value_parser = adapter)]
    pub(crate) adapter: AdapterChoice,
}

impl RunArgs {
    /// The steps that are left.
    pub(crate) fn culls(&self) -> Culls {
        self.no_cull
            .iter()
            .fold(Culls::EVERY, |left, off| match off.0 {
                Some(step) => left.without(step),
                None => Culls::NONE,
            })
    }
}

/// `--casters`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Casters {
    #[default]
    Material,
    Front,
    Back,
    Both,
}

impl From<Casters> for umbrage_lab::stage::Casters {
    fn from(choice: Casters) -> Self {
        match choice {
            Casters::Material => Self::Material,
            Casters::Front => Self::Front,
            Casters::Back => Self::Back,
            Casters::Both => Self::Both,
        }
    }
}

/// `--shadows`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Shadows {
    #[default]
    Black,
    Ambient,
    Attenuated,
}

impl From<Shadows> for umbrage_lab::application::Application {
    fn from(choice: Shadows) -> Self {
        match choice {
            Shadows::Black => Self::Black,
            Shadows::Ambient => Self::Ambient,
            Shadows::Attenuated => Self::Attenuated,
        }
    }
}

impl From<Heatmap> for umbrage_lab::heat::Heat {
    fn from(choice: Heatmap) -> Self {
        match choice {
            Heatmap::Overdraw => Self::Overdraw,
            Heatmap::Lights => Self::Lights,
            Heatmap::Layers => Self::Layers,
            Heatmap::Cost => Self::Cost,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parse(line: &str) -> Result<Verb, clap::Error> {
        Cli::try_parse_from(line.split(' ')).map(|cli| cli.verb)
    }

    #[test]
    fn the_definition_holds() {
        Cli::command().debug_assert();
    }

    #[test]
    fn defaults_are_as_documented() {
        let Ok(Verb::Render(args)) = parse("umbrage render x.glb") else {
            panic!("not render")
        };
        assert_eq!(args.common.view.size, Size([1280, 720]));
        assert_eq!(args.common.lights, LightChoice::Scene);
        assert_eq!(args.common.method.0.name(), "counter");
        assert_eq!(args.common.run.repeat.get(), 5);
        assert_eq!(args.common.world.weld, 0.0);
        assert!(args.common.view.camera.is_none() && args.common.results.json.is_none());
    }

    #[test]
    fn a_camera_may_begin_with_a_minus() {
        let line = "umbrage check x.obj --camera -4,2,8,0,1,0 --origin -1e5,0,0 --json - -q";
        let Ok(Verb::Check(args)) = parse(line) else {
            panic!("not check")
        };
        assert!(matches!(
            args.common.view.camera,
            Some(CameraChoice::Free { .. })
        ));
        assert!(args.common.results.quiet && args.common.world.origin.is_some());
    }

    #[test]
    fn usage_errors_exit_with_2_and_help_with_0() {
        for line in [
            "umbrage",
            "umbrage render",
            "umbrage render x.glb --size 10",
            "umbrage render x.glb --method nope",
            "umbrage render x.glb --heatmap overdraw",
            "umbrage render x.glb --repeat 0",
            "umbrage inspect x.glb --lights lots",
            "umbrage inspect x.glb --weld close",
            "umbrage inspect x.glb --weld -1",
            "umbrage gen city",
            "umbrage dance x.glb",
        ] {
            assert_eq!(parse(line).unwrap_err().exit_code(), 2, "{line}");
        }
        assert_eq!(parse("umbrage render --help").unwrap_err().exit_code(), 0);
    }
}

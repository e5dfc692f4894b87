//! What can be typed: verbs and options. `umbrage <verb> --help` is written here.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use serde::Serialize;
use umbrage_lab::Culls;
use umbrage_lab::gpu::AdapterChoice;

use crate::error::CliError;
use crate::json;
use crate::table::Table;
use crate::values::{
    CameraChoice, Instructions, LightChoice, Method, NoCull, Point, RangeChoice, Size, adapter,
    metres,
};

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

Exit codes: 0 success, 1 a check failed, 2 bad input or usage, 3 no usable adapter";

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    Render(RenderArgs),
    Inspect(InspectArgs),
    Check(CheckArgs),
    Volumes(VolumesArgs),
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
    pub(crate) common: Common,
}

const INSPECT_EXAMPLES: &str = "\
Nothing that is counted here is an error: open edges, edges of many triangles, opposite
winding, degenerate and duplicate triangles all cast exact shadows.

Blended triangles count too, so a scene with some needs a --world file of its own here.

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
and the method is an exact one.

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
    pub(crate) common: Common,
}

const VOLUMES_EXAMPLES: &str = "\
Examples:
  umbrage volumes map.glb
      Nanoseconds a candidate triangle, quads and polygons of counter, crow and brute
  umbrage volumes map.glb --range 1e30 --repeat 9 --json -
      Every triangle a candidate of every light";

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
    /// Prints `table` and writes `report`; a table never mixes with JSON on standard output.
    pub(crate) fn show(&self, table: &Table, report: &impl Serialize) -> Result<(), CliError> {
        let taken = self.json.as_deref().is_some_and(json::is_stdout);
        if !self.quiet && !taken {
            json::print(&table.to_string());
        }
        self.json
            .as_deref()
            .map_or(Ok(()), |path| json::write(path, report))
    }
}

/// Options of every verb that takes a scene.
#[derive(Clone, Debug, Args)]
pub(crate) struct Common {
    #[command(flatten)]
    pub(crate) results: ResultArgs,
    #[command(flatten)]
    pub(crate) world: WorldArgs,
    #[command(flatten)]
    pub(crate) view: ViewArgs,
    #[command(flatten)]
    pub(crate) run: RunArgs,
}

/// What casts and what shines.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "World")]
pub(crate) struct WorldArgs {
    /// scene: its own lights, or 64 seeded ones where it has none; or a count with a seed to
    /// place them by; or a JSON array of lights
    #[arg(long, value_name = "scene|N[:seed]|FILE.json", default_value = "scene")]
    pub(crate) lights: LightChoice,
    /// How far lights shine. auto: each light's own range, or where it has none the distance
    /// at which it falls below 0.01 lux
    #[arg(long, value_name = "auto|METRES", default_value = "auto")]
    pub(crate) range: RangeChoice,
    /// Which sides of triangles cast shadows; material: front of single-sided ones, both of
    /// double-sided ones. Blended ones are left out
    #[arg(long, value_enum, default_value_t = Casters::Material)]
    pub(crate) casters: Casters,
    /// World position that all f32 positions are relative to; far from the scene it costs
    /// precision [default: near the scene]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) origin: Option<Point>,
    /// Keep the built world in this file: saved if it does not exist, else mapped, in milliseconds.
    /// It holds for one scene, --casters and --origin; for others it is refused
    #[arg(long = "world", value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
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
    /// counter: z-pass from the eye count; counter-zfail: both caps for every light; shadowmap-N:
    /// cube maps of N texels a side, 256 to 4096, and one map for narrow spots and for directional
    /// lights; raytrace: rays over the BVH, in a compute
    /// shader; none: no shadows
    #[arg(long, value_name = "NAME", default_value = "counter")]
    pub(crate) method: Method,
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
        assert_eq!(args.common.world.lights, LightChoice::Scene);
        assert_eq!(args.common.run.method.0.name(), "counter");
        assert_eq!(args.common.run.repeat.get(), 5);
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
            "umbrage gen city",
            "umbrage dance x.glb",
        ] {
            assert_eq!(parse(line).unwrap_err().exit_code(), 2, "{line}");
        }
        assert_eq!(parse("umbrage render --help").unwrap_err().exit_code(), 0);
    }
}

//! A loaded scene made ready: triangles with casting rules, a world, lights, and what shading
//! needs.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use thiserror::Error;
use umbrage_core::world::{ObjectError, SavedWorldError, World, WorldError};
use umbrage_core::{Casting, Light, LightShape, Mesh};
use umbrage_scene::rig::Posed;
use umbrage_scene::{AlphaMode, LightKind, Scene, SceneError, Soup};

use crate::actors::{self, Actor};

pub use crate::actors::fixed_part;
use crate::saved_world::{WorldFileError, open_or_build};

/// Which casting rule the scene's casters follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Casters {
    /// Each material's own: single-sided casts from its front, double-sided from both.
    #[default]
    Material,
    /// Front faces.
    Front,
    /// Back faces.
    Back,
    /// Both: shadows equal those of an any-hit ray cast.
    Both,
}

/// Why a scene cannot be staged.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StageError {
    /// The file or generator.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The triangles.
    #[error("{scene}: {error}")]
    World {
        /// Name of the scene.
        scene: String,
        /// What is wrong.
        error: WorldError,
    },
    /// An instance that moves.
    #[error("{scene}: instance {instance}: {error}")]
    Actor {
        /// Name of the scene.
        scene: String,
        /// Name of the instance.
        instance: String,
        /// What is wrong.
        error: ObjectError,
    },
    /// The file of its world.
    #[error("{}: {error}", file.display())]
    SavedWorld {
        /// Its path.
        file: PathBuf,
        /// What is wrong.
        error: SavedWorldError,
    },
}

impl StageError {
    pub(crate) fn actor(scene: &Scene, instance: u32, error: ObjectError) -> Self {
        StageError::Actor {
            scene: scene.name.clone(),
            instance: scene.instances[instance as usize].name.clone(),
            error,
        }
    }

    /// Names what the error is about.
    pub fn new(scene: &Scene, world_file: Option<&Path>, error: WorldFileError) -> Self {
        match error {
            WorldFileError::Build(error) => StageError::World {
                scene: scene.name.clone(),
                error,
            },
            WorldFileError::File(error) => StageError::SavedWorld {
                file: world_file.unwrap_or(Path::new("")).to_owned(),
                error,
            },
        }
    }
}

/// A light with what the lab shades it by.
#[derive(Clone, Debug, PartialEq)]
pub struct StageLight {
    /// Unique in the scene.
    pub name: String,
    /// What the shadow system sees.
    pub light: Light,
    /// Linear colour times intensity: candela for point and spot lights, lux for directional.
    pub power: Vec3,
    /// Cosine of the half angle within which a spot is at full strength.
    pub cos_inner: f32,
}

impl StageLight {
    /// The word used in reports: `point`, `spot` or `directional`.
    pub fn kind(&self) -> &'static str {
        match self.light.shape {
            LightShape::Point => "point",
            LightShape::Spot { .. } => "spot",
            LightShape::Directional { .. } => "directional",
        }
    }
}

/// A scene ready to render and to judge.
#[derive(Debug)]
pub struct Stage {
    /// As loaded, its lights and cameras where they are at `time_s`.
    pub scene: Scene,
    /// World-space triangles with shading attributes, those that never move first, else in file
    /// order, without blended ones: these neither cast nor receive, and the lab does not draw them.
    pub soup: Soup,
    /// The same triangles as the library and the oracle take them.
    pub mesh: Mesh,
    /// Built from those of `mesh` that never move, with an object for each of `actors`.
    pub world: World,
    /// What moves.
    pub actors: Vec<Actor>,
    /// Where the nodes and joints of the scene are at `time_s`.
    pub posed: Posed,
    /// Seconds: see [`Stage::set_time`].
    pub time_s: f64,
}

/// By which rules a stage's triangles cast, with the world and the objects built for that: see
/// [`Stage::recast`].
#[derive(Debug)]
pub struct Cast {
    casting: Vec<Casting>,
    world: World,
    actors: Vec<Actor>,
}

/// Illuminance (lux) below which a light without a range is taken to end.
const DARK: f32 = 0.01;

impl Stage {
    /// Flattens the scene at time zero and builds its world, with positions relative to `origin` or
    /// to the soup's own.
    pub fn new(scene: Scene, casters: Casters, origin: Option<DVec3>) -> Result<Self, StageError> {
        Self::with_world_file(scene, casters, origin, 0.0, None)
    }

    /// The same with the world of what never moves mapped from `world_file` where that exists, else
    /// saved there, and with positions of what never moves within `weld_m` of each other welded
    /// (see [`Mesh::weld_within`]; 0 moves none).
    pub fn with_world_file(
        mut scene: Scene,
        casters: Casters,
        origin: Option<DVec3>,
        weld_m: f32,
        world_file: Option<&Path>,
    ) -> Result<Self, StageError> {
        let posed = scene.posed(0.0);
        scene.follow(&posed);
        let mut soup = scene.soup_posed(&posed, origin)?;
        drop_blended(&scene, &mut soup);
        let mut mesh = mesh(&scene, &soup, casters);
        let [vertices, fixed] = fixed_part(&scene, &soup);
        if let Err(error) = mesh.weld_first_within(vertices, weld_m) {
            return Err(StageError::new(&scene, None, error.into()));
        }
        if weld_m != 0.0 {
            soup.positions.clone_from(&mesh.positions);
            soup.residuals.clone_from(&mesh.residuals);
        }
        let mut world = match open_or_build(&first(&mesh, vertices, fixed), world_file) {
            Ok(found) => found.world,
            Err(error) => return Err(StageError::new(&scene, world_file, error)),
        };
        Ok(Self {
            actors: actors::insert(&scene, &soup, &mesh, fixed, &mut world)?,
            scene,
            soup,
            mesh,
            world,
            posed,
            time_s: 0.0,
        })
    }

    /// The triangles that never move; all of them, where they stand at time zero, if every one may.
    /// So it does not depend on [`Stage::set_time`].
    pub fn scenery(&self) -> Cow<'_, Mesh> {
        match fixed_part(&self.scene, &self.soup) {
            [_, 0] if self.time_s == 0.0 => Cow::Borrowed(&self.mesh),
            [_, 0] => Cow::Owned(self.mesh_at(0.0)),
            [vertices, triangles] => first(&self.mesh, vertices, triangles),
        }
    }

    /// The world as it would be if the triangles cast by other rules, one a triangle of `mesh`.
    ///
    /// # Errors
    /// As [`Stage::new`].
    pub fn recast(&self, casting: Vec<Casting>) -> Result<Cast, StageError> {
        let [vertices, fixed] = fixed_part(&self.scene, &self.soup);
        let mesh = Mesh {
            casting,
            ..self.mesh.clone()
        };
        let mut world = World::build(&first(&mesh, vertices, fixed))
            .map_err(|error| StageError::new(&self.scene, None, error.into()))?;
        Ok(Cast {
            actors: actors::insert(&self.scene, &self.soup, &mesh, fixed, &mut world)?,
            casting: mesh.casting,
            world,
        })
    }

    /// Casts as `cast` has it, which then has what was there.
    pub fn exchange(&mut self, cast: &mut Cast) {
        std::mem::swap(&mut self.mesh.casting, &mut cast.casting);
        std::mem::swap(&mut self.world, &mut cast.world);
        std::mem::swap(&mut self.actors, &mut cast.actors);
    }

    /// A world point relative to the world origin.
    pub fn local(&self, p: DVec3) -> DVec3 {
        p - self.soup.origin
    }

    /// The scene's own lights. `range_m` replaces every finite light's range; without it a light
    /// keeps the file's, or ends where it falls below a hundredth of a lux.
    pub fn lights(&self, range_m: Option<f32>) -> Vec<StageLight> {
        self.scene
            .lights
            .iter()
            .map(|light| self.light(light, range_m))
            .collect()
    }

    /// One light of the scene, or one that a caller made in the scene's terms.
    pub fn light(&self, light: &umbrage_scene::Light, range_m: Option<f32>) -> StageLight {
        let direction = light.direction.as_vec3();
        let power = light.color * light.intensity;
        let (shape, cos_inner) = match light.kind {
            LightKind::Point => (LightShape::Point, 1.0),
            LightKind::Directional => (LightShape::Directional { direction }, 1.0),
            LightKind::Spot {
                inner_rad,
                outer_rad,
            } => {
                let cos_outer = outer_rad.cos();
                (
                    LightShape::Spot {
                        direction,
                        cos_outer,
                    },
                    inner_rad.cos().max(cos_outer),
                )
            }
        };
        let auto = || (power.max_element() / DARK).sqrt().max(1e-3);
        StageLight {
            name: light.name.clone(),
            light: Light {
                position: self.local(light.position),
                range: range_m.or(light.range).unwrap_or_else(auto),
                shape,
            },
            power,
            cos_inner,
        }
    }
}

/// The triangles of a flattened scene as the library and the oracle take them.
pub fn mesh(scene: &Scene, soup: &Soup, casters: Casters) -> Mesh {
    Mesh {
        positions: soup.positions.clone(),
        residuals: soup.residuals.clone(),
        triangles: soup.triangles.clone(),
        casting: casting(scene, soup, casters),
    }
}

/// One rule a triangle of the soup.
fn casting(scene: &Scene, soup: &Soup, casters: Casters) -> Vec<Casting> {
    let rule = |&material: &u32| match casters {
        Casters::Material if scene.materials[material as usize].double_sided => Casting::Both,
        Casters::Material | Casters::Front => Casting::Front,
        Casters::Back => Casting::Back,
        Casters::Both => Casting::Both,
    };
    soup.material.iter().map(rule).collect()
}

/// The first vertices and triangles of a mesh.
fn first(mesh: &Mesh, vertices: usize, triangles: usize) -> Cow<'_, Mesh> {
    if triangles == mesh.triangles.len() && vertices == mesh.positions.len() {
        return Cow::Borrowed(mesh);
    }
    Cow::Owned(Mesh {
        positions: mesh.positions[..vertices].to_vec(),
        residuals: mesh.residuals.get(..vertices).unwrap_or_default().to_vec(),
        triangles: mesh.triangles[..triangles].to_vec(),
        casting: mesh.casting[..triangles].to_vec(),
    })
}

fn drop_blended(scene: &Scene, soup: &mut Soup) {
    let solid: Vec<bool> = soup
        .material
        .iter()
        .map(|&m| !matches!(scene.materials[m as usize].alpha, AlphaMode::Blend))
        .collect();
    fn keep<T>(list: &mut Vec<T>, solid: &[bool]) {
        if !list.is_empty() {
            let mut flags = solid.iter();
            list.retain(|_| *flags.next().unwrap_or(&true));
        }
    }
    keep(&mut soup.triangles, &solid);
    keep(&mut soup.material, &solid);
    keep(&mut soup.instance, &solid);
    keep(&mut soup.normals, &solid);
    keep(&mut soup.uvs, &solid);
}

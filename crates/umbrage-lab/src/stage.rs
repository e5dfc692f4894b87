//! A loaded scene made ready: triangles with casting rules, a world, lights, and what shading
//! needs.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use thiserror::Error;
use umbrage_core::world::{SavedWorldError, World, WorldError};
use umbrage_core::{Casting, Light, LightShape, Mesh};
use umbrage_scene::{AlphaMode, LightKind, Scene, SceneError, Soup};

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
    /// As loaded.
    pub scene: Scene,
    /// World-space triangles with shading attributes, in file order, without blended ones: these
    /// neither cast nor receive, and the lab does not draw them.
    pub soup: Soup,
    /// The same triangles as the library and the oracle take them.
    pub mesh: Mesh,
    /// Built from `mesh`.
    pub world: World,
}

/// Illuminance (lux) below which a light without a range is taken to end.
const DARK: f32 = 0.01;

impl Stage {
    /// Flattens the scene and builds its world, with positions relative to `origin` or to the
    /// soup's own.
    pub fn new(scene: Scene, casters: Casters, origin: Option<DVec3>) -> Result<Self, StageError> {
        Self::with_world_file(scene, casters, origin, 0.0, None)
    }

    /// The same with the world mapped from `world_file` where that exists, else saved there, and
    /// with positions within `weld_m` of each other welded (see [`Mesh::weld_within`]; 0 moves
    /// none).
    pub fn with_world_file(
        scene: Scene,
        casters: Casters,
        origin: Option<DVec3>,
        weld_m: f32,
        world_file: Option<&Path>,
    ) -> Result<Self, StageError> {
        let mut soup = scene.soup_at(origin)?;
        drop_blended(&scene, &mut soup);
        let mut mesh = Mesh {
            positions: soup.positions.clone(),
            triangles: soup.triangles.clone(),
            casting: casting(&scene, &soup, casters),
        };
        match mesh.weld_within(weld_m) {
            Ok(0) => {}
            Ok(_) => soup.positions.clone_from(&mesh.positions),
            Err(error) => return Err(StageError::new(&scene, None, error.into())),
        }
        let world = match open_or_build(&mesh, world_file) {
            Ok(found) => found.world,
            Err(error) => return Err(StageError::new(&scene, world_file, error)),
        };
        Ok(Self {
            scene,
            soup,
            mesh,
            world,
        })
    }

    /// A world point relative to the world origin, rounded once.
    pub fn local(&self, p: DVec3) -> Vec3 {
        (p - self.soup.origin).as_vec3()
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

/// One rule a triangle of the soup.
pub fn casting(scene: &Scene, soup: &Soup, casters: Casters) -> Vec<Casting> {
    let rule = |&material: &u32| match casters {
        Casters::Material if scene.materials[material as usize].double_sided => Casting::Both,
        Casters::Material | Casters::Front => Casting::Front,
        Casters::Back => Casting::Back,
        Casters::Both => Casting::Both,
    };
    soup.material.iter().map(rule).collect()
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

//! The scene as plain data: what every loader and generator gives, and every user takes.
//!
//! Invariant of a scene that [`load`](crate::load) or [`open`](crate::open) returned: every index
//! is in range (triangles into positions, `Mesh::materials` into `Scene::materials`, instances
//! into meshes, image references into images), every position and transform is finite, and the
//! names of lights are unique.

use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};

use crate::report::LoadReport;
use crate::rig::Rig;

/// Everything a file or a generator says about a world.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// File stem, or the generator's specification.
    pub name: String,
    /// Geometry in mesh space; a mesh may be used by no instance or by many.
    pub meshes: Vec<Mesh>,
    /// Where the meshes stand.
    pub instances: Vec<Instance>,
    /// Surface materials; never empty if there is a triangle.
    pub materials: Vec<Material>,
    /// Decoded base colour images.
    pub images: Vec<Image>,
    /// Lights in world space.
    pub lights: Vec<Light>,
    /// Perspective cameras in world space.
    pub cameras: Vec<Camera>,
    /// What moves, if anything can.
    pub rig: Option<Rig>,
    /// What was skipped or repaired on the way in.
    pub report: LoadReport,
}

/// Indexed triangles of one mesh, in mesh space (metres before the instance's transform).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Name in the file, or `mesh_N`.
    pub name: String,
    /// Vertex positions, all finite; not welded, possibly with unused ones.
    pub positions: Vec<Vec3>,
    /// Empty or one per vertex. A zero vector stands for "use the normal of the face".
    pub normals: Vec<Vec3>,
    /// Empty or one per vertex; origin in the upper left corner of the image, as in glTF.
    pub uvs: Vec<Vec2>,
    /// Three indices into `positions` a triangle; counter-clockwise seen from its front.
    pub triangles: Vec<[u32; 3]>,
    /// One index into [`Scene::materials`] a triangle.
    pub materials: Vec<u32>,
    /// Empty or one per vertex: four joints of the instance's skin. Of an instance without a skin
    /// they say nothing.
    pub joints: Vec<[u16; 4]>,
    /// As long as `joints`: how much of each joint, at least 0, together 1.
    pub weights: Vec<[f32; 4]>,
}

/// One placement of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Instance {
    /// Name of the node, or `node_N`.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: u32,
    /// Mesh space to world space where nothing plays; may mirror, may be singular, is finite.
    pub transform: DAffine3,
    /// Index into [`Rig::nodes`], if the scene has a rig.
    pub node: Option<u32>,
    /// Index into [`Rig::skins`]: joints, not `transform`, place its vertices.
    pub skin: Option<u32>,
}

/// How a surface's alpha is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Covered where alpha is at least the cutoff.
    Mask {
        /// Smallest alpha that counts as covered.
        cutoff: f32,
    },
    /// Blended over what lies behind.
    Blend,
}

/// A surface material in metallic-roughness terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file, or `material_N`.
    pub name: String,
    /// Linear red, green, blue and alpha; multiplies the image.
    pub base_color: Vec4,
    /// Index into [`Scene::images`].
    pub base_color_image: Option<u32>,
    /// Linear, may exceed 1.
    pub emissive: Vec3,
    /// How alpha is meant.
    pub alpha: AlphaMode,
    /// Whether the back of a triangle is visible, and therefore casts.
    pub double_sided: bool,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
}

impl Default for Material {
    /// White, opaque, single-sided, rough, not metallic.
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            base_color: Vec4::ONE,
            base_color_image: None,
            emissive: Vec3::ZERO,
            alpha: AlphaMode::Opaque,
            double_sided: false,
            roughness: 1.0,
            metallic: 0.0,
        }
    }
}

/// A decoded image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Name in the file, or the file's own name.
    pub name: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Four bytes a pixel, rows from the top; colour is sRGB, alpha linear and not premultiplied.
    pub rgba8: Vec<u8>,
}

/// What kind of light, and the part of its shape that only this kind has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LightKind {
    /// All directions from a point.
    #[default]
    Point,
    /// A cone from a point.
    Spot {
        /// Half angle up to which the light is full, in radians.
        inner_rad: f32,
        /// Half angle beyond which there is none, in radians; larger than `inner_rad`.
        outer_rad: f32,
    },
    /// Parallel light from infinitely far.
    Directional,
}

/// A light in absolute world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Unique in its scene: the node's name, else the light's, else `light_N`.
    pub name: String,
    /// World space, metres; without meaning for a directional light.
    pub position: DVec3,
    /// Unit vector, the way the light travels; without meaning for a point light.
    pub direction: DVec3,
    /// Linear red, green, blue, each 0 to 1.
    pub color: Vec3,
    /// Candela for point and spot lights, lux for directional ones; finite, not negative.
    pub intensity: f32,
    /// Distance in metres beyond which there is no light; `None` is unbounded.
    pub range: Option<f32>,
    /// What kind of light.
    pub kind: LightKind,
    /// Index into [`Rig::nodes`] of the node it hangs on, if the scene has a rig.
    pub node: Option<u32>,
}

impl Default for Light {
    /// A white point light of one candela at the origin, without range.
    fn default() -> Self {
        Self {
            name: String::new(),
            position: DVec3::ZERO,
            direction: DVec3::NEG_Z,
            color: Vec3::ONE,
            intensity: 1.0,
            range: None,
            kind: LightKind::Point,
            node: None,
        }
    }
}

/// A perspective camera in absolute world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name of the node, else of the camera, else `camera_N`.
    pub name: String,
    /// World space, metres.
    pub position: DVec3,
    /// Unit vector along the view.
    pub forward: DVec3,
    /// Unit vector, at right angles to `forward`.
    pub up: DVec3,
    /// Full vertical angle of view, in radians.
    pub fovy_rad: f64,
    /// Distance of the near plane in metres, if the file gives one.
    pub near: Option<f64>,
    /// Index into [`Rig::nodes`] of the node it hangs on, if the scene has a rig.
    pub node: Option<u32>,
}

impl Default for Camera {
    /// At the origin, looking along -Z, 60 degrees high.
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            position: DVec3::ZERO,
            forward: DVec3::NEG_Z,
            up: DVec3::Y,
            fovy_rad: std::f64::consts::FRAC_PI_3,
            near: None,
            node: None,
        }
    }
}

impl Camera {
    /// A camera at `eye` that looks at `target` with +Y up, `fovy_rad` high.
    pub fn look_at(name: &str, eye: DVec3, target: DVec3, fovy_rad: f64) -> Self {
        let forward = (target - eye).try_normalize().unwrap_or(DVec3::NEG_Z);
        let right = forward.cross(DVec3::Y).try_normalize();
        let right = right.unwrap_or_else(|| forward.any_orthonormal_vector());
        Self {
            name: name.to_owned(),
            position: eye,
            forward,
            up: right.cross(forward),
            fovy_rad,
            near: None,
            node: None,
        }
    }
}

impl Scene {
    /// Triangles when every instance is counted: what [`Scene::soup`] gives.
    pub fn flattened_triangles(&self) -> u64 {
        let of = |i: &Instance| {
            self.meshes
                .get(i.mesh as usize)
                .map_or(0, |m| m.triangles.len())
        };
        self.instances
            .iter()
            .map(|i| of(i) as u64)
            .fold(0, u64::saturating_add)
    }
}

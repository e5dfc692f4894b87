//! Volumes made by the vertex shader from a static buffer (Brennan 2002, "Shadow Volume Extrusion
//! using a Vertex Shader", in ShaderX).
//!
//! Every triangle has three corners of its own, and between the two triangles of an edge lies a
//! quad without area. The shader sends the corners of triangles that face away from the light to
//! infinity, so that the quads along the silhouette open up as sides, the triangles that face the
//! light are the light cap and the others the dark cap: a closed volume, counted where it is behind
//! the surface. No geometry is uploaded and no silhouette found on the CPU, but every triangle of an object is
//! drawn for every light that reaches the object.
//!
//! That is right for closed meshes, whose shadows are those of casters with two sides: a light inside
//! one leaves none of it facing, all of it goes to infinity, and all else is in shadow. An edge
//! without a partner (an opening, a third triangle, opposite winding) has no quad, and the volume
//! is torn there: such edges are counted, and the note says so. A shell that is closed around its
//! lights, as the rooms of most game maps are, faces them all over and so has no dark cap: its own
//! walls come out in shadow.
//!
//! A triangle's normal is found anew from its posed corners: the article's better variant for skinned
//! characters, and the one for what stands still. The two cheaper ones turn the normal at rest by the
//! weights of each vertex (the corners of a triangle may then disagree, and it is torn), or of the
//! face.

mod skin;

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;

use glam::Vec3;
use umbrage_core::world::{Reach, World};
use umbrage_wgpu::{CLIP_WGSL, ShadowRenderer};

use super::unseen::Unseen;
use super::{Given, Technique, TechniqueReport};
use crate::binding::{STORAGE, bind, buffer, layout};
use crate::gbuffer::DEPTH_STENCIL;
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::method::Normals;
use crate::run::{FROM_DARK, light_pass};
use crate::stage::Stage;

/// Every object's triangles and quads, drawn for every light that reaches it.
#[derive(Debug)]
pub(crate) struct Extrude {
    light: LightPass,
    caps: wgpu::RenderPipeline,
    sides: wgpu::RenderPipeline,
    clean: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    normals: Normals,
    buffers: Option<Buffers>,
    bind_group: Option<wgpu::BindGroup>,
    unseen: Unseen,
}

/// The static buffer.
#[derive(Debug)]
struct Buffers {
    corners: wgpu::Buffer,
    skin: wgpu::Buffer,
    meshes: Vec<ClosedMesh>,
    edges: usize,
    unpaired: usize,
    /// What triangles it knows.
    built: Vec<u64>,
}

/// Triangles that cast together: an instance of the scene, or an object.
#[derive(Clone, Debug)]
struct ClosedMesh {
    /// Its triangles among the corners.
    caps: Range<u32>,
    /// The quads between them.
    sides: Range<u32>,
    triangles: Triangles,
}

#[derive(Clone, Debug)]
enum Triangles {
    /// They never move: lower and upper corner of their box.
    Fixed([Vec3; 2]),
    /// Those of the object in this slot.
    Object(usize),
}

impl Extrude {
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        draw: LightDraw,
        normals: Normals,
    ) -> Self {
        let device = &gpu.device;
        let uniform = buffer(wgpu::BufferBindingType::Uniform);
        let storage = buffer(STORAGE);
        let types = [uniform, storage, storage, storage];
        let layout = layout(gpu, "extrude", wgpu::ShaderStages::VERTEX, types);
        let constants = [(
            "normals",
            match normals {
                Normals::Neighbours => 0.0,
                Normals::FaceWeights => 1.0,
                Normals::VertexWeights => 2.0,
            },
        )];
        let source = format!(
            "{CLIP_WGSL}\n{}\n{}",
            shadows.world_wgsl(1),
            include_str!("../shaders/extrude.wgsl")
        );
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("extrude"),
            source: wgpu::ShaderSource::Wgsl(Cow::Owned(source)),
        });
        let pipeline = |label, entry, stencil| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(
                    &device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                        label: Some(label),
                        bind_group_layouts: &[
                            Some(&layout),
                            Some(shadows.world_bind_group_layout()),
                        ],
                        immediate_size: 0,
                    }),
                ),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &constants,
                        ..wgpu::PipelineCompilationOptions::default()
                    },
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState {
                    unclipped_depth: gpu.depth_clamp,
                    ..wgpu::PrimitiveState::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH_STENCIL,
                    depth_write_enabled: Some(false),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil,
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("nothing"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: draw.format(),
                        blend: None,
                        write_mask: wgpu::ColorWrites::empty(),
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        use wgpu::StencilOperation::{DecrementWrap, IncrementWrap, Keep, Zero};
        let stencil = |[front_fail, back_fail]: [wgpu::StencilOperation; 2], pass| {
            let face = |depth_fail_op| wgpu::StencilFaceState {
                compare: wgpu::CompareFunction::Always,
                fail_op: Keep,
                depth_fail_op,
                pass_op: pass,
            };
            wgpu::StencilState {
                front: face(front_fail),
                back: face(back_fail),
                read_mask: 0xff,
                write_mask: 0xff,
            }
        };
        let behind = stencil([DecrementWrap, IncrementWrap], Keep);
        Self {
            light: LightPass::new(gpu, shadows, draw, LitBy::Stencil),
            caps: pipeline("extrude caps", "cap", behind.clone()),
            sides: pipeline("extrude sides", "side", behind),
            clean: pipeline("clean", "everywhere", stencil([Zero, Zero], Zero)),
            layout,
            normals,
            buffers: None,
            bind_group: None,
            unseen: Unseen::default(),
        }
    }
}

impl Technique for Extrude {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.light.prepare(given);
        self.unseen.update(given)?;
        let world = &given.stage.world;
        let built = world.topology();
        if self.buffers.as_ref().is_none_or(|b| b.built != built) {
            self.buffers = Some(Buffers::new(given.gpu, given.stage, built, self.normals)?);
        }
        let Some(Buffers { skin: at_rest, .. }) = &self.buffers else {
            return Ok(());
        };
        let mut lights: Vec<[[f32; 4]; 2]> = given
            .lights
            .iter()
            .map(|l| l.light.homogeneous_f32())
            .collect();
        lights.resize(lights.len().max(1), [[0.0; 4]; 2]);
        let lights = given
            .gpu
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("light positions"),
                contents: bytemuck::cast_slice(&lights),
                usage: wgpu::BufferUsages::STORAGE,
            });
        let joints = given
            .gpu
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("joints"),
                contents: bytemuck::cast_slice(&skin::matrices(given.stage)),
                usage: wgpu::BufferUsages::STORAGE,
            });
        let first = given
            .gpu
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("first skinned corner"),
                contents: bytemuck::bytes_of(&[skin::first_corner(world); 4]),
                usage: wgpu::BufferUsages::UNIFORM,
            });
        let buffers = [&first, &lights, at_rest, &joints];
        let resources = buffers.map(wgpu::Buffer::as_entire_binding);
        self.bind_group = Some(bind(given.gpu, "extrude", &self.layout, resources));
        Ok(())
    }

    fn record(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
    ) -> Result<(), GpuError> {
        let Some(buffers) = &self.buffers else {
            return Ok(());
        };
        if lights.start == 0 {
            self.unseen.record(given, encoder);
        }
        let mut pass = light_pass(encoder, given.targets, target, FROM_DARK);
        pass.set_index_buffer(buffers.corners.slice(..), wgpu::IndexFormat::Uint32);
        given
            .shadows
            .record(&mut pass, given.plan, lights, |pass, number, _| {
                let instance = number as u32..number as u32 + 1;
                if self.unseen.has(number) {
                    return;
                }
                let world = &given.stage.world;
                let reach = Reach::new(&given.lights[number].light);
                pass.set_bind_group(0, self.bind_group.as_ref(), &[]);
                pass.set_bind_group(1, given.shadows.world_bind_group(), &[]);
                for (pipeline, corners) in [
                    (
                        &self.caps,
                        (|mesh| &mesh.caps) as fn(&ClosedMesh) -> &Range<u32>,
                    ),
                    (&self.sides, |mesh| &mesh.sides),
                ] {
                    pass.set_pipeline(pipeline);
                    let reached = |mesh: &&ClosedMesh| reach.touches_box(mesh.bounds(world));
                    for mesh in buffers.meshes.iter().filter(reached) {
                        pass.draw_indexed(corners(mesh).clone(), 0, instance.clone());
                    }
                }
                self.light.draw(pass, given.shadows, number, None);
                pass.set_pipeline(&self.clean);
                pass.set_bind_group(0, self.bind_group.as_ref(), &[]);
                pass.set_bind_group(1, given.shadows.world_bind_group(), &[]);
                pass.draw(0..3, 0..1);
            });
        Ok(())
    }

    fn report(&self) -> TechniqueReport {
        let Some(buffers) = &self.buffers else {
            return TechniqueReport::default();
        };
        let (edges, unpaired) = (buffers.edges, buffers.unpaired);
        TechniqueReport {
            gpu_bytes: buffers.corners.size() + buffers.skin.size(),
            note: match unpaired {
                0 => String::new(),
                _ => format!("not closed: {unpaired} of {edges} edges have no partner"),
            },
        }
    }
}

impl ClosedMesh {
    fn bounds(&self, world: &World) -> [Vec3; 2] {
        match self.triangles {
            Triangles::Fixed(bounds) => bounds,
            Triangles::Object(slot) => world.objects[slot].bounds,
        }
    }
}

impl Buffers {
    fn new(gpu: &Gpu, stage: &Stage, built: Vec<u64>, normals: Normals) -> Result<Self, GpuError> {
        let world = &stage.world;
        let mut meshes = Vec::new();
        let mut corners = Vec::new();
        let (mut edges, mut unpaired) = (0, 0);
        let mut add = |of: &[u32], triangles: Triangles| {
            let first = corners.len() as u32;
            corners.extend(of.iter().flat_map(|t| [3 * t, 3 * t + 1, 3 * t + 2]));
            let between = corners.len() as u32;
            let paired = close(world, of, &mut corners);
            edges += paired.edges;
            unpaired += paired.unpaired;
            meshes.push(ClosedMesh {
                caps: first..between,
                sides: between..corners.len() as u32,
                triangles,
            });
        };
        let mut instances: Vec<Vec<u32>> = Vec::new();
        for t in world.fixed.triangles.clone() {
            let instance = stage.soup.instance[world.source[t as usize] as usize] as usize;
            instances.resize(instances.len().max(instance + 1), Vec::new());
            instances[instance].push(t);
        }
        for of in instances.iter().filter(|of| !of.is_empty()) {
            let points = of
                .iter()
                .flat_map(|&t| world.corners(t).map(glam::DVec3::as_vec3));
            let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
            let bounds = points.fold(empty, |[min, max], p| [min.min(p), max.max(p)]);
            add(of, Triangles::Fixed(bounds));
        }
        for (slot, object) in world.objects.iter().enumerate() {
            let of: Vec<u32> = object.extent.triangles.clone().collect();
            add(&of, Triangles::Object(slot));
        }
        corners.resize(corners.len().max(3), 0);
        let skin = skin::corners(stage, normals);
        gpu.check_buffer(
            "corners of extruded triangles",
            size_of_val(&corners[..]) as u64,
        )?;
        gpu.check_storage("skinned normals", size_of_val(&skin[..]))?;
        Ok(Self {
            corners: gpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("extrude corners"),
                contents: bytemuck::cast_slice(&corners),
                usage: wgpu::BufferUsages::INDEX,
            }),
            skin: gpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("skinned normals"),
                contents: bytemuck::cast_slice(&skin),
                usage: wgpu::BufferUsages::STORAGE,
            }),
            meshes,
            edges,
            unpaired,
            built,
        })
    }
}

/// Edges of a mesh, and those that no second triangle runs along the other way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Pairing {
    edges: usize,
    unpaired: usize,
}

/// Appends the quads between the triangles numbered `of`, as corners: three times a triangle's
/// number plus 0, 1 or 2 (the article's pseudo code, with a checklist that knows directions).
fn close(world: &World, of: &[u32], corners: &mut Vec<u32>) -> Pairing {
    // Start and end vertex, and the first of the side's two corners, in its triangle.
    let mut checklist: HashMap<[u32; 2], Vec<[u32; 2]>> = HashMap::new();
    let mut edges = 0;
    for &t in of {
        let vertices = world.triangles[t as usize];
        for side in 0..3 {
            let next = (side + 1) % 3;
            let [a, b] = [vertices[side], vertices[next]];
            if a == b {
                continue;
            }
            let [from, to] = [side, next].map(|corner| 3 * t + corner as u32);
            match checklist.get_mut(&[b, a]).and_then(Vec::pop) {
                // The partner's side runs from b to a: its corners are at b, then at a.
                Some([at_b, at_a]) => {
                    corners.extend([from, at_a, to, to, at_a, at_b]);
                }
                None => {
                    edges += 1;
                    checklist.entry([a, b]).or_default().push([from, to]);
                }
            }
        }
    }
    Pairing {
        edges,
        unpaired: checklist.values().map(Vec::len).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage_core::{Casting, Mesh};

    fn world(triangles: &[[u32; 3]]) -> World {
        let positions = [
            [0., 0., 0.],
            [1., 0., 0.],
            [0., 1., 0.],
            [0., 0., 1.],
            [0., -1., 0.],
        ];
        World::build(&Mesh {
            positions: positions.map(Vec3::from).to_vec(),
            triangles: triangles.to_vec(),
            casting: vec![Casting::Front; triangles.len()],
            ..Mesh::default()
        })
        .unwrap()
    }

    fn pairing(triangles: &[[u32; 3]]) -> (Pairing, usize) {
        let world = world(triangles);
        let mut corners = Vec::new();
        let all: Vec<u32> = (0..triangles.len() as u32).collect();
        let found = close(&world, &all, &mut corners);
        (found, corners.len() / 6)
    }

    #[test]
    fn a_closed_mesh_has_a_quad_an_edge() {
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let closed = Pairing {
            edges: 6,
            unpaired: 0,
        };
        assert_eq!(pairing(&tetrahedron), (closed, 6));
    }

    #[test]
    fn openings_third_triangles_and_opposite_winding_have_no_partner() {
        let open = [[0, 2, 1], [0, 1, 3], [0, 3, 2]];
        assert_eq!(
            pairing(&open),
            (
                Pairing {
                    edges: 6,
                    unpaired: 3
                },
                3
            )
        );
        let flipped = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 3, 2]];
        assert_eq!(pairing(&flipped).0.unpaired, 6);
        let fin = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 1, 4]];
        assert_eq!(pairing(&fin).0.unpaired, 3);
    }
}

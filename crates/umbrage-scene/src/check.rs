//! That a scene keeps its invariant, whoever made it.
//!
//! Takes a scene; gives the mesh of each instance, or the item at fault. Loaders give whole scenes;
//! what a host built by hand is checked here before anything is indexed.

use crate::rig::Rig;
use crate::{Instance, MAX_TRIANGLES, Mesh, Scene, SceneError};

impl Scene {
    /// The mesh of each instance, once every index is known to be in range.
    pub(crate) fn check_used(&self) -> Result<Vec<(&Instance, &Mesh)>, SceneError> {
        let triangles = self.flattened_triangles();
        if triangles > MAX_TRIANGLES {
            let (scene, limit) = (self.name.clone(), MAX_TRIANGLES);
            return Err(SceneError::TooManyTriangles {
                scene,
                triangles,
                limit,
            });
        }
        self.check_meshes()?;
        if let Some(Err(what)) = self.rig.as_ref().map(Rig::check) {
            return Err(self.invalid("rig".to_owned(), what));
        }
        let mut vertices = 0u64;
        let mut used = Vec::with_capacity(self.instances.len());
        for (i, instance) in self.instances.iter().enumerate() {
            let Some(mesh) = self.meshes.get(instance.mesh as usize) else {
                let what = format!("mesh {} of {}", instance.mesh, self.meshes.len());
                return Err(self.invalid(self.instance_item(i), what));
            };
            self.check_bound(instance, mesh)
                .map_err(|what| self.invalid(self.instance_item(i), what))?;
            vertices += mesh.positions.len() as u64;
            used.push((instance, mesh));
        }
        if vertices > u64::from(u32::MAX) {
            let what = format!("{vertices} vertices do not fit 32-bit indices");
            return Err(self.invalid("flattened scene".to_owned(), what));
        }
        Ok(used)
    }

    /// That every mesh keeps the invariant of [`Scene`].
    pub(crate) fn check_meshes(&self) -> Result<(), SceneError> {
        for (m, mesh) in self.meshes.iter().enumerate() {
            self.check_mesh(mesh)
                .map_err(|what| self.invalid(format!("mesh {m} ({})", mesh.name), what))?;
        }
        Ok(())
    }

    /// What is wrong with an instance's place in the rig, if anything.
    fn check_bound(&self, instance: &Instance, mesh: &Mesh) -> Result<(), String> {
        let Some(rig) = &self.rig else {
            return Ok(());
        };
        let nodes = rig.nodes.len();
        if instance.node.is_some_and(|n| n as usize >= nodes) {
            return Err(format!("it names a node beyond {nodes}"));
        }
        let Some(skin) = instance.skin else {
            return Ok(());
        };
        let Some(skin) = rig.skins.get(skin as usize) else {
            return Err(format!("it names a skin beyond {}", rig.skins.len()));
        };
        let joints = skin.joints.len();
        let beyond = mesh
            .joints
            .iter()
            .flatten()
            .any(|&j| usize::from(j) >= joints);
        if beyond && mesh.is_bound() {
            return Err(format!("its mesh names a joint beyond {joints}"));
        }
        Ok(())
    }

    /// What is wrong with a mesh, if anything.
    fn check_mesh(&self, mesh: &Mesh) -> Result<(), String> {
        let vertices = mesh.positions.len();
        for (what, len) in [
            ("normals", mesh.normals.len()),
            ("uvs", mesh.uvs.len()),
            ("joints", mesh.joints.len()),
            ("weights", mesh.weights.len()),
        ] {
            if len != 0 && len != vertices {
                return Err(format!("{len} {what} for {vertices} vertices"));
            }
        }
        if mesh.materials.len() != mesh.triangles.len() {
            let (m, t) = (mesh.materials.len(), mesh.triangles.len());
            return Err(format!("{m} materials for {t} triangles"));
        }
        let beyond = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= vertices);
        if let Some(t) = mesh.triangles.iter().position(beyond) {
            return Err(format!("triangle {t} names a vertex beyond {vertices}"));
        }
        let count = self.materials.len();
        if let Some(t) = mesh.materials.iter().position(|&m| m as usize >= count) {
            return Err(format!("triangle {t} names a material beyond {count}"));
        }
        Ok(())
    }

    pub(crate) fn instance_item(&self, index: usize) -> String {
        format!("instance {index} ({})", self.instances[index].name)
    }

    pub(crate) fn invalid(&self, item: String, what: String) -> SceneError {
        SceneError::Invalid {
            scene: self.name.clone(),
            item,
            what,
        }
    }
}

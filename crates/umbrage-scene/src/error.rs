//! The one error of this crate: what cannot be loaded, where it is, and what to do.

use std::path::PathBuf;

/// Why there is no scene. Every message names the file, the item at fault and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The operating system refused to read or write.
    #[error("{}: {source}; check that it is there, may be accessed, and has room", path.display())]
    Io {
        /// File that was read or written.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A path that is no regular file.
    #[error("{}: not a regular file; give the path of a file", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// No loader for this file name extension.
    #[error("{}: unknown scene format; supported are .glb, .gltf and .obj, or a generated world as gen:NAME", path.display())]
    UnknownFormat {
        /// The path.
        path: PathBuf,
    },
    /// The binary container is broken.
    #[error("{}: broken GLB container: {what}; export the file again", path.display())]
    Container {
        /// The .glb file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The JSON text is broken or not glTF.
    #[error("{}: not glTF JSON: {source}; export the file again", path.display())]
    Json {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Line, column and reason.
        source: serde_json::Error,
    },
    /// A glTF version other than 2.
    #[error("{}: glTF version {version:?} is not supported; convert the file to glTF 2.0", path.display())]
    Version {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// What it says.
        version: String,
    },
    /// The file needs an extension that changes its geometry and is not supported.
    #[error("{}: requires the extension {extension}, which is not supported; export without it", path.display())]
    UnsupportedExtension {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Name of the extension.
        extension: String,
    },
    /// An item refers to another that does not exist.
    #[error("{}: {from} refers to {kind} {index}, but there are {len}; export the file again", path.display())]
    Dangling {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Item that refers, with index and name.
        from: String,
        /// Kind of the item that is missing.
        kind: &'static str,
        /// Index that is out of range.
        index: u64,
        /// How many there are.
        len: u64,
    },
    /// A buffer is missing, truncated or not readable.
    #[error("{}: buffer {buffer}: {what}; put the complete file beside the scene or export again", path.display())]
    Buffer {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Index of the buffer.
        buffer: usize,
        /// What is wrong with it.
        what: String,
    },
    /// An accessor does not fit its data.
    #[error("{}: accessor {accessor} ({name}): {what}; export the file again", path.display())]
    Accessor {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Index of the accessor.
        accessor: usize,
        /// Its name.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// A primitive cannot be read.
    #[error("{}: mesh {mesh} ({name}), primitive {primitive}: {what}; export the mesh again", path.display())]
    Primitive {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Index of the mesh.
        mesh: usize,
        /// Its name.
        name: String,
        /// Index of the primitive in the mesh.
        primitive: usize,
        /// What is wrong with it.
        what: String,
    },
    /// A vertex is infinite or not a number.
    #[error("{}: mesh {mesh} ({name}), primitive {primitive}, vertex {vertex}: position is not finite; repair the mesh", path.display())]
    NonFiniteVertex {
        /// The scene file.
        path: PathBuf,
        /// Index of the mesh.
        mesh: usize,
        /// Its name.
        name: String,
        /// Index of the primitive in the mesh, 0 for OBJ.
        primitive: usize,
        /// Index of the vertex in the primitive.
        vertex: usize,
    },
    /// A node is its own ancestor or has two parents.
    #[error("{}: node {node} ({name}) is reached twice; nodes must form a tree, so give each node one parent", path.display())]
    NodeTwice {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Index of the node.
        node: usize,
        /// Its name.
        name: String,
    },
    /// A node's transform is infinite or not a number.
    #[error("{}: node {node} ({name}): its transform is not finite; repair the node", path.display())]
    NodeTransform {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Index of the node.
        node: usize,
        /// Its name.
        name: String,
    },
    /// A skin cannot be read.
    #[error("{}: skin {skin} ({name}): {what}; export the skin again", path.display())]
    Skin {
        /// The .glb or .gltf file.
        path: PathBuf,
        /// Index of the skin.
        skin: usize,
        /// Its name.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// A statement of an OBJ file cannot be understood.
    #[error("{}:{line}: {what}; repair the line or export the file again", path.display())]
    Obj {
        /// The .obj file.
        path: PathBuf,
        /// Line number, from 1.
        line: u64,
        /// What is wrong with it.
        what: String,
    },
    /// The file is binary or UTF-16 where text is expected.
    #[error("{}: not a text file in UTF-8 or ASCII; save it as UTF-8", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
    },
    /// A light file cannot be understood, or a light in it has a value out of bounds.
    #[error("{}: {item}: {what}; correct the light file", path.display())]
    LightFile {
        /// The .json file.
        path: PathBuf,
        /// Light at fault, with number and name.
        item: String,
        /// What is wrong with it.
        what: String,
    },
    /// The file names far more data than it holds.
    #[error("{}: {item} would need {bytes} bytes, beyond the limit of {limit} for a file of this size; remove repeated geometry or split the file", path.display())]
    TooLarge {
        /// The scene file.
        path: PathBuf,
        /// Item at fault.
        item: String,
        /// Bytes asked for so far, this item included.
        bytes: u64,
        /// Most that is allowed for the file.
        limit: u64,
    },
    /// Flattening gives more triangles than the stated maximum.
    #[error(
        "{scene}: {triangles} triangles when instances are flattened, beyond the limit of {limit}; use fewer instances or split the scene"
    )]
    TooManyTriangles {
        /// Name of the scene.
        scene: String,
        /// Triangles with every instance counted.
        triangles: u64,
        /// Most that is allowed.
        limit: u64,
    },
    /// Memory for the flattened scene could not be had.
    #[error(
        "{scene}: no memory for {bytes} bytes; use fewer instances or a machine with more memory"
    )]
    OutOfMemory {
        /// Name of the scene.
        scene: String,
        /// Size of the allocation that failed.
        bytes: u64,
    },
    /// A scene built by hand breaks the invariant of [`Scene`](crate::Scene).
    #[error("{scene}: {item}: {what}; repair the scene before use")]
    Invalid {
        /// Name of the scene.
        scene: String,
        /// Item at fault, with index and name.
        item: String,
        /// What is wrong with it.
        what: String,
    },
    /// No generator of this name.
    #[error("gen:{name}: unknown generator; known are {known}")]
    UnknownGenerator {
        /// Name that was asked for.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// A generator got a key or value that it does not take.
    #[error("gen:{generator}: {what}; it takes {known}")]
    GeneratorKey {
        /// Name of the generator.
        generator: String,
        /// What is wrong.
        what: String,
        /// Keys that it takes, with their bounds and defaults.
        known: String,
    },
}

impl SceneError {
    /// An [`SceneError::Io`] for `path`.
    pub(crate) fn io(path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }
}

//! Stylised hair in a scene: closed surfaces with a colour per lock.

use std::sync::Arc;

use glam::Vec2;

use super::TuftMaterial;
use crate::geometry::Mesh;
use crate::tuft::{Island, TuftMesh, Tufts};

crate::choices! {
    /// What a surface of stylised hair is.
    pub enum LockKind {
        /// Locks along strokes.
        Tufts = "tufts",
        /// Hair that lies on the scalp.
        Cap = "cap",
        /// A ball of hair.
        Bun = "bun",
        /// A band around a lock.
        Ring = "ring",
        /// Hair from a file.
        Mesh = "mesh",
    }
}

/// One part of stylised hair: many tufts in one mesh, or one cap, bun or ring.
#[derive(Clone, Debug)]
pub struct Locks {
    /// What it is.
    pub kind: LockKind,
    /// The tufts that the mesh is made of; none for caps, buns and rings.
    pub tufts: Arc<Tufts>,
    /// The surface; caps, buns and rings count as one lock.
    pub mesh: Arc<TuftMesh>,
    /// Looks; a tuft's colour is an index into it, everything else has the first one.
    pub palette: Vec<TuftMaterial>,
}

impl Locks {
    /// Tufts, with their mesh made.
    pub fn tufts(tufts: Arc<Tufts>, palette: Vec<TuftMaterial>) -> Self {
        let mesh = Arc::new(tufts.mesh());
        Self { kind: LockKind::Tufts, tufts, mesh, palette }
    }

    /// One surface that is not a tuft.
    pub fn piece(kind: LockKind, mesh: Mesh, material: TuftMaterial) -> Self {
        let (vertices, triangles) = (mesh.positions.len() as u32, mesh.triangles.len() as u32);
        let mesh = TuftMesh {
            tuft: vec![0; mesh.positions.len()],
            vertices: std::iter::once(0..vertices).collect(),
            triangles: std::iter::once(0..triangles).collect(),
            islands: vec![Island::WHOLE],
            mesh,
        };
        Self { kind, tufts: Arc::default(), mesh: Arc::new(mesh), palette: vec![material] }
    }

    /// The same locks with another surface of the same topology.
    #[must_use]
    pub fn with_surface(&self, mesh: Mesh) -> Self {
        Self { mesh: Arc::new(TuftMesh { mesh, ..(*self.mesh).clone() }), ..self.clone() }
    }

    /// How many locks there are.
    pub fn count(&self) -> usize {
        self.mesh.vertices.len()
    }

    /// The look of a lock.
    pub fn look(&self, lock: usize) -> &TuftMaterial {
        static DEFAULT: std::sync::LazyLock<TuftMaterial> = std::sync::LazyLock::new(TuftMaterial::default);
        let index = self.tufts.tufts.get(lock).map_or(0, |t| t.colour as usize);
        self.palette.get(index).or(self.palette.first()).unwrap_or(&DEFAULT)
    }

    /// Place of a vertex on its lock: x around, y along from root (0) to tip (1). On a cap y runs from crown to border.
    pub fn place(&self, vertex: usize) -> Vec2 {
        let mesh = &self.mesh;
        let (Some(uv), Some(&lock)) = (mesh.mesh.uvs.get(vertex), mesh.tuft.get(vertex)) else { return Vec2::ZERO };
        let island = mesh.islands[lock as usize];
        let within = (*uv - island.min) / (island.max - island.min).max(Vec2::splat(1e-9));
        match self.kind {
            LockKind::Cap => {
                let off = within - Vec2::splat(0.5);
                Vec2::new(crate::math::trig::atan2(off.y, off.x) / std::f32::consts::TAU + 0.5, 2.0 * off.length())
            }
            LockKind::Tufts | LockKind::Bun | LockKind::Ring | LockKind::Mesh => within,
        }
    }
}

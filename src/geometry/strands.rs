//! Strands: many polylines in one buffer.

use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};
use rayon::prelude::*;

use super::Bounds;
use crate::math::Digest;

/// Where a strand leaves the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Identity: a hash of where the root lies, stable when the density changes; unique within a set of strands.
    pub id: u64,
    /// Position on the surface, cm.
    pub position: Vec3,
    /// Unit normal of the surface there.
    pub normal: Vec3,
    /// Texture coordinate of the surface there; zero when it has none.
    pub uv: Vec2,
    /// Triangle of the head mesh.
    pub triangle: u32,
}

impl Root {
    /// Everything about it, for a key.
    pub fn bytes(&self) -> [u8; 44] {
        let mut out = [0; 44];
        out[..8].copy_from_slice(&self.id.to_le_bytes());
        out[8..12].copy_from_slice(&self.triangle.to_le_bytes());
        let (p, n) = (self.position, self.normal);
        for (to, f) in out[12..].chunks_exact_mut(4).zip([p.x, p.y, p.z, n.x, n.y, n.z, self.uv.x, self.uv.y]) {
            to.copy_from_slice(&f.to_le_bytes());
        }
        out
    }
}

/// Many strands, as a structure of arrays.
///
/// Strand `i` has the nodes `points[offsets[i]..offsets[i + 1]]`, root first, at least two. All per-strand vectors
/// have one entry per strand, all per-node vectors one per point or none at all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strands {
    /// All nodes, strand after strand, cm.
    pub points: Vec<Vec3>,
    /// Where each strand begins in `points`, and at the end `points.len()`: one more than there are strands.
    pub offsets: Vec<u32>,
    /// Per strand: its root.
    pub roots: Vec<Root>,
    /// Per strand: index of the guide that it follows most (for a guide its own index).
    pub guide: Vec<u32>,
    /// Per strand: index into `sources`.
    pub source: Vec<u16>,
    /// Places in the script (`ponytail.lua:24`) that made strands.
    pub sources: Vec<Arc<str>>,
    /// Per node: number of the stage that bent it last, 0 for none; empty where unknown.
    pub stage: Vec<u8>,
}

/// What [`Strands::validate`] found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StrandsError {
    /// A vector has the wrong number of entries.
    #[error("{count} {what} where {expected} are needed")]
    Count {
        /// Which vector.
        what: &'static str,
        /// Its length.
        count: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A strand has fewer than two nodes, or its offsets run backwards.
    #[error("strand {strand} has no segment")]
    TooShort {
        /// Index of the strand.
        strand: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("strand {strand} has a node that is not finite: `{point}`")]
    NotFinite {
        /// Index of the strand.
        strand: usize,
        /// The node.
        point: Vec3,
    },
    /// Two strands share an identity.
    #[error("two strands have the id {id:#018x}")]
    RepeatedId {
        /// The id.
        id: u64,
    },
}

impl Strands {
    /// No strands; ready for [`Strands::push`].
    pub fn new() -> Self {
        Self { offsets: vec![0], ..Self::default() }
    }

    /// The strands moved as a whole: turned, shifted, evenly scaled; their roots with them.
    #[must_use]
    pub fn transformed(&self, by: &Affine3A) -> Self {
        let mut strands = self.clone();
        strands.points.par_iter_mut().for_each(|p| *p = by.transform_point3(*p));
        for root in &mut strands.roots {
            root.position = by.transform_point3(root.position);
            root.normal = by.transform_vector3(root.normal).normalize_or_zero();
        }
        strands
    }

    /// How many strands there are.
    pub fn count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// The nodes of strand `i`, root first.
    pub fn strand(&self, i: usize) -> &[Vec3] {
        &self.points[self.range(i)]
    }

    /// Where the nodes of strand `i` lie in `points`.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.offsets[i] as usize..self.offsets[i + 1] as usize
    }

    /// All strands, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[Vec3]> {
        (0..self.count()).map(|i| self.strand(i))
    }

    /// Appends a strand that is its own guide; `source` is an index into `sources`.
    pub fn push(&mut self, root: Root, source: u16, nodes: impl IntoIterator<Item = Vec3>) {
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        self.points.extend(nodes);
        self.offsets.push(self.points.len() as u32);
        self.guide.push(self.roots.len() as u32);
        self.roots.push(root);
        self.source.push(source);
    }

    /// Feeds the geometry to a key: everything but where in a script it was made.
    pub fn digest(&self, into: &mut Digest) {
        // In pieces of a fixed size, each with a key of its own: the same on any number of threads.
        let pieces: Vec<u128> = (self.points.par_chunks(1 << 17))
            .map(|piece| {
                let mut digest = Digest::new("nodes");
                digest.vectors(piece);
                digest.finish()
            })
            .collect();
        into.number(self.points.len() as u64).packed(&pieces, |k| k.to_le_bytes());
        into.numbers(&self.offsets).packed(&self.roots, Root::bytes).numbers(&self.guide);
        into.packed(&self.source, |s| s.to_le_bytes()).bytes(&self.stage);
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.points)
            + size_of_val(&*self.offsets)
            + size_of_val(&*self.roots)
            + size_of_val(&*self.guide)
            + size_of_val(&*self.source)
            + self.stage.len()
    }

    /// Arc length of strand `i`, cm.
    pub fn length(&self, i: usize) -> f32 {
        self.strand(i).windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    /// Bounds of all nodes.
    pub fn bounds(&self) -> Bounds {
        let pieces = self.points.par_chunks(1 << 15).map(|piece| Bounds::of(piece.iter().copied()));
        // Least and greatest are the same in any order.
        pieces.reduce(|| Bounds::EMPTY, Bounds::union)
    }

    /// Checks everything that the rest of Coif relies on.
    ///
    /// # Errors
    /// The first [`StrandsError`] found.
    pub fn validate(&self) -> Result<(), StrandsError> {
        let (n, nodes) = (self.count(), self.points.len());
        let counts = [
            ("roots", self.roots.len(), n),
            ("guide indices", self.guide.len(), n),
            ("source indices", self.source.len(), n),
            ("stages", self.stage.len(), if self.stage.is_empty() { 0 } else { nodes }),
            ("points", nodes, self.offsets.last().map_or(0, |&o| o as usize)),
        ];
        for (what, count, expected) in counts {
            if count != expected {
                return Err(StrandsError::Count { what, count, expected });
            }
        }
        for i in 0..n {
            if self.offsets[i + 1] < self.offsets[i] + 2 {
                return Err(StrandsError::TooShort { strand: i });
            }
            if let Some(&point) = self.strand(i).iter().find(|p| !p.is_finite()) {
                return Err(StrandsError::NotFinite { strand: i, point });
            }
        }
        let mut ids: Vec<u64> = self.roots.iter().map(|r| r.id).collect();
        ids.sort_unstable();
        if let Some(w) = ids.windows(2).find(|w| w[0] == w[1]) {
            return Err(StrandsError::RepeatedId { id: w[0] });
        }
        Ok(())
    }
}

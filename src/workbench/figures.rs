//! The figures of a scene.

use rayon::prelude::*;
use serde::Serialize;

use crate::geometry::Solid;
use crate::groom;
use crate::scene::{Body, Scene};

/// What a part consists of.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PartFigures {
    /// Name of the part.
    pub part: String,
    /// Strands of hair.
    pub strands: usize,
    /// Guides that they follow.
    pub guides: usize,
    /// Points: nodes of strands, or corners of a surface.
    pub points: usize,
    /// Locks of stylised hair.
    #[serde(skip_serializing_if = "is_zero")]
    pub tufts: usize,
    /// Triangles of a surface.
    pub triangles: usize,
    /// Mean length of a strand, cm.
    pub mean_length: f32,
    /// Length of the longest strand, cm.
    pub longest: f32,
    /// Strands with a node or a segment inside the head.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inside: Option<usize>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
fn is_zero(n: &usize) -> bool {
    *n == 0
}

/// Figures of every part, in the scene's order.
pub fn figures(scene: &Scene) -> Vec<PartFigures> {
    scene
        .parts
        .iter()
        .map(|part| match &part.body {
            Body::Mesh(mesh, _) => PartFigures {
                part: part.name.clone(),
                points: mesh.positions.len(),
                triangles: mesh.triangles.len(),
                ..PartFigures::default()
            },
            Body::Locks(locks) => {
                let mesh = &locks.mesh.mesh;
                let lengths: Vec<f32> = locks.tufts.tufts.iter().map(crate::tuft::Tuft::length).collect();
                PartFigures {
                    part: part.name.clone(),
                    tufts: lengths.len(),
                    points: mesh.positions.len(),
                    triangles: mesh.triangles.len(),
                    mean_length: lengths.iter().sum::<f32>() / lengths.len().max(1) as f32,
                    longest: lengths.iter().copied().fold(0.0, f32::max),
                    ..PartFigures::default()
                }
            }
            Body::Hair(hair) => {
                let strands = &hair.strands;
                let count = strands.count();
                let lengths: Vec<f32> = (0..count).into_par_iter().map(|i| strands.length(i)).collect();
                let sum: f64 = lengths.iter().copied().map(f64::from).sum();
                let longest = lengths.into_iter().fold(0.0, f32::max);
                PartFigures {
                    part: part.name.clone(),
                    strands: count,
                    guides: hair.guides.count(),
                    points: strands.points.len(),
                    mean_length: if count > 0 { (sum / count as f64) as f32 } else { 0.0 },
                    longest,
                    ..PartFigures::default()
                }
            }
        })
        .collect()
}

/// Fills in how many strands are inside the scene's surfaces.
pub fn count_inside(scene: &Scene, figures: &mut [PartFigures]) {
    let solids: Vec<Solid> = scene
        .parts
        .iter()
        .filter_map(|part| match &part.body {
            Body::Mesh(mesh, _) => Solid::new(mesh).ok(),
            Body::Hair(_) | Body::Locks(_) => None,
        })
        .collect();
    for (part, figures) in scene.parts.iter().zip(figures) {
        if let Body::Hair(hair) = &part.body {
            figures.inside = Some(solids.iter().map(|solid| groom::count_inside(&hair.strands, solid)).sum());
        }
    }
}

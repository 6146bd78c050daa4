//! The scene: everything that pictures and files are made from, plain and complete.
//!
//! A script ends by returning a scene. Renderers and exporters see only this: no script, no defaults left to fill in.

mod carry;
mod locks;
mod look;
mod motion;
mod overlay;

use std::sync::Arc;

use glam::Affine3A;

use crate::geometry::{Bounds, Mesh, Strands};

pub use locks::{LockKind, Locks};
pub use look::{Background, HairMaterial, Look, MeshMaterial, Shading, TuftMaterial, View};
pub use motion::{Motion, Shown, Timeline};
pub use overlay::{Arrow, Line, Marker, Note, Overlay, WireBox, WireSphere};

/// A finished hairstyle.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the style: the script's file name without its ending.
    pub name: String,
    /// What is in it, in the script's order.
    pub parts: Vec<Part>,
    /// The views of the preview sheet, in order, at least one.
    pub views: Vec<View>,
    /// Background and debug view.
    pub look: Look,
    /// From head space (cm) to the space of the head's own file (cm); identity for the built-in mannequin.
    pub placement: Affine3A,
    /// Which frames the pictures show, when anything moves.
    pub shown: Shown,
    /// What the debug view draws besides what hair brings with it: lattices, pins, tapes.
    pub overlay: Arc<Overlay>,
}

/// One thing in a scene.
#[derive(Clone, Debug)]
pub struct Part {
    /// Unique within the scene: `head`, `hair`, `hair_2`.
    pub name: String,
    /// Place in the script that made it: `ponytail.lua:24`; empty when no script did.
    pub source: String,
    /// What it is; for a part that moves, at rest.
    pub body: Body,
    /// How it moves, if it does.
    pub motion: Option<Motion>,
}

/// What a part is made of.
#[derive(Clone, Debug)]
pub enum Body {
    /// A surface: the head.
    Mesh(Arc<Mesh>, MeshMaterial),
    /// Strands of hair.
    Hair(Hair),
    /// Stylised hair: closed surfaces.
    Locks(Locks),
}

/// Strands with what belongs to them.
#[derive(Clone, Debug)]
pub struct Hair {
    /// The strands to be drawn and exported.
    pub strands: Arc<Strands>,
    /// The guides they follow; the strands themselves when there are no others.
    pub guides: Arc<Strands>,
    /// How they look.
    pub material: HairMaterial,
    /// Domains, partings, roots: what the debug view draws.
    pub overlay: Arc<Overlay>,
}

impl Part {
    /// True for a garment, which is shown as far down as it goes; of any other surface, a bust, the lower end is left out.
    pub fn is_garment(&self) -> bool {
        matches!(self.body, Body::Mesh(..)) && (self.name == "garment" || self.name.starts_with("garment_"))
    }
}

impl Scene {
    /// Bounds of everything in it.
    pub fn bounds(&self) -> Bounds {
        self.parts.iter().fold(Bounds::EMPTY, |b, part| {
            b.union(match &part.body {
                Body::Mesh(mesh, _) => mesh.bounds(),
                Body::Hair(hair) => hair.strands.bounds(),
                Body::Locks(locks) => locks.mesh.mesh.bounds(),
            })
        })
    }

    /// Every part that is hair.
    pub fn hair(&self) -> impl Iterator<Item = (&Part, &Hair)> {
        self.parts.iter().filter_map(|part| match &part.body {
            Body::Hair(hair) => Some((part, hair)),
            Body::Mesh(..) | Body::Locks(_) => None,
        })
    }

    /// Every part that is stylised hair.
    pub fn locks(&self) -> impl Iterator<Item = (&Part, &Locks)> {
        self.parts.iter().filter_map(|part| match &part.body {
            Body::Locks(locks) => Some((part, locks)),
            Body::Mesh(..) | Body::Hair(_) => None,
        })
    }
}

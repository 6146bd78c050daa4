//! `coif.scene`: what a script ends with.

use std::sync::Arc;

use glam::Affine3A;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Noun};
use super::overlay;
use super::piece::Piece as Shape;
use super::strands::Lock;
use super::tuft::Wig;
use crate::geometry::Mesh;
use crate::head::Head;
use crate::math::Colour;
use crate::params::{Handle, Object, Value};
use crate::scene::{Background, Body, Hair, Locks, Look, MeshMaterial, Part, Scene, Shading, View};
use crate::task::Warning;

impl Object for Scene {
    const NAME: &'static str = "Scene";
}

crate::params! {
    /// Puts together what the pictures and files show. A script ends with `return coif.scene { head, hair }`.
    pub struct SceneFields("coif.scene") {
        /// The head and the hair, in any number and order; lists in the list are taken apart.
        parts: Vec<Value> = vec![], positional();
        /// The views of the preview, in order.
        views: Vec<View> = vec![View::Front, View::Left, View::Back];
        /// The colour behind everything.
        background: Background = Background::White;
        /// How surfaces and light are drawn.
        shading: Shading = Shading::Soft;
        /// Colour of the head.
        skin: Colour = MeshMaterial::default().colour;
    }
}

/// `coif.scene`.
pub fn functions() -> Vec<Entry> {
    vec![Entry::table::<SceneFields>("coif.scene", "Scene", scene)]
}

/// A scene.
pub fn noun() -> Noun {
    Noun::of::<Scene>("A finished hairstyle.", vec![], vec![], |h| {
        h.get::<Scene>().map_or_else(String::new, |s| format!("scene of {} parts", s.parts.len()))
    })
}

/// The scene inside a handle.
pub fn scene_of(handle: &Handle) -> Option<Arc<Scene>> {
    handle.get()
}

/// What a scene can be made of.
enum Piece {
    Head(Arc<Head>),
    Hair(Arc<Lock>),
    Tufts(Wig),
    Shape(Arc<Shape>),
}

impl Piece {
    /// The head that it is, or belongs to.
    fn head(&self) -> &Arc<Head> {
        match self {
            Self::Head(head) => head,
            Self::Hair(lock) => &lock.area.head,
            Self::Tufts(wig) => &wig.head,
            Self::Shape(shape) => &shape.head,
        }
    }

    /// What it is and where it was made, for messages.
    fn made(&self) -> (&'static str, &str) {
        match self {
            Self::Head(_) => ("head", ""),
            Self::Hair(lock) => ("hair", &lock.source),
            Self::Tufts(wig) => ("tufts", wig.tufts.sources.first().map_or("", |s| s)),
            Self::Shape(shape) => (shape.kind.text(), &shape.source),
        }
    }
}

fn scene(call: &Call) -> Result<Value> {
    let fields: SceneFields = call.read()?;
    if fields.views.is_empty() {
        return Err(call.problem_at("views", "a scene needs at least one view", Some("as in { \"front\" }".into())));
    }
    let mut pieces = vec![];
    for (i, value) in fields.parts.iter().enumerate() {
        take(call, value, &format!("[{}]", i + 1), &mut pieces)?;
    }
    if pieces.is_empty() {
        let hint = "list them: `coif.scene { head, hair }`".to_owned();
        return Err(call.problem("a scene without head and hair", Some(hint)));
    }
    let heads: Vec<&Arc<Head>> =
        pieces.iter().filter_map(|p| if let Piece::Head(h) = p { Some(h) } else { None }).collect();
    for piece in &pieces {
        if !heads.is_empty() && !heads.iter().any(|h| Arc::ptr_eq(h, piece.head())) {
            let (what, source) = piece.made();
            let verb = if what == "tufts" { "grow" } else { "grows" };
            let warning =
                Warning::new(format!("the {what} made at {source} {verb} on a head that is not in the scene"));
            call.warn("", warning.hint("make the head once and use it for everything: `local head = coif.head()`"));
        }
    }
    let placement =
        heads.first().copied().or(pieces.first().map(Piece::head)).map_or(Affine3A::IDENTITY, |h| h.placement);
    let mut scene = Scene {
        name: call.session.options.name(),
        parts: vec![],
        views: fields.views,
        look: Look { background: fields.background, shading: fields.shading, debug: false },
        placement,
    };
    for piece in &pieces {
        let (base, source, body) = match piece {
            Piece::Head(head) => {
                let look = MeshMaterial { colour: fields.skin, ..MeshMaterial::default() };
                ("head", String::new(), Body::Mesh(Arc::clone(&head.mesh), look))
            }
            Piece::Hair(lock) => ("hair", lock.source.to_string(), Body::Hair(hair(lock))),
            Piece::Tufts(wig) => {
                // With more than one source, each tuft says its own.
                let source = if let [one] = wig.tufts.sources.as_slice() { one.to_string() } else { String::new() };
                ("tufts", source, Body::Locks(Locks::tufts(Arc::clone(&wig.tufts), wig.palette.clone())))
            }
            Piece::Shape(shape) => {
                let locks = Locks::piece(shape.kind, Mesh::clone(&shape.mesh), shape.material.clone());
                (shape.kind.text(), shape.source.to_string(), Body::Locks(locks))
            }
        };
        let name = unique(base, &scene.parts);
        scene.parts.push(Part { name, source, body, motion: None });
    }
    let bounds = scene.bounds();
    for part in &mut scene.parts {
        if let Body::Hair(hair) = &mut part.body {
            overlay::fit(Arc::make_mut(&mut hair.overlay), bounds);
        }
    }
    Ok(Value::Handle(Handle::new(Arc::new(scene))))
}

fn hair(lock: &Lock) -> Hair {
    Hair {
        strands: Arc::clone(&lock.strands),
        guides: Arc::clone(&lock.guides),
        material: lock.material.clone(),
        overlay: Arc::clone(&lock.overlay),
    }
}

/// Takes one entry of the list, or every entry of a list in it.
fn take(call: &Call, value: &Value, path: &str, out: &mut Vec<Piece>) -> Result<()> {
    let hint = match value {
        Value::Handle(h) => {
            if let Some(head) = h.get::<Head>() {
                out.push(Piece::Head(head));
                return Ok(());
            }
            if let Some(lock) = h.get::<Lock>() {
                out.push(Piece::Hair(lock));
                return Ok(());
            }
            if let Some(wig) = h.get::<Wig>() {
                // All tufts of a head become one part: one mesh, one atlas.
                let same = out.iter_mut().find_map(|p| match p {
                    Piece::Tufts(all) if Arc::ptr_eq(&all.head, &wig.head) => Some(all),
                    _ => None,
                });
                match same {
                    Some(all) => *all = all.joined(&wig),
                    None => out.push(Piece::Tufts(Wig::clone(&wig))),
                }
                return Ok(());
            }
            if let Some(shape) = h.get::<Shape>() {
                out.push(Piece::Shape(shape));
                return Ok(());
            }
            match h.name() {
                "Guides" => Some("grow them first: `guides:grow { ... }`"),
                "Region" => Some("a region shows nothing; grow hair on it: `region:guides { ... }:grow { ... }`"),
                _ => None,
            }
        }
        Value::Table(t) if t.fields.is_empty() && !t.items.is_empty() => {
            for (i, item) in t.items.iter().enumerate() {
                take(call, item, &format!("{path}[{}]", i + 1), out)?;
            }
            return Ok(());
        }
        Value::Nil => Some("is the name before it spelt as where it was set?"),
        _ => None,
    };
    let message = format!("expected a Head, Strands, Tufts or a Piece, got {} `{value}`", value.type_name());
    Err(call.problem_at(path, message, hint.map(ToOwned::to_owned)))
}

/// `hair`, `hair_2`, `hair_3`.
fn unique(base: &str, parts: &[Part]) -> String {
    let taken = |name: &str| parts.iter().any(|p| p.name == name);
    if !taken(base) {
        return base.to_owned();
    }
    (2..).map(|n| format!("{base}_{n}")).find(|name| !taken(name)).unwrap_or_default()
}

//! `coif.scene`: what a script ends with.

use std::sync::Arc;

use glam::Affine3A;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Noun};
use super::overlay;
use super::strands::Lock;
use crate::head::Head;
use crate::math::Colour;
use crate::params::{Handle, Object, Value};
use crate::scene::{Background, Body, Hair, Look, MeshMaterial, Part, Scene, View};
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
        if let (Piece::Hair(lock), false) = (piece, heads.is_empty())
            && !heads.iter().any(|h| Arc::ptr_eq(h, &lock.area.head))
        {
            let warning =
                Warning::new(format!("the hair made at {} grows on a head that is not in the scene", lock.source));
            call.warn("", warning.hint("make the head once and use it for everything: `local head = coif.head()`"));
        }
    }
    let placement = pieces.first().map_or(Affine3A::IDENTITY, |_| {
        let of_hair = pieces.iter().find_map(|p| if let Piece::Hair(l) = p { Some(&l.area.head) } else { None });
        heads.first().copied().or(of_hair).map_or(Affine3A::IDENTITY, |h| h.placement)
    });
    let mut scene = Scene {
        name: call.session.options.name(),
        parts: vec![],
        views: fields.views,
        look: Look { background: fields.background, debug: false },
        placement,
    };
    for piece in &pieces {
        let (base, source, body) = match piece {
            Piece::Head(head) => {
                let look = MeshMaterial { colour: fields.skin, ..MeshMaterial::default() };
                ("head", String::new(), Body::Mesh(Arc::clone(&head.mesh), look))
            }
            Piece::Hair(lock) => ("hair", lock.source.to_string(), Body::Hair(hair(lock))),
        };
        let name = unique(base, &scene.parts);
        scene.parts.push(Part { name, source, body });
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
    let message = format!("expected a Head or Strands, got {} `{value}`", value.type_name());
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

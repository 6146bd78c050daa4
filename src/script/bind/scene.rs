//! `coif.scene`: what a script ends with.

use std::sync::Arc;

use glam::Affine3A;

use super::super::call::{Call, Result};
use super::super::limits::Need;
use super::super::registry::{Entry, Noun};
use super::clip::{MovingLocks, MovingStrands, StillLocks};
use super::garment::Cloth;
use super::piece::Piece as Shape;
use super::strands::Lock;
use super::tuft::Wig;
use super::{carry, overlay};
use crate::geometry::{Clip, Mesh};
use crate::head::{Head, HeadMotion};
use crate::math::Colour;
use crate::params::{Handle, Object, Value};
use crate::scene::{
    Background, Body, Hair, HairMaterial, Locks, Look, MeshMaterial, Motion, Part, Scene, Shading, Shown, View,
};
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
        /// How the head moves: `head:motion { ... }`. What is on it moves with it, but for hair whose own motion was made
        /// with this one; when there is such hair, this may be left out.
        motion: Option<Arc<HeadMotion>>;
        /// Of a scene that moves, the frame of still pictures, from 1; the middle one when left out.
        still: Option<usize>, range(1.0, 1e9);
        /// Of a scene that moves, the frames of the strip, from 1; eight of them, evenly, when left out.
        strip: Vec<usize> = vec![];
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
    Cloth(Arc<Cloth>),
    MovingHair(Arc<MovingStrands>),
    /// All moving tufts of one head, or one moving piece.
    MovingLocks(MovingLocks),
}

impl Piece {
    /// The head that it is, or belongs to, if to any.
    fn head(&self) -> Option<&Arc<Head>> {
        Some(match self {
            Self::Head(head) => head,
            Self::Hair(lock) => &lock.area.head,
            Self::Tufts(wig) => &wig.head,
            Self::Shape(shape) => &shape.head,
            Self::Cloth(_) => return None,
            Self::MovingHair(hair) => &hair.rest.area.head,
            Self::MovingLocks(locks) => locks.rest.head(),
        })
    }

    /// The motion of the head that is in its frames.
    fn motion(&self) -> Option<&Arc<HeadMotion>> {
        match self {
            Self::Head(_) | Self::Hair(_) | Self::Tufts(_) | Self::Shape(_) | Self::Cloth(_) => None,
            Self::MovingHair(hair) => hair.motion.as_ref(),
            Self::MovingLocks(locks) => locks.motion.as_ref(),
        }
    }

    /// The same on another head.
    fn carried(&self, call: &Call, to: &Arc<Head>) -> Result<Self> {
        Ok(match self {
            Self::Head(_) => Self::Head(Arc::clone(to)),
            Self::Hair(lock) => Self::Hair(Arc::new(carry::carried_strands(call, lock, to)?)),
            Self::Tufts(wig) => Self::Tufts(carry::carried_tufts(call, wig, to)?),
            Self::Shape(shape) => Self::Shape(Arc::new(carry::carried_piece(call, shape, to)?)),
            Self::Cloth(cloth) => Self::Cloth(Arc::clone(cloth)),
            Self::MovingHair(_) | Self::MovingLocks(_) => {
                let (what, source) = self.made();
                let message =
                    format!("the {what} made at {source} moves, and what moves is not carried to another head");
                let hint = "carry it at rest, `hair:carry { to = head }`, and let it move on that head".to_owned();
                return Err(call.problem(message, Some(hint)));
            }
        })
    }

    /// What it is and where it was made, for messages.
    fn made(&self) -> (&'static str, &str) {
        match self {
            Self::Head(_) => ("head", ""),
            Self::Hair(lock) => ("hair", &lock.source),
            Self::Tufts(wig) => ("tufts", wig.tufts.sources.first().map_or("", |s| s)),
            Self::Shape(shape) => (shape.kind.text(), &shape.source),
            Self::Cloth(cloth) => ("garment", &cloth.source),
            Self::MovingHair(hair) => ("hair", &hair.rest.source),
            Self::MovingLocks(locks) => match &locks.rest {
                StillLocks::Tufts(_) => ("tufts", &locks.source),
                StillLocks::Piece(shape) => (shape.kind.text(), &locks.source),
            },
        }
    }

    /// As a part of the scene: its name, where it was made, what it is and what it does itself.
    fn part(&self, skin: Colour) -> (&'static str, String, Body, Option<Motion>) {
        match self {
            Self::Head(head) => {
                let look = MeshMaterial { colour: skin, ..MeshMaterial::default() };
                ("head", String::new(), Body::Mesh(Arc::clone(&head.mesh), look), None)
            }
            Self::Hair(lock) => ("hair", lock.source.to_string(), Body::Hair(hair(lock)), None),
            Self::Tufts(wig) => {
                // With more than one source, each tuft says its own.
                let source = if let [one] = wig.tufts.sources.as_slice() { one.to_string() } else { String::new() };
                let locks = Locks::tufts(Arc::clone(&wig.tufts), wig.palette.clone());
                ("tufts", source, Body::Locks(locks), None)
            }
            Self::Shape(shape) => {
                let locks = Locks::piece(shape.kind, Mesh::clone(&shape.mesh), shape.material.clone());
                (shape.kind.text(), shape.source.to_string(), Body::Locks(locks), None)
            }
            Self::Cloth(cloth) => {
                let body = Body::Mesh(Arc::new(cloth.garment.mesh.clone()), cloth.material);
                ("garment", cloth.source.to_string(), body, None)
            }
            Self::MovingHair(moving) => {
                let motion = Motion::Strands { strands: moving.strands.clone(), guides: moving.guides.clone() };
                ("hair", moving.rest.source.to_string(), Body::Hair(hair(&moving.rest)), Some(motion))
            }
            Self::MovingLocks(moving) => {
                let body = Body::Locks(moving.rest.locks());
                (self.made().0, moving.source.to_string(), body, Some(Motion::Surface(moving.surface.clone())))
            }
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
    let carries = call.session.carries.borrow().clone();
    for (from, to) in &carries {
        for piece in &mut pieces {
            if piece.head().is_some_and(|own| Arc::ptr_eq(own, from)) {
                *piece = piece.carried(call, to)?;
            }
        }
    }
    let heads: Vec<&Arc<Head>> =
        pieces.iter().filter_map(|p| if let Piece::Head(h) = p { Some(h) } else { None }).collect();
    for piece in &pieces {
        if !heads.is_empty() && piece.head().is_some_and(|own| !heads.iter().any(|h| Arc::ptr_eq(h, own))) {
            let (what, source) = piece.made();
            let verb = if what == "tufts" { "grow" } else { "grows" };
            let warning =
                Warning::new(format!("the {what} made at {source} {verb} on a head that is not in the scene"));
            call.warn("", warning.hint("make the head once and use it for everything: `local head = coif.head()`"));
        }
    }
    let placement =
        heads.first().copied().or(pieces.iter().find_map(Piece::head)).map_or(Affine3A::IDENTITY, |h| h.placement);
    let motion = head_motion(call, &fields, &pieces)?;
    let mut scene = Scene {
        name: call.session.options.name(),
        parts: vec![],
        views: fields.views.clone(),
        look: Look { background: fields.background, shading: fields.shading, debug: false },
        placement,
        shown: Shown::default(),
        overlay: Arc::default(),
    };
    for (i, piece) in pieces.iter().enumerate() {
        if let Piece::Tufts(wig) = piece {
            call.claim(&format!("[{}]", i + 1), Need::triangles(wig.tufts.triangle_count()))?;
        }
        let (base, source, body, own) = piece.part(fields.skin);
        let mut part = Part { name: unique(base, &scene.parts), source, body, motion: own };
        if let (Some(motion), None, Some(_)) = (&motion, piece.motion(), piece.head()) {
            call.task().check().map_err(|e| call.problem(e.to_string(), None))?;
            part.carry(&motion.clip);
        }
        scene.parts.push(part);
    }
    scene.shown = shown(call, &fields, &scene)?;
    for piece in &pieces {
        if let Piece::Cloth(cloth) = piece {
            Arc::make_mut(&mut scene.overlay).extend(&cloth.overlay);
        }
    }
    let bounds = scene.bounds();
    for part in &mut scene.parts {
        if let Body::Hair(hair) = &mut part.body {
            overlay::fit(Arc::make_mut(&mut hair.overlay), bounds);
        }
    }
    Ok(Value::Handle(Handle::new(Arc::new(scene))))
}

/// What the head does: what the scene says, else what a part's own motion was made with; never two things at once, and
/// all that moves at one rate.
fn head_motion(call: &Call, fields: &SceneFields, pieces: &[Piece]) -> Result<Option<Arc<HeadMotion>>> {
    let mut motion = fields.motion.clone();
    for piece in pieces {
        let Some(own) = piece.motion() else { continue };
        match &motion {
            Some(known) if **known != **own => {
                let (what, source) = piece.made();
                let message = format!("the {what} made at {source} moves with another motion of the head");
                let hint = "make the motion once and use it for everything: `local turn = head:motion { ... }`";
                return Err(call.problem_at(
                    if fields.motion.is_some() { "motion" } else { "" },
                    message,
                    Some(hint.into()),
                ));
            }
            _ => motion = Some(Arc::clone(own)),
        }
    }
    let mut rate = motion.as_ref().map(|m| ("the head's motion".to_owned(), m.clip.rate));
    for piece in pieces {
        let own = match piece {
            Piece::MovingHair(hair) => hair.strands.rate,
            Piece::MovingLocks(locks) => locks.surface.rate,
            Piece::Head(_) | Piece::Hair(_) | Piece::Tufts(_) | Piece::Shape(_) | Piece::Cloth(_) => continue,
        };
        let (what, source) = piece.made();
        match &rate {
            Some((other, known)) if *known != own => {
                let message = format!("the {what} made at {source} has {own} frames in a second, {other} has {known}");
                let hint = "give everything that moves the same `rate`".to_owned();
                return Err(call.problem(message, Some(hint)));
            }
            _ => rate = Some((format!("the {what} made at {source}"), own)),
        }
    }
    Ok(motion)
}

/// Which frames the pictures show.
fn shown(call: &Call, fields: &SceneFields, scene: &Scene) -> Result<Shown> {
    let Some(timeline) = scene.timeline() else {
        let given = [("still", fields.still.is_some()), ("strip", !fields.strip.is_empty())];
        return match given.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => {
                let hint = Some("leave it out, or put something in that moves".to_owned());
                Err(call.problem_at(name, "nothing in the scene moves", hint))
            }
            None => Ok(Shown::default()),
        };
    };
    let last = timeline.frames;
    let within = |path: &str, frame: usize| {
        if (1..=last).contains(&frame) {
            return Ok(frame - 1);
        }
        Err(call.problem_at(path, format!("there is no frame `{frame}`"), Some(format!("the frames are 1 to {last}"))))
    };
    let still = within("still", fields.still.unwrap_or(last.div_ceil(2)))?;
    let strip = fields.strip.iter().enumerate().map(|(i, &f)| within(&format!("strip[{}]", i + 1), f));
    Ok(Shown { still, strip: strip.collect::<Result<_>>()? })
}

fn hair(lock: &Lock) -> Hair {
    Hair {
        strands: Arc::clone(&lock.strands),
        guides: Arc::clone(&lock.guides),
        // Fewer strands are drawn wider, so that the hair is as dense.
        material: HairMaterial { width: lock.material.width * lock.stands_for, ..lock.material.clone() },
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
            if let Some(cloth) = h.get::<Cloth>() {
                out.push(Piece::Cloth(cloth));
                return Ok(());
            }
            if let Some(shape) = h.get::<Shape>() {
                out.push(Piece::Shape(shape));
                return Ok(());
            }
            if let Some(hair) = h.get::<MovingStrands>() {
                out.push(Piece::MovingHair(hair));
                return Ok(());
            }
            if let Some(locks) = h.get::<MovingLocks>() {
                take_moving(call, &locks, path, out)?;
                return Ok(());
            }
            match h.name() {
                "Guides" => Some("grow them first: `guides:grow { ... }`"),
                "Motion" => Some("name it: `motion = turn`"),
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
    let message = format!("expected a Head, Strands, Tufts, a Piece or a Garment, got {} `{value}`", value.type_name());
    Err(call.problem_at(path, message, hint.map(ToOwned::to_owned)))
}

/// Takes stylised hair in motion; all moving tufts of a head become one part, as still ones do.
fn take_moving(call: &Call, locks: &MovingLocks, path: &str, out: &mut Vec<Piece>) -> Result<()> {
    let vertices = locks.rest.locks().mesh.mesh.positions.len();
    if let Some(frame) = locks.surface.frames.iter().find(|f| f.len() != vertices) {
        let message = format!("a frame of `{}` points moves a surface of {vertices}", frame.len());
        return Err(call.problem_at(path, message, None));
    }
    let is_same = |a: &MovingLocks| match (&a.rest, &locks.rest) {
        (StillLocks::Tufts(a), StillLocks::Tufts(b)) => Arc::ptr_eq(&a.head, &b.head),
        _ => false,
    };
    let fits = |a: &MovingLocks| {
        let (x, y) = (&a.surface, &locks.surface);
        let motions = match (&a.motion, &locks.motion) {
            (None, None) => true,
            (Some(a), Some(b)) => a == b,
            _ => false,
        };
        motions && x.rate == y.rate && x.looped == y.looped && (!x.looped || x.count() == y.count())
    };
    let same = out.iter_mut().find_map(|p| match p {
        Piece::MovingLocks(all) if is_same(all) && fits(all) => Some(all),
        _ => None,
    });
    match (same, &locks.rest) {
        (Some(all), StillLocks::Tufts(wig)) => {
            if let StillLocks::Tufts(rest) = &mut all.rest {
                *rest = rest.followed(wig);
            }
            let count = all.surface.count().max(locks.surface.count());
            let frames = (0..count).map(|i| {
                let of = |clip: &Clip<Vec<glam::Vec3>>| clip.at(i).map_or_else(Vec::new, |f| f.to_vec());
                Arc::new([of(&all.surface), of(&locks.surface)].concat())
            });
            all.surface.frames = frames.collect();
            if all.source != locks.source {
                all.source = "".into();
            }
        }
        _ => out.push(Piece::MovingLocks(locks.clone())),
    }
    Ok(())
}

/// `hair`, `hair_2`, `hair_3`.
fn unique(base: &str, parts: &[Part]) -> String {
    let taken = |name: &str| parts.iter().any(|p| p.name == name);
    if !taken(base) {
        return base.to_owned();
    }
    (2..).map(|n| format!("{base}_{n}")).find(|name| !taken(name)).unwrap_or_default()
}

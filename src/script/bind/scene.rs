//! `coif.scene`: what a script ends with.

use std::sync::Arc;

use glam::Affine3A;

use super::super::call::{Call, Result};
use super::super::registry::{Entry, Noun};
use crate::params::{Handle, Object, Value};
use crate::scene::{Background, Look, Scene, View};

impl Object for Scene {
    const NAME: &'static str = "Scene";
}

crate::params! {
    /// Puts together what the pictures and files show. A script ends with `return coif.scene { head, hair }`.
    pub struct SceneFields("coif.scene") {
        /// The head and the hair, in any number and order.
        parts: Vec<Value> = vec![], positional();
        /// The views of the preview, in order.
        views: Vec<View> = vec![View::Front, View::Left, View::Back];
        /// The colour behind everything.
        background: Background = Background::White;
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

fn scene(call: &Call) -> Result<Value> {
    let fields: SceneFields = call.read()?;
    let scene = Scene {
        name: call.session.options.name(),
        parts: vec![],
        views: fields.views,
        look: Look { background: fields.background, debug: false },
        placement: Affine3A::IDENTITY,
    };
    Ok(Value::Handle(Handle::new(Arc::new(scene))))
}

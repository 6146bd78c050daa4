//! Golden previews: a test's picture against the one that was kept.

use std::sync::Arc;

use glam::Mat3;

use super::super::Preview;
use super::super::call::{Call, Result};
use super::super::files::AccessError;
use super::super::testing::Tests;
use super::test::expect;
use super::tested::Tested;
use crate::params::Value;
use crate::render::{self, Picture, SheetOptions, camera};
use crate::scene::{Background, View};

crate::params! {
    /// Expects the preview of a scene to be the golden picture `golden/NAME.png` beside the test.
    pub struct PreviewFields("Test:preview") {
        /// What `t:run` gave, or a scene.
        scene: Value, takes("TestScene|Scene");
        /// Name of the picture: letters, digits, `-` and `_`.
        name: String;
        /// How it is drawn and compared.
        options: Option<PreviewOptions>;
    }
}

crate::params! {
    /// How a golden preview is drawn and compared.
    pub struct PreviewOptions("Test:preview.options") {
        /// The views, side by side; the scene's first one when left out.
        views: Vec<View> = vec![];
        /// Width of one view in pixels; its height is nine eighths of it.
        size: u32 = 120, unit("px"), range(16.0, 1024.0);
        /// How far a channel of a pixel may differ, out of 255.
        tolerance: u32 = 1, range(0.0, 255.0);
        /// The colour behind everything, instead of the scene's own.
        background: Option<Background>;
        /// Of a scene that moves, which frame, from 1; the scene's own when left out.
        frame: Option<usize>, range(1.0, 1e9);
    }
}

/// `Test:preview`.
pub fn preview(call: &Call) -> Result<Value> {
    let fields: PreviewFields = call.read()?;
    let tests = Tests::of(call)?;
    let name = fields.name;
    if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_') {
        let hint = "letters, digits, `-` and `_`, as in \"ponytail_back\"".to_owned();
        return Err(call.problem_at("name", format!("`{name}` is not the name of a picture"), Some(hint)));
    }
    if tests.previews.borrow().iter().any(|p| p.name == name) {
        return Err(call.problem_at("name", format!("there is already a preview `{name}`"), None));
    }
    let scene = Tested::from(call, &fields.scene, "scene")?;
    let options = match fields.options {
        Some(options) => options,
        None => crate::params::read(&crate::params::Table::default()).map_err(|p| call.problems(p))?,
    };
    let scene = match options.frame {
        Some(frame) => Arc::new(scene.at(frame - 1)),
        None => scene,
    };
    let actual = draw(call, &scene, &options)?;
    let golden = call.session.options.folder().join("golden").join(format!("{name}.png"));
    let mut preview = Preview { name, golden, actual, panels: None, is_same: false, place: None };
    let path = preview.golden.display().to_string();
    let accept = || Some("look at it, then keep it: `coif test --accept`".to_owned());
    let (message, hint) = match call.session.access.read(&preview.golden) {
        Ok(bytes) => match render::png::decode(&bytes) {
            Ok(expected) => match render::compare(&expected, &preview.actual, options.tolerance as u8) {
                None => {
                    preview.is_same = true;
                    (String::new(), None)
                }
                Some(difference) => {
                    let all = expected.width as usize * expected.height as usize;
                    let sizes = (expected.width, expected.height) == (preview.actual.width, preview.actual.height);
                    let message = if sizes {
                        let (n, most) = (difference.pixels, difference.most);
                        format!("`{path}` differs in {n} of {all} pixels, by {most} of 255 at most")
                    } else {
                        let (a, b) = (&expected, &preview.actual);
                        let (w, h) = (b.width, b.height);
                        format!("`{path}` has {} x {} pixels, the preview {w} x {h}", a.width, a.height)
                    };
                    preview.panels = Some(difference.panels);
                    (message, accept())
                }
            },
            Err(what) => (format!("`{path}` is no PNG picture: {what}"), accept()),
        },
        Err(AccessError::Missing { .. }) => (format!("there is no golden picture `{path}`"), accept()),
        Err(other) => (other.to_string(), other.hint()),
    };
    let is_same = preview.is_same;
    preview.place = call.problem("", None).0.pop().and_then(|d| d.place);
    tests.previews.borrow_mut().push(preview);
    expect(call, is_same, || message, hint)
}

/// The views side by side, without lettering.
fn draw(call: &Call, tested: &Tested, options: &PreviewOptions) -> Result<Picture> {
    let mut scene = crate::scene::Scene::clone(&tested.scene);
    if let Some(background) = options.background {
        scene.look.background = background;
    }
    let views = if options.views.is_empty() { &scene.views[..scene.views.len().min(1)] } else { &options.views };
    let views = if views.is_empty() { &[View::Front] } else { views };
    let sights: Vec<Mat3> = views.iter().map(|&v| camera::axes(v)).collect();
    let sheet =
        SheetOptions { width: options.size, height: options.size * 9 / 8, lettering: false, ..SheetOptions::default() };
    let failed = |e: render::RenderError| call.problem(e.to_string(), None);
    let pictures = render::views(&scene, &sights, None, &sheet, call.task()).map_err(failed)?;
    Ok(render::contact::row(&pictures))
}

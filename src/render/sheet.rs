//! The preview sheet: every view at one scale, with quiet lettering.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{Mat3, Vec3};
use rayon::prelude::*;
use tiny_skia::{Paint, Pixmap, Rect, Transform};

use crate::geometry::{Mesh, Strands};
use crate::math::Colour;
use crate::scene::{Background, Body, MeshMaterial, Scene, Shading, View};
use crate::task::{Cancelled, Task};

use super::camera::{Camera, Framing, axes, frame};
use super::lettering::{self, Anchor};
use super::overlay::{self, Label};
use super::raster::{self, Canvas};
use super::shade::{Coat, Skin, Sky, Studio};
use super::shadow::{Density, density};
use super::strands::{Bundle, Ink};
use super::surface::{self, Shell};
use super::toon::{self, Toon};

/// An opaque picture, sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, row by row from the top.
    pub pixels: Vec<u8>,
}

/// How large and how fine a sheet is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetOptions {
    /// Width of one view in pixels, 16 to 8192.
    pub width: u32,
    /// Height of one view in pixels, 16 to 8192.
    pub height: u32,
    /// Views per row; chosen by their number when none is given.
    pub columns: Option<u32>,
    /// Samples per pixel along each side, 1 to 4: 1 while watching, 2 for a picture that is kept.
    pub supersample: u32,
    /// Pixels of the sheet along each side of one that is drawn, 1 to 8: 2 for a draft, a quarter of the work.
    pub coarse: u32,
    /// Names, figures and a scale bar around the views.
    pub lettering: bool,
}

impl Default for SheetOptions {
    fn default() -> Self {
        Self { width: 640, height: 720, columns: None, supersample: 2, coarse: 1, lettering: true }
    }
}

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// Stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A size that is not between its limits.
    #[error("a {what} of `{value}` is not between {least} and {most}")]
    Size {
        /// Which option.
        what: &'static str,
        /// Its value.
        value: u32,
        /// Least allowed.
        least: u32,
        /// Most allowed.
        most: u32,
    },
    /// All views together are too many pixels.
    #[error("a sheet of {width} x {height} pixels is more than the {most} million that fit in memory")]
    TooLarge {
        /// Pixels.
        width: u64,
        /// Pixels.
        height: u64,
        /// Most allowed, in millions.
        most: u64,
    },
}

/// Height of the strip at the lower border that fades out, as a fraction of a view's.
const FADE: f32 = 0.10;

/// The cut through a bust fades; a garment has an end of its own.
fn fade(scene: &Scene) -> f32 {
    if scene.parts.iter().any(crate::scene::Part::is_garment) { 0.0 } else { FADE }
}

/// Most pixels of a sheet, in millions.
pub(super) const MOST_PIXELS: u64 = 200;

/// Where everything stands on the sheet, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layout {
    columns: u32,
    rows: u32,
    /// Height of the title band.
    head: u32,
    /// Height of the line with a view's name under the view.
    caption: u32,
    /// Height of the band at the bottom.
    foot: u32,
    margin: u32,
    /// Size of the letters.
    letter: f32,
    width: u32,
    height: u32,
}

impl Layout {
    fn new(views: usize, options: &SheetOptions) -> Result<Self, RenderError> {
        let sizes = [
            ("width", options.width, 16, 8192),
            ("height", options.height, 16, 8192),
            ("supersample", options.supersample, 1, 4),
            ("coarseness", options.coarse, 1, 8),
            ("column count", options.columns.unwrap_or(1), 1, 64),
        ];
        for (what, value, least, most) in sizes {
            if value < least || value > most {
                return Err(RenderError::Size { what, value, least, most });
            }
        }
        let n = views.max(1) as u32;
        let columns = options.columns.unwrap_or(match n {
            1..=3 => n,
            4 => 2,
            5 | 6 => 3,
            _ => 4,
        });
        let columns = columns.min(n);
        let rows = n.div_ceil(columns);
        let letter = (options.width as f32 / 36.0).clamp(9.0, 22.0);
        let band = |lines: f32| if options.lettering { (letter * lines).round() as u32 } else { 0 };
        let (head, caption, foot, margin) = (band(4.2), band(2.0), band(3.4), band(1.5));
        let width = u64::from(columns) * u64::from(options.width);
        let height = u64::from(rows) * u64::from(options.height + caption) + u64::from(head) + u64::from(foot);
        if width * height > MOST_PIXELS * 1_000_000 {
            return Err(RenderError::TooLarge { width, height, most: MOST_PIXELS });
        }
        let (width, height) = (width as u32, height as u32);
        Ok(Self { columns, rows, head, caption, foot, margin, letter, width, height })
    }

    /// Which rows of the sheet hold letters, when none are in the views of this height.
    fn written(&self, views: Option<u32>) -> Vec<bool> {
        let free = |y: u32| {
            let row = y.checked_sub(self.head)?;
            let height = views?;
            Some(row < self.rows * (height + self.caption) && row % (height + self.caption) < height)
        };
        // A letter may reach a little into the view over it.
        let near = |y: u32| (0..=2).any(|d| !free(y + d).unwrap_or(false));
        (0..self.height).map(near).collect()
    }

    /// Upper left corner of view `i`.
    fn corner(&self, i: usize, options: &SheetOptions) -> (u32, u32) {
        let (column, row) = (i as u32 % self.columns, i as u32 / self.columns);
        (column * options.width, self.head + row * (options.height + self.caption))
    }
}

/// Colours of paper and ink.
pub(super) struct Paper {
    pub paper: Colour,
    pub ink: Colour,
    pub quiet: Colour,
}

pub(super) fn paper(background: Background) -> Paper {
    match background {
        Background::White => {
            Paper { paper: Colour::hex(0xff_ff_ff), ink: Colour::hex(0x2b_2d_31), quiet: Colour::hex(0x8c_90_98) }
        }
        Background::Dark => {
            Paper { paper: Colour::hex(0x15_16_19), ink: Colour::hex(0xe4_e5_e8), quiet: Colour::hex(0x7f_84_8d) }
        }
    }
}

/// Draws all views of `scene` on one sheet.
///
/// # Errors
/// [`RenderError`]: cancelled, or a size out of range.
pub fn sheet(scene: &Scene, options: &SheetOptions, task: &Task) -> Result<Picture, RenderError> {
    let views: &[View] = if scene.views.is_empty() { &[View::Front] } else { &scene.views };
    let layout = Layout::new(views.len(), options)?;
    let paper = paper(scene.look.background);
    task.progress("density", 0.0);
    let stage = Stage::new(scene, task)?;
    task.progress("framing", 0.0);
    let sights: Vec<Mat3> = views.iter().map(|&view| axes(view)).collect();
    let framing = frame(scene, &sights);
    let mut picture = blank(layout.width, layout.height, paper.paper);
    let steps = Steps { task, done: AtomicUsize::new(0), all: STEPS * views.len() };
    // Side by side, so that a view's last work fills what the next one leaves free.
    let drawn: Result<Vec<_>, Cancelled> = sights
        .par_iter()
        .zip(&framing.centres)
        .map(|(&sight, &centre)| {
            let camera = camera(sight, centre, &framing, options);
            let (pixels, words) = stage.view(scene, &camera, options, paper.paper, &steps)?;
            Ok((camera, pixels, words))
        })
        .collect();
    let mut labels = Vec::new();
    for (i, (camera, pixels, words)) in drawn?.into_iter().enumerate() {
        paste(&mut picture, &pixels, layout.corner(i, options), options.width);
        labels.push((camera, words));
    }
    task.progress("lettering", 0.95);
    if options.lettering {
        letter(&mut picture, scene, views, &layout, options, &framing, &paper, &labels);
    }
    Ok(picture)
}

/// Draws the scene alone, without lettering: one picture for each direction (columns of a sight: right, up, toward the
/// viewer; see [`axes`](super::camera::axes) and [`turned`](super::camera::turned)), all at one scale.
///
/// Without a framing of your own the pixels are those that [`sheet`] gives for the same views.
///
/// # Errors
/// [`RenderError`]: cancelled, or a size out of range.
pub fn views(
    scene: &Scene,
    sights: &[Mat3],
    framing: Option<&Framing>,
    options: &SheetOptions,
    task: &Task,
) -> Result<Vec<Picture>, RenderError> {
    Layout::new(sights.len(), &SheetOptions { lettering: false, columns: None, ..*options })?;
    let paper = paper(scene.look.background);
    let stage = Stage::new(scene, task)?;
    let own = if framing.is_none() { Some(frame(scene, sights)) } else { None };
    let Some(framing) = framing.or(own.as_ref()) else { return Ok(vec![]) };
    let steps = Steps { task, done: AtomicUsize::new(0), all: STEPS * sights.len() };
    sights
        .par_iter()
        .zip(&framing.centres)
        .map(|(&sight, &centre)| {
            let camera = camera(sight, centre, framing, options);
            let (pixels, _) = stage.view(scene, &camera, options, paper.paper, &steps)?;
            Ok(Picture { width: options.width, height: options.height, pixels })
        })
        .collect()
}

/// One scale for all views, with room around the largest.
fn camera(sight: Mat3, centre: Vec3, framing: &Framing, options: &SheetOptions) -> Camera {
    let m = sight;
    let (w, h) = (options.width as f32, options.height as f32);
    let scale = (0.88 * w / framing.size.x).min(0.92 * h / framing.size.y);
    Camera {
        right: m.x_axis,
        up: m.y_axis,
        toward: m.z_axis,
        centre,
        scale,
        width: options.width as usize,
        height: options.height as usize,
    }
}

pub(super) fn blank(width: u32, height: u32, colour: Colour) -> Picture {
    let [r, g, b] = super::fast::encode(colour.to_linear());
    let pixels = [r, g, b].repeat(width as usize * height as usize);
    Picture { width, height, pixels }
}

pub(super) fn paste(picture: &mut Picture, view: &[u8], (x, y): (u32, u32), width: u32) {
    let row = width as usize * 3;
    for (i, line) in view.chunks_exact(row).enumerate() {
        let at = ((y as usize + i) * picture.width as usize + x as usize) * 3;
        picture.pixels[at..at + row].copy_from_slice(line);
    }
}

/// A picture of `size` pixels with each of them `factor` times as large on each side, cut to `wanted` pixels: between the
/// middles of pixels colours go over evenly.
fn enlarge(pixels: &[u8], size: [usize; 2], factor: usize, wanted: [usize; 2]) -> Vec<u8> {
    // Per place along a side: the pixel before, the one after, and the share of the second in 256ths.
    let places = |count: usize, wanted: usize| -> Vec<(usize, usize, u32)> {
        let place = |i: usize| {
            let at = (((2 * i + 1) * 128 / factor).max(128) - 128).min((count - 1) * 256);
            (at / 256, (at / 256 + 1).min(count - 1), (at % 256) as u32)
        };
        (0..wanted).map(place).collect()
    };
    let (columns, rows) = (places(size[0], wanted[0]), places(size[1], wanted[1]));
    let mut out = vec![0; wanted[0] * wanted[1] * 3];
    out.par_chunks_exact_mut(3 * wanted[0]).zip(rows).for_each(|(out, (up, down, low))| {
        let row = |y: usize| &pixels[y * size[0] * 3..(y + 1) * size[0] * 3];
        let mixed: Vec<u32> =
            row(up).iter().zip(row(down)).map(|(&a, &b)| u32::from(a) * (256 - low) + u32::from(b) * low).collect();
        for (pixel, &(left, right, share)) in out.chunks_exact_mut(3).zip(&columns) {
            for (k, byte) in pixel.iter_mut().enumerate() {
                *byte = ((mixed[3 * left + k] * (256 - share) + mixed[3 * right + k] * share + (1 << 15)) >> 16) as u8;
            }
        }
    });
    out
}

/// How far the views of a sheet are, which are drawn at once.
struct Steps<'a> {
    task: &'a Task,
    done: AtomicUsize,
    all: usize,
}

/// Steps of one view: its light, its head, its hair.
const STEPS: usize = 3;

impl Steps<'_> {
    /// Notes that a step of some view is done.
    fn step(&self) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.task.progress("views", done as f32 / self.all.max(1) as f32);
        self.task.check()
    }
}

/// What all views of a scene share.
struct Stage {
    meshes: Vec<(Mesh, Skin, Option<Vec<Vec3>>)>,
    density: Density,
    sky: Sky,
    /// Instead of light and shadow.
    toon: Option<Toon>,
}

impl Stage {
    fn new(scene: &Scene, task: &Task) -> Result<Self, Cancelled> {
        let mut meshes = Vec::new();
        // Flat tones need neither shadows in hair nor a sky.
        if scene.look.shading == Shading::Toon && !scene.look.debug {
            let density = density(&[], &[], task)?;
            let sky = Sky::new(&density, task)?;
            return Ok(Self { meshes, density, sky, toon: Some(Toon::new(scene)) });
        }
        for part in &scene.parts {
            if let Body::Mesh(mesh, material) = &part.body {
                task.check()?;
                let mut mesh = Mesh::clone(mesh);
                if mesh.normals.len() != mesh.positions.len() {
                    mesh.compute_normals();
                }
                meshes.push((mesh, Skin::new(material), None));
            }
            if let (Body::Locks(locks), false) = (&part.body, scene.look.debug) {
                let roughness = locks.look(0).roughness;
                let tints = (0..locks.mesh.mesh.positions.len())
                    .map(|v| locks.look(locks.mesh.tuft[v] as usize).along(locks.place(v).y))
                    .collect();
                let skin = Skin::new(&MeshMaterial { roughness, ..MeshMaterial::default() });
                meshes.push((locks.mesh.mesh.clone(), skin, Some(tints)));
            }
        }
        let hair: Vec<(&Strands, f32, f32)> = scene
            .hair()
            .filter(|_| !scene.look.debug)
            .map(|(_, h)| {
                let width = h.material.width;
                (&*h.strands, width, width * h.material.taper)
            })
            .collect();
        let shapes: Vec<&Mesh> = meshes.iter().map(|(m, ..)| m).collect();
        let density = density(&hair, &shapes, task)?;
        let sky = Sky::new(&density, task)?;
        Ok(Self { meshes, density, sky, toon: None })
    }

    /// One view for a sheet whose camera is given: its bytes, and words for the lettering.
    fn view<'a>(
        &'a self,
        scene: &'a Scene,
        camera: &Camera,
        options: &SheetOptions,
        paper: Colour,
        steps: &Steps,
    ) -> Result<(Vec<u8>, Vec<Label>), Cancelled> {
        if options.coarse == 1 {
            return self.drawn(scene, camera, options, paper, steps);
        }
        let coarse = options.coarse as usize;
        let small = camera.reduced(coarse);
        let (pixels, words) = self.drawn(scene, &small, options, paper, steps)?;
        Ok((enlarge(&pixels, [small.width, small.height], coarse, [camera.width, camera.height]), words))
    }

    /// One view with as many pixels as `camera` has.
    fn drawn<'a>(
        &'a self,
        scene: &'a Scene,
        camera: &Camera,
        options: &SheetOptions,
        paper: Colour,
        steps: &Steps,
    ) -> Result<(Vec<u8>, Vec<Label>), Cancelled> {
        let task = steps.task;
        let ss = options.supersample as usize;
        if let (Some(toon), None) = (&self.toon, scene.hair().next()) {
            task.progress("surfaces", 0.2);
            let paper = toon::Paper { background: paper.to_linear(), fade: fade(scene) };
            return Ok((toon.picture(camera, ss, paper, task)?, vec![]));
        }
        let fine = camera.enlarged(ss);
        let meshes: Vec<&Mesh> = self.meshes.iter().map(|(mesh, ..)| mesh).collect();
        let studio = Studio::new(&fine, &self.density, &meshes, &self.sky);
        steps.step()?;
        let shell = |(mesh, skin, tints): &'a (Mesh, Skin, Option<Vec<Vec3>>)| Shell {
            mesh,
            skin: *skin,
            tints: tints.as_deref(),
        };
        let shells: Vec<Shell> = self.meshes.iter().map(shell).collect();
        let layer = match &self.toon {
            Some(toon) => toon.draw(&fine, ss, task)?,
            None => surface::draw(&shells, &fine, &studio, task)?,
        };
        let pen = (camera.width as f32 / 520.0).clamp(0.7, 2.5);
        let drawing = scene.look.debug.then(|| overlay::draw(scene, camera, pen));
        let mut bundles: Vec<Bundle> = match &drawing {
            Some(drawing) => drawing.wires.iter().map(|w| w.bundle(ss as f32)).collect(),
            None => scene.hair().map(|(_, hair)| bundle(hair, fine.scale)).collect(),
        };
        let flat: Vec<Vec<Vec3>> = match &self.toon {
            Some(toon) => scene.hair().map(|(_, hair)| toon.strands(hair, &fine)).collect(),
            None => vec![],
        };
        for (bundle, colours) in bundles.iter_mut().zip(&flat) {
            bundle.ink = Ink::Flat(colours);
        }
        let canvas = Canvas {
            camera: &fine,
            supersample: ss,
            studio: &studio,
            layer: &layer,
            solid: if drawing.is_some() { 0.45 } else { 1.0 },
            background: paper.to_linear(),
            fade: fade(scene),
        };
        steps.step()?;
        let pixels = raster::draw(&bundles, &canvas, task)?;
        steps.step()?;
        Ok((pixels, drawing.map_or_else(|| overlay::notes(scene, camera), |d| d.labels)))
    }
}

/// `scale`: pixels per cm of a strand's width.
fn bundle(hair: &crate::scene::Hair, scale: f32) -> Bundle<'_> {
    let width = hair.material.width * scale;
    Bundle {
        points: &hair.strands.points,
        offsets: &hair.strands.offsets,
        width: [width, width * hair.material.taper],
        ink: Ink::Hair(Coat::new(&hair.material), &hair.strands.roots),
    }
}

/// All words, the scale bar and the legend.
#[expect(clippy::too_many_arguments, reason = "one step of `sheet`, cut out for length")]
fn letter(
    picture: &mut Picture,
    scene: &Scene,
    views: &[View],
    layout: &Layout,
    options: &SheetOptions,
    framing: &Framing,
    paper: &Paper,
    labels: &[(Camera, Vec<Label>)],
) {
    let Some(mut pixmap) = Pixmap::new(picture.width, picture.height) else { return };
    let shown = labels.iter().all(|(_, words)| words.is_empty()).then_some(options.height);
    let written = layout.written(shown);
    copy_rows(&mut picture.pixels, pixmap.data_mut(), &written, |rgb, rgba| {
        rgba.copy_from_slice(&[rgb[0], rgb[1], rgb[2], 255]);
    });
    let (w, h) = (layout.width as f32, layout.height as f32);
    let (size, margin) = (layout.letter, layout.margin as f32);
    let title = lettering::fitted(&scene.name, 1.5 * size, w - 2.0 * margin);
    lettering::write(&mut pixmap, &title, margin, 2.2 * size, 1.5 * size, Anchor::Start, paper.ink);
    let figures = lettering::fitted(&figures(scene), 0.85 * size, w - 2.0 * margin);
    lettering::write(&mut pixmap, &figures, margin, 3.7 * size, 0.85 * size, Anchor::Start, paper.quiet);
    for (i, (&view, (camera, words))) in views.iter().zip(labels).enumerate() {
        let (x, y) = layout.corner(i, options);
        let (x, y) = (x as f32, y as f32);
        let name = lettering::fitted(view.text(), size, options.width as f32);
        let (middle, base) = (x + 0.5 * options.width as f32, y + options.height as f32 + 1.2 * size);
        lettering::write(&mut pixmap, &name, middle, base, size, Anchor::Middle, paper.quiet);
        for word in words {
            let at = camera.project(word.at);
            let inside = at.x > 0.0 && at.y > size && at.x < camera.width as f32 && at.y < camera.height as f32;
            if inside {
                let text = lettering::fitted(&word.text, 0.8 * size, camera.width as f32 - at.x);
                let (left, base) = (x + at.x, y + at.y - 3.0);
                lettering::write_over(&mut pixmap, &text, left, base, 0.8 * size, word.colour, paper.paper);
            }
        }
    }
    let scale = camera(Mat3::IDENTITY, Vec3::ZERO, framing, options).scale;
    let base = h - 1.3 * size;
    let end = scale_bar(&mut pixmap, scale, margin, base, options.width as f32 * 0.4, size, paper.quiet);
    if scene.look.debug {
        legend(&mut pixmap, scene, end + 2.5 * size, base, w - margin, size, paper.quiet);
    }
    copy_rows(&mut picture.pixels, pixmap.data_mut(), &written, |rgb, rgba| rgb.copy_from_slice(&rgba[..3]));
}

/// Calls `copy` for every pixel of some rows of a picture and of a pixmap.
fn copy_rows(rgb: &mut [u8], rgba: &mut [u8], written: &[bool], copy: impl Fn(&mut [u8], &mut [u8]) + Sync) {
    let width = rgb.len() / written.len().max(1) / 3;
    let rows = rgb.par_chunks_exact_mut(3 * width.max(1)).zip(rgba.par_chunks_exact_mut(4 * width.max(1)));
    rows.zip(written).filter(|(_, written)| **written).for_each(|((rgb, rgba), _)| {
        for (rgb, rgba) in rgb.chunks_exact_mut(3).zip(rgba.chunks_exact_mut(4)) {
            copy(rgb, rgba);
        }
    });
}

pub(super) fn to_pixmap(picture: &Picture) -> Option<Pixmap> {
    let bytes = picture.pixels.chunks_exact(3).flat_map(|c| [c[0], c[1], c[2], 255]).collect();
    Pixmap::from_vec(bytes, tiny_skia::IntSize::from_wh(picture.width, picture.height)?)
}

pub(super) fn fill(pixmap: &mut Pixmap, x: f32, y: f32, w: f32, h: f32, colour: Colour) {
    let mut paint = Paint { anti_alias: false, ..Paint::default() };
    if let (Some(rect), Some(c)) =
        (Rect::from_xywh(x.round(), y.round(), w, h), tiny_skia::Color::from_rgba(colour.r, colour.g, colour.b, 1.0))
    {
        paint.set_color(c);
        pixmap.fill_rect(rect, &paint, Transform::identity(), None);
    }
}

/// A bar of a round number of cm, at most `room` pixels long; returns where its text ends.
fn scale_bar(pixmap: &mut Pixmap, scale: f32, x: f32, y: f32, room: f32, size: f32, colour: Colour) -> f32 {
    let lengths = [100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1];
    let cm = lengths.into_iter().find(|cm| cm * scale <= room).unwrap_or(0.1);
    let (length, tick) = (cm * scale, (0.35 * size).round());
    let line = (size / 12.0).round().max(1.0);
    fill(pixmap, x, y, length, line, colour);
    fill(pixmap, x, y - tick, line, tick, colour);
    fill(pixmap, x + length - line, y - tick, line, tick, colour);
    let text = format!("{cm} cm");
    let from = x + length + 0.6 * size;
    lettering::write(pixmap, &text, from, y + line, 0.85 * size, Anchor::Start, colour);
    from + lettering::width(&text, 0.85 * size)
}

/// Which colour means which stage.
fn legend(pixmap: &mut Pixmap, scene: &Scene, mut x: f32, y: f32, end: f32, size: f32, colour: Colour) {
    let mut seen = [false; 256];
    for (_, hair) in scene.hair() {
        for &stage in &hair.guides.stage {
            seen[stage as usize] = true;
        }
    }
    for stage in (0..=255_u8).filter(|&s| seen[s as usize]) {
        let text = if stage == 0 { "not bent".to_owned() } else { format!("stage {stage}") };
        let width = lettering::width(&text, 0.85 * size);
        if x + 1.2 * size + width > end {
            break;
        }
        fill(pixmap, x, y - 0.6 * size, (0.8 * size).round(), (0.8 * size).round(), overlay::stage_colour(stage));
        lettering::write(pixmap, &text, x + 1.2 * size, y + 1.0, 0.85 * size, Anchor::Start, colour);
        x += 1.2 * size + width + 1.6 * size;
    }
}

/// How much hair, how long.
fn figures(scene: &Scene) -> String {
    let (mut count, mut total, mut longest) = (0_usize, 0.0_f64, 0.0_f32);
    for (_, hair) in scene.hair() {
        let strands = if scene.look.debug { &hair.guides } else { &hair.strands };
        count += strands.count();
        let lengths: Vec<f32> = (0..strands.count()).into_par_iter().map(|i| strands.length(i)).collect();
        for length in lengths {
            total += f64::from(length);
            longest = longest.max(length);
        }
    }
    let what = if scene.look.debug { "guides" } else { "strands" };
    let mut words = Vec::new();
    let (mut tufts, mut triangles) = (0, 0);
    for (_, locks) in scene.locks() {
        tufts += locks.tufts.count();
        triangles += locks.mesh.mesh.triangles.len();
    }
    if triangles > 0 {
        words.push(format!("{} tufts · {} triangles", grouped(tufts), grouped(triangles)));
    }
    if count > 0 {
        let mean = total / count as f64;
        words.push(format!("{} {what} · mean {mean:.1} cm · longest {longest:.1} cm", grouped(count)));
    }
    if words.is_empty() && scene.hair().next().is_none() {
        let surfaces = scene.parts.iter().filter_map(|p| match &p.body {
            Body::Mesh(mesh, _) => Some(mesh.triangles.len()),
            Body::Hair(_) | Body::Locks(_) => None,
        });
        words.push(format!("{} triangles", grouped(surfaces.sum())));
    }
    if words.is_empty() { format!("no {what}") } else { words.join(" · ") }
}

/// A number with a mark between thousands: `40,000`.
pub fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(c);
    }
    out
}

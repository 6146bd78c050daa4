//! The toon look: flat tones, a band of light along the hair, and ink lines that taper towards tips.
//!
//! Every surface has two or three tones, parted by the angle to one lamp over the viewer's left shoulder; skin is in the
//! shade of hair too. The band of light lies where the lock's direction is square to the half vector between lamp and
//! viewer (the cone of Kajiya and Kay 1989, cut off at a threshold), so it goes on from lock to lock; on each it is
//! broadest in the middle. Lines are found in the picture (Saito and Takahashi 1990): where one lock or body ends before
//! another, and where one body's depth jumps; each is drawn with a round pen whose width follows the place along the lock
//! and the depth of the step.
//!
//! A view goes band by band: [`raster`] finds what is nearest, [`shade`] gives it a tone, [`ink`] finds the lines. What a
//! band leaves behind is one word per sample; lines are laid over it and samples averaged when all bands are done.

mod ink;
mod raster;
mod shade;

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::Mesh;
use crate::math::trig;
use crate::scene::{Body, Hair, LockKind, Scene, TuftMaterial};
use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::fast;
use super::surface::Layer;
use ink::Ink;
use shade::{Light, Shaded};

/// Direction to the lamp: right, up, toward the viewer.
const LAMP: Vec3 = Vec3::new(-0.42, 0.74, 0.62);
/// Rows of samples that one task draws, rounded to whole pixels.
const BAND: usize = 32;

/// The colours of one lock or body, linear.
#[derive(Clone, Copy, Debug)]
struct Tones {
    /// In the light: at the root and at the tip.
    lit: [Vec3; 2],
    /// What the lit colour is multiplied with in the shade, and in the depth.
    shade: [Vec3; 2],
    /// Has the third tone.
    deep: bool,
    /// The band of light.
    light: Vec3,
    ink: Vec3,
    /// Half width of the band, as a cosine; 0 for none.
    band: f32,
}

impl Tones {
    fn of_skin(albedo: Vec3) -> Self {
        let shade = Vec3::new(0.80, 0.60, 0.54);
        let ink = albedo * Vec3::new(0.10, 0.045, 0.04);
        Self { lit: [albedo; 2], shade: [shade, shade * shade], deep: false, light: albedo, ink, band: 0.0 }
    }

    fn of_tuft(material: &TuftMaterial) -> Self {
        let lit = [material.along(0.0), material.along(1.0)];
        let base = lit[0].max(Vec3::splat(1e-4));
        // Shade leans to blue, as under a sky.
        let cool = Vec3::new(0.46, 0.45, 0.56);
        let shade = material.shade.map_or(cool, |c| c.to_linear() / base);
        // The hair's own colour as bright as it goes; what is bright already turns whiter instead.
        let more = (0.95 / lit[0].max_element().max(1e-3)).clamp(1.0, 2.4);
        let pale = (lit[0] * more).lerp(Vec3::ONE, 0.46 - 0.30 * (more - 1.0) / 1.4);
        let light = material.light.map_or(pale, |c| c.to_linear());
        let ink = material.ink.map_or(lit[0] * 0.10 + Vec3::splat(0.002), |c| c.to_linear());
        let deep = material.tones > 2;
        Self { lit, shade: [shade, shade * cool], deep, light, ink, band: 0.30 * material.shine }
    }

    /// The colour at a place: `along` the lock, from 0 to 1 how much of it is lit, not deep and bright.
    fn at(&self, along: f32, lit: f32, raised: f32, bright: f32) -> Vec3 {
        let colour = if self.lit[0] == self.lit[1] {
            self.lit[0]
        } else {
            self.lit[0].lerp(self.lit[1], trig::smoothstep(0.25, 0.95, along))
        };
        let dark = self.shade[1].lerp(self.shade[0], raised);
        (colour * dark.lerp(Vec3::ONE, lit)).lerp(self.light, bright)
    }
}

/// A lock, or a whole body.
#[derive(Clone, Copy, Debug)]
struct Lock {
    tones: Tones,
    /// Skin and what else is no hair.
    skin: bool,
    /// A tuft: lines taper towards the tip and fade out at the root.
    tapers: bool,
}

/// A vertex of any surface.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    position: Vec3,
    normal: Vec3,
    /// From root to tip, unit; zero on skin.
    grain: Vec3,
    /// Place along the lock.
    along: f32,
    /// From the middle of the side that is seen (0) to the lock's edges (1).
    across: f32,
}

/// A scene, made ready for the toon look.
#[derive(Debug)]
pub struct Toon {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
    /// Per triangle.
    lock_of: Vec<u32>,
    locks: Vec<Lock>,
    /// About the middle of the skull: what hair is taken to lie around.
    centre: Vec3,
}

/// How the samples of a view become pixels.
#[derive(Clone, Copy, Debug)]
pub struct Paper {
    /// Linear colour behind everything.
    pub background: Vec3,
    /// Height above the lower border, as a fraction of the picture's, over which all fades into the background.
    pub fade: f32,
}

/// A view as samples: bands of rows, with the ink that goes over them.
struct Drawn {
    width: usize,
    /// Rows per band.
    rows: usize,
    bands: Vec<Shaded>,
    ink: Ink,
}

impl Toon {
    /// From all surfaces of a scene.
    pub fn new(scene: &Scene) -> Self {
        let mut toon = Self { vertices: vec![], triangles: vec![], lock_of: vec![], locks: vec![], centre: Vec3::ZERO };
        let mut top = 0.0_f32;
        for part in &scene.parts {
            let first = toon.locks.len() as u32;
            match &part.body {
                Body::Mesh(mesh, material) => {
                    top = mesh.positions.iter().map(|p| p.y).filter(|y| y.is_finite()).fold(top, f32::max);
                    let tones = Tones::of_skin(material.colour.to_linear());
                    toon.locks.push(Lock { tones, skin: true, tapers: false });
                    toon.add(mesh, |_| (0.0, 0.0), |_| first);
                }
                Body::Locks(locks) => {
                    let tapers = locks.kind == LockKind::Tufts;
                    toon.locks.extend((0..locks.count()).map(|i| Lock {
                        tones: Tones::of_tuft(locks.look(i)),
                        skin: false,
                        tapers,
                    }));
                    let place = |v: usize| {
                        let place = locks.place(v);
                        // The seam lies on the side that faces the head.
                        (place.y, if tapers { (4.0 * (place.x - 0.5).abs()).min(1.0) } else { 0.5 })
                    };
                    let of = &locks.mesh.tuft;
                    toon.add(&locks.mesh.mesh, place, |t| first + of[locks.mesh.mesh.triangles[t][0] as usize]);
                }
                Body::Hair(_) => {}
            }
        }
        toon.centre = Vec3::new(0.0, 0.35 * top, -0.05 * top);
        toon
    }

    fn add(&mut self, mesh: &Mesh, place: impl Fn(usize) -> (f32, f32) + Sync, lock: impl Fn(usize) -> u32) {
        let own;
        let normals = if mesh.normals.len() == mesh.positions.len() {
            &mesh.normals
        } else {
            let mut copy = mesh.clone();
            copy.compute_normals();
            own = copy.normals;
            &own
        };
        let places: Vec<(f32, f32)> = (0..mesh.positions.len()).into_par_iter().map(&place).collect();
        let first = self.vertices.len() as u32;
        let grains = grain(mesh, &places);
        self.vertices.extend((0..mesh.positions.len()).map(|v| Vertex {
            position: mesh.positions[v],
            normal: normals[v],
            grain: grains[v],
            along: places[v].0,
            across: places[v].1,
        }));
        self.lock_of.extend((0..mesh.triangles.len()).map(lock));
        self.triangles.extend(mesh.triangles.iter().map(|t| [t[0] + first, t[1] + first, t[2] + first]));
    }

    fn lock(&self, triangle: u32) -> &Lock {
        &self.locks[self.lock_of[triangle as usize] as usize]
    }

    /// All samples of a view; `per_pixel` of them to each side of a pixel of the picture, `depths` when they are wanted.
    fn samples(&self, camera: &Camera, per_pixel: usize, depths: bool, task: &Task) -> Result<Drawn, Cancelled> {
        let light = Light::new(self, camera, task)?;
        let rows = BAND.div_ceil(per_pixel) * per_pixel;
        let screen = raster::Screen::new(self, camera.width, camera.height, rows, |p| camera.project(p));
        task.check()?;
        let pen = ink::pen(camera.width, per_pixel);
        let words = shade::words(self);
        let drawn: Result<Vec<(Shaded, Vec<ink::Drop>)>, Cancelled> = (0..screen.bands())
            .into_par_iter()
            .map(|band| {
                task.check()?;
                let nearest = screen.nearest(band, 1);
                let mut shaded = shade::band(self, &screen, &nearest, &light, &words, depths);
                let drops = ink::edges(self, &screen, &nearest, &shaded.locks, camera.scale, pen);
                shaded.locks = vec![];
                Ok((shaded, drops))
            })
            .collect();
        let (bands, mut drops): (Vec<Shaded>, Vec<Vec<ink::Drop>>) = drawn?.into_iter().unzip();
        ink::folds(self, &bands, &mut drops, camera, rows, pen);
        ink::tidy(self, &mut drops, camera.width);
        Ok(Drawn { width: camera.width, rows, bands, ink: Ink::new(drops, rows) })
    }

    /// Draws all surfaces for strands to pass before and behind; `supersample` are pixels of the camera per pixel of the
    /// picture.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn draw(&self, camera: &Camera, supersample: usize, task: &Task) -> Result<Layer, Cancelled> {
        let finer = finer(supersample);
        let fine = camera.enlarged(finer);
        let drawn = self.samples(&fine, supersample * finer, true, task)?;
        let bands: Vec<Layer> = (0..drawn.bands.len()).into_par_iter().map(|b| self.layer(&drawn, b, finer)).collect();
        let mut layer = Layer { width: camera.width, depth: vec![], cover: vec![], colour: vec![] };
        for band in bands {
            layer.depth.extend(band.depth);
            layer.cover.extend(band.cover);
            layer.colour.extend(band.colour);
        }
        Ok(layer)
    }

    /// One band as a layer of `finer` times fewer pixels.
    fn layer(&self, drawn: &Drawn, band: usize, finer: usize) -> Layer {
        let shaded = &drawn.bands[band];
        let (wet, depths) = drawn.ink.laid(band, drawn.width, shaded.rows, true);
        let (width, height) = (drawn.width / finer, shaded.rows / finer);
        let count = width * height;
        let mut layer = Layer { width, depth: vec![], cover: vec![], colour: Vec::with_capacity(count) };
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut cover, mut depth) = (Vec3::ZERO, 0.0, f32::NEG_INFINITY);
                for k in 0..finer * finer {
                    let i = (y * finer + k / finer) * drawn.width + x * finer + k % finer;
                    let (below, there) = shade::unpack(shaded.samples[i]);
                    let (wetness, colour) = self.wet(wet[i]);
                    sum += below * (there * (1.0 - wetness)) + colour * wetness;
                    cover += there + (1.0 - there) * wetness;
                    depth = depth.max(shaded.depths[i]).max(depths[i]);
                }
                layer.colour.push(if cover > 0.0 { sum / cover } else { Vec3::ZERO });
                layer.cover.push(cover / (finer * finer) as f32);
                layer.depth.push(depth);
            }
        }
        layer
    }

    /// Draws all surfaces where there are no strands: sRGB bytes, row by row. `camera` is that of the picture.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn picture(
        &self,
        camera: &Camera,
        supersample: usize,
        paper: Paper,
        task: &Task,
    ) -> Result<Vec<u8>, Cancelled> {
        let per_pixel = supersample * finer(supersample);
        let fine = camera.enlarged(per_pixel);
        let drawn = self.samples(&fine, per_pixel, false, task)?;
        let mut bytes = vec![0; camera.width * camera.height * 3];
        let band_bytes = camera.width * 3 * (drawn.rows / per_pixel);
        bytes.par_chunks_mut(band_bytes).enumerate().for_each(|(band, out)| {
            let shaded = &drawn.bands[band];
            let (wet, _) = drawn.ink.laid(band, drawn.width, shaded.rows, false);
            let share = 1.0 / (per_pixel * per_pixel) as f32;
            for (y, row) in out.chunks_exact_mut(camera.width * 3).enumerate() {
                let above = (camera.height - band * drawn.rows / per_pixel - y) as f32 - 0.5;
                let keep = match paper.fade {
                    fade if fade > 0.0 => trig::smoothstep(0.0, fade, above / camera.height as f32),
                    _ => 1.0,
                };
                // Most pixels are flat, and as the one before.
                let (mut flat, mut last) = (u32::MAX, [0; 3]);
                for x in 0..camera.width {
                    let first = y * per_pixel * drawn.width + x * per_pixel;
                    let word = shaded.samples[first];
                    let mut even = true;
                    for j in 0..per_pixel {
                        let from = first + j * drawn.width;
                        let row = from..from + per_pixel;
                        even &=
                            shaded.samples[row.clone()].iter().all(|s| *s == word) && wet[row].iter().all(|w| *w == 0);
                    }
                    if !(even && word == flat) {
                        let mut sum = Vec3::ZERO;
                        for j in 0..per_pixel {
                            let from = first + j * drawn.width;
                            let row = from..from + per_pixel;
                            for (&sample, &wet) in shaded.samples[row.clone()].iter().zip(&wet[row]) {
                                let (mut colour, there) = shade::unpack(sample);
                                if there == 0.0 {
                                    colour = paper.background;
                                }
                                if wet != 0 {
                                    let (wetness, ink) = self.wet(wet);
                                    colour = colour.lerp(ink, wetness);
                                }
                                sum += colour;
                            }
                        }
                        let mean = sum * share;
                        last = fast::encode(paper.background + (mean - paper.background) * keep);
                        flat = if even { word } else { u32::MAX };
                    }
                    row[3 * x..3 * x + 3].copy_from_slice(&last);
                }
            }
        });
        Ok(bytes)
    }

    /// How much ink there is, and its colour.
    fn wet(&self, word: u32) -> (f32, Vec3) {
        let (cover, lock) = ink::split(word);
        (cover, self.locks[lock as usize].tones.ink)
    }

    /// Flat colours for every node of some strands.
    pub fn strands(&self, hair: &Hair, camera: &Camera) -> Vec<Vec3> {
        let lamp = camera.to_world(LAMP.normalize());
        let half = (lamp + camera.toward).normalize_or(lamp);
        let material = TuftMaterial {
            colour: hair.material.root_colour,
            tip_colour: Some(hair.material.tip_colour),
            shine: hair.material.shine,
            ..TuftMaterial::default()
        };
        let tones = Tones::of_tuft(&material);
        let strands = &hair.strands;
        let mut colours = vec![Vec3::ZERO; strands.points.len()];
        for i in 0..strands.count() {
            let range = strands.range(i);
            let points = &strands.points[range.clone()];
            let last = points.len().saturating_sub(1);
            // Every few strands are drawn as one pencil line.
            let id = strands.roots.get(i).map_or(0, |r| r.id);
            let dark = if (id ^ (id >> 17)) & 15 == 0 { 0.55 } else { 1.0 };
            for (k, &p) in points.iter().enumerate() {
                let out = (p - self.centre).normalize_or(lamp);
                let tangent = (points[(k + 1).min(last)] - points[k.saturating_sub(1)]).normalize_or_zero();
                let lit = f32::from(out.dot(lamp) > -0.02);
                let off = (tangent.dot(half) - 0.10).abs();
                let bright = f32::from(off < 0.5 * tones.band && out.dot(half) > 0.7) * lit;
                colours[range.start + k] = tones.at(k as f32 / last.max(1) as f32, lit, 1.0, bright) * dark;
            }
        }
        colours
    }
}

/// How many samples there are to each side of a pixel of the camera: four in all at least per pixel of the picture.
fn finer(supersample: usize) -> usize {
    if supersample < 2 { 2 } else { 1 }
}

/// Per vertex the direction in which `along` grows fastest on the surface, unit or zero.
fn grain(mesh: &Mesh, places: &[(f32, f32)]) -> Vec<Vec3> {
    let mut sum = vec![Vec3::ZERO; mesh.positions.len()];
    for (i, t) in mesh.triangles.iter().enumerate() {
        let v = t.map(|v| places[v as usize].0);
        if v[0] == v[1] && v[1] == v[2] {
            continue;
        }
        let [a, b, c] = mesh.corners(i);
        let normal = (b - a).cross(c - a);
        // Gradient of the linear function over the triangle, times its area squared.
        let gradient = normal.cross(c - b) * v[0] + normal.cross(a - c) * v[1] + normal.cross(b - a) * v[2];
        let gradient = gradient / normal.length().max(1e-12);
        for v in t {
            sum[*v as usize] += gradient;
        }
    }
    sum.into_iter().map(Vec3::normalize_or_zero).collect()
}

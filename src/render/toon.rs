//! The toon look: flat tones, a band of light along the hair, and ink lines that taper towards tips.
//!
//! Every surface has two tones, parted by the angle to one lamp over the viewer's left shoulder; skin is in the shade of
//! hair too. The band of light lies where the lock's direction is square to the half vector between lamp and viewer
//! (the cone of Kajiya and Kay 1989, cut off at a threshold). Lines are found in the picture (Saito and Takahashi 1990):
//! where one lock or body ends before another, and where one body's depth jumps; each is drawn with a round pen whose
//! width follows the place along the lock and the depth of the step.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::geometry::Mesh;
use crate::scene::{Body, Hair, LockKind, Scene, TuftMaterial};
use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::shadow::Depths;
use super::surface::{self, BAND, Face, Faces, Layer, SAMPLES};

/// Direction to the lamp: right, up, toward the viewer.
const LAMP: Vec3 = Vec3::new(-0.42, 0.74, 0.62);
/// Width of a full line in pixels of a picture 640 pixels wide.
const LINE: f32 = 2.1;
/// A step in depth within one body that draws a line, cm.
const STEP: f32 = 0.45;
/// Half the width of the border between two tones, as a cosine: no wider than a pixel or two.
const BORDER: f32 = 0.007;
/// Height of a fold of the skin that draws a line, cm.
const FOLD: f32 = 0.42;
/// No surface.
const NOTHING: u32 = u32::MAX;

/// The colours of one material, linear.
#[derive(Clone, Copy, Debug)]
struct Tones {
    /// In the light: at the root and at the tip.
    lit: [Vec3; 2],
    /// What the lit colour is multiplied with in the shade.
    shade: Vec3,
    /// The band of light.
    light: Vec3,
    ink: Vec3,
    /// Half width of the band, as a cosine; 0 for none.
    band: f32,
}

impl Tones {
    fn of_skin(albedo: Vec3) -> Self {
        let shade = Vec3::new(0.80, 0.60, 0.54);
        Self { lit: [albedo; 2], shade, light: albedo, ink: albedo * Vec3::new(0.10, 0.045, 0.04), band: 0.0 }
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
        Self { lit, shade, light, ink, band: 0.30 * material.shine }
    }

    /// The colour at a place: `along` the lock, `lit` and `bright` from 0 to 1.
    fn at(&self, along: f32, lit: f32, bright: f32) -> Vec3 {
        let colour = self.lit[0].lerp(self.lit[1], crate::math::trig::smoothstep(0.25, 0.95, along));
        colour.lerp(colour * self.shade, 1.0 - lit).lerp(self.light, bright)
    }
}

/// One body of the scene, ready to be drawn.
#[derive(Debug)]
struct Figure {
    mesh: Mesh,
    /// Per vertex: direction from root to tip (zero on skin), place along.
    grain: Vec<(Vec3, f32)>,
    /// Per vertex: its lock; empty for skin.
    locks: Vec<u32>,
    /// Per lock, or one.
    tones: Vec<Tones>,
    /// Tufts: lines taper towards the tip and fade out at the root.
    tapers: bool,
}

impl Figure {
    fn lock(&self, triangle: usize) -> u32 {
        if self.locks.is_empty() { 0 } else { self.locks[self.mesh.triangles[triangle][0] as usize] }
    }

    fn tones(&self, lock: u32) -> &Tones {
        &self.tones[lock as usize]
    }
}

/// A scene, made ready for the toon look.
#[derive(Debug)]
pub struct Toon {
    figures: Vec<Figure>,
    /// About the middle of the skull: what hair is taken to lie around.
    centre: Vec3,
}

/// What is seen in a pixel.
#[derive(Clone, Copy)]
struct Seen {
    /// Figure and lock; [`NOTHING`] for none.
    id: [u32; 2],
    z: f32,
    /// Change of depth per pixel to the right and downward.
    slope: Vec2,
    along: f32,
    /// How much the surface faces up.
    tilt: f32,
}

const UNSEEN: Seen = Seen { id: [NOTHING; 2], z: f32::NEG_INFINITY, slope: Vec2::ZERO, along: 0.0, tilt: 0.0 };

/// A drop of ink: middle and radius in pixels, colour, depth.
#[derive(Clone, Copy)]
struct Drop {
    at: Vec2,
    radius: f32,
    colour: Vec3,
    z: f32,
}

impl Toon {
    /// From all surfaces of a scene.
    pub fn new(scene: &Scene) -> Self {
        let mut figures = Vec::new();
        let mut top = 0.0_f32;
        for part in &scene.parts {
            match &part.body {
                Body::Mesh(mesh, material) => {
                    let mut mesh = Mesh::clone(mesh);
                    if mesh.normals.len() != mesh.positions.len() {
                        mesh.compute_normals();
                    }
                    top = mesh.positions.iter().map(|p| p.y).filter(|y| y.is_finite()).fold(top, f32::max);
                    let grain = vec![(Vec3::ZERO, 0.0); mesh.positions.len()];
                    let tones = vec![Tones::of_skin(material.colour.to_linear())];
                    figures.push(Figure { mesh, grain, locks: vec![], tones, tapers: false });
                }
                Body::Locks(locks) => {
                    let mesh = locks.mesh.mesh.clone();
                    let along: Vec<f32> = (0..mesh.positions.len()).map(|v| locks.place(v).y).collect();
                    let grain = grain(&mesh, &along).into_iter().zip(along).collect();
                    let tones = (0..locks.count()).map(|i| Tones::of_tuft(locks.look(i))).collect();
                    let tapers = locks.kind == LockKind::Tufts;
                    figures.push(Figure { mesh, grain, locks: locks.mesh.tuft.clone(), tones, tapers });
                }
                Body::Hair(_) => {}
            }
        }
        Self { figures, centre: Vec3::new(0.0, 0.35 * top, -0.05 * top) }
    }

    /// Draws all surfaces; `supersample` are pixels of the camera per pixel of the picture.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn draw(&self, camera: &Camera, supersample: usize, task: &Task) -> Result<Layer, Cancelled> {
        let (width, height) = (camera.width, camera.height);
        let Faces { faces, of_band } = surface::faces(self.figures.iter().map(|f| &f.mesh), camera, task)?;
        let lamp = camera.to_world(LAMP.normalize());
        let meshes: Vec<&Mesh> = self.figures.iter().map(|f| &f.mesh).collect();
        let light = Light { lamp, half: (lamp + camera.toward).normalize_or(lamp), shadow: Depths::new(&meshes, lamp) };
        let bands: Result<Vec<(Layer, Vec<Seen>)>, Cancelled> = of_band
            .par_iter()
            .enumerate()
            .map(|(band, list)| {
                task.check()?;
                let top = band * BAND;
                Ok(self.band(&faces, list, camera, &light, top, BAND.min(height - top)))
            })
            .collect();
        let mut layer = Layer { width, depth: Vec::new(), cover: Vec::new(), colour: Vec::new() };
        let mut seen = Vec::with_capacity(width * height);
        for (band, some) in bands? {
            layer.depth.extend(band.depth);
            layer.cover.extend(band.cover);
            layer.colour.extend(band.colour);
            seen.extend(some);
        }
        let pen = LINE * (width as f32 / 640.0).max(0.55 * supersample as f32);
        let reach = (FOLD * camera.scale).round().max(1.0) as usize;
        let drops: Vec<Vec<Drop>> = (0..height)
            .into_par_iter()
            .map(|y| {
                let mut drops = self.edges(&seen, width, y, pen);
                self.folds(&seen, width, y, reach, pen, &mut drops);
                drops
            })
            .collect();
        ink(&mut layer, height, &drops);
        Ok(layer)
    }

    /// Tones of `rows` rows, and what is seen in their pixels.
    fn band(
        &self,
        faces: &[Face],
        list: &[u32],
        camera: &Camera,
        light: &Light,
        top: usize,
        rows: usize,
    ) -> (Layer, Vec<Seen>) {
        let (width, n) = (camera.width, SAMPLES.len());
        let (depth, owner) = surface::nearest(faces, list, width, top, rows);
        let count = width * rows;
        let mut layer = Layer {
            width,
            depth: vec![f32::NEG_INFINITY; count],
            cover: vec![0.0; count],
            colour: vec![Vec3::ZERO; count],
        };
        let mut seen = vec![UNSEEN; count];
        for i in 0..count {
            let owners = &owner[i * n..(i + 1) * n];
            if owners.iter().all(|&o| o == u32::MAX) {
                continue;
            }
            let pixel = Vec2::new((i % width) as f32, (top + i / width) as f32);
            // The samples of each lock are shaded together, once.
            let id = |o: u32| {
                faces.get(o as usize).map(|f| [f.shell, self.figures[f.shell as usize].lock(f.triangle as usize)])
            };
            let ids: [Option<[u32; 2]>; 4] = std::array::from_fn(|s| id(owners[s]));
            let (mut most, mut z, mut hits) = (0, f32::NEG_INFINITY, 0);
            for s in 0..n {
                let Some(this) = ids[s] else { continue };
                if ids[..s].contains(&ids[s]) {
                    continue;
                }
                let figure = &self.figures[this[0] as usize];
                let (mut point, mut normal, mut grain, mut along, mut deep, mut weight) =
                    (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, 0.0, 0.0, 0);
                for k in s..n {
                    if ids[k] != Some(this) {
                        continue;
                    }
                    let face = &faces[owners[k] as usize];
                    let Some(w) = surface::weights(&face.corners, pixel + SAMPLES[k]) else { continue };
                    let t = figure.mesh.triangles[face.triangle as usize].map(|v| v as usize);
                    for (&v, w) in t.iter().zip(w) {
                        point += figure.mesh.positions[v] * w;
                        normal += figure.mesh.normals[v] * w;
                        grain += figure.grain[v].0 * w;
                        along += figure.grain[v].1 * w;
                    }
                    deep += depth[i * n + k];
                    weight += 1;
                }
                if weight == 0 {
                    continue;
                }
                let share = 1.0 / weight as f32;
                let mut facing = normal.normalize_or(camera.toward);
                if facing.dot(camera.toward) < -0.25 {
                    facing = -facing;
                }
                let place = Place { point: point * share, normal: facing, grain, along: along * share };
                let colour = self.shade(figure, this[1], &place, light);
                layer.colour[i] += colour * weight as f32;
                hits += weight;
                z = z.max(deep * share);
                if weight > most {
                    most = weight;
                    // Depth falls along the picture as the surface turns away.
                    let toward = facing.dot(camera.toward).max(0.12);
                    let slope = Vec2::new(-facing.dot(camera.right), facing.dot(camera.up)) / (toward * camera.scale);
                    let tilt = facing.dot(camera.up);
                    seen[i] = Seen { id: this, z: deep * share, slope, along: place.along, tilt };
                }
            }
            if hits > 0 {
                layer.colour[i] /= hits as f32;
                layer.cover[i] = hits as f32 / n as f32;
                layer.depth[i] = z;
            }
        }
        (layer, seen)
    }

    fn shade(&self, figure: &Figure, lock: u32, place: &Place, light: &Light) -> Vec3 {
        let tones = figure.tones(lock);
        let out = (place.point - self.centre).normalize_or(place.normal);
        let step = |x: f32| crate::math::trig::smoothstep(-BORDER, BORDER, x);
        if figure.locks.is_empty() {
            // Skin: features are drawn by lines; the lamp sees the head's large form.
            let n = (place.normal * 0.55 + out * 0.45).normalize_or(place.normal);
            let lit = step(n.dot(light.lamp) + 0.06);
            let free = step(light.shadow.sample(place.point + place.normal * 0.25 + light.lamp * 0.15) - 0.5);
            return tones.at(0.0, lit * free, 0.0);
        }
        // Locks that lie on the head share its light; what each of them adds keeps them apart.
        let n = (place.normal * 0.68 + out * 0.32).normalize_or(place.normal);
        let lit = step(n.dot(light.lamp) - 0.02);
        let bright = if tones.band > 0.0 {
            // Each lock has its own place for the band, a little.
            let shift = ((lock.wrapping_mul(0x9e37_79b9) >> 16) & 0xff) as f32 / 255.0 - 0.5;
            let grain = place.grain.normalize_or_zero();
            let off = (grain.dot(light.half) - 0.10 - 0.10 * shift).abs();
            let facing = n.dot(light.half) - 0.80 + 0.25 * tones.band;
            step(tones.band * 0.55 - off).min(step(facing)) * lit * f32::from(grain != Vec3::ZERO)
        } else {
            0.0
        };
        tones.at(place.along, lit, bright)
    }

    /// Lines that cross the border between a pixel of row `y` and its neighbours to the right and below.
    fn edges(&self, seen: &[Seen], width: usize, y: usize, pen: f32) -> Vec<Drop> {
        let mut drops = Vec::new();
        let height = seen.len() / width;
        for x in 0..width {
            let a = &seen[y * width + x];
            for (dx, dy) in [(1, 0), (0, 1)] {
                if x + dx >= width || y + dy >= height {
                    continue;
                }
                let b = &seen[(y + dy) * width + x + dx];
                if let Some((radius, colour, z)) = self.edge(a, b, Vec2::new(dx as f32, dy as f32), pen) {
                    let at = Vec2::new(x as f32 + 0.5 + 0.5 * dx as f32, y as f32 + 0.5 + 0.5 * dy as f32);
                    drops.push(Drop { at, radius, colour, z });
                }
            }
        }
        drops
    }

    /// Lines along folds of the skin that look down: lids, lips, the wings of the nose. The surface turns down and up
    /// again within [`FOLD`].
    fn folds(&self, seen: &[Seen], width: usize, y: usize, reach: usize, pen: f32, drops: &mut Vec<Drop>) {
        let height = seen.len() / width;
        if y < reach || y + reach >= height {
            return;
        }
        for x in 0..width {
            let here = &seen[y * width + x];
            let Some(figure) = self.figures.get(here.id[0] as usize).filter(|f| f.locks.is_empty()) else { continue };
            let (above, below) = (&seen[(y - reach) * width + x], &seen[(y + reach) * width + x]);
            if above.id != here.id || below.id != here.id {
                continue;
            }
            let dip = above.tilt.min(below.tilt) - here.tilt;
            // Only the bottom of the fold.
            let (up, down) = (seen[(y - 1) * width + x].tilt, seen[(y + 1) * width + x].tilt);
            if dip > 0.10 && here.tilt <= up && here.tilt <= down {
                let weight = 1.25 * crate::math::trig::smoothstep(0.02, 0.40, dip);
                let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                drops.push(Drop { at, radius: 0.5 * pen * weight, colour: figure.tones(0).ink, z: here.z });
            }
        }
    }

    /// The line between two neighbouring pixels: radius, colour, depth.
    fn edge(&self, a: &Seen, b: &Seen, step: Vec2, pen: f32) -> Option<(f32, Vec3, f32)> {
        let (front, back) = if a.z >= b.z { (a, b) } else { (b, a) };
        if front.id[0] == NOTHING {
            return None;
        }
        let figure = &self.figures[front.id[0] as usize];
        let tones = figure.tones(front.id[1]);
        // What the surfaces' own slopes do not explain of the step.
        let slope = (a.slope.dot(step)).abs().max(b.slope.dot(step).abs());
        let gap = if back.id[0] == NOTHING { f32::INFINITY } else { front.z - back.z - 1.2 * slope };
        let mut weight = if back.id[0] == NOTHING {
            1.0
        } else if front.id != back.id {
            // Locks that touch are parted by a thin line, locks that hang before others by a bold one.
            0.42 + 0.48 * crate::math::trig::smoothstep(0.0, 0.8, gap)
        } else if gap > STEP {
            0.75
        } else {
            return None;
        };
        if figure.tapers {
            weight *= 1.0 - 0.72 * crate::math::trig::smoothstep(0.55, 1.0, front.along);
            // Where a lock comes out of other hair, no line closes it off.
            let other = self.figures.get(back.id[0] as usize).filter(|f| !f.locks.is_empty());
            if other.is_some() {
                weight *= crate::math::trig::smoothstep(0.04, 0.30, front.along);
            }
        }
        (weight > 0.08).then_some((0.5 * pen * weight, tones.ink, front.z))
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
                colours[range.start + k] = tones.at(k as f32 / last.max(1) as f32, lit, bright) * dark;
            }
        }
        colours
    }
}

/// The lamp of one view.
struct Light {
    lamp: Vec3,
    half: Vec3,
    shadow: Depths,
}

/// A place on a surface.
struct Place {
    point: Vec3,
    normal: Vec3,
    grain: Vec3,
    along: f32,
}

/// Per vertex the direction in which `along` grows fastest on the surface, unit or zero.
fn grain(mesh: &Mesh, along: &[f32]) -> Vec<Vec3> {
    let mut sum = vec![Vec3::ZERO; mesh.positions.len()];
    for (i, t) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(i);
        let v = t.map(|v| along[v as usize]);
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

/// Lays drops of ink over a layer: each pixel takes the strongest.
fn ink(layer: &mut Layer, height: usize, drops: &[Vec<Drop>]) {
    let width = layer.width;
    let mut wet: Vec<(f32, Vec3, f32)> = vec![(0.0, Vec3::ZERO, f32::NEG_INFINITY); width * height];
    for drop in drops.iter().flatten() {
        let reach = drop.radius + 0.5;
        let (x0, x1) = ((drop.at.x - reach).max(0.0) as usize, ((drop.at.x + reach) as usize).min(width - 1));
        let (y0, y1) = ((drop.at.y - reach).max(0.0) as usize, ((drop.at.y + reach) as usize).min(height - 1));
        for y in y0..=y1 {
            for x in x0..=x1 {
                let distance = drop.at.distance(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                // A line thinner than a pixel covers only a part of it.
                let cover = (reach - distance).clamp(0.0, (2.0 * drop.radius).min(1.0));
                let pixel = &mut wet[y * width + x];
                if cover > pixel.0 {
                    *pixel = (cover, drop.colour, drop.z);
                }
            }
        }
    }
    for (i, (cover, colour, z)) in wet.into_iter().enumerate().filter(|(_, w)| w.0 > 0.0) {
        let before = layer.cover[i];
        let after = before + (1.0 - before) * cover;
        layer.colour[i] = (layer.colour[i] * (before * (1.0 - cover)) + colour * cover) / after;
        layer.cover[i] = after;
        layer.depth[i] = layer.depth[i].max(z);
    }
}

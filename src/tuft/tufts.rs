//! Many tufts as one value, and their mesh.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use rayon::prelude::*;

use super::detail::{Detail, Plan};
use super::skin::{self, Out, Surface};
use super::{Ground, Section, Stroke, TuftError};
use crate::geometry::{Mesh, MeshError};
use crate::math::rng::Key;

/// One lock of stylised hair.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuft {
    /// Identity: a hash of where its root lies; unique within a set of tufts.
    pub id: u64,
    /// Its centre line.
    pub stroke: Stroke,
    /// Its shape across the stroke.
    pub section: Section,
    /// Where the thickness points, unit; away from the head when not given.
    pub up: Option<Vec3>,
    /// How fine its mesh is.
    pub detail: Detail,
    /// Index into a palette that the scene has.
    pub colour: u32,
    /// Index into [`Tufts::sources`].
    pub source: u16,
    /// May run through the head.
    pub bury: bool,
}

impl Tuft {
    /// A tuft with the default tolerance of half a millimetre and the first colour.
    ///
    /// # Errors
    /// A section out of range.
    pub fn new(stroke: Stroke, section: Section) -> Result<Self, TuftError> {
        section.validate()?;
        let id = identity(stroke.root());
        Ok(Self { id, stroke, section, up: None, detail: Detail::Tolerance(0.05), colour: 0, source: 0, bury: false })
    }

    /// The same tuft along another stroke.
    #[must_use]
    pub fn along(&self, stroke: Stroke) -> Self {
        Self { id: identity(stroke.root()), stroke, section: self.section.clone(), ..*self }
    }

    /// Mirrored at the plane between the head's left and right.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let up = self.up.map(|u| Vec3::new(-u.x, u.y, u.z));
        Self { section: self.section.mirrored(), up, ..self.along(self.stroke.mirrored()) }
    }

    /// Turned about its root by `angle` radians around `axis` (unit).
    #[must_use]
    pub fn rotated(&self, axis: Vec3, angle: f32) -> Self {
        let up = self.up.map(|u| Quat::from_axis_angle(axis, angle) * u);
        Self { up, ..self.along(self.stroke.rotated(axis, angle)) }
    }

    /// `count` tufts, this one first, set around the head as [`Stroke::array`] says.
    pub fn array(&self, count: usize, axis: Vec3, step: f32, ground: &Ground) -> Vec<Self> {
        let strokes = self.stroke.array(count, axis, step, ground);
        let turned = |(i, stroke)| {
            let up = self.up.map(|u| Quat::from_axis_angle(axis, step * i as f32) * u);
            Self { up, ..self.along(stroke) }
        };
        strokes.into_iter().enumerate().map(turned).collect()
    }

    /// Its mesh alone, with uv over the whole square.
    pub fn mesh(&self) -> Mesh {
        Tufts { tufts: vec![self.clone()], sources: Vec::new() }.mesh().mesh
    }

    /// Length of the stroke from the buried start to the tip, cm.
    pub fn length(&self) -> f32 {
        self.surface().sweep.length()
    }

    /// Rings and sides of its mesh.
    pub fn counts(&self) -> (usize, usize) {
        let plan = plan(self, &self.surface());
        (plan.rings.len(), plan.sides)
    }

    pub(super) fn surface(&self) -> Surface<'_> {
        Surface::new(&self.stroke, &self.section, self.up)
    }
}

fn identity(root: Vec3) -> u64 {
    // `+ 0.0` makes -0 and 0 one place.
    let bits = (root + Vec3::ZERO).to_array().map(|c| u64::from(c.to_bits()));
    Key::new(0, "tuft").with(bits[0]).with(bits[1]).with(bits[2]).bits()
}

/// Many tufts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tufts {
    /// In the order they were made.
    pub tufts: Vec<Tuft>,
    /// Places in the script (`fringe.lua:24`) that made tufts.
    pub sources: Vec<Arc<str>>,
}

/// A tuft's rectangle in the texture atlas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Island {
    /// Lower left corner: u around, v root to tip.
    pub min: Vec2,
    /// Upper right corner.
    pub max: Vec2,
}

impl Island {
    /// The whole texture.
    pub const WHOLE: Self = Self { min: Vec2::ZERO, max: Vec2::ONE };

    pub(super) fn place(self, u: f32, v: f32) -> Vec2 {
        self.min + (self.max - self.min) * Vec2::new(u, v)
    }
}

/// The mesh of many tufts.
#[derive(Clone, Debug, PartialEq)]
pub struct TuftMesh {
    /// All tufts, one after the other, each closed; normals and uv in the atlas.
    pub mesh: Mesh,
    /// Per vertex: index of its tuft in [`Tufts::tufts`], for `_TUFT_ID`.
    pub tuft: Vec<u32>,
    /// Per tuft: its vertices.
    pub vertices: Vec<Range<u32>>,
    /// Per tuft: its triangles.
    pub triangles: Vec<Range<u32>>,
    /// Per tuft: its rectangle in the atlas.
    pub islands: Vec<Island>,
}

/// What [`Tufts::validate`] found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TuftsError {
    /// One tuft is wrong.
    #[error("tuft {number}: {error}")]
    Tuft {
        /// Counted from 1.
        number: usize,
        /// What is wrong.
        error: TuftError,
    },
    /// A tuft names a source that does not exist.
    #[error("tuft {number} has the source {source_index}, but there are only {count}")]
    Source {
        /// Counted from 1.
        number: usize,
        /// The index.
        source_index: u16,
        /// How many sources there are.
        count: usize,
    },
    /// Two tufts share an identity.
    #[error("two tufts have the id {id:#018x}")]
    RepeatedId {
        /// The id.
        id: u64,
    },
    /// The mesh is wrong.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl Tufts {
    /// Tufts made at one place of a script.
    pub fn new(tufts: Vec<Tuft>, source: &str) -> Self {
        let mut all = Self::default();
        all.push(tufts, source);
        all
    }

    /// Appends tufts made at `source`. A tuft with the same root as an earlier one gets an id of its own.
    pub fn push(&mut self, tufts: Vec<Tuft>, source: &str) {
        let known = self.sources.iter().position(|s| &**s == source);
        let source = known.unwrap_or_else(|| {
            self.sources.push(source.into());
            self.sources.len() - 1
        });
        // A script with 65,536 lines that make tufts shares the last label.
        let source = u16::try_from(source).unwrap_or(u16::MAX);
        self.tufts.extend(tufts.into_iter().map(|t| Tuft { source, ..t }));
        self.separate_ids();
    }

    /// Appends another set, its sources included.
    pub fn extend(&mut self, other: &Self) {
        for tuft in &other.tufts {
            let label = other.sources.get(tuft.source as usize).map_or("", |s| &**s);
            let known = self.sources.iter().position(|s| &**s == label).unwrap_or_else(|| {
                self.sources.push(label.into());
                self.sources.len() - 1
            });
            self.tufts.push(Tuft { source: u16::try_from(known).unwrap_or(u16::MAX), ..tuft.clone() });
        }
        self.separate_ids();
    }

    fn separate_ids(&mut self) {
        let mut seen = std::collections::BTreeSet::new();
        for tuft in &mut self.tufts {
            let first = tuft.id;
            let mut n = 0;
            while !seen.insert(tuft.id) {
                n += 1;
                tuft.id = Key::new(first, "tuft again").with(n).bits();
            }
        }
    }

    /// All tufts mirrored at the plane between the head's left and right.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mut all = Self { tufts: self.tufts.iter().map(Tuft::mirrored).collect(), sources: self.sources.clone() };
        all.separate_ids();
        all
    }

    /// How many tufts there are.
    pub fn count(&self) -> usize {
        self.tufts.len()
    }

    /// How many triangles the mesh has.
    pub fn triangle_count(&self) -> usize {
        self.tufts.par_iter().map(|t| plan(t, &t.surface()).triangles(&t.section)).sum()
    }

    /// Checks every tuft, and that ids are unique and the mesh is sound.
    ///
    /// # Errors
    /// The first problem found.
    pub fn validate(&self) -> Result<(), TuftsError> {
        let mut ids = std::collections::BTreeSet::new();
        for (i, tuft) in self.tufts.iter().enumerate() {
            let at = |error| TuftsError::Tuft { number: i + 1, error };
            tuft.section.validate().map_err(at)?;
            tuft.detail.validate().map_err(at)?;
            if tuft.source as usize >= self.sources.len() {
                let (source_index, count) = (tuft.source, self.sources.len());
                return Err(TuftsError::Source { number: i + 1, source_index, count });
            }
            if !ids.insert(tuft.id) {
                return Err(TuftsError::RepeatedId { id: tuft.id });
            }
        }
        if !self.tufts.is_empty() {
            self.mesh().mesh.validate()?;
        }
        Ok(())
    }

    /// The mesh of all tufts. The same bytes on any number of threads.
    pub fn mesh(&self) -> TuftMesh {
        struct Item<'a> {
            surface: Surface<'a>,
            plan: Plan,
            /// Split tufts are made at once, with uv over the whole square.
            split: Option<Mesh>,
        }
        let items: Vec<Item> = self
            .tufts
            .par_iter()
            .map(|tuft| {
                let surface = tuft.surface();
                let plan = plan(tuft, &surface);
                let split = tuft.section.split.map(|_| skin::split_mesh(&surface, &plan, Island::WHOLE));
                Item { surface, plan, split }
            })
            .collect();

        // Room
        let sizes: Vec<(usize, usize)> = items
            .iter()
            .map(|item| match &item.split {
                Some(mesh) => (mesh.positions.len(), mesh.triangles.len()),
                None => skin::size(item.plan.rings.len(), item.plan.sides),
            })
            .collect();
        let ranges = |pick: fn(&(usize, usize)) -> usize| -> Vec<Range<u32>> {
            let mut end = 0;
            let mut next = |s| {
                let start = end;
                end += pick(s) as u32;
                start..end
            };
            sizes.iter().map(&mut next).collect()
        };
        let (vertices, triangles) = (ranges(|s| s.0), ranges(|s| s.1));
        let count = vertices.last().map_or(0, |r| r.end as usize);
        let faces = triangles.last().map_or(0, |r| r.end as usize);
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO; count],
            triangles: vec![[0; 3]; faces],
            normals: vec![Vec3::ZERO; count],
            uvs: vec![Vec2::ZERO; count],
            groups: Vec::new(),
        };
        let mut tuft = vec![0; count];
        let islands = pack(&items.iter().map(|i| island_size(&i.surface)).collect::<Vec<_>>());
        let units: BTreeMap<usize, Vec<Vec2>> =
            items.iter().map(|i| i.plan.sides).map(|n| (n, skin::outline(n))).collect();

        // Every tuft writes into its own part of the buffers
        let mut outs = Vec::with_capacity(items.len());
        {
            let mut rest = (
                &mut mesh.positions[..],
                &mut mesh.normals[..],
                &mut mesh.uvs[..],
                &mut mesh.triangles[..],
                &mut tuft[..],
            );
            for (&(v, t), range) in sizes.iter().zip(&vertices) {
                let (positions, p) = std::mem::take(&mut rest.0).split_at_mut(v);
                let (normals, n) = std::mem::take(&mut rest.1).split_at_mut(v);
                let (uvs, u) = std::mem::take(&mut rest.2).split_at_mut(v);
                let (triangles, f) = std::mem::take(&mut rest.3).split_at_mut(t);
                let (ids, i) = std::mem::take(&mut rest.4).split_at_mut(v);
                outs.push((Out { positions, normals, uvs, triangles, first: range.start }, ids));
                rest = (p, n, u, f, i);
            }
        }
        outs.into_par_iter().zip(&items).zip(&islands).enumerate().for_each(|(i, (((mut out, ids), item), island))| {
            ids.fill(i as u32);
            match &item.split {
                Some(part) => {
                    out.positions.copy_from_slice(&part.positions);
                    out.normals.copy_from_slice(&part.normals);
                    for (to, from) in out.uvs.iter_mut().zip(&part.uvs) {
                        *to = island.place(from.x, from.y);
                    }
                    for (to, from) in out.triangles.iter_mut().zip(&part.triangles) {
                        *to = from.map(|v| v + out.first);
                    }
                }
                None => skin::write(&item.surface, &item.plan, &units[&item.plan.sides], *island, &mut out),
            }
        });
        TuftMesh { mesh, tuft, vertices, triangles, islands }
    }
}

fn plan(tuft: &Tuft, surface: &Surface) -> Plan {
    Plan::new(surface, tuft.detail, tuft.stroke.points().len())
}

/// Width and height that a tuft's island wants: its greatest girth and its length, cm.
fn island_size(surface: &Surface) -> Vec2 {
    let girth = (1..16).map(|i| surface.section.radii(i as f32 / 16.0)).map(|(w, h)| w + h).fold(0.01, f32::max);
    Vec2::new(girth * std::f32::consts::PI, surface.sweep.length().max(0.01))
}

/// Rectangles of those sizes, all scaled alike, beside each other in the unit square: shelves of falling height.
fn pack(sizes: &[Vec2]) -> Vec<Island> {
    match sizes.len() {
        0 => return Vec::new(),
        1 => return vec![Island::WHOLE],
        _ => {}
    }
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&a, &b| sizes[b].y.total_cmp(&sizes[a].y).then(a.cmp(&b)));
    // Two texels of a 1024 atlas, less when there are very many.
    let gap = (2.0 / 1024.0_f32).min(0.4 / (sizes.len() + 1) as f32);
    let shelves = |scale: f32| -> Option<Vec<Island>> {
        let mut islands = vec![Island::WHOLE; sizes.len()];
        let (mut x, mut y, mut shelf) = (gap, gap, 0.0);
        for &i in &order {
            let size = sizes[i] * scale;
            if x + size.x + gap > 1.0 {
                y += shelf + gap;
                x = gap;
                shelf = 0.0;
            }
            if shelf == 0.0 {
                shelf = size.y;
            }
            if x + size.x + gap > 1.0 || y + size.y + gap > 1.0 {
                return None;
            }
            islands[i] = Island { min: Vec2::new(x, y), max: Vec2::new(x, y) + size };
            x += size.x + gap;
        }
        Some(islands)
    };
    let largest = sizes.iter().fold(Vec2::ZERO, |a, &b| a.max(b));
    // So small that everything fits on one shelf of half the width.
    let mut lo = 0.4 / sizes.iter().map(|s| s.x).sum::<f32>().max(largest.y);
    let mut hi = 1.0 / largest.max_element();
    let mut best = shelves(lo);
    for _ in 0..30 {
        let middle = 0.5 * (lo + hi);
        match shelves(middle) {
            Some(found) => {
                best = Some(found);
                lo = middle;
            }
            None => hi = middle,
        }
    }
    best.unwrap_or_else(|| vec![Island::WHOLE; sizes.len()])
}

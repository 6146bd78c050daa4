//! Heads: the mesh that hair grows on, its landmarks, its head space, its scalp, and roots on it.
//!
//! **Head space:** the origin is the middle between the two ear landmarks; x points to the head's left, y up, z to
//! the face; one unit is one centimetre. A loaded head is moved and turned about Y into it, never scaled;
//! [`Head::placement`] leads back. [`Head::scale`] is the height from chin to vertex over 23 cm, an adult's.

mod crop;
mod detect;
mod ear;
mod error;
mod landmarks;
pub mod load;
pub mod mannequin;
mod mask;
mod matching;
mod motion;
mod parting;
mod polygon;
mod region;
#[cfg(test)]
mod region_tests;
mod roots;
mod sampled;
mod scalp;
mod space;
mod symmetry;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

use glam::{Affine3A, Vec2, Vec3};

use crate::geometry::sample::{BlueNoise, Patch, Sample};
use crate::geometry::{Bvh, Mesh, Root, Solid};
use crate::math::Digest;
use crate::params::{Object, nearest};
use crate::task::{Task, Warned, Warning};

pub use ear::Ear;
pub use error::HeadError;
pub use landmarks::Landmarks;
pub use mask::Mask;
pub use matching::matching;
pub use motion::{HeadMotion, MOST_FRAMES, MotionError, MotionOptions, Pose};
pub use parting::{Parting, PartingError};
pub use region::{Region, RegionError};
pub use roots::{MOST_ROOTS, RootsError, roots, roots_by_density};

/// Height of an adult's head from chin to vertex, cm: [`Head::scale`] 1.
pub const ADULT_HEIGHT: f32 = 23.0;

/// A head, in head space.
pub struct Head {
    /// What the script or the file calls it.
    pub name: String,
    /// The whole mesh, in head space, with normals.
    pub mesh: Arc<Mesh>,
    /// Its inside and outside; its first triangles are the mesh's.
    pub solid: Arc<Solid>,
    /// Named places, in head space.
    pub landmarks: Landmarks,
    /// From head space to the space of the head's own file (cm).
    pub placement: Affine3A,
    /// Height from chin to vertex over [`ADULT_HEIGHT`].
    pub scale: f32,
    ears: [Option<Ear>; 2],
    /// The surface that hair may grow on: the head and the neck, not the shoulders.
    patch: Arc<Patch>,
    /// Orders of places by seed, so that guides and members share their work.
    orders: Mutex<BTreeMap<u64, BlueNoise>>,
    key: OnceLock<u128>,
}

impl Object for Head {
    const NAME: &'static str = "Head";
}

impl std::fmt::Debug for Head {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Head({:?}, {} triangles, scale {})", self.name, self.mesh.triangles.len(), self.scale)
    }
}

impl Head {
    /// The built-in mannequin.
    ///
    /// # Errors
    /// None in practice: the tests build every style.
    pub fn mannequin(style: mannequin::Style) -> Result<Self, HeadError> {
        let mut marks = Landmarks::from_all([Vec3::NAN; 9]);
        for (name, place) in mannequin::landmarks(style) {
            marks = marks.with(name, place);
        }
        Self::with_landmarks(mannequin::mesh(style), "mannequin", marks)
    }

    /// A head from any upright mesh in cm that looks to +Z, give or take 45 degrees. `overrides` are landmarks by
    /// name in the mesh's own space; they are laid on the surface.
    ///
    /// # Errors
    /// A mesh without volume, without a head that can be told, or an unknown landmark; each says what to do.
    pub fn from_mesh(mesh: Mesh, name: &str, overrides: &BTreeMap<String, Vec3>) -> Result<Warned<Self>, HeadError> {
        Self::from_mesh_until(mesh, name, overrides, &Task::new())
    }

    /// The same, unless the task is cancelled: it is asked before every step.
    ///
    /// # Errors
    /// As [`Head::from_mesh`], and [`HeadError::Cancelled`].
    pub fn from_mesh_until(
        mut mesh: Mesh,
        name: &str,
        overrides: &BTreeMap<String, Vec3>,
        task: &Task,
    ) -> Result<Warned<Self>, HeadError> {
        task.check()?;
        // Closing and orienting first: a mesh without volume has no head.
        Solid::new(&mesh)?;
        task.check()?;
        if mesh.volume() < 0.0 {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            mesh.normals.clear();
        }
        let bvh = Bvh::new(&mesh.positions, &mesh.triangles);
        task.check()?;
        let mut warnings = Vec::new();
        let mut landmarks = if overrides.len() == Landmarks::NAMES.len() {
            Landmarks::from_all([Vec3::ZERO; 9])
        } else {
            detect::detect(&mesh, &bvh)?
        };
        for (key, &place) in overrides {
            landmarks = landmarks.with(key, on_surface(&bvh, key, place, &mut warnings)?);
        }
        Ok(Warned { value: Self::built(mesh, name, landmarks, task)?, warnings })
    }

    /// A head whose landmarks are known, in the mesh's own space: moves both into head space.
    ///
    /// # Errors
    /// A mesh without volume, or landmarks that cannot be a head's.
    pub fn with_landmarks(mesh: Mesh, name: &str, landmarks: Landmarks) -> Result<Self, HeadError> {
        Self::built(mesh, name, landmarks, &Task::new())
    }

    fn built(mut mesh: Mesh, name: &str, landmarks: Landmarks, task: &Task) -> Result<Self, HeadError> {
        task.check()?;
        mesh.validate().map_err(crate::geometry::SolidError::from)?;
        let placement = space::placement(&landmarks)?;
        let inverse = placement.inverse();
        let landmarks = landmarks.transformed(&inverse);
        for p in &mut mesh.positions {
            *p = inverse.transform_point3(*p);
        }
        if mesh.normals.is_empty() {
            mesh.compute_normals();
        } else {
            for n in &mut mesh.normals {
                *n = inverse.transform_vector3(*n);
            }
        }
        task.check()?;
        let solid = Solid::new(&mesh)?;
        task.check()?;
        let scale = landmarks.height() / ADULT_HEIGHT;
        let patch = Patch::new(&mesh, space::growing(&mesh, &landmarks)).ok_or(HeadError::NoHead)?;
        task.check()?;
        let ears = space::ears(&mesh, &solid, &landmarks);
        Ok(Self {
            name: name.to_owned(),
            mesh: Arc::new(mesh),
            solid: Arc::new(solid),
            landmarks,
            placement,
            scale,
            ears,
            patch: Arc::new(patch),
            orders: Mutex::default(),
            key: OnceLock::new(),
        })
    }

    /// The key of its content: surface, landmarks and place, but not its name.
    pub fn key(&self) -> u128 {
        *self.key.get_or_init(|| {
            let mut digest = Digest::new("head");
            self.mesh.digest(&mut digest);
            digest.data(&self.landmarks).data(&self.placement).finish()
        })
    }

    /// Memory that it takes, roughly: the mesh, and the trees and normals of its solid.
    pub fn bytes(&self) -> usize {
        // A few hundred bytes a triangle, the orders of places and the octree a few megabytes.
        self.mesh.positions.len() * 64 + self.mesh.triangles.len() * 250 + (16 << 20)
    }

    /// A landmark plus an offset, which is multiplied by [`Head::scale`].
    ///
    /// # Errors
    /// An unknown name, with the nearest one.
    pub fn at(&self, landmark: &str, offset: Vec3) -> Result<Vec3, HeadError> {
        let place = self.landmarks.get(landmark).ok_or_else(|| HeadError::unknown_landmark(landmark))?;
        Ok(place + offset * self.scale)
    }

    /// The middle of the skull: every place on the scalp is seen from it.
    pub fn centre(&self) -> Vec3 {
        space::centre(&self.landmarks)
    }

    /// The ears' outlines (left, right), where ears stand out.
    pub fn ears(&self) -> &[Option<Ear>; 2] {
        &self.ears
    }

    /// Area that hair may grow on, cm^2: the head and the neck.
    pub fn area(&self) -> f64 {
        self.patch.area()
    }

    /// Triangles that hair may grow on: the head and the neck, not the shoulders.
    pub fn growing(&self) -> &[u32] {
        self.patch.triangles()
    }

    /// The place of the head's own surface that is closest to `p`.
    pub fn closest(&self, p: Vec3) -> Sample {
        let found = self.solid.closest(p);
        if self.solid.is_closing(found.triangle) {
            // A lid over a hole is no skin: look for the nearest skin around it.
            let t = self.nearest_own(found.position);
            return t;
        }
        Sample {
            position: found.position,
            triangle: found.triangle,
            barycentric: self.weights(found.triangle, found.position),
        }
    }

    /// The root that a strand would have at a place.
    pub fn root(&self, at: &Sample) -> Root {
        let normal = at.interpolate(&self.mesh, &self.mesh.normals);
        let flat = || self.mesh.area_vector(at.triangle as usize).try_normalize().unwrap_or(Vec3::Y);
        let uv = if self.mesh.uvs.is_empty() { Vec2::ZERO } else { at.interpolate(&self.mesh, &self.mesh.uvs) };
        Root {
            id: at.id(),
            position: at.position,
            normal: normal.try_normalize().unwrap_or_else(flat),
            uv,
            triangle: at.triangle,
        }
    }

    /// The outermost place of the skin in a direction from [`Head::centre`], at most `reach` cm from it.
    pub fn skin(&self, direction: Vec3, reach: f32) -> Option<Sample> {
        let direction = direction.try_normalize()?;
        let hit = self.solid.bvh().first_hit(self.centre() + direction * reach, -direction, reach)?;
        (!self.solid.is_closing(hit.triangle)).then_some(Sample {
            position: hit.position,
            triangle: hit.triangle,
            barycentric: hit.barycentric,
        })
    }

    fn weights(&self, triangle: u32, p: Vec3) -> Vec3 {
        let [a, b, c] = self.mesh.corners(triangle as usize);
        let n = (b - a).cross(c - a);
        let whole = n.length_squared();
        if whole <= 0.0 {
            return Vec3::X;
        }
        let (u, v) = ((b - p).cross(c - p).dot(n) / whole, (c - p).cross(a - p).dot(n) / whole);
        let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
        let w = (1.0 - u - v).max(0.0);
        Vec3::new(u, v, w) / (u + v + w)
    }

    fn nearest_own(&self, p: Vec3) -> Sample {
        let mesh = &self.mesh;
        let best = (0..mesh.positions.len() as u32)
            .min_by(|&a, &b| {
                let d = |v: u32| mesh.positions[v as usize].distance_squared(p);
                d(a).total_cmp(&d(b))
            })
            .unwrap_or(0);
        for &t in self.growing() {
            if let Some(k) = mesh.triangles[t as usize].iter().position(|&v| v == best) {
                return Sample::on(mesh, t, Vec3::AXES[k]);
            }
        }
        Sample::on(mesh, self.growing()[0], Vec3::X)
    }
}

/// Lays an overridden landmark on the surface.
fn on_surface(bvh: &Bvh, name: &str, place: Vec3, warnings: &mut Vec<Warning>) -> Result<Vec3, HeadError> {
    if Landmarks::index(name).is_none() {
        return Err(HeadError::unknown_landmark(name));
    }
    let found = place.is_finite().then(|| bvh.closest(place, f32::MAX.sqrt())).flatten();
    let found = found.ok_or_else(|| HeadError::PlaceNotFinite { name: name.to_owned(), place })?;
    if found.distance > 0.5 {
        let p = found.position;
        warnings.push(
            Warning::new(format!("landmark `{name}` was {:.1} cm from the surface", found.distance))
                .hint(format!("it was moved to {{ {:.2}, {:.2}, {:.2} }}", p.x, p.y, p.z)),
        );
    }
    Ok(found.position)
}

impl HeadError {
    fn unknown_landmark(name: &str) -> Self {
        let near = nearest(name, Landmarks::NAMES);
        Self::UnknownLandmark { name: name.to_owned(), nearest: near }
    }
}

impl Head {
    fn patch(&self) -> &Patch {
        &self.patch
    }

    /// The order for a seed, out of the head's keeping: nobody waits for a lock while it grows.
    fn take_order(&self, seed: u64) -> BlueNoise {
        let mut orders = self.orders.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        orders.remove(&seed).unwrap_or_else(|| BlueNoise::new(Arc::clone(&self.patch), seed))
    }

    fn keep_order(&self, seed: u64, noise: BlueNoise) {
        let mut orders = self.orders.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if orders.len() < 4 && noise.order().len() < roots::KEPT {
            let kept = orders.entry(seed).or_insert_with(|| noise.clone());
            if kept.order().len() < noise.order().len() {
                *kept = noise;
            }
        }
    }
}

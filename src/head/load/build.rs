//! From what the readers collect to a clean mesh.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3, Mat3, Vec2, Vec3};

use super::{LoadError, MAX_NAMED, STEPS};
use crate::geometry::{Group, Mesh};
use crate::task::{Task, Warned, Warning};

/// Further than this from the origin, in cm, squares and products of places begin to leave the range of `f32`.
const FAR: f64 = 1e7;

/// What a reader collects: places in the file's own unit and axes.
#[derive(Debug, Default)]
pub(super) struct Parts {
    /// Places in the file's unit.
    pub positions: Vec<Vec3>,
    /// One per position; zero where the file gives none.
    pub normals: Vec<Vec3>,
    /// One per position; `None` where the file gives none.
    pub uvs: Vec<Option<Vec2>>,
    /// Indices into `positions`, all in range.
    pub triangles: Vec<[u32; 3]>,
    /// In order of first naming; triangles ascending.
    pub groups: Vec<Group>,
    /// The number of each group.
    pub by_name: BTreeMap<String, usize>,
    /// How many triangles all groups hold together.
    pub named: u64,
    /// Points and lines that were left out.
    pub ignored: usize,
    /// In the order they were met.
    pub warnings: Vec<Warning>,
}

impl Parts {
    /// The number of the group of that name, which is made if need be.
    pub fn group(&mut self, name: &str) -> usize {
        if let Some(&group) = self.by_name.get(name) {
            return group;
        }
        self.groups.push(Group { name: name.to_owned(), triangles: Vec::new() });
        self.by_name.insert(name.to_owned(), self.groups.len() - 1);
        self.groups.len() - 1
    }

    /// Puts all triangles from `since` on into a group.
    ///
    /// # Errors
    /// [`LoadError::TooMuch`] when a file of many names and triangles would unfold without end.
    pub fn enlist(&mut self, group: usize, since: usize) -> Result<(), LoadError> {
        let triangles = &mut self.groups[group].triangles;
        // A node, its mesh or a node below may carry the same name.
        let first = triangles.partition_point(|&t| (t as usize) < since);
        self.named += (self.triangles.len() - since - (triangles.len() - first)) as u64;
        if self.named > MAX_NAMED {
            return Err(LoadError::TooMuch { what: "triangles in groups".into(), count: self.named, limit: MAX_NAMED });
        }
        triangles.truncate(first);
        triangles.extend(since as u32..self.triangles.len() as u32);
        Ok(())
    }

    /// A clean mesh: chosen groups only, turned and scaled to cm, without flat triangles and unused vertices.
    pub fn finish(
        mut self,
        rotation: Mat3,
        scale: f64,
        chosen: &[String],
        task: &Task,
    ) -> Result<Warned<Mesh>, LoadError> {
        if self.ignored > 0 {
            let message = format!("points and lines left out: `{}`", self.ignored);
            self.warnings.push(Warning::new(message).hint("only faces are loaded"));
        }
        // Choose triangles.
        let mut keep = vec![chosen.is_empty(); self.triangles.len()];
        for name in chosen {
            let Some(&group) = self.by_name.get(name.as_str()) else {
                let groups = self.groups.iter().map(|g| g.name.clone()).collect();
                return Err(LoadError::UnknownGroup { name: name.clone(), groups });
            };
            for &t in &self.groups[group].triangles {
                keep[t as usize] = true;
            }
        }
        // Place vertices; those of no chosen triangle may be anywhere.
        let turn = rotation.as_dmat3() * DMat3::from_diagonal(DVec3::splat(scale));
        let mut used = vec![false; self.positions.len()];
        let mut dropped = 0;
        for (t, triangle) in self.triangles.iter().enumerate() {
            if t % STEPS == 0 {
                task.check()?;
            }
            if !keep[t] {
                continue;
            }
            let placed = triangle.map(|v| turn * self.positions[v as usize].as_dvec3());
            for (&v, p) in triangle.iter().zip(placed) {
                if !p.is_finite() || p.abs().max_element() > FAR {
                    return Err(LoadError::TooFar { vertex: v as usize, position: p.as_vec3() });
                }
            }
            keep[t] = !is_flat(placed);
            dropped += usize::from(!keep[t]);
            for &v in triangle {
                used[v as usize] |= keep[t];
            }
        }
        if !keep.contains(&true) {
            return Err(LoadError::NoTriangles { dropped, ignored: self.ignored });
        }
        if dropped > 0 {
            let all = self.triangles.len();
            self.warnings.push(Warning::new(format!("triangles without area dropped: `{dropped}` of {all}")));
        }
        // Renumber.
        task.check()?;
        let mut mesh = Mesh::default();
        let mut vertex = vec![0; used.len()];
        for (v, _) in used.iter().enumerate().filter(|&(_, &used)| used) {
            vertex[v] = mesh.positions.len() as u32;
            mesh.positions.push((turn * self.positions[v].as_dvec3()).as_vec3());
        }
        let mut number = vec![None; keep.len()];
        for (t, _) in keep.iter().enumerate().filter(|&(_, &keep)| keep) {
            number[t] = Some(mesh.triangles.len() as u32);
            mesh.triangles.push(self.triangles[t].map(|v| vertex[v as usize]));
        }
        mesh.groups = std::mem::take(&mut self.groups)
            .into_iter()
            .map(|g| Group {
                name: g.name,
                triangles: g.triangles.iter().filter_map(|&t| number[t as usize]).collect(),
            })
            .filter(|g| !g.triangles.is_empty())
            .collect();
        task.check()?;
        self.attributes(&mut mesh, &used, rotation);
        task.check()?;
        mesh.validate()?;
        Ok(Warned { value: mesh, warnings: self.warnings })
    }

    /// Normals, computed where there are none, and uv, if any vertex has one.
    fn attributes(&mut self, mesh: &mut Mesh, used: &[bool], rotation: Mat3) {
        let kept = || (0..used.len()).filter(|&v| used[v]);
        mesh.compute_normals();
        for (normal, v) in mesh.normals.iter_mut().zip(kept()) {
            if let Some(given) = (rotation * self.normals[v]).try_normalize() {
                *normal = given;
            }
        }
        let bare = kept().filter(|&v| !self.uvs[v].is_some_and(|uv| uv.is_finite())).count();
        if bare < mesh.positions.len() {
            mesh.uvs = kept().map(|v| self.uvs[v].filter(|uv| uv.is_finite()).unwrap_or_default()).collect();
            if bare > 0 {
                let message = format!("vertices without uv, set to 0, 0: `{bare}` of {}", mesh.positions.len());
                self.warnings.push(Warning::new(message));
            }
        }
    }
}

/// True for a triangle whose height is beneath what `f32` places of its size can tell from zero.
fn is_flat([a, b, c]: [DVec3; 3]) -> bool {
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    (b - a).cross(c - a).length() <= 1e-7 * longest
}

//! States of locks as a script gives them: tufts or pieces, brought to one topology.

use std::ops::Range;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::super::call::{Call, Result};
use super::animate::{AnimateOptions, At};
use super::clip::StillLocks;
use super::piece::Piece;
use super::tuft::Wig;
use crate::animate::AnimateError;
use crate::geometry::{Mesh, curve};
use crate::params::Value;
use crate::scene::Locks;
use crate::task::Warning;
use crate::tuft::{Detail, Tuft, Tufts};

/// A lock within the mesh of all.
pub struct OneLock {
    /// Its vertices.
    pub vertices: Range<u32>,
    /// Its triangles.
    triangles: Range<u32>,
}

/// Locks in several states, all of one topology.
pub struct Posed {
    /// The rest, as it is shown.
    pub rest: StillLocks,
    /// The rest's mesh, and where each of its vertices is on its lock.
    locks_at_rest: Locks,
    /// Vertices of all locks, state by state, the rest first.
    pub states: Vec<Vec<Vec3>>,
    /// The locks.
    pub locks: Vec<OneLock>,
}

/// Reads the states.
pub fn posed(call: &Call, states: &[Value]) -> Result<Posed> {
    let (mut wigs, mut pieces) = (vec![], vec![]);
    for (i, value) in states.iter().enumerate() {
        let path = format!("states[{}]", i + 1);
        let Value::Handle(handle) = value else { return Err(wrong(call, &path, value)) };
        match (handle.get::<Wig>(), handle.get::<Piece>()) {
            (Some(wig), _) if pieces.is_empty() => wigs.push(wig),
            (_, Some(piece)) if wigs.is_empty() => pieces.push(piece),
            (None, None) => return Err(wrong(call, &path, value)),
            _ => {
                let hint = Some("give tufts only, or pieces only".to_owned());
                return Err(call.problem_at(&path, "a tuft cannot become a piece", hint));
            }
        }
    }
    if wigs.len() + pieces.len() < 2 {
        let error = AnimateError::NoStates;
        return Err(call.problem_at("states", error.to_string(), error.hint()));
    }
    if wigs.is_empty() { of_pieces(call, &pieces) } else { of_tufts(call, &wigs) }
}

fn wrong(call: &Call, path: &str, value: &Value) -> super::super::session::Raised {
    let message = format!("expected Tufts or a Piece, got {} `{value}`", value.type_name());
    let hint = matches!(value, Value::Nil).then(|| "is the name spelt as where it was set?".to_owned());
    call.problem_at(path, message, hint)
}

fn of_pieces(call: &Call, pieces: &[Arc<Piece>]) -> Result<Posed> {
    let rest = &pieces[0];
    for (i, piece) in pieces.iter().enumerate().skip(1) {
        let state = i + 1;
        let error = if piece.mesh.positions.len() != rest.mesh.positions.len() {
            let (count, rest) = (piece.mesh.positions.len(), rest.mesh.positions.len());
            Some(AnimateError::VertexCount { state, count, rest })
        } else {
            let differs = (0..piece.mesh.triangles.len().max(rest.mesh.triangles.len()))
                .find(|&t| piece.mesh.triangles.get(t) != rest.mesh.triangles.get(t));
            differs.map(|t| AnimateError::Topology { state, triangle: t + 1 })
        };
        if let Some(error) = error {
            return Err(call.problem_at(&format!("states[{state}]"), error.to_string(), error.hint()));
        }
    }
    let still = StillLocks::Piece(Arc::clone(rest));
    Ok(Posed::new(still, pieces.iter().map(|p| p.mesh.positions.clone()).collect()))
}

fn of_tufts(call: &Call, wigs: &[Arc<Wig>]) -> Result<Posed> {
    let rest = &wigs[0];
    for (i, wig) in wigs.iter().enumerate().skip(1) {
        let path = format!("states[{}]", i + 1);
        if !Arc::ptr_eq(&wig.head, &rest.head) {
            let hint = "make both on one head, and make that once: `local head = coif.head()`".to_owned();
            return Err(call.problem_at(&path, "the tufts are of different heads", Some(hint)));
        }
        let (count, wanted) = (wig.tufts.count(), rest.tufts.count());
        if count != wanted {
            let hint = "a state poses every lock of the rest, in the same order".to_owned();
            let s = if count == 1 { "" } else { "s" };
            return Err(call.problem_at(&path, format!("{count} lock{s}, the rest has {wanted}"), Some(hint)));
        }
    }
    // Rings and sides: as many as the finest state wants, or at the control points where all agree on that.
    let alike = |lock: usize| {
        let all = || wigs.iter().map(move |w| &w.tufts.tufts[lock]);
        let first = &rest.tufts.tufts[lock];
        let by_points = matches!(first.detail, Detail::ControlPoints { .. });
        let same = all().all(|t| t.detail == first.detail && t.stroke.points().len() == first.stroke.points().len());
        if by_points && same {
            return first.detail;
        }
        let (rings, sides) = all().map(Tuft::counts).fold((1, 3), |a, b| (a.0.max(b.0), a.1.max(b.1)));
        Detail::Counts { rings: rings as u32, sides: sides as u32 }
    };
    let details: Vec<Detail> = (0..rest.tufts.count()).map(alike).collect();
    let with = |wig: &Wig| {
        let tufts = wig.tufts.tufts.iter().zip(&details).map(|(t, &detail)| Tuft { detail, ..t.clone() });
        Tufts { tufts: tufts.collect(), sources: wig.tufts.sources.clone() }
    };
    let shown = Wig { tufts: Arc::new(with(rest)), ..Wig::clone(rest) };
    let mut states = vec![];
    let mut ranges = vec![];
    for (i, wig) in wigs.iter().enumerate() {
        let mesh = with(wig).mesh();
        if i == 0 {
            ranges.clone_from(&mesh.vertices);
        }
        for (lock, (own, rest)) in mesh.vertices.iter().zip(&ranges).enumerate() {
            if own.len() != rest.len() {
                let error = AnimateError::VertexCount { state: i + 1, count: own.len(), rest: rest.len() };
                let lock = if ranges.len() > 1 { format!("lock {}: ", lock + 1) } else { String::new() };
                let path = format!("states[{}]", i + 1);
                return Err(call.problem_at(&path, format!("{lock}{error}"), error.hint()));
            }
        }
        states.push(mesh.mesh.positions);
    }
    Ok(Posed::new(StillLocks::Tufts(shown), states))
}

impl Posed {
    fn new(rest: StillLocks, states: Vec<Vec<Vec3>>) -> Self {
        let locks_at_rest = rest.locks();
        let mesh = &locks_at_rest.mesh;
        let one = |(v, t): (&Range<u32>, &Range<u32>)| OneLock { vertices: v.clone(), triangles: t.clone() };
        let locks = mesh.vertices.iter().zip(&mesh.triangles).map(one).collect();
        Self { rest, locks_at_rest, states, locks }
    }

    /// A lock's own mesh at rest, without what its features do not need.
    pub fn mesh_of(&self, lock: &OneLock) -> Mesh {
        let triangles = &self.locks_at_rest.mesh.mesh.triangles;
        let own = triangles[lock.triangles.start as usize..lock.triangles.end as usize].iter();
        Mesh {
            positions: self.within(0, lock).to_vec(),
            triangles: own.map(|t| t.map(|v| v - lock.vertices.start)).collect(),
            ..Mesh::default()
        }
    }

    fn within(&self, state: usize, lock: &OneLock) -> &[Vec3] {
        &self.states[state][lock.vertices.start as usize..lock.vertices.end as usize]
    }

    /// A lock's other states.
    pub fn states_of(&self, lock: &OneLock) -> Vec<Vec<Vec3>> {
        (1..self.states.len()).map(|s| self.within(s, lock).to_vec()).collect()
    }

    /// How many frames a lock that only lags has.
    pub fn frames_at_rest(&self, options: &AnimateOptions) -> usize {
        options.motion.as_ref().map_or(1, |m| m.clip.count())
    }

    /// A warning, with the lock that it is about when there are several.
    pub fn about(&self, number: usize, mut warning: Warning) -> Warning {
        if self.locks.len() > 1 {
            warning.message = format!("lock {}: {}", number + 1, warning.message);
        }
        warning
    }

    /// So many places along the middle of a lock at rest, evenly: along its stroke; on a piece, which has none, from the
    /// vertex nearest to the skin straight to the farthest one.
    pub fn middle(&self, number: usize, count: usize) -> Vec<Vec3> {
        let way: Vec<Vec3> = match &self.rest {
            StillLocks::Tufts(wig) => wig.tufts.tufts[number].stroke.points().to_vec(),
            StillLocks::Piece(piece) => {
                let away = |p: &Vec3| piece.head.closest(*p).position.distance(*p);
                let order = |a: &&Vec3, b: &&Vec3| away(a).total_cmp(&away(b));
                let all = &piece.mesh.positions;
                [all.iter().min_by(order), all.iter().max_by(order)].into_iter().flatten().copied().collect()
            }
        };
        curve::resampled(&way, count)
    }

    fn place(&self, lock: &OneLock, vertex: u32) -> Option<Vec2> {
        match self.rest {
            StillLocks::Tufts(_) => Some(self.locks_at_rest.place((lock.vertices.start + vertex) as usize)),
            // A piece has no root and no tip.
            StillLocks::Piece(_) => None,
        }
    }

    /// How far a vertex is from root (0) to tip (1); nothing on a piece.
    pub fn along(&self, lock: &OneLock, vertex: u32) -> Option<f32> {
        self.place(lock, vertex).map(|p| p.y)
    }

    /// The vertices of a lock from the root up to a part of its way.
    pub fn up_to(&self, call: &Call, lock: &OneLock, part: f32) -> Result<Vec<u32>> {
        if matches!(self.rest, StillLocks::Piece(_)) {
            let hint = "say what stays: `held = function(place) return place.y > 5 end`".to_owned();
            return Err(call.problem_at("held", "a piece has no root", Some(hint)));
        }
        let at = |v: u32| self.along(lock, v).unwrap_or(1.0);
        let positions = self.within(0, lock);
        let all: Vec<u32> = (0..lock.vertices.len() as u32).filter(|&v| at(v) <= part + 1e-5).collect();
        if part > 0.0 {
            return Ok(all);
        }
        // The middle of the root alone: the ring of an open one turns with the stroke, buried in the head.
        let middle = all.iter().map(|&v| positions[v as usize]).sum::<Vec3>() / all.len().max(1) as f32;
        let off = |v: &u32| positions[*v as usize].distance(middle);
        let least = all.iter().map(off).fold(f32::MAX, f32::min);
        Ok(all.into_iter().filter(|v| off(v) <= least + 1e-4).collect())
    }

    /// The vertex of a handle.
    pub fn handle(&self, call: &Call, field: &str, lock: &OneLock, at: At) -> Result<u32> {
        let positions = self.within(0, lock);
        let count = positions.len() as u32;
        let least = |cost: &dyn Fn(u32) -> f32| {
            (0..count).min_by(|&a, &b| cost(a).total_cmp(&cost(b)).then(a.cmp(&b))).unwrap_or(0)
        };
        let place = |v: u32| self.place(lock, v).unwrap_or_default();
        match at {
            At::Place(p) => Ok(least(&|v| positions[v as usize].distance_squared(p))),
            At::Tip | At::Along(_) if matches!(self.rest, StillLocks::Piece(_)) => {
                let hint = "give the handle a place: `at = { 0, -5, 9 }`".to_owned();
                Err(call.problem_at(field, "a piece has no tip", Some(hint)))
            }
            At::Tip => {
                // Of several tips, or the ring of an open one, what is nearest to their middle.
                let tips: Vec<u32> = (0..count).filter(|&v| place(v).y > 1.0 - 1e-5).collect();
                let middle = tips.iter().map(|&v| positions[v as usize]).sum::<Vec3>() / tips.len().max(1) as f32;
                let off =
                    |v: u32| if place(v).y > 1.0 - 1e-5 { positions[v as usize].distance(middle) } else { f32::MAX };
                Ok(least(&off))
            }
            // u = 0.5 is the side away from the head.
            At::Along(t) => Ok(least(&|v| 100.0 * (place(v).y - t).abs() + (place(v).x - 0.5).abs())),
        }
    }
}

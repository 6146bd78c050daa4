//! Keeping stylised hair within a number of triangles.

use std::sync::Arc;

use crate::geometry::Mesh;
use crate::scene::{Body, LockKind, Locks, Part, Scene};
use crate::tuft::{TuftError, Tufts, reduce};

/// What was done to keep within the triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Triangles of all tufts, caps, buns and rings before.
    pub before: usize,
    /// And now.
    pub after: usize,
    /// How many tufts lost some.
    pub lowered: usize,
    /// How many tufts there are.
    pub tufts: usize,
    /// How many caps, buns and rings lost some.
    pub pieces: usize,
    /// Farthest that a reduced mesh lies from its true surface, cm; none when nothing had to change.
    pub tolerance: Option<f32>,
}

/// Brings all tufts, caps, buns and rings of the scene together within `triangles`. The head does not count; parts that
/// move count, but stay as they are, for every frame has their corners.
///
/// # Errors
/// Fewer triangles than the coarsest meshes need.
pub fn keep_within(scene: &mut Scene, triangles: usize) -> Result<Budget, TuftError> {
    let of = |part: &'_ Part, tufts: bool| match &part.body {
        Body::Locks(l) if part.motion.is_none() && (l.kind == LockKind::Tufts) == tufts => Some(l.clone()),
        _ => None,
    };
    let moving = |part: &Part| if part.motion.is_some() { locks_of(part).map_or(0, triangles_of) } else { 0 };
    let fixed: usize = scene.parts.iter().map(moving).sum();
    let mut all = Tufts::default();
    let mut pieces: Vec<Locks> = Vec::new();
    for part in &scene.parts {
        if let Some(locks) = of(part, true) {
            all.tufts.extend(locks.tufts.tufts.iter().cloned());
        }
        pieces.extend(of(part, false));
    }
    let meshes: Vec<&Mesh> = pieces.iter().map(|p| &p.mesh.mesh).collect();
    let reduction = reduce(&all, &meshes, triangles.saturating_sub(fixed)).map_err(|e| match e {
        TuftError::Budget { least, .. } => TuftError::Budget { budget: triangles, least: least + fixed },
        other => other,
    })?;
    let count = reduction.pieces.iter().flatten().count();
    if reduction.tolerance.is_some() {
        let mut reduced = reduction.tufts.tufts.into_iter();
        let mut meshes = reduction.pieces.into_iter();
        for part in &mut scene.parts {
            if let Some(locks) = of(part, true) {
                let tufts = reduced.by_ref().take(locks.tufts.count()).collect();
                let tufts = Arc::new(Tufts { tufts, sources: locks.tufts.sources.clone() });
                part.body = Body::Locks(Locks::tufts(tufts, locks.palette));
            } else if let (Some(locks), Some(Some(mesh))) =
                (of(part, false), of(part, false).and_then(|_| meshes.next()))
            {
                let look = locks.look(0).clone();
                part.body = Body::Locks(Locks::piece(locks.kind, mesh, look));
            }
        }
    }
    Ok(Budget {
        before: reduction.before + fixed,
        after: reduction.after + fixed,
        lowered: reduction.lowered.len(),
        tufts: all.count(),
        pieces: count,
        tolerance: reduction.tolerance,
    })
}

fn locks_of(part: &Part) -> Option<&Locks> {
    if let Body::Locks(locks) = &part.body { Some(locks) } else { None }
}

fn triangles_of(locks: &Locks) -> usize {
    locks.mesh.mesh.triangles.len()
}

//! Keeping tufts within a number of triangles.

use std::sync::Arc;

use crate::scene::{Body, Locks, Motion, Part, Scene};
use crate::tuft::{TuftError, Tufts, reduce};

/// What was done to keep within the triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Triangles of all tufts before.
    pub before: usize,
    /// And now.
    pub after: usize,
    /// How many tufts lost some.
    pub lowered: usize,
    /// How many tufts there are.
    pub tufts: usize,
    /// Farthest that a reduced mesh lies from its true surface, cm; none when nothing had to change.
    pub tolerance: Option<f32>,
}

/// Brings all tufts of the scene together within `triangles`; head, caps, buns, rings and tufts whose surfaces move stay
/// as they are and do not count.
///
/// # Errors
/// Fewer triangles than the coarsest meshes need.
pub fn keep_within(scene: &mut Scene, triangles: usize) -> Result<Budget, TuftError> {
    let mut all = Tufts::default();
    let stays = |part: &Part| matches!(part.motion, Some(Motion::Surface(_)));
    for (_, locks) in scene.locks().filter(|(part, _)| !stays(part)) {
        all.tufts.extend(locks.tufts.tufts.iter().cloned());
    }
    let reduction = reduce(&all, triangles)?;
    if reduction.tolerance.is_some() {
        let mut reduced = reduction.tufts.tufts.into_iter();
        for part in &mut scene.parts {
            if !stays(part)
                && let Body::Locks(locks) = &mut part.body
                && locks.tufts.count() > 0
            {
                let tufts = reduced.by_ref().take(locks.tufts.count()).collect();
                let tufts = Arc::new(Tufts { tufts, sources: locks.tufts.sources.clone() });
                *locks = Locks::tufts(tufts, std::mem::take(&mut locks.palette));
            }
        }
    }
    Ok(Budget {
        before: reduction.before,
        after: reduction.after,
        lowered: reduction.lowered.len(),
        tufts: all.count(),
        tolerance: reduction.tolerance,
    })
}

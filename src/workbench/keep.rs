//! Files that were made before: pictures and models by the content of their scene.

use std::sync::Arc;

use crate::math::Digest;
use crate::scene::{Body, Motion, Scene};
use crate::script::{Memo, Origin};

/// What a file shows of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// The hair; who made it where in the script is not to be seen.
    Hair,
    /// Domains, guides, partings and roots too.
    Domains,
    /// Places in the script too.
    Places,
}

/// The key of a scene for files that show so much of it; `what` is the kind of file.
pub fn scene_key(what: &str, scene: &Scene, shows: Shows, memo: &Memo) -> Digest {
    let mut key = Digest::new(what);
    key.bytes(scene.name.as_bytes()).data(&scene.views).data(&scene.look).data(&scene.placement);
    match shows {
        Shows::Hair => key.data(&scene.overlay.notes),
        Shows::Domains | Shows::Places => key.data(&scene.overlay),
    };
    for part in &scene.parts {
        key.bytes(part.name.as_bytes());
        moves(&mut key, part.motion.as_ref(), memo);
        match &part.body {
            Body::Mesh(mesh, look) => mesh.digest(key.data(look)),
            Body::Locks(locks) => {
                locks.mesh.mesh.digest(key.data(&locks.kind).data(&locks.palette));
                // Colours, numbers and strokes; where they were made too, which is rarely all that differs.
                key.data(&locks.tufts.tufts).data(&locks.tufts.sources).bytes(part.source.as_bytes());
            }
            Body::Hair(hair) => {
                key.key(memo.content(&hair.strands)).key(memo.content(&hair.guides)).data(&hair.material);
                match shows {
                    Shows::Hair => {}
                    Shows::Domains => {
                        key.data(&hair.overlay);
                    }
                    Shows::Places => {
                        key.bytes(part.source.as_bytes()).data(&hair.strands.sources).data(&hair.guides.sources);
                    }
                }
            }
        }
    }
    key
}

/// How a part moves.
fn moves(key: &mut Digest, motion: Option<&Motion>, memo: &Memo) {
    let Some(motion) = motion else { return };
    key.data(&motion.count()).data(&motion.rate()).data(&motion.is_loop());
    match motion {
        Motion::Rigid(clip) => clip.frames.iter().for_each(|f| {
            key.floats(&f.to_cols_array());
        }),
        Motion::Surface(clip) => clip.frames.iter().for_each(|f| {
            key.vectors(f);
        }),
        Motion::Strands { strands, guides } => {
            for frame in strands.frames.iter().chain(&guides.frames) {
                key.key(memo.content(frame));
            }
        }
    }
}

/// The file with this key, from the memo or made.
///
/// # Errors
/// What `make` says; errors are not kept.
pub fn kept<E>(
    memo: &Memo,
    key: &Digest,
    make: impl FnOnce() -> Result<Vec<u8>, E>,
) -> Result<(Arc<Vec<u8>>, Origin), E> {
    if let Some((bytes, _)) = memo.get::<Vec<u8>>(key.finish()) {
        return Ok((bytes, Origin::Hit));
    }
    let bytes = Arc::new(make()?);
    memo.put(key.finish(), &bytes, &[]);
    Ok((bytes, Origin::Computed))
}

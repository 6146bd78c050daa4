//! Hair on another head.

use std::sync::Arc;

use super::super::call::{Call, Result};
use super::clip::{MovingLocks, MovingStrands, StillLocks};
use super::head::give;
use super::lattice::failed;
use super::piece::Piece;
use super::strands::Lock;
use super::tuft::{Wig, ground, settled as settled_tufts, tuft_error};
use crate::deform::{self, DeformError, Deformer, Hold};
use crate::geometry::{Clip, Strands};
use crate::groom::{Body, keep_out};
use crate::head::{Head, matching};
use crate::math::Digest;
use crate::params::Value;
use crate::task::{Warned, Warning};
use crate::tuft::{Stroke, Tuft, TuftError, Tufts};

crate::params! {
    /// Carries it to another head: the smooth motion through the landmarks of both heads moves every point, roots are laid on
    /// the new skin, and what then lies in the new head is moved out.
    pub struct CarryFields("carry") {
        /// The other head.
        to: Arc<Head>;
    }
}

/// The motion from one head to another.
pub fn between(call: &Call, from: &Head, to: &Head) -> Result<Deformer> {
    let warp = deform::Warp::new(matching(from, to)).map_err(|e| failed(call, "to", &e))?;
    Ok(Deformer::Warp(Arc::new(warp)))
}

/// Over how long a way from the root a strand comes back to where the warp alone would have it, cm.
const SETTLING: f32 = 4.0;

/// Strands laid on another head.
fn laid(call: &Call, of: &Arc<Strands>, from: &Head, to: &Head, by: &Deformer) -> Result<Arc<Strands>> {
    let mut key = Digest::new("carry strands 1");
    key.key(from.key()).key(to.key()).key(call.session.options.memo.content(of));
    call.memo_strands(&key, &of.sources, || {
        let by = std::slice::from_ref(by);
        let error = |e: DeformError| failed(call, "", &e);
        let mut out = deform::strands(of, by, &Hold::default(), call.task()).map_err(error)?;
        for i in 0..out.count() {
            let range = out.range(i);
            let root = to.root(&to.closest(out.points[range.start]));
            let off = root.position - out.points[range.start];
            let mut along = 0.0;
            let mut before = out.points[range.start];
            for k in range {
                let p = out.points[k];
                along += p.distance(before);
                before = p;
                out.points[k] += off * (1.0 - crate::math::trig::smoothstep(0.0, SETTLING * to.scale, along));
            }
            out.roots[i] = crate::geometry::Root { id: out.roots[i].id, ..root };
        }
        let body = Body { solid: &to.solid, margin: 0.1 * to.scale };
        let [cut, stuck] =
            keep_out(&mut out, &|_| true, body, call.task()).map_err(|e| failed(call, "", &DeformError::from(e)))?;
        let mut warned = Warned::clean(out);
        if cut + stuck > 0 {
            warned
                .warnings
                .push(Warning::new(format!("{} strands are cut short: they would run into the new head", cut + stuck)));
        }
        Ok(warned)
    })
}

/// Hair carried to another head.
pub fn carried_strands(call: &Call, lock: &Lock, to: &Arc<Head>) -> Result<Lock> {
    let from = &lock.area.head;
    let by = between(call, from, to)?;
    let strands = laid(call, &lock.strands, from, to, &by)?;
    let guides = if Arc::ptr_eq(&lock.strands, &lock.guides) {
        Arc::clone(&strands)
    } else {
        laid(call, &lock.guides, from, to, &by)?
    };
    let area = super::region::Area::new(Arc::clone(to), to.scalp());
    Ok(Lock { strands, guides, area, overlay: Arc::default(), ..lock.clone() })
}

/// Tufts carried to another head.
pub fn carried_tufts(call: &Call, wig: &Wig, to: &Arc<Head>) -> Result<Wig> {
    let by = [between(call, &wig.head, to)?];
    let (mut all, ground) = (Tufts::clone(&wig.tufts), ground(to));
    let grown = to.scale / wig.head.scale;
    for tuft in &mut all.tufts {
        let points = deform::points(tuft.stroke.points(), &by, call.task()).map_err(|e| failed(call, "", &e))?;
        let stroke = Stroke::new(points, ground.reference, tuft.stroke.depth() * grown);
        let stroke = stroke.map_err(|e: TuftError| tuft_error(call, "", &e))?;
        let on = ground.solid.closest(stroke.root());
        let (id, stroke) = (tuft.id, stroke.moved_to(on.position));
        *tuft = Tuft { id, ..tuft.along(stroke) };
    }
    let all = settled_tufts(call, all, to, true, 0.5)?;
    Ok(Wig { tufts: Arc::new(all), head: Arc::clone(to), palette: wig.palette.clone() })
}

/// A cap, a bun or a ring carried to another head.
pub fn carried_piece(call: &Call, piece: &Piece, to: &Arc<Head>) -> Result<Piece> {
    let by = [between(call, &piece.head, to)?];
    let mesh = deform::mesh(&piece.mesh, &by, call.task()).map_err(|e| failed(call, "", &e))?;
    let mesh = if piece.kind == crate::scene::LockKind::Cap {
        // A cap lies on the skin: what the warp leaves inside comes out.
        let cleared = crate::garment::clear(&mesh, &to.solid, 0.15 * to.scale, call.task());
        let cleared = cleared.map_err(|e| failed(call, "", &DeformError::from(e)))?;
        mesh.moved(&cleared.positions)
    } else {
        mesh
    };
    Ok(Piece { mesh: Arc::new(mesh), head: Arc::clone(to), ..piece.clone() })
}

/// Refuses frames that hold what the old head did.
fn at_rest(call: &Call, is_moved: bool, how: &str) -> Result<()> {
    if is_moved {
        let message = "the head's own motion is in these frames, and the other head turns elsewhere";
        return Err(call.problem(message, Some(format!("carry the hair first, then let it move: {how}"))));
    }
    Ok(())
}

/// `StrandsClip:carry`: the hair at rest, and every frame.
pub fn carry_moving_strands(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<MovingStrands>()?, call.read::<CarryFields>()?);
    at_rest(call, this.motion.is_some(), "`hair:carry { to = other }:simulate { motion = other:motion { ... } }`")?;
    let (from, to) = (&this.rest.area.head, &fields.to);
    let by = between(call, from, to)?;
    let frames = |clip: &Clip<Strands>| {
        clip.try_map(|i, frame| {
            call.task().progress("carry", i as f32 / clip.count() as f32);
            laid(call, frame, from, to, &by)
        })
    };
    let strands = frames(&this.strands)?;
    let is_one = this.strands.frames.iter().zip(&this.guides.frames).all(|(a, b)| Arc::ptr_eq(a, b));
    let guides = if is_one { strands.clone() } else { frames(&this.guides)? };
    let rest = carried_strands(call, &this.rest, to)?;
    let mut key = Digest::new("carry clip 1");
    key.key(this.key).key(from.key()).key(to.key());
    Ok(give(MovingStrands { rest, strands, guides, motion: None, key: key.finish() }))
}

/// `LocksClip:carry`: the locks at rest, and how every frame differs from them.
pub fn carry_moving_locks(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<MovingLocks>()?, call.read::<CarryFields>()?);
    let how = "`coif.animate` after `locks:carry { to = other }`, with the motion of the other head";
    at_rest(call, this.motion.is_some(), how)?;
    let by = [between(call, this.rest.head(), &fields.to)?];
    let rest = match &this.rest {
        StillLocks::Tufts(wig) => StillLocks::Tufts(carried_tufts(call, wig, &fields.to)?),
        StillLocks::Piece(piece) => StillLocks::Piece(Arc::new(carried_piece(call, piece, &fields.to)?)),
    };
    let error = |e: DeformError| failed(call, "", &e);
    let before = this.rest.locks().mesh.mesh.positions.clone();
    let still = rest.locks().mesh.mesh.positions.clone();
    if still.len() != before.len() {
        let message = "on the other head these locks have another mesh, so that the frames do not fit";
        return Err(call.problem(message, Some(format!("carry the locks first, then move them: {how}"))));
    }
    let before = deform::points(&before, &by, call.task()).map_err(error)?;
    let surface = this.surface.try_map(|_, frame| {
        let mut frame = deform::points(frame, &by, call.task()).map_err(error)?;
        for ((p, before), still) in frame.iter_mut().zip(&before).zip(&still) {
            *p = *still + (*p - *before);
        }
        Ok(Arc::new(frame))
    })?;
    Ok(give(MovingLocks { rest, surface, motion: None, source: call.source() }))
}

/// `Strands:carry`.
pub fn carry_strands(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Lock>()?, call.read::<CarryFields>()?);
    Ok(give(carried_strands(call, &this, &fields.to)?))
}

/// `Tufts:carry`.
pub fn carry_tufts(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Wig>()?, call.read::<CarryFields>()?);
    Ok(give(carried_tufts(call, &this, &fields.to)?))
}

/// `Piece:carry`.
pub fn carry_piece(call: &Call) -> Result<Value> {
    let (this, fields) = (call.this::<Piece>()?, call.read::<CarryFields>()?);
    Ok(give(carried_piece(call, &this, &fields.to)?))
}

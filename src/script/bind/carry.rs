//! Hair on another head.

use std::sync::Arc;

use super::super::call::{Call, Result};
use super::head::give;
use super::lattice::failed;
use super::piece::Piece;
use super::strands::Lock;
use super::tuft::{Wig, ground, settled as settled_tufts, tuft_error};
use crate::deform::{self, DeformError, Deformer, Hold};
use crate::geometry::Strands;
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

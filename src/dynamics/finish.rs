//! Frames made presentable: every segment at its length, no strand in the head.

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use super::packet::{Packet, unpack};
use super::world::Hair;
use crate::geometry::clear::{Outcome, Scratch};
use crate::geometry::{Clear, Strands, slide};

/// The strands as they are now, and how many could not be kept out of the head. `pose` is where the head is.
pub fn frame(hair: &Hair, packets: &[Packet], pose: &Affine3A) -> (Strands, usize) {
    let mut strands = hair.strands.clone();
    unpack(packets, &strands.offsets, &mut strands.points);
    let stuck = finish(hair, &mut strands, pose);
    (strands, stuck)
}

/// Lays every segment to its length and clears strands of the head, in the head's place `pose`.
pub fn finish(hair: &Hair, strands: &mut Strands, pose: &Affine3A) -> usize {
    let (rest, back) = (hair.strands, pose.inverse());
    let clear = hair
        .body
        .filter(|_| hair.options.collide)
        .map(|body| Clear { body: slide::Body { solid: body.solid, margin: hair.options.margin } });
    let mut parts = Vec::with_capacity(strands.count());
    let mut points = strands.points.as_mut_slice();
    for w in strands.offsets.windows(2) {
        let (strand, after) = points.split_at_mut((w[1] - w[0]) as usize);
        parts.push(strand);
        points = after;
    }
    let stuck = parts.par_iter_mut().enumerate().map_init(Scratch::default, |scratch, (i, points)| {
        let home = rest.strand(i);
        if *pose != Affine3A::IDENTITY {
            points.iter_mut().for_each(|p| *p = back.transform_point3(*p));
        }
        lay(hair, points, home);
        let mut is_stuck = false;
        if let Some(clear) = &clear
            && clear.strand(points, scratch) == Outcome::Stuck
        {
            points.copy_from_slice(home);
            is_stuck = clear.strand(points, scratch) == Outcome::Stuck;
        }
        if *pose != Affine3A::IDENTITY {
            points.iter_mut().for_each(|p| *p = pose.transform_point3(*p));
        }
        usize::from(is_stuck)
    });
    let stuck = stuck.sum();
    if *pose != Affine3A::IDENTITY {
        for root in &mut strands.roots {
            root.position = pose.transform_point3(root.position);
            root.normal = pose.transform_vector3(root.normal);
        }
    }
    stuck
}

/// Gives every segment its length again, from the root on; pinned nodes stay.
fn lay(hair: &Hair, points: &mut [Vec3], home: &[Vec3]) {
    for k in 1..points.len() {
        let is_pinned = (k == 1 && hair.options.clamped) || hair.pinned.iter().any(|z| z.contains(home[k]));
        if !is_pinned {
            let along = (points[k] - points[k - 1]).try_normalize().unwrap_or(Vec3::NEG_Y);
            points[k] = points[k - 1] + along * home[k].distance(home[k - 1]);
        }
    }
}

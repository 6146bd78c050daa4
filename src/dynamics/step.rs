//! One step of eight strands: equations (4) and (5), then bending, lengths and the head.
//!
//! With a(t) the acceleration of the force objects, v(t) the velocity and h the step,
//!
//! ```text
//! x(t+h) = x + v h + a h^2 / 2                                            (4)
//! v(t+h) = v + (a(t) + a(t+h)) h / 2                                      (5)
//! ```
//!
//! A step begins with the second half of (5) of the step before it, so a is asked for once a step. The air takes its
//! part of the velocity between the two halves, exactly, which keeps the second order. What bending, lengths and the head
//! move a node by is motion as well: its velocity is the way that it has come over h.

use glam::Affine3A;
use multiversion::multiversion;

use super::acting::Acting;
use super::bend::Factors;
use super::lanes::{LANES, Lanes, Plane, dot, each, three};
use super::length::{self, Memory};
use super::options::{Lengths, Solver};
use super::packet::Packet;
use super::skin::Skin;

/// What does not change from step to step.
#[derive(Clone, Copy, Debug)]
pub struct Rules<'a> {
    /// The step h, s.
    pub h: f32,
    /// What the air leaves of a velocity after a step.
    pub kept: f32,
    /// Rounds of corrections.
    pub iterations: usize,
    /// Their form.
    pub lengths: Lengths,
    /// Their order.
    pub solver: Solver,
    /// The head.
    pub skin: Option<&'a Skin>,
    /// Of hair on skin.
    pub friction: f32,
    /// Whether a strand stops where it is fastest: hair is to come to rest. The least number of steps between stops.
    pub stops: Option<usize>,
}

/// One step of all strands.
#[derive(Clone, Debug)]
pub struct Moment<'a> {
    /// The forces when it begins.
    pub forces: Vec<Acting<'a>>,
    /// From where a place on the head is when it begins to where it is when it ends.
    pub carry: Affine3A,
    /// Where the head is when it ends.
    pub to: Affine3A,
    /// Back from there to the head at rest.
    pub back: Affine3A,
    /// The farthest that any place near the head moves with it in the step, cm.
    pub way: f32,
    /// Whether it is the first: there is no step before it to end.
    pub is_first: bool,
}

/// Memory that is used again from packet to packet.
#[derive(Debug, Default)]
pub struct Scratch {
    before: Plane,
    force: Plane,
    factors: Factors,
    memory: Memory,
}

/// Moves a packet through some steps.
#[multiversion(targets("x86_64+avx2"))]
pub fn advance(packet: &mut Packet, moments: &[Moment], rules: &Rules, scratch: &mut Scratch) {
    scratch.before.resize(packet.nodes);
    scratch.force.resize(packet.nodes);
    scratch.memory.resize(packet.nodes);
    scratch.factors.resize(packet.nodes);
    for moment in moments {
        drift(packet, moment, rules, scratch);
        let Packet { at, free, rest, bend, taut, .. } = packet;
        if let Some(bend) = bend {
            let m = moment.to.matrix3;
            let turn = [m.x_axis.to_array(), m.y_axis.to_array(), m.z_axis.to_array()];
            bend.apply(at, (free, rest), &turn, &scratch.force, &mut scratch.factors);
        }
        if matches!(rules.solver, Solver::Chain) {
            scratch.memory.look(at, &scratch.before, taut);
        }
        for i in 0..rules.iterations {
            let most = correct(at, (free, rest), &[1.0; LANES], rules, scratch);
            if i == 0 {
                *taut = most;
            }
        }
        if rules.iterations > 0 && matches!(rules.solver, Solver::Chain) {
            // Strands that whip about need more rounds.
            for _ in 0..length::MORE {
                let which = length::off(at, free, rest, length::NEAR);
                if which == [0.0; LANES] {
                    break;
                }
                correct(at, (free, rest), &which, rules, scratch);
            }
            let which = length::off(at, free, rest, length::LOOSE);
            if which != [0.0; LANES] {
                length::lay(at, &scratch.before, (free, rest), &which);
            }
        }
        if let Some(skin) = rules.skin {
            keep_out(packet, &scratch.before, moment, skin, rules.friction);
        }
        let one_over = 1.0 / rules.h;
        let Packet { at, velocity, .. } = packet;
        for (v, (a, b)) in [
            (&mut velocity.x, (&at.x, &scratch.before.x)),
            (&mut velocity.y, (&at.y, &scratch.before.y)),
            (&mut velocity.z, (&at.z, &scratch.before.z)),
        ] {
            for (v, (a, b)) in v.iter_mut().zip(a.iter().zip(b)) {
                *v = each(|l| (a[l] - b[l]) * one_over);
            }
        }
        if let Some(gap) = rules.stops {
            stop(packet, gap);
        }
    }
}

/// Stops the strands that have just become slower: where a swing is fastest it passes the place of rest.
#[inline(always)]
fn stop(packet: &mut Packet, gap: usize) {
    let Packet { velocity, swing, .. } = packet;
    let mut now = [0.0; LANES];
    for k in 0..velocity.x.len() {
        let v = velocity.row(k);
        let square = dot(&v, &v);
        now = each(|l| now[l] + square[l]);
    }
    let [before, since] = *swing;
    let stops = each(|l| if (now[l] < before[l]) & (since[l] >= gap as f32) { 1.0 } else { 0.0 });
    *swing = [each(|l| now[l] * (1.0 - stops[l])), each(|l| (since[l] + 1.0) * (1.0 - stops[l]))];
    if stops != [0.0; LANES] {
        for v in [&mut velocity.x, &mut velocity.y, &mut velocity.z] {
            for v in v {
                *v = each(|l| if stops[l] > 0.0 { 0.0 } else { v[l] });
            }
        }
    }
}

/// One round of corrections to the lengths; tells how taut strands are.
#[inline(always)]
fn correct(at: &mut Plane, strand: (&[Lanes], &[Lanes]), which: &Lanes, rules: &Rules, scratch: &mut Scratch) -> Lanes {
    let Scratch { before, memory, .. } = scratch;
    match (rules.solver, rules.lengths) {
        (Solver::Chain, Lengths::Exact) => length::chain::<false>(at, before, strand, which, memory),
        (Solver::Chain, Lengths::RootFree) => length::chain::<true>(at, before, strand, which, memory),
        (Solver::Pairs, Lengths::Exact) => {
            length::pairs::<false>(at, strand.0, strand.1);
            [0.0; LANES]
        }
        (Solver::Pairs, Lengths::RootFree) => {
            length::pairs::<true>(at, strand.0, strand.1);
            [0.0; LANES]
        }
    }
}

/// The second half of the velocity of the last step, the first half of this one, and the way.
#[inline(always)]
fn drift(packet: &mut Packet, moment: &Moment, rules: &Rules, scratch: &mut Scratch) {
    let h = rules.h;
    // v(t) = v(t - h/2) + a h/2, then the air, then v(t + h/2) = v + a h/2.
    let ended = if moment.is_first { 0.0 } else { 0.5 * h * rules.kept };
    let kick = ended + 0.5 * h;
    let m = moment.to.matrix3;
    let (mx, my, mz, shift) = (m.x_axis, m.y_axis, m.z_axis, moment.to.translation);
    let (has_push, bends) = (!packet.push.x.is_empty(), packet.bend.is_some());
    for k in 0..packet.nodes {
        let at = packet.at.row(k);
        scratch.before.put(k, at);
        let mut a = if has_push { packet.push.row(k) } else { [[0.0; LANES]; 3] };
        for force in &moment.forces {
            force.add(&at, &mut a);
        }
        let v = packet.velocity.row(k);
        let mut next = three!(c => each(|l| at[c][l] + h * (v[c][l] * rules.kept)));
        if bends {
            scratch.force.put(k, three!(c => each(|l| h * kick * a[c][l])));
        } else {
            for c in 0..3 {
                for l in 0..LANES {
                    next[c][l] += h * kick * a[c][l];
                }
            }
        }
        if packet.is_held[k] {
            let (home, free) = (packet.home.row(k), &packet.free[k]);
            for c in 0..3 {
                let (x, y, z, w) = (mx[c], my[c], mz[c], shift[c]);
                let held = each(|l| x * home[0][l] + y * home[1][l] + z * home[2][l] + w);
                next[c] = each(|l| if free[l] > 0.0 { next[c][l] } else { held[l] });
            }
        }
        packet.at.put(k, next);
    }
}

/// Moves nodes that come too near to the skin out of it, and brakes those that touch it.
#[inline(always)]
fn keep_out(packet: &mut Packet, before: &Plane, moment: &Moment, skin: &Skin, friction: f32) {
    for k in 1..packet.nodes {
        let (at, from) = (packet.at.row(k), before.row(k));
        let (margin, free) = (packet.margin[k], packet.free[k]);
        // The skin comes no nearer than by the way of the node and that of the head.
        let clear = packet.clear[k];
        let clear = each(|l| {
            let way = (at[0][l] - from[0][l]).abs() + (at[1][l] - from[1][l]).abs() + (at[2][l] - from[2][l]).abs();
            clear[l] - way - moment.way
        });
        packet.clear[k] = clear;
        let mut touches = 0.0_f32;
        for l in 0..LANES {
            touches = touches.max((margin[l] - clear[l]) * free[l]);
        }
        if touches > 0.0 {
            for l in 0..LANES {
                if free[l] > 0.0 && clear[l] < margin[l] {
                    packet.clear[k][l] = touch(packet, before, moment, skin, friction, (k, l));
                }
            }
        }
    }
}

/// Looks after one node, and tells how far the skin is.
fn touch(
    packet: &mut Packet,
    before: &Plane,
    moment: &Moment,
    skin: &Skin,
    friction: f32,
    (k, l): (usize, usize),
) -> f32 {
    let p = packet.at.get(k, l);
    let (distance, slope) = skin.at(moment.back.transform_point3(p));
    let depth = packet.margin[k][l] - distance;
    if depth <= 0.0 {
        return distance - skin.slack();
    }
    let Some(normal) = slope.try_normalize() else { return 0.0 };
    let normal = moment.to.transform_vector3(normal);
    let was = before.get(k, l);
    // The way along the skin, which may itself have moved.
    let skin_way = moment.carry.transform_point3(was) - was;
    let way = p - was - skin_way;
    let along = way - normal * way.dot(normal);
    let stuck = (friction * depth / along.length().max(1e-9)).min(1.0);
    packet.at.set(k, l, p + normal * depth - along * stuck);
    0.0
}

//! Strands in packets of eight, each with everything that its motion needs.

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use super::bend::Bend;
use super::error::DynamicsError;
use super::force::Zone;
use super::lanes::{LANES, Lanes, Plane};
use crate::geometry::Strands;

/// Eight strands of about the same number of nodes.
#[derive(Clone, Debug)]
pub struct Packet {
    /// Indices of the strands; [`NONE`] where there is none.
    pub strands: [u32; LANES],
    /// Nodes of each.
    pub counts: [usize; LANES],
    /// Nodes of the longest: shorter strands go on with idle ones.
    pub nodes: usize,
    /// Where the nodes are, cm.
    pub at: Plane,
    /// Their velocities in the middle of the last step, cm/s.
    pub velocity: Plane,
    /// Where they were at first, seen from the head.
    pub home: Plane,
    /// 1 for a node that moves, 0 for one that is pinned to the head or idle.
    pub free: Vec<Lanes>,
    /// Whether any of the eight is not free.
    pub is_held: Vec<bool>,
    /// Lengths of the segments, each with the number of the node at its end; 0 where it is idle.
    pub rest: Vec<Lanes>,
    /// Bending.
    pub bend: Option<Bend>,
    /// Least distance from the skin, node by node.
    pub margin: Vec<Lanes>,
    /// A distance from each node within which there is no skin.
    pub clear: Vec<Lanes>,
    /// Acceleration by crowding; empty when hair does not repel.
    pub push: Plane,
    /// How taut the strands were in the last step: the greatest mu of the lengths.
    pub taut: Lanes,
    /// Where the nodes were when their way was last looked at.
    pub mark: Plane,
    /// While hair settles: the square of all velocities of each strand in the last step, and steps since it last stopped.
    pub swing: [Lanes; 2],
    /// While hair settles: how often in a row each strand was calm.
    pub calm: [usize; LANES],
    /// Whether it is at rest.
    pub rests: [bool; LANES],
}

/// No strand.
pub const NONE: u32 = u32::MAX;

/// The mean curvature of heads, 1/cm: how far a segment's middle lies below its ends.
const ROUND: f32 = 1.0 / 8.0;

/// Looks in a row after which a strand that was calm in all of them is at rest.
const CALM: usize = 3;
/// The same for one that trembles.
const PATIENT: usize = 8;

/// What packets are made with.
#[derive(Clone, Copy, Debug)]
pub struct Making<'a> {
    /// Nodes in any of these are pinned to the head.
    pub pinned: &'a [Zone],
    /// Whether the second node is pinned with the first.
    pub clamped: bool,
    /// Bending stiffness over mass per length, cm^4/s^2; 0 for none.
    pub stiffness: f32,
    /// The acceleration under which the shape at first is at rest, seen from the head, cm/s^2.
    pub load: Vec3,
    /// Length of a step, s.
    pub step: f32,
    /// Least distance from the skin, cm.
    pub margin: f32,
    /// Whether hair repels.
    pub repels: bool,
    /// Where the head is at first.
    pub pose: Affine3A,
    /// Whether any node may move without being pinned: tests of free particles.
    pub loose: bool,
}

/// Refuses segments that have no direction.
pub fn check_segments(strands: &Strands) -> Result<(), DynamicsError> {
    let bad = (0..strands.count()).into_par_iter().find_map_first(|i| {
        let nodes = strands.strand(i);
        let at = nodes.windows(2).position(|w| w[0].distance_squared(w[1]) < 1e-10)?;
        Some((i, at + 1, nodes[at].distance(nodes[at + 1])))
    });
    match bad {
        Some((strand, segment, length)) => Err(DynamicsError::Segment { strand, segment, length }),
        None => Ok(()),
    }
}

/// All strands in packets; strands of like length share one.
pub fn pack(strands: &Strands, making: &Making) -> Vec<Packet> {
    let mut order: Vec<u32> = (0..strands.count() as u32).collect();
    order.sort_by_key(|&i| (strands.range(i as usize).len(), i));
    order.par_chunks(LANES).map(|some| Packet::new(strands, some, making)).collect()
}

impl Packet {
    fn new(strands: &Strands, some: &[u32], making: &Making) -> Self {
        let mut indices = [NONE; LANES];
        indices[..some.len()].copy_from_slice(some);
        let counts = indices.map(|i| if i == NONE { 0 } else { strands.range(i as usize).len() });
        let nodes = counts.into_iter().max().unwrap_or(0);
        let mut packet = Self { strands: indices, counts, ..Self::empty(nodes, making.repels) };
        for (l, &i) in indices.iter().enumerate() {
            if i != NONE {
                packet.place(l, strands.strand(i as usize), making);
            }
        }
        for k in 0..nodes {
            packet.is_held[k] = packet.free[k].contains(&0.0);
        }
        if making.stiffness > 0.0 {
            packet.bend = Some(Bend::new(&packet, making.stiffness, making.step, making.load, &making.pose));
        }
        packet
    }

    /// Lays one strand into its lane.
    fn place(&mut self, l: usize, points: &[Vec3], making: &Making) {
        for k in 0..self.nodes {
            let p = points[k.min(points.len() - 1)];
            let is_idle = k >= points.len();
            let is_root = k == 0 || (k == 1 && making.clamped);
            let is_pinned = (is_root && !making.loose) || making.pinned.iter().any(|z| z.contains(p));
            self.home.set(k, l, p);
            self.at.set(k, l, making.pose.transform_point3(p));
            self.free[k][l] = f32::from(!is_idle && !is_pinned);
            if k > 0 && !is_idle {
                let length = p.distance(points[k - 1]);
                self.rest[k][l] = length;
                // Near the root it rises from the skin; where segments are long, their middles need room as well.
                let rise = (0.45 * k as f32 * points[0].distance(points[1])).max(0.002);
                let sag = (length * length * ROUND / 8.0).min(0.5);
                self.margin[k][l] = (making.margin + sag).min(rise);
            }
        }
    }

    /// Strands of other packets, each given by its lane, side by side in one: no more than eight.
    fn regrouped(some: &[(&Self, usize)]) -> Self {
        let nodes = some.iter().map(|(p, _)| p.nodes).max().unwrap_or(0);
        let has_push = some.iter().any(|(p, _)| !p.push.x.is_empty());
        let mut packet = Self::empty(nodes, has_push);
        for (l, &(from, lane)) in some.iter().enumerate() {
            packet.strands[l] = from.strands[lane];
            packet.counts[l] = from.counts[lane];
            packet.taut[l] = from.taut[lane];
            packet.calm[l] = from.calm[lane];
            packet.rests[l] = from.rests[lane];
            for i in 0..2 {
                packet.swing[i][l] = from.swing[i][lane];
            }
            // Idle nodes lie at the tip.
            let last = from.counts[lane] - 1;
            for k in 0..nodes {
                let is_idle = k > last;
                let k_from = k.min(last);
                packet.at.set(k, l, from.at.get(k_from, lane));
                packet.home.set(k, l, from.home.get(k_from, lane));
                packet.mark.set(k, l, from.mark.get(k_from, lane));
                if !is_idle {
                    packet.velocity.set(k, l, from.velocity.get(k, lane));
                    packet.free[k][l] = from.free[k][lane];
                    packet.rest[k][l] = from.rest[k][lane];
                    packet.margin[k][l] = from.margin[k][lane];
                    packet.clear[k][l] = from.clear[k][lane];
                    if has_push {
                        packet.push.set(k, l, from.push.get(k, lane));
                    }
                }
            }
        }
        for k in 0..nodes {
            packet.is_held[k] = packet.free[k].contains(&0.0);
        }
        let bends: Vec<_> =
            some.iter().filter_map(|&(p, lane)| Some((p.bend.as_ref()?, lane, p.counts[lane]))).collect();
        packet.bend = Bend::regrouped(&bends, nodes);
        packet
    }

    /// No strand.
    fn empty(nodes: usize, has_push: bool) -> Self {
        Self {
            strands: [NONE; LANES],
            counts: [0; LANES],
            nodes,
            at: Plane::new(nodes),
            velocity: Plane::new(nodes),
            home: Plane::new(nodes),
            free: vec![[0.0; LANES]; nodes],
            is_held: vec![true; nodes],
            rest: vec![[0.0; LANES]; nodes],
            bend: None,
            margin: vec![[0.0; LANES]; nodes],
            clear: vec![[0.0; LANES]; nodes],
            push: Plane::new(if has_push { nodes } else { 0 }),
            taut: [0.0; LANES],
            mark: Plane::new(nodes),
            swing: [[0.0; LANES]; 2],
            calm: [0; LANES],
            rests: [false; LANES],
        }
    }

    /// Looks how far each strand has come from where it was marked. One that has stayed within `way` is calm, and at rest
    /// after [`CALM`] looks; one that trembles about a place may go twice as far in the end, and is at rest after
    /// [`PATIENT`]. Any other is marked anew. Gives the greatest way of all.
    pub fn look(&mut self, way: f32) -> f32 {
        let mut most = 0.0_f32;
        for l in 0..LANES {
            if self.strands[l] == NONE {
                continue;
            }
            let far = (0..self.counts[l]).map(|k| self.at.get(k, l).distance_squared(self.mark.get(k, l)));
            let far = far.fold(0.0, f32::max).sqrt();
            most = most.max(far);
            let patience = self.calm[l] as f32 / PATIENT as f32;
            if far <= way * (1.0 + patience) {
                self.calm[l] += 1;
                self.rests[l] = self.calm[l] >= PATIENT || (self.calm[l] >= CALM && far <= way);
            } else {
                (self.calm[l], self.rests[l]) = (0, false);
                for k in 0..self.counts[l] {
                    self.mark.set(k, l, self.at.get(k, l));
                }
            }
        }
        most
    }

    /// Where a strand is now: its lane and the nodes.
    pub fn each_strand(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let some = self.strands.iter().zip(self.counts).enumerate();
        some.filter(|(_, (i, _))| **i != NONE).map(|(l, (i, count))| (l, *i as usize, count))
    }
}

/// Puts what strands are left side by side again when many places are empty. What a strand does depends on its own numbers
/// only, so this changes no bit of it.
pub fn regroup(packets: &mut Vec<Packet>) {
    let left: Vec<(&Packet, usize)> = packets.iter().flat_map(|p| p.each_strand().map(move |(l, ..)| (p, l))).collect();
    if 4 * left.len() < 3 * LANES * packets.len() {
        let fewer: Vec<Packet> = left.par_chunks(LANES).map(Packet::regrouped).collect();
        *packets = fewer;
    }
}

/// Writes the strands as they are now into `points`, which is laid out as theirs.
pub fn unpack(packets: &[Packet], offsets: &[u32], points: &mut [Vec3]) {
    // Packets hold strands in another order, so each thread writes to places of its own all over the buffer.
    let mut parts: Vec<Option<&mut [Vec3]>> = split(points, offsets);
    let mut work: Vec<(&Packet, [Option<&mut [Vec3]>; LANES])> = packets
        .iter()
        .map(|p| (p, p.strands.map(|i| if i == NONE { None } else { parts[i as usize].take() })))
        .collect();
    work.par_iter_mut().for_each(|(packet, strands)| {
        for (l, points) in strands.iter_mut().enumerate() {
            for (k, to) in points.iter_mut().flat_map(|p| p.iter_mut()).enumerate() {
                *to = packet.at.get(k, l);
            }
        }
    });
}

/// The parts of `points` that belong to the single strands.
fn split<'a>(mut points: &'a mut [Vec3], offsets: &[u32]) -> Vec<Option<&'a mut [Vec3]>> {
    offsets
        .windows(2)
        .map(|w| {
            let (strand, rest) = std::mem::take(&mut points).split_at_mut((w[1] - w[0]) as usize);
            points = rest;
            Some(strand)
        })
        .collect()
}

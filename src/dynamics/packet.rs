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
}

/// No strand.
pub const NONE: u32 = u32::MAX;

/// The mean curvature of heads, 1/cm: how far a segment's middle lies below its ends.
const ROUND: f32 = 1.0 / 8.0;

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
        let mut packet = Self {
            strands: indices,
            counts,
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
            push: Plane::new(if making.repels { nodes } else { 0 }),
            taut: [0.0; LANES],
            mark: Plane::new(nodes),
        };
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

    /// Where a strand is now: its lane and the nodes.
    pub fn each_strand(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let some = self.strands.iter().zip(self.counts).enumerate();
        some.filter(|(_, (i, _))| **i != NONE).map(|(l, (i, count))| (l, *i as usize, count))
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

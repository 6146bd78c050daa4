//! Hair that is crowded spreads: a soft repulsion through a grid.
//!
//! Every node lays the length of hair that it stands for into the cells around it; where the density rho changes from
//! place to place, hair is accelerated towards where there is less of it, by -s l grad(rho) / (rho + rho0), with s the
//! strength and l the spacing: as a gas of one temperature would be. rho0, a few strands to a cell, keeps single strands
//! from repelling themselves. Lengths are added as whole numbers, so the sums do not depend on the order.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use super::error::DynamicsError;
use super::packet::Packet;
use crate::geometry::Bounds;

/// Most cells of a grid.
const MOST: f32 = 16_777_216.0;
/// Parts of a centimetre that lengths are counted in.
const PARTS: f32 = 4096.0;
/// Strands to a cell that do not count as crowded yet.
const FEW: f32 = 4.0;

/// A grid whose memory is used again.
#[derive(Debug)]
pub struct Repulsion {
    strength: f32,
    spacing: f32,
    cells: Vec<AtomicU32>,
    counts: [usize; 3],
    min: Vec3,
}

impl Repulsion {
    /// For a strength in cm/s^2 and a spacing in cm.
    pub fn new(strength: f32, spacing: f32) -> Self {
        Self { strength, spacing, cells: vec![], counts: [0; 3], min: Vec3::ZERO }
    }

    /// Writes the acceleration of every node of all packets.
    ///
    /// # Errors
    /// When the grid over all of the hair would be too large.
    pub fn push(&mut self, packets: &mut [Packet]) -> Result<(), DynamicsError> {
        let bounds = (packets.par_iter())
            .map(|p| {
                let nodes = p.each_strand().flat_map(|(l, _, count)| (0..count).map(move |k| p.at.get(k, l)));
                Bounds::of(nodes)
            })
            .reduce(|| Bounds::EMPTY, Bounds::union)
            .grown(self.spacing);
        let size = bounds.size() / self.spacing;
        let counts = size.to_array().map(|s| s.ceil() + 1.0);
        if !(counts.iter().product::<f32>() <= MOST) {
            let [x, y, z] = bounds.size().to_array();
            let least = self.spacing * (counts.iter().product::<f32>() / MOST).cbrt() * 1.05;
            return Err(DynamicsError::Spacing {
                spacing: self.spacing,
                size: format!("{x:.0} x {y:.0} x {z:.0}"),
                least,
            });
        }
        self.counts = counts.map(|c| c as usize);
        self.min = bounds.min;
        let cells = self.counts.iter().product();
        self.cells.par_iter().for_each(|c| c.store(0, Ordering::Relaxed));
        self.cells.resize_with(cells, AtomicU32::default);
        let this = &*self;
        packets.par_iter().for_each(|p| this.lay(p));
        packets.par_iter_mut().for_each(|p| this.take(p));
        Ok(())
    }

    /// The cell of a place, and where in it.
    fn find(&self, p: Vec3) -> (usize, Vec3) {
        let q = ((p - self.min) / self.spacing).max(Vec3::ZERO);
        let cell = |k: usize| (q[k] as usize).min(self.counts[k] - 2);
        let (x, y, z) = (cell(0), cell(1), cell(2));
        let u = q - Vec3::new(x as f32, y as f32, z as f32);
        (x + self.counts[0] * (y + self.counts[1] * z), u.min(Vec3::ONE))
    }

    /// The eight corners of a cell.
    fn corners(&self, cell: usize) -> [usize; 8] {
        let [nx, ny, _] = self.counts;
        std::array::from_fn(|i| cell + (i & 1) + nx * ((i >> 1 & 1) + ny * (i >> 2)))
    }

    fn lay(&self, packet: &Packet) {
        for (l, _, count) in packet.each_strand() {
            for k in 0..count {
                let after = if k + 1 < count { packet.rest[k + 1][l] } else { 0.0 };
                let length = 0.5 * (packet.rest[k][l] + after) * PARTS;
                let (cell, u) = self.find(packet.at.get(k, l));
                for (i, corner) in self.corners(cell).into_iter().enumerate() {
                    let part = |bit: usize, u: f32| if i >> bit & 1 == 1 { u } else { 1.0 - u };
                    let share = length * part(0, u.x) * part(1, u.y) * part(2, u.z);
                    self.cells[corner].fetch_add(share as u32, Ordering::Relaxed);
                }
            }
        }
    }

    fn take(&self, packet: &mut Packet) {
        let strands: Vec<_> = packet.each_strand().collect();
        for (l, _, count) in strands {
            for k in 0..count {
                let (cell, u) = self.find(packet.at.get(k, l));
                let d = self.corners(cell).map(|c| self.cells[c].load(Ordering::Relaxed) as f32 / PARTS);
                let mix = |a: f32, b: f32, u: f32| a + (b - a) * u;
                let plane = |z: usize| {
                    let (a, b, c, e) = (d[4 * z], d[4 * z + 1], d[4 * z + 2], d[4 * z + 3]);
                    (mix(mix(a, b, u.x), mix(c, e, u.x), u.y), mix(b - a, e - c, u.y), mix(c - a, e - b, u.x))
                };
                let (low, high) = (plane(0), plane(1));
                let density = mix(low.0, high.0, u.z);
                let slope = Vec3::new(mix(low.1, high.1, u.z), mix(low.2, high.2, u.z), high.0 - low.0);
                packet.push.set(k, l, slope * (-self.strength / (density + FEW * self.spacing)));
            }
        }
    }
}

//! A garment kept out of a body.

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::{Mesh, Solid};
use crate::task::{Cancelled, Task};

/// Rounds of pushing and smoothing.
const ROUNDS: usize = 12;

/// What came out.
#[derive(Clone, Debug)]
pub struct Cleared {
    /// Where every vertex goes.
    pub positions: Vec<Vec3>,
    /// How many vertices were nearer than the margin.
    pub dipped: usize,
    /// How deep the deepest of them was below the margin, cm.
    pub deepest: f32,
    /// How many still are inside the body; 0 but in places that no push leads out of.
    pub left: usize,
}

/// Pushes every vertex that lies in the body, or nearer to it than `margin` cm, out along the body's normal. The pushes are
/// spread smoothly over the cloth around, so that no dent is left; the middles of edges and triangles are kept out too.
/// Vertices at one place move together; what is not near stays to the bit.
///
/// # Errors
/// Cancelling.
pub fn clear(mesh: &Mesh, body: &Solid, margin: f32, task: &Task) -> Result<Cleared, Cancelled> {
    clear_all(mesh, &mesh.weld(), body, margin, task)
}

/// The same with vertices of one place known already.
///
/// # Errors
/// Cancelling.
pub fn clear_all(mesh: &Mesh, same: &[u32], body: &Solid, margin: f32, task: &Task) -> Result<Cleared, Cancelled> {
    let near = beside(mesh, same);
    let mut p = mesh.positions.clone();
    let reach = body.bounds().grown(margin);
    let push = |p: Vec3, margin: f32| -> Vec3 {
        // The quick lower bound first: most of a garment is nowhere near.
        if !reach.contains(p) || body.clearance(p) >= margin {
            return Vec3::ZERO;
        }
        let on = body.closest(p);
        if on.distance < margin { on.position + on.normal * margin - p } else { Vec3::ZERO }
    };
    let (mut dipped, mut deepest) = (0, 0.0_f32);
    for round in 0..ROUNDS {
        task.check()?;
        task.progress("clear", round as f32 / ROUNDS as f32);
        let own: Vec<Vec3> = p
            .par_iter()
            .enumerate()
            .map(|(v, &at)| if same[v] as usize == v { push(at, margin) } else { Vec3::ZERO })
            .collect();
        if round == 0 {
            let lengths = || own.iter().map(|d| d.length()).filter(|&d| d > 1e-4);
            dipped = lengths().count();
            deepest = lengths().fold(0.0, f32::max);
        }
        // Triangles whose corners are out but whose middle is not: their corners move by what the middle lacks.
        let middles: Vec<Vec3> = mesh
            .triangles
            .par_iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| p[same[v as usize] as usize]);
                let places = [(a + b + c) / 3.0, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
                let pushes = places.map(|q| push(q, 0.5 * margin));
                pushes.into_iter().fold(Vec3::ZERO, |m, d| if d.length_squared() > m.length_squared() { d } else { m })
            })
            .collect();
        let mut wanted = own;
        for (t, by) in mesh.triangles.iter().zip(&middles) {
            if *by == Vec3::ZERO {
                continue;
            }
            for v in t.map(|v| same[v as usize] as usize) {
                if by.length_squared() > wanted[v].length_squared() {
                    wanted[v] = *by;
                }
            }
        }
        if wanted.iter().all(|d| d.length_squared() < 1e-10) {
            break;
        }
        // The last rounds push only, so that smoothing has not the last word.
        let spread = if round + 3 < ROUNDS { smoothed(&wanted, &near, same) } else { wanted };
        for v in 0..p.len() {
            let by = spread[same[v] as usize];
            if by != Vec3::ZERO {
                p[v] += by;
            }
        }
    }
    let left = (0..p.len()).filter(|&v| same[v] as usize == v).filter(|&v| body.signed_distance(p[v]) < 0.0).count();
    Ok(Cleared { positions: p, dipped, deepest, left })
}

/// Vertices that share an edge, by place.
fn beside(mesh: &Mesh, same: &[u32]) -> Vec<Vec<u32>> {
    let mut near = vec![Vec::new(); mesh.positions.len()];
    for t in &mesh.triangles {
        let t = t.map(|v| same[v as usize]);
        for k in 0..3 {
            near[t[k] as usize].extend([t[(k + 1) % 3], t[(k + 2) % 3]]);
        }
    }
    for list in &mut near {
        list.sort_unstable();
        list.dedup();
    }
    near
}

/// Pushes carried to the vertices around, each at least its own.
fn smoothed(push: &[Vec3], near: &[Vec<u32>], same: &[u32]) -> Vec<Vec3> {
    let mut out = push.to_vec();
    for _ in 0..3 {
        let before = out.clone();
        for v in (0..out.len()).filter(|&v| same[v] as usize == v && !near[v].is_empty()) {
            let mean = near[v].iter().map(|&w| before[w as usize]).sum::<Vec3>() / near[v].len() as f32;
            if mean == Vec3::ZERO && before[v] == Vec3::ZERO {
                continue;
            }
            let own = push[v];
            let mean = mean * 0.9;
            // No less than what this vertex needs itself.
            let short = if own == Vec3::ZERO { 0.0 } else { (1.0 - mean.dot(own) / own.length_squared()).max(0.0) };
            out[v] = mean + own * short;
        }
    }
    out
}

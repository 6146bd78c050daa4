//! Closed surfaces for cages: through scattered points, around points, or a mesh that is there.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, Vec3};

use super::DeformError;
use crate::geometry::{Bounds, Mesh};

/// The most control points of a cage.
pub const MOST_POINTS: usize = 500;
/// The most divisions of a cage that is made around something.
pub const MOST_CAGE_DIVISIONS: u32 = 8;

/// Directions from the middle that differ by less than this are one and the same, radians.
const SAME: f64 = 1e-3;
/// How far a direction may lie off the plane of others and still be in it.
const FLAT: f64 = 1e-6;

/// Corners with faces of three or more corners each, anticlockwise as seen from outside.
pub struct Faces {
    /// The corners.
    pub points: Vec<Vec3>,
    /// The faces.
    pub faces: Vec<Vec<u32>>,
}

/// The surface through scattered points on which neighbours in direction, as seen from their middle, are neighbours: the
/// convex hull of the directions, with every direction at the distance of its point. So every point is a corner, and from
/// the middle all of the surface is seen. Directions in a plane make one face, so that a mirrored set has the mirrored
/// surface.
///
/// # Errors
/// Too few or too many points, two in one direction, or none on one side of the middle.
pub fn through(points: Vec<Vec3>, called: &dyn Fn(usize) -> String) -> Result<Faces, DeformError> {
    let count = points.len();
    if !(4..=MOST_POINTS).contains(&count) {
        let (value, low, high) = (count as f64, 4.0, MOST_POINTS as f64);
        return Err(DeformError::OutOfRange { what: "the number of control points".into(), value, low, high });
    }
    if let Some(i) = points.iter().position(|p| !p.is_finite()) {
        return Err(DeformError::NotFinite { what: called(i), value: points[i] });
    }
    let middle = Bounds::of(points.iter().copied()).centre();
    let mut directions: Vec<DVec3> = Vec::with_capacity(count);
    for (i, &p) in points.iter().enumerate() {
        let Some(d) = (p - middle).as_dvec3().try_normalize() else {
            return Err(DeformError::InTheMiddle { which: called(i), place: p });
        };
        if let Some(k) = directions.iter().position(|o| o.distance(d) < SAME) {
            return Err(DeformError::SameDirection { first: called(k), second: called(i), middle });
        }
        directions.push(d);
    }
    let faces = hull(&directions).ok_or(DeformError::NotAround { middle })?;
    Ok(Faces { points, faces })
}

/// The faces of the convex hull of points on the unit sphere, by wrapping; `None` when the middle is not inside.
fn hull(at: &[DVec3]) -> Option<Vec<Vec<u32>>> {
    let count = at.len();
    // How far `d` lies above the plane through `a`, `b` and `c`.
    let above = |[a, b, c]: [usize; 3], d: usize| {
        (at[b] - at[a]).cross(at[c] - at[a]).try_normalize().map_or(0.0, |n| n.dot(at[d] - at[a]))
    };
    // The face on the left of an edge of the hull.
    let face = |a: usize, b: usize| -> Option<Vec<u32>> {
        let others = || (0..count).filter(|&d| d != a && d != b);
        let mut c = others().next()?;
        for d in others() {
            if above([a, b, c], d) > 0.0 {
                c = d;
            }
        }
        let normal = (at[b] - at[a]).cross(at[c] - at[a]).try_normalize()?;
        // The middle must lie well below.
        if normal.dot(at[a]) < 1e-4 || others().any(|d| normal.dot(at[d] - at[a]) > FLAT) {
            return None;
        }
        let mut ring: Vec<u32> =
            (0..count).filter(|&d| normal.dot(at[d] - at[a]).abs() <= FLAT).map(|d| d as u32).collect();
        // All lie on a circle around the normal.
        let (x, y) = (at[a] - normal * normal.dot(at[a]), normal.cross(at[a]));
        let around = |d: u32| libm::atan2(at[d as usize].dot(y), at[d as usize].dot(x));
        ring.sort_by(|&p, &q| around(p).total_cmp(&around(q)));
        let first = ring.iter().position(|&d| d as usize == a)?;
        ring.rotate_left(first);
        Some(ring)
    };
    let start = (1..count).find_map(|b| face(0, b).filter(|ring| ring.get(1) == Some(&(b as u32))))?;
    let mut faces = vec![start];
    let (mut edges, mut next) = (BTreeSet::new(), 0);
    for &[a, b] in &ring_edges(&faces[0]) {
        edges.insert((a, b));
    }
    while next < faces.len() {
        for [a, b] in ring_edges(&faces[next]) {
            if edges.contains(&(b, a)) {
                continue;
            }
            let ring = face(b as usize, a as usize)?;
            for [a, b] in ring_edges(&ring) {
                if !edges.insert((a, b)) {
                    return None;
                }
            }
            faces.push(ring);
        }
        next += 1;
        if faces.len() > 2 * count {
            return None;
        }
    }
    let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
    let closed = edges.iter().all(|&(a, b)| edges.contains(&(b, a)));
    (closed && used.len() == count).then_some(faces)
}

fn ring_edges(ring: &[u32]) -> Vec<[u32; 2]> {
    (0..ring.len()).map(|k| [ring[k], ring[(k + 1) % ring.len()]]).collect()
}

/// A box around points, its sides divided, drawn in to the points wherever they leave room; it encloses all of them at a
/// distance of about `margin`.
///
/// # Errors
/// No points, divisions out of range.
pub fn around(places: &[Vec3], divisions: u32, margin: f32) -> Result<Faces, DeformError> {
    if !(1..=MOST_CAGE_DIVISIONS).contains(&divisions) {
        let (value, low, high) = (f64::from(divisions), 1.0, f64::from(MOST_CAGE_DIVISIONS));
        return Err(DeformError::OutOfRange { what: "`divisions`".into(), value, low, high });
    }
    let bounds = Bounds::of(places.iter().copied());
    if bounds.is_empty() {
        return Err(DeformError::Nothing { what: "points to go around" });
    }
    let (middle, half) = (bounds.centre(), 0.5 * bounds.size());
    let half = half.max(Vec3::splat((0.05 * half.max_element()).max(1e-2)));
    let n = divisions as i32;
    // Corners are the grid points on the sides of a cube, by their indices.
    let mut number: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    for i in 0..=n {
        for j in 0..=n {
            for k in 0..=n {
                if [i, j, k].iter().any(|&x| x == 0 || x == n) {
                    number.insert([i, j, k], number.len() as u32);
                }
            }
        }
    }
    let unit = |x: i32| 2.0 * x as f32 / n as f32 - 1.0;
    let cube: Vec<Vec3> = number.keys().map(|&[i, j, k]| Vec3::new(unit(i), unit(j), unit(k))).collect();
    // Faces by side and cell, in the order in which `cell` counts them.
    let mut faces = Vec::new();
    for axis in 0..3 {
        for end in [0, n] {
            for u in 0..n {
                for v in 0..n {
                    let at = |du: i32, dv: i32| {
                        let mut index = [0; 3];
                        (index[axis], index[(axis + 1) % 3], index[(axis + 2) % 3]) = (end, u + du, v + dv);
                        number[&index]
                    };
                    let ring = vec![at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                    faces.push(if end == n { ring } else { ring.into_iter().rev().collect() });
                }
            }
        }
    }
    // The side and cell of a direction, and how far out it is.
    let cell = |p: Vec3| {
        let q = (p - middle) / half;
        let size = q.abs().max_element();
        let axis = (0..3).find(|&a| q[a].abs() == size).unwrap_or(0);
        let part =
            |a: usize| if size > 0.0 { ((q[a] / size + 1.0) * 0.5 * n as f32) as i32 } else { 0 }.clamp(0, n - 1);
        let side = 2 * axis as i32 + i32::from(q[axis] > 0.0);
        let index = (side * n + part((axis + 1) % 3)) * n + part((axis + 2) % 3);
        (index as usize, size)
    };
    let mut reach = vec![0.0_f32; cube.len()];
    for &p in places {
        let (face, size) = cell(p);
        for &v in &faces[face] {
            reach[v as usize] = reach[v as usize].max(size);
        }
    }
    // A corner that nothing reaches follows its neighbours, so that there are no dents to the middle.
    for _ in 0..2 * n {
        let before = reach.clone();
        for ring in &faces {
            for [a, b] in ring_edges(ring) {
                let (a, b) = (a as usize, b as usize);
                reach[a] = reach[a].max(0.75 * before[b]);
                reach[b] = reach[b].max(0.75 * before[a]);
            }
        }
    }
    let mut points: Vec<Vec3> = (cube.iter().zip(&reach))
        .map(|(&c, &r)| {
            let out = c * half * r;
            middle + out + out.normalize_or(c.normalize()) * margin
        })
        .collect();
    // Where corners differ much, a side may cut a point off: then all of it grows as much as that needs.
    let mut grow = 1.0_f32;
    for &p in places {
        grow = grow.max(outside_by(&points, &faces[cell(p).0], middle, p));
    }
    if grow > 1.0 {
        points.iter_mut().for_each(|p| *p = middle + (*p - middle) * (grow * 1.001));
    }
    Ok(Faces { points, faces })
}

/// By how much a face must grow, as seen from the middle, to have a place in its cone inside; 0 when none of its triangles
/// is in the way.
fn outside_by(points: &[Vec3], ring: &[u32], middle: Vec3, p: Vec3) -> f32 {
    let at = |v: u32| points[v as usize] - middle;
    let centre = ring.iter().map(|&v| at(v)).sum::<Vec3>() / ring.len() as f32;
    let mut by: f32 = 0.0;
    for [a, b] in ring_edges(ring) {
        let inverse = glam::Mat3::from_cols(at(a), at(b), centre).inverse();
        let x = inverse * (p - middle);
        if x.is_finite() && x.min_element() >= -1e-4 * x.length() {
            by = by.max(x.element_sum());
        }
    }
    by
}

/// A mesh as a cage: its vertices are the control points, those at one place one.
///
/// # Errors
/// A mesh that is open, turned different ways, too large, or has triangles without an area.
pub fn of(mesh: &Mesh) -> Result<Faces, DeformError> {
    let weld = mesh.weld();
    let mut used: Vec<u32> = mesh.triangles.iter().flatten().map(|&v| weld[v as usize]).collect();
    used.sort_unstable();
    used.dedup();
    if !(4..=MOST_POINTS).contains(&used.len()) {
        let (value, low, high) = (used.len() as f64, 4.0, MOST_POINTS as f64);
        return Err(DeformError::OutOfRange { what: "the number of control points".into(), value, low, high });
    }
    let points: Vec<Vec3> = used.iter().map(|&v| mesh.positions[v as usize]).collect();
    let number = |v: u32| used.binary_search(&weld[v as usize]).unwrap_or(0) as u32;
    let mut faces: Vec<Vec<u32>> = mesh.triangles.iter().map(|t| t.map(number).to_vec()).collect();
    let mut edges: BTreeMap<(u32, u32), [usize; 2]> = BTreeMap::new();
    for ring in &faces {
        let [a, b, c] = [0, 1, 2].map(|k| points[ring[k] as usize]);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        if (b - a).cross(c - a).length() <= 1e-5 * longest * longest {
            return Err(DeformError::NoArea { a, b, c });
        }
        for [a, b] in ring_edges(ring) {
            edges.entry((a.min(b), a.max(b))).or_default()[usize::from(a < b)] += 1;
        }
    }
    for (&(a, b), &[one, other]) in &edges {
        let (from, to) = (points[a as usize], points[b as usize]);
        if one + other != 2 {
            return Err(DeformError::Open { from, to, count: one + other });
        }
        if one != other {
            return Err(DeformError::WrongWay { from, to });
        }
    }
    let volume: f64 = (faces.iter())
        .map(|r| {
            let [a, b, c] = [0, 1, 2].map(|k| points[r[k] as usize].as_dvec3());
            a.dot(b.cross(c))
        })
        .sum();
    if volume < 0.0 {
        faces.iter_mut().for_each(|ring| ring.reverse());
    }
    Ok(Faces { points, faces })
}

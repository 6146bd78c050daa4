//! Stylised hair in the buffer: one mesh with an atlas, a colour and a number per tuft.

use glam::{Vec2, Vec3};

use super::buffer::{Attribute, Pen, Slot};
use super::document as json;
use super::shapes::METRES;
use crate::geometry::{Bounds, Mesh};
use crate::scene::Locks;

/// Index of the tuft in its part.
const TUFT: Attribute = Attribute::floats("_TUFT_ID", 1);
/// Index into the node's list of sources.
const SOURCE: Attribute = Attribute::floats("_SOURCE", 1);

/// (attributes, vertices, indices)
pub fn layout(locks: &Locks) -> (Vec<Attribute>, u64, u64) {
    let mut attributes = vec![
        Attribute::floats("POSITION", 3),
        Attribute::floats("NORMAL", 3),
        Attribute::floats("TANGENT", 4),
        Attribute::floats("TEXCOORD_0", 2),
        // Linear and often dark: eight bits would show steps.
        Attribute { name: "COLOR_0", component: json::U16, normalized: true, shape: "VEC4", size: 8 },
        TUFT,
    ];
    attributes.extend(has_sources(locks).then_some(SOURCE));
    let mesh = &locks.mesh.mesh;
    (attributes, mesh.positions.len() as u64, 3 * mesh.triangles.len() as u64)
}

fn has_sources(locks: &Locks) -> bool {
    locks.tufts.sources.len() > 1
}

/// Writes the surface; bounds of the positions in metres.
pub fn write(locks: &Locks, bytes: &mut [u8], slot: &Slot) -> Bounds {
    let (vertices, indices) = bytes[slot.bytes.clone()].split_at_mut(slot.vertex_bytes);
    let (mut vertices, mut indices) = (Pen(vertices), Pen(indices));
    let mesh = &locks.mesh.mesh;
    let mut bounds = Bounds::EMPTY;
    for (i, ((p, n), (tangent, side))) in mesh.positions.iter().zip(&mesh.normals).zip(tangents(mesh)).enumerate() {
        let position = *p * METRES;
        bounds = Bounds { min: bounds.min.min(position), max: bounds.max.max(position) };
        vertices.vec3(position);
        vertices.vec3(n.try_normalize().unwrap_or(Vec3::Y));
        vertices.vec3(tangent);
        vertices.float(side);
        // glTF counts v from the top of the picture.
        let uv = mesh.uvs.get(i).filter(|uv| uv.is_finite()).copied().unwrap_or(Vec2::ZERO);
        vertices.float(uv.x);
        vertices.float(1.0 - uv.y);
        let lock = locks.mesh.tuft[i] as usize;
        let colour = locks.look(lock).along(locks.place(i).y);
        colour.to_array().into_iter().chain([1.0]).for_each(|c| vertices.fraction(c));
        vertices.float(lock as f32);
        if has_sources(locks) {
            vertices.float(locks.tufts.tufts.get(lock).map_or(0.0, |t| f32::from(t.source)));
        }
    }
    for i in mesh.triangles.iter().flatten() {
        indices.index(*i);
    }
    bounds
}

/// Per vertex the unit direction in which u grows, square to the normal, and the side on which v grows: the sum over the
/// triangles around it (Lengyel 2001), for pointed ends any direction square to the normal.
pub fn tangents(mesh: &Mesh) -> Vec<(Vec3, f32)> {
    let mut sums = vec![(Vec3::ZERO, Vec3::ZERO); mesh.positions.len()];
    for (i, t) in mesh.triangles.iter().enumerate() {
        if mesh.uvs.is_empty() {
            break;
        }
        let [a, b, c] = mesh.corners(i);
        let [ua, ub, uc] = t.map(|v| mesh.uvs[v as usize]);
        let ((e, f), (s, t2)) = ((b - a, c - a), (ub - ua, uc - ua));
        let area = s.perp_dot(t2);
        if area.abs() < 1e-14 {
            continue;
        }
        // Weighted by the triangle's area in space, not in the picture.
        let weight = e.cross(f).length() * area.signum();
        let (u, v) = ((e * t2.y - f * s.y).normalize_or_zero(), (f * s.x - e * t2.x).normalize_or_zero());
        for corner in t {
            let sum = &mut sums[*corner as usize];
            sum.0 += u * weight;
            sum.1 += v * weight;
        }
    }
    sums.into_iter()
        .zip(&mesh.normals)
        .map(|((u, v), n)| {
            let n = n.try_normalize().unwrap_or(Vec3::Y);
            let tangent = (u - n * n.dot(u)).try_normalize().unwrap_or_else(|| n.any_orthonormal_vector());
            (tangent, if n.cross(tangent).dot(v) < 0.0 { -1.0 } else { 1.0 })
        })
        .collect()
}

//! A tree over triangles: rays, segments, closest points.
//!
//! The tree is `obvhs`'s two-way BVH; the closest-point walk over its nodes is our own, for it has none.

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::{INVALID_ID, Ray, RayHit};
use obvhs::triangle::Triangle;

/// Where a ray or a segment meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in units of its direction's length; 0..=1 for a segment.
    pub t: f32,
    /// Index of the triangle.
    pub triangle: u32,
    /// The place.
    pub position: Vec3,
    /// Weights of the triangle's corners, summing to 1.
    pub barycentric: Vec3,
}

/// The point of the triangles that is closest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The point on the triangle.
    pub position: Vec3,
    /// Index of the triangle; of several at the same distance the lowest.
    pub triangle: u32,
    /// Weights of the triangle's corners, summing to 1.
    pub barycentric: Vec3,
    /// Distance to the given point.
    pub distance: f32,
    /// Where the triangle stands in the tree's order.
    pub slot: u32,
}

/// A bounding-volume hierarchy over triangles.
#[derive(Clone)]
pub struct Bvh {
    tree: Bvh2,
    /// In the tree's order.
    corners: Vec<[Vec3A; 3]>,
    /// Greatest coordinate of all, for rounding.
    extent: f32,
}

impl Bvh {
    /// Builds the tree over `triangles`, whose indices must be in range and whose corners finite.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let corner = |v: u32| Vec3A::from(positions[v as usize]);
        let input: Vec<Triangle> =
            triangles.iter().map(|t| Triangle { v0: corner(t[0]), v1: corner(t[1]), v2: corner(t[2]) }).collect();
        // A closest-point walk needs every triangle wholly inside its leaf, so nothing is split.
        let params = BvhBuildParams { pre_split: false, ..BvhBuildParams::medium_build() };
        let tree = build_bvh2_from_tris(&input, params, &mut Duration::default());
        let corners = tree
            .primitive_indices
            .iter()
            .map(|&t| [input[t as usize].v0, input[t as usize].v1, input[t as usize].v2])
            .collect();
        let extent = positions.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
        Self { tree, corners, extent }
    }

    /// The first triangle on the way from `origin` along `direction`, at most `max` times its length away.
    pub fn first_hit(&self, origin: Vec3, direction: Vec3, max: f32) -> Option<Hit> {
        if self.corners.is_empty() || !direction.is_finite() || !origin.is_finite() {
            return None;
        }
        let ray = Ray::new(origin.into(), direction.into(), 0.0, max);
        let mut hit = RayHit::none();
        self.tree.ray_traverse(ray, &mut hit, |ray, slot| {
            let t = intersect(&self.corners[slot], ray.origin, ray.direction);
            if t >= 0.0 { t } else { f32::INFINITY }
        });
        if hit.primitive_id == INVALID_ID || hit.t > max {
            return None;
        }
        let position = origin + direction * hit.t;
        let slot = hit.primitive_id as usize;
        let (_, barycentric) = closest_on_triangle(position.into(), &self.corners[slot]);
        Some(Hit { t: hit.t, triangle: self.tree.primitive_indices[slot], position, barycentric })
    }

    /// Where the segment from `a` to `b` first meets a triangle.
    pub fn segment_hit(&self, a: Vec3, b: Vec3) -> Option<Hit> {
        self.first_hit(a, b - a, 1.0)
    }

    /// True when the segment from `a` to `b` meets a triangle.
    pub fn is_crossed(&self, a: Vec3, b: Vec3) -> bool {
        if self.corners.is_empty() || !a.is_finite() || !(b - a).is_finite() {
            return false;
        }
        let ray = Ray::new(a.into(), (b - a).into(), 0.0, 1.0);
        !self.tree.ray_traverse_miss(ray, |ray, slot| {
            let t = intersect(&self.corners[slot], ray.origin, ray.direction);
            if t >= 0.0 { t } else { f32::INFINITY }
        })
    }

    /// The closest point to `p`, unless it is farther away than `max`.
    pub fn closest(&self, p: Vec3, max: f32) -> Option<Closest> {
        self.closest_guessed(p, max, None)
    }

    /// The same, looked for sooner where a triangle that may be the closest is known by its slot. The answer is the one
    /// of a search through all triangles, whatever the guess.
    pub fn closest_guessed(&self, p: Vec3, max: f32, guess: Option<u32>) -> Option<Closest> {
        if self.corners.is_empty() || !p.is_finite() {
            return None;
        }
        let p = Vec3A::from(p);
        // Distances to boxes and to triangles are rounded differently: what is a little too far is looked at too, so
        // that the order of the walk does not matter.
        let rounding = 1e-6 * (self.extent + p.abs().max_element());
        let with_rounding = |squared: f32| {
            let far = squared.sqrt() + rounding;
            far * far
        };
        // A little slack, so that a point at exactly `max` is found in spite of rounding.
        let mut best = max * max * 1.000_001 + f32::MIN_POSITIVE;
        let mut found: Option<(u32, u32, Vec3A, Vec3)> = None;
        let look = |slot: u32, best: &mut f32, found: &mut Option<(u32, u32, Vec3A, Vec3)>| {
            let (q, barycentric) = closest_on_triangle(p, &self.corners[slot as usize]);
            let d = (q - p).length_squared();
            let triangle = self.tree.primitive_indices[slot as usize];
            if d < *best || (d == *best && found.is_none_or(|f| triangle < f.0)) {
                *best = d;
                *found = Some((triangle, slot, q, barycentric));
            }
        };
        if let Some(slot) = guess.filter(|&s| (s as usize) < self.corners.len()) {
            look(slot, &mut best, &mut found);
        }
        let mut limit = with_rounding(best);
        let mut stack = [(0_u32, 0.0_f32); 48];
        let mut depth = 1;
        stack[0] = (0, box_distance(&self.tree, 0, p));
        // A tree deeper than the stack (many coinciding triangles) goes on in a heap.
        let mut overflow: Vec<(u32, f32)> = Vec::new();
        loop {
            let (index, distance) = if let Some(top) = overflow.pop() {
                top
            } else if depth > 0 {
                depth -= 1;
                stack[depth]
            } else {
                break;
            };
            if distance > limit {
                continue;
            }
            let node = &self.tree.nodes[index as usize];
            if node.prim_count == 0 {
                let (left, right) = (node.first_index, node.first_index + 1);
                let mut children =
                    [(left, box_distance(&self.tree, left, p)), (right, box_distance(&self.tree, right, p))];
                if children[0].1 < children[1].1 {
                    children.swap(0, 1);
                }
                for child in children {
                    if child.1 <= limit {
                        if depth < stack.len() && overflow.is_empty() {
                            stack[depth] = child;
                            depth += 1;
                        } else {
                            overflow.push(child);
                        }
                    }
                }
                continue;
            }
            let before = best;
            for slot in node.first_index..node.first_index + node.prim_count {
                look(slot, &mut best, &mut found);
            }
            if best < before {
                limit = with_rounding(best);
            }
        }
        found.map(|(triangle, slot, q, barycentric)| Closest {
            position: q.into(),
            triangle,
            barycentric,
            distance: best.sqrt(),
            slot,
        })
    }
}

impl Bvh {
    /// The greatest `normal . x` over all triangles that come within `reach` of `p`; negative infinity where none does.
    pub fn support_within(&self, p: Vec3, reach: f32, normal: Vec3) -> f32 {
        if self.corners.is_empty() || !p.is_finite() {
            return f32::NEG_INFINITY;
        }
        let (p, normal, reach) = (Vec3A::from(p), Vec3A::from(normal), reach * reach);
        let is_up = normal.cmpge(Vec3A::ZERO);
        let support = |node: u32| {
            let aabb = &self.tree.nodes[node as usize].aabb;
            normal.dot(Vec3A::select(is_up, aabb.max, aabb.min))
        };
        let mut best = f32::NEG_INFINITY;
        let mut stack = Vec::with_capacity(64);
        stack.push((0_u32, support(0)));
        while let Some((index, most)) = stack.pop() {
            if most <= best || box_distance(&self.tree, index, p) > reach {
                continue;
            }
            let node = &self.tree.nodes[index as usize];
            if node.prim_count == 0 {
                let (left, right) = (node.first_index, node.first_index + 1);
                let mut children = [(left, support(left)), (right, support(right))];
                // The more promising one is looked at first.
                if children[0].1 > children[1].1 {
                    children.swap(0, 1);
                }
                stack.extend(children);
                continue;
            }
            for slot in node.first_index..node.first_index + node.prim_count {
                let corners = &self.corners[slot as usize];
                let most = corners.iter().map(|&c| normal.dot(c)).fold(f32::NEG_INFINITY, f32::max);
                if most > best && (closest_on_triangle(p, corners).0 - p).length_squared() <= reach {
                    best = most;
                }
            }
        }
        best
    }
}

/// Squared distance from `p` to a node's box.
fn box_distance(tree: &Bvh2, node: u32, p: Vec3A) -> f32 {
    let aabb = &tree.nodes[node as usize].aabb;
    (p.clamp(aabb.min, aabb.max) - p).length_squared()
}

/// Where the ray meets the triangle, or NaN or infinity (Moeller and Trumbore 1997, both sides). The borders are a
/// little wide, so that a ray through an edge cannot slip between two triangles.
fn intersect([a, b, c]: &[Vec3A; 3], origin: Vec3A, direction: Vec3A) -> f32 {
    const SLACK: f32 = 1e-6;
    let (e1, e2) = (*b - *a, *c - *a);
    let h = direction.cross(e2);
    let det = e1.dot(h);
    if det == 0.0 {
        return f32::INFINITY;
    }
    let inverse = 1.0 / det;
    let s = origin - *a;
    let u = s.dot(h) * inverse;
    let q = s.cross(e1);
    let v = direction.dot(q) * inverse;
    if u < -SLACK || v < -SLACK || u + v > 1.0 + SLACK {
        return f32::INFINITY;
    }
    e2.dot(q) * inverse
}

/// The point of a triangle closest to `p`, with its barycentric weights, by the Voronoi regions of its features
/// (Ericson 2005, section 5.1.5).
fn closest_on_triangle(p: Vec3A, [a, b, c]: &[Vec3A; 3]) -> (Vec3A, Vec3) {
    let (ab, ac, ap) = (*b - *a, *c - *a, p - *a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (*a, Vec3::X);
    }
    let bp = p - *b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (*b, Vec3::Y);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 - d3 > 0.0 {
        let v = d1 / (d1 - d3);
        return (*a + ab * v, Vec3::new(1.0 - v, v, 0.0));
    }
    let cp = p - *c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (*c, Vec3::Z);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 - d6 > 0.0 {
        let w = d2 / (d2 - d6);
        return (*a + ac * w, Vec3::new(1.0 - w, 0.0, w));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 && (d4 - d3) + (d5 - d6) > 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (*b + (*c - *b) * w, Vec3::new(0.0, 1.0 - w, w));
    }
    let sum = va + vb + vc;
    if sum == 0.0 {
        return (*a, Vec3::X);
    }
    let (v, w) = (vb / sum, vc / sum);
    (*a + ab * v + ac * w, Vec3::new(1.0 - v - w, v, w))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::math::{rng::Key, trig};

    /// A closed sphere with `n` rings, for the tests of this folder.
    pub(crate) fn sphere(n: usize, radius: f32) -> Mesh {
        let mut mesh = Mesh { positions: vec![Vec3::Y * radius], ..Mesh::default() };
        let m = 2 * n;
        for i in 1..n {
            for j in 0..m {
                let (a, b) = (std::f32::consts::PI * i as f32 / n as f32, std::f32::consts::TAU * j as f32 / m as f32);
                mesh.positions
                    .push(Vec3::new(trig::sin(a) * trig::cos(b), trig::cos(a), trig::sin(a) * trig::sin(b)) * radius);
            }
        }
        mesh.positions.push(Vec3::NEG_Y * radius);
        let at = |i: usize, j: usize| (1 + (i - 1) * m + j % m) as u32;
        let last = (mesh.positions.len() - 1) as u32;
        for j in 0..m {
            mesh.triangles.push([0, at(1, j + 1), at(1, j)]);
            for i in 1..n - 1 {
                mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
                mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
            }
            mesh.triangles.push([at(n - 1, j), at(n - 1, j + 1), last]);
        }
        mesh
    }

    #[test]
    fn queries_agree_with_brute_force() {
        let mesh = sphere(12, 3.0);
        let bvh = Bvh::new(&mesh.positions, &mesh.triangles);
        let key = Key::new(5, "bvh");
        for i in 0..400 {
            let p = key.with(i).direction() * key.with(i).with(9).range(0.1, 8.0);
            let corners = |t: &[u32; 3]| t.map(|v| Vec3A::from(mesh.positions[v as usize]));
            let brute = mesh
                .triangles
                .iter()
                .map(|t| (closest_on_triangle(p.into(), &corners(t)).0 - Vec3A::from(p)).length())
                .fold(f32::INFINITY, f32::min);
            let found = bvh.closest(p, f32::INFINITY).unwrap();
            assert_eq!(found.distance, brute);
            assert!(bvh.closest(p, brute * 0.99).is_none());
            assert!(bvh.closest(p, brute).is_some());
            let guess = Some(key.with(i).with(8).bits() as u32 % mesh.triangles.len() as u32);
            assert_eq!(bvh.closest_guessed(p, f32::INFINITY, guess).unwrap(), found);

            let direction = key.with(i).with(3).direction();
            let first = mesh
                .triangles
                .iter()
                .map(|t| intersect(&corners(t), p.into(), direction.into()))
                .filter(|t| *t >= 0.0 && t.is_finite())
                .fold(f32::INFINITY, f32::min);
            assert_eq!(bvh.first_hit(p, direction, 1e6).map_or(f32::INFINITY, |h| h.t), first);
            for part in [0.5, 0.999, 1.001, 2.0] {
                let end = p + direction * if first.is_finite() { first * part } else { 20.0 };
                assert_eq!(bvh.is_crossed(p, end), bvh.segment_hit(p, end).is_some());
            }
        }
    }

    #[test]
    fn coinciding_triangles_do_not_overflow() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let bvh = Bvh::new(&positions, &vec![[0, 1, 2]; 5000]);
        assert_eq!(bvh.closest(Vec3::Z, 10.0).map(|c| c.triangle), Some(0));
    }

    #[test]
    fn nothing_in_an_empty_tree() {
        let bvh = Bvh::new(&[], &[]);
        assert!(bvh.closest(Vec3::ZERO, 1.0).is_none());
        assert!(bvh.first_hit(Vec3::ZERO, Vec3::X, 1.0).is_none());
    }
}

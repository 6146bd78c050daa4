//! Cutting polygons into triangles.
//!
//! Ear clipping (Meisters 1975; the quadratic form of O'Rourke, *Computational Geometry in C*, 1.4): a polygon is seen
//! along its mean normal, and corners whose triangle holds no other corner are cut off one by one, the best shaped
//! first. So concave polygons keep their outline, and corners on a straight edge are not cut into flat triangles while
//! anything better is left.

use glam::{DVec2, DVec3, Vec3};

/// Cuts a polygon into `points.len() - 2` triangles of its corners' indices, wound as the polygon is.
///
/// Any polygon gets its triangles: a flat, crossing or bent one as well as can be, fewer than three corners none. The
/// time grows with the square of the number of corners.
///
/// ```
/// use glam::Vec3;
/// // An arrow head, concave at corner 3.
/// let arrow = [Vec3::new(0.0, 2.0, 0.0), Vec3::new(-1.0, 0.0, 0.0), Vec3::new(0.0, 0.5, 0.0), Vec3::new(1.0, 0.0, 0.0)];
/// assert_eq!(coif::geometry::polygon::triangulate(&arrow), [[0, 1, 2], [0, 2, 3]]);
/// ```
pub fn triangulate(points: &[Vec3]) -> Vec<[u32; 3]> {
    match points.len() {
        0..=2 => return Vec::new(),
        3 => return vec![[0, 1, 2]],
        _ => {}
    }
    let plane = project(points);
    if let [a, b, c, d] = plane[..] {
        return quad([a, b, c, d], points).to_vec();
    }
    Clipper::new(plane).run()
}

/// The polygon's vector area in the square of its unit (Newell's sum): its length is the area of a planar polygon.
pub fn area_vector(points: &[Vec3]) -> DVec3 {
    let Some(origin) = points.first().map(|p| p.as_dvec3()) else { return DVec3::ZERO };
    let corner = |i: usize| points[i % points.len()].as_dvec3() - origin;
    (0..points.len()).map(|i| corner(i).cross(corner(i + 1))).sum::<DVec3>() * 0.5
}

/// The corners along the mean normal, counter-clockwise, within the unit box.
fn project(points: &[Vec3]) -> Vec<DVec2> {
    let origin = points[0].as_dvec3();
    let size = points.iter().map(|p| (p.as_dvec3() - origin).abs().max_element()).fold(0.0, f64::max);
    let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
    let normal = (area_vector(points) * scale * scale).try_normalize().unwrap_or(DVec3::Z);
    let (u, v) = normal.any_orthonormal_pair();
    points.iter().map(|p| (p.as_dvec3() - origin) * scale).map(|p| DVec2::new(p.dot(u), p.dot(v))).collect()
}

/// Twice the signed area of a triangle.
fn cross(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Of a quad's two diagonals the shorter that lies inside; with equal ones the first. A concave quad has only one.
fn quad(p: [DVec2; 4], points: &[Vec3]) -> [[u32; 3]; 2] {
    let worst =
        |t: [[usize; 3]; 2]| t.map(|[a, b, c]| cross(p[a], p[b], p[c])).into_iter().fold(f64::INFINITY, f64::min);
    let (first, second) = (worst([[0, 1, 2], [0, 2, 3]]), worst([[0, 1, 3], [1, 2, 3]]));
    let is_first = if first > FLAT && second > FLAT {
        points[0].distance_squared(points[2]) <= points[1].distance_squared(points[3])
    } else {
        first >= second
    };
    if is_first { [[0, 1, 2], [0, 2, 3]] } else { [[0, 1, 3], [1, 2, 3]] }
}

/// Twice the area, in a polygon of size 1, under which a triangle counts as flat: about what `f32` corners resolve.
const FLAT: f64 = 1e-9;

/// A polygon in the course of being clipped.
struct Clipper {
    points: Vec<DVec2>,
    prev: Vec<usize>,
    next: Vec<usize>,
    /// How well shaped the ear at each corner is; `None`: cannot be cut.
    ears: Vec<Option<f64>>,
    is_reflex: Vec<bool>,
    /// The corners that are left, ascending.
    left: Vec<usize>,
}

impl Clipper {
    fn new(points: Vec<DVec2>) -> Self {
        let n = points.len();
        let mut clipper = Self {
            prev: (0..n).map(|i| (i + n - 1) % n).collect(),
            next: (0..n).map(|i| (i + 1) % n).collect(),
            ears: vec![None; n],
            is_reflex: vec![false; n],
            left: (0..n).collect(),
            points,
        };
        for i in 0..n {
            clipper.is_reflex[i] = clipper.turn(i) <= FLAT;
        }
        for i in 0..n {
            clipper.ears[i] = clipper.ear(i);
        }
        clipper
    }

    fn triangle(&self, i: usize) -> [usize; 3] {
        [self.prev[i], i, self.next[i]]
    }

    fn turn(&self, i: usize) -> f64 {
        let [a, b, c] = self.triangle(i).map(|k| self.points[k]);
        cross(a, b, c)
    }

    /// Twice the area over the square of the longest edge, if the corner may be cut.
    fn ear(&self, i: usize) -> Option<f64> {
        if self.is_reflex[i] {
            return None;
        }
        let [a, b, c] = self.triangle(i).map(|k| self.points[k]);
        let is_blocked = self.left.iter().any(|&k| {
            let p = self.points[k];
            // A point at a corner is where the outline touches itself (a bridge to a hole): it does not block.
            self.is_reflex[k]
                && p != a
                && p != b
                && p != c
                && cross(a, b, p) >= 0.0
                && cross(b, c, p) >= 0.0
                && cross(c, a, p) >= 0.0
        });
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        (!is_blocked).then(|| self.turn(i) / longest)
    }

    fn run(mut self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.points.len() - 2);
        while self.left.len() > 3 {
            // The first of the best; where the outline crosses itself and nothing is an ear, the sharpest corner.
            let best = |value: &dyn Fn(usize) -> Option<f64>| {
                let mut best: Option<(f64, usize)> = None;
                for (at, &i) in self.left.iter().enumerate() {
                    if let Some(v) = value(i).filter(|&v| best.is_none_or(|(b, _)| v > b)) {
                        best = Some((v, at));
                    }
                }
                best.map(|(_, at)| at)
            };
            let at = best(&|i| self.ears[i]).or_else(|| best(&|i| Some(self.turn(i)))).unwrap_or(0);
            let i = self.left.remove(at);
            let [a, _, c] = self.triangle(i);
            triangles.push([a as u32, i as u32, c as u32]);
            (self.next[a], self.prev[c]) = (c, a);
            for k in [a, c] {
                self.is_reflex[k] = self.turn(k) <= FLAT;
            }
            for k in [a, c] {
                self.ears[k] = self.ear(k);
            }
        }
        let i = self.left[0];
        triangles.push([i, self.next[i], self.prev[i]].map(|k| k as u32));
        triangles
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Key;

    fn areas(points: &[Vec3]) -> (f64, Vec<f64>) {
        let whole = area_vector(points);
        let n = whole.normalize();
        let part = |t: &[u32; 3]| area_vector(&t.map(|k| points[k as usize])).dot(n);
        (whole.length(), triangulate(points).iter().map(part).collect())
    }

    /// A simple polygon around the origin with `n` corners at random distances, tilted.
    fn star(key: Key, n: usize, depth: f32) -> Vec<Vec3> {
        let tilt = glam::Quat::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), key.with(9).unit() * 6.0);
        (0..n)
            .map(|i| {
                let turn = i as f32 / n as f32 * std::f32::consts::TAU;
                let r = 1.0 - depth * key.with(i as u64 + 10).unit();
                tilt * Vec3::new(r * crate::math::trig::cos(turn), r * crate::math::trig::sin(turn), 0.0)
            })
            .collect()
    }

    #[test]
    fn a_concave_polygon_keeps_its_area_and_no_triangle_turns_over() {
        for seed in 0..300 {
            let points = star(Key::new(seed, "polygon"), 4 + (seed as usize % 40), 0.95);
            let (whole, parts) = areas(&points);
            assert_eq!(parts.len(), points.len() - 2);
            assert!((parts.iter().sum::<f64>() - whole).abs() < 1e-5 * whole, "seed {seed}");
            // Triangles that do not turn over and fill the whole area cannot overlap or leave the outline.
            assert!(parts.iter().all(|&a| a > -1e-7), "seed {seed}: {parts:?}");
        }
    }

    #[test]
    fn every_point_is_in_one_triangle_exactly_when_it_is_in_the_polygon() {
        // A comb: many reflex corners, by crossing number against the triangles.
        let mut points = vec![Vec3::new(0.0, -1.0, 0.0), Vec3::new(9.0, -1.0, 0.0)];
        for i in (0..10).rev() {
            points.push(Vec3::new(i as f32, if i % 2 == 0 { 5.0 } else { 0.0 }, 0.0));
        }
        let triangles = triangulate(&points);
        let mut inside = 0;
        for i in 0..2000_u64 {
            let p = glam::Vec2::new(
                Key::new(i, "comb").with(1).unit() * 11.0 - 1.0,
                Key::new(i, "comb").with(2).unit() * 8.0 - 2.0,
            );
            let mut crossings = 0;
            for k in 0..points.len() {
                let (a, b) = (points[k], points[(k + 1) % points.len()]);
                if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
                    crossings += 1;
                }
            }
            let holds = |t: &&[u32; 3]| {
                let q = t.map(|k| points[k as usize].truncate());
                (0..3).all(|k| (q[(k + 1) % 3] - q[k]).perp_dot(p - q[k]) > 0.0)
            };
            assert_eq!(triangles.iter().filter(holds).count(), crossings % 2, "{p}");
            inside += crossings % 2;
        }
        assert!(inside > 200);
    }

    #[test]
    fn corners_on_a_straight_edge_make_no_flat_triangle() {
        // A square with two more corners on each edge.
        let mut points = Vec::new();
        for (a, d) in [(Vec3::ZERO, Vec3::X), (Vec3::X, Vec3::Z), (Vec3::X + Vec3::Z, -Vec3::X), (Vec3::Z, -Vec3::Z)] {
            points.extend([0.0, 0.25, 0.5].map(|t| a + d * t));
        }
        let (whole, parts) = areas(&points);
        assert!((whole - 1.0).abs() < 1e-12);
        assert!(parts.iter().all(|&a| a > 1e-3), "{parts:?}");
    }

    #[test]
    fn a_concave_quad_is_cut_at_its_reflex_corner_wherever_it_starts() {
        let arrow =
            [Vec3::new(0.0, 2.0, 0.0), Vec3::new(-1.0, 0.0, 0.0), Vec3::new(0.0, 0.5, 0.0), Vec3::new(1.0, 0.0, 0.0)];
        for start in 0..4 {
            let mut turned = arrow;
            turned.rotate_left(start);
            let (whole, parts) = areas(&turned);
            assert!((parts.iter().sum::<f64>() - whole).abs() < 1e-6);
            assert!(parts.iter().all(|&a| a > 0.1), "start {start}: {parts:?}");
        }
    }

    #[test]
    fn degenerate_polygons_still_get_their_triangles() {
        assert!(triangulate(&[Vec3::ZERO, Vec3::X]).is_empty());
        for points in [
            vec![Vec3::ONE; 6],
            (0..6).map(|i| Vec3::X * i as f32).collect(),
            vec![Vec3::MAX, Vec3::MIN, Vec3::X, Vec3::Y, Vec3::Z],
        ] {
            let triangles = triangulate(&points);
            assert_eq!(triangles.len(), points.len() - 2);
            assert!(triangles.iter().flatten().all(|&k| (k as usize) < points.len()));
        }
        // A bow tie crosses itself.
        assert_eq!(triangulate(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::Z]).len(), 3);
    }
}

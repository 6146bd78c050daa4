//! Level cuts through a mesh, and girths: what a tape measure reads.

use std::collections::BTreeMap;

use glam::{DVec2, Vec2, Vec3};

use super::Mesh;

crate::choices! {
    /// Which of several outlines of a cut is meant.
    pub enum Side {
        /// The largest: the torso rather than an arm.
        Middle = "middle",
        /// The largest on the left: the left leg, the left arm.
        Left = "left",
        /// The largest on the right.
        Right = "right",
    }
}

/// One outline of a cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// In order around it, all at one height.
    pub points: Vec<Vec3>,
    /// False where the cut runs out at a border of the mesh.
    pub is_closed: bool,
}

/// Where the mesh meets the plane at a height, as outlines; `which` says which triangles take part.
///
/// A vertex exactly in the plane counts as above it, so every crossing triangle has exactly two crossing edges, and
/// outlines are closed except at borders of the mesh. Vertices at the same place count as one.
pub fn cut(mesh: &Mesh, height: f32, which: impl Fn(u32) -> bool) -> Vec<Outline> {
    let crossing = |t: &[u32; 3]| {
        let above = t.map(|v| mesh.positions[v as usize].y >= height);
        above.contains(&true) && above.contains(&false)
    };
    let some: Vec<u32> =
        (0..mesh.triangles.len() as u32).filter(|&t| which(t) && crossing(&mesh.triangles[t as usize])).collect();
    let same = places(mesh, &some);
    let mut edges: Vec<[Edge; 2]> = Vec::with_capacity(some.len());
    for &t in &some {
        let corners = mesh.triangles[t as usize].map(|v| same[&v]);
        let mut ends = [(0, 0); 2];
        let mut n = 0;
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let is_above = |v: u32| mesh.positions[v as usize].y >= height;
            if is_above(a) != is_above(b) && n < 2 {
                ends[n] = (a.min(b), a.max(b));
                n += 1;
            }
        }
        edges.push(ends);
    }
    let mut meeting: BTreeMap<Edge, Vec<usize>> = BTreeMap::new();
    for (i, ends) in edges.iter().enumerate() {
        for end in ends {
            meeting.entry(*end).or_default().push(i);
        }
    }
    let place = |(a, b): Edge| {
        let (p, q) = (mesh.positions[a as usize].as_dvec3(), mesh.positions[b as usize].as_dvec3());
        let u = (f64::from(height) - p.y) / (q.y - p.y);
        let mut place = p.lerp(q, u).as_vec3();
        place.y = height;
        place
    };
    let mut used = vec![false; edges.len()];
    let mut outlines = Vec::new();
    // From open ends first, so that an open outline is not begun in its middle.
    let open =
        meeting.iter().filter(|(_, at)| at.len() % 2 == 1).flat_map(|(&end, at)| at.iter().map(move |&i| (end, i)));
    let rest = edges.iter().enumerate().map(|(i, ends)| (ends[0], i));
    for (start, first) in open.chain(rest).collect::<Vec<_>>() {
        if used[first] {
            continue;
        }
        let (mut at, mut segment) = (start, first);
        let mut points = vec![place(at)];
        loop {
            used[segment] = true;
            at = if edges[segment][0] == at { edges[segment][1] } else { edges[segment][0] };
            if at == start {
                break;
            }
            points.push(place(at));
            match meeting[&at].iter().find(|&&i| !used[i]) {
                Some(&next) => segment = next,
                None => break,
            }
        }
        if points.len() > 1 {
            outlines.push(Outline { points, is_closed: at == start });
        }
    }
    outlines
}

/// An edge by its two vertices, the lower number first.
type Edge = (u32, u32);

/// For every vertex of these triangles the first one at the same place.
fn places(mesh: &Mesh, triangles: &[u32]) -> BTreeMap<u32, u32> {
    let mut first: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    let mut same = BTreeMap::new();
    for &t in triangles {
        for v in mesh.triangles[t as usize] {
            let key = (mesh.positions[v as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
            same.insert(v, *first.entry(key).or_insert(v));
        }
    }
    same
}

impl Outline {
    /// Length along it, cm; of a closed one all around.
    pub fn perimeter(&self) -> f32 {
        let open: f64 = self.points.windows(2).map(|w| distance(w[0], w[1])).sum();
        let close = match (self.points.first(), self.points.last()) {
            (Some(&a), Some(&b)) if self.is_closed => distance(a, b),
            _ => 0.0,
        };
        (open + close) as f32
    }

    /// What a tape measure reads: the length of its convex hull, cm.
    pub fn tape(&self) -> f32 {
        around(&self.hull())
    }

    /// Its convex hull seen from above: (x, z), counter-clockwise in that plane.
    pub fn hull(&self) -> Vec<Vec2> {
        hull(self.points.iter().map(|p| Vec2::new(p.x, p.z)))
    }

    /// The middle of its bounds.
    pub fn centre(&self) -> Vec3 {
        super::Bounds::of(self.points.iter().copied()).centre()
    }
}

fn distance(a: Vec3, b: Vec3) -> f64 {
    a.as_dvec3().distance(b.as_dvec3())
}

/// Length around a closed polygon.
pub fn around(polygon: &[Vec2]) -> f32 {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(a, b)| a.as_dvec2().distance(b.as_dvec2())).sum::<f64>() as f32
}

/// The outline that is meant: the one with the longest hull on that side. In the middle two of nearly the same size
/// beside each other (legs) are ambiguous: then there is none.
pub fn outline(outlines: &[Outline], side: Side) -> Option<&Outline> {
    let mut all: Vec<(f32, &Outline)> = outlines.iter().map(|o| (o.tape(), o)).collect();
    match side {
        Side::Middle => {}
        Side::Left | Side::Right => {
            // Beside the middle of the two largest, so that legs are told apart wherever the body stands.
            let (lo, hi) = outlines
                .iter()
                .flat_map(|o| &o.points)
                .fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), p| (lo.min(p.x), hi.max(p.x)));
            let middle = 0.5 * (lo + hi);
            all.retain(|(_, o)| if side == Side::Left { o.centre().x > middle } else { o.centre().x < middle });
        }
    }
    // Longest first; of equal ones the first found.
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (length, best) = *all.first()?;
    if side == Side::Middle
        && let Some(&(second, other)) = all.get(1)
        && second > 0.8 * length
        && !is_inside(&best.hull(), other)
    {
        return None;
    }
    Some(best)
}

/// True when the middle of an outline lies within a convex polygon.
fn is_inside(polygon: &[Vec2], outline: &Outline) -> bool {
    let c = outline.centre();
    outside(polygon, Vec2::new(c.x, c.z)) <= 0.0
}

/// How far a place lies outside a convex polygon (counter-clockwise); 0 inside.
pub fn outside(polygon: &[Vec2], p: Vec2) -> f32 {
    let n = polygon.len();
    let is_in = n > 2 && (0..n).all(|i| (polygon[(i + 1) % n] - polygon[i]).perp_dot(p - polygon[i]) >= 0.0);
    if is_in {
        return 0.0;
    }
    let to_edge = |i: usize| {
        let (a, b) = (polygon[i], polygon[(i + 1) % n]);
        let d = b - a;
        let u = if d == Vec2::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
        p.distance(a + d * u)
    };
    (0..n).map(to_edge).fold(f32::INFINITY, f32::min)
}

/// The convex hull of points in a plane, counter-clockwise, by Andrew's monotone chain (1979).
pub fn hull(points: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut all: Vec<Vec2> = points.filter(|p| p.is_finite()).collect();
    all.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    all.dedup();
    if all.len() < 3 {
        return all;
    }
    let turns_right = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - b) <= 0.0;
    let chain = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && turns_right(a.as_dvec2(), b.as_dvec2(), p.as_dvec2())
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut all.iter().copied());
    hull.extend(chain(&mut all.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bvh::tests::sphere;
    use crate::math::rng::Key;

    #[test]
    fn a_sphere_is_cut_in_circles() {
        let ball = sphere(64, 5.0);
        for height in [0.0, 1.0, -3.2, 4.5] {
            let outlines = cut(&ball, height, |_| true);
            assert_eq!(outlines.len(), 1, "{height}");
            let o = &outlines[0];
            let exact = std::f32::consts::TAU * (25.0 - height * height).sqrt();
            assert!(o.is_closed && (o.perimeter() - exact).abs() < 0.01 * exact, "{height} {}", o.perimeter());
            assert!((o.tape() - o.perimeter()).abs() < 1e-4 * exact);
        }
        assert!(cut(&ball, 6.0, |_| true).is_empty());
    }

    #[test]
    fn a_cut_through_vertices_is_closed_as_well() {
        // Heights of the sphere's own rings, and its poles.
        let ball = sphere(8, 2.0);
        for p in &ball.positions {
            for o in cut(&ball, p.y, |_| true) {
                assert!(o.is_closed, "at {}", p.y);
            }
        }
    }

    #[test]
    fn a_border_opens_the_outline_and_seams_do_not() {
        let mut ball = sphere(16, 3.0);
        let half = ball.clone();
        let right = |t: u32| half.corners(t as usize).iter().all(|p| p.x > -1e-3);
        let open = cut(&ball, 0.4, right);
        assert_eq!((open.len(), open[0].is_closed), (1, false));
        // Each triangle with vertices of its own: welded by place.
        let corners: Vec<Vec3> = (0..ball.triangles.len()).flat_map(|t| ball.corners(t)).collect();
        ball.triangles = (0..ball.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        ball.positions = corners;
        let seamed = cut(&ball, 0.4, |_| true);
        assert_eq!((seamed.len(), seamed[0].is_closed), (1, true));
    }

    #[test]
    fn a_hull_holds_all_points_and_turns_left() {
        let key = Key::new(3, "hull");
        for n in [1, 2, 3, 10, 200] {
            let points: Vec<Vec2> =
                (0..n).map(|i| Vec2::new(key.with(i).unit(), (key.with(i + 1000).unit() * 8.0).floor())).collect();
            let hull = hull(points.iter().copied());
            assert!(hull.len() <= points.len());
            for p in &points {
                assert!(outside(&hull, *p) < 1e-5, "{p}");
            }
        }
        let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        assert_eq!(hull(square.into_iter()), square);
        assert_eq!((around(&square), outside(&square, Vec2::new(0.5, -2.0))), (4.0, 2.0));
    }

    #[test]
    fn the_torso_is_measured_and_not_an_arm_and_legs_need_a_side() {
        let at = |x: f32, r: f32| {
            let points = (0..40).map(|i| {
                let a = std::f32::consts::TAU * i as f32 / 40.0;
                Vec3::new(x + r * crate::math::trig::cos(a), 0.0, r * crate::math::trig::sin(a))
            });
            Outline { points: points.collect(), is_closed: true }
        };
        let body = [at(20.0, 4.0), at(0.0, 12.0), at(-20.0, 4.0)];
        assert_eq!(outline(&body, Side::Middle).map(|o| o.centre().x.abs() < 1e-4), Some(true));
        assert!(outline(&body, Side::Left).is_some_and(|o| o.centre().x > 10.0));
        let legs = [at(9.0, 8.0), at(-9.0, 8.0)];
        assert_eq!(outline(&legs, Side::Middle), None);
        assert!(outline(&legs, Side::Right).is_some_and(|o| o.centre().x < 0.0));
        // Two layers of cloth are no legs.
        let layers = [at(0.0, 8.0), at(0.0, 8.2)];
        assert!(outline(&layers, Side::Middle).is_some_and(|o| o.tape() > 51.0));
        assert_eq!(outline(&[], Side::Middle), None);
    }
}

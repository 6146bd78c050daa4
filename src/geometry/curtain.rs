//! Curtains: surfaces that stand on a line and part one side from the other.

use glam::Vec3;

use super::Bounds;

/// A polyline with a direction at each point, drawn out along these directions to both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Curtain {
    line: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[Vec3; 3]>,
    bounds: Bounds,
}

impl Curtain {
    /// Over `line` with one unit normal per point; it reaches `inward` cm against and `outward` cm along them.
    /// `None` for fewer than two different points, counts that differ or values that are not finite.
    pub fn new(line: &[Vec3], normals: &[Vec3], inward: f32, outward: f32) -> Option<Self> {
        let finite = line.iter().chain(normals).all(|p| p.is_finite()) && inward.is_finite() && outward.is_finite();
        if !finite || line.len() != normals.len() {
            return None;
        }
        let (mut points, mut directions) = (Vec::<Vec3>::new(), Vec::new());
        for (&p, &n) in line.iter().zip(normals) {
            if points.last().is_none_or(|&last| last.distance_squared(p) > 1e-10) {
                points.push(p);
                directions.push(n);
            }
        }
        if points.len() < 2 {
            return None;
        }
        let edge = |i: usize| (points[i] - directions[i] * inward, points[i] + directions[i] * outward);
        let mut triangles = Vec::with_capacity(2 * points.len());
        for i in 1..points.len() {
            let ((a, b), (c, d)) = (edge(i - 1), edge(i));
            triangles.push([a, b, d]);
            triangles.push([a, d, c]);
        }
        let bounds = Bounds::of(triangles.iter().flatten().copied());
        Some(Self { line: points, normals: directions, triangles, bounds })
    }

    /// The line it stands on.
    pub fn line(&self) -> &[Vec3] {
        &self.line
    }

    /// Unit normals, one per point of the line.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Its triangles: what the tests below are exact about.
    pub fn triangles(&self) -> &[[Vec3; 3]] {
        &self.triangles
    }

    /// True when the segment from `a` to `b` passes through it. Touching counts; a segment within the curtain's own
    /// plane does not.
    pub fn separates(&self, a: Vec3, b: Vec3) -> bool {
        let (lo, hi) = (a.min(b), a.max(b));
        if lo.cmpgt(self.bounds.max).any() || hi.cmplt(self.bounds.min).any() {
            return false;
        }
        self.triangles.iter().any(|t| {
            let (tlo, thi) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
            lo.cmple(thi).all() && hi.cmpge(tlo).all() && crosses(t, a, b)
        })
    }

    /// On which side of the line `p` lies: 1 on the side of tangent x normal (to the right of one who walks along the
    /// line on the skin), -1 on the other, 0 on it. The line goes on straight beyond its ends.
    pub fn side(&self, p: Vec3) -> f32 {
        let last = self.line.len() - 2;
        let mut best = (f32::INFINITY, 0.0);
        for i in 0..=last {
            let (a, b) = (self.line[i], self.line[i + 1]);
            let d = b - a;
            let t = (p - a).dot(d) / d.length_squared();
            let t = t.clamp(if i == 0 { f32::NEG_INFINITY } else { 0.0 }, if i == last { f32::INFINITY } else { 1.0 });
            let normal = self.normals[i].lerp(self.normals[i + 1], t.clamp(0.0, 1.0));
            let away = p - (a + d * t);
            // Distance along the skin counts, height over it does not.
            let flat = (away - normal * away.dot(normal)).length_squared();
            if flat < best.0 {
                // At a corner the mean of both segments decides, as with a pseudonormal.
                let tangent = |k: usize| (self.line[k + 1] - self.line[k]).normalize_or_zero();
                let along = match t {
                    t if t <= 0.0 && i > 0 => tangent(i - 1) + tangent(i),
                    t if t >= 1.0 && i < last => tangent(i) + tangent(i + 1),
                    _ => tangent(i),
                };
                best = (flat, along.cross(normal).dot(away));
            }
        }
        match best.1 {
            x if x > 0.0 => 1.0,
            x if x < 0.0 => -1.0,
            _ => 0.0,
        }
    }
}

/// Segment against triangle by signed volumes, in double precision; both sides, borders included. Neighbouring
/// triangles see the very same edges, so nothing slips between them.
fn crosses(t: &[Vec3; 3], a: Vec3, b: Vec3) -> bool {
    let [p, q, r] = t.map(|v| v.as_dvec3());
    let (a, b) = (a.as_dvec3(), b.as_dvec3());
    let normal = (q - p).cross(r - p);
    let (above, below) = ((a - p).dot(normal), (b - p).dot(normal));
    if (above > 0.0 && below > 0.0) || (above < 0.0 && below < 0.0) || (above == 0.0 && below == 0.0) {
        return false;
    }
    let d = b - a;
    // The order of an edge's ends must not change the result's last bit: the lower end comes first.
    let volume = |u: glam::DVec3, v: glam::DVec3| {
        let swap = (u.x, u.y, u.z) > (v.x, v.y, v.z);
        let (u, v, sign) = if swap { (v, u, -1.0) } else { (u, v, 1.0) };
        sign * d.dot((u - a).cross(v - a))
    };
    let sides = [volume(p, q), volume(q, r), volume(r, p)];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Key;

    /// Along -Z in the plane x = 0, normals up.
    fn straight() -> Curtain {
        let line: Vec<Vec3> = (0..10).map(|i| Vec3::new(0.0, 0.0, -(i as f32))).collect();
        Curtain::new(&line, &[Vec3::Y; 10], 1.0, 2.0).unwrap()
    }

    #[test]
    fn a_flat_curtain_parts_what_passes_through_its_rectangle() {
        let curtain = straight();
        let mut crossed = 0;
        for i in 0..20_000 {
            let key = Key::new(4, "curtain").with(i);
            let point = |k: u64| {
                let f = |c: u64, lo: f32, hi: f32| key.with(k).with(c).range(lo, hi);
                Vec3::new(f(0, -2.0, 2.0), f(1, -3.0, 4.0), f(2, -12.0, 3.0))
            };
            let (a, b) = (point(1), point(2));
            let at = a.lerp(b, a.x / (a.x - b.x));
            let expected = a.x * b.x < 0.0 && (-1.0..=2.0).contains(&at.y) && (-9.0..=0.0).contains(&at.z);
            crossed += usize::from(expected);
            assert_eq!(curtain.separates(a, b), expected, "{a} {b}");
            assert_eq!(curtain.separates(b, a), expected, "{b} {a}");
        }
        assert!(crossed > 2000);
    }

    #[test]
    fn nothing_slips_through_joints() {
        // A bent, twisted curtain; segments through the joints and the diagonals.
        let line: Vec<Vec3> =
            (0..20).map(|i| Key::new(1, "bend").with(i).direction() * 0.3 - Vec3::Z * i as f32).collect();
        let normals: Vec<Vec3> =
            (0..20).map(|i| (Vec3::Y + Key::new(2, "twist").with(i).direction() * 0.2).normalize()).collect();
        let curtain = Curtain::new(&line, &normals, 3.0, 3.0).unwrap();
        for i in 0..3000 {
            let key = Key::new(3, "slip").with(i);
            let t = &curtain.triangles()[(key.with(1).bits() % 38) as usize];
            let at = t[0].lerp(t[1], key.with(2).unit());
            let away = Vec3::X * 9.0 + key.with(3).direction();
            // Its ends lie beyond anything of the curtain, on different sides.
            if at.z < -1.0 && at.z > -18.0 && at.y.abs() < 1.5 {
                assert!(curtain.separates(at + away, at - away), "{i}");
            }
        }
    }

    #[test]
    fn sides_are_left_and_right_of_the_walker() {
        let curtain = straight();
        assert_eq!(curtain.side(Vec3::new(0.5, 0.3, -4.0)), 1.0);
        assert_eq!(curtain.side(Vec3::new(-0.5, -0.3, -4.0)), -1.0);
        assert_eq!(curtain.side(Vec3::new(0.0, 5.0, -4.0)), 0.0);
        assert_eq!(curtain.side(Vec3::new(-0.01, 0.0, -40.0)), -1.0);
        assert_eq!(curtain.side(Vec3::new(7.0, -2.0, 30.0)), 1.0);
    }

    #[test]
    fn bad_lines_are_refused() {
        assert!(Curtain::new(&[Vec3::ZERO], &[Vec3::Y], 1.0, 1.0).is_none());
        assert!(Curtain::new(&[Vec3::ZERO; 3], &[Vec3::Y; 3], 1.0, 1.0).is_none());
        assert!(Curtain::new(&[Vec3::ZERO, Vec3::X], &[Vec3::Y], 1.0, 1.0).is_none());
        assert!(Curtain::new(&[Vec3::ZERO, Vec3::NAN], &[Vec3::Y; 2], 1.0, 1.0).is_none());
    }
}

//! Which guides a member follows: nearest roots, on its side of every parting, that agree on a shape.

use glam::Vec3;

use crate::math::trig;

/// A tree over points for the nearest of them.
#[derive(Clone, Debug)]
pub struct Nearest {
    points: Vec<Vec3>,
    /// Indices into `points`, as a balanced tree: the middle of a range is its node, split along `axes` there.
    order: Vec<u32>,
    axes: Vec<u8>,
}

impl Nearest {
    /// Builds the tree.
    pub fn new(points: Vec<Vec3>) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut axes = vec![0; points.len()];
        build(&points, &mut order, &mut axes);
        Self { points, order, axes }
    }

    /// The `k` nearest to `p` as (squared distance, index), nearest first; equal distances by index.
    pub fn find(&self, p: Vec3, k: usize, out: &mut Vec<(f32, u32)>) {
        out.clear();
        if k > 0 {
            self.search(p, k, 0, self.order.len(), out);
        }
    }

    fn search(&self, p: Vec3, k: usize, lo: usize, hi: usize, out: &mut Vec<(f32, u32)>) {
        if lo >= hi {
            return;
        }
        let middle = (lo + hi) / 2;
        let index = self.order[middle];
        let q = self.points[index as usize];
        let entry = (p.distance_squared(q), index);
        let is_less = |a: &(f32, u32), b: &(f32, u32)| a.0 < b.0 || (a.0 == b.0 && a.1 < b.1);
        if out.len() < k || out.last().is_some_and(|last| is_less(&entry, last)) {
            let at = out.partition_point(|e| is_less(e, &entry));
            out.insert(at, entry);
            out.truncate(k);
        }
        let axis = usize::from(self.axes[middle]);
        let d = p[axis] - q[axis];
        let (near, far) = if d < 0.0 { ((lo, middle), (middle + 1, hi)) } else { ((middle + 1, hi), (lo, middle)) };
        self.search(p, k, near.0, near.1, out);
        if out.len() < k || out.last().is_some_and(|last| d * d <= last.0) {
            self.search(p, k, far.0, far.1, out);
        }
    }
}

fn build(points: &[Vec3], order: &mut [u32], axes: &mut [u8]) {
    if order.is_empty() {
        return;
    }
    let bounds = crate::geometry::Bounds::of(order.iter().map(|&i| points[i as usize]));
    let axis = bounds.size().max_position();
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |&a, &b| {
        points[a as usize][axis].total_cmp(&points[b as usize][axis]).then(a.cmp(&b))
    });
    axes[middle] = axis as u8;
    let (left, right) = order.split_at_mut(middle);
    let (left_axes, right_axes) = axes.split_at_mut(middle);
    build(points, left, left_axes);
    build(points, &mut right[1..], &mut right_axes[1..]);
}

/// How far two guides agree, 0 to 1, from their unit segment directions (equally many, at equal parts of their lengths).
///
/// Blending is right where strands run side by side and wrong where they part: half-way between a left and a right
/// pigtail there is no hair. So the mean directions of eight parts are compared, and the worst counts; and as members
/// between two curls of different phase would be straight, the directions node by node must agree on the whole.
pub fn agreement(a: &[Vec3], b: &[Vec3]) -> f32 {
    const PARTS: usize = 8;
    let n = a.len().min(b.len());
    let parts = PARTS.min(n).max(1);
    let (mut worst, mut sum) = (1.0_f32, 0.0);
    for part in 0..parts {
        let range = part * n / parts..(part + 1) * n / parts;
        let (mut ca, mut cb) = (Vec3::ZERO, Vec3::ZERO);
        for k in range {
            ca += a[k];
            cb += b[k];
            sum += a[k].dot(b[k]);
        }
        worst = worst.min(ca.normalize_or_zero().dot(cb.normalize_or_zero()));
    }
    // Full agreement within 37 degrees in every part, none beyond 73; node by node 26 and 60 degrees.
    trig::smoothstep(0.3, 0.8, worst) * trig::smoothstep(0.5, 0.9, sum / n.max(1) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Key;

    #[test]
    fn the_nearest_are_those_of_a_plain_search() {
        let key = Key::new(2, "nearest");
        for n in [0_u64, 1, 2, 7, 300] {
            let mut points: Vec<Vec3> = (0..n).map(|i| key.with(i).gaussian3()).collect();
            points.extend_from_within(..points.len() / 3);
            let tree = Nearest::new(points.clone());
            let mut found = vec![];
            for q in 0..50 {
                let p = key.with(1000 + q).gaussian3();
                for k in [1, 4, 9] {
                    tree.find(p, k, &mut found);
                    let mut all: Vec<(f32, u32)> =
                        points.iter().zip(0..).map(|(x, i)| (x.distance_squared(p), i)).collect();
                    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
                    all.truncate(k);
                    assert_eq!(found, all);
                }
            }
        }
    }

    #[test]
    fn parallel_strands_agree_and_parting_ones_do_not() {
        let down = vec![Vec3::NEG_Y; 64];
        let slanted = vec![Vec3::new(0.3, -1.0, 0.0).normalize(); 64];
        assert_eq!(agreement(&down, &down), 1.0);
        assert_eq!(agreement(&down, &slanted), 1.0);
        // Two pigtails: apart for a while, then both down.
        let side = |x: f32| [vec![Vec3::new(x, -0.3, 0.0).normalize(); 16], vec![Vec3::NEG_Y; 48]].concat();
        assert_eq!(agreement(&side(1.0), &side(-1.0)), 0.0);
    }
}

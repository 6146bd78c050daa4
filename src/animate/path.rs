//! Paths: where a handle is from frame to frame.

use std::cmp::Ordering;

use glam::Vec3;

use super::AnimateError;
use crate::geometry::Ease;
use crate::geometry::curve::catmull_rom;

crate::choices! {
    /// What joins the points of a path.
    pub enum PathCurve {
        /// A smooth curve through the points.
        Spline = "spline",
        /// Straight lines from point to point.
        Line = "line",
    }
}

crate::params! {
    /// A path for the handle of a lock. Give `points`, `offsets` or `states`.
    #[derive(PartialEq)]
    pub struct PathOptions("coif.path") {
        /// Places that the handle passes, in head space.
        points: Option<Vec<Vec3>>, unit("cm"), takes("(Point|Head.point.fields)[]");
        /// The same as seen from where the handle is at rest, so that one path does for many locks.
        offsets: Option<Vec<Vec3>>, unit("cm"), takes("Point[]");
        /// The same as numbers of states: the handle passes where it is in each; 1 is the rest.
        states: Option<Vec<usize>>, takes("integer[]");
        /// How many frames it takes.
        frames: usize = 40, range(1.0, 100_000.0);
        /// What joins the points.
        curve: PathCurve = PathCurve::Spline;
        /// How speed changes on the way; with `times`, from each point to the next.
        ease: Ease = Ease::Linear;
        /// When each point is passed, rising, in any unit: the first is the first frame, the last the last. Without them
        /// speed is even but for `ease`. A closed path has one more, for the way back to its first point.
        times: Option<Vec<f32>>;
        /// Leads from the last point on to the first.
        closed: bool = false;
        /// Turns round at the last point and comes back the same way.
        back: bool = false;
    }
}

/// Samples per piece of a spline from which lengths are measured.
const FINE: usize = 32;

impl PathOptions {
    /// True when the end is where it began.
    pub fn returns(&self) -> bool {
        self.closed || self.back
    }

    /// Where the handle is in every frame, `points` being what the path passes. In a loop the frame after the last is the
    /// first again; otherwise the last frame is at the path's end.
    ///
    /// # Errors
    /// Too few points, points that are not finite, times that do not fit or do not rise.
    pub fn sample(&self, points: &[Vec3], looped: bool) -> Result<Vec<Vec3>, AnimateError> {
        if self.frames == 0 {
            return Err(AnimateError::NoFrames);
        }
        if points.len() < 2 {
            return Err(AnimateError::PathPoints { least: 2, count: points.len() });
        }
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(AnimateError::PathPoint { number: i + 1, point: points[i] });
        }
        let pieces = Pieces::new(points, self.curve, self.closed);
        if let Some(times) = &self.times {
            if times.len() != pieces.count() + 1 {
                return Err(AnimateError::TimeCount { times: times.len(), points: pieces.count() + 1 });
            }
            let rises = |i: usize| times[i - 1].partial_cmp(&times[i]) == Some(Ordering::Less);
            if let Some(i) = (1..times.len()).find(|&i| !rises(i)) {
                return Err(AnimateError::TimeOrder { number: i + 1, time: times[i], before: times[i - 1] });
            }
        }
        let steps = if looped { self.frames } else { self.frames.saturating_sub(1).max(1) };
        let frame = |f: usize| {
            let t = f as f32 / steps as f32;
            let t = if self.back { 1.0 - (2.0 * t - 1.0).abs() } else { t };
            match &self.times {
                None => pieces.along(self.ease.at(t)),
                Some(times) => {
                    let (first, last) = (times[0], times[times.len() - 1]);
                    let now = first + t * (last - first);
                    let i = times.partition_point(|&x| x <= now).clamp(1, times.len() - 1) - 1;
                    let part = ((now - times[i]) / (times[i + 1] - times[i])).clamp(0.0, 1.0);
                    pieces.within(i, self.ease.at(part))
                }
            }
        };
        Ok((0..self.frames).map(frame).collect())
    }
}

/// A path cut at its points, with lengths.
struct Pieces {
    /// Finely sampled: place, and length so far, [`FINE`] per piece and the end.
    samples: Vec<(Vec3, f32)>,
}

impl Pieces {
    fn new(points: &[Vec3], curve: PathCurve, closed: bool) -> Self {
        let n = points.len();
        let count = if closed { n } else { n - 1 };
        // A closed spline goes on beyond its ends as if it went round again.
        let mut all = points.to_vec();
        if closed {
            all.insert(0, points[n - 1]);
            all.extend([points[0], points[1]]);
        }
        let first = usize::from(closed);
        let place = |i: usize, u: f32| match curve {
            PathCurve::Line => all[first + i].lerp(all[first + i + 1], u),
            PathCurve::Spline => catmull_rom(&all, first + i, u),
        };
        let mut samples = vec![(points[0], 0.0)];
        for i in 0..count {
            for k in 1..=FINE {
                let at = if k == FINE { all[first + i + 1] } else { place(i, k as f32 / FINE as f32) };
                let (before, length) = samples[samples.len() - 1];
                samples.push((at, length + at.distance(before)));
            }
        }
        Self { samples }
    }

    fn count(&self) -> usize {
        self.samples.len() / FINE
    }

    /// After the part `u` of the whole length.
    fn along(&self, u: f32) -> Vec3 {
        place(&self.samples, u)
    }

    /// After the part `u` of one piece's length.
    fn within(&self, piece: usize, u: f32) -> Vec3 {
        place(&self.samples[piece * FINE..=(piece + 1) * FINE], u)
    }
}

fn place(samples: &[(Vec3, f32)], u: f32) -> Vec3 {
    let (first, last) = (samples[0], samples[samples.len() - 1]);
    // Ends are met to the last bit.
    if u <= 0.0 {
        return first.0;
    }
    if u >= 1.0 {
        return last.0;
    }
    let s = first.1 + u * (last.1 - first.1);
    let i = samples.partition_point(|x| x.1 <= s).clamp(1, samples.len() - 1);
    let (a, b) = (samples[i - 1], samples[i]);
    let w = if b.1 > a.1 { ((s - a.1) / (b.1 - a.1)).clamp(0.0, 1.0) } else { 0.0 };
    a.0.lerp(b.0, w)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(frames: usize) -> PathOptions {
        PathOptions {
            points: None,
            offsets: None,
            states: None,
            frames,
            curve: PathCurve::Spline,
            ease: Ease::Linear,
            times: None,
            closed: false,
            back: false,
        }
    }

    fn square() -> Vec<Vec3> {
        vec![Vec3::ZERO, Vec3::X * 4.0, Vec3::new(4.0, 4.0, 1.0), Vec3::Y * 4.0]
    }

    fn steps(path: &[Vec3]) -> Vec<f32> {
        path.windows(2).map(|w| w[0].distance(w[1])).collect()
    }

    #[test]
    fn a_path_begins_and_ends_at_its_points_and_goes_evenly() {
        for curve in [PathCurve::Spline, PathCurve::Line] {
            let points = square();
            let path = PathOptions { curve, ..options(61) }.sample(&points, false).unwrap();
            assert_eq!((path[0], path[60], path.len()), (points[0], points[3], 61));
            let steps = steps(&path);
            let mean = steps.iter().sum::<f32>() / 60.0;
            // Only at a corner of the polyline is the straight way from frame to frame shorter.
            let even = steps.iter().filter(|s| (*s / mean - 1.0).abs() < 0.03).count();
            assert!(even >= 58, "{steps:?}");
            for p in &points {
                assert!(path.iter().any(|q| q.distance(*p) < 0.6 * mean), "{p} is not passed");
            }
        }
    }

    #[test]
    fn timed_points_are_passed_on_time() {
        let points = square();
        for ease in [Ease::Linear, Ease::In, Ease::Out, Ease::Smooth] {
            let timed = PathOptions { ease, times: Some(vec![2.0, 3.0, 3.5, 6.0]), ..options(41) };
            let path = timed.sample(&points, false).unwrap();
            for (frame, point) in [(0, 0), (10, 1), (15, 2), (40, 3)] {
                assert!(path[frame].distance(points[point]) < 1e-4, "{ease:?} frame {frame}: {}", path[frame]);
            }
        }
        // A point given twice is waited at.
        let waited = vec![points[0], points[1], points[1], points[2]];
        let path = PathOptions { times: Some(vec![0.0, 1.0, 3.0, 4.0]), ..options(41) }.sample(&waited, false).unwrap();
        assert!(path[10..=30].iter().all(|p| p.distance(points[1]) < 1e-4));
    }

    #[test]
    fn easing_starts_and_stops_where_it_says() {
        for ease in [Ease::Linear, Ease::In, Ease::Out, Ease::Smooth] {
            assert_eq!((ease.at(0.0), ease.at(1.0)), (0.0, 1.0));
            let eased = PathOptions { ease, ..options(50) }.sample(&square(), false).unwrap();
            let steps = steps(&eased);
            let (slow_start, slow_end) = (steps[0] < 0.3 * steps[24], steps[48] < 0.3 * steps[24]);
            let expected = (matches!(ease, Ease::In | Ease::Smooth), matches!(ease, Ease::Out | Ease::Smooth));
            assert_eq!((slow_start, slow_end), expected, "{ease:?}");
        }
    }

    #[test]
    fn loops_close_without_a_doubled_frame() {
        for (closed, back) in [(true, false), (false, true)] {
            let path = PathOptions { closed, back, ..options(60) };
            assert!(path.returns());
            let frames = path.sample(&square(), true).unwrap();
            let (last, mean) = (frames[59].distance(frames[0]), steps(&frames).iter().sum::<f32>() / 59.0);
            assert!((last / mean - 1.0).abs() < 0.05, "{last} {mean}");
            let once = path.sample(&square(), false).unwrap();
            assert!(once[59].distance(once[0]) < 1e-4);
        }
        let there = PathOptions { back: true, ..options(60) }.sample(&square(), true).unwrap();
        for f in 1..30 {
            assert!(there[f].distance(there[60 - f]) < 1e-3, "{f}");
        }
    }

    #[test]
    fn what_is_no_path_is_named() {
        let points = square();
        assert_eq!(options(0).sample(&points, false), Err(AnimateError::NoFrames));
        assert_eq!(options(1).sample(&points, false), Ok(vec![Vec3::ZERO]));
        assert_eq!(options(5).sample(&points[..1], false), Err(AnimateError::PathPoints { least: 2, count: 1 }));
        let broken = [points[0], Vec3::splat(f32::INFINITY)];
        assert!(matches!(options(5).sample(&broken, false), Err(AnimateError::PathPoint { number: 2, .. })));
        let timed = |times: &[f32]| PathOptions { times: Some(times.to_vec()), ..options(5) }.sample(&points, false);
        assert_eq!(timed(&[0.0, 1.0]), Err(AnimateError::TimeCount { times: 2, points: 4 }));
        let order = AnimateError::TimeOrder { number: 3, time: 1.0, before: 1.0 };
        assert_eq!(timed(&[0.0, 1.0, 1.0, 2.0]), Err(order));
    }
}

//! Motions of a head: poses at times, and the frames between them.

use glam::{Affine3A, Mat3, Vec3};

use super::Head;
use crate::geometry::{Clip, Ease};
use crate::params::{Angle, Object};

/// The joint of the neck, from the middle between the ears, cm of an adult's head: about where the skull stands on the
/// spine.
const JOINT: Vec3 = Vec3::new(0.0, -3.0, -1.5);

/// Most frames of a motion.
pub const MOST_FRAMES: usize = 100_000;

/// How far the end of a loop may lie from its beginning, as a part of a turn or in cm.
const CLOSED: f32 = 1e-4;

crate::params! {
    /// A pose of the head at a time.
    #[derive(PartialEq)]
    pub struct Pose("Head:motion.pose") {
        /// When, from the motion's beginning.
        time: f32, unit("s"), range(0.0, 3600.0);
        /// Turned to the head's left.
        yaw: Angle = Angle::degrees(0.0), range(-3600.0, 3600.0);
        /// Nodded down.
        pitch: Angle = Angle::degrees(0.0), range(-3600.0, 3600.0);
        /// Tilted to the head's left shoulder.
        roll: Angle = Angle::degrees(0.0), range(-3600.0, 3600.0);
        /// Moved, to the head's left, up, to the front.
        shift: Vec3 = Vec3::ZERO, unit("cm");
        /// How it is come to from the pose before.
        ease: Ease = Ease::Smooth;
    }
}

crate::params! {
    /// A motion of the head, by its poses at times: the head turns about the joint of its neck. In a scene (`motion`)
    /// everything on the head moves with it.
    #[derive(PartialEq)]
    pub struct MotionOptions("Head:motion") {
        /// The poses, in the order of their times.
        poses: Vec<Pose>, positional();
        /// Frames in a second.
        rate: f32 = 24.0, unit("1/s"), range(1.0, 240.0);
        /// True when the motion begins anew after the last pose, which must then be as the first.
        r#loop: bool = false;
        /// What it turns about; the joint of the neck when left out.
        pivot: Option<Vec3>, unit("cm");
    }
}

/// Why there is no such motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// One pose is no motion.
    #[error("a motion needs at least 2 poses, got `{count}`")]
    TooFewPoses {
        /// How many there are.
        count: usize,
    },
    /// A pose comes before its time.
    #[error("pose {number} is at `{time}` s, the one before it at {before} s")]
    Order {
        /// From 1.
        number: usize,
        /// Its time, s.
        time: f32,
        /// That of the pose before, s.
        before: f32,
    },
    /// The motion is shorter than one frame.
    #[error("the motion lasts `{seconds}` s, less than one frame at {rate} frames in a second")]
    TooShort {
        /// How long, s.
        seconds: f32,
        /// Frames in a second.
        rate: f32,
    },
    /// More frames than anybody looks at.
    #[error("the motion would have `{frames}` frames; at most {MOST_FRAMES} are allowed")]
    TooLong {
        /// How many.
        frames: usize,
    },
    /// A loop would jump.
    #[error("the loop would jump: the last pose is not the first one")]
    Open,
}

impl MotionError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        Some(match self {
            Self::TooFewPoses { .. } => "as in { { time = 0 }, { time = 0.5, yaw = 60 } }".into(),
            Self::Order { .. } => "give the poses in the order of their times, each later than the one before".into(),
            Self::TooShort { rate, .. } => format!("give the last pose a time of {} or more", 1.0 / rate),
            Self::TooLong { .. } => "lower the `rate`, or make the motion shorter".into(),
            Self::Open => "end with a pose like the first, or write `loop = false`".into(),
        })
    }
}

/// What a head does from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadMotion {
    /// From the head at rest to each frame, head space, cm: turns and moves only.
    pub clip: Clip<Affine3A>,
}

impl Object for HeadMotion {
    const NAME: &'static str = "Motion";
}

impl HeadMotion {
    /// The motion of `head` through poses. Frame `i` is at the time `i / rate`; a loop's frames divide its time evenly,
    /// so that its rate is met to within half a frame in the whole, and the last frame is one before the first.
    ///
    /// # Errors
    /// [`MotionError`].
    pub fn new(head: &Head, options: &MotionOptions) -> Result<Self, MotionError> {
        let poses = &options.poses;
        let (Some(first), Some(last)) = (poses.first(), poses.last().filter(|_| poses.len() > 1)) else {
            return Err(MotionError::TooFewPoses { count: poses.len() });
        };
        if let Some(i) = poses.windows(2).position(|w| w[1].time <= w[0].time) {
            let (before, time) = (poses[i].time, poses[i + 1].time);
            return Err(MotionError::Order { number: i + 2, time, before });
        }
        // The time before the first pose belongs to the motion, but a loop has no use for it.
        let start = if options.r#loop { first.time } else { 0.0 };
        let seconds = last.time - start;
        let steps = seconds * options.rate;
        let count = if options.r#loop { steps.round() as usize } else { (steps + 1e-3).floor() as usize + 1 };
        if count < 2 {
            return Err(MotionError::TooShort { seconds, rate: options.rate });
        }
        if count > MOST_FRAMES {
            return Err(MotionError::TooLong { frames: count });
        }
        let pivot = options.pivot.unwrap_or(JOINT * head.scale);
        let frames: Vec<_> = (0..count)
            .map(|i| {
                let way = if options.r#loop { seconds * i as f32 / count as f32 } else { i as f32 / options.rate };
                placed(&between(poses, start + way), pivot).into()
            })
            .collect();
        let clip = Clip { rate: options.rate, looped: options.r#loop, frames };
        if options.r#loop && !is_near(&placed(first, pivot), &placed(last, pivot)) {
            return Err(MotionError::Open);
        }
        Ok(Self { clip })
    }
}

fn is_near(a: &Affine3A, b: &Affine3A) -> bool {
    a.abs_diff_eq(*b, CLOSED)
}

/// The pose at a time; before the first and after the last it stays as they are.
fn between(poses: &[Pose], time: f32) -> Pose {
    let next = poses.partition_point(|p| p.time <= time);
    let (Some(a), Some(b)) = (next.checked_sub(1).map(|i| &poses[i]), poses.get(next)) else {
        return poses[next.saturating_sub(1)].clone();
    };
    let t = b.ease.at((time - a.time) / (b.time - a.time));
    let mix = |a: Angle, b: Angle| Angle { radians: a.radians + (b.radians - a.radians) * t };
    Pose {
        time,
        yaw: mix(a.yaw, b.yaw),
        pitch: mix(a.pitch, b.pitch),
        roll: mix(a.roll, b.roll),
        shift: a.shift.lerp(b.shift, t),
        ease: b.ease,
    }
}

/// A pose as a transform: tilted, then nodded, then turned about `pivot`, then moved.
fn placed(pose: &Pose, pivot: Vec3) -> Affine3A {
    let turn = Mat3::from_rotation_y(pose.yaw.radians)
        * Mat3::from_rotation_x(pose.pitch.radians)
        * Mat3::from_rotation_z(-pose.roll.radians);
    Affine3A::from_mat3_translation(turn, pivot + pose.shift - turn * pivot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::head::mannequin::Style;
    use crate::params::{Table, Value, read};

    fn pose(time: f32, yaw: f32) -> Pose {
        let fields = [("time".to_owned(), Value::Number(f64::from(time)))].into();
        let pose: Pose = read(&Table { fields, ..Table::default() }).unwrap();
        Pose { yaw: Angle::degrees(yaw), ..pose }
    }

    fn options(poses: Vec<Pose>, r#loop: bool) -> MotionOptions {
        MotionOptions { poses, rate: 10.0, r#loop, pivot: None }
    }

    fn head() -> Head {
        Head::mannequin(Style::Adult).unwrap()
    }

    #[test]
    fn every_pose_is_met_and_every_frame_is_rigid() {
        let head = head();
        let turn = Pose { pitch: Angle::degrees(20.0), roll: Angle::degrees(-35.0), shift: Vec3::X, ..pose(1.0, 60.0) };
        let motion =
            HeadMotion::new(&head, &options(vec![pose(0.0, 0.0), turn.clone(), pose(2.0, -60.0)], false)).unwrap();
        let pivot = JOINT * head.scale;
        assert_eq!(motion.clip.count(), 21);
        assert_eq!(*motion.clip.frames[0], Affine3A::IDENTITY);
        assert!(motion.clip.frames[10].abs_diff_eq(placed(&turn, pivot), 1e-5));
        assert!(motion.clip.frames[20].abs_diff_eq(placed(&pose(2.0, -60.0), pivot), 1e-5));
        for frame in &motion.clip.frames {
            let m = frame.matrix3;
            assert!((m.transpose() * m).abs_diff_eq(glam::Mat3A::IDENTITY, 1e-5) && m.determinant() > 0.0);
        }
        // The joint stays where it is but for the shift.
        assert!(motion.clip.frames[20].transform_point3(pivot).distance(pivot) < 1e-5);
    }

    #[test]
    fn angles_have_the_senses_that_the_words_say() {
        let at = |p: Pose, v: Vec3| placed(&p, Vec3::ZERO).transform_vector3(v);
        assert!(at(pose(0.0, 90.0), Vec3::Z).distance(Vec3::X) < 1e-6, "the face turns to the left");
        let nod = Pose { pitch: Angle::degrees(90.0), ..pose(0.0, 0.0) };
        assert!(at(nod, Vec3::Z).distance(Vec3::NEG_Y) < 1e-6, "the face looks down");
        let tilt = Pose { roll: Angle::degrees(90.0), ..pose(0.0, 0.0) };
        assert!(at(tilt, Vec3::Y).distance(Vec3::X) < 1e-6, "the vertex comes over the left shoulder");
    }

    #[test]
    fn a_loop_closes_and_has_no_frame_twice() {
        let whole = options(vec![pose(0.0, 0.0), Pose { ease: Ease::Linear, ..pose(2.0, 360.0) }], true);
        let clip = HeadMotion::new(&head(), &whole).unwrap().clip;
        assert_eq!((clip.count(), clip.looped), (20, true));
        let step = clip.frames[1].matrix3;
        for i in 0..20 {
            let (a, b) = (clip.frames[i].matrix3, clip.frames[(i + 1) % 20].matrix3);
            assert!((step * a).abs_diff_eq(b, 1e-5), "{i}");
        }
        let open = options(vec![pose(0.0, 0.0), pose(2.0, 90.0)], true);
        assert_eq!(HeadMotion::new(&head(), &open).unwrap_err(), MotionError::Open);
    }

    #[test]
    fn easings_go_from_nothing_to_all_and_never_back() {
        for ease in Ease::TEXTS.iter().filter_map(|t| Ease::parse(t)) {
            assert_eq!((ease.at(0.0), ease.at(1.0)), (0.0, 1.0), "{ease:?}");
            assert!((0..100).all(|i| ease.at(i as f32 / 100.0) <= ease.at((i + 1) as f32 / 100.0)), "{ease:?}");
        }
        // Soft ends: next to no way in the first and the last hundredth of the time.
        assert!(Ease::Smooth.at(0.01) < 0.001 && Ease::Smooth.at(0.99) > 0.999);
    }

    #[test]
    fn what_is_no_motion_is_refused() {
        let refused = |poses: Vec<Pose>| HeadMotion::new(&head(), &options(poses, false)).unwrap_err();
        assert_eq!(refused(vec![]), MotionError::TooFewPoses { count: 0 });
        assert_eq!(refused(vec![pose(0.0, 3.0)]), MotionError::TooFewPoses { count: 1 });
        let back = MotionError::Order { number: 3, time: 0.5, before: 1.0 };
        assert_eq!(refused(vec![pose(0.0, 3.0), pose(1.0, 3.0), pose(0.5, 3.0)]), back);
        assert!(matches!(refused(vec![pose(0.0, 3.0), pose(0.05, 3.0)]), MotionError::TooShort { .. }));
        let long = MotionOptions { rate: 240.0, ..options(vec![pose(0.0, 0.0), pose(3600.0, 3.0)], false) };
        assert!(matches!(HeadMotion::new(&head(), &long), Err(MotionError::TooLong { frames: 864_001 })));
    }
}

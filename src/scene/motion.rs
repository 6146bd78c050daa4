//! Motion in a scene: what its parts do from frame to frame.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::{Body, Part, Scene};
use crate::geometry::{Clip, Strands};

/// How a part moves.
#[derive(Clone, Debug)]
pub enum Motion {
    /// As a whole: the body at rest is moved by each frame's transform (head space, cm).
    Rigid(Clip<Affine3A>),
    /// Every vertex of the part's surface at each frame, cm; the normals are made from them. Surfaces and locks.
    Surface(Clip<Vec<Vec3>>),
    /// The strands and their guides at each frame, of one topology. Hair.
    Strands {
        /// What is drawn.
        strands: Clip<Strands>,
        /// What they follow; the strands again when there are no others.
        guides: Clip<Strands>,
    },
}

impl Motion {
    /// How many frames there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Rigid(clip) => clip.count(),
            Self::Surface(clip) => clip.count(),
            Self::Strands { strands, .. } => strands.count(),
        }
    }

    /// Frames in a second.
    pub fn rate(&self) -> f32 {
        match self {
            Self::Rigid(clip) => clip.rate,
            Self::Surface(clip) => clip.rate,
            Self::Strands { strands, .. } => strands.rate,
        }
    }

    /// True when the first frame follows the last.
    pub fn is_loop(&self) -> bool {
        match self {
            Self::Rigid(clip) => clip.looped,
            Self::Surface(clip) => clip.looped,
            Self::Strands { strands, .. } => strands.looped,
        }
    }
}

/// The frames of a scene that moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    /// How many frames there are, two or more: those of the longest clip.
    pub frames: usize,
    /// Frames in a second, the same for all clips.
    pub rate: f32,
    /// True when every clip is a loop.
    pub looped: bool,
}

/// Which frames of a scene that moves are shown, counted from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// The frame of still pictures.
    pub still: usize,
    /// The frames of a strip; eight of them, evenly, when there are none.
    pub strip: Vec<usize>,
}

impl Timeline {
    /// The frames that a strip shows unless others are chosen, from 0: eight, evenly, up to the last.
    pub fn strip(&self) -> Vec<usize> {
        let count = self.frames.min(8);
        (1..=count).map(|i| (i * self.frames).div_ceil(count) - 1).collect()
    }
}

impl Scene {
    /// The still scene at the frame that still pictures show.
    #[must_use]
    pub fn still(&self) -> Self {
        self.at(self.shown.still)
    }

    /// The frames, when any part moves.
    pub fn timeline(&self) -> Option<Timeline> {
        let motions = || self.parts.iter().filter_map(|p| p.motion.as_ref());
        let longest = motions().max_by_key(|m| m.count())?;
        let looped = motions().all(Motion::is_loop);
        (longest.count() > 1).then(|| Timeline { frames: longest.count(), rate: longest.rate(), looped })
    }

    /// The still scene at a frame; a scene that does not move is the same at all of them.
    #[must_use]
    pub fn at(&self, frame: usize) -> Self {
        Self { parts: self.parts.iter().map(|p| p.at(frame)).collect(), ..self.clone() }
    }
}

impl Part {
    /// The still part at a frame.
    #[must_use]
    pub fn at(&self, frame: usize) -> Self {
        let Some(motion) = &self.motion else { return self.clone() };
        let body = match (&self.body, motion) {
            (Body::Mesh(mesh, material), Motion::Rigid(clip)) => match clip.at(frame) {
                Some(transform) => Body::Mesh(Arc::new(mesh.transformed(transform)), *material),
                None => self.body.clone(),
            },
            (Body::Mesh(mesh, material), Motion::Surface(clip)) => match clip.at(frame) {
                Some(positions) => Body::Mesh(Arc::new(mesh.moved(positions)), *material),
                None => self.body.clone(),
            },
            (Body::Locks(locks), Motion::Rigid(clip)) => match clip.at(frame) {
                Some(transform) => Body::Locks(locks.with_surface(locks.mesh.mesh.transformed(transform))),
                None => self.body.clone(),
            },
            (Body::Locks(locks), Motion::Surface(clip)) => match clip.at(frame) {
                Some(positions) => Body::Locks(locks.with_surface(locks.mesh.mesh.moved(positions))),
                None => self.body.clone(),
            },
            (Body::Hair(hair), Motion::Strands { strands, guides }) => match (strands.at(frame), guides.at(frame)) {
                (Some(strands), Some(guides)) => {
                    let (strands, guides) = (Arc::clone(strands), Arc::clone(guides));
                    Body::Hair(super::Hair { strands, guides, ..hair.clone() })
                }
                _ => self.body.clone(),
            },
            (Body::Hair(hair), Motion::Rigid(clip)) => match clip.at(frame) {
                Some(by) => {
                    let (strands, guides) = (hair.strands.transformed(by), hair.guides.transformed(by));
                    Body::Hair(super::Hair { strands: Arc::new(strands), guides: Arc::new(guides), ..hair.clone() })
                }
                None => self.body.clone(),
            },
            // A script cannot pair these.
            (Body::Hair(_), Motion::Surface(_)) | (Body::Mesh(..) | Body::Locks(_), Motion::Strands { .. }) => {
                self.body.clone()
            }
        };
        Self { name: self.name.clone(), source: self.source.clone(), body, motion: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::scene::{Look, MeshMaterial, View};

    fn scene(motion: Option<Motion>) -> Scene {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            normals: vec![Vec3::Z; 3],
            ..Mesh::default()
        };
        let body = Body::Mesh(Arc::new(mesh), MeshMaterial::default());
        let part = Part { name: "head".into(), source: String::new(), body, motion };
        let (views, look) = (vec![View::Front], Look::default());
        Scene {
            name: "s".into(),
            parts: vec![part],
            views,
            look,
            placement: Affine3A::IDENTITY,
            shown: Shown::default(),
            overlay: Arc::default(),
        }
    }

    fn corner(scene: &Scene) -> (Vec3, Vec3) {
        let Body::Mesh(mesh, _) = &scene.parts[0].body else { panic!("a mesh") };
        (mesh.positions[1], mesh.normals[1])
    }

    #[test]
    fn a_scene_without_motion_has_no_timeline_and_is_the_same_at_every_frame() {
        let still = scene(None);
        assert_eq!((still.timeline(), corner(&still.at(3))), (None, (Vec3::X, Vec3::Z)));
    }

    #[test]
    fn a_strip_has_eight_frames_or_all() {
        let strip = |frames| Timeline { frames, rate: 24.0, looped: false }.strip();
        assert_eq!(strip(40), [4, 9, 14, 19, 24, 29, 34, 39]);
        assert_eq!(strip(3), [0, 1, 2]);
        let odd = strip(61);
        assert_eq!((odd.len(), odd[7]), (8, 60));
    }

    #[test]
    fn a_rigid_motion_moves_points_and_turns_normals() {
        let quarter = Affine3A::from_rotation_y(std::f32::consts::FRAC_PI_2);
        let clip = Clip::new(24.0, vec![Arc::new(Affine3A::IDENTITY), Arc::new(quarter)]);
        let moving = scene(Some(Motion::Rigid(clip)));
        assert_eq!(moving.timeline(), Some(Timeline { frames: 2, rate: 24.0, looped: false }));
        let (at, normal) = corner(&moving.at(1));
        assert!(at.distance(Vec3::NEG_Z) < 1e-6 && normal.distance(Vec3::X) < 1e-6, "{at} {normal}");
        assert!(moving.at(1).timeline().is_none());
    }

    #[test]
    fn a_surface_motion_gives_new_normals() {
        let flipped = vec![Vec3::ZERO, Vec3::Y, Vec3::X];
        let clip = Clip::new(24.0, vec![Arc::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y]), Arc::new(flipped)]);
        let moving = scene(Some(Motion::Surface(clip)));
        assert_eq!(corner(&moving.at(0)), (Vec3::X, Vec3::Z));
        assert_eq!(corner(&moving.at(1)), (Vec3::Y, Vec3::NEG_Z));
    }
}

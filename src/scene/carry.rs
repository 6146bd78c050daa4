//! Parts that are carried by a motion of the whole, besides what they do themselves.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use super::{Motion, Part};
use crate::geometry::Clip;

impl Part {
    /// Carries the part by `by` (head space, cm): a part at rest moves as a whole, a part that moves is carried frame by
    /// frame. What then loops does so only where both loops fit together.
    pub fn carry(&mut self, by: &Clip<Affine3A>) {
        let motion = match &self.motion {
            None => Motion::Rigid(by.clone()),
            Some(Motion::Rigid(clip)) => Motion::Rigid(both(clip, by, |own, by| *by * *own)),
            Some(Motion::Surface(clip)) => Motion::Surface(both(clip, by, |own: &Vec<Vec3>, by| {
                own.par_iter().map(|p| by.transform_point3(*p)).collect()
            })),
            Some(Motion::Strands { strands, guides }) => {
                let is_one = strands.frames.iter().zip(&guides.frames).all(|(a, b)| Arc::ptr_eq(a, b));
                let strands = both(strands, by, |own, by| own.transformed(by));
                let guides = if is_one { strands.clone() } else { both(guides, by, |own, by| own.transformed(by)) };
                Motion::Strands { strands, guides }
            }
        };
        self.motion = Some(motion);
    }
}

/// The clip of what `make` gives for the frames of both; as long as the longer one.
fn both<T>(own: &Clip<T>, by: &Clip<Affine3A>, make: impl Fn(&T, &Affine3A) -> T) -> Clip<T> {
    let count = own.count().max(by.count());
    let frame = |i| Some(Arc::new(make(own.at(i)?, by.at(i)?)));
    let fits = |n: usize| n > 0 && count.is_multiple_of(n);
    let looped = own.looped && by.looped && fits(own.count()) && fits(by.count());
    Clip { rate: by.rate, looped, frames: (0..count).filter_map(frame).collect() }
}

#[cfg(test)]
mod tests {
    use super::super::{Body, MeshMaterial};
    use super::*;
    use crate::geometry::Mesh;

    fn part(motion: Option<Motion>) -> Part {
        let mesh = Mesh { positions: vec![Vec3::X], ..Mesh::default() };
        let body = Body::Mesh(Arc::new(mesh), MeshMaterial::default());
        Part { name: "head".into(), source: String::new(), body, motion }
    }

    fn place(part: &Part, frame: usize) -> Vec3 {
        let Body::Mesh(mesh, _) = part.at(frame).body else { panic!("a mesh") };
        mesh.positions[0]
    }

    #[test]
    fn what_moves_itself_is_carried_besides() {
        let up: Vec<_> = (0..4).map(|i| Arc::new(Affine3A::from_translation(Vec3::Y * i as f32))).collect();
        let by = Clip { rate: 10.0, looped: true, frames: up };
        let own = |looped| {
            let frames = vec![Arc::new(vec![Vec3::X]), Arc::new(vec![Vec3::Z])];
            Motion::Surface(Clip { rate: 10.0, looped, frames })
        };
        let mut still = part(None);
        still.carry(&by);
        assert_eq!((place(&still, 3), place(&still, 5)), (Vec3::new(1.0, 3.0, 0.0), Vec3::new(1.0, 1.0, 0.0)));
        let mut looping = part(Some(own(true)));
        looping.carry(&by);
        assert_eq!(place(&looping, 3), Vec3::new(0.0, 3.0, 1.0));
        assert!(looping.motion.as_ref().is_some_and(Motion::is_loop));
        let mut ending = part(Some(own(false)));
        ending.carry(&by);
        assert_eq!(place(&ending, 2), Vec3::new(0.0, 2.0, 1.0));
        assert!(!ending.motion.as_ref().is_some_and(Motion::is_loop));
    }
}

//! What moves: time samples, one time code to a frame.

use glam::{Mat4, Vec3};

use super::Writer;
use super::text::{self, tuple};
use crate::export::ExportError;
use crate::geometry::{Bounds, Clip, Mesh};
use crate::scene::{Motion, Part};
use crate::task::Task;

impl Writer {
    /// The motion of a surface.
    pub(super) fn mesh_moves(&mut self, part: &Part, mesh: &Mesh, task: &Task) -> Result<(), ExportError> {
        match &part.motion {
            Some(Motion::Rigid(clip)) => self.placed(clip),
            Some(Motion::Surface(clip)) => {
                let at = |f: usize| clip.at(f).map_or_else(|| mesh.positions.clone(), |p| p.to_vec());
                self.extents(|f| Bounds::of(at(f)))?;
                self.samples("point3f[] points", at, task)?;
                self.samples("normal3f[] normals", |f| mesh.moved(&at(f)).normals, task)
            }
            Some(Motion::Strands { .. }) | None => Ok(()),
        }
    }

    /// The motion of strands of which these nodes are kept: (index of the strand, its nodes).
    pub(super) fn curves_move(
        &mut self,
        part: &Part,
        each: &[(usize, &[u32])],
        is_guide: bool,
        widest: f32,
        task: &Task,
    ) -> Result<(), ExportError> {
        match &part.motion {
            Some(Motion::Rigid(clip)) => self.placed(clip),
            Some(Motion::Strands { strands, guides }) => {
                let clip = if is_guide { guides } else { strands };
                let kept = || each.iter().flat_map(|(_, nodes)| nodes.iter());
                let at = |f: usize| match clip.at(f) {
                    Some(now) => kept().filter_map(|&n| now.points.get(n as usize)).copied().collect(),
                    None => vec![],
                };
                self.extents(|f| clip.at(f).map_or(Bounds::EMPTY, |s| s.bounds().grown(widest)))?;
                self.samples("point3f[] points", at, task)
            }
            Some(Motion::Surface(_)) | None => Ok(()),
        }
    }

    /// Where the part is as a whole at each frame.
    fn placed(&mut self, clip: &Clip<glam::Affine3A>) -> Result<(), ExportError> {
        self.line(2, "matrix4d xformOp:transform.timeSamples = {")?;
        for f in 0..self.frames {
            let m = Mat4::from(clip.at(f).map_or(glam::Affine3A::IDENTITY, |t| **t));
            let rows = m.to_cols_array_2d().map(|r| format!("({}, {}, {}, {})", r[0], r[1], r[2], r[3]));
            self.line(3, &format!("{f}: ({}),", rows.join(", ")))?;
        }
        self.line(2, "}")?;
        self.line(2, "uniform token[] xformOpOrder = [\"xformOp:transform\"]")
    }

    fn extents(&mut self, at: impl Fn(usize) -> Bounds) -> Result<(), ExportError> {
        self.line(2, "float3[] extent.timeSamples = {")?;
        for f in 0..self.frames {
            let bounds = at(f);
            if !bounds.is_empty() {
                let (min, max) = (text::of(&bounds.min.to_array()), text::of(&bounds.max.to_array()));
                self.line(3, &format!("{f}: [{min}, {max}],"))?;
            }
        }
        self.line(2, "}")
    }

    fn samples(&mut self, head: &str, at: impl Fn(usize) -> Vec<Vec3>, task: &Task) -> Result<(), ExportError> {
        self.line(2, &format!("{head}.timeSamples = {{"))?;
        for f in 0..self.frames {
            let before = format!("            {f}: ");
            self.list(&before, &at(f), |o, p| tuple(o, &p.to_array()), ",", task)?;
        }
        self.line(2, "}")
    }
}

//! What the debug view draws instead of hair: guides by stage, wire shapes, arrows, partings, dots.
//!
//! Everything becomes lines in space, so that it hides and is hidden like strands; the head is drawn as a ghost, and
//! what lies behind it shines through faintly.

use glam::Vec3;

use crate::math::{Colour, trig};
use crate::scene::{Hair, Overlay, Scene};

use super::camera::Camera;
use super::strands::{Bundle, Ink};

/// Colours of stages; 0 is for what no stage bent. Beyond the last they begin again at 1.
const STAGES: [u32; 9] =
    [0x8d_93_9c, 0xe4_57_2e, 0x2f_7d_e1, 0x12_a1_79, 0xe0_a1_00, 0x9b_5d_e5, 0xd6_47_8f, 0x00_a6_c8, 0x7a_8f_1c];
/// Straight pieces of a drawn circle.
const CIRCLE: usize = 48;

/// The colour in which nodes bent by stage `stage` are drawn.
pub fn stage_colour(stage: u8) -> Colour {
    let k = if stage == 0 { 0 } else { 1 + (stage as usize - 1) % (STAGES.len() - 1) };
    Colour::hex(STAGES[k])
}

/// Lines of one width, coloured per node.
#[derive(Clone, Debug)]
pub struct Wires {
    points: Vec<Vec3>,
    offsets: Vec<u32>,
    colours: Vec<Vec3>,
    width: f32,
}

impl Wires {
    /// No lines yet; `width` in pixels.
    pub fn new(width: f32) -> Self {
        Self { points: Vec::new(), offsets: vec![0], colours: Vec::new(), width }
    }

    fn line(&mut self, points: impl IntoIterator<Item = Vec3>, colour: Colour) {
        let before = self.points.len();
        self.points.extend(points);
        self.colours.resize(self.points.len(), colour.to_linear());
        if self.points.len() < before + 2 {
            self.points.truncate(before);
            self.colours.truncate(before);
            return;
        }
        self.offsets.push(self.points.len() as u32);
    }

    /// As the rasteriser takes them; `scale` are its pixels per pixel of the sheet.
    pub fn bundle(&self, scale: f32) -> Bundle<'_> {
        let width = self.width * scale;
        Bundle { points: &self.points, offsets: &self.offsets, width: [width, width], ink: Ink::Flat(&self.colours) }
    }
}

/// A word in the debug view.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// What it stands beside.
    pub at: Vec3,
    /// The word.
    pub text: String,
    /// Its colour.
    pub colour: Colour,
}

/// Everything to draw for one view.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Lines by width.
    pub wires: Vec<Wires>,
    /// Words.
    pub labels: Vec<Label>,
}

/// Draws the scene's hair parts and its overlay for `camera`; lines are `pen` pixels wide.
pub fn draw(scene: &Scene, camera: &Camera, pen: f32) -> Drawing {
    let (mut guides, mut thin, mut bold) = (Wires::new(0.6 * pen), Wires::new(1.3 * pen), Wires::new(2.6 * pen));
    let mut dots = Wires::new(1.7 * pen);
    let mut labels = Vec::new();
    let pixel = 1.0 / camera.scale;
    for (_, hair) in scene.hair() {
        bent(hair, &mut guides);
        for root in &hair.guides.roots {
            dot(root.position + root.normal * 0.05, 1.7 * pen, Colour::hex(0x50_55_5c), camera, &mut dots);
        }
    }
    for overlay in scene.hair().map(|(_, hair)| &hair.overlay).chain([&scene.overlay]) {
        shapes(overlay, camera, &mut thin, &mut labels);
        for line in &overlay.thin {
            guides.line(line.points.iter().copied(), line.colour);
        }
        for line in &overlay.lines {
            bold.line(line.points.iter().copied(), line.colour);
        }
        for marker in &overlay.markers {
            dot(marker.position, 5.0 * pen, marker.colour, camera, &mut bold);
            if !marker.label.is_empty() {
                let at = marker.position + (camera.right + camera.up) * (5.0 * pen * pixel);
                labels.push(Label { at, text: marker.label.clone(), colour: marker.colour });
            }
        }
    }
    for (_, locks) in scene.locks() {
        for (i, tuft) in locks.tufts.tufts.iter().enumerate() {
            let colour = locks.look(i).colour;
            let along = |b: [Vec3; 4]| {
                (0..=12).map(move |k| {
                    let u = k as f32 / 12.0;
                    let (ab, bc, cd) = (b[0].lerp(b[1], u), b[1].lerp(b[2], u), b[2].lerp(b[3], u));
                    ab.lerp(bc, u).lerp(bc.lerp(cd, u), u)
                })
            };
            thin.line(tuft.stroke.beziers().into_iter().flat_map(along), colour);
            for &p in tuft.stroke.points() {
                dot(p, 3.0 * pen, colour, camera, &mut dots);
            }
        }
    }
    Drawing { wires: vec![guides, thin, bold, dots], labels }
}

/// The words that every picture shows, where they stand for `camera`.
pub fn notes(scene: &Scene, camera: &Camera) -> Vec<Label> {
    /// Between a thing and its words, cm.
    const GAP: f32 = 0.8;
    let along = |p: &Vec3| p.dot(camera.right);
    let label = |note: &crate::scene::Note| {
        let end = *note.points.iter().max_by(|a, b| along(a).total_cmp(&along(b)))?;
        Some(Label { at: end + camera.right * GAP, text: note.text.clone(), colour: note.colour })
    };
    scene.overlay.notes.iter().filter_map(label).collect()
}

/// Guides, each node in the colour of the stage that bent it.
fn bent(hair: &Hair, out: &mut Wires) {
    let guides = &hair.guides;
    for i in 0..guides.count() {
        let range = guides.range(i);
        out.line(guides.points[range.clone()].iter().copied(), stage_colour(0));
        if guides.stage.len() == guides.points.len() {
            let end = out.colours.len();
            if end >= range.len() {
                let stages = guides.stage[range.clone()].iter();
                for (colour, &stage) in out.colours[end - range.len()..].iter_mut().zip(stages) {
                    *colour = stage_colour(stage).to_linear();
                }
            }
        }
    }
}

fn shapes(overlay: &Overlay, camera: &Camera, out: &mut Wires, labels: &mut Vec<Label>) {
    for b in &overlay.boxes {
        let corner = |i: usize| {
            let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            b.centre + b.axes * (b.half * Vec3::new(sign(0), sign(1), sign(2)))
        };
        for i in 0..8_usize {
            for bit in [1, 2, 4] {
                if i & bit == 0 {
                    out.line([corner(i), corner(i | bit)], b.colour);
                }
            }
        }
        // The word goes to the corner that is leftmost at the top of the picture.
        let at = (0..8).map(corner).max_by(|p, q| {
            let key = |p: &Vec3| p.dot(camera.up) - 0.5 * p.dot(camera.right);
            key(p).total_cmp(&key(q))
        });
        if let Some(at) = at.filter(|_| !b.label.is_empty()) {
            labels.push(Label { at, text: b.label.clone(), colour: b.colour });
        }
    }
    for s in &overlay.spheres {
        for (u, v) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X), (camera.right, camera.up)] {
            let circle = (0..=CIRCLE).map(|i| {
                let a = std::f32::consts::TAU * i as f32 / CIRCLE as f32;
                s.centre + (u * trig::cos(a) + v * trig::sin(a)) * s.radius
            });
            out.line(circle, s.colour);
        }
        if !s.label.is_empty() {
            let at = s.centre + camera.up * s.radius;
            labels.push(Label { at, text: s.label.clone(), colour: s.colour });
        }
    }
    for a in &overlay.arrows {
        let shaft = a.to - a.from;
        let Some(d) = shaft.try_normalize() else { continue };
        let barb = (0.22 * shaft.length()).min(1.2);
        let side = d.cross(camera.toward).try_normalize().unwrap_or_else(|| d.any_orthonormal_vector());
        out.line([a.from, a.to], a.colour);
        for sign in [1.0, -1.0] {
            out.line([a.to, a.to - d * barb + side * (0.45 * sign * barb)], a.colour);
        }
    }
}

/// A square of `size` pixels that faces the camera.
fn dot(at: Vec3, size: f32, colour: Colour, camera: &Camera, out: &mut Wires) {
    let half = camera.right * (0.5 * size / camera.scale);
    out.line([at - half, at + half], colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_stages_differ_and_the_palette_wraps() {
        for stage in 0..30 {
            assert_ne!(stage_colour(stage), stage_colour(stage + 1));
        }
        assert_eq!(stage_colour(1), stage_colour(1 + STAGES.len() as u8 - 1));
    }

    #[test]
    fn lines_without_a_segment_are_left_out() {
        let mut wires = Wires::new(1.0);
        wires.line([Vec3::X], Colour::hex(0));
        wires.line([], Colour::hex(0));
        wires.line([Vec3::X, Vec3::Y], Colour::hex(0));
        assert_eq!((wires.points.len(), wires.colours.len(), wires.offsets.as_slice()), (2, 2, &[0_u32, 2][..]));
    }
}

//! Films: pictures of a scene frame after frame from one place, and files of them (animated PNG).

use std::f32::consts::TAU;

use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;

use super::camera::{self, Framing, frame};
use super::png::{PngError, Speed, encoder};
use super::sheet::{Picture, RenderError, SheetOptions, views};
use crate::scene::{Scene, Timeline};
use crate::task::{Cancelled, Task};

/// A picture of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Which frame of the scene, from 0.
    pub frame: usize,
    /// From where: right, up, toward the viewer, as columns.
    pub sight: Mat3,
}

/// Pictures of a whole turn around a scene that does not move: five degrees each.
pub const TURN: usize = 72;

/// Every frame of a scene, from one side.
pub fn steady(timeline: &Timeline, sight: Mat3) -> Vec<Shot> {
    (0..timeline.frames).map(|frame| Shot { frame, sight }).collect()
}

/// Once around the scene from the front over the head's left, while it moves: as often through its frames as makes at
/// least [`TURN`] pictures.
pub fn turntable(timeline: Option<&Timeline>) -> Vec<Shot> {
    let count = timeline.map_or(TURN, |t| TURN.div_ceil(t.frames) * t.frames);
    let frame = |i: usize| timeline.map_or(0, |t| i % t.frames);
    (0..count).map(|i| Shot { frame: frame(i), sight: camera::turned(TAU * i as f32 / count as f32) }).collect()
}

/// One place to look at and one scale that hold every shot, so that the camera stands still or turns evenly.
///
/// # Errors
/// [`Cancelled`].
pub fn framing(scene: &Scene, shots: &[Shot], task: &Task) -> Result<Framing, Cancelled> {
    let boxes: Vec<(Vec3, Vec2)> = shots
        .par_iter()
        .map(|shot| {
            task.check()?;
            let Framing { centres, size } = frame(&scene.at(shot.frame), &[shot.sight]);
            Ok((centres.first().copied().unwrap_or(Vec3::ZERO), size))
        })
        .collect::<Result<_, Cancelled>>()?;
    let is_one = shots.windows(2).all(|w| w[0].sight == w[1].sight);
    let centre = match shots.first() {
        Some(shot) if is_one => {
            let corners = boxes.iter().flat_map(|&(centre, size)| {
                let (at, half) = (shot.sight.transpose() * centre, 0.5 * size.extend(0.0));
                [at - half, at + half]
            });
            shot.sight * crate::geometry::Bounds::of(corners).centre()
        }
        // The mean over a turn is the axis about which everything shows evenly.
        _ => boxes.iter().map(|b| b.0).sum::<Vec3>() / boxes.len().max(1) as f32,
    };
    let mut half = Vec2::splat(0.5e-3);
    for (shot, &(at, size)) in shots.iter().zip(&boxes) {
        let off = (shot.sight.transpose() * (at - centre)).truncate().abs();
        half = half.max(off + 0.5 * size);
    }
    Ok(Framing { centres: vec![centre; shots.len()], size: 2.0 * half })
}

/// The pictures of a film, without lettering, all framed alike.
///
/// # Errors
/// [`RenderError`]: cancelled, or a size out of range.
pub fn film(scene: &Scene, shots: &[Shot], options: &SheetOptions, task: &Task) -> Result<Vec<Picture>, RenderError> {
    let Framing { centres, size } = framing(scene, shots, task)?;
    let quiet = task.child().with_progress(|_, _| ());
    let draw = |(shot, &centre): (&Shot, &Vec3)| {
        task.check()?;
        let framing = Framing { centres: vec![centre], size };
        views(&scene.at(shot.frame), &[shot.sight], Some(&framing), options, &quiet)
    };
    // As many at a time as there are threads: each needs the memory of a still picture.
    let many = rayon::current_num_threads().max(1);
    let mut pictures = Vec::with_capacity(shots.len());
    for (some, centres) in shots.chunks(many).zip(centres.chunks(many)) {
        task.progress("frames", pictures.len() as f32 / shots.len() as f32);
        let drawn: Vec<Vec<Picture>> = some.par_iter().zip(centres).map(draw).collect::<Result<_, _>>()?;
        pictures.extend(drawn.into_iter().flatten());
    }
    Ok(pictures)
}

/// The bytes of an animated PNG file that plays `pictures` (of one size) at `rate` in a second, over and over.
///
/// A picture is coded as the rectangle in which it differs from the one before it.
///
/// # Errors
/// [`PngError::Coding`] for no pictures, or pictures without pixels or of different sizes.
pub fn encode(pictures: &[Picture], rate: f32, speed: Speed) -> Result<Vec<u8>, PngError> {
    let (width, height) = pictures.first().map_or((0, 0), |p| (p.width, p.height));
    let mut bytes = Vec::new();
    let written = (|| {
        let mut encoder = encoder(&mut bytes, (width, height), speed);
        encoder.set_animated(pictures.len() as u32, 0)?;
        let (seconds, parts) = delay(rate);
        encoder.set_frame_delay(seconds, parts)?;
        let mut writer = encoder.write_header()?;
        for (i, picture) in pictures.iter().enumerate() {
            let before = i.checked_sub(1).and_then(|b| pictures.get(b));
            let [x, y, w, h] = changed(before, picture);
            writer.reset_frame_position()?;
            writer.reset_frame_dimension()?;
            writer.set_frame_dimension(w, h)?;
            writer.set_frame_position(x, y)?;
            let row = picture.width as usize * 3;
            let lines = picture.pixels.chunks_exact(row.max(1)).skip(y as usize).take(h as usize);
            let part: Vec<u8> = lines.flat_map(|l| &l[x as usize * 3..(x + w) as usize * 3]).copied().collect();
            writer.write_image_data(&part)?;
        }
        writer.finish()
    })();
    written.map_err(|source| PngError::Coding { width, height, source })?;
    Ok(bytes)
}

/// The time of one frame as a fraction of a second that a file can hold.
fn delay(rate: f32) -> (u16, u16) {
    let whole = rate.round();
    if (rate - whole).abs() < 1e-4 && (1.0..65_535.0).contains(&whole) {
        return (1, whole as u16);
    }
    let thousandths = (rate * 1000.0).round();
    if thousandths < 65_535.0 {
        (1000, thousandths.max(1.0) as u16)
    } else {
        (100, (rate * 100.0).min(65_535.0) as u16)
    }
}

/// The rectangle (x, y, width, height) in which a picture differs from the one before: all of it when there is none, one
/// pixel when nothing changed.
fn changed(before: Option<&Picture>, picture: &Picture) -> [u32; 4] {
    let (width, height) = (picture.width, picture.height);
    let Some(before) = before.filter(|b| (b.width, b.height) == (width, height)) else { return [0, 0, width, height] };
    let row = (width as usize * 3).max(1);
    let rows = || picture.pixels.chunks_exact(row).zip(before.pixels.chunks_exact(row));
    let differs = |(a, b): &(&[u8], &[u8])| a != b;
    let Some(top) = rows().position(|r| differs(&r)) else { return [0, 0, 1, 1] };
    let bottom = rows().rposition(|r| differs(&r)).unwrap_or(top);
    let (mut left, mut right) = (row, 0);
    for (a, b) in rows().skip(top).take(bottom - top + 1) {
        if let Some(first) = a.iter().zip(b).position(|(a, b)| a != b) {
            left = left.min(first / 3);
            let last = a.iter().zip(b).rposition(|(a, b)| a != b).unwrap_or(first);
            right = right.max(last / 3);
        }
    }
    [left as u32, top as u32, (right - left + 1) as u32, (bottom - top + 1) as u32]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Affine3A;

    use super::*;
    use crate::geometry::{Clip, Mesh};
    use crate::scene::{Body, Look, MeshMaterial, Motion, Part, Shown, View};

    /// A small square that moves to the right, in front of a large one that does not.
    pub fn moving(frames: usize) -> Scene {
        let square = |half: f32, z: f32| Mesh {
            positions: [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| Vec3::new(x * half, y * half, z))
                .into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            normals: vec![Vec3::Z; 4],
            ..Mesh::default()
        };
        let part = |name: &str, mesh: Mesh, colour: u32, motion| Part {
            name: name.into(),
            source: String::new(),
            body: Body::Mesh(Arc::new(mesh), MeshMaterial { colour: crate::math::Colour::hex(colour), roughness: 0.9 }),
            motion,
        };
        let to = |i: usize| Arc::new(Affine3A::from_translation(Vec3::X * (i as f32 - 1.0)));
        let clip = Clip { rate: 24.0, looped: false, frames: (0..frames).map(to).collect() };
        let parts = vec![
            part("wall", square(6.0, -1.0), 0x60_80_a0, None),
            part("stone", square(1.0, 1.0), 0xc0_40_20, (frames > 0).then_some(Motion::Rigid(clip))),
        ];
        let (views, look, shown) = (vec![View::Front], Look::default(), Shown::default());
        Scene { name: "s".into(), parts, views, look, placement: Affine3A::IDENTITY, shown, overlay: Arc::default() }
    }

    fn small() -> SheetOptions {
        SheetOptions { width: 48, height: 54, supersample: 1, lettering: false, ..SheetOptions::default() }
    }

    /// What a player shows after each frame, with the delay of each, and how often the file plays.
    fn played(bytes: &[u8]) -> (Vec<Picture>, Vec<(u16, u16)>, u32) {
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let (width, height) = reader.info().size();
        let control = *reader.info().animation_control().unwrap();
        let mut shown = Picture { width, height, pixels: vec![0; width as usize * height as usize * 3] };
        let (mut pictures, mut delays) = (vec![], vec![]);
        for _ in 0..control.num_frames {
            let mut part = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut part).unwrap();
            let fc = *reader.info().frame_control().unwrap();
            assert_eq!((fc.blend_op, fc.dispose_op), (::png::BlendOp::Source, ::png::DisposeOp::None));
            for (y, line) in part[..info.buffer_size()].chunks_exact(fc.width as usize * 3).enumerate() {
                let at = ((fc.y_offset as usize + y) * width as usize + fc.x_offset as usize) * 3;
                shown.pixels[at..at + line.len()].copy_from_slice(line);
            }
            pictures.push(shown.clone());
            delays.push((fc.delay_num, fc.delay_den));
        }
        (pictures, delays, control.num_plays)
    }

    #[test]
    fn a_file_plays_what_was_drawn_at_its_rate_and_for_ever() {
        let scene = moving(5);
        let shots = steady(&scene.timeline().unwrap(), camera::axes(View::Front));
        let pictures = film(&scene, &shots, &small(), &Task::new()).unwrap();
        assert_eq!(pictures.len(), 5);
        for speed in [Speed::Fast, Speed::Balanced] {
            let bytes = encode(&pictures, 24.0, speed).unwrap();
            let (shown, delays, plays) = played(&bytes);
            assert_eq!(shown, pictures);
            assert!(delays.iter().all(|&d| d == (1, 24)) && plays == 0);
        }
        // A picture like the one before it takes next to nothing.
        let still = vec![pictures[0].clone(); 20];
        assert_eq!(played(&encode(&still, 29.97, Speed::Fast).unwrap()).1[0], (1000, 29_970));
        assert!(
            encode(&still, 24.0, Speed::Fast).unwrap().len()
                < encode(&still[..1], 24.0, Speed::Fast).unwrap().len() + 20 * 120
        );
        assert!(encode(&[], 24.0, Speed::Fast).is_err());
    }

    #[test]
    fn the_camera_stands_still_and_holds_all_frames() {
        let scene = moving(9);
        let shots = steady(&scene.timeline().unwrap(), camera::axes(View::Front));
        let all = framing(&scene, &shots, &Task::new()).unwrap();
        assert!(all.centres.windows(2).all(|w| w[0] == w[1]));
        // From the wall's left border at -6 to the stone's right one at 7 + 1.
        assert!((all.size.x - 14.0).abs() < 1e-3 && (all.centres[0].x - 1.0).abs() < 1e-3, "{all:?}");
        let pictures = film(&scene, &shots, &small(), &Task::new()).unwrap();
        // What does not move is drawn alike in all: a column of the wall that the stone never covers.
        let column = |p: &Picture| (0..54).map(|y| p.pixels[(y * 48 + 6) * 3..][..3].to_vec()).collect::<Vec<_>>();
        assert!(pictures.iter().all(|p| column(p) == column(&pictures[0])));
        assert!(pictures.windows(2).all(|w| w[0] != w[1]));
    }

    #[test]
    fn a_turntable_goes_once_around_and_ends_before_its_beginning() {
        let still = turntable(None);
        assert_eq!((still.len(), still[0].sight), (TURN, camera::axes(View::Front)));
        assert_eq!(still[TURN / 4].sight, camera::axes(View::Left));
        let moving = turntable(Some(&Timeline { frames: 30, rate: 24.0, looped: true }));
        assert_eq!((moving.len(), moving[31].frame, moving[89].frame), (90, 1, 29));
        // A wall turned edge on is no reason to come nearer.
        let framing = framing(&super::tests::moving(0), &still, &Task::new()).unwrap();
        assert!(framing.size.x > 11.9 && framing.centres.iter().all(|c| *c == framing.centres[0]));
    }

    #[test]
    fn a_film_is_the_same_on_any_number_of_threads_and_stops_when_cancelled() {
        let scene = moving(4);
        let shots = steady(&scene.timeline().unwrap(), camera::axes(View::ThreeQuarter));
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| film(&scene, &shots, &small(), &Task::new()).unwrap())
        };
        assert_eq!(on(1), on(2));
        let task = Task::new();
        task.cancel();
        assert_eq!(film(&scene, &shots, &small(), &task), Err(RenderError::Cancelled(Cancelled)));
    }
}

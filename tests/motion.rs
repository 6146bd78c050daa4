//! Files of scenes that move: GLB, played by another reader than the one that wrote them, and the time samples of USD.

mod export_scene;

use std::collections::BTreeMap;
use std::sync::Arc;

use coif::export::{ExportError, GlbOptions, MotionForm, StrandForm, UsdaOptions, glb, motions, usda};
use coif::geometry::{Clip, Mesh, Strands};
use coif::math::trig;
use coif::scene::{Body, MeshMaterial, Motion, Part, Scene};
use coif::task::{Cancelled, Task};
use export_scene::{RADIUS, ball, scene};
use glam::{Affine3A, Quat, Vec3};
use gltf::animation::util::ReadOutputs;

const FRAMES: usize = 24;
const RATE: f32 = 12.0;

/// The head's motion at a frame.
fn head(frame: usize) -> Affine3A {
    let angle = 0.9 * trig::sin(std::f32::consts::TAU * frame as f32 / FRAMES as f32);
    let pivot = Vec3::Y * -RADIUS;
    Affine3A::from_translation(pivot) * Affine3A::from_rotation_y(angle) * Affine3A::from_translation(-pivot)
}

/// Strands that sway about their roots, and turn with the head.
fn swayed(rest: &Strands, frame: usize) -> Strands {
    let mut strands = rest.clone();
    let swing = trig::sin(std::f32::consts::TAU * frame as f32 / FRAMES as f32 + 0.6) - trig::sin(0.6);
    for i in 0..strands.count() {
        let n = strands.range(i).len() as f32 - 1.0;
        for (k, at) in strands.range(i).enumerate() {
            strands.points[at] += Vec3::new(1.5 * swing, 0.3 * swing * swing, 0.0) * (k as f32 / n);
        }
    }
    strands.transformed(&head(frame))
}

/// A flag of which only the outer half moves.
fn flag(frame: usize) -> Vec<Vec3> {
    let swing = trig::sin(std::f32::consts::TAU * frame as f32 / FRAMES as f32);
    ball().positions.iter().map(|p| *p * 0.3 + Vec3::Z * (swing * (p.x - 4.0).max(0.0) + 15.0)).collect()
}

fn clip<T>(looped: bool, frame: impl Fn(usize) -> T) -> Clip<T> {
    Clip { rate: RATE, looped, frames: (0..FRAMES).map(|f| Arc::new(frame(f))).collect() }
}

/// A head that turns with hair that sways, and a flag that waves by itself.
fn moving(strands: u64, looped: bool) -> Scene {
    let mut scene = scene(strands);
    scene.parts[0].motion = Some(Motion::Rigid(clip(looped, head)));
    let (_, hair) = scene.hair().next().unwrap();
    let frames = |of: &Strands| clip(looped, |f| swayed(of, f));
    let motion = Motion::Strands { strands: frames(&hair.strands), guides: frames(&hair.guides) };
    scene.parts[1].motion = Some(motion);
    let mut mesh = Mesh { positions: flag(0), ..ball() };
    mesh.compute_normals();
    let motion = Motion::Surface(clip(looped, flag));
    let body = Body::Mesh(Arc::new(mesh), MeshMaterial::default());
    scene.parts.push(Part { name: "flag".into(), source: String::new(), body, motion: Some(motion) });
    scene
}

/// A file that can be played.
struct Player {
    document: gltf::Document,
    buffers: Vec<gltf::buffer::Data>,
}

/// What keys make of a node at a time.
#[derive(Clone, Default)]
struct Pose {
    shift: Option<Vec3>,
    turn: Option<Quat>,
    weights: Option<Vec<f32>>,
}

impl Player {
    fn new(bytes: &[u8]) -> Self {
        let (document, buffers, _) = gltf::import_slice(bytes).expect("the reader takes it");
        Self { document, buffers }
    }

    /// The poses of all animated nodes at a time, as the specification has it.
    fn poses(&self, time: f32) -> BTreeMap<usize, Pose> {
        let mut poses: BTreeMap<usize, Pose> = BTreeMap::new();
        let animation = self.document.animations().next().expect("an animation");
        for channel in animation.channels() {
            let reader = channel.reader(|b| Some(&self.buffers[b.index()]));
            let times: Vec<f32> = reader.read_inputs().unwrap().collect();
            assert!(times.windows(2).all(|w| w[0] < w[1]) && times[0] == 0.0);
            let next = times.partition_point(|t| *t <= time).clamp(1, times.len() - 1);
            let t = ((time - times[next - 1]) / (times[next] - times[next - 1])).clamp(0.0, 1.0);
            let pose = poses.entry(channel.target().node().index()).or_default();
            match reader.read_outputs().unwrap() {
                ReadOutputs::Translations(all) => {
                    let all: Vec<Vec3> = all.map(Vec3::from).collect();
                    assert_eq!(all.len(), times.len());
                    pose.shift = Some(all[next - 1].lerp(all[next], t));
                }
                ReadOutputs::Rotations(all) => {
                    let all: Vec<Quat> = all.into_f32().map(Quat::from_array).collect();
                    // Whole 32767ths are not quite of length one.
                    assert!(all.iter().all(|q| (q.length() - 1.0).abs() < 1e-4));
                    let all: Vec<Quat> = all.into_iter().map(Quat::normalize).collect();
                    pose.turn = Some(all[next - 1].slerp(all[next], t));
                }
                ReadOutputs::MorphTargetWeights(all) => {
                    let all: Vec<f32> = all.into_f32().collect();
                    let n = all.len() / times.len();
                    let mix = |k: usize| all[(next - 1) * n + k] * (1.0 - t) + all[next * n + k] * t;
                    pose.weights = Some((0..n).map(mix).collect());
                }
                ReadOutputs::Scales(_) => panic!("nothing changes its size"),
            }
        }
        poses
    }

    /// Where every node is in the file's space, with these poses; none for those outside of the scene.
    fn worlds(&self, poses: &BTreeMap<usize, Pose>) -> Vec<Affine3A> {
        let mut worlds = vec![Affine3A::IDENTITY; self.document.nodes().count()];
        let mut open: Vec<(gltf::Node, Affine3A)> =
            self.document.scenes().next().unwrap().nodes().map(|n| (n, Affine3A::IDENTITY)).collect();
        while let Some((node, above)) = open.pop() {
            let (shift, turn, size) = node.transform().decomposed();
            let pose = poses.get(&node.index()).cloned().unwrap_or_default();
            let turn = pose.turn.unwrap_or(Quat::from_array(turn));
            let shift = pose.shift.unwrap_or(Vec3::from(shift));
            let world = above * Affine3A::from_scale_rotation_translation(Vec3::from(size), turn, shift);
            worlds[node.index()] = world;
            open.extend(node.children().map(|child| (child, world)));
        }
        worlds
    }

    /// The vertices of the node of that name at a time, in the file's space, metres; with `rest` of no time at all.
    fn vertices(&self, name: &str, time: Option<f32>) -> Vec<Vec3> {
        let poses = time.map(|t| self.poses(t)).unwrap_or_default();
        let worlds = self.worlds(&poses);
        let node = self.document.nodes().find(|n| n.name() == Some(name) && n.mesh().is_some()).expect("the part");
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|b| Some(&self.buffers[b.index()]));
        let mut points: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
        let weights = poses.get(&node.index()).and_then(|p| p.weights.clone()).unwrap_or_default();
        for ((deltas, _, _), w) in reader.read_morph_targets().zip(weights) {
            for (p, d) in points.iter_mut().zip(deltas.unwrap()) {
                *p += Vec3::from(d) * w;
            }
        }
        let Some(skin) = node.skin() else {
            return points.into_iter().map(|p| worlds[node.index()].transform_point3(p)).collect();
        };
        // A skin leaves its own node out of account.
        let inverse = skin.reader(|b| Some(&self.buffers[b.index()])).read_inverse_bind_matrices().unwrap();
        let moves: Vec<Affine3A> = skin
            .joints()
            .zip(inverse)
            .map(|(joint, m)| worlds[joint.index()] * Affine3A::from_mat4(glam::Mat4::from_cols_array_2d(&m)))
            .collect();
        let joints = reader.read_joints(0).unwrap().into_u16();
        let weights = reader.read_weights(0).unwrap().into_f32();
        let moved = |((p, joints), weights): ((&Vec3, [u16; 4]), [f32; 4])| {
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            joints.iter().zip(weights).map(|(&j, w)| moves[usize::from(j)].transform_point3(*p) * w).sum()
        };
        points.iter().zip(joints).zip(weights).map(moved).collect()
    }

    /// `extras.coif.motion` of a part.
    fn told(&self, name: &str) -> serde_json::Value {
        let node = self.document.nodes().find(|n| n.name() == Some(name) && n.mesh().is_some()).unwrap();
        let extras: serde_json::Value = serde_json::from_str(node.extras().as_ref().unwrap().get()).unwrap();
        extras["coif"]["motion"].clone()
    }
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Rounding of floats in head space, metres.
const ROUNDING: f32 = 2e-6;

#[test]
fn every_frame_plays_within_the_stated_error() {
    let forms = [MotionForm::Auto, MotionForm::Shapes, MotionForm::Joints];
    for (looped, motion) in [true, false].into_iter().flat_map(|l| forms.map(|f| (l, f))) {
        let scene = moving(40, looped);
        // Every node is written, so that vertices and nodes can be told from each other.
        let options = GlbOptions { tolerance: 0.0, motion_tolerance: Some(0.02), motion, ..GlbOptions::default() };
        let player = Player::new(&glb(&scene, &options, &Task::new()).unwrap());
        assert_eq!(player.document.skins().count() == 1, motion == MotionForm::Joints);
        let error = |name: &str| {
            let told = player.told(name);
            assert_eq!((told["frames"].as_u64(), told["looped"].as_bool()), (Some(FRAMES as u64), Some(looped)));
            let error = told["error_cm"].as_f64().unwrap() as f32;
            assert!(error <= 0.02 + 1e-6, "{name} {error}");
            error * 0.01 + ROUNDING
        };
        let (head_error, hair_error, flag_error) = (error("head"), error("hair"), error("flag"));
        let in_file = |p: &Vec3| scene.placement.transform_point3(*p) * 0.01;
        for frame in 0..FRAMES {
            let time = Some(frame as f32 / RATE);
            let still = scene.at(frame);
            let Body::Mesh(mesh, _) = &still.parts[0].body else { panic!() };
            let wanted: Vec<Vec3> = mesh.positions.iter().map(in_file).collect();
            assert!(farthest(&player.vertices("head", time), &wanted) <= head_error, "head {frame}");
            let wanted: Vec<Vec3> = flag(frame).iter().map(in_file).collect();
            assert!(farthest(&player.vertices("flag", time), &wanted) <= flag_error, "flag {frame}");
            // Between the two edges of a ribbon is its strand.
            let middles: Vec<Vec3> =
                player.vertices("hair", time).chunks(2).map(|edges| 0.5 * (edges[0] + edges[1])).collect();
            let (_, hair) = still.hair().next().unwrap();
            let wanted: Vec<Vec3> = hair.strands.points.iter().map(in_file).collect();
            assert!(farthest(&middles, &wanted) <= hair_error, "hair {frame}: {}", farthest(&middles, &wanted));
        }
        // A loop ends where it began.
        let end = Some((if looped { FRAMES } else { FRAMES - 1 }) as f32 / RATE);
        let (first, last) = (player.vertices("hair", Some(0.0)), player.vertices("hair", end));
        assert_eq!(farthest(&first, &last) < 2.0 * hair_error, looped);
    }
}

#[test]
fn ribbons_keep_their_width_while_they_turn() {
    let scene = moving(10, true);
    let player =
        Player::new(&glb(&scene, &GlbOptions { tolerance: 0.0, ..GlbOptions::default() }, &Task::new()).unwrap());
    let widths = |time| -> Vec<f32> { player.vertices("hair", time).chunks(2).map(|e| e[0].distance(e[1])).collect() };
    let still = widths(None);
    for frame in 0..FRAMES {
        for (a, b) in widths(Some(frame as f32 / RATE)).iter().zip(&still) {
            assert!((a - b).abs() < 1.05e-3 * 2.0, "{a} {b}");
        }
    }
}

#[test]
fn what_moves_with_the_head_costs_nothing_and_what_stays_is_sparse() {
    let mut scene = moving(40, true);
    let text = |scene: &Scene| {
        let bytes = glb(scene, &GlbOptions::default(), &Task::new()).unwrap();
        let file = gltf::binary::Glb::from_slice(&bytes).unwrap();
        (serde_json::from_slice::<serde_json::Value>(&file.json).unwrap(), bytes.len())
    };
    let (json, _) = text(&scene);
    assert_eq!(json["animations"].as_array().unwrap().len(), 1);
    assert_eq!(json["animations"][0]["name"], "style");
    // Half of the flag does not move.
    let target = &json["meshes"][2]["primitives"][0]["targets"][0]["POSITION"];
    let accessor = &json["accessors"][target.as_u64().unwrap() as usize];
    let (count, all) = (accessor["sparse"]["count"].as_u64().unwrap(), accessor["count"].as_u64().unwrap());
    assert!(count < all / 2 && count > all / 8, "{count} of {all}");
    // A flag that waves in one direction is one shape, and where it is counted from.
    assert_eq!(json["meshes"][2]["weights"].as_array().unwrap().len(), 2);
    // Programs hold weights between 0 and 1.
    let file = gltf::Gltf::from_slice(&glb(&scene, &GlbOptions::default(), &Task::new()).unwrap()).unwrap();
    let blob = file.blob.as_deref().unwrap();
    let mut channels = 0;
    for channel in file.document.animations().flat_map(|a| a.channels()) {
        let reader = channel.reader(|_| Some(blob));
        if let Some(gltf::animation::util::ReadOutputs::MorphTargetWeights(weights)) = reader.read_outputs() {
            let weights: Vec<f32> = weights.into_f32().collect();
            assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)) && weights.contains(&0.0), "{weights:?}");
            channels += 1;
        }
    }
    assert_eq!(channels, 2);
    // Hair at rest on a head that turns: no shapes at all.
    let clip = match &scene.parts[0].motion {
        Some(Motion::Rigid(clip)) => clip.clone(),
        _ => panic!(),
    };
    scene.parts[1].motion = Some(Motion::Rigid(clip));
    let (json, _) = text(&scene);
    assert!(json["meshes"][1]["weights"].is_null());
    let carrier = json["nodes"].as_array().unwrap().iter().find(|n| n["name"] == "style motion").unwrap();
    assert_eq!(carrier["children"].as_array().unwrap().len(), 2);
}

#[test]
fn a_looser_tolerance_is_smaller_and_stays_within_itself() {
    let scene = moving(60, true);
    let file = |tolerance| {
        let options = GlbOptions { motion_tolerance: Some(tolerance), ..GlbOptions::default() };
        let bytes = glb(&scene, &options, &Task::new()).unwrap();
        let told = Player::new(&bytes).told("hair");
        (bytes.len(), told["error_cm"].as_f64().unwrap())
    };
    let (fine, rough) = (file(0.001), file(0.3));
    assert!(fine.0 > rough.0 && fine.1 <= 0.001 + 1e-6 && rough.1 <= 0.3, "{fine:?} {rough:?}");
}

/// Wisps of thirty strands that each bend and swing in their own time, so that few shapes do not show them; the first strand
/// of each is its guide.
fn lively(count: u64) -> Scene {
    let mut scene = scene(count);
    let Body::Hair(hair) = &mut scene.parts[1].body else { panic!() };
    let pick = |strands: &Strands| {
        let mut guides = Strands::new();
        for i in (0..strands.count()).step_by(30) {
            guides.push(strands.roots[i], 0, strands.strand(i).iter().copied());
        }
        guides
    };
    let mut strands = Strands::new();
    for i in 0..count as usize {
        let (first, aside) = (i - i % 30, coif::math::rng::Key::new(i as u64, "aside").direction() * 0.2);
        let aside = if i == first { Vec3::ZERO } else { aside };
        let mut root = hair.strands.roots[first];
        (root.id, root.position) = (i as u64, root.position + aside);
        strands.push(root, 0, hair.strands.strand(first).iter().map(|p| *p + aside));
        strands.guide[i] = i as u32 / 30;
    }
    let frame = |f: usize| {
        let mut now = strands.clone();
        for i in 0..now.count() {
            let key = coif::math::rng::Key::new(i as u64 / 30, "lively");
            let (phase, axis) = (key.range(0.0, 6.0), key.with(1).direction());
            let swing = trig::sin(std::f32::consts::TAU * f as f32 / FRAMES as f32 + phase) - trig::sin(phase);
            let root = now.points[now.range(i).start];
            for at in now.range(i) {
                let away = now.points[at] - root;
                let turn = Quat::from_axis_angle(axis, 0.05 * swing * away.length());
                now.points[at] = root + turn * away;
            }
        }
        now
    };
    hair.guides = Arc::new(pick(&strands));
    let motion = Motion::Strands { strands: clip(true, frame), guides: clip(true, |f| pick(&frame(f))) };
    hair.strands = Arc::new(strands);
    scene.parts[1].motion = Some(motion);
    scene
}

#[test]
fn what_many_shapes_would_show_follows_joints_for_less() {
    let scene = lively(600);
    let file = |motion| {
        let options = GlbOptions { tolerance: 0.0, motion_tolerance: Some(0.15), motion, ..GlbOptions::default() };
        glb(&scene, &options, &Task::new()).unwrap()
    };
    let (auto, shapes, joints) = (file(MotionForm::Auto), file(MotionForm::Shapes), file(MotionForm::Joints));
    assert!(auto == joints, "the smaller one is taken");
    let (many, told) = (motions(&shapes), motions(&joints));
    assert!(2 * told[0].bytes < many[0].bytes && joints.len() < shapes.len(), "{told:?} {many:?}");
    assert_eq!((told[0].part.as_str(), told[0].form.as_str(), many[0].form.as_str()), ("hair", "joints", "shapes"));
    // Thirty strands share a chain; joints are fewer than nodes.
    let (_, hair) = scene.hair().next().unwrap();
    assert!(told[0].chains < 120, "{told:?}");
    assert!(told[0].joints < told[0].chains * hair.strands.strand(0).len(), "{told:?}");
    assert!(told[0].error_cm <= 0.15, "{told:?}");
    let player = Player::new(&joints);
    for frame in 0..FRAMES {
        let middles: Vec<Vec3> =
            player.vertices("hair", Some(frame as f32 / RATE)).chunks(2).map(|e| 0.5 * (e[0] + e[1])).collect();
        let still = scene.at(frame);
        let (_, hair) = still.hair().next().unwrap();
        let wanted: Vec<Vec3> =
            hair.strands.points.iter().map(|p| scene.placement.transform_point3(*p) * 0.01).collect();
        let error = 100.0 * farthest(&middles, &wanted);
        assert!(error <= told[0].error_cm + 100.0 * ROUNDING, "frame {frame}: {error}");
    }
    // For the Khronos validator, which `.ci/run` lets loose on it.
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("glb");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("joints.glb"), &joints).unwrap();
    // The size that is told is about that of what is added.
    let still = glb(&scene, &GlbOptions { tolerance: 0.0, animation: false, ..GlbOptions::default() }, &Task::new());
    let added = (joints.len() - still.unwrap().len()) as f64;
    assert!((told[0].bytes as f64 / added - 1.0).abs() < 0.25, "{} {added}", told[0].bytes);
}

#[test]
fn without_animation_it_is_the_still_frame() {
    let mut scene = moving(20, true);
    scene.shown.still = 7;
    let options = GlbOptions { animation: false, strands: StrandForm::Lines, ..GlbOptions::default() };
    let still = glb(&scene, &options, &Task::new()).unwrap();
    assert_eq!(still, glb(&scene.at(7), &options, &Task::new()).unwrap());
    assert!(Player::new(&still).document.animations().next().is_none());
}

#[test]
fn the_bytes_do_not_depend_on_threads_and_cancelling_stops() {
    let scene = moving(300, true);
    for motion in [MotionForm::Auto, MotionForm::Joints] {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| glb(&scene, &GlbOptions { motion, ..GlbOptions::default() }, &Task::new()).unwrap())
        };
        assert!(on(1) == on(2), "{motion:?}");
    }
    let task = Task::new();
    task.cancel();
    assert_eq!(glb(&scene, &GlbOptions::default(), &task), Err(ExportError::Cancelled(Cancelled)));
}

#[test]
fn frames_that_do_not_fit_are_refused() {
    let mut scene = moving(5, false);
    let Some(Motion::Surface(clip)) = &mut scene.parts[2].motion else { panic!() };
    Arc::make_mut(&mut clip.frames[3]).pop();
    let refused = |scene: &Scene| glb(scene, &GlbOptions::default(), &Task::new()).unwrap_err();
    assert!(matches!(refused(&scene), ExportError::Motion { frame: 4, .. }));
    let Some(Motion::Surface(clip)) = &mut scene.parts[2].motion else { panic!() };
    *clip = Clip { frames: vec![Arc::new(vec![Vec3::NAN; ball().positions.len()])], ..clip.clone() };
    assert!(matches!(refused(&scene), ExportError::Motion { frame: 1, .. }));
}

/// The numbers of the line that begins so, after a place in a text.
fn numbers(text: &str, after: &str, line: &str) -> Vec<f32> {
    let from = text.find(after).unwrap_or_else(|| panic!("no {after}"));
    let at = text[from..].find(line).unwrap_or_else(|| panic!("no {line}")) + from + line.len();
    let end = text[at..].find("]").unwrap() + at;
    text[at..end].split(['(', ')', ',', ' ', '[', '\n']).filter_map(|w| w.parse().ok()).collect()
}

#[test]
fn usd_has_a_sample_for_every_frame() {
    let scene = moving(12, true);
    let text = String::from_utf8(usda(&scene, &UsdaOptions::default(), &Task::new()).unwrap()).unwrap();
    for line in ["startTimeCode = 0", "endTimeCode = 23", "timeCodesPerSecond = 12", "framesPerSecond = 12"] {
        assert!(text.contains(line), "{line}");
    }
    for frame in [0, 7, FRAMES - 1] {
        let flat = |points: &[Vec3]| points.iter().flat_map(|p| p.to_array()).collect::<Vec<_>>();
        let near = |have: Vec<f32>, wanted: Vec<f32>| {
            assert_eq!(have.len(), wanted.len());
            assert!(have.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 2e-5), "{frame}");
        };
        let hair = &text[text.find("def BasisCurves \"hair\"").unwrap()..];
        let still = scene.at(frame);
        let (_, now) = still.hair().next().unwrap();
        near(numbers(hair, "points.timeSamples", &format!("\n            {frame}: [")), flat(&now.strands.points));
        let guides = &text[text.find("def BasisCurves \"hair_guides\"").unwrap()..];
        near(numbers(guides, "points.timeSamples", &format!("\n            {frame}: [")), flat(&now.guides.points));
        let surface = &text[text.find("def Mesh \"flag\"").unwrap()..];
        near(numbers(surface, "points.timeSamples", &format!("\n            {frame}: [")), flat(&flag(frame)));
        let place = numbers(&format!("{text}]"), "xformOp:transform.timeSamples", &format!("\n            {frame}: ("));
        let wanted = glam::Mat4::from(head(frame)).to_cols_array();
        assert!(place[..16].iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5));
    }
    // Still scenes have none.
    let text = String::from_utf8(usda(&scene.at(3), &UsdaOptions::default(), &Task::new()).unwrap()).unwrap();
    assert!(!text.contains("timeSamples") && !text.contains("TimeCode"));
}

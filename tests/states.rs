//! States of a lock that are meshes from files.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use coif::geometry::Mesh;
use coif::math::trig;
use coif::scene::{LockKind, Motion, Scene};
use coif::script::{Disk, Ending, Options, run, show_all};
use coif::task::Task;
use glam::Vec3;

const RINGS: usize = 12;
const SIDES: usize = 10;
const TIP: usize = RINGS * SIDES;

/// A horn that grows from the back of the head and bends to the head's left by `bend` radians.
fn horn(bend: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut middle = Vec3::new(0.0, 8.0, -11.0);
    for ring in 0..=RINGS {
        let s = ring as f32 / RINGS as f32;
        let (along, side) = (bend * s, 1.2 * (1.0 - s));
        let (way, out) =
            (Vec3::new(trig::sin(along), 0.2, -trig::cos(along)), Vec3::new(trig::cos(along), 0.0, trig::sin(along)));
        if ring == RINGS {
            mesh.positions.push(middle);
            break;
        }
        for k in 0..SIDES {
            let a = std::f32::consts::TAU * k as f32 / SIDES as f32;
            mesh.positions.push(middle + (out * trig::cos(a) + Vec3::Y * trig::sin(a)) * side);
        }
        middle += way * (14.0 / RINGS as f32);
    }
    let at = |ring: usize, k: usize| if ring == RINGS { TIP as u32 } else { (ring * SIDES + k % SIDES) as u32 };
    for ring in 0..RINGS {
        for k in 0..SIDES {
            mesh.triangles.push([at(ring, k), at(ring, k + 1), at(ring + 1, k)]);
            if ring + 1 < RINGS {
                mesh.triangles.push([at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)]);
            }
        }
    }
    mesh
}

fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for p in &mesh.positions {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

const STYLE: &str = r##"
local head = coif.head { style = "cartoon" }
local function state(name) return coif.mesh { file = name .. ".obj", material = "#a05030" } end
local lock = coif.animate {
  states  = { state("rest"), state("left"), state("right") },
  held    = function(place) return place.z > -11.5 end,
  handles = { { at = { 0, 10.8, -25 }, path = coif.path { states = { 1, 2, 1, 3 }, closed = true, frames = 24 } } },
  loop    = true,
}
return coif.scene { head, lock }
"##;

/// A folder with a style and the files of its states; the scene, or what was said.
fn scene(files: &[(&str, &str)]) -> Result<(Scene, String), String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    run_in(folder.path())
}

fn run_in(folder: &Path) -> Result<(Scene, String), String> {
    let mut outcome = run(&Options::new(folder.join("style.lua")), Arc::new(Disk), &Task::new());
    let said = show_all(&outcome.diagnostics, &outcome.sources, false);
    match outcome.ending {
        Ending::Done => Ok((outcome.scene.take().unwrap(), said)),
        Ending::Failed | Ending::Cancelled => Err(said),
    }
}

#[test]
fn loaded_states_are_met() {
    let (left, right) = (horn(1.1), horn(-1.1));
    let files =
        [("style.lua", STYLE), ("rest.obj", &obj(&horn(0.0))), ("left.obj", &obj(&left)), ("right.obj", &obj(&right))];
    let (scene, said) = scene(&files).unwrap_or_else(|said| panic!("{said}"));
    assert!(said.is_empty(), "{said}");
    let part = scene.parts.iter().find(|p| p.motion.is_some()).unwrap();
    assert!(scene.locks().any(|(_, l)| l.kind == LockKind::Mesh));
    let Some(Motion::Surface(clip)) = &part.motion else { panic!("a surface") };
    assert_eq!(clip.count(), 24);
    // A file's vertices come in the order in which faces name them.
    let rest = horn(0.0);
    let (_, locks) = scene.locks().next().unwrap();
    let order: Vec<usize> = rest
        .positions
        .iter()
        .map(|p| locks.mesh.mesh.positions.iter().position(|q| q.distance(*p) < 1e-4).expect("a vertex"))
        .collect();
    let at = |frame: usize| order.iter().map(|&v| clip.frames[frame][v]).collect::<Vec<Vec3>>();
    for (frame, state) in [(0, &rest), (6, &left), (12, &rest), (18, &right)] {
        let worst = at(frame).iter().zip(&state.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        // The path passes the tips, and the surface is then that of the state.
        assert!(worst < 0.3, "frame {frame}: {worst} cm");
    }
    // Between them it is as long as in them.
    let long = |at: &[Vec3]| (0..RINGS).map(|r| at[r * SIDES].distance(at[((r + 1) * SIDES).min(TIP)])).sum::<f32>();
    for frame in 0..clip.count() {
        let part = long(&at(frame)) / long(&at(0));
        assert!((part - 1.0).abs() < 0.2, "frame {frame}: {part}");
    }
}

#[test]
fn what_does_not_fit_is_told() {
    let rest = obj(&horn(0.0));
    let told = |left: &Mesh| {
        let files = [("style.lua", STYLE), ("rest.obj", &rest), ("left.obj", &obj(left)), ("right.obj", &rest)];
        scene(&files).map(|(_, said)| said).unwrap_err()
    };
    // A triangle that joins other vertices.
    let mut other = horn(1.1);
    other.triangles[7].swap(0, 1);
    let said = told(&other);
    assert!(said.contains("triangle 8 of state 2 joins other vertices"), "{said}");
    // A vertex more.
    let mut more = horn(1.1);
    more.positions.push(Vec3::new(0.0, 9.0, -14.0));
    more.triangles.push([0, 5, TIP as u32 + 1]);
    let said = told(&more);
    assert!(said.contains("state 2 has 122 vertices, the rest has 121"), "{said}");
    // A triangle without area is left out where the file is read, and then the state is short of it.
    let mut flat = horn(1.1);
    let [a, b, c] = flat.triangles[30].map(|v| v as usize);
    flat.positions[c] = 0.5 * (flat.positions[a] + flat.positions[b]);
    let said = told(&flat);
    assert!(said.contains("triangles without area dropped") && said.contains("state 2"), "{said}");
    // A piece from a file has no root and no tip.
    let files = [
        ("style.lua", &*STYLE.replace("held ", "-- held ")),
        ("rest.obj", &rest),
        ("left.obj", &rest),
        ("right.obj", &rest),
    ];
    let said = scene(&files).map(|(_, said)| said).unwrap_err();
    assert!(said.contains("a piece has no root"), "{said}");
}

//! Stylised hair from script to files: the figures of the papers and the cartoon examples.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use coif::export::{GlbOptions, UsdaOptions, glb, usda};
use coif::geometry::{Bvh, Mesh};
use coif::render::{Picture, SheetOptions, sheet};
use coif::scene::{Background, LockKind, Locks, Scene, Shading, View};
use coif::script::{Disk, Ending, Options, Outcome, run, show_all};
use coif::task::Task;
use coif::tuft::{Profile, Tuft};
use coif::workbench;
use glam::{Vec3, Vec4};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn script(path: &str, set: &[(&str, &str)]) -> (Scene, Outcome) {
    let mut options = Options::new(root().join(path));
    options.set = set.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    let mut outcome = run(&options, Arc::new(Disk), &Task::new());
    let said = show_all(&outcome.diagnostics, &outcome.sources, false);
    assert_eq!(outcome.ending, Ending::Done, "{path}: {said}");
    assert!(said.is_empty(), "{path}: {said}");
    (outcome.scene.take().unwrap(), outcome)
}

fn tufts(scene: &Scene) -> &Locks {
    let all: Vec<&Locks> = scene.locks().map(|(_, l)| l).filter(|l| l.kind == LockKind::Tufts).collect();
    assert_eq!(all.len(), 1, "all tufts of a head are one part");
    all[0]
}

fn picture(scene: &Scene, width: u32) -> Picture {
    let options = SheetOptions { width, height: width, lettering: false, supersample: 1, ..SheetOptions::default() };
    sheet(scene, &options, &Task::new()).unwrap()
}

fn one_view(mut scene: Scene, background: Background) -> Scene {
    scene.views = vec![View::Front];
    scene.look.background = background;
    scene
}

#[test]
fn figure_3_has_its_diameters() {
    let (scene, _) = script("tests/scenes/tufts_figure_3.lua", &[]);
    let of = |t: &Tuft| match t.section.profile {
        Profile::Round { diameter, peak } => ((diameter * 10.0).round(), (peak * 100.0).round()),
        _ => panic!("a round tuft"),
    };
    let all: Vec<(f32, f32)> = tufts(&scene).tufts.tufts.iter().map(of).collect();
    assert_eq!(all, [(25.0, 30.0), (100.0, 30.0), (60.0, 10.0), (60.0, 80.0)]);
    // The mesh has them too: the widest place of the second tuft is 10 cm across.
    let mesh = tufts(&scene).mesh.clone();
    let range = mesh.vertices[1].clone();
    let places = &mesh.mesh.positions[range.start as usize..range.end as usize];
    let stroke = &tufts(&scene).tufts.tufts[1].stroke;
    let widest = places
        .iter()
        .map(|&p| {
            let nearest =
                |b: &[Vec3; 4]| (0..=40).map(|k| at(b, k as f32 / 40.0).distance(p)).fold(f32::INFINITY, f32::min);
            stroke.beziers().iter().map(nearest).fold(f32::INFINITY, f32::min)
        })
        .fold(0.0, f32::max);
    assert!((widest - 5.0).abs() < 0.1, "{widest}");
}

fn at(b: &[Vec3; 4], u: f32) -> Vec3 {
    let (ab, bc, cd) = (b[0].lerp(b[1], u), b[1].lerp(b[2], u), b[2].lerp(b[3], u));
    ab.lerp(bc, u).lerp(bc.lerp(cd, u), u)
}

#[test]
fn figure_11_follows_its_densities() {
    let count = |set: &[(&str, &str)]| tufts(&script("tests/scenes/tufts_figure_11.lua", set).0).count();
    let (sparse, dense) = (count(&[("around", "20")]), count(&[("around", "90")]));
    assert!(2 < sparse && 2 * sparse < dense, "{sparse} {dense}");
    let around = count(&[]);
    let up = count(&[("up", "60")]);
    let both = count(&[("up", "60"), ("down", "60")]);
    assert!(around < up && up < both, "{around} {up} {both}");
    // Jitter moves roots, by 9 degrees at most, and every filled one.
    let still = script("tests/scenes/tufts_figure_11.lua", &[]).0;
    let strewn = script("tests/scenes/tufts_figure_11.lua", &[("jitter", "1")]).0;
    let (a, b) = (&tufts(&still).tufts.tufts, &tufts(&strewn).tufts.tufts);
    assert_eq!(
        a[..2].iter().map(|t| t.stroke.root()).collect::<Vec<_>>(),
        b[..2].iter().map(|t| t.stroke.root()).collect::<Vec<_>>()
    );
    for (s, m) in a[2..].iter().zip(&b[2..]) {
        let h = s.stroke.reference();
        let turn = (s.stroke.root() - h).angle_between(m.stroke.root() - h).to_degrees();
        assert!(turn > 0.0 && turn < 13.0, "{turn}");
    }
}

#[test]
fn figures_9_and_10_run() {
    assert_eq!(tufts(&script("tests/scenes/tufts_figure_9.lua", &[]).0).count(), 12);
    assert_eq!(tufts(&script("tests/scenes/tufts_figure_10.lua", &[]).0).count(), 2);
}

#[test]
fn every_cartoon_style_is_sound() {
    let folder = root().join("examples/cartoon");
    let mut all: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|n| Path::new(n).extension().is_some_and(|e| e == "lua"))
        .collect();
    all.sort();
    assert!(all.len() >= 6, "{all:?}");
    let mut mixed = 0;
    for name in &all {
        let (scene, _) = script(&format!("examples/cartoon/{name}"), &[]);
        assert_eq!(scene.look.shading, Shading::Toon, "{name}");
        tufts(&scene).tufts.validate().unwrap_or_else(|e| panic!("{name}: {e}"));
        mixed += usize::from(scene.hair().next().is_some());
        let bytes = glb(&scene, &GlbOptions::default(), &Task::new()).unwrap();
        gltf::import_slice(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
    assert!(mixed > 0, "one style has strands and tufts");
}

#[test]
fn cloth_has_two_sides_and_usd_numbers_tufts() {
    let (scene, _) = script("examples/garments/held_back.lua", &[]);
    let bytes = glb(&scene, &GlbOptions::default(), &Task::new()).unwrap();
    let (document, ..) = gltf::import_slice(&bytes).unwrap();
    let mut cloth = 0;
    for node in document.nodes().filter(|n| n.mesh().is_some()) {
        let extras: serde_json::Value = serde_json::from_str(node.extras().as_ref().unwrap().get()).unwrap();
        let is_cloth = node.name().unwrap().starts_with("garment");
        assert_eq!(extras["coif"]["kind"] == "garment", is_cloth, "{extras}");
        for primitive in node.mesh().unwrap().primitives() {
            assert_eq!(primitive.material().double_sided(), is_cloth, "{extras}");
        }
        cloth += usize::from(is_cloth);
    }
    assert!(cloth > 0);
    let text = String::from_utf8(usda(&scene, &UsdaOptions::default(), &Task::new()).unwrap()).unwrap();
    assert_eq!(text.matches("bool doubleSided = 1").count(), cloth);

    let (scene, _) = script("examples/cartoon/twin_tails.lua", &[]);
    let locks = tufts(&scene);
    let text = String::from_utf8(usda(&scene, &UsdaOptions::default(), &Task::new()).unwrap()).unwrap();
    let (_, from) = text.split_once("def Mesh \"tufts\"").unwrap();
    let (_, list) = from.split_once("int[] primvars:coif_tuft = [").unwrap();
    let (list, _) = list.split_once(']').unwrap();
    let numbers: Vec<u32> = list.split(',').map(|n| n.trim().parse().unwrap()).collect();
    assert_eq!(numbers, locks.mesh.tuft);
}

#[test]
fn tufts_in_glb_have_tangents_colours_and_numbers() {
    let (scene, _) = script("examples/cartoon/twin_tails.lua", &[]);
    let locks = tufts(&scene);
    let bytes = glb(&scene, &GlbOptions::default(), &Task::new()).unwrap();
    let (document, buffers, _) = gltf::import_slice(&bytes).unwrap();
    let node = document.nodes().find(|n| n.name() == Some("tufts")).unwrap();
    let extras: serde_json::Value = serde_json::from_str(node.extras().as_ref().unwrap().get()).unwrap();
    assert_eq!(extras["coif"]["kind"], "tufts");
    assert_eq!(extras["coif"]["tufts"], locks.count());
    assert!(
        extras["coif"]["sources"].as_array().unwrap().iter().all(|s| s.as_str().unwrap().contains("twin_tails.lua:"))
    );
    let mesh = node.mesh().unwrap();
    assert_eq!(mesh.primitives().len(), 1);
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|b| Some(&buffers[b.index()]));
    let normals: Vec<Vec3> = reader.read_normals().unwrap().map(Vec3::from).collect();
    let uvs: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
    assert!(uvs.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
    for (n, t) in normals.iter().zip(reader.read_tangents().unwrap().map(Vec4::from)) {
        assert!((t.truncate().length() - 1.0).abs() < 1e-4 && t.truncate().dot(*n).abs() < 1e-3);
        assert_eq!(t.w.abs(), 1.0);
    }
    // u grows along the tangent: on every triangle whose uv has an area.
    let positions: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
    let tangents: Vec<Vec4> = reader.read_tangents().unwrap().map(Vec4::from).collect();
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    let (mut along, mut all) = (0, 0);
    for t in indices.chunks_exact(3) {
        let [a, b, c] = [t[0] as usize, t[1] as usize, t[2] as usize];
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (du, dv) = (uvs[to][0] - uvs[from][0], uvs[to][1] - uvs[from][1]);
            if du.abs() > 20.0 * dv.abs() && du.abs() > 1e-5 {
                let way = (positions[to] - positions[from]) * du.signum();
                all += 1;
                along += usize::from(way.dot(tangents[from].truncate()) > 0.0);
            }
        }
    }
    assert!(all > 1000 && along * 100 > all * 97, "{along} of {all}");
    assert_eq!(reader.read_colors(0).unwrap().into_rgba_f32().count(), normals.len());
    let id = primitive.attributes().find(|(s, _)| s.to_string().contains("TUFT_ID")).unwrap().1;
    assert_eq!(id.count(), normals.len());
    assert!(primitive.attributes().any(|(s, _)| s.to_string().contains("SOURCE")));
}

#[test]
fn a_budget_is_kept_and_told() {
    let (mut scene, _) = script("tests/scenes/tufts_figure_11.lua", &[("up", "60")]);
    let before = tufts(&scene).mesh.mesh.triangles.len();
    let count = tufts(&scene).count();
    let done = workbench::keep_within(&mut scene, 3000).unwrap();
    assert!(before > 3000);
    assert_eq!((done.before, done.after, done.tufts), (before, tufts(&scene).mesh.mesh.triangles.len(), count));
    assert!(done.after <= 3000 && done.after > 2000 && done.lowered > 0 && done.tolerance.is_some(), "{done:?}");
    tufts(&scene).tufts.validate().unwrap();
    let again = workbench::keep_within(&mut scene, 3000).unwrap();
    assert_eq!((again.before, again.lowered, again.tolerance), (done.after, 0, None));
    assert!(workbench::keep_within(&mut scene, 10).is_err());
}

#[test]
fn caps_and_buns_are_in_the_budget() {
    let (mut scene, _) = script("examples/cartoon/top_bun.lua", &[("strands", "100")]);
    let of = |scene: &Scene| -> Vec<(LockKind, Mesh)> {
        scene.locks().map(|(_, l)| (l.kind, l.mesh.mesh.clone())).collect()
    };
    let before = of(&scene);
    assert!(before.iter().any(|(k, _)| *k == LockKind::Cap) && before.iter().any(|(k, _)| *k == LockKind::Bun));
    let done = workbench::keep_within(&mut scene, 6000).unwrap();
    let after = of(&scene);
    let sum = |all: &[(LockKind, Mesh)]| all.iter().map(|(_, m)| m.triangles.len()).sum::<usize>();
    assert_eq!((done.before, done.after), (sum(&before), sum(&after)));
    assert!(done.after <= 6000 && done.after > 4000 && done.pieces == 3, "{done:?}");
    let tolerance = done.tolerance.unwrap();
    for ((kind, was), (_, is)) in before.iter().zip(&after).filter(|((k, _), _)| *k != LockKind::Tufts) {
        is.validate().unwrap();
        assert!(is.triangles.len() < was.triangles.len() && is.uvs.len() == is.positions.len(), "{kind:?}");
        // Still closed: it has an inside, and every edge its opposite.
        let mut edges = BTreeMap::new();
        let at = |m: &Mesh, v: u32| m.positions[v as usize].to_array().map(|c| (c + 0.0).to_bits());
        for t in &is.triangles {
            for k in 0..3 {
                let (a, b) = (at(is, t[k]), at(is, t[(k + 1) % 3]));
                *edges.entry((a, b)).or_insert(0) += 1;
                *edges.entry((b, a)).or_insert(0) -= 1;
            }
        }
        assert!(edges.values().all(|&n| n == 0), "{kind:?} is open");
        // And near what it was: each removed corner lies close to the new surface.
        let tree = Bvh::new(&is.positions, &is.triangles);
        let off = was.positions.iter().filter_map(|&p| tree.closest(p, 100.0)).map(|c| c.distance).fold(0.0, f32::max);
        assert!(off <= 2.0 * tolerance, "{kind:?}: {off} of {tolerance}");
    }
}

/// How many pixels are nearly of a colour.
fn near(picture: &Picture, colour: [u8; 3], by: i32) -> usize {
    let close = |c: &[u8]| c.iter().zip(colour).all(|(&a, b)| (i32::from(a) - i32::from(b)).abs() <= by);
    picture.pixels.chunks_exact(3).filter(|c| close(c)).count()
}

#[test]
fn toon_shading_has_flat_tones_and_ink() {
    let (scene, _) = script("examples/cartoon/twin_tails.lua", &[]);
    let toon = picture(&one_view(scene.clone(), Background::White), 200);
    // The lit colour of the hair is there as it was written, on thousands of pixels; soft shading has no such tone.
    let lit = near(&toon, [0x3f, 0x7f, 0xc4], 2);
    assert!(lit > 2500, "{lit}");
    let mut soft = one_view(scene.clone(), Background::White);
    soft.look.shading = Shading::Soft;
    assert!(near(&picture(&soft, 200), [0x3f, 0x7f, 0xc4], 2) < lit / 5);
    // Lines: at least the outline of the whole figure, which is no shorter than that of its box, at the thinnest that
    // a tapered line gets, times a half for corners that the box has and the figure has not; and at most a full line
    // around every tuft on both sides.
    let width = 400;
    let toon = picture(&one_view(scene.clone(), Background::White), width);
    let paper = |x: u32, y: u32| toon.pixels[3 * (y * width + x) as usize..][..3] == [255; 3];
    let (mut lo, mut hi) = ([width; 2], [0; 2]);
    for (x, y) in (0..width).flat_map(|y| (0..width).map(move |x| (x, y))).filter(|&(x, y)| !paper(x, y)) {
        lo = [lo[0].min(x), lo[1].min(y)];
        hi = [hi[0].max(x), hi[1].max(y)];
    }
    let perimeter = 2.0 * f64::from(hi[0] - lo[0] + hi[1] - lo[1]);
    // A full line is 2.1 pixels wide at 640, but no less than 0.55 times that.
    let pen = 2.1 * (f64::from(width) / 640.0).max(0.55);
    let dark = toon.pixels.chunks_exact(3).filter(|c| c[0] < 110 && c[1] < 110 && c[2] < 140).count() as f64;
    let tallest = f64::from(hi[1] - lo[1]);
    let most = (tufts(&scene).count() as f64 * 2.0 * tallest + 4.0 * perimeter) * pen;
    assert!(dark > 0.5 * 0.28 * pen * perimeter && dark < most, "{dark}: {perimeter} x {pen}, {most}");
    let toon = picture(&one_view(scene.clone(), Background::White), 200);
    assert!(near(&toon, [255; 3], 0) > 8000);
    let night = picture(&one_view(scene, Background::Dark), 200);
    assert!(near(&night, [0x3f, 0x7f, 0xc4], 2) > 2500 && near(&night, [255; 3], 0) == 0);
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let (scene, _) = script("tests/scenes/tufts_figure_10.lua", &[]);
    let scene = one_view(scene, Background::White);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (picture(&scene, 120), glb(&scene, &GlbOptions::default(), &Task::new()).unwrap()))
    };
    assert!(on(1) == on(3));
}

#[test]
fn every_tuft_has_its_colour_in_usd() {
    let (scene, _) = script("examples/cartoon/twin_tails.lua", &[]);
    let text = String::from_utf8(usda(&scene, &UsdaOptions::default(), &Task::new()).unwrap()).unwrap();
    let locks = scene.locks().count();
    assert_eq!(text.matches("UsdPrimvarReader_float3").count(), locks);
    assert_eq!(text.matches("inputs:diffuseColor.connect = </").count(), locks);
    assert_eq!(text.matches("string inputs:varname = \"displayColor\"").count(), locks);
    // Every connection leads to a shader that is there.
    for line in text.lines().filter_map(|l| l.trim().strip_prefix("color3f inputs:diffuseColor.connect = <")) {
        let name = line.split('/').nth(3).unwrap();
        assert!(
            line.ends_with("/Colour.outputs:result>") && text.contains(&format!("def Material \"{name}\"")),
            "{line}"
        );
    }
}

#[test]
fn three_tones_have_a_darker_one() {
    let source = r##"
        local head = coif.head { style = "cartoon" }
        local tones = coif.params { tones = { 2, min = 2, max = 3 } }.tones
        local look = coif.material.tuft { colour = "#3f7fc4", shine = 0, tones = tones }
        return coif.scene { head, coif.cap { thickness = 1, material = look }, shading = "toon" }
    "##;
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("tones.lua");
    std::fs::write(&path, source).unwrap();
    let dark = |tones: &str| {
        let (scene, _) = script(path.to_str().unwrap(), &[("tones", tones)]);
        let mut scene = scene;
        scene.views = vec![View::Back];
        let picture = picture(&scene, 200);
        // Between the ink and the colour in the shade.
        let blue = |c: &&[u8]| c[2] > c[0].saturating_add(40) && (100..130).contains(&c[2]);
        let lit = near(&picture, [0x3f, 0x7f, 0xc4], 2);
        (lit, picture.pixels.chunks_exact(3).filter(blue).count())
    };
    let (two, three) = (dark("2"), dark("3"));
    assert_eq!(two.0, three.0, "the light is where it was");
    assert!(three.1 > two.1 + 80, "{two:?} {three:?}");
}

//! USD text and `.hair` files, read back by small readers of their own.

mod export_scene;

use std::sync::Arc;

use coif::export::{CyHairOptions, ExportError, UsdaOptions, cyhair, usda};
use coif::geometry::{Root, Strands};
use coif::task::{Cancelled, Task};
use export_scene::{hair_of, scene};
use glam::{Affine3A, Mat4, Vec2, Vec3};

/// A `.hair` file as the format's own page describes it.
struct Cy {
    segments: Vec<u16>,
    points: Vec<Vec3>,
    thickness: Vec<f32>,
    colours: Vec<Vec3>,
}

fn read_cy(bytes: &[u8]) -> Cy {
    assert_eq!(&bytes[..4], b"HAIR");
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let (strands, nodes) = (word(4) as usize, word(8) as usize);
    assert_eq!((word(12), word(16), float(20), float(24)), (23, 0, 1.0, 0.0));
    assert!(bytes[40..].starts_with(b"coif ") && bytes[127] == 0);
    let mut at = 128;
    let segments =
        (0..strands).map(|i| u16::from_le_bytes(bytes[at + 2 * i..at + 2 * i + 2].try_into().unwrap())).collect();
    at += 2 * strands;
    let mut floats = |count: usize| -> Vec<f32> {
        let out = (0..count).map(|i| float(at + 4 * i)).collect();
        at += 4 * count;
        out
    };
    let triples = |f: Vec<f32>| f.chunks_exact(3).map(Vec3::from_slice).collect();
    let (points, thickness, colours) = (triples(floats(3 * nodes)), floats(nodes), triples(floats(3 * nodes)));
    assert_eq!(at, bytes.len(), "nothing is left over");
    Cy { segments, points, thickness, colours }
}

#[test]
fn hair_files_hold_every_strand() {
    let scene = scene(200);
    let (_, hair) = scene.hair().next().unwrap();
    let file = read_cy(&cyhair(&scene, &CyHairOptions::default(), &Task::new()).unwrap());
    assert_eq!(file.segments.len(), 200);
    let mut at = 0;
    let (root, tip) = (hair.material.root_colour.to_linear(), hair.material.tip_colour.to_linear());
    for (i, &segments) in file.segments.iter().enumerate() {
        let strand = hair.strands.strand(i);
        assert_eq!(usize::from(segments) + 1, strand.len());
        let end = at + strand.len();
        for (have, node) in file.points[at..end].iter().zip(strand) {
            assert!(have.distance(scene.placement.transform_point3(*node)) < 1e-4);
        }
        let (width, taper) = (hair.material.width, hair.material.taper);
        assert!((file.thickness[at] - width).abs() < 1e-7 && (file.thickness[end - 1] - width * taper).abs() < 1e-7);
        assert!(file.thickness[at..end].windows(2).all(|w| w[0] > w[1]));
        let gain = file.colours[at].x / root.x;
        assert!((gain - 1.0).abs() <= hair.material.variation + 1e-5);
        assert!(file.colours[end - 1].abs_diff_eq(tip * gain, 1e-5));
        at = end;
    }
    assert_eq!(at, file.points.len());

    let reduced = CyHairOptions { tolerance: 0.05, ..CyHairOptions::default() };
    let fewer = read_cy(&cyhair(&scene, &reduced, &Task::new()).unwrap());
    assert!(fewer.points.len() < file.points.len() * 3 / 4);
    let bald = coif::scene::Scene { parts: Vec::new(), ..scene };
    assert_eq!(cyhair(&bald, &CyHairOptions::default(), &Task::new()).unwrap().len(), 128);
}

/// The numbers of the first array that follows `head` after the text `after`.
fn numbers(text: &str, after: &str, head: &str) -> Vec<f64> {
    let text = &text[text.find(after).unwrap_or_else(|| panic!("no {after}"))..];
    let start = text.find(&format!("{head} = [")).unwrap_or_else(|| panic!("no {head}")) + head.len() + 4;
    let end = start + text[start..].find(']').unwrap();
    text[start..end]
        .split(|c: char| c == ',' || c == '(' || c == ')' || c.is_whitespace())
        .filter(|w| !w.is_empty())
        .map(|w| w.parse().unwrap_or_else(|_| panic!("`{w}` is no number")))
        .collect()
}

#[test]
fn usd_text_holds_the_head_the_hair_and_the_guides() {
    let scene = scene(300);
    let (_, hair) = scene.hair().next().unwrap();
    let text = String::from_utf8(usda(&scene, &UsdaOptions::default(), &Task::new()).unwrap()).unwrap();
    assert!(text.starts_with("#usda 1.0\n(\n    defaultPrim = \"style\"\n"));
    assert_eq!(text.matches(['{', '(', '[']).count(), text.matches(['}', ')', ']']).count());

    for (prim, strands) in [("\"hair\"", &hair.strands), ("\"hair_guides\"", &hair.guides)] {
        let prim = format!("def BasisCurves {prim}");
        let array = |head: &str| numbers(&text, &prim, head);
        let counts = array("int[] curveVertexCounts");
        assert_eq!(counts, strands.iter().map(|s| s.len() as f64).collect::<Vec<_>>());
        let points = array("point3f[] points");
        assert_eq!(points.len(), 3 * strands.points.len());
        for (have, want) in points.iter().zip(strands.points.iter().flat_map(|p| p.to_array())) {
            assert!((have - f64::from(want)).abs() < 0.6e-5);
        }
        assert_eq!(array("float[] widths").len(), strands.points.len());
        assert_eq!(array("float[] widths")[0], 0.02);
        for uniform in ["texCoord2f[] primvars:st", "float2[] primvars:surface_uv_coordinate"] {
            assert_eq!(array(uniform).len(), 2 * strands.count());
        }
        assert_eq!(array("color3f[] primvars:displayColor").len(), 3 * strands.count());
        assert_eq!(array("int[] primvars:coif_guide"), strands.guide.iter().map(|&g| f64::from(g)).collect::<Vec<_>>());
        let extent = array("float3[] extent");
        let bounds = strands.bounds();
        for k in 0..3 {
            assert!(extent[k] < f64::from(bounds.min[k]) && extent[3 + k] > f64::from(bounds.max[k]));
        }
    }
    let guides = &text[text.find("def BasisCurves \"hair_guides\"").unwrap()..];
    assert!(guides.contains("uniform token purpose = \"guide\"") && guides.contains("groom_guide = [1]"));
    assert!(text.contains("custom string[] coif:sources = [\"style.lua:7\", \"style.lua:12\"]"));

    let ball = export_scene::ball();
    assert_eq!(numbers(&text, "def Mesh", "point3f[] points").len(), 3 * ball.positions.len());
    let corners: Vec<f64> = ball.triangles.iter().flatten().map(|&i| f64::from(i)).collect();
    assert_eq!(numbers(&text, "def Mesh", "int[] faceVertexIndices"), corners);

    let line = text.lines().find(|l| l.contains("matrix4d")).unwrap();
    let rows: Vec<f32> = line.split(['(', ')', ',', ' ']).filter_map(|w| w.parse().ok()).collect();
    assert_eq!(rows, Mat4::from(scene.placement).to_cols_array());
}

#[test]
fn arrays_longer_than_a_piece_stay_whole() {
    let mut scene = scene(1);
    let strands = Arc::make_mut(&mut hair_of(&mut scene).strands);
    for id in 0..9_000 {
        let root = Root { id: 10_000 + id, position: Vec3::ZERO, normal: Vec3::Y, uv: Vec2::ZERO, triangle: 0 };
        strands.push(root, 0, [Vec3::ZERO, Vec3::Y * id as f32]);
    }
    strands.guide.fill(0);
    let text = String::from_utf8(usda(&scene, &UsdaOptions::default(), &Task::new()).unwrap()).unwrap();
    let ids = numbers(&text, "def BasisCurves", "int[] primvars:groom_id");
    assert_eq!(ids, (0..9_001).map(f64::from).collect::<Vec<_>>());
    assert!(!text.contains(",,") && !text.contains(", ,"));
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let scene = scene(6000);
    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let usd = usda(&scene, &UsdaOptions::default(), &Task::new()).unwrap();
            (usd, cyhair(&scene, &CyHairOptions::default(), &Task::new()).unwrap())
        })
    };
    assert!(bytes(1) == bytes(3));
}

#[test]
fn what_cannot_be_written_is_named() {
    let good = scene(30);
    let task = Task::new();
    let small = UsdaOptions { max_bytes: 5_000, ..UsdaOptions::default() };
    assert!(matches!(usda(&good, &small, &task), Err(ExportError::TooLarge { limit: 5_000, .. })));
    let small = CyHairOptions { max_bytes: 5_000, ..CyHairOptions::default() };
    assert!(matches!(cyhair(&good, &small, &task), Err(ExportError::TooLarge { limit: 5_000, .. })));

    let mut broken = scene(30);
    Arc::make_mut(&mut hair_of(&mut broken).strands).points[3].x = f32::NAN;
    assert!(matches!(usda(&broken, &UsdaOptions::default(), &task), Err(ExportError::Strands { .. })));
    assert!(matches!(cyhair(&broken, &CyHairOptions::default(), &task), Err(ExportError::Strands { .. })));
    let lost = coif::scene::Scene { placement: Affine3A::from_translation(Vec3::NAN), ..scene(2) };
    assert!(matches!(usda(&lost, &UsdaOptions::default(), &task), Err(ExportError::Placement { .. })));
    assert!(matches!(cyhair(&lost, &CyHairOptions::default(), &task), Err(ExportError::Placement { .. })));

    let mut long = scene(1);
    let mut strands = Strands::new();
    let root = Root { id: 1, position: Vec3::ZERO, normal: Vec3::Y, uv: Vec2::ZERO, triangle: 0 };
    strands.push(root, 0, (0..65_537).map(|i| Vec3::new(0.0, i as f32, (i % 2) as f32)));
    hair_of(&mut long).strands = Arc::new(strands);
    let error = cyhair(&long, &CyHairOptions::default(), &task).unwrap_err();
    let (part, limit) = ("hair".to_owned(), 65_535);
    assert_eq!(error, ExportError::TooManySegments { part, strand: 0, segments: 65_536, limit });
    assert!(cyhair(&long, &CyHairOptions { tolerance: 2.0, ..CyHairOptions::default() }, &task).is_ok());

    task.cancel();
    assert_eq!(usda(&good, &UsdaOptions::default(), &task), Err(ExportError::Cancelled(Cancelled)));
    assert_eq!(cyhair(&good, &CyHairOptions::default(), &task), Err(ExportError::Cancelled(Cancelled)));
}

/// Leaves files for trying other programs on: `target/tmp/formats`.
#[test]
fn samples() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("formats");
    std::fs::create_dir_all(&folder).unwrap();
    let scene = scene(400);
    std::fs::write(folder.join("style.usda"), usda(&scene, &UsdaOptions::default(), &Task::new()).unwrap()).unwrap();
    std::fs::write(folder.join("style.hair"), cyhair(&scene, &CyHairOptions::default(), &Task::new()).unwrap())
        .unwrap();
}

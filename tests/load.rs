//! Loading meshes: every feature on a small file of our own, every refusal with its words, and mutants of all of them.

mod load_files;

use coif::geometry::Mesh;
use coif::head::load::{Axis, FileBytes, LoadError, LoadOptions, NoSiblings, Unit, load, load_until};
use coif::math::rng::Key;
use coif::task::{Task, Warned};
use glam::{Vec2, Vec3};
use load_files::{CUBE, Glb, head_glb, skinned_glb};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

fn options() -> LoadOptions {
    LoadOptions::default()
}

fn read(name: &str, bytes: &[u8], options: &LoadOptions) -> Result<Warned<Mesh>, LoadError> {
    let loaded = load(&FileBytes { name, bytes }, options, &NoSiblings)?;
    loaded.value.mesh.validate().expect("what is loaded is valid");
    Ok(Warned { value: loaded.value.mesh, warnings: loaded.warnings })
}

fn obj(text: &str) -> Mesh {
    let read = read("a.obj", text.as_bytes(), &options()).unwrap();
    assert_eq!(read.warnings, [], "{text}");
    read.value
}

fn glb(bytes: &[u8]) -> Mesh {
    let read = read("a.glb", bytes, &options()).unwrap();
    assert_eq!(read.warnings, []);
    read.value
}

/// The message and, after a semicolon, the hint.
fn refusal(name: &str, bytes: &[u8], options: &LoadOptions) -> String {
    let error = read(name, bytes, options).expect_err("must be refused");
    let (text, hint) = (error.to_string(), error.hint());
    assert!(!text.ends_with('.') && !text.starts_with(char::is_uppercase), "{text}");
    hint.map_or(text.clone(), |hint| format!("{text}; {hint}"))
}

fn area(mesh: &Mesh) -> f32 {
    (0..mesh.triangles.len()).map(|t| mesh.area_vector(t).length() * 0.5).sum()
}

fn names(mesh: &Mesh) -> Vec<(&str, usize)> {
    mesh.groups.iter().map(|g| (g.name.as_str(), g.triangles.len())).collect()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn a_cube_of_quads_is_closed_and_faces_outward() {
    let mesh = obj(CUBE);
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
    assert!((mesh.volume() - 1.0).abs() < 1e-6);
    assert_eq!(mesh.normals.len(), 8);
    assert!(mesh.normals.iter().zip(&mesh.positions).all(|(n, &p)| n.dot(p - Vec3::splat(0.5)) > 0.8));
    assert!(mesh.uvs.is_empty());
}

#[test]
fn units_and_axes_are_the_users() {
    for (unit, size) in
        [(Unit::Mm, 0.1), (Unit::Cm, 1.0), (Unit::Dm, 10.0), (Unit::M, 100.0), (Unit::In, 2.54), (Unit::Ft, 30.48)]
    {
        let mesh = read("a.obj", CUBE.as_bytes(), &LoadOptions { unit: Some(unit), ..options() }).unwrap().value;
        assert!((mesh.bounds().size() - Vec3::splat(size)).abs().max_element() < 1e-5);
    }
    // Z up, the face to -Y: the nose lies at -Y and comes to +Z, the crown at +Z comes to +Y, the left ear at +X stays.
    let text = "v 1 -5 0\nv 7 0 0\nv 0 0 3\nf 1 2 3\n";
    let loaded = load(
        &FileBytes { name: "a.obj", bytes: text.as_bytes() },
        &LoadOptions { up: Some(Axis::Z), ..options() },
        &NoSiblings,
    )
    .unwrap()
    .value;
    assert_eq!(loaded.mesh.positions, [Vec3::new(1.0, 0.0, 5.0), Vec3::new(7.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0)]);
    assert_eq!(loaded.from_file * Vec3::new(1.0, -5.0, 0.0), loaded.mesh.positions[0]);
    // Where the file gives no unit, glTF is in metres.
    let size = glb(&head_glb().bytes()).bounds().size();
    assert!((size - Vec3::splat(20.0)).abs().max_element() < 1e-4, "{size}");
    let in_feet = read("a.glb", &head_glb().bytes(), &LoadOptions { unit: Some(Unit::Ft), ..options() }).unwrap().value;
    assert!((in_feet.bounds().size().y - 0.2 * 30.48).abs() < 1e-4);
}

#[test]
fn obj_names_become_groups_that_can_be_chosen() {
    let text = format!("{CUBE}o hat\nusemtl felt\ng brim top\nf 1 2 3\ng\nf 1 3 4\nusemtl hat\nf 1 2 4\n");
    let mesh = obj(&text);
    assert_eq!(
        names(&mesh),
        [("sides", 8), ("skin", 8), ("caps", 4), ("hat", 3), ("brim", 1), ("top", 1), ("felt", 2)]
    );
    assert_eq!(mesh.group("hat").unwrap().triangles, [12, 13, 14]);

    let chosen = LoadOptions { groups: vec!["brim".into(), "caps".into()], ..options() };
    let part = read("a.obj", text.as_bytes(), &chosen).unwrap().value;
    assert_eq!(part.triangles.len(), 5);
    assert_eq!(names(&part), [("caps", 4), ("hat", 1), ("brim", 1), ("top", 1), ("felt", 1)]);
    assert_eq!(
        refusal("a.obj", text.as_bytes(), &LoadOptions { groups: vec!["sidse".into()], ..options() }),
        "no group `sidse` in the file; did you mean \"sides\"?"
    );
    assert_eq!(
        refusal("a.obj", text.as_bytes(), &LoadOptions { groups: vec!["nose".into()], ..options() }),
        "no group `nose` in the file; it has \"sides\", \"skin\", \"caps\", \"hat\", \"brim\", \"top\", \"felt\""
    );
}

#[test]
fn obj_text_comes_in_many_dresses() {
    let plain = obj(&format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
    let dresses = [
        format!("\u{feff}{SQUARE}f 1 2 3\nf 1 3 4"),
        format!("{SQUARE}f 1 2 3\nf 1 3 4\n").replace('\n', "\r\n"),
        format!("{SQUARE}f 1 2 3\nf 1 3 4\n").replace('\n', "\r"),
        format!("{SQUARE}f 1 2 \\\n  3\nf \\\r\n1 3 4 # comment"),
        format!("{SQUARE}f -4 -3 -2\nf -4 -2 -1\n"),
        format!("# a comment\n\n  {}\tf 1 2 3\nf 1 3 4\ns off\nmtllib gone.mtl\n\0\x1a", SQUARE.replace(' ', " \t ")),
        SQUARE.replace("1 1 0", "1.0e+000 .1e1 -0.").replace("0 1 0", "0 1 0 1") + "f 1 2 3\nf 1 3 4\n",
        SQUARE.replace("0\n", "0 0.5 0.5 0.5\n") + "f 1 2 3\nf 1 3 4\n",
        format!("f 1 2 3\nf 1 3 4\n{SQUARE}"),
    ];
    for text in dresses {
        let mesh = obj(&text);
        assert_eq!((mesh.positions, mesh.triangles), (plain.positions.clone(), plain.triangles.clone()), "{text}");
    }
    let bytes = [SQUARE.as_bytes(), b"g caf\xe9 #2\nusemtl skin#2\nf 1 2 3\n"].concat();
    let read = read("a.obj", &bytes, &options()).unwrap().value;
    assert_eq!(names(&read), [("caf\u{fffd}", 1), ("skin#2", 1)]);
}

#[test]
fn uv_and_normals_come_along_and_what_lacks_is_filled() {
    let text =
        format!("{SQUARE}vt 0 0\nvt 1 0\nvt 1 0.75 0\nvt 0.5\nvn 0 0 2\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n");
    let mesh = obj(&text);
    assert_eq!(mesh.uvs, [Vec2::ZERO, Vec2::X, Vec2::new(1.0, 0.75), Vec2::new(0.5, 0.0)]);
    assert_eq!(mesh.normals, [Vec3::Z; 4]);
    // A seam repeats positions.
    assert_eq!(obj(&text.replace("f 1/1/1 3/3/1", "f 1/2/1 3/3/1")).positions.len(), 5);
    // The second face has neither: its normals are computed, its uv are told.
    let mixed = read("a.obj", text.replace("1/1/1 3/3/1 4/4/1", "1 3 4").as_bytes(), &options()).unwrap();
    assert_eq!(mixed.value.normals, [Vec3::Z; 6]);
    assert_eq!(mixed.value.uvs[3..], [Vec2::ZERO; 3]);
    assert_eq!(mixed.warnings[0].message, "vertices without uv, set to 0, 0: `3` of 6");
}

#[test]
fn a_concave_polygon_is_cut_along_its_outline() {
    // An L, which a fan around its first corner would overfill.
    let text = "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\ng l\nf 1 2 3 4 5 6\n";
    let mesh = obj(text);
    assert_eq!(mesh.triangles.len(), 4);
    assert!((area(&mesh) - 3.0).abs() < 1e-6);
    assert!((0..4).all(|t| mesh.area_vector(t).z > 0.0));
    assert_eq!(names(&mesh), [("l", 4)]);
}

#[test]
fn points_lines_and_flat_triangles_are_left_out_with_a_word() {
    let text = format!("{SQUARE}v 2 0 0\nf 1 2 3\nf 1 2 2\nf 1 2 5\nl 1 2\np 3\nfoo 1 2\nsurf 0 1\n");
    let read = read("a.obj", text.as_bytes(), &options()).unwrap();
    assert_eq!((read.value.triangles.len(), read.value.positions.len()), (1, 3));
    let told: Vec<&str> = read.warnings.iter().map(|w| w.message.as_str()).collect();
    assert_eq!(
        told,
        [
            "free-form curves and surfaces left out: `1`",
            "lines not understood: `1`, the first is line 11: `foo`",
            "points and lines left out: `2`",
            "triangles without area dropped: `2` of 3",
        ]
    );
}

#[test]
fn wrong_obj_lines_are_named() {
    for (line, words) in [
        ("v 1 2 x", "line 5: expected a number, got `x`"),
        ("v 1,5 2 3", "line 5: expected a number, got `1,5`; write `1.5`"),
        ("v 1 2", "line 5: expected 3 or more numbers after `v`, got `2`"),
        ("vn 1", "line 5: expected 3 or more numbers after `vn`, got `1`"),
        ("vt", "line 5: expected 1 or more numbers after `vt`, got `0`"),
        ("v nan 0 0", "line 5: `nan` is not a finite number"),
        ("v 0 -inf 0", "line 5: `-inf` is not a finite number"),
        ("v 0 1e60 0", "line 5: `1e60` is not a finite number"),
        ("v 0 0 1.#IND", "line 5: expected a number, got `1.#IND`"),
        ("f 1 2", "line 5: a face needs 3 corners, got `2`; write an edge as `l`, not `f`"),
        ("f", "line 5: a face needs 3 corners, got `0`"),
        ("f 0 1 2", "line 5: `0` names vertex 0; OBJ counts from 1"),
        ("f 1 2 9", "line 5: `9` names vertex 9, but there are only 4"),
        ("g a b c d e f g h i j k l m n o p q", "line 5: `17` groups at once: the limit is 16"),
        ("f 1/1 2/1 3/1", "line 5: `1/1` names uv 1, but there are only 0"),
        ("f 1//1 2//7 3//1\nvn 0 0 1", "line 5: `2//7` names normal 7, but there are only 1"),
        (
            "f 1 2 -5",
            "line 5: `-5` names vertex -5, but there are only 4; a negative index counts back from the lines above",
        ),
        ("f 1 2 99999999999", "line 5: `99999999999` names vertex 99999999999, but there are only 4"),
        (
            "f 1 2 1e3",
            "line 5: `1e3` is not a corner of a face; write a corner as v, v/vt, v//vn or v/vt/vn, with whole numbers",
        ),
        (
            "f 1 2 /3",
            "line 5: `/3` is not a corner of a face; write a corner as v, v/vt, v//vn or v/vt/vn, with whole numbers",
        ),
        (
            "f 1 2 3/1/1/1",
            "line 5: `3/1/1/1` is not a corner of a face; write a corner as v, v/vt, v//vn or v/vt/vn, with whole numbers",
        ),
        ("f 1 \\\n\n v nan 0 0", "line 5: a face needs 3 corners, got `1`"),
        ("v 0 0 \\\n0\nf 1 2 9", "line 7: `9` names vertex 9, but there are only 5"),
    ] {
        assert_eq!(refusal("a.obj", format!("{SQUARE}{line}\n").as_bytes(), &options()), words);
    }
    let crowd = format!("{SQUARE}f{}\n", " 1 2 3".repeat(2000));
    assert_eq!(
        refusal("a.obj", crowd.as_bytes(), &options()),
        "`6000` corners in the face at line 5: the limit is 4096"
    );
}

#[test]
fn what_is_no_mesh_is_refused() {
    let kinds = "give a Wavefront .obj, or glTF 2.0 as .glb or .gltf";
    for (name, bytes, words) in [
        ("a.obj", &b""[..], format!("the file is empty; {kinds}")),
        ("a.glb", b" \n\t", format!("the file is empty; {kinds}")),
        ("a.obj", b"hello world", format!("`a.obj` is not a mesh: it has no `v` and no `f` lines; {kinds}")),
        ("a", b"ply\nformat ascii 1.0\n", format!("`a` is not a mesh: it is a PLY file; {kinds}")),
        ("a.fbx", b"Kaydara FBX Binary  \0", format!("`a.fbx` is not a mesh: it is an FBX file; {kinds}")),
        ("a.obj", b"\xff\xfev\0 \0", format!("`a.obj` is not a mesh: it is UTF-16 text; save it as UTF-8; {kinds}")),
        ("a.obj", b"v 0 0 0\nv 1 0 0\n", "the file has no triangles".into()),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nl 1 2",
            "the file has no triangles; it has only points and lines; export faces".into(),
        ),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 2", "the file has no triangles; triangles without area dropped: 1".into()),
        (
            "a.obj",
            b"v 0 0 0\nv 1e9 0 0\nv 0 1 0\nf 1 2 3",
            "vertex 1 lies `1e9` cm away, further than 100 km; look at the unit".into(),
        ),
    ] {
        assert_eq!(refusal(name, bytes, &options()), words);
    }
    let axes = LoadOptions { up: Some(Axis::Y), forward: Some(Axis::MinusY), ..options() };
    assert_eq!(
        refusal("a.obj", CUBE.as_bytes(), &axes),
        "`forward = \"-y\"` lies along `up = \"y\"`; take two different axes, such as `up = \"z\", forward = \"-y\"`"
    );
}

#[test]
fn gltf_nodes_place_and_name_their_meshes() {
    let mesh = glb(&head_glb().bytes());
    assert_eq!(mesh.triangles.len(), 12);
    assert_eq!(names(&mesh), [("skin", 12), ("Head mesh", 12), ("head", 12), ("root", 12)]);
    assert!((mesh.volume() - 8000.0).abs() < 0.1);
    let centre = mesh.bounds().centre();
    assert!((centre - Vec3::new(0.0, 160.0, 0.0)).abs().max_element() < 1e-3, "{centre}");

    // Turned by 90 degrees about x, then mirrored: still outward, and the normals with it.
    let turned = head_glb().replace("\"translation\":[0,1.6,0]", "\"rotation\":[1,0,0,1],\"scale\":[-1,2,1]");
    let mesh = glb(&turned.bytes());
    assert!((mesh.volume() - 16000.0).abs() < 0.1);
    assert!((mesh.bounds().size() - Vec3::new(20.0, 20.0, 40.0)).abs().max_element() < 1e-3);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        assert!(triangle.iter().all(|&v| mesh.normals[v as usize].dot(mesh.area_vector(t)) > 0.0));
    }
    // Shown twice, once by a matrix.
    let twice = head_glb()
        .replace("{\"name\":\"head\"", "{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,3,0,0,1]},{\"name\":\"head\"")
        .replace("\"children\":[1]", "\"children\":[1,2]");
    let mesh = glb(&twice.bytes());
    assert_eq!((mesh.triangles.len(), mesh.bounds().max.x), (24, 310.0));
    assert_eq!(names(&mesh), [("skin", 24), ("Head mesh", 24), ("head", 12), ("root", 24)]);
}

#[test]
fn gltf_lists_strips_and_fans() {
    // The square's corners around; a strip needs them in zigzag.
    for (mode, indices, triangles) in [
        (4, Some(&[0_u32, 1, 2, 0, 2, 3][..]), vec![[0, 1, 2], [0, 2, 3]]),
        (5, Some(&[0, 1, 3, 2]), vec![[0, 1, 2], [1, 3, 2]]),
        (6, None, vec![[0, 1, 2], [0, 2, 3]]),
        (4, Some(&[0, 1, 2, 3]), vec![[0, 1, 2]]),
    ] {
        let bytes = Glb::square(mode, indices).bytes();
        let read = read("a.glb", &bytes, &options()).unwrap();
        let mesh = read.value;
        assert_eq!(mesh.triangles.len(), triangles.len());
        assert!((0..mesh.triangles.len()).all(|t| mesh.area_vector(t).z > 0.0), "mode {mode}");
        assert!((area(&mesh) - 5000.0 * triangles.len() as f32).abs() < 0.1);
        assert_eq!(read.warnings.len(), usize::from(indices.is_some_and(|i| mode == 4 && i.len() == 4)));
    }
    let lines = Glb::square(1, None).bytes();
    assert_eq!(
        refusal("a.glb", &lines, &options()),
        "the file has no triangles; it has only points and lines; export faces"
    );
}

#[test]
fn gltf_uv_count_downwards_and_quantised_places_are_read() {
    let mesh = glb(&Glb::square(6, None).bytes());
    assert_eq!(mesh.uvs, [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0), Vec2::ZERO]);
    let mesh = glb(&Glb::quantised().bytes());
    assert!((mesh.bounds().size() - Vec3::new(100.0, 100.0, 0.0)).abs().max_element() < 1e-2, "{:?}", mesh.bounds());
}

#[test]
fn sparse_accessors_are_unfolded() {
    // Corner 2 of the square is moved from (1, 1, 0) to (2, 2, 0).
    let mesh = glb(&Glb::sparse().bytes());
    assert_eq!(mesh.bounds().max, Vec3::new(200.0, 200.0, 0.0));
}

#[test]
fn a_skin_stands_as_the_file_rests() {
    // The exporter left 0.01 on the skeleton's root; the mesh is stored in cm.
    let mesh = glb(&skinned_glb().bytes());
    assert!((mesh.bounds().size() - Vec3::splat(20.0)).abs().max_element() < 1e-3, "{:?}", mesh.bounds());
    // Half the weight on a joint that is 10 cm further up.
    let top = mesh.bounds().max.y;
    let moved = glb(&skinned_glb().replace("\"name\":\"tip\"", "\"name\":\"tip\",\"translation\":[0,10,0]").bytes());
    assert!((moved.bounds().max.y - top - 5.0).abs() < 1e-3);
    assert!((moved.bounds().min.y - mesh.bounds().min.y).abs() < 1e-3);
}

#[test]
fn gltf_buffers_may_lie_beside_or_within() {
    let glb = Glb::square(6, None);
    let (json, data) = glb.apart("my%20data.bin");
    let read =
        |name: &str| if name == "my data.bin" { Ok(data.clone()) } else { Err(std::io::ErrorKind::NotFound.into()) };
    let file = FileBytes { name: "a.gltf", bytes: json.as_bytes() };
    assert_eq!(load(&file, &options(), &read).unwrap().value.mesh.triangles.len(), 2);
    let error = load(&file, &options(), &NoSiblings).unwrap_err();
    assert_eq!(error.to_string(), "`my%20data.bin` cannot be read: the file stands alone");
    let short = |_: &str| Ok(data[..50].to_vec());
    let error = load(&file, &options(), &short).unwrap_err();
    assert_eq!(error.to_string(), "buffers[0]: reaches to byte `80` of my%20data.bin with 50 bytes");
    let (json, _) = glb.apart(&glb.data_uri());
    assert_eq!(
        load(&FileBytes { name: "a.gltf", bytes: json.as_bytes() }, &options(), &NoSiblings)
            .unwrap()
            .value
            .mesh
            .triangles
            .len(),
        2
    );
}

#[test]
fn wrong_containers_are_named() {
    let good = head_glb().bytes();
    let n = good.len();
    let with = |at: usize, bytes: &[u8]| [&good[..at], bytes, &good[at + bytes.len()..]].concat();
    for (bytes, words) in [
        (with(0, b"glTG"), "byte 0: expected `glTF`, got `glTG`".to_owned()),
        (good[..7].to_vec(), "byte 7: the file ends within its header of 12 bytes, after `7`; the file was cut off; copy or export it again".into()),
        (with(4, &[1]), "byte 4: glTF version `1`, expected 2; export it as glTF 2.0".into()),
        (good[..n - 9].to_vec(), format!("byte 8: the file says `{n}` bytes, but ends after {}; the file was cut off; copy or export it again", n - 9)),
        (with(8, &[13, 0, 0, 0]), "byte 12: the file ends within a chunk's header, after `13` bytes; the file was cut off; copy or export it again".into()),
        (with(12, &[255, 255, 255, 255]), format!("byte 12: a chunk of `4294967295` bytes, but the file ends {} bytes further; the file was cut off; copy or export it again", n - 20)),
        (with(16, b"JSOM"), "byte 12: no `JSON` chunk".into()),
    ] {
        assert_eq!(refusal("a.glb", &bytes, &options()), words);
    }
    assert_eq!(refusal("a.gltf", b"{]", &options()), "line 1, column 2 of the JSON: key must be a string");
    assert_eq!(
        refusal("a.gltf", b"{\n \"nodes\": 3}", &options()),
        "line 2, column 11 of the JSON: invalid type: integer `3`, expected a sequence"
    );
    assert_eq!(
        refusal("a.gltf", &b"[".repeat(100_000), &options()),
        "line 1, column 2 of the JSON: invalid type: sequence, expected a string"
    );
}

#[test]
fn wrong_gltf_values_are_named() {
    let again = "the file was cut off or is damaged; export it again";
    for (from, to, words) in [
        ("\"version\":\"2.0\"", "\"version\":\"1.0\"", "asset.version: expected 2.0, got `1.0`".to_owned()),
        ("\"asset\"", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\"",
            "the file needs the extension `KHR_draco_mesh_compression`, which is not supported; export it again without mesh compression".into()),
        ("\"asset\"", "\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],\"asset\"",
            "the file needs the extension `EXT_mesh_gpu_instancing`, which is not supported; export it again without this extension".into()),
        ("\"POSITION\":0", "\"POSITION\":9", "meshes[0].primitives[0].attributes.POSITION: names accessor `9`, but there are only 3".into()),
        ("\"POSITION\":0", "\"POSITION\":2", "meshes[0].primitives[0].attributes.POSITION: expected VEC3 of numbers, got `SCALAR of u32`".into()),
        ("\"NORMAL\":1", "\"NORMAL\":2", "meshes[0].primitives[0].attributes.NORMAL: expected VEC3 of numbers, got `SCALAR of u32`".into()),
        ("\"count\":24", "\"count\":25", format!("accessors[0]: reaches to byte `300` of bufferViews[0] with 288 bytes; {again}")),
        ("\"count\":24", "\"count\":0", "accessors[0].count: expected at least 1, got `0`".into()),
        ("\"count\":24", "\"count\":4000000000", "`4000000000` entries in accessors[0]: the limit is 60000000".into()),
        ("\"byteLength\":288", "\"byteLength\":999999", format!("bufferViews[0]: reaches to byte `999999` of buffers[0] with 720 bytes; {again}")),
        ("\"byteLength\":720", "\"byteLength\":1720", format!("buffers[0]: reaches to byte `1720` of its data with 720 bytes; {again}")),
        ("\"mode\":4", "\"mode\":44", "meshes[0].primitives[0].mode: expected 0 to 6, got `44`".into()),
        ("\"material\":0", "\"material\":1", "meshes[0].primitives[0].material: names material `1`, but there are only 1".into()),
        ("\"children\":[1]", "\"children\":[0]", "nodes[0]: node `0` is its own ancestor or has two parents".into()),
        ("\"children\":[1]", "\"children\":[1,1]", "nodes[0].children: node `1` is its own ancestor or has two parents".into()),
        ("\"children\":[1]", "\"children\":[7]", "nodes[0].children: names node `7`, but there are only 2".into()),
        ("\"nodes\":[0]", "\"nodes\":[1]", "scenes[0].nodes: node `1` is its own ancestor or has two parents".into()),
        ("\"mesh\":0", "\"mesh\":3", "nodes[1].mesh: names mesh `3`, but there are only 1".into()),
        ("\"translation\":[0,1.6,0]", "\"rotation\":[0,0,0,0]", "nodes[1]: expected an affine transform, got `not finite`".into()),
        ("\"translation\":[0,1.6,0]", "\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]", "nodes[1]: expected an affine transform, got `perspective`".into()),
        ("\"translation\":[0,1.6,0]", "\"scale\":[1e39,1,1]", "line 1, column 139 of the JSON: number out of range".into()),
        ("\"translation\":[0,1.6,0]", "\"translation\":[0,1e30,0]", "vertex 0 lies `1e32` cm away, further than 100 km; look at the unit".into()),
        ("\"bufferView\":0,", "", "accessors[0]: has no `bufferView`; the data may be compressed; export it again without mesh compression".into()),
    ] {
        let file = head_glb().replace(from, to);
        assert_eq!(refusal("a.glb", &file.bytes(), &options()), words);
    }
    let mut stray = Glb::square(4, Some(&[0, 1, 2]));
    let at = stray.data.len() - 4;
    stray.data[at] = 4;
    assert_eq!(
        refusal("a.glb", &stray.bytes(), &options()),
        "meshes[0].primitives[0].indices: names vertex `4`, but there are only 4"
    );
    let mut nan = Glb::square(6, None);
    nan.data[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(
        refusal("a.glb", &nan.bytes(), &options()),
        "meshes[0].primitives[0].attributes.POSITION: expected finite numbers, got `[NaN, 0, 0]`"
    );
    let mut joint = skinned_glb();
    joint.data[288] = 2;
    assert_eq!(
        refusal("a.glb", &joint.bytes(), &options()),
        "meshes[0].primitives[0].attributes.JOINTS_0: names joint `2`, but there are only 2"
    );
}

#[test]
fn a_small_file_cannot_unfold_without_end() {
    // A sparse accessor over nothing.
    let bare = Glb::sparse()
        .replace("\"bufferView\":0,\"componentType\":5126,\"count\":4", "\"componentType\":5126,\"count\":9000000");
    assert_eq!(refusal("a.glb", &bare.bytes(), &options()), "`9000000` entries in accessors[0]: the limit is 1048576");
    // A mesh of 100 000 triangles at the end of a chain of named nodes.
    let mut chain = String::new();
    for n in 0..2000 {
        chain += &format!("{{\"name\":\"n{n}\",\"children\":[{}]}},", n + 1);
    }
    let deep = Glb::square(6, Some(&[0, 1, 2].repeat(33_334)))
        .replace("\"nodes\":[{\"mesh\"", &format!("\"nodes\":[{chain}{{\"mesh\""));
    assert!(refusal("a.glb", &deep.bytes(), &options()).ends_with("triangles in groups: the limit is 50000000"));

    // 100 000 corners from 12 bytes by a fan over one index, shown by a thousand nodes.
    let mut glb = Glb::square(6, Some(&vec![0_u32; 100_000]));
    let nodes = "{\"mesh\":0},".repeat(999);
    glb = glb.replace("\"nodes\":[{", &format!("\"nodes\":[{nodes}{{")).replace("\"scenes\":[{\"nodes\":[0]}],", "");
    assert!(refusal("a.glb", &glb.bytes(), &options()).ends_with("triangles: the limit is 20000000"));
}

/// A key's choice of one of `n`.
/// Cancels at the given look at the task; how many looks there were.
fn polled(at: usize, work: impl FnOnce(&Task) -> bool) -> (usize, bool) {
    let (task, count) = (Task::new(), Arc::new(AtomicUsize::new(0)));
    let (own, counted) = (task.clone(), Arc::clone(&count));
    let task = task.with_polls(move || {
        if counted.fetch_add(1, Ordering::SeqCst) + 1 == at {
            own.cancel();
        }
    });
    let is_cancelled = work(&task);
    (count.load(Ordering::SeqCst), is_cancelled)
}

#[test]
fn loading_looks_at_its_task_often_and_stops_at_once() {
    // A sheet of 200 x 200 squares in bumps: 40,000 vertices and as many faces, as OBJ.
    let n = 200;
    let mut text = String::new();
    for i in 0..n * n {
        text += &format!("v {} {} {}\n", i % n, i / n, (i * 7) % 5);
    }
    for i in (0..n * n).filter(|i| i % n + 1 < n && i / n + 1 < n) {
        text += &format!("f {} {} {} {}\n", i + 1, i + 2, i + n + 2, i + n + 1);
    }
    let objects = [("a.obj", text.into_bytes(), 40), ("a.glb", head_glb().bytes(), 6)];
    for (name, bytes, least) in objects {
        let load = |task: &Task| match load_until(&FileBytes { name, bytes: &bytes }, &options(), &NoSiblings, task) {
            Err(LoadError::Cancelled(_)) => true,
            Err(e) => panic!("{name}: {e}"),
            Ok(_) => false,
        };
        let (all, is_cancelled) = polled(usize::MAX, load);
        assert!(!is_cancelled && all >= least, "{name}: only {all} looks at the task");
        for at in (1..=all).step_by((all / 12).max(1)) {
            let (count, is_cancelled) = polled(at, load);
            // Once more, to tell a cancelled text from a bad one.
            assert!(is_cancelled && count <= at + 1, "{name}: {count} looks after the cancelling at {at}");
        }
    }
    let egg = coif::head::mannequin::mesh(coif::head::mannequin::Style::Cartoon);
    let head = |task: &Task| {
        let made = coif::head::Head::from_mesh_until(egg.clone(), "egg", &std::collections::BTreeMap::new(), task);
        matches!(made, Err(coif::head::HeadError::Cancelled(_)))
    };
    let (all, is_cancelled) = polled(usize::MAX, head);
    assert!(!is_cancelled && all >= 6, "only {all} looks at the task");
    for at in 1..=all {
        assert_eq!(polled(at, head), (at, true));
    }
}

fn pick(key: Key, n: usize) -> usize {
    (key.bits() % n.max(1) as u64) as usize
}

/// Turns a few bytes over, cuts, doubles a piece, or writes another number where one stands.
fn mutate(file: &[u8], key: Key) -> Vec<u8> {
    const NUMBERS: [&str; 12] = [
        "0",
        "-1",
        "1",
        "2",
        "3",
        "255",
        "65536",
        "4294967295",
        "18446744073709551615",
        "1e39",
        "0.5",
        "99999999999999999999999",
    ];
    let mut bytes = file.to_vec();
    for step in 0..1 + pick(key.with(1), 3) as u64 {
        let key = key.with(100 + step);
        let at = pick(key.with(2), bytes.len());
        match pick(key.with(3), 6) {
            0 => bytes[at] = key.with(4).bits() as u8,
            1 => bytes[at] ^= 1 << pick(key.with(4), 8),
            2 => bytes.truncate(at.max(1)),
            3 => {
                let end = (at + pick(key.with(4), 20)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => {
                // The number at or after `at`.
                let Some(start) = (at..bytes.len()).find(|&i| bytes[i].is_ascii_digit()) else { continue };
                let end = (start..bytes.len()).find(|&i| !bytes[i].is_ascii_digit()).unwrap_or(bytes.len());
                bytes.splice(start..end, NUMBERS[pick(key.with(4), NUMBERS.len())].bytes());
            }
        }
    }
    bytes
}

#[test]
fn no_mutant_gets_past_the_checks_or_breaks_a_reader() {
    let uv = format!(
        "{SQUARE}vt 0 0\nvt 1 0\nvn 0 0 1\no a\ng b c\nusemtl d\nf 1/1/1 2/2/1 3/1/1 4/2/1\nf -1//1 -2//-1 \\\n-3//1\n"
    );
    let glbs = [head_glb(), skinned_glb(), Glb::square(5, Some(&[0, 1, 3, 2])), Glb::quantised(), Glb::sparse()];
    let mut files: Vec<(&str, Vec<u8>)> = vec![("a.obj", CUBE.into()), ("a.obj", uv.into())];
    let (mut good, mut bad) = (0, 0);
    for glb in &glbs {
        files.push(("a.glb", glb.bytes()));
        files.push(("a.gltf", glb.apart(&glb.data_uri()).0.into()));
    }
    let mut try_one = |name: &str, bytes: &[u8], from: &str| match read(name, bytes, &options()) {
        // A panic of a reader that the checks let through.
        Err(LoadError::Reader { problem, .. }) => panic!("{from}: {problem}\n{}", String::from_utf8_lossy(bytes)),
        Err(error) => {
            bad += 1;
            assert!(error.to_string().len() < 400 && !error.hint().is_some_and(|h| h.is_empty()), "{error}");
        }
        Ok(_) => good += 1,
    };
    for seed in 0..2000_u64 {
        let key = Key::new(seed, "mutant");
        let (name, file) = &files[seed as usize % files.len()];
        try_one(name, &mutate(file, key), &format!("seed {seed}"));
        // The JSON alone, with the container around it made good again.
        let glb = &glbs[seed as usize % glbs.len()];
        let json = String::from_utf8_lossy(&mutate(glb.json.as_bytes(), key)).into_owned();
        try_one("a.glb", &Glb { json, data: glb.data.clone() }.bytes(), &format!("json of seed {seed}"));
    }
    assert!(good > 200 && bad > 1000, "{good} good, {bad} bad");
}

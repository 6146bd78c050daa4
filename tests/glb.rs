//! GLB files, read back by another reader than the one that wrote them.

mod export_scene;

use std::sync::Arc;

use coif::export::{ExportError, GlbOptions, StrandForm, glb, guides_glb};
use coif::geometry::strands::StrandsError;
use coif::geometry::{Bounds, MeshError, Root, Strands};
use coif::scene::{Body, Hair, MeshMaterial, Scene};
use coif::task::{Cancelled, Task};
use export_scene::{ball, hair_of, scene};
use glam::{Affine3A, Vec2, Vec3, Vec4};

struct Read {
    json: serde_json::Value,
    bin: Vec<u8>,
}

impl Read {
    fn of(bytes: &[u8]) -> Self {
        let file = gltf::binary::Glb::from_slice(bytes).expect("a GLB");
        assert_eq!(file.header.length as usize, bytes.len());
        Self {
            json: serde_json::from_slice(&file.json).expect("JSON"),
            bin: file.bin.map(|b| b.to_vec()).unwrap_or_default(),
        }
    }

    /// The numbers of a float accessor, `N` each.
    fn floats<const N: usize>(&self, accessor: usize) -> Vec<[f32; N]> {
        let a = &self.json["accessors"][accessor];
        let view = &self.json["bufferViews"][a["bufferView"].as_u64().unwrap() as usize];
        assert_eq!(a["componentType"], 5126);
        let get = |v: &serde_json::Value| v.as_u64().unwrap_or(0) as usize;
        let start = get(&view["byteOffset"]) + get(&a["byteOffset"]);
        let stride = get(&view["byteStride"]);
        (0..get(&a["count"]))
            .map(|i| {
                std::array::from_fn(|k| {
                    let at = start + i * stride + 4 * k;
                    f32::from_le_bytes(self.bin[at..at + 4].try_into().unwrap())
                })
            })
            .collect()
    }

    fn attribute<const N: usize>(&self, mesh: usize, name: &str) -> Vec<[f32; N]> {
        let index = &self.json["meshes"][mesh]["primitives"][0]["attributes"][name];
        self.floats(index.as_u64().unwrap_or_else(|| panic!("no {name}")) as usize)
    }

    fn scalars(&self, mesh: usize, name: &str) -> Vec<f32> {
        self.attribute::<1>(mesh, name).into_iter().map(|[x]| x).collect()
    }
}

/// Everything that holds for every primitive, by the `gltf` crate's own reading.
fn check_common(bytes: &[u8]) -> gltf::Document {
    let (document, buffers, _images) = gltf::import_slice(bytes).expect("the reader takes it");
    assert_eq!(buffers.len(), document.buffers().len());
    for mesh in document.meshes() {
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|b| Some(&buffers[b.index()]));
            let positions: Vec<[f32; 3]> = reader.read_positions().expect("positions").collect();
            let bounds = Bounds::of(positions.iter().map(|&p| p.into()));
            let told = primitive.bounding_box();
            assert_eq!((told.min, told.max), (bounds.min.to_array(), bounds.max.to_array()));
            let indices: Vec<u32> = reader.read_indices().expect("indices").into_u32().collect();
            assert!(indices.iter().all(|&i| (i as usize) < positions.len()));
            if let Some(normals) = reader.read_normals() {
                assert!(normals.map(Vec3::from).all(|n| (n.length() - 1.0).abs() < 1e-5));
            }
            if let Some(tangents) = reader.read_tangents() {
                assert!(tangents.map(Vec4::from).all(|t| (t.truncate().length() - 1.0).abs() < 1e-5));
            }
        }
    }
    document
}

fn segment_distance(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let d = b - a;
    let t = if d == Vec3::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
    p.distance(a + d * t)
}

#[test]
fn ribbons_follow_their_strands() {
    let scene = scene(300);
    let options = GlbOptions { tolerance: 0.05, ..GlbOptions::default() };
    let bytes = glb(&scene, &options, &Task::new()).unwrap();
    check_common(&bytes);
    let file = Read::of(&bytes);
    let (_, hair) = scene.hair().next().unwrap();

    let positions: Vec<Vec3> = file.attribute(1, "POSITION").into_iter().map(Vec3::from_array).collect();
    let normals: Vec<Vec3> = file.attribute(1, "NORMAL").into_iter().map(Vec3::from_array).collect();
    let tangents: Vec<Vec4> = file.attribute(1, "TANGENT").into_iter().map(Vec4::from_array).collect();
    let widths = file.scalars(1, "_WIDTH");
    let ids = file.scalars(1, "_STRAND_ID");
    let guides = file.scalars(1, "_GUIDE_ID");
    let sources = file.scalars(1, "_SOURCE");
    assert!(positions.len() < 2 * hair.strands.points.len() * 2 / 3, "the tolerance leaves nodes out");

    let mut outward = [0, 0];
    let mut start = 0;
    for i in 0..hair.strands.count() {
        let end = start + ids[start..].iter().take_while(|&&id| id == i as f32).count();
        assert!(end >= start + 4 && end % 2 == 0, "strand {i} has vertices {start}..{end}");
        let mut middle = Vec::new();
        for k in (start..end).step_by(2) {
            assert_eq!((guides[k], sources[k]), ((i % 5) as f32, (i % 2) as f32));
            assert_eq!((normals[k], tangents[k]), (normals[k + 1], tangents[k + 1]));
            let side = positions[k + 1] - positions[k];
            assert!((side.length() - widths[k]).abs() < 2e-7, "the ribbon is as wide as it says");
            // glTF 2.0, section 3.7.2.1: bitangent = cross(normal, tangent) * w; here it runs with u.
            let bitangent = normals[k].cross(tangents[k].truncate()) * tangents[k].w;
            assert!(bitangent.dot(side.normalize()) > 0.99);
            let p = (positions[k] + positions[k + 1]) * 50.0;
            middle.push(p);
            // Lying on the ball: tangential and before the curls begin, at 0.4 * 1.4 radians from the root.
            let up = p.normalize();
            if up.dot(hair.strands.roots[i].normal) > 0.86 && tangents[k].truncate().dot(up).abs() < 0.3 {
                outward[usize::from(normals[k].dot(up) > 0.9)] += 1;
            }
        }
        let strand = hair.strands.strand(i);
        assert!(middle[0].distance(strand[0]) < 1e-4);
        assert!(middle[middle.len() - 1].distance(strand[strand.len() - 1]) < 1e-4);
        for w in strand.windows(2) {
            for s in 0..4 {
                let p = w[0].lerp(w[1], s as f32 / 4.0);
                let d = middle.windows(2).map(|m| segment_distance(p, m[0], m[1])).fold(f32::INFINITY, f32::min);
                assert!(d <= 0.05 + 1e-4, "strand {i}: a point is {d} cm from its ribbon");
            }
        }
        let material = &hair.material;
        assert!((widths[start] - material.width * 0.01).abs() < 1e-8);
        assert!((widths[end - 1] - material.width * material.taper * 0.01).abs() < 1e-8);
        start = end;
    }
    assert_eq!(start, positions.len());
    assert!(outward[1] > 300 && outward[0] == 0, "lying ribbons face outward: {outward:?}");
}

#[test]
fn ribbon_triangles_face_as_their_normals_and_uv_run_from_root_to_tip() {
    let scene = scene(60);
    let bytes = glb(&scene, &GlbOptions::default(), &Task::new()).unwrap();
    let (document, buffers, images) = gltf::import_slice(&bytes).unwrap();
    let mesh = document.meshes().find(|m| m.name() == Some("hair")).unwrap();
    let primitive = mesh.primitives().next().unwrap();
    assert_eq!(primitive.mode(), gltf::mesh::Mode::Triangles);
    let reader = primitive.reader(|b| Some(&buffers[b.index()]));
    let p: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
    let n: Vec<Vec3> = reader.read_normals().unwrap().map(Vec3::from).collect();
    let uv: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    let ids = Read::of(&bytes).scalars(1, "_STRAND_ID");
    for t in indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| i as usize);
        assert!(ids[a] == ids[b] && ids[b] == ids[c], "no triangle joins two strands");
        let area = (p[b] - p[a]).cross(p[c] - p[a]);
        // A sharp bend turns a triangle by at most half the bend against its corners.
        assert!(area.normalize().dot(n[a] + n[b] + n[c]) > 0.0);
    }
    for k in (0..uv.len()).step_by(2) {
        assert_eq!((uv[k][0], uv[k + 1][0], uv[k][1]), (0.0, 1.0, uv[k + 1][1]));
        if k + 2 < uv.len() && ids[k] == ids[k + 2] {
            assert!(uv[k + 2][1] > uv[k][1]);
        } else {
            assert_eq!(uv[k][1], 1.0);
        }
    }

    let material = primitive.material();
    assert!(material.double_sided());
    let texture = material.pbr_metallic_roughness().base_color_texture().expect("a ramp from root to tip");
    let ramp = &images[texture.texture().source().index()];
    let row = |r: u32| {
        let at = (r * ramp.width * 3) as usize;
        [ramp.pixels[at], ramp.pixels[at + 1], ramp.pixels[at + 2]].map(f32::from)
    };
    let (_, hair) = scene.hair().next().unwrap();
    for (texel, colour) in [(row(0), hair.material.root_colour), (row(ramp.height - 1), hair.material.tip_colour)] {
        // Brighter by the variation, which the vertex colour takes back on average; half a texel from the end.
        let gain = 1.0 + hair.material.variation;
        let wanted = coif::math::Colour::from_linear(colour.to_linear() * gain);
        for (have, want) in texel.into_iter().zip([wanted.r, wanted.g, wanted.b]) {
            assert!((have - want * 255.0).abs() < 2.0, "{texel:?} for {wanted}");
        }
    }
    let colours: Vec<[f32; 4]> = reader.read_colors(0).unwrap().into_rgba_f32().collect();
    let mean: f32 = colours.iter().map(|c| c[0]).sum::<f32>() / colours.len() as f32;
    assert!((mean * (1.0 + hair.material.variation) - 1.0).abs() < 0.05, "strands are as bright as told on average");
}

#[test]
fn the_head_comes_back_in_metres_below_its_placement() {
    let scene = scene(4);
    let bytes = glb(&scene, &GlbOptions::default(), &Task::new()).unwrap();
    let document = check_common(&bytes);
    let root = document.default_scene().unwrap().nodes().next().unwrap();
    assert_eq!(root.name(), Some("style"));
    let names: Vec<_> = root.children().map(|c| c.name().unwrap().to_owned()).collect();
    assert_eq!(names, ["head", "hair"]);
    let matrix = glam::Mat4::from_cols_array_2d(&root.transform().matrix());
    for p in [Vec3::ZERO, Vec3::new(3.0, -4.0, 5.0)] {
        let wanted = scene.placement.transform_point3(p) * 0.01;
        assert!(matrix.transform_point3(p * 0.01).distance(wanted) < 1e-6);
    }
    let (file, ball) = (Read::of(&bytes), ball());
    for (name, wanted) in [("POSITION", &ball.positions), ("NORMAL", &ball.normals)] {
        let scale = if name == "POSITION" { 0.01 } else { 1.0 };
        let have = file.attribute::<3>(0, name);
        assert_eq!(have.len(), wanted.len());
        assert!(have.iter().zip(wanted).all(|(h, w)| Vec3::from_array(*h).distance(*w * scale) < 1e-6));
    }
    for (have, uv) in file.attribute::<2>(0, "TEXCOORD_0").iter().zip(&ball.uvs) {
        assert_eq!(*have, [uv.x, 1.0 - uv.y]);
    }
    assert_eq!(file.json["asset"]["generator"], concat!("coif ", env!("CARGO_PKG_VERSION")));
}

#[test]
fn extras_say_which_lines_made_a_strand() {
    let bytes = glb(&scene(4), &GlbOptions::default(), &Task::new()).unwrap();
    let file = Read::of(&bytes);
    let extras = &file.json["nodes"][2]["extras"]["coif"];
    assert_eq!(extras["source"], "style.lua:12");
    assert_eq!((&extras["strands"], &extras["guides"]), (&4.into(), &5.into()));
    assert_eq!(extras["sources"], serde_json::json!(["style.lua:7", "style.lua:12"]));
    assert_eq!(file.json["materials"][1]["extras"]["coif"]["root_colour"], "#2e1b12");
}

#[test]
fn lines_and_guides() {
    let scene = scene(40);
    let (_, hair) = scene.hair().next().unwrap();
    let options = GlbOptions { strands: StrandForm::Lines, tolerance: 0.0, ..GlbOptions::default() };
    let bytes = glb(&scene, &options, &Task::new()).unwrap();
    let lines = check_common(&bytes);
    let primitive = lines.meshes().nth(1).unwrap().primitives().next().unwrap();
    assert_eq!(primitive.mode(), gltf::mesh::Mode::Lines);
    let have = Read::of(&bytes).attribute::<3>(1, "POSITION");
    assert_eq!(have.len(), hair.strands.points.len());
    let segments = hair.strands.points.len() - hair.strands.count();
    assert_eq!(primitive.indices().unwrap().count(), 2 * segments);

    let bytes = guides_glb(&scene, &GlbOptions::default(), &Task::new()).unwrap();
    let document = check_common(&bytes);
    let names: Vec<_> = document.nodes().map(|n| n.name().unwrap().to_owned()).collect();
    assert_eq!(names, ["style", "hair guides"]);
    let file = Read::of(&bytes);
    let have = file.attribute::<3>(0, "POSITION");
    assert_eq!(have.len(), hair.guides.points.len());
    for (h, w) in have.iter().zip(&hair.guides.points) {
        assert!(Vec3::from_array(*h).distance(*w * 0.01) < 1e-6);
    }
    let ids = file.scalars(0, "_STRAND_ID");
    assert_eq!(ids.last(), Some(&4.0));

    let options = GlbOptions { strands: StrandForm::None, ..GlbOptions::default() };
    let document = check_common(&glb(&scene, &options, &Task::new()).unwrap());
    assert_eq!(document.meshes().len(), 1);
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let scene = scene(1500);
    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| glb(&scene, &GlbOptions::default(), &Task::new()).unwrap())
    };
    let one = bytes(1);
    assert!(one == bytes(4) && one == bytes(1));
}

#[test]
fn degenerate_strands_are_written() {
    let mut scene = scene(1);
    let hair = hair_of(&mut scene);
    let strands = Arc::make_mut(&mut hair.strands);
    let root = |id| Root { id, position: Vec3::Y, normal: Vec3::Y, uv: Vec2::ZERO, triangle: 0 };
    strands.push(root(90), 0, [Vec3::Y; 3]);
    strands.push(root(91), 0, [Vec3::Y, Vec3::Y * 2.0, Vec3::Y * 3.0]);
    strands.push(Root { normal: Vec3::ZERO, ..root(92) }, 0, [Vec3::Y, Vec3::X, Vec3::Y]);
    strands.push(Root { normal: Vec3::NAN, ..root(93) }, 0, [Vec3::Y, Vec3::X]);
    for form in [StrandForm::Ribbons, StrandForm::Lines] {
        check_common(&glb(&scene, &GlbOptions { strands: form, ..GlbOptions::default() }, &Task::new()).unwrap());
    }

    let empty = Scene { parts: Vec::new(), placement: Affine3A::IDENTITY, ..scene.clone() };
    let bytes = glb(&empty, &GlbOptions::default(), &Task::new()).unwrap();
    assert_eq!(Read::of(&bytes).json["nodes"].as_array().map(Vec::len), Some(1));
    *hair_of(&mut scene) = Hair { strands: Arc::new(Strands::new()), ..hair_of(&mut scene).clone() };
    let document = check_common(&glb(&scene, &GlbOptions::default(), &Task::new()).unwrap());
    assert_eq!((document.meshes().len(), document.nodes().len()), (1, 3));
}

#[test]
fn what_cannot_be_written_is_named() {
    let good = scene(30);
    let task = Task::new();
    let options = GlbOptions { max_bytes: 10_000, ..GlbOptions::default() };
    match glb(&good, &options, &task) {
        Err(ExportError::TooLarge { bytes, limit: 10_000 }) => assert!(bytes > 10_000),
        other => panic!("{:?}", other.map(|b| b.len())),
    }
    let exact = glb(&good, &GlbOptions::default(), &task).unwrap().len() as u64;
    assert!(glb(&good, &GlbOptions { max_bytes: exact, ..GlbOptions::default() }, &task).is_ok());
    let close = GlbOptions { max_bytes: exact - 1, ..GlbOptions::default() };
    assert_eq!(glb(&good, &close, &task).unwrap_err(), ExportError::TooLarge { bytes: exact, limit: exact - 1 });

    let refused = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene(30);
        change(&mut scene);
        glb(&scene, &GlbOptions::default(), &Task::new()).expect_err("it must be refused")
    };
    let error = refused(&|s| Arc::make_mut(&mut hair_of(s).strands).points[25].y = f32::NAN);
    assert!(
        matches!(&error, ExportError::Strands { part, error: StrandsError::NotFinite { strand: 1, .. } } if part == "hair")
    );
    let error = refused(&|s| Arc::make_mut(&mut hair_of(s).strands).guide[7] = 5);
    assert_eq!(error.to_string(), "part `hair`: strand 7 names guide 5, but there are only 5");
    let error = refused(&|s| Arc::make_mut(&mut hair_of(s).strands).source[7] = 2);
    assert_eq!(error.to_string(), "part `hair`: strand 7 names source 2, but there are only 2");
    let error = refused(&|s| {
        let mut mesh = ball();
        mesh.positions[3].x = f32::INFINITY;
        s.parts[0].body = Body::Mesh(Arc::new(mesh), MeshMaterial::default());
    });
    assert!(matches!(error, ExportError::Mesh { error: MeshError::NotFinite { vertex: 3, .. }, .. }));
    let sheared = Affine3A::from_mat3(glam::Mat3::from_cols(Vec3::X, Vec3::new(0.5, 1.0, 0.0), Vec3::Z));
    assert!(matches!(refused(&|s| s.placement = sheared), ExportError::Placement { .. }));
    let nowhere = Affine3A::from_translation(Vec3::NAN);
    assert!(matches!(refused(&|s| s.placement = nowhere), ExportError::Placement { .. }));
    for tolerance in [-0.1, f32::NAN, f32::INFINITY] {
        let options = GlbOptions { tolerance, ..GlbOptions::default() };
        assert!(matches!(glb(&good, &options, &task), Err(ExportError::Tolerance { .. })));
    }
    task.cancel();
    assert_eq!(glb(&good, &GlbOptions::default(), &task), Err(ExportError::Cancelled(Cancelled)));
    assert_eq!(guides_glb(&good, &GlbOptions::default(), &task), Err(ExportError::Cancelled(Cancelled)));
}

/// Leaves files for the Khronos validator, which `.ci/run` lets loose on them.
#[test]
fn samples_for_the_validator() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("glb");
    std::fs::create_dir_all(&folder).unwrap();
    let scene = scene(400);
    for (name, form) in [("ribbons", StrandForm::Ribbons), ("lines", StrandForm::Lines), ("none", StrandForm::None)] {
        let bytes = glb(&scene, &GlbOptions { strands: form, ..GlbOptions::default() }, &Task::new()).unwrap();
        std::fs::write(folder.join(format!("{name}.glb")), bytes).unwrap();
    }
    let bytes = guides_glb(&scene, &GlbOptions::default(), &Task::new()).unwrap();
    std::fs::write(folder.join("guides.glb"), bytes).unwrap();
}

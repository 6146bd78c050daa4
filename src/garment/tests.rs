//! Laws of garments.

use glam::Vec3;

use super::*;
use crate::geometry::bvh::tests::sphere;
use crate::geometry::{Solid, slice};
use crate::params::{Params, Table, Value, read};
use crate::task::Task;

fn with<P: Params>(fields: &[(&str, f64)]) -> P {
    let fields = fields.iter().map(|(k, v)| ((*k).to_owned(), Value::Number(*v))).collect();
    read::<P>(&Table { items: vec![], fields }).unwrap()
}

fn library() -> Vec<Garment> {
    vec![
        with::<SkirtOptions>(&[]).build(),
        with::<DressOptions>(&[]).build(),
        with::<ShirtOptions>(&[]).build(),
        with::<TrousersOptions>(&[]).build(),
        with::<FormOptions>(&[]).build(),
    ]
}

fn girth(garment: &Garment, name: &str) -> f32 {
    let tape = garment.tape(name).unwrap();
    let there: Vec<String> = tape.parts.iter().filter(|p| garment.mesh.group(p).is_some()).cloned().collect();
    let part = garment.triangles(&there);
    let outlines = slice::cut(&garment.mesh, tape.height, |t| part.is_empty() || part.contains(&t));
    slice::outline(&outlines, tape.side).unwrap().tape()
}

/// Borders of the surface: edges of one triangle, by place.
fn borders(mesh: &Mesh) -> usize {
    let same = mesh.weld();
    let mut edges = std::collections::BTreeMap::new();
    for t in &mesh.triangles {
        let t = t.map(|v| same[v as usize]);
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            *edges.entry((a.min(b), a.max(b))).or_insert(0) += 1;
        }
    }
    edges.values().filter(|&&n| n == 1).count()
}

#[test]
fn every_piece_is_a_sound_mesh_in_named_parts() {
    for garment in library() {
        let mesh = &garment.mesh;
        mesh.validate().unwrap();
        assert!(mesh.normals.iter().all(|n| n.is_normalized()), "{}", garment.kind);
        assert_eq!(mesh.uvs.len(), mesh.positions.len());
        let named: usize = mesh.groups.iter().map(|g| g.triangles.len()).sum();
        assert_eq!(named, mesh.triangles.len(), "{}: every triangle is of one part", garment.kind);
        assert!(garment.parts().len() >= 2, "{}", garment.kind);
        // The left is the mirrored right: so are the bounds.
        let bounds = mesh.bounds();
        assert!((bounds.min.x + bounds.max.x).abs() < 0.05, "{} {bounds:?}", garment.kind);
    }
}

#[test]
fn pieces_have_the_girths_that_were_asked_for() {
    let skirt = with::<SkirtOptions>(&[("waist", 71.0), ("hem", 150.0), ("length", 50.0)]).build();
    assert!((girth(&skirt, "waist") - 71.0).abs() < 0.1, "{}", girth(&skirt, "waist"));
    let low = skirt.mesh.bounds().min.y;
    let hem = slice::cut(&skirt.mesh, low + 3.0, |_| true);
    let hem = slice::outline(&hem, Side::Middle).unwrap().tape();
    assert!((hem - 150.0).abs() < 8.0, "{hem}");
    assert!((low + 57.0 + 50.0).abs() < 1.5, "{low}");
    for bust in [75.0, 88.7, 120.0] {
        let dress = with::<DressOptions>(&[("bust", bust), ("waist", 57.0)]).build();
        assert!((f64::from(girth(&dress, "bust")) - bust).abs() < 0.3, "{bust} {}", girth(&dress, "bust"));
        assert!((girth(&dress, "waist") - 57.0).abs() < 0.1);
    }
    let shirt = with::<ShirtOptions>(&[("waist", 80.0), ("hip", 100.0)]).build();
    assert!((girth(&shirt, "waist") - 80.0).abs() < 0.2 && (girth(&shirt, "hip") - 100.0).abs() < 0.2);
    let trousers = with::<TrousersOptions>(&[("waist", 70.0), ("knee", 44.0)]).build();
    assert!((girth(&trousers, "waist") - 70.0).abs() < 0.1 && (girth(&trousers, "hip") - 92.0).abs() < 0.3);
    assert!((girth(&trousers, "left_knee") - 44.0).abs() < 2.0);
    assert!((girth(&trousers, "left_knee") - girth(&trousers, "right_knee")).abs() < 0.05);
}

#[test]
fn sleeves_and_legs_are_sewn_on_without_a_gap() {
    // A shirt is open at the inner edges of neck, hem and two cuffs; a gap would add borders by the hundred.
    for (garment, rims) in [(with::<ShirtOptions>(&[]).build(), 4), (with::<TrousersOptions>(&[]).build(), 3)] {
        let mesh = &garment.mesh;
        let found = borders(mesh);
        assert!(found > 0 && found <= rims * 150, "{}: {found}", garment.kind);
        for part in garment.mesh.groups.iter().filter(|g| g.name.contains("sleeve") || g.name.contains("leg")) {
            let own = mesh.triangles[part.triangles[0] as usize].map(|v| mesh.positions[v as usize]);
            let touching = |t: &[u32; 3]| t.iter().any(|&v| own.contains(&mesh.positions[v as usize]));
            let others = (0..mesh.triangles.len() as u32).filter(|t| part.triangles.binary_search(t).is_err());
            assert!(others.filter(|&t| touching(&mesh.triangles[t as usize])).count() > 0, "{} is loose", part.name);
        }
    }
}

#[test]
fn a_form_is_a_body() {
    let form = FormOptions { stand: false, ..with::<FormOptions>(&[]) }.build();
    assert_eq!(borders(&form.mesh), 0, "closed");
    assert!(form.mesh.volume() > 20_000.0 && Solid::new(&form.mesh).is_ok(), "{}", form.mesh.volume());
}

#[test]
fn cloth_is_pushed_out_of_the_body_and_the_rest_stays() {
    let form = with::<FormOptions>(&[]).build();
    let body = Solid::new(&form.mesh).unwrap();
    let tight = with::<DressOptions>(&[("waist", 56.0), ("bust", 80.0), ("hip", 84.0)]).build();
    let inside = |mesh: &Mesh| mesh.positions.iter().filter(|&&p| body.signed_distance(p) < 0.0).count();
    assert!(inside(&tight.mesh) > 100);
    let cleared = clear(&tight.mesh, &body, 0.3, &Task::new()).unwrap();
    assert!(cleared.dipped > 100 && cleared.left == 0, "{} {}", cleared.dipped, cleared.left);
    let moved = tight.mesh.moved(&cleared.positions);
    assert_eq!(inside(&moved), 0);
    let near = moved.positions.iter().map(|&p| body.signed_distance(p)).fold(f32::INFINITY, f32::min);
    assert!(near > 0.25, "{near}");
    assert_eq!(tight.mesh.weld(), moved.weld(), "seams stay closed");
    let low = |p: &Vec3| p.y < -95.0;
    let kept = tight.mesh.positions.iter().zip(&moved.positions).filter(|(p, _)| low(p)).all(|(p, q)| p == q);
    assert!(kept, "the skirt below the form stays");
    // Nothing near: nothing moves, to the bit.
    let far = sphere(8, 2.0);
    let same = clear(&far, &body, 0.3, &Task::new()).unwrap();
    assert!(same.positions == far.positions && same.dipped == 0);
    let stopped = Task::new();
    stopped.cancel();
    assert!(clear(&tight.mesh, &body, 0.3, &stopped).is_err());
}

#[test]
fn parts_by_heights_and_tapes_by_name() {
    let shirt = with::<ShirtOptions>(&[]).build();
    let split = shirt.clone().split(&[("upper".into(), -45.0, 0.0), ("lower".into(), -100.0, -45.0)]);
    let (a, b) = (split.mesh.group("upper").unwrap(), split.mesh.group("lower").unwrap());
    assert_eq!(a.triangles.len() + b.triangles.len(), shirt.mesh.triangles.len());
    assert!(split.mesh.group("left_sleeve").is_some());
    let tape = Tape { name: "waist".into(), height: -55.0, side: Side::Middle, parts: vec![] };
    let shirt = shirt.with_tape(tape);
    assert_eq!(shirt.tape("waist").unwrap().height, -55.0);
    assert_eq!(shirt.tapes.iter().filter(|t| t.name == "waist").count(), 1);
    // A tape may move cloth as far as the next one around the same parts, or the reach.
    let bust = shirt.tape("bust").unwrap().clone();
    assert_eq!(shirt.reach(&bust, 10.0), (-49.0, -29.0));
    assert_eq!(shirt.reach(&bust, 60.0).0, -77.0);
}

#[test]
fn a_ribbon_lies_around_its_outline() {
    let form = with::<FormOptions>(&[]).build();
    let outlines = slice::cut(&form.mesh, -57.0, |_| true);
    let outline = slice::outline(&outlines, Side::Middle).unwrap();
    let ribbon = ribbon(outline, 1.6);
    ribbon.validate().unwrap();
    assert!(ribbon.volume() > 5.0, "closed, and it faces outward: {}", ribbon.volume());
    let hull = outline.hull();
    let off = ribbon.positions.iter().map(|p| slice::outside(&hull, glam::Vec2::new(p.x, p.z)));
    assert!(off.fold(f32::INFINITY, f32::min) > 0.05);
}

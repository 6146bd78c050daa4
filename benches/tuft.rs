//! Meshes of many tufts, beside writing the same bytes. `cargo bench --bench tuft`.

use coif::tuft::{Detail, Section, Stroke, Tuft, Tufts, toward};
use divan::{Bencher, black_box};
use glam::Vec3;

fn main() {
    divan::main();
}

/// 200 tufts of 20 control points and 40 sides: 1,520 triangles each.
fn tufts(detail: Detail) -> Tufts {
    let tufts = (0..200).map(|i| {
        let points = (0..20).map(|k| {
            let s = k as f32 / 19.0;
            toward(i as f32 * 0.7 + 0.3 * s, 1.2 - 1.6 * s - 0.002 * i as f32) * (9.0 + 3.0 * s * (1.3 - s))
        });
        let stroke = Stroke::new(points.collect(), Vec3::ZERO, 1.0).expect("points apart");
        let section = Section { flatten: 0.3, ..Section::round(2.0, 0.3) };
        Tuft { detail, ..Tuft::new(stroke, section).expect("a plain section") }
    });
    Tufts::new(tufts.collect(), "bench")
}

#[divan::bench]
fn mesh_of_200_tufts_of_1520_triangles(bencher: Bencher) {
    let tufts = tufts(Detail::ControlPoints { sides: 40 });
    assert_eq!(tufts.triangle_count(), 200 * 1520);
    bencher.bench(|| tufts.mesh());
}

/// The same buffers, only filled.
#[divan::bench]
fn memset_of_the_same_bytes(bencher: Bencher) {
    let mesh = tufts(Detail::ControlPoints { sides: 40 }).mesh();
    let (vertices, triangles) = (mesh.mesh.positions.len(), mesh.mesh.triangles.len());
    let bytes = vertices * (12 + 12 + 8 + 4) + triangles * 12;
    bencher.bench(|| black_box(vec![black_box(1_u8); bytes]));
}

#[divan::bench]
fn mesh_of_200_tufts_by_tolerance(bencher: Bencher) {
    let tufts = tufts(Detail::Tolerance(0.05));
    bencher.bench(|| tufts.mesh());
}

#[divan::bench]
fn reduce_200_tufts_to_20000_triangles(bencher: Bencher) {
    let tufts = tufts(Detail::ControlPoints { sides: 40 });
    bencher.bench(|| coif::tuft::reduce(&tufts, &[], 20_000));
}

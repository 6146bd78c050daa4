//! Laws of the whole picture.

use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};

use crate::geometry::{Mesh, Root, Strands};
use crate::math::{Colour, rng::Key};
use crate::scene::{Background, Body, Hair, HairMaterial, Look, MeshMaterial, Overlay, Part, Scene, Shown, View};
use crate::task::Task;

use super::{Picture, RenderError, SheetOptions, sheet};

fn root(id: u64, position: Vec3) -> Root {
    Root { id, position, normal: Vec3::Y, uv: Vec2::ZERO, triangle: 0 }
}

fn strands(lines: &[Vec<Vec3>]) -> Arc<Strands> {
    let mut s = Strands::new();
    for (i, line) in lines.iter().enumerate() {
        s.push(root(i as u64 + 1, line[0]), 0, line.iter().copied());
    }
    Arc::new(s)
}

fn part(name: &str, lines: &[Vec<Vec3>], colour: u32, width: f32) -> Part {
    let strands = strands(lines);
    let material = HairMaterial {
        root_colour: Colour::hex(colour),
        tip_colour: Colour::hex(colour),
        variation: 0.0,
        width,
        taper: 1.0,
        shine: 0.0,
        ..HairMaterial::default()
    };
    let hair = Hair { guides: strands.clone(), strands, material, overlay: Arc::new(Overlay::default()) };
    Part { name: name.into(), source: String::new(), body: Body::Hair(hair), motion: None }
}

/// A sphere of radius `r` in 24 x 48 pieces.
fn ball(r: f32) -> Part {
    use crate::math::trig::{cos, sin};
    use std::f32::consts::{PI, TAU};
    let mut mesh = Mesh::default();
    for i in 0..=24_u32 {
        for j in 0..48_u32 {
            let (a, b) = (PI * i as f32 / 24.0, TAU * j as f32 / 48.0);
            mesh.positions.push(Vec3::new(sin(a) * sin(b), cos(a), sin(a) * cos(b)) * r);
            if i < 24 {
                let (p, q) = (i * 48 + j, i * 48 + (j + 1) % 48);
                mesh.triangles.extend([[p, p + 48, q], [q, p + 48, q + 48]]);
            }
        }
    }
    let material = MeshMaterial::default();
    Part { name: "head".into(), source: String::new(), body: Body::Mesh(Arc::new(mesh), material), motion: None }
}

fn scene(parts: Vec<Part>, views: &[View]) -> Scene {
    Scene {
        name: "test".into(),
        parts,
        views: views.to_vec(),
        look: Look::default(),
        placement: Affine3A::IDENTITY,
        shown: Shown::default(),
        overlay: Arc::default(),
    }
}

fn bare(width: u32, height: u32) -> SheetOptions {
    SheetOptions { width, height, columns: None, supersample: 1, coarse: 1, lettering: false }
}

fn draw(scene: &Scene, options: &SheetOptions) -> Picture {
    let picture = sheet(scene, options, &Task::new()).unwrap();
    assert_eq!(picture.pixels.len(), picture.width as usize * picture.height as usize * 3);
    picture
}

fn at(p: &Picture, x: u32, y: u32) -> [u8; 3] {
    let i = ((y * p.width + x) * 3) as usize;
    [p.pixels[i], p.pixels[i + 1], p.pixels[i + 2]]
}

fn red(c: [u8; 3]) -> bool {
    c[0] > c[1].saturating_add(20) && c[0] > c[2].saturating_add(20)
}

fn green(c: [u8; 3]) -> bool {
    c[1] > c[0].saturating_add(20) && c[1] > c[2].saturating_add(20)
}

/// A bar along x (or y) at depth z.
fn bar(upright: bool, z: f32) -> Vec<Vec3> {
    (0..=10)
        .map(|i| {
            let s = i as f32 - 5.0;
            if upright { Vec3::new(0.0, s, z) } else { Vec3::new(s, 0.0, z) }
        })
        .collect()
}

#[test]
fn the_nearer_strand_hides_the_farther_whatever_the_order() {
    let near = part("near", &[bar(true, 1.0)], 0xff_20_20, 1.0);
    let far = part("far", &[bar(false, -1.0)], 0x20_ff_20, 1.0);
    for parts in [vec![near.clone(), far.clone()], vec![far, near]] {
        let front = draw(&scene(parts.clone(), &[View::Front]), &bare(200, 200));
        assert!(red(at(&front, 100, 100)), "{:?}", at(&front, 100, 100));
        assert!(green(at(&front, 40, 100)), "{:?}", at(&front, 40, 100));
        let back = draw(&scene(parts, &[View::Back]), &bare(200, 200));
        assert!(green(at(&back, 100, 100)), "{:?}", at(&back, 100, 100));
    }
}

#[test]
fn what_lies_behind_the_head_is_hidden() {
    for (z, seen) in [(-5.0, false), (5.0, true)] {
        let parts = vec![ball(4.0), part("hair", &[bar(false, z)], 0x20_ff_20, 0.6)];
        let p = draw(&scene(parts, &[View::Front]), &bare(240, 240));
        assert_eq!(green(at(&p, 120, 120)), seen, "z {z}");
        // Beside the ball it is always there.
        assert!((10..230).any(|x| green(at(&p, x, 120)) && !(60..180).contains(&x)));
    }
}

#[test]
fn coverage_is_proportional_to_width() {
    // Black strands on white: what is missing from white, in linear light, is the covered area.
    let missing = |width: f32, tilt: f32| {
        let line: Vec<Vec3> = (0..=20).map(|i| Vec3::new(i as f32 - 10.0, tilt * (i as f32 - 10.0), 0.0)).collect();
        let frame = vec![Vec3::new(-12.0, -12.0, 0.0), Vec3::new(-12.0, -11.99, 0.0)];
        let p = draw(&scene(vec![part("hair", &[line, frame], 0, width)], &[View::Front]), &bare(256, 256));
        p.pixels.chunks(3).map(|c| 1.0 - Colour::new(c[0] as f32 / 255.0, 0.0, 0.0).to_linear().x).sum::<f32>()
    };
    for tilt in [0.0, 0.31, 1.0] {
        let one = missing(0.01, tilt);
        for times in [2.0, 5.0, 40.0] {
            let more = missing(0.01 * times, tilt);
            assert!((more / one / times - 1.0).abs() < 0.08, "{times} times as wide: {more} for {one}");
        }
    }
}

#[test]
fn thinned_hair_with_wider_strands_is_as_dense() {
    // A fringe of parallel strands: all of them, and every eighth eight times as wide.
    let fringe = |step: usize| -> Vec<Vec<Vec3>> {
        let strand = |i: usize| {
            let key = Key::new(3, "fringe").with(i as u64);
            let (x, z) = (key.unit() * 10.0 - 5.0, key.with(1).unit());
            (0..=8).map(|k| Vec3::new(x, 4.0 - k as f32, z)).collect()
        };
        (0..1600).step_by(step).map(strand).collect()
    };
    let covered = |lines: &[Vec<Vec3>], times: f32| {
        let p = draw(&scene(vec![part("hair", lines, 0, 0.004 * times)], &[View::Front]), &bare(256, 256));
        p.pixels.iter().map(|&c| 1.0 - Colour::new(f32::from(c) / 255.0, 0.0, 0.0).to_linear().x).sum::<f32>()
    };
    let (whole, thinned, thin) = (covered(&fringe(1), 1.0), covered(&fringe(8), 8.0), covered(&fringe(8), 1.0));
    assert!((thinned / whole - 1.0).abs() < 0.06, "{thinned} of {whole}");
    assert!(thin < 0.3 * whole, "{thin} of {whole}");
}

#[test]
fn threads_do_not_change_a_byte() {
    let key = Key::new(5, "threads");
    let lines: Vec<Vec<Vec3>> = (0..700)
        .map(|i| {
            let mut p = key.with(i).direction() * 5.0;
            let d = key.with(i + 10_000).direction() * 0.4;
            (0..20)
                .map(|_| {
                    p += d;
                    p
                })
                .collect()
        })
        .collect();
    let mut s = scene(vec![ball(4.5), part("hair", &lines, 0x6b_43_2b, 0.03)], &[View::Front, View::ThreeQuarter]);
    for debug in [false, true] {
        s.look.debug = debug;
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| draw(&s, &SheetOptions { width: 120, height: 130, ..SheetOptions::default() }))
        };
        assert!(run(1) == run(4), "debug {debug}");
    }
}

#[test]
fn degenerate_strands_do_no_harm() {
    let lines = vec![
        vec![Vec3::ZERO; 5],
        vec![Vec3::ZERO, Vec3::ZERO, Vec3::X, Vec3::X],
        vec![Vec3::new(0.0, 0.0, -3.0), Vec3::new(0.0, 0.0, 3.0)],
        vec![Vec3::new(f32::NAN, 0.0, 0.0), Vec3::Y],
        vec![Vec3::new(f32::INFINITY, 0.0, 0.0), Vec3::Y],
        vec![Vec3::splat(-2.0), Vec3::splat(2.0)],
    ];
    let mut s = scene(vec![ball(1.0), part("hair", &lines, 0x30_20_10, 0.05)], &[View::Front, View::Top]);
    for debug in [false, true] {
        s.look.debug = debug;
        let p = draw(&s, &bare(64, 64));
        assert!(p.pixels.iter().any(|&c| c < 200));
    }
    // Nothing but such strands.
    draw(&scene(vec![part("hair", &lines[3..5], 0, 0.1)], &[View::Left]), &bare(32, 32));
    draw(&scene(vec![part("hair", &lines[..1], 0, 0.1)], &[View::Left]), &bare(32, 32));
}

#[test]
fn an_empty_scene_is_paper() {
    for (background, want) in [(Background::White, [255, 255, 255]), (Background::Dark, [0x15, 0x16, 0x19])] {
        let mut s = scene(Vec::new(), &[View::Front]);
        s.look.background = background;
        let p = draw(&s, &bare(40, 30));
        assert!(p.pixels.chunks(3).all(|c| c == want));
        let lettered = draw(&s, &SheetOptions::default());
        assert!(lettered.pixels.chunks(3).any(|c| c != want));
    }
}

#[test]
fn a_coarse_picture_shows_the_same_in_the_same_place() {
    // Sizes that are no multiples of it, too.
    for (width, height, coarse) in [(200, 160, 2), (201, 159, 2), (100, 101, 3)] {
        let s = scene(vec![ball(4.0), part("hair", &[bar(true, 6.0)], 0xff_20_20, 1.5)], &[View::Front]);
        let (fine, coarse) = (bare(width, height), SheetOptions { coarse, ..bare(width, height) });
        let (fine, coarse) = (draw(&s, &fine), draw(&s, &coarse));
        assert_eq!((fine.width, fine.height), (coarse.width, coarse.height));
        let middle = |p: &Picture, is: fn([u8; 3]) -> bool| {
            let all = (0..p.width * p.height).map(|i| (i % p.width, i / p.width)).filter(|&(x, y)| is(at(p, x, y)));
            let (n, x, y) =
                all.fold((0.0, 0.0, 0.0), |(n, a, b), (x, y)| (n + 1.0, a + f64::from(x), b + f64::from(y)));
            (n, x / n, y / n)
        };
        for is in [red as fn([u8; 3]) -> bool, |c: [u8; 3]| c != [255; 3]] {
            let (a, b) = (middle(&fine, is), middle(&coarse, is));
            assert!(
                (a.0 / b.0 - 1.0).abs() < 0.12 && (a.1 - b.1).abs() < 0.5 && (a.2 - b.2).abs() < 0.5,
                "{a:?} {b:?}"
            );
        }
    }
}

#[test]
fn any_number_of_views_fits() {
    let all: Vec<View> = View::TEXTS.iter().filter_map(|t| View::parse(t)).collect();
    for n in 0..=7 {
        for columns in [None, Some(1), Some(3), Some(9)] {
            let s = scene(vec![ball(3.0)], &all[..n]);
            let options = SheetOptions { columns, ..bare(48, 40) };
            let p = draw(&s, &options);
            let shown = n.max(1) as u32;
            assert!(p.width.is_multiple_of(48) && p.height.is_multiple_of(40));
            let cells = p.width / 48 * (p.height / 40);
            assert!(cells >= shown && cells - shown < p.width / 48, "{n} views in {cells} cells");
            // Every view shows the ball in its middle.
            for i in 0..shown {
                let (x, y) = (i % (p.width / 48) * 48 + 24, i / (p.width / 48) * 40 + 16);
                assert_ne!(at(&p, x, y), [255, 255, 255], "view {i} of {n}");
            }
        }
    }
}

#[test]
fn a_dark_head_on_white_is_lit_from_the_upper_left() {
    let p = draw(&scene(vec![ball(5.0)], &[View::Front]), &bare(200, 200));
    let sum = |x, y| at(&p, x, y).iter().map(|&c| u32::from(c)).sum::<u32>();
    assert!(sum(75, 70) > sum(128, 130), "{} {}", sum(75, 70), sum(128, 130));
    assert_eq!(at(&p, 2, 2), [255, 255, 255]);
}

#[test]
fn sizes_out_of_range_are_refused() {
    let s = scene(vec![ball(3.0)], &[View::Front]);
    let bad = [
        SheetOptions { width: 0, ..SheetOptions::default() },
        SheetOptions { height: 100_000, ..SheetOptions::default() },
        SheetOptions { supersample: 9, ..SheetOptions::default() },
        SheetOptions { coarse: 0, ..SheetOptions::default() },
        SheetOptions { columns: Some(0), ..SheetOptions::default() },
    ];
    for options in bad {
        assert!(matches!(sheet(&s, &options, &Task::new()), Err(RenderError::Size { .. })));
    }
    let many = scene(vec![ball(3.0)], &[View::Front; 7]);
    let options = SheetOptions { width: 8192, height: 8192, ..SheetOptions::default() };
    assert!(matches!(sheet(&many, &options, &Task::new()), Err(RenderError::TooLarge { .. })));
}

#[test]
fn a_cancelled_task_stops() {
    let task = Task::new();
    task.cancel();
    let s = scene(vec![ball(3.0), part("hair", &[bar(true, 0.0)], 0, 0.1)], &[View::Front]);
    assert!(matches!(sheet(&s, &SheetOptions::default(), &task), Err(RenderError::Cancelled(_))));
}

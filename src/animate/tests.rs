//! The laws of MeshIK.

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

use super::*;
use crate::geometry::Mesh;
use crate::task::Task;

/// A closed tube along +Y, `length` cm long, with pointed ends: `rings` rings of `sides` between two apexes, every position
/// repeated where a seam in uv would repeat it.
fn bar(length: f64, radius: f64, rings: usize, sides: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let columns = sides + 1;
    for r in 0..rings {
        for s in 0..columns {
            let angle = std::f64::consts::TAU * (s % sides) as f64 / sides as f64;
            let y = length * (r as f64 + 0.5) / rings as f64;
            let p = DVec3::new(radius * libm::cos(angle), y, -radius * libm::sin(angle));
            mesh.positions.push(p.as_vec3());
        }
    }
    let apex = mesh.positions.len() as u32;
    for s in 0..2 * sides {
        let y = if s < sides { 0.0 } else { length };
        mesh.positions.push(DVec3::new(0.0, y, 0.0).as_vec3());
    }
    let at = |r: usize, s: usize| (r * columns + s) as u32;
    for s in 0..sides {
        mesh.triangles.push([apex + s as u32, at(0, s + 1), at(0, s)]);
        for r in 0..rings - 1 {
            mesh.triangles.push([at(r, s), at(r, s + 1), at(r + 1, s)]);
            mesh.triangles.push([at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)]);
        }
        mesh.triangles.push([at(rings - 1, s), at(rings - 1, s + 1), apex + (sides + s) as u32]);
    }
    mesh
}

fn root(mesh: &Mesh) -> Vec<u32> {
    (0..mesh.positions.len() as u32).filter(|&v| mesh.positions[v as usize].y == 0.0).collect()
}

fn tip(mesh: &Mesh) -> u32 {
    mesh.positions.len() as u32 - 1
}

fn map(mesh: &Mesh, f: impl Fn(DVec3) -> DVec3) -> Vec<Vec3> {
    mesh.positions.iter().map(|p| f(p.as_dvec3()).as_vec3()).collect()
}

/// Bends +Y towards +X into an arc that turns by `angle` over `length`; lengths on the axis stay.
fn bend(length: f64, angle: f64) -> impl Fn(DVec3) -> DVec3 {
    move |p| {
        if angle == 0.0 {
            return p;
        }
        let r = length / angle;
        let (sin, cos) = (libm::sin(p.y / r), libm::cos(p.y / r));
        DVec3::new(r - (r - p.x) * cos, (r - p.x) * sin, p.z)
    }
}

fn twist(length: f64, angle: f64) -> impl Fn(DVec3) -> DVec3 {
    move |p| DQuat::from_rotation_y(angle * p.y / length) * p
}

fn greatest(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// A lock with three states: bent aside, bent away and twisted, curled and thickened.
fn states(mesh: &Mesh) -> Vec<Vec<Vec3>> {
    let turned = DQuat::from_rotation_y(1.9);
    vec![
        map(mesh, bend(20.0, 1.2)),
        map(mesh, |p| turned * bend(20.0, 0.9)(twist(20.0, 1.5)(p))),
        map(mesh, |p| bend(20.0, -2.6)(p * DVec3::new(1.3, 0.9, 1.3))),
    ]
}

fn rig(mesh: &Mesh, states: &[Vec<Vec3>]) -> Rig {
    let states: Vec<&[Vec3]> = states.iter().map(Vec::as_slice).collect();
    Rig::new(mesh, &states, &root(mesh), &[tip(mesh)]).unwrap().value
}

fn posed(rig: &Rig, target: Vec3) -> (Vec<Vec3>, Posed) {
    let mut out = vec![Vec3::NAN; rig.rest.len()];
    let found = rig.poser().pose(&[target], &mut out);
    assert!(found.converged, "{found:?}");
    (out, found)
}

#[test]
fn every_state_comes_out_when_the_handle_is_where_it_has_it() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let states = states(&mesh);
    let rig = rig(&mesh, &states);
    for (i, state) in std::iter::once(&mesh.positions).chain(&states).enumerate() {
        let (out, found) = posed(&rig, state[tip(&mesh) as usize]);
        assert!(greatest(&out, state) < 1e-4, "state {i}: {}", greatest(&out, state));
        assert!(found.residual < 1e-6, "state {i}: {}", found.residual);
        for (e, w) in found.weights.iter().enumerate() {
            assert!((w - if e + 1 == i { 1.0 } else { 0.0 }).abs() < 1e-4, "{found:?}");
        }
    }
}

/// Moves states and path alike and wants the result moved alike.
fn moved_alike(by: DAffine3, tolerance: f32) {
    let mesh = bar(20.0, 2.0, 12, 10);
    let states = states(&mesh);
    let still = rig(&mesh, &states);
    let moved_mesh = Mesh { positions: map(&mesh, |p| by.transform_point3(p)), ..mesh.clone() };
    let moved_states: Vec<Vec<Vec3>> =
        states.iter().map(|s| s.iter().map(|p| by.transform_point3(p.as_dvec3()).as_vec3()).collect()).collect();
    let others: Vec<&[Vec3]> = moved_states.iter().map(Vec::as_slice).collect();
    let moved = Rig::new(&moved_mesh, &others, &root(&mesh), &[tip(&mesh)]).unwrap().value;
    let ends = [0, 1, 2, 3].map(|s| still.handle_at(0, s).unwrap());
    let (mut a, mut b) = (still.poser(), moved.poser());
    for k in 0..10 {
        let t = k as f32 / 9.0;
        let target = ends[0].lerp(ends[1], t).lerp(ends[3].lerp(ends[2], t), t);
        let (mut plain, mut other) = (vec![Vec3::ZERO; mesh.positions.len()], vec![Vec3::ZERO; mesh.positions.len()]);
        let p = a.pose(&[target], &mut plain);
        let q = b.pose(&[by.transform_point3(target.as_dvec3()).as_vec3()], &mut other);
        assert!(p.converged && q.converged);
        let wanted: Vec<Vec3> = plain.iter().map(|p| by.transform_point3(p.as_dvec3()).as_vec3()).collect();
        assert!(greatest(&wanted, &other) < tolerance, "frame {k}: {}", greatest(&wanted, &other));
    }
}

#[test]
fn a_rigidly_moved_example_set_gives_a_rigidly_moved_result() {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 2.3);
    moved_alike(DAffine3::from_rotation_translation(turn, DVec3::new(3.0, 8.0, -5.0)), 2e-3);
}

#[test]
fn where_the_style_stands_makes_no_difference() {
    // Powers of two: nothing is rounded on the way there that was not rounded before.
    moved_alike(DAffine3::from_translation(DVec3::new(64.0, -128.0, 32.0)), 2e-3);
}

/// Lengths between the middles of neighbouring rings, and each ring's mean radius.
fn rings(mesh: &Mesh, positions: &[Vec3], sides: usize) -> (f64, Vec<f64>) {
    let count = (mesh.positions.len() - 2 * sides) / (sides + 1);
    let ring = |r: usize| positions[r * (sides + 1)..][..sides].iter().map(|p| p.as_dvec3());
    let middles: Vec<DVec3> = (0..count).map(|r| ring(r).sum::<DVec3>() / sides as f64).collect();
    let radius = |r: usize| ring(r).map(|p| p.distance(middles[r])).sum::<f64>() / sides as f64;
    (middles.windows(2).map(|w| w[0].distance(w[1])).sum(), (0..count).map(radius).collect())
}

/// A bar whose one state is bent by `angle`, with its handle where a bend by half of that has it.
fn halfway(angle: f64) {
    let (length, radius, count, sides) = (20.0, 1.0, 24, 12);
    let mesh = bar(length, radius, count, sides);
    let rig = rig(&mesh, &[map(&mesh, bend(length, angle))]);
    let wanted = map(&mesh, bend(length, 0.5 * angle));
    let (out, found) = posed(&rig, wanted[tip(&mesh) as usize]);
    assert!((found.weights[0] - 0.5).abs() < 0.01, "{found:?}");
    // Halving the rotation vectors is halving the bend; only the stretch of the flanks is blended otherwise.
    assert!(greatest(&out, &wanted) < 0.02 * length as f32, "{}", greatest(&out, &wanted));
    let (straight, thick) = rings(&mesh, &mesh.positions, sides);
    let (along, across) = rings(&mesh, &out, sides);
    assert!((along / straight - 1.0).abs() < 0.01, "{along} of {straight}");
    for (a, b) in across.iter().zip(&thick) {
        assert!((a / b - 1.0).abs() < 0.02, "{a} of {b}");
    }
}

#[test]
fn a_bar_bent_by_a_right_angle_passes_half_of_it_without_shrinking() {
    halfway(std::f64::consts::FRAC_PI_2);
}

#[test]
fn bends_beyond_half_a_turn_are_followed_round() {
    halfway(4.0);
    halfway(-5.5);
}

#[test]
fn a_twist_beyond_half_a_turn_is_wound_up_evenly() {
    let (length, sides) = (20.0, 12);
    let mesh = bar(length, 0.5, 24, sides);
    let wound = |w: f64| map(&mesh, twist(length, 5.0 * w));
    let state = wound(1.0);
    // On its own axis a handle cannot tell a twist: these are on the last ring.
    let handles = [0, 4, 8].map(|s| 23 * 13 + s);
    let rig = Rig::new(&mesh, &[&state], &root(&mesh), &handles).unwrap().value;
    let (straight, thick) = rings(&mesh, &mesh.positions, sides);
    let (mut poser, mut out) = (rig.poser(), vec![Vec3::ZERO; mesh.positions.len()]);
    for k in 0..=40 {
        let w = f64::from(k) / 40.0;
        let wanted = wound(w);
        let found = poser.pose(&handles.map(|v| wanted[v as usize]), &mut out);
        assert!(found.converged && (found.weights[0] - w).abs() < 0.01, "{w}: {found:?}");
        assert!(greatest(&out, &wanted) < 0.1, "{w}: {}", greatest(&out, &wanted));
        let (along, across) = rings(&mesh, &out, sides);
        assert!((along / straight - 1.0).abs() < 0.01, "{along} of {straight}");
        assert!(across.iter().zip(&thick).all(|(a, b)| (a / b - 1.0).abs() < 0.05), "{across:?}");
    }
}

#[test]
fn handles_and_held_vertices_are_met_exactly() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let states = states(&mesh);
    let others: Vec<&[Vec3]> = states.iter().map(Vec::as_slice).collect();
    // Two handles, a vertex in the middle held besides the root; the seam's doubles go along.
    let (middle, held) = (6 * 11 + 3, 2 * 11);
    let mut roots = root(&mesh);
    roots.push(held);
    let rig = Rig::new(&mesh, &others, &roots, &[tip(&mesh), middle]).unwrap().value;
    let targets = [Vec3::new(7.3, 15.1, -2.2), Vec3::new(2.7, 9.9, 0.4)];
    let mut out = vec![Vec3::ZERO; mesh.positions.len()];
    let found = rig.poser().pose(&targets, &mut out);
    assert!(found.converged && found.residual > 0.0);
    assert_eq!((out[tip(&mesh) as usize], out[middle as usize]), (targets[0], targets[1]));
    for &v in &roots {
        assert_eq!(out[v as usize], mesh.positions[v as usize]);
    }
    assert_eq!(out[held as usize + 10], mesh.positions[held as usize]);
    assert_eq!(out[tip(&mesh) as usize - 3], targets[0]);
}

/// The energy of Sumner et al. with its fourth vertices, written out plainly.
struct Plain {
    rest: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
    /// Per state and triangle: rotation vector and stretch.
    states: Vec<Vec<(DVec3, DMat3)>>,
    weight: f64,
}

impl Plain {
    fn spanned(corners: [DVec3; 3]) -> DMat3 {
        let [a, b, c] = corners;
        let n = (b - a).cross(c - a);
        DMat3::from_cols(b - a, c - a, n / n.length().sqrt())
    }

    fn new(rest: &[DVec3], triangles: &[[usize; 3]], poses: &[Vec<DVec3>]) -> Self {
        let corners = |p: &[DVec3], t: &[usize; 3]| t.map(|v| p[v]);
        let change = |pose: &Vec<DVec3>, t: &[usize; 3]| {
            let gradient = Self::spanned(corners(pose, t)) * Self::spanned(corners(rest, t)).inverse();
            let (r, s) = super::rotation::polar(gradient).unwrap();
            (super::rotation::logarithm(r), s)
        };
        Self {
            rest: rest.to_vec(),
            triangles: triangles.to_vec(),
            states: poses.iter().map(|p| triangles.iter().map(|t| change(p, t)).collect()).collect(),
            weight: (1.0 / triangles.len() as f64).sqrt(),
        }
    }

    /// Nine numbers per triangle; `fourth` is the place of each triangle's fourth vertex.
    fn residuals(&self, x: &[DVec3], fourth: &[DVec3], w: &[f64]) -> Vec<f64> {
        let mut out = vec![];
        for (i, t) in self.triangles.iter().enumerate() {
            let [a, b, c] = t.map(|v| x[v]);
            let gradient =
                DMat3::from_cols(b - a, c - a, fourth[i] - a) * Self::spanned(t.map(|v| self.rest[v])).inverse();
            let turn: DVec3 = self.states.iter().zip(w).map(|(s, w)| s[i].0 * *w).sum();
            let mut stretch = DMat3::IDENTITY;
            for (s, w) in self.states.iter().zip(w) {
                stretch += (s[i].1 - DMat3::IDENTITY) * *w;
            }
            let d = gradient - super::rotation::exponential(turn) * stretch;
            out.extend(d.to_cols_array().map(|n| n * self.weight));
        }
        out
    }
}

/// Solves dense least squares by the normal equations and Gauss elimination.
fn least_squares(jacobian: &[Vec<f64>], residual: &[f64]) -> Vec<f64> {
    let n = jacobian.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut m: Vec<Vec<f64>> = jacobian
        .iter()
        .map(|a| jacobian.iter().map(|b| dot(a, b)).chain(std::iter::once(-dot(a, residual))).collect())
        .collect();
    for i in 0..n {
        let pivot = (i..n).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs())).unwrap();
        m.swap(i, pivot);
        for r in i + 1..n {
            let f = m[r][i] / m[i][i];
            let (above, below) = m.split_at_mut(r);
            below[0][i..].iter_mut().zip(&above[i][i..]).for_each(|(to, from)| *to -= f * from);
        }
    }
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        x[i] = (m[i][n] - (i + 1..n).map(|c| m[i][c] * x[c]).sum::<f64>()) / m[i][i];
    }
    x
}

#[test]
fn it_finds_what_a_dense_search_with_fourth_vertices_finds() {
    let (rings, sides) = (4, 4);
    let mesh = bar(6.0, 1.0, rings, sides);
    let poses = [map(&mesh, bend(6.0, 1.1)), map(&mesh, twist(6.0, 1.3)), map(&mesh, |p| bend(6.0, -0.7)(p * 1.2))];
    let rig = rig(&mesh, &poses);
    // Welded by hand: rings without their repeated vertex, two apexes.
    let columns = sides + 1;
    let welded: Vec<usize> = (0..mesh.positions.len())
        .map(|v| match v.checked_sub(rings * columns) {
            None => v / columns * sides + v % columns % sides,
            Some(k) => rings * sides + k / sides,
        })
        .collect();
    let count = rings * sides + 2;
    let unique = |p: &[Vec3]| {
        let mut out = vec![DVec3::ZERO; count];
        welded.iter().zip(p).for_each(|(&w, p)| out[w] = p.as_dvec3());
        out
    };
    let triangles: Vec<[usize; 3]> = mesh.triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
    let plain = Plain::new(&unique(&mesh.positions), &triangles, &poses.each_ref().map(|p| unique(p)));
    let (bottom, top) = (count - 2, count - 1);

    for target in [Vec3::new(2.0, 4.6, 0.9), Vec3::new(-1.5, 6.2, -0.4)] {
        // The plain energy says nothing about weights.
        let mut poser = rig.poser();
        poser.blending = 0.0;
        let mut out = vec![Vec3::NAN; mesh.positions.len()];
        let found = poser.pose(&[target], &mut out);
        assert!(found.converged);
        // Gauss-Newton over every free vertex, every fourth vertex and the weights, with slopes by differences.
        let free: Vec<usize> = (0..count).filter(|&v| v != bottom && v != top).collect();
        let mut x = plain.rest.clone();
        x[top] = target.as_dvec3();
        let mut fourth: Vec<DVec3> =
            triangles.iter().map(|t| plain.rest[t[0]] + Plain::spanned(t.map(|v| plain.rest[v])).z_axis).collect();
        let mut w = vec![0.0; 3];
        let unknowns = 3 * free.len() + 3 * fourth.len() + 3;
        for _ in 0..40 {
            let base = plain.residuals(&x, &fourth, &w);
            let mut jacobian = Vec::with_capacity(unknowns);
            for k in 0..unknowns {
                let (mut x2, mut f2, mut w2) = (x.clone(), fourth.clone(), w.clone());
                let (i, c) = (k / 3, k % 3);
                match i.checked_sub(free.len()) {
                    None => x2[free[i]][c] += 1e-6,
                    Some(j) if j < f2.len() => f2[j][c] += 1e-6,
                    Some(_) => w2[c] += 1e-6,
                }
                let there = plain.residuals(&x2, &f2, &w2);
                jacobian.push(there.iter().zip(&base).map(|(a, b)| (a - b) / 1e-6).collect::<Vec<f64>>());
            }
            let step = least_squares(&jacobian, &base);
            for (k, d) in step.iter().enumerate() {
                let (i, c) = (k / 3, k % 3);
                match i.checked_sub(free.len()) {
                    None => x[free[i]][c] += d,
                    Some(j) if j < fourth.len() => fourth[j][c] += d,
                    Some(_) => w[c] += d,
                }
            }
        }
        let off = welded.iter().zip(&out).map(|(&v, p)| p.as_dvec3().distance(x[v])).fold(0.0, f64::max);
        assert!(off < 1e-3, "{off}; weights {w:?} and {:?}", found.weights);
        let energy: f64 = plain.residuals(&x, &fourth, &w).iter().map(|r| r * r).sum();
        assert!((energy.sqrt() - found.residual).abs() < 1e-4, "{} {}", energy.sqrt(), found.residual);
    }
}

#[test]
fn states_that_are_alike_or_the_rest_again_do_no_harm() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let bent = map(&mesh, bend(20.0, 1.2));
    let rig = rig(&mesh, &[bent.clone(), mesh.positions.clone(), bent.clone()]);
    let (out, found) = posed(&rig, bent[tip(&mesh) as usize]);
    assert!(greatest(&out, &bent) < 1e-3, "{found:?}");
    assert!((found.weights[0] + found.weights[2] - 1.0).abs() < 1e-3);
}

/// From one state's handle to the next one's and back.
fn path(rig: &Rig, frames: usize) -> Vec<Vec3> {
    let (a, b, c) = (rig.handle_at(0, 1).unwrap(), rig.handle_at(0, 0).unwrap(), rig.handle_at(0, 2).unwrap());
    (0..frames).map(|f| f as f32 / frames as f32).map(|t| a.lerp(b, t).lerp(b.lerp(c, t), t)).collect()
}

#[test]
fn frames_follow_each_other_and_start_where_the_last_one_ended() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let rig = rig(&mesh, &states(&mesh));
    let path = path(&rig, 40);
    let made = animate(&rig, std::slice::from_ref(&path), 24.0, false, &Task::new()).unwrap();
    assert_eq!((made.value.clip.count(), made.value.posed.len(), made.warnings.len()), (40, 40, 0));
    let speed = path.windows(2).map(|w| w[0].distance(w[1])).fold(0.0, f32::max);
    for (i, pair) in made.value.clip.frames.windows(2).enumerate() {
        assert!(greatest(&pair[0], &pair[1]) < 3.0 * speed, "frame {}: {}", i + 2, greatest(&pair[0], &pair[1]));
        assert_eq!(pair[1][tip(&mesh) as usize], path[i + 1]);
    }
    // Going on from the frame before finds what a search from every state finds.
    for f in [7, 20, 33] {
        let (alone, _) = posed(&rig, path[f]);
        assert!(greatest(&alone, &made.value.clip.frames[f]) < 5e-3, "frame {}", f + 1);
    }
    let most = made.value.posed[2..].iter().map(|p| p.iterations).max().unwrap();
    assert!(most <= 12, "{most}");
}

#[test]
fn a_loop_ends_as_it_began() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let rig = rig(&mesh, &states(&mesh));
    let mut there = path(&rig, 20);
    there.extend(there.clone().iter().rev());
    let made = animate(&rig, &[there], 24.0, true, &Task::new()).unwrap();
    assert!(made.value.clip.looped && made.warnings.is_empty(), "{:?}", made.warnings);
    let frames = &made.value.clip.frames;
    assert!(greatest(&frames[0], &frames[39]) < 1e-2);
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let mesh = bar(20.0, 2.0, 8, 10);
    let rigs: Vec<_> = (0..5)
        .map(|i| {
            let rig = rig(&mesh, &states(&mesh));
            let by = Vec3::X * 0.1 * i as f32;
            let path = path(&rig, 12).iter().map(|&p| p + by).collect::<Vec<_>>();
            (rig, vec![path])
        })
        .collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let all = pool.install(|| animate_all(&rigs, 24.0, false, &Task::new())).unwrap();
        all.into_iter().flat_map(|a| a.value.clip.frames).flat_map(|f| f.to_vec()).collect::<Vec<Vec3>>()
    };
    assert_eq!(run(1), run(4));
}

#[test]
fn a_handle_beyond_the_states_is_told() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let rig = rig(&mesh, &[map(&mesh, bend(20.0, 0.4))]);
    let far = map(&mesh, bend(20.0, 2.4))[tip(&mesh) as usize];
    let rest = rig.handle_at(0, 0).unwrap();
    let made = animate(&rig, &[vec![rest, far]], 24.0, false, &Task::new()).unwrap();
    let said = &made.warnings[0].message;
    assert!(
        said.starts_with("the handle goes further than the states show: frame 2, a state weighs up to `"),
        "{said}"
    );
}

#[test]
fn a_frame_that_does_not_come_to_rest_is_an_error() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let rig = rig(&mesh, &states(&mesh));
    let mut poser = rig.poser();
    poser.most_iterations = 1;
    let mut out = vec![Vec3::ZERO; mesh.positions.len()];
    let found = poser.pose(&[Vec3::new(5.0, 14.0, 3.0)], &mut out);
    assert!(!found.converged && found.step > 1e-3, "{found:?}");
    let error = AnimateError::NotConverged { frame: 3, iterations: found.iterations, step: 0.25 };
    assert!(error.to_string().contains("frame 3") && error.hint().is_some());
}

#[test]
fn a_cancelled_task_stops_between_frames() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let rig = rig(&mesh, &states(&mesh));
    let task = Task::new();
    task.cancel();
    assert!(matches!(animate(&rig, &[path(&rig, 40)], 24.0, true, &task), Err(AnimateError::Cancelled(_))));
}

#[test]
fn what_does_not_fit_is_named() {
    let mesh = bar(20.0, 2.0, 6, 5);
    let state = map(&mesh, bend(20.0, 1.0));
    let (roots, tip) = (root(&mesh), tip(&mesh));
    let error = |states: &[&[Vec3]], held: &[u32], handles: &[u32]| Rig::new(&mesh, states, held, handles).unwrap_err();

    assert_eq!(error(&[], &roots, &[tip]), AnimateError::NoStates);
    assert_eq!(error(&[&state[..]; 11], &roots, &[tip]), AnimateError::TooManyStates { count: 11, limit: 10 });
    let (count, rest) = (state.len() - 1, state.len());
    assert_eq!(error(&[&state[1..]], &roots, &[tip]), AnimateError::VertexCount { state: 2, count, rest });
    let mut holed = state.clone();
    holed[4].y = f32::NAN;
    assert!(matches!(error(&[&state, &holed], &roots, &[tip]), AnimateError::NotFinite { state: 3, vertex: 5, .. }));
    // Contradictions
    assert!(matches!(
        error(&[&state], &roots, &[tip, 7, tip]),
        AnimateError::RepeatedHandle { first: 1, second: 3, .. }
    ));
    // A double of the tip in the seam is the tip.
    assert!(matches!(
        error(&[&state], &roots, &[tip, tip - 2]),
        AnimateError::RepeatedHandle { first: 1, second: 2, .. }
    ));
    assert!(matches!(error(&[&state], &roots, &[tip, roots[0]]), AnimateError::HeldHandle { handle: 2, .. }));
    assert!(matches!(
        error(&[&state], &roots, &[9999]),
        AnimateError::NoVertex { what: "handle vertex", vertex: 10_000, .. }
    ));
    // Nothing fixed; one of two pieces not fixed
    assert!(matches!(error(&[&state], &[], &[]), AnimateError::Loose { .. }));
    let mut two = mesh.clone();
    two.positions.extend(mesh.positions.iter().map(|p| *p + 9.0 * Vec3::X));
    two.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + rest as u32)));
    let other: Vec<Vec3> = state.iter().copied().chain(state.iter().map(|p| *p + 9.0 * Vec3::X)).collect();
    let loose = Rig::new(&two, &[&other], &roots, &[tip]).unwrap_err();
    assert!(matches!(loose, AnimateError::Loose { count, vertex, .. } if count == rest && vertex > rest), "{loose}");
    // Triangles without area, at rest and in a state
    let mut flat = mesh.clone();
    flat.positions[7] = 0.5 * (flat.positions[6] + flat.positions[8]);
    flat.triangles.push([6, 7, 8]);
    let triangle = flat.triangles.len();
    let found = Rig::new(&flat, &[&state], &roots, &[tip]).unwrap_err();
    assert!(matches!(found, AnimateError::Degenerate { state: 1, triangle: t, .. } if t == triangle), "{found}");
    let collapsed = vec![Vec3::X; rest];
    assert!(matches!(error(&[&collapsed], &roots, &[tip]), AnimateError::Degenerate { state: 2, triangle: 1, .. }));
    // Paths
    let rig = Rig::new(&mesh, &[&state], &roots, &[tip, 7]).unwrap().value;
    let at = Vec3::Y * 20.0;
    let animated = |paths: &[Vec<Vec3>]| animate(&rig, paths, 24.0, false, &Task::new()).unwrap_err();
    assert_eq!(animated(&[vec![at]]), AnimateError::PathCount { paths: 1, handles: 2 });
    assert_eq!(animated(&[vec![], vec![]]), AnimateError::NoFrames);
    assert_eq!(animated(&[vec![at; 2], vec![at]]), AnimateError::PathFrames { handle: 2, count: 1, first: 2 });
    assert!(matches!(animated(&[vec![at, at], vec![at, Vec3::NAN]]), AnimateError::Target { handle: 2, frame: 2, .. }));
}

#[test]
fn a_state_that_moves_the_root_or_tears_around_is_warned_of() {
    let mesh = bar(20.0, 2.0, 12, 10);
    let shifted = map(&mesh, |p| bend(20.0, 1.0)(p) + DVec3::X);
    let made = Rig::new(&mesh, &[&shifted], &root(&mesh), &[tip(&mesh)]).unwrap();
    assert!(made.warnings[0].message.contains("held vertices up to `1.00` cm"), "{:?}", made.warnings);
    // So wild a twist that the surface crumples from ring to ring.
    let wild = map(&mesh, twist(20.0, 1.9 * 12.0));
    let made = Rig::new(&mesh, &[&wild], &root(&mesh), &[tip(&mesh)]).unwrap();
    assert!(made.warnings[0].message.contains("by more than half a turn across"), "{:?}", made.warnings);
}

#[test]
fn a_path_that_is_too_short_for_the_lock_does_not_run_away_into_the_weights() {
    // Two opposite bends nearly cancel each other, and what is left of great weights shortens the lock.
    let mesh = bar(28.0, 2.0, 12, 10);
    let rig = rig(&mesh, &[map(&mesh, bend(28.0, 0.9)), map(&mesh, bend(28.0, -2.4))]);
    let path = path(&rig, 20);
    let end = rig.handle_at(0, 2).unwrap();
    let there = [path, vec![end]].concat();
    let made = animate(&rig, &[there], 24.0, false, &Task::new()).unwrap();
    assert!(made.warnings.is_empty(), "{:?}", made.warnings);
    let most = made.value.posed.iter().flat_map(|p| &p.weights).fold(0.0_f64, |m, w| m.max(w.abs()));
    assert!(most < 2.0, "{most}");
    // It ends in the state that has the handle there.
    let last = made.value.posed.last().unwrap();
    assert!(last.residual < 1e-4 && (last.weights[1] - 1.0).abs() < 1e-3, "{last:?}");
}

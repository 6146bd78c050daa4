//! A mesh with its states, held vertices and handles: all that stays the same from frame to frame, the factored system
//! included.

use glam::{DVec3, Vec3};

use super::AnimateError;
use super::cholesky::{Factor, Lower};
use super::feature::Features;
use super::order::minimum_degree;
use super::pose::Poser;
use super::shape::{NOWHERE, Shape};
use crate::geometry::Mesh;
use crate::task::{Warned, Warning};

/// Held vertices that lie further from the rest in a state than this share of the mesh's size are worth a warning.
const HELD_OFF: f64 = 1e-3;

/// What fixes a place from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fixed {
    /// It stays where it is at rest.
    Held,
    /// It goes where the handle of that index is.
    Handle(usize),
}

/// A mesh of one topology in several states, with held vertices and handles, ready to be posed.
///
/// Rows of the system are welded places: first the free ones in the order of elimination, then the fixed ones.
#[derive(Debug)]
pub struct Rig {
    /// Per vertex of the mesh: its row, or nothing when no triangle uses it.
    pub(super) row: Vec<Option<u32>>,
    /// The rest's positions, per vertex.
    pub(super) rest: Vec<Vec3>,
    /// What rows are measured from, so that a style far from the origin loses no digits.
    pub(super) centre: DVec3,
    /// The rest's places by row, from the centre.
    pub(super) places: Vec<DVec3>,
    /// What fixes the rows after the free ones.
    pub(super) fixed: Vec<Fixed>,
    /// Where the handles are in each state, the rest first.
    handles: Vec<Vec<Vec3>>,
    pub(super) features: Features,
    pub(super) states: usize,
    pub(super) factor: Factor,
    /// Entries of `G^T G` in fixed rows: the fixed row's number, any row, the value.
    pub(super) coupling: Vec<(u32, u32, f64)>,
    /// Diagonal of the mesh's bounds, cm.
    pub(super) size: f64,
}

impl Rig {
    /// A rig of `rest` and at least one other state, given as its vertices. `held` and `handles` are vertices (from 0);
    /// vertices at the same place as a held one, or a handle, in every state are the same vertex.
    ///
    /// # Errors
    /// States that do not fit, triangles without area, vertices that are fixed twice or that nothing fixes.
    pub fn new(rest: &Mesh, states: &[&[Vec3]], held: &[u32], handles: &[u32]) -> Result<Warned<Self>, AnimateError> {
        let shape = Shape::new(rest, states)?;
        let mut warnings = Vec::new();
        let fixed = fixed(&shape, held, handles)?;
        tied(&shape, rest, &fixed)?;
        let places = shape.places(&rest.positions);
        let flat = shape.flat(&places)?;
        let bounds = rest.bounds();
        let size = f64::from(bounds.max.distance(bounds.min));
        // What the states do
        let anchored: Vec<bool> = fixed.iter().map(|f| *f == Some(Fixed::Held)).collect();
        let mut changes = Vec::with_capacity(states.len());
        for (i, state) in states.iter().enumerate() {
            let posed = shape.places(state);
            let (change, jumps) = shape.changes(i + 1, &places, &posed, &flat, &anchored)?;
            changes.push(change);
            if jumps > 0 {
                let message = format!("state {} turns by more than half a turn across {jumps} edges", i + 2);
                let hint = "it is blended by the shorter way there: pose a state between, or use more rings and sides";
                warnings.push(Warning::new(message).hint(hint));
            }
            let off = |p: &usize| anchored[*p].then(|| places[*p].distance(posed[*p]));
            let worst = (0..places.len()).filter_map(|p| off(&p)).fold(0.0, f64::max);
            if worst > HELD_OFF * size {
                let message =
                    format!("state {} has held vertices up to `{worst:.2}` cm from where the rest has them", i + 2);
                let hint =
                    "held vertices stay as in the rest, so that state is not met exactly; pose it with the same root";
                warnings.push(Warning::new(message).hint(hint));
            }
        }
        // The system
        let laplacian = Laplacian::new(&shape, &flat);
        let free: Vec<u32> = (0..places.len() as u32).filter(|&p| fixed[p as usize].is_none()).collect();
        let rows = Rows::new(&laplacian, &free, &fixed);
        let factor = Factor::new(&rows.lower).map_err(|e| {
            let vertex = shape.first[rows.order[e.row] as usize] as usize;
            AnimateError::Uneven { vertex: vertex + 1, position: rest.positions[vertex] }
        })?;
        let triangles: Vec<_> = shape
            .triangles
            .iter()
            .zip(&flat)
            .map(|(corners, flat)| (corners.map(|p| rows.row[p as usize]), *flat))
            .collect();
        let centre = places.iter().sum::<DVec3>() / places.len() as f64;
        let poses = std::iter::once(&rest.positions[..]).chain(states.iter().copied());
        let rig = Self {
            row: shape.spot.iter().map(|&p| (p != NOWHERE).then(|| rows.row[p as usize])).collect(),
            rest: rest.positions.clone(),
            centre,
            places: rows.order.iter().map(|&p| places[p as usize] - centre).collect(),
            fixed: rows.order[free.len()..].iter().filter_map(|&p| fixed[p as usize]).collect(),
            handles: poses.map(|p| handles.iter().map(|&v| p[v as usize]).collect()).collect(),
            features: Features::new(&triangles, &changes),
            states: states.len(),
            coupling: rows.coupling,
            factor,
            size,
        };
        Ok(Warned { value: rig, warnings })
    }

    /// How many handles there are.
    pub fn handles(&self) -> usize {
        self.handles[0].len()
    }

    /// How many states there are, the rest included.
    pub fn states(&self) -> usize {
        self.states + 1
    }

    /// Where handle `handle` is in a state; 0 is the rest. `None` when there is no such state or handle.
    pub fn handle_at(&self, handle: usize, state: usize) -> Option<Vec3> {
        self.handles.get(state)?.get(handle).copied()
    }

    /// Unknown places of the system.
    pub fn unknowns(&self) -> usize {
        self.factor.size()
    }

    /// Numbers in the factor of the system.
    pub fn factor_entries(&self) -> usize {
        self.factor.entries()
    }

    /// What poses it, frame after frame.
    pub fn poser(&self) -> Poser<'_> {
        Poser::new(self)
    }

    /// One bare solve of the factored system for three coordinates, in place: the least work that a frame could be.
    /// For measuring. `x` has one entry per unknown.
    pub fn bare_solve(&self, x: &mut [[f64; 12]]) {
        self.factor.solve(x, 3);
    }
}

/// What fixes each place.
fn fixed(shape: &Shape, held: &[u32], handles: &[u32]) -> Result<Vec<Option<Fixed>>, AnimateError> {
    let mut fixed = vec![None; shape.first.len()];
    let count = shape.spot.len();
    let place = |what: &'static str, v: u32| {
        let place = shape.spot.get(v as usize).copied().filter(|&p| p != NOWHERE);
        place.map(|p| p as usize).ok_or(AnimateError::NoVertex { what, vertex: v as usize + 1, count })
    };
    for &v in held {
        fixed[place("held vertex", v)?] = Some(Fixed::Held);
    }
    for (i, &v) in handles.iter().enumerate() {
        let vertex = v as usize + 1;
        match fixed[place("handle vertex", v)?].replace(Fixed::Handle(i)) {
            Some(Fixed::Held) => return Err(AnimateError::HeldHandle { vertex, handle: i + 1 }),
            Some(Fixed::Handle(first)) => {
                return Err(AnimateError::RepeatedHandle { first: first + 1, second: i + 1, vertex });
            }
            None => {}
        }
    }
    Ok(fixed)
}

/// Every piece has something that fixes it.
fn tied(shape: &Shape, rest: &Mesh, fixed: &[Option<Fixed>]) -> Result<(), AnimateError> {
    let pieces = shape.pieces();
    let mut tied = vec![false; pieces.len()];
    for (piece, fixed) in pieces.iter().zip(fixed) {
        tied[*piece as usize] |= fixed.is_some();
    }
    match pieces.iter().find(|&&p| !tied[p as usize]) {
        Some(&piece) => {
            let count = shape.spot.iter().filter(|&&s| s != NOWHERE && pieces[s as usize] == piece).count();
            let vertex = shape.first[piece as usize] as usize;
            Err(AnimateError::Loose { count, vertex: vertex + 1, position: rest.positions[vertex] })
        }
        None => Ok(()),
    }
}

/// `G^T G` over all places: per place its neighbours and itself, ascending.
struct Laplacian(Vec<Vec<(u32, f64)>>);

impl Laplacian {
    /// Of triangles that count alike: a cotangent Laplacian, each triangle over its area and their number.
    fn new(shape: &Shape, flat: &[super::feature::Flat]) -> Self {
        let share = 1.0 / flat.len() as f64;
        let mut rows: Vec<Vec<(u32, f64)>> = vec![vec![]; shape.first.len()];
        for (corners, flat) in shape.triangles.iter().zip(flat) {
            // The gradients of the three hat functions.
            let (double_area, [b, c]) = (flat.double_area(), flat.corners);
            let gb = glam::DVec2::new(c.y, -c.x) / double_area;
            let gc = glam::DVec2::new(-b.y, b.x) / double_area;
            let gradients = [-gb - gc, gb, gc];
            for (&i, gi) in corners.iter().zip(&gradients) {
                for (&j, gj) in corners.iter().zip(&gradients) {
                    rows[i as usize].push((j, gi.dot(*gj) * share));
                }
            }
        }
        for row in &mut rows {
            // Stable: equal places keep the order of the triangles, so sums are the same everywhere.
            row.sort_by_key(|&(j, _)| j);
            row.dedup_by(|next, kept| {
                let same = next.0 == kept.0;
                if same {
                    kept.1 += next.1;
                }
                same
            });
        }
        Self(rows)
    }
}

/// The places in rows.
struct Rows {
    /// Per row: its place.
    order: Vec<u32>,
    /// Per place: its row.
    row: Vec<u32>,
    lower: Lower,
    coupling: Vec<(u32, u32, f64)>,
}

impl Rows {
    fn new(laplacian: &Laplacian, free: &[u32], fixed: &[Option<Fixed>]) -> Self {
        let mut number = vec![NOWHERE; fixed.len()];
        free.iter().enumerate().for_each(|(i, &p)| number[p as usize] = i as u32);
        let neighbours: Vec<Vec<u32>> = free
            .iter()
            .map(|&p| {
                let others = laplacian.0[p as usize].iter().filter(|&&(j, _)| j != p);
                others.map(|&(j, _)| number[j as usize]).filter(|&n| n != NOWHERE).collect()
            })
            .collect();
        let mut order: Vec<u32> = minimum_degree(&neighbours).iter().map(|&i| free[i as usize]).collect();
        order.extend((0..fixed.len() as u32).filter(|&p| fixed[p as usize].is_some()));
        let mut row = vec![0; order.len()];
        order.iter().enumerate().for_each(|(r, &p)| row[p as usize] = r as u32);
        let lower = |r: usize| {
            let all = laplacian.0[order[r] as usize].iter().map(|&(j, a)| (row[j as usize], a));
            let mut below: Vec<(u32, f64)> = all.filter(|&(j, _)| j as usize <= r).collect();
            below.sort_by_key(|&(j, _)| j);
            below
        };
        let lower = Lower { rows: (0..free.len()).map(lower).collect() };
        let coupling = (free.len()..order.len())
            .flat_map(|r| laplacian.0[order[r] as usize].iter().map(move |&(j, a)| (r, j, a)))
            .map(|(r, j, a)| ((r - free.len()) as u32, row[j as usize], a))
            .collect();
        Self { order, row, lower, coupling }
    }
}

//! The states as one welded surface, and what each of them does to every triangle of it.

use std::collections::VecDeque;

use glam::{DMat3, DVec3, Vec3};

use super::AnimateError;
use super::feature::{Change, Flat, MOST_STATES, has_area};
use super::rotation::{branch, logarithm, polar};
use crate::geometry::Mesh;

/// Of a vertex that no triangle uses.
pub(super) const NOWHERE: u32 = u32::MAX;

/// A welded surface in several states; state 0 is the rest.
#[derive(Debug)]
pub(super) struct Shape {
    /// Per vertex of the mesh: its place, or [`NOWHERE`].
    pub(super) spot: Vec<u32>,
    /// Per place: the first vertex there.
    pub(super) first: Vec<u32>,
    /// Triangles of three different places.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Per triangle: its index in the mesh.
    numbers: Vec<u32>,
}

impl Shape {
    /// Welds vertices that lie at one place in every state, and leaves out the triangles that this makes vanish.
    ///
    /// # Errors
    /// A bad mesh; states that do not fit it or are not finite.
    pub(super) fn new(rest: &Mesh, states: &[&[Vec3]]) -> Result<Self, AnimateError> {
        rest.validate()?;
        match states.len() {
            0 => return Err(AnimateError::NoStates),
            count if count > MOST_STATES => return Err(AnimateError::TooManyStates { count, limit: MOST_STATES }),
            _ => {}
        }
        let count = rest.positions.len();
        for (i, state) in states.iter().enumerate() {
            if state.len() != count {
                return Err(AnimateError::VertexCount { state: i + 2, count: state.len(), rest: count });
            }
            if let Some(v) = state.iter().position(|p| !p.is_finite()) {
                return Err(AnimateError::NotFinite { state: i + 2, vertex: v + 1, position: state[v] });
            }
        }
        let poses: Vec<&[Vec3]> = std::iter::once(&rest.positions[..]).chain(states.iter().copied()).collect();
        // `+ ZERO` makes -0 and 0 one place.
        let bits = |v: u32| poses.iter().flat_map(move |p| (p[v as usize] + Vec3::ZERO).to_array().map(f32::to_bits));
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.sort_by(|&a, &b| bits(a).cmp(bits(b)).then(a.cmp(&b)));
        let mut leader: Vec<u32> = (0..count as u32).collect();
        for pair in order.windows(2) {
            if bits(pair[0]).eq(bits(pair[1])) {
                leader[pair[1] as usize] = leader[pair[0] as usize];
            }
        }
        let mut shape = Self { spot: vec![NOWHERE; count], first: vec![], triangles: vec![], numbers: vec![] };
        let mut place = |v: u32| {
            let lead = leader[v as usize] as usize;
            if shape.spot[lead] == NOWHERE {
                shape.spot[lead] = shape.first.len() as u32;
                shape.first.push(lead as u32);
            }
            shape.spot[lead]
        };
        for (i, corners) in rest.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| leader[v as usize]);
            if a != b && b != c && c != a {
                shape.triangles.push([a, b, c].map(&mut place));
                shape.numbers.push(i as u32);
            }
        }
        shape.spot = leader.iter().map(|&lead| shape.spot[lead as usize]).collect();
        if shape.triangles.is_empty() {
            let position = rest.positions[rest.triangles[0][0] as usize];
            return Err(AnimateError::Degenerate { state: 1, triangle: 1, position });
        }
        Ok(shape)
    }

    /// The places in a state.
    pub(super) fn places(&self, positions: &[Vec3]) -> Vec<DVec3> {
        self.first.iter().map(|&v| positions[v as usize].as_dvec3()).collect()
    }

    /// The flat triangles of the rest.
    ///
    /// # Errors
    /// One without area.
    pub(super) fn flat(&self, rest: &[DVec3]) -> Result<Vec<Flat>, AnimateError> {
        let one = |(t, corners): (usize, &[u32; 3])| {
            let corners = corners.map(|v| rest[v as usize]);
            Flat::new(corners).ok_or_else(|| self.degenerate(0, t, corners[0]))
        };
        self.triangles.iter().enumerate().map(one).collect()
    }

    fn degenerate(&self, state: usize, triangle: usize, at: DVec3) -> AnimateError {
        let triangle = self.numbers[triangle] as usize + 1;
        AnimateError::Degenerate { state: state + 1, triangle, position: at.as_vec3() }
    }

    /// What state `state` (counted with the rest as 0) does to every triangle, and across how many edges its rotation
    /// jumps by more than half a turn. Rotation vectors are continued from triangle to triangle, breadth first, each
    /// piece from the least turned triangle at the `anchored` places, or of all when there is none.
    ///
    /// # Errors
    /// A triangle without area.
    pub(super) fn changes(
        &self,
        state: usize,
        rest: &[DVec3],
        posed: &[DVec3],
        flat: &[Flat],
        anchored: &[bool],
    ) -> Result<(Vec<Change>, usize), AnimateError> {
        let mut changes = Vec::with_capacity(flat.len());
        for (t, corners) in self.triangles.iter().enumerate() {
            let (from, to) = (corners.map(|v| rest[v as usize]), corners.map(|v| posed[v as usize]));
            let gradient = has_area(to).then(|| spanned(to) * spanned(from).inverse());
            let (r, s) = gradient.and_then(polar).ok_or_else(|| self.degenerate(state, t, to[0]))?;
            let stretch = flat[t].axes.map(|a| s * a - a);
            changes.push(Change { turn: logarithm(r), stretch });
        }
        let neighbours = self.neighbours();
        let anchor = |t: usize| self.triangles[t].iter().any(|&v| anchored[v as usize]);
        let mut seeds: Vec<u32> = (0..changes.len() as u32).collect();
        let angle = |t: u32| changes[t as usize].turn.length_squared();
        seeds.sort_by(|&a, &b| {
            anchor(b as usize).cmp(&anchor(a as usize)).then(angle(a).total_cmp(&angle(b))).then(a.cmp(&b))
        });
        let mut known = vec![false; changes.len()];
        let mut queue = VecDeque::new();
        for seed in seeds {
            if !std::mem::replace(&mut known[seed as usize], true) {
                queue.push_back(seed);
            }
            while let Some(t) = queue.pop_front() {
                for &u in &neighbours[t as usize] {
                    if !std::mem::replace(&mut known[u as usize], true) {
                        changes[u as usize].turn = branch(changes[u as usize].turn, changes[t as usize].turn);
                        queue.push_back(u);
                    }
                }
            }
        }
        let jumps = |(t, next): (usize, &Vec<u32>)| {
            let far = |&&u: &&u32| changes[t].turn.distance(changes[u as usize].turn) > std::f64::consts::PI;
            next.iter().filter(|&&u| u as usize > t).filter(far).count()
        };
        let jumps = neighbours.iter().enumerate().map(jumps).sum();
        Ok((changes, jumps))
    }

    /// Per triangle those that share an edge with it.
    fn neighbours(&self) -> Vec<Vec<u32>> {
        let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (t, &[a, b, c]) in self.triangles.iter().enumerate() {
            edges.extend([[a, b], [b, c], [c, a]].map(|[u, v]| ([u.min(v), u.max(v)], t as u32)));
        }
        edges.sort_unstable();
        let mut neighbours = vec![vec![]; self.triangles.len()];
        for pair in edges.windows(2) {
            if pair[0].0 == pair[1].0 {
                neighbours[pair[0].1 as usize].push(pair[1].1);
                neighbours[pair[1].1 as usize].push(pair[0].1);
            }
        }
        neighbours
    }

    /// Per place the first place of the piece it belongs to: places that triangles join.
    pub(super) fn pieces(&self) -> Vec<u32> {
        let mut parent: Vec<u32> = (0..self.first.len() as u32).collect();
        fn root(parent: &mut [u32], mut v: u32) -> u32 {
            while parent[v as usize] != v {
                parent[v as usize] = parent[parent[v as usize] as usize];
                v = parent[v as usize];
            }
            v
        }
        for &[a, b, c] in &self.triangles {
            for (u, v) in [(a, b), (b, c)] {
                let (u, v) = (root(&mut parent, u), root(&mut parent, v));
                parent[u.max(v) as usize] = u.min(v);
            }
        }
        (0..parent.len() as u32).map(|v| root(&mut parent, v)).collect()
    }
}

/// Two edges and the fourth vertex over the first corner: the normal, as long as the root of its length (Sumner, Popovic
/// 2004).
fn spanned([a, b, c]: [DVec3; 3]) -> DMat3 {
    let normal = (b - a).cross(c - a);
    DMat3::from_cols(b - a, c - a, normal / normal.length().sqrt())
}

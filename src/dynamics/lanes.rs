//! Eight strands side by side: node `k` of all of them lies together in memory, so that a loop over the eight is one
//! vector instruction. Nothing is ever added across the lanes: a strand's numbers do not depend on its neighbours.

use glam::Vec3;

/// The three parts of a vector, each made by itself. A macro, as `map` over an array is a call, which is not always built
/// into the vector code around it.
macro_rules! three {
    ($c:ident => $make:expr) => {
        [
            {
                let $c = 0_usize;
                $make
            },
            {
                let $c = 1_usize;
                $make
            },
            {
                let $c = 2_usize;
                $make
            },
        ]
    };
}

/// The same for what has two parts.
macro_rules! two {
    ($i:ident => $make:expr) => {
        [
            {
                let $i = 0_usize;
                $make
            },
            {
                let $i = 1_usize;
                $make
            },
        ]
    };
}

pub(super) use {three, two};

/// Strands that are worked on together.
pub const LANES: usize = 8;

/// A number of each strand.
pub type Lanes = [f32; LANES];

/// A vector of each strand at every node.
#[derive(Clone, Debug, Default)]
pub struct Plane {
    /// Along the head's left.
    pub x: Vec<Lanes>,
    /// Up.
    pub y: Vec<Lanes>,
    /// To the front.
    pub z: Vec<Lanes>,
}

impl Plane {
    /// Zeros for `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        Self { x: vec![[0.0; LANES]; nodes], y: vec![[0.0; LANES]; nodes], z: vec![[0.0; LANES]; nodes] }
    }

    /// Makes it `nodes` nodes long; what is in it then is of no meaning.
    pub fn resize(&mut self, nodes: usize) {
        for part in [&mut self.x, &mut self.y, &mut self.z] {
            part.resize(nodes, [0.0; LANES]);
        }
    }

    /// The vector of one strand at one node.
    #[inline(always)]
    pub fn get(&self, node: usize, lane: usize) -> Vec3 {
        Vec3::new(self.x[node][lane], self.y[node][lane], self.z[node][lane])
    }

    /// Sets it.
    #[inline(always)]
    pub fn set(&mut self, node: usize, lane: usize, v: Vec3) {
        self.x[node][lane] = v.x;
        self.y[node][lane] = v.y;
        self.z[node][lane] = v.z;
    }

    /// The vectors of all strands at one node.
    #[inline(always)]
    pub fn row(&self, node: usize) -> [Lanes; 3] {
        [self.x[node], self.y[node], self.z[node]]
    }

    /// Sets them.
    #[inline(always)]
    pub fn put(&mut self, node: usize, row: [Lanes; 3]) {
        [self.x[node], self.y[node], self.z[node]] = row;
    }

    /// The same as another.
    #[inline(always)]
    pub fn copy(&mut self, other: &Self) {
        self.x.copy_from_slice(&other.x);
        self.y.copy_from_slice(&other.y);
        self.z.copy_from_slice(&other.z);
    }
}

/// A row made lane by lane.
#[inline(always)]
pub fn each(mut make: impl FnMut(usize) -> f32) -> Lanes {
    let mut out = [0.0; LANES];
    for (l, to) in out.iter_mut().enumerate() {
        *to = make(l);
    }
    out
}

/// `a - b`.
#[inline(always)]
pub fn minus(a: &[Lanes; 3], b: &[Lanes; 3]) -> [Lanes; 3] {
    [each(|l| a[0][l] - b[0][l]), each(|l| a[1][l] - b[1][l]), each(|l| a[2][l] - b[2][l])]
}

/// `a . b`.
#[inline(always)]
pub fn dot(a: &[Lanes; 3], b: &[Lanes; 3]) -> Lanes {
    each(|l| a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l])
}

/// `a x b`.
#[inline(always)]
pub fn cross(a: &[Lanes; 3], b: &[Lanes; 3]) -> [Lanes; 3] {
    [
        each(|l| a[1][l] * b[2][l] - a[2][l] * b[1][l]),
        each(|l| a[2][l] * b[0][l] - a[0][l] * b[2][l]),
        each(|l| a[0][l] * b[1][l] - a[1][l] * b[0][l]),
    ]
}

/// `a` times a number of each strand.
#[inline(always)]
pub fn scaled(a: &[Lanes; 3], s: &Lanes) -> [Lanes; 3] {
    [each(|l| a[0][l] * s[l]), each(|l| a[1][l] * s[l]), each(|l| a[2][l] * s[l])]
}

/// Adds `b` times a number of each strand to `a`.
#[inline(always)]
pub fn add_scaled(a: &mut [Lanes; 3], b: &[Lanes; 3], s: &Lanes) {
    for (a, b) in a.iter_mut().zip(b) {
        for l in 0..LANES {
            a[l] += b[l] * s[l];
        }
    }
}

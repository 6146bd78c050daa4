//! A picture cut into square tiles, and which segments touch which.

use glam::Vec3;

/// A picture cut into square tiles.
#[derive(Clone, Copy, Debug)]
pub struct Tiles {
    /// Edge in pixels.
    pub edge: usize,
    /// Tiles per row.
    pub columns: usize,
    /// Rows of tiles.
    pub rows: usize,
}

impl Tiles {
    /// Tiles of `edge` pixels over a picture.
    pub fn new(width: usize, height: usize, edge: usize) -> Self {
        Self { edge, columns: width.div_ceil(edge), rows: height.div_ceil(edge) }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// Tiles that the box from `lo` to `hi` touches.
    fn touched(self, lo: Vec3, hi: Vec3) -> impl Iterator<Item = usize> {
        let per_pixel = 1.0 / self.edge as f32;
        let range = |lo: f32, hi: f32, n: usize| {
            // Also a NaN gives the empty range.
            let first = if lo > 0.0 { (lo * per_pixel) as usize } else { 0 };
            let end = if hi >= 0.0 { ((hi * per_pixel) as usize + 1).min(n) } else { 0 };
            first..end
        };
        let (xs, ys) = (range(lo.x, hi.x, self.columns), range(lo.y, hi.y, self.rows));
        ys.flat_map(move |y| xs.clone().map(move |x| y * self.columns + x))
    }
}

/// A place on a line in the picture, ready to be drawn. 20 bytes: a tile reads many that it then need not draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Pixels and depth.
    pub at: Vec3,
    /// Width of the line here, pixels.
    pub width: f32,
    /// Square roots of the linear channels, 10 bits each.
    colour: u32,
}

impl Vertex {
    /// With a linear colour; its channels are taken to be within 0..=1.
    pub fn new(at: Vec3, width: f32, colour: Vec3) -> Self {
        let bits = |c: f32| (c.clamp(0.0, 1.0).sqrt() * 1023.0 + 0.5) as i32 as u32;
        Self { at, width, colour: bits(colour.x) << 20 | bits(colour.y) << 10 | bits(colour.z) }
    }

    /// Linear.
    pub fn colour(&self) -> Vec3 {
        let root = |shift: u32| (self.colour >> shift & 1023) as i32 as f32 * (1.0 / 1023.0);
        let c = Vec3::new(root(20), root(10), root(0));
        c * c
    }
}

/// A segment: its ends.
pub type Segment = [Vertex; 2];

/// Where a segment stands in the order from near to far: the greater, the farther.
pub fn behind(segment: &Segment) -> u32 {
    // The bits of a number order like the number itself once those of negative ones are turned round.
    let bits = (0.5 * (segment[0].at.z + segment[1].at.z)).to_bits();
    if bits >> 31 == 1 { bits } else { !(bits | 1 << 31) }
}

/// Segments of a few lines, tile after tile; those that touch several tiles stand in each.
#[derive(Debug)]
pub struct Binned {
    segments: Vec<Segment>,
    /// Where each tile begins in `segments`, and the end.
    starts: Vec<u32>,
    /// True for hair, whose strands lie in each other's shadow.
    pub shaded: bool,
}

impl Binned {
    /// Sorts the segments that begin at the vertices `joined` and end at the next; they reach `margin` pixels beyond.
    pub fn new(tiles: Tiles, vertices: &[Vertex], joined: &[u32], margin: f32, shaded: bool) -> Self {
        let touched = |i: u32| {
            let (a, b) = (vertices[i as usize].at, vertices[i as usize + 1].at);
            tiles.touched(a.min(b) - Vec3::splat(margin), a.max(b) + Vec3::splat(margin))
        };
        let mut starts = vec![0_u32; tiles.count() + 1];
        for &i in joined {
            for tile in touched(i) {
                starts[tile + 1] += 1;
            }
        }
        for tile in 0..tiles.count() {
            starts[tile + 1] += starts[tile];
        }
        let mut next = starts.clone();
        let Some(&any) = vertices.first() else { return Self { segments: vec![], starts, shaded } };
        let mut segments = vec![[any; 2]; starts[tiles.count()] as usize];
        for &i in joined {
            let segment = [vertices[i as usize], vertices[i as usize + 1]];
            for tile in touched(i) {
                segments[next[tile] as usize] = segment;
                next[tile] += 1;
            }
        }
        Self { segments, starts, shaded }
    }

    /// Segments that touch a tile.
    pub fn of(&self, tile: usize) -> &[Segment] {
        &self.segments[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_in_the_order_of_depth() {
        let depths = [f32::INFINITY, 31.5, 2.0, 1.999, 1e-9, 0.0, -1e-9, -0.25, -2.0, -2.001, -1e9, f32::NEG_INFINITY];
        let at = |z: f32| behind(&[Vertex::new(Vec3::new(1.0, 2.0, z), 1.0, Vec3::ONE); 2]);
        assert!(depths.windows(2).all(|w| at(w[0]) < at(w[1])));
    }

    #[test]
    fn colours_come_back() {
        for c in [Vec3::ZERO, Vec3::ONE, Vec3::new(0.5, 0.02, 0.8)] {
            assert!(Vertex::new(Vec3::ZERO, 1.0, c).colour().abs_diff_eq(c, 1.5e-3), "{c}");
        }
        assert_eq!(Vertex::new(Vec3::ZERO, 1.0, Vec3::new(f32::NAN, 7.0, -1.0)).colour(), Vec3::Y);
    }
}

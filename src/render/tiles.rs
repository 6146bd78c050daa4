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

/// Bits of a key for the vertex at which a segment begins.
const VERTEX_BITS: u32 = 32;

/// A segment, and where it stands in the order from near to far: its depth in the upper half, its first vertex in the
/// lower. So a tile knows the order without looking at the vertices, which lie scattered.
pub type Key = u64;

/// A key's place in the order of depth, 32 bits: the greater the farther.
fn behind(z: f32) -> u64 {
    // The bits of a number order like the number itself once those of negative ones are turned round.
    let bits = z.to_bits();
    let ordered = if bits >> 31 == 1 { !bits } else { bits | 1 << 31 };
    u64::from(!ordered)
}

/// The vertex at which a key's segment begins.
pub fn first_vertex(key: Key) -> usize {
    (key & ((1 << VERTEX_BITS) - 1)) as usize
}

/// The segments of a chunk, tile after tile.
#[derive(Debug)]
pub struct Binned {
    keys: Vec<Key>,
    /// Where each tile begins in `keys`, and the end.
    starts: Vec<u32>,
}

impl Binned {
    /// Sorts the segments that begin at the vertices `joined` and end at the next; they reach `margin` pixels beyond.
    pub fn new(tiles: Tiles, at: &[Vec3], joined: &[u32], margin: f32) -> Self {
        let touched = |i: u32| {
            let (a, b) = (at[i as usize], at[i as usize + 1]);
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
        let mut keys = vec![0; starts[tiles.count()] as usize];
        for &i in joined {
            let key = behind(0.5 * (at[i as usize].z + at[i as usize + 1].z)) << VERTEX_BITS | u64::from(i);
            for tile in touched(i) {
                keys[next[tile] as usize] = key;
                next[tile] += 1;
            }
        }
        Self { keys, starts }
    }

    /// Segments that touch a tile.
    pub fn of(&self, tile: usize) -> &[Key] {
        &self.keys[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_in_the_order_of_depth() {
        let depths = [f32::INFINITY, 31.5, 2.0, 1.999, 1e-9, 0.0, -1e-9, -0.25, -2.0, -2.001, -1e9, f32::NEG_INFINITY];
        assert!(depths.windows(2).all(|w| behind(w[0]) < behind(w[1])));
    }
}

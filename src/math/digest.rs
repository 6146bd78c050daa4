//! Keys of content: equal content has equal keys, whatever its age, place in memory or origin.

use std::fmt::{self, Debug, Write};

use glam::{Vec2, Vec3};
use xxhash_rust::xxh3::Xxh3;

/// A key in the making: 128 bits of XXH3 over everything that is fed to it, in order, each piece with its length, so
/// that no two different sequences look alike.
#[derive(Clone, Default)]
pub struct Digest(Xxh3);

/// Bytes that are gathered before they are hashed.
const BLOCK: usize = 6144;

impl Digest {
    /// For one kind of thing: `what` sets it apart from others with the same content.
    pub fn new(what: &str) -> Self {
        let mut digest = Self::default();
        digest.bytes(what.as_bytes());
        digest
    }

    /// The key of all that was fed so far.
    pub fn finish(&self) -> u128 {
        self.0.digest128()
    }

    /// Bytes.
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.number(bytes.len() as u64);
        self.0.update(bytes);
        self
    }

    /// A whole number.
    pub fn number(&mut self, number: u64) -> &mut Self {
        self.0.update(&number.to_le_bytes());
        self
    }

    /// A key made before.
    pub fn key(&mut self, key: u128) -> &mut Self {
        self.0.update(&key.to_le_bytes());
        self
    }

    /// Parameters, as their derived `Debug` writes them. That names every field, and writes numbers so that different
    /// ones differ; for large data there are the others.
    pub fn data(&mut self, value: &impl Debug) -> &mut Self {
        struct Feed<'a>(&'a mut Xxh3, u64);
        impl Write for Feed<'_> {
            fn write_str(&mut self, text: &str) -> fmt::Result {
                self.0.update(text.as_bytes());
                self.1 += text.len() as u64;
                Ok(())
            }
        }
        let mut feed = Feed(&mut self.0, 0);
        // Feeding never fails.
        let _ = write!(feed, "{value:?}");
        let length = feed.1;
        self.number(length)
    }

    /// Floats, by their bits.
    pub fn floats(&mut self, floats: &[f32]) -> &mut Self {
        self.packed(floats, |f| f.to_le_bytes())
    }

    /// Whole numbers.
    pub fn numbers(&mut self, numbers: &[u32]) -> &mut Self {
        self.packed(numbers, |n| n.to_le_bytes())
    }

    /// Flags.
    pub fn flags(&mut self, flags: &[bool]) -> &mut Self {
        self.packed(flags, |&f| [u8::from(f)])
    }

    /// Vectors, by their bits.
    pub fn vectors(&mut self, vectors: &[Vec3]) -> &mut Self {
        const COUNT: usize = BLOCK / 12;
        self.number(vectors.len() as u64);
        // In two steps, each of which the compiler makes a plain copy of: together they would be five times slower.
        let (mut floats, mut bytes) = ([[0.0; 3]; COUNT], [[0; 4]; 3 * COUNT]);
        for some in vectors.chunks(COUNT) {
            floats.iter_mut().zip(some).for_each(|(to, v)| *to = v.to_array());
            bytes.iter_mut().zip(floats.as_flattened()).for_each(|(to, f): (&mut [u8; 4], &f32)| *to = f.to_le_bytes());
            self.0.update(&bytes.as_flattened()[..some.len() * 12]);
        }
        self
    }

    /// Vectors in the plane, by their bits.
    pub fn planar(&mut self, vectors: &[Vec2]) -> &mut Self {
        self.packed(vectors, |v| {
            let (mut out, [x, y]) = ([0; 8], v.to_array().map(f32::to_le_bytes));
            out[..4].copy_from_slice(&x);
            out[4..].copy_from_slice(&y);
            out
        })
    }

    /// Any list of things of `N` bytes each.
    pub fn packed<T, const N: usize>(&mut self, items: &[T], pack: impl Fn(&T) -> [u8; N]) -> &mut Self {
        self.number(items.len() as u64);
        let mut block = [0; BLOCK];
        for some in items.chunks(BLOCK / N) {
            for (to, item) in block.chunks_exact_mut(N).zip(some) {
                to.copy_from_slice(&pack(item));
            }
            self.0.update(&block[..some.len() * N]);
        }
        self
    }
}

impl Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Digest({:032x})", self.finish())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn different_sequences_differ() {
        let of = |feed: &dyn Fn(&mut Digest) -> u128| feed(&mut Digest::new("test"));
        let all = [
            of(&|d| d.finish()),
            of(&|d| d.bytes(b"ab").bytes(b"c").finish()),
            of(&|d| d.bytes(b"a").bytes(b"bc").finish()),
            of(&|d| d.data(&"ab").data(&"c").finish()),
            of(&|d| d.data(&"a").data(&"bc").finish()),
            of(&|d| d.floats(&[0.0]).finish()),
            of(&|d| d.floats(&[-0.0]).finish()),
            of(&|d| d.floats(&[0.0, 0.0]).finish()),
            of(&|d| d.floats(&[0.0]).floats(&[0.0]).finish()),
            of(&|d| d.vectors(&[Vec3::ZERO; 1000]).finish()),
            of(&|d| d.vectors(&[Vec3::ZERO; 1001]).finish()),
            of(&|d| d.data(&0.1_f32).finish()),
            of(&|d| d.data(&(0.1_f32 + f32::EPSILON / 8.0)).finish()),
        ];
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| a != b), "{i}");
        }
        assert_ne!(Digest::new("one").finish(), Digest::new("two").finish());
    }

    #[test]
    fn blocks_do_not_show() {
        let points: Vec<Vec3> = (0..5000).map(|i| Vec3::new(i as f32, 0.5, -1.0)).collect();
        let floats: Vec<f32> = points.iter().flat_map(|p| p.to_array()).collect();
        let mut packed = Digest::default();
        packed.vectors(&points);
        let mut plain = Digest::default();
        plain.number(5000);
        for f in floats {
            plain.0.update(&f.to_le_bytes());
        }
        assert_eq!(packed.finish(), plain.finish());
    }
}

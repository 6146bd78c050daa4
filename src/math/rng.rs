//! Random numbers keyed by what they are for.
//!
//! A [`Key`] is a 64-bit number; [`Key::with`] derives another from it and any number (a strand's id, a node's index,
//! a channel). The same key always gives the same value: there is no hidden state, so results depend neither on the
//! order of calls nor on the number of threads. The mixing function is SplitMix64's finaliser (Steele, Lea, Flood
//! 2014, figure 16).

use glam::Vec3;

use super::trig;

/// A place in the space of random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key(u64);

impl Key {
    /// The key of a whole run: `seed` is what the user gives, `purpose` keeps two uses of one seed apart.
    pub fn new(seed: u64, purpose: &str) -> Self {
        // FNV-1a over the purpose's bytes: a fixed function, unlike the standard hasher.
        let tag = purpose
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3));
        Self(mix(seed ^ mix(tag)))
    }

    /// The key of item `n` below this one.
    #[must_use]
    pub fn with(self, n: u64) -> Self {
        Self(mix(self.0.rotate_left(17) ^ n.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// 64 uniform bits.
    pub fn bits(self) -> u64 {
        mix(self.0)
    }

    /// Uniform in 0..1, 1 excluded.
    pub fn unit(self) -> f32 {
        (self.bits() >> 40) as f32 * (1.0 / (1u64 << 24) as f32)
    }

    /// Uniform in `lo`..`hi`.
    pub fn range(self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.unit()
    }

    /// Normal distribution with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub fn gaussian(self) -> f32 {
        let u = 1.0 - self.with(1).unit();
        let v = self.with(2).unit();
        (-2.0 * trig::ln(u)).sqrt() * trig::cos(std::f32::consts::TAU * v)
    }

    /// Three independent normal numbers.
    pub fn gaussian3(self) -> Vec3 {
        Vec3::new(self.with(11).gaussian(), self.with(12).gaussian(), self.with(13).gaussian())
    }

    /// Uniform on the unit sphere.
    pub fn direction(self) -> Vec3 {
        let z = self.with(1).range(-1.0, 1.0);
        let a = std::f32::consts::TAU * self.with(2).unit();
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * trig::cos(a), r * trig::sin(a), z)
    }
}

/// SplitMix64's finaliser: every input bit moves every output bit.
fn mix(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_values_not_streams() {
        let key = Key::new(7, "roots");
        assert_eq!(key.with(3).unit(), key.with(3).unit());
        assert_ne!(key.with(3).bits(), key.with(4).bits());
        assert_ne!(Key::new(7, "roots").bits(), Key::new(7, "noise").bits());
        assert_ne!(key.with(1).with(2).bits(), key.with(2).with(1).bits());
    }

    #[test]
    fn gaussian_has_the_moments_it_promises() {
        let key = Key::new(1, "moments");
        let n = 20_000;
        let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
        for i in 0..n {
            let x = f64::from(key.with(i).gaussian());
            sum += x;
            squares += x * x;
        }
        let mean = sum / n as f64;
        // Standard error of the mean is 1/sqrt(n) = 0.007; of the variance sqrt(2/n) = 0.01.
        assert!(mean.abs() < 0.03, "mean {mean}");
        let variance = squares / n as f64 - mean * mean;
        assert!((variance - 1.0).abs() < 0.04, "variance {variance}");
    }
}

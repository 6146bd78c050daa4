//! Roots: where strands leave the skin.
//!
//! A head has one progressive order of places per seed ([`BlueNoise`]); a region takes those inside it, in that
//! order. So a lower count is a subset of a higher one, guides are a subset of the members, and a region that grows
//! adds roots between the old ones. Where the density is below 1, a place is taken when a number keyed by its
//! identity is below the density: raising the density only adds.

use rayon::prelude::*;

use super::{Head, Region};
use crate::geometry::Root;
use crate::geometry::sample::{BlueNoise, Sample};
use crate::math::rng::Key;
use crate::task::{Cancelled, Task};

/// Most roots in one call.
pub const MOST_ROOTS: usize = 2_000_000;

/// Most places on a whole head: a region so small or thin that its roots would need more is refused.
const MOST_PLACES: f64 = 8.0e6;

/// What one strand of usual length takes in memory: 50 nodes of 12 bytes and its root.
const BYTES_PER_STRAND: f64 = 700.0;

/// Orders up to this length are kept with the head.
pub(super) const KEPT: usize = 1_500_000;

/// Why there are no roots.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RootsError {
    /// None were asked for.
    #[error("`0` roots were asked for")]
    Zero,
    /// A density that is negative, infinite or NaN.
    #[error("a density of `{density}` roots per cm2")]
    BadDensity {
        /// What was asked for.
        density: f32,
    },
    /// More than [`MOST_ROOTS`].
    #[error("`{count}` roots are more than {MOST_ROOTS}: their strands would take about {gigabytes:.1} GB")]
    TooMany {
        /// What was asked for.
        count: usize,
        /// Memory for as many strands of 50 nodes.
        gigabytes: f64,
    },
    /// Too close together.
    #[error("`{count}` roots on {area:.3} cm2 are {density:.0} per cm2; a head holds {most:.0} per cm2 at most")]
    TooDense {
        /// What was asked for.
        count: usize,
        /// Area of the region, weighted with its density.
        area: f64,
        /// Roots per cm^2.
        density: f64,
        /// The limit.
        most: f64,
    },
    /// The region covers nothing.
    #[error("the region is empty: it covers no part of the head's skin")]
    Empty,
    /// Cancelled from outside.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl RootsError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Zero => Some("ask for at least 1".into()),
            Self::BadDensity { .. } => Some("give a positive number; a real scalp has 100 to 200 per cm2".into()),
            Self::TooMany { .. } => Some("a real head has 100000 to 150000 hairs".into()),
            Self::TooDense { .. } => {
                Some("ask for fewer, or make the region larger; a real scalp has 200 per cm2".into())
            }
            Self::Empty => Some("are the region's points on the head, in head space (cm)?".into()),
            Self::Cancelled(_) => None,
        }
    }
}

/// The first `count` roots of a region, in the head's order for `seed`.
///
/// # Errors
/// Counts that make no sense or cost too much, an empty region, cancelling.
pub fn roots(head: &Head, region: &Region, count: usize, seed: u64, task: &Task) -> Result<Vec<Root>, RootsError> {
    if count == 0 {
        return Err(RootsError::Zero);
    }
    if count > MOST_ROOTS {
        return Err(RootsError::TooMany { count, gigabytes: count as f64 * BYTES_PER_STRAND / 1e9 });
    }
    task.check()?;
    let mut noise = head.take_order(seed);
    let picked = pick(head, region, count, task, &mut noise);
    head.keep_order(seed, noise);
    picked.map(|places| places.par_iter().map(|s| head.root(s)).collect())
}

/// As many roots as give `density` per cm^2 where the region's own density is 1.
///
/// # Errors
/// As [`roots`], and a density that is no positive number.
pub fn roots_by_density(
    head: &Head,
    region: &Region,
    density: f32,
    seed: u64,
    task: &Task,
) -> Result<Vec<Root>, RootsError> {
    if !(density > 0.0 && density.is_finite()) {
        return Err(RootsError::BadDensity { density });
    }
    let area = region.area(head);
    if area <= 0.0 {
        return Err(RootsError::Empty);
    }
    roots(head, region, (area * f64::from(density)).round().max(1.0) as usize, seed, task)
}

fn pick(
    head: &Head,
    region: &Region,
    count: usize,
    task: &Task,
    noise: &mut BlueNoise,
) -> Result<Vec<Sample>, RootsError> {
    let mut places = Vec::with_capacity(count);
    let mut seen = 0;
    let mut is_checked = false;
    loop {
        let fresh = &noise.order()[seen..];
        // In blocks, so that a long kept order is not tested beyond what is needed.
        for block in fresh.chunks(16_384) {
            task.check()?;
            let taken: Vec<bool> = block.par_iter().map(|s| is_taken(head, region, s)).collect();
            let taken = block.iter().zip(taken).filter(|(_, t)| *t).map(|(s, _)| *s);
            places.extend(taken.take(count - places.len()));
            if places.len() == count {
                return Ok(places);
            }
        }
        seen = noise.order().len();
        task.progress("roots", places.len() as f32 / count as f32);
        // Before the work grows, ask whether it can end.
        if !is_checked && seen > 2000 {
            is_checked = true;
            let area = region.area(head);
            if area <= 0.0 {
                return Err(RootsError::Empty);
            }
            let (density, most) = (count as f64 / area, MOST_PLACES / head.area());
            if density > most {
                return Err(RootsError::TooDense { count, area, density, most });
            }
        }
        if seen as f64 > 2.5 * MOST_PLACES {
            return Err(RootsError::Empty);
        }
        noise.grow(task)?;
    }
}

fn is_taken(head: &Head, region: &Region, place: &Sample) -> bool {
    let density = region.density(head, place);
    density >= 1.0 || (density > 0.0 && Key::new(place.id(), "density").unit() < density)
}

//! Guides before they grow: roots and what all of them share.

use std::sync::Arc;

use glam::Vec3;

use super::error::{GroomError, check_point, check_size, check_value};
use super::noise::gaussian3;
use crate::geometry::Root;
use crate::math::rng::Key;
use crate::params::{Direction, Object};

crate::params! {
    /// Guides: the strands that are grown through the domains, each standing for one wisp.
    pub struct GuideOptions("coif.guides") {
        /// How many.
        count: usize = 800, range(1.0, 1e15);
        /// The longest strand's length.
        length: f32 = 25.0, unit("cm"), range(0.05, 1000.0);
        /// How much shorter strands may be, as a part of the length: 0 all alike, 1 down to nothing.
        length_variation: f32 = 0.1, range(0.0, 1.0);
        /// Length of a growth step.
        step: f32 = 0.5, unit("cm"), range(0.01, 100.0);
        /// Resistance to bending: weight of the last tangent against the force.
        stiffness: f32 = 3.0, range(0.0, 10_000.0);
        /// Greatest number of growth steps; as many as the length needs when left out.
        limit: Option<usize>, range(1.0, 1_000_000.0);
        /// Where to strands lie from the first, along the skin.
        lay: Option<Direction>;
        /// Strands lie away from this point from the first: a whorl. With `lay` both act.
        lay_from: Option<Vec3>, unit("cm");
        /// How flat they lie: 0 stands upright on the skin, 1 lies on it; counts with `lay` or `lay_from`.
        lay_amount: f32 = 0.7, range(0.0, 1.0);
        /// Standard deviation of the gaussian noise on the first direction.
        noise: f32 = 0.0, range(0.0, 10.0);
        /// Another seed gives other random numbers.
        seed: u64 = 0;
    }
}

/// Roots, and what the guides that grow from them share.
#[derive(Clone, Debug)]
pub struct Guides {
    /// One root per guide.
    pub roots: Vec<Root>,
    /// What they share.
    pub options: GuideOptions,
    /// The place in the script that made them.
    pub source: Arc<str>,
}

impl Object for Guides {
    const NAME: &'static str = "Guides";
}

impl GuideOptions {
    /// Checks what the ranges of the single fields cannot say, for `roots` guides.
    ///
    /// # Errors
    /// No roots, too many of them, a step that does not fit, numbers that are none.
    pub fn check(&self, roots: &[Root]) -> Result<(), GroomError> {
        if roots.is_empty() {
            return Err(GroomError::Nothing { what: "roots" });
        }
        // Written so that NaN is refused too.
        if !(self.step > 0.0 && self.length >= self.step && self.length.is_finite()) {
            return Err(GroomError::Step { step: self.step, length: self.length });
        }
        check_value("the length variation", self.length_variation, 0.0, 1.0)?;
        check_value("the stiffness", self.stiffness, 0.0, f32::MAX)?;
        check_value("how flat strands lie", self.lay_amount, 0.0, 1.0)?;
        check_value("the noise", self.noise, 0.0, f32::MAX)?;
        for r in roots {
            check_root(r)?;
        }
        let strands = roots.len() as u64;
        check_size(strands, strands.saturating_mul(self.most_steps() as u64 + 1))
    }

    /// Length of the strand with this root, cm.
    pub fn length_of(&self, root: &Root) -> f32 {
        let u = Key::new(self.seed, "guide length").with(root.id).unit();
        (self.length * (1.0 - self.length_variation * u)).max(self.length * 0.02).max(self.step.min(self.length))
    }

    /// Steps to a length of `length` cm, the last perhaps a part of one; never more than the growth limit.
    pub fn steps_to(&self, length: f32) -> usize {
        // A rest of less than a thousandth of a step is rounding.
        let steps = (length / self.step - 1e-3).ceil().max(1.0) as usize;
        self.limit.map_or(steps, |limit| steps.min(limit))
    }

    /// The most steps any strand may take.
    pub fn most_steps(&self) -> usize {
        self.steps_to(self.length)
    }

    /// The first tangent of the strand with this root.
    pub fn first_direction(&self, root: &Root) -> Vec3 {
        let along = |v: Vec3| (v - root.normal * v.dot(root.normal)).normalize_or_zero();
        let lay = self.lay.map_or(Vec3::ZERO, |d| along(d.0));
        let from = self.lay_from.map_or(Vec3::ZERO, |p| along(root.position - p));
        let flat = along(lay + from);
        let amount = if flat == Vec3::ZERO { 0.0 } else { self.lay_amount };
        let mut t = root.normal * (1.0 - amount) + flat * amount;
        if self.noise > 0.0 {
            t += gaussian3(Key::new(self.seed, "first direction").with(root.id)) * self.noise;
        }
        // Never into the skin.
        let t = t - root.normal * t.dot(root.normal).min(0.0);
        t.try_normalize().unwrap_or(root.normal)
    }
}

/// Refuses roots that are nowhere or stand nowhere to.
pub fn check_root(root: &Root) -> Result<(), GroomError> {
    check_point(format!("the root {:#018x}", root.id), root.position)?;
    check_value(format!("the length of the normal of root {:#018x}", root.id), root.normal.length(), 0.99, 1.01)
}

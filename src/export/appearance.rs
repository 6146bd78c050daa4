//! What a hair material means for a single strand, for all formats alike.

use glam::Vec3;

use crate::math::rng::Key;
use crate::scene::HairMaterial;

/// The colour at `v` (0 root, 1 tip), linear, mixed in linear light.
pub(super) fn ramp(look: &HairMaterial, v: f32) -> Vec3 {
    look.root_colour.to_linear().lerp(look.tip_colour.to_linear(), v)
}

/// What the colour of a strand is multiplied by: uniform between `1 - variation` and `1 + variation`, keyed by the
/// strand's identity.
pub(super) fn brightness(look: &HairMaterial, id: u64) -> f32 {
    let t = Key::new(0, "export brightness").with(id).range(-1.0, 1.0);
    1.0 + look.variation.clamp(0.0, 1.0) * t
}

/// The greatest brightness that a strand can have.
pub(super) fn brightest(look: &HairMaterial) -> f32 {
    1.0 + look.variation.clamp(0.0, 1.0)
}

/// Diameter at `v`, cm.
pub(super) fn width(look: &HairMaterial, v: f32) -> f32 {
    look.width * (1.0 + (look.taper - 1.0) * v)
}

/// Share of the length from the root to each node, 0..=1; by number where the strand has no length.
pub(super) fn shares(nodes: impl ExactSizeIterator<Item = Vec3> + Clone) -> impl Iterator<Item = f32> {
    let step = |before: &mut Option<Vec3>, p: Vec3| before.replace(p).map_or(0.0, |b| b.distance(p));
    let total: f32 = nodes.clone().scan(None, move |before, p| Some(step(before, p))).sum();
    let last = nodes.len().saturating_sub(1).max(1) as f32;
    let (mut before, mut length) = (None, 0.0);
    nodes.enumerate().map(move |(k, p)| {
        length += step(&mut before, p);
        if total > 0.0 { length / total } else { k as f32 / last }
    })
}

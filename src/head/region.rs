//! Regions: parts of a head's surface, with a density.
//!
//! A region gives every place of the surface a density 0..=1; a set has densities 0 and 1 only. Union is the
//! greatest, intersection the least of two densities, complement one minus it (Zadeh 1965), so sets behave as sets
//! do, and De Morgan's laws hold for varying densities too. [`Region::times`] multiplies.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::ear::Ear;
use super::mask::Mask;
use super::polygon::Polygon;
use super::sampled::Lattice;
use super::{Head, scalp};
use crate::geometry::Root;
use crate::geometry::sample::Sample;
use crate::math::Digest;
use crate::math::rng::Key;
use crate::params::{Object, nearest};

/// A part of the surface of one head.
#[derive(Clone, Debug)]
pub struct Region(Arc<Shape>);

impl Object for Region {
    const NAME: &'static str = "Region";
}

#[derive(Debug)]
enum Shape {
    Everything,
    Polygon(Polygon),
    /// What stands out of the skull, by more than this many cm.
    Ears([Option<Ear>; 2], f32),
    /// Per triangle of the mesh.
    Triangles(Vec<bool>),
    Sampled {
        lattice: Lattice,
        values: Vec<f32>,
        crisp: bool,
    },
    Mask(Arc<Mask>),
    Union(Region, Region),
    Intersection(Region, Region),
    Complement(Region),
    Times(Region, Region),
    Constant(f32),
}

/// Why there is no such region.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegionError {
    /// Less than three points enclose nothing.
    #[error("a region needs at least 3 points, got `{count}`")]
    TooFewPoints {
        /// How many there are, not counting those in the middle of the skull.
        count: usize,
    },
    /// A point is NaN or infinite.
    #[error("point {index} is not finite: `{point}`")]
    PointNotFinite {
        /// From 1.
        index: usize,
        /// The point.
        point: Vec3,
    },
    /// A group that the mesh does not have.
    #[error("the head has no group `{name}`")]
    UnknownGroup {
        /// What was asked for.
        name: String,
        /// The nearest name, if any is near.
        nearest: Option<String>,
        /// Some of the names there are.
        names: Vec<String>,
    },
    /// A mask on a mesh without texture coordinates.
    #[error("the head has no texture coordinates for a mask")]
    NoUv,
    /// A mask whose size and values do not fit.
    #[error("a mask of {width} x {height} pixels with {count} values")]
    BadMask {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
        /// How many values it has.
        count: usize,
    },
    /// Not one value per place.
    #[error("{count} values for {expected} places")]
    ValueCount {
        /// How many there are.
        count: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A density outside 0..=1.
    #[error("density `{value}` at {{ {:.2}, {:.2}, {:.2} }} is not between 0 and 1", at.x, at.y, at.z)]
    BadDensity {
        /// The density.
        value: f32,
        /// Where, in head space.
        at: Vec3,
    },
    /// It covers nothing.
    #[error("the region is empty: it covers no part of the head's skin")]
    Empty,
}

impl RegionError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::UnknownGroup { nearest: Some(near), .. } => Some(format!("did you mean `{near}`?")),
            Self::UnknownGroup { names, .. } if names.is_empty() => Some("its mesh has no groups at all".into()),
            Self::UnknownGroup { names, .. } => Some(format!("it has {}", names.join(", "))),
            Self::TooFewPoints { .. } => Some("give points around the region, in order".into()),
            Self::NoUv => Some("unwrap the head's mesh, or use points or a function instead".into()),
            Self::Empty => Some("are its points on the head, in head space (cm)?".into()),
            Self::PointNotFinite { .. } | Self::BadMask { .. } | Self::ValueCount { .. } | Self::BadDensity { .. } => {
                None
            }
        }
    }
}

impl Region {
    fn new(shape: Shape) -> Self {
        Self(Arc::new(shape))
    }

    /// The whole surface.
    pub fn everything() -> Self {
        Self::new(Shape::Everything)
    }

    /// See [`Head::scalp`].
    pub(super) fn natural(head: &Head) -> Self {
        let outline = Polygon::around(head.centre(), head.crown(), &scalp::outline(head), true);
        let scalp = outline.map_or_else(Self::everything, |p| Self::new(Shape::Polygon(p)));
        scalp.minus(&Self::new(Shape::Ears(*head.ears(), 0.5 * head.scale)))
    }

    /// What a closed curve through `points` (head space, in order, either way round) encloses; `smooth` rounds its
    /// corners. Edges run along great circles about [`Head::centre`]. A curve
    /// about half of the head encloses the half with the crown.
    ///
    /// # Errors
    /// Too few points, or a bad one.
    pub fn polygon(head: &Head, points: &[Vec3], smooth: bool) -> Result<Self, RegionError> {
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(RegionError::PointNotFinite { index: i + 1, point: points[i] });
        }
        // Points are laid on the surface: given a little off it, they mean the same directions and the right shell.
        let laid: Vec<Vec3> = points.iter().map(|&p| head.closest(p).position).collect();
        let polygon = Polygon::new(head.centre(), head.crown(), &laid, smooth);
        polygon.map(|p| Self::new(Shape::Polygon(p))).ok_or(RegionError::TooFewPoints { count: points.len() })
    }

    /// The triangles of a group, an object or a material of the mesh.
    ///
    /// # Errors
    /// An unknown name, with the nearest.
    pub fn group(head: &Head, name: &str) -> Result<Self, RegionError> {
        let groups = &head.mesh.groups;
        if !groups.iter().any(|g| g.name == name) {
            let near = nearest(name, groups.iter().map(|g| g.name.as_str())).map(str::to_owned);
            let names = groups.iter().map(|g| g.name.clone()).take(12).collect();
            return Err(RegionError::UnknownGroup { name: name.to_owned(), nearest: near, names });
        }
        let mut within = vec![false; head.mesh.triangles.len()];
        for &t in groups.iter().filter(|g| g.name == name).flat_map(|g| &g.triangles) {
            if let Some(flag) = within.get_mut(t as usize) {
                *flag = true;
            }
        }
        Ok(Self::new(Shape::Triangles(within)))
    }

    /// The places at which a predicate or a density function is to be asked, for [`Region::sampled`].
    pub fn sample_points(head: &Head) -> Vec<Root> {
        Lattice::new(&head.mesh, head.growing(), head.scale).places.iter().map(|s| head.root(s)).collect()
    }

    /// From one value per place of [`Region::sample_points`]. `crisp`: a set, whose border runs where the values,
    /// linear in between, pass 0.5; otherwise a density.
    ///
    /// # Errors
    /// The wrong number of values, or one outside 0..=1.
    pub fn sampled(head: &Head, values: Vec<f32>, crisp: bool) -> Result<Self, RegionError> {
        let lattice = Lattice::new(&head.mesh, head.growing(), head.scale);
        if values.len() != lattice.places.len() {
            return Err(RegionError::ValueCount { count: values.len(), expected: lattice.places.len() });
        }
        if let Some(i) = values.iter().position(|v| !(0.0..=1.0).contains(v)) {
            return Err(RegionError::BadDensity { value: values[i], at: lattice.places[i].position });
        }
        Ok(Self::new(Shape::Sampled { lattice, values, crisp }))
    }

    /// A picture over the head's texture coordinates, as a density.
    ///
    /// # Errors
    /// A head without texture coordinates, or a bad mask.
    pub fn mask(head: &Head, mask: Arc<Mask>) -> Result<Self, RegionError> {
        if !mask.is_valid() {
            let (width, height, count) = (mask.width, mask.height, mask.values.len());
            return Err(RegionError::BadMask { width, height, count });
        }
        if head.mesh.uvs.is_empty() {
            return Err(RegionError::NoUv);
        }
        Ok(Self::new(Shape::Mask(mask)))
    }

    /// What is in either.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        Self::new(Shape::Union(self.clone(), other.clone()))
    }

    /// What is in both.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self::new(Shape::Intersection(self.clone(), other.clone()))
    }

    /// What is in this and not in the other.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        self.and(&other.complement())
    }

    /// Everything else on the head.
    #[must_use]
    pub fn complement(&self) -> Self {
        Self::new(Shape::Complement(self.clone()))
    }

    /// Both densities multiplied.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        Self::new(Shape::Times(self.clone(), other.clone()))
    }

    /// The density multiplied by a number, clamped to 0..=1.
    #[must_use]
    pub fn thinned(&self, factor: f32) -> Self {
        let factor = if factor.is_nan() { 0.0 } else { factor.clamp(0.0, 1.0) };
        self.times(&Self::new(Shape::Constant(factor)))
    }

    /// Density 0..=1 at a place of `head`, the head this region was made for.
    pub fn density(&self, head: &Head, at: &Sample) -> f32 {
        match &*self.0 {
            Shape::Everything => 1.0,
            Shape::Polygon(polygon) => f32::from(polygon.contains(at.position)),
            Shape::Ears(ears, limit) => {
                let out = |e: &Ear| e.stands_out(at.position, 0.3 * head.scale).is_some_and(|d| d > *limit);
                f32::from(ears.iter().flatten().any(out))
            }
            Shape::Triangles(within) => f32::from(within.get(at.triangle as usize).is_some_and(|&w| w)),
            Shape::Sampled { lattice, values, crisp } => {
                let value = lattice.value(&head.mesh, values, at);
                if *crisp { f32::from(value >= 0.5) } else { value.clamp(0.0, 1.0) }
            }
            Shape::Mask(mask) => mask.value(at.interpolate(&head.mesh, &head.mesh.uvs)).clamp(0.0, 1.0),
            Shape::Union(a, b) => {
                let first = a.density(head, at);
                if first >= 1.0 { first } else { first.max(b.density(head, at)) }
            }
            Shape::Intersection(a, b) => {
                let first = a.density(head, at);
                if first <= 0.0 { first } else { first.min(b.density(head, at)) }
            }
            Shape::Complement(a) => 1.0 - a.density(head, at),
            Shape::Times(a, b) => {
                let first = a.density(head, at);
                if first <= 0.0 { first } else { first * b.density(head, at) }
            }
            Shape::Constant(c) => *c,
        }
    }

    /// True where the density is not zero.
    pub fn contains(&self, head: &Head, at: &Sample) -> bool {
        self.density(head, at) > 0.0
    }

    /// Area in cm^2, each place weighted with its density; to about 1 % for a region of 20 cm^2.
    pub fn area(&self, head: &Head) -> f64 {
        let patch = head.patch();
        let mut area = 0.0;
        for count in [1 << 15, 1 << 19] {
            let key = Key::new(0, "area");
            // Summed by blocks in a fixed order: the same on any number of threads.
            let blocks: Vec<f64> = (0..count / 1024)
                .into_par_iter()
                .map(|block| {
                    let places = (block * 1024..(block + 1) * 1024).map(|i| patch.stratified(i, count, key));
                    places.map(|s| f64::from(self.density(head, &s))).sum()
                })
                .collect();
            let hits: f64 = blocks.iter().sum();
            area = patch.area() * hits / count as f64;
            if hits > 2000.0 {
                break;
            }
        }
        area
    }

    /// Feeds what it is to a key, for the head that it is of.
    pub fn digest(&self, into: &mut Digest) {
        match &*self.0 {
            Shape::Everything => into.number(0),
            Shape::Polygon(polygon) => into.number(1).data(polygon),
            Shape::Ears(ears, height) => into.number(2).data(ears).floats(&[*height]),
            Shape::Triangles(which) => into.number(3).flags(which),
            // The lattice depends on the head alone.
            Shape::Sampled { lattice: _, values, crisp } => into.number(4).floats(values).flags(&[*crisp]),
            Shape::Mask(mask) => into.number(5).number(mask.width as u64).floats(&mask.values),
            Shape::Union(a, b) => two(into.number(6), a, b),
            Shape::Intersection(a, b) => two(into.number(7), a, b),
            Shape::Complement(a) => one(into.number(8), a),
            Shape::Times(a, b) => two(into.number(9), a, b),
            Shape::Constant(density) => into.number(10).floats(&[*density]),
        };
        fn one<'a>(into: &'a mut Digest, a: &Region) -> &'a mut Digest {
            a.digest(into);
            into
        }
        fn two<'a>(into: &'a mut Digest, a: &Region, b: &Region) -> &'a mut Digest {
            one(one(into, a), b)
        }
    }

    /// Checks that it covers something.
    ///
    /// # Errors
    /// [`RegionError::Empty`].
    pub fn check(&self, head: &Head) -> Result<(), RegionError> {
        if self.area(head) > 0.0 { Ok(()) } else { Err(RegionError::Empty) }
    }
}

impl Head {
    /// The natural scalp: from the forehead landmark over slightly receding corners and the temples to sideburns in
    /// front of the ears, around the ears, and behind them down to the nape. Ears themselves are left out.
    pub fn scalp(&self) -> Region {
        Region::natural(self)
    }
}

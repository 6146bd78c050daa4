//! Sections: the shape of a tuft across its stroke.

use std::f32::consts::{FRAC_PI_2, PI};

use super::TuftError;
use crate::math::trig;

/// Size along the stroke; `t` is the fraction of arc length, 0 at the buried start, 1 at the tip.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// A circle (Shimosoyama et al. 2015, section 3.2): 0 at the start, `diameter` at `peak`, 0 at the tip. The paper
    /// says no more; here both halves are quarter sines, so that start and tip are cones and the belly is smooth. With
    /// `peak` 0.5 this is [`Profile::Elliptic`] with equal radii.
    Round {
        /// Greatest diameter, cm.
        diameter: f32,
        /// Where it is, 0..1.
        peak: f32,
    },
    /// An ellipse (Ren, Zhao, Geng 2010, formulas (1) and (2)): radii R sin(pi (t + alpha) / (1 + alpha + beta)).
    Elliptic {
        /// HR: greatest radius along the width, cm.
        horizontal: f32,
        /// VR: greatest radius along the thickness, cm.
        vertical: f32,
        /// Opens the root, 0 or more.
        alpha: f32,
        /// Opens the tip, 0 or more.
        beta: f32,
    },
    /// An ellipse through given sizes, from t = 0 to t = 1, joined by a cubic that never overshoots them (Fritsch,
    /// Carlson 1980, with the slopes of Fritsch, Butland 1984).
    Points(Vec<ProfilePoint>),
}

/// The size of a section at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Fraction of arc length, 0..=1.
    pub t: f32,
    /// Whole width, cm.
    pub width: f32,
    /// Whole thickness, cm.
    pub thickness: f32,
}

/// Split tips: from `from` on, the tuft is several prongs side by side along its width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// How many tips, 2 to 8.
    pub tips: u32,
    /// Where the prongs part, 0..1.
    pub from: f32,
    /// How far they spread: 0 go on side by side, 1 twice as far apart at the tips, negative comes together.
    pub spread: f32,
}

/// The shape of a tuft across its stroke.
///
/// Width runs along the frame's binormal, thickness along its normal, which points away from the head.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Size along the stroke.
    pub profile: Profile,
    /// 0 leaves the thickness as it is, towards 1 makes it flat.
    pub flatten: f32,
    /// Turn about the stroke from start to tip, radians.
    pub twist: f32,
    /// The width is bent into an arc that spans this angle, its edges towards the head; radians, negative: away.
    pub bend: f32,
    /// Several tips.
    pub split: Option<Split>,
}

impl Section {
    /// The paper's round tuft: `diameter` in cm, `peak` as a fraction.
    pub fn round(diameter: f32, peak: f32) -> Self {
        Self::of(Profile::Round { diameter, peak })
    }

    /// A section of that profile, neither flattened, twisted, bent nor split.
    pub fn of(profile: Profile) -> Self {
        Self { profile, flatten: 0.0, twist: 0.0, bend: 0.0, split: None }
    }

    /// A profile sampled at `count` even places from a function of t that gives (width, thickness), cm.
    pub fn sampled(count: usize, mut size: impl FnMut(f32) -> (f32, f32)) -> Self {
        let count = count.max(2);
        let points = (0..count).map(|i| {
            let t = i as f32 / (count - 1) as f32;
            let (width, thickness) = size(t);
            ProfilePoint { t, width, thickness }
        });
        Self::of(Profile::Points(points.collect()))
    }

    /// Checks every number.
    ///
    /// # Errors
    /// The first number out of range, a profile out of order, a section without any size.
    pub fn validate(&self) -> Result<(), TuftError> {
        const LARGE: f32 = 1000.0;
        let within = TuftError::check;
        match &self.profile {
            Profile::Round { diameter, peak } => {
                within("diameter", *diameter, 1e-3, LARGE)?;
                within("peak", *peak, 0.01, 1.0)?;
            }
            Profile::Elliptic { horizontal, vertical, alpha, beta } => {
                within("horizontal", *horizontal, 1e-3, LARGE)?;
                within("vertical", *vertical, 1e-3, LARGE)?;
                within("alpha", *alpha, 0.0, 100.0)?;
                within("beta", *beta, 0.0, 100.0)?;
            }
            Profile::Points(points) => {
                if points.len() < 2 {
                    return Err(TuftError::ProfileOrder { number: 1, t: points.first().map_or(0.0, |p| p.t) });
                }
                let ends = [(0, 0.0), (points.len() - 1, 1.0)];
                for (i, p) in points.iter().enumerate() {
                    let risen = i == 0 || p.t - points[i - 1].t > 1e-4;
                    let ended = ends.iter().all(|&(end, t)| end != i || p.t == t);
                    if !(risen && ended) {
                        return Err(TuftError::ProfileOrder { number: i + 1, t: p.t });
                    }
                    within("width", p.width, 0.0, LARGE)?;
                    within("thickness", p.thickness, 0.0, LARGE)?;
                }
                let greatest = |f: fn(&ProfilePoint) -> f32| points.iter().map(f).fold(0.0, f32::max);
                for (what, size) in [("width", greatest(|p| p.width)), ("thickness", greatest(|p| p.thickness))] {
                    if size < 1e-3 {
                        return Err(TuftError::NoSize { what });
                    }
                }
                // Where one of the two vanishes inside, the mesh would be pinched to a sheet.
                for p in &points[1..points.len() - 1] {
                    within("width inside the profile", p.width, 1e-3, LARGE)?;
                    within("thickness inside the profile", p.thickness, 1e-3, LARGE)?;
                }
            }
        }
        within("flatten", self.flatten, 0.0, 0.98)?;
        within("twist", self.twist, -20.0 * PI, 20.0 * PI)?;
        within("bend", self.bend, -1.9 * PI, 1.9 * PI)?;
        if let Some(split) = self.split {
            within("tips", split.tips as f32, 2.0, 8.0)?;
            within("split from", split.from, 0.05, 0.98)?;
            within("spread", split.spread, -0.9, 10.0)?;
        }
        Ok(())
    }

    /// Half width and half thickness at `t` in 0..=1, cm.
    pub fn radii(&self, t: f32) -> (f32, f32) {
        let (w, h) = match &self.profile {
            Profile::Round { diameter, peak } => {
                let f = if t <= *peak {
                    trig::sin(FRAC_PI_2 * t / peak)
                } else {
                    trig::sin(FRAC_PI_2 * (1.0 - t) / (1.0 - peak))
                };
                (0.5 * diameter * f, 0.5 * diameter * f)
            }
            Profile::Elliptic { horizontal, vertical, alpha, beta } => {
                // From the nearer end, so that a closed tip is exactly 0.
                let whole = 1.0 + alpha + beta;
                let f = trig::sin(PI * ((t + alpha) / whole).min((1.0 - t + beta) / whole));
                (horizontal * f, vertical * f)
            }
            Profile::Points(points) => {
                (0.5 * monotone(points, t, |p| p.width), 0.5 * monotone(points, t, |p| p.thickness))
            }
        };
        (w.max(0.0), h.max(0.0) * (1.0 - self.flatten))
    }

    /// The greatest width anywhere, cm: what fills space their tufts by (the paper's d).
    pub fn greatest_width(&self) -> f32 {
        match &self.profile {
            Profile::Round { diameter, .. } => *diameter,
            Profile::Elliptic { horizontal, alpha, beta, .. } => {
                let whole = 1.0 + alpha + beta;
                // The sine's crest may lie outside 0..1 when the ends are wide open.
                let crest = (0.5 * whole).clamp(*alpha, 1.0 + alpha);
                2.0 * horizontal * trig::sin(PI * crest / whole)
            }
            Profile::Points(points) => points.iter().map(|p| p.width).fold(0.0, f32::max),
        }
    }

    /// Its kind, for messages: "round", "elliptic", "points".
    pub fn kind(&self) -> &'static str {
        match self.profile {
            Profile::Round { .. } => "round",
            Profile::Elliptic { .. } => "elliptic",
            Profile::Points(_) => "points",
        }
    }

    /// Every number a fraction `s` of the way from this section's to `other`'s; `None` for different kinds of profile.
    /// Tips are those of the nearer one.
    pub fn between(&self, other: &Self, s: f32) -> Option<Self> {
        let mix = |a: f32, b: f32| a + (b - a) * s;
        let profile = match (&self.profile, &other.profile) {
            (Profile::Round { diameter, peak }, Profile::Round { diameter: d, peak: p }) => {
                Profile::Round { diameter: mix(*diameter, *d), peak: mix(*peak, *p) }
            }
            (
                Profile::Elliptic { horizontal, vertical, alpha, beta },
                Profile::Elliptic { horizontal: h, vertical: v, alpha: a, beta: b },
            ) => Profile::Elliptic {
                horizontal: mix(*horizontal, *h),
                vertical: mix(*vertical, *v),
                alpha: mix(*alpha, *a),
                beta: mix(*beta, *b),
            },
            (Profile::Points(a), Profile::Points(b)) => {
                let mut places: Vec<f32> = a.iter().chain(b).map(|p| p.t).collect();
                places.sort_by(f32::total_cmp);
                places.dedup_by(|x, y| *x - *y <= 1e-4);
                if let Some(last) = places.last_mut() {
                    *last = 1.0;
                }
                let at = |t| ProfilePoint {
                    t,
                    width: mix(monotone(a, t, |p| p.width), monotone(b, t, |p| p.width)),
                    thickness: mix(monotone(a, t, |p| p.thickness), monotone(b, t, |p| p.thickness)),
                };
                Profile::Points(places.into_iter().map(at).collect())
            }
            _ => return None,
        };
        Some(Self {
            profile,
            flatten: mix(self.flatten, other.flatten),
            twist: mix(self.twist, other.twist),
            bend: mix(self.bend, other.bend),
            split: if s < 0.5 { self.split } else { other.split },
        })
    }

    /// Mirrored at the head's middle plane: only a twist has a handedness.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        Self { twist: -self.twist, ..self.clone() }
    }
}

/// The monotone cubic through the points' sizes at `t`.
fn monotone(points: &[ProfilePoint], t: f32, size: impl Fn(&ProfilePoint) -> f32) -> f32 {
    let i = points.partition_point(|p| p.t <= t).clamp(1, points.len() - 1) - 1;
    let slope = |k: usize| (size(&points[k + 1]) - size(&points[k])) / (points[k + 1].t - points[k].t);
    let tangent = |k: usize| {
        if k == 0 {
            return slope(0);
        }
        if k == points.len() - 1 {
            return slope(k - 1);
        }
        let (a, b) = (slope(k - 1), slope(k));
        if a * b <= 0.0 {
            return 0.0;
        }
        let (ha, hb) = (points[k].t - points[k - 1].t, points[k + 1].t - points[k].t);
        let (wa, wb) = (2.0 * hb + ha, hb + 2.0 * ha);
        (wa + wb) / (wa / a + wb / b)
    };
    let (a, b) = (&points[i], &points[i + 1]);
    let h = b.t - a.t;
    let x = ((t - a.t) / h).clamp(0.0, 1.0);
    let (x2, x3) = (x * x, x * x * x);
    size(a) * (2.0 * x3 - 3.0 * x2 + 1.0)
        + h * tangent(i) * (x3 - 2.0 * x2 + x)
        + size(b) * (3.0 * x2 - 2.0 * x3)
        + h * tangent(i + 1) * (x3 - x2)
}

//! The dress form: a torso on a stand.

use glam::Vec3;

use super::figure::{AXIS, BUST, Figure, HIP, WAIST};
use super::loft::Loft;
use super::skirt::ring;
use super::{Garment, Tape};
use crate::geometry::slice::Side;
use crate::math::trig;

crate::params! {
    /// A dress form: a woman's torso, closed, on a stand.
    #[derive(PartialEq)]
    pub struct FormOptions("coif.garment.form") {
        /// Girth around the bust.
        bust: f32 = 84.0, unit("cm"), range(50.0, 200.0);
        /// Girth around the waist.
        waist: f32 = 60.0, unit("cm"), range(35.0, 200.0);
        /// Girth around the hip.
        hip: f32 = 88.0, unit("cm"), range(50.0, 200.0);
        /// False leaves the stand out.
        stand: bool = true;
    }
}

impl FormOptions {
    /// The form.
    pub fn build(&self) -> Garment {
        let figure = Figure::new(self.bust, self.waist, self.hip);
        let mut loft = Loft::default();
        let (neck, bottom) = (-13.5, -86.0);
        let mut rows: Vec<Vec<Vec3>> = Vec::new();
        // A round lid on the neck.
        for u in [0.02, 0.35, 0.65, 0.88, 0.97] {
            rows.push(ring(|a| {
                let p = figure.place(neck, a, 0.0);
                Vec3::new(p.x * u, neck + 1.6 * (1.0 - u * u).max(0.0), AXIS + (p.z - AXIS) * u)
            }));
        }
        let count = 130;
        rows.extend((0..=count).map(|r| {
            let y = neck + (bottom - neck) * r as f32 / count as f32;
            ring(|a| figure.place(y, a, 0.0))
        }));
        // Rounded in below.
        for (u, down) in [(0.98, 0.7), (0.93, 1.6), (0.8, 2.6), (0.5, 3.3), (0.2, 3.5)] {
            rows.push(ring(|a| {
                let p = figure.place(bottom, a, 0.0);
                Vec3::new(p.x * u, bottom - down, AXIS + (p.z - AXIS) * u)
            }));
        }
        loft.sheet("form", &rows, |_, _| true);
        let lid = rows[0][0].y;
        loft.cap("form", &rows[0], Vec3::new(0.0, lid, AXIS), true);
        let last = rows.len() - 1;
        loft.cap("form", &rows[last], Vec3::new(0.0, rows[last][0].y, AXIS), false);
        if self.stand {
            turned(
                &mut loft,
                &[(0.05, -9.3), (0.9, -9.5), (1.5, -10.2), (1.6, -11.0), (1.1, -11.8), (0.8, -12.2), (1.6, -12.4)],
            );
            let foot = -157.0;
            turned(
                &mut loft,
                &[
                    (1.5, -88.0),
                    (1.5, -150.0),
                    (2.6, -151.0),
                    (2.8, -152.5),
                    (6.0, -154.0),
                    (14.0, -155.4),
                    (15.5, -156.0),
                    (15.8, foot),
                    (0.05, foot),
                ],
            );
        }
        let around = |name: &str, height: f32| Tape { name: name.into(), height, side: Side::Middle, parts: vec![] };
        let tapes = vec![around("bust", BUST), around("waist", WAIST), around("hip", HIP)];
        Garment { kind: "form".into(), mesh: loft.finish(), tapes }
    }
}

/// A turned piece of the stand: (radius, height) from top to bottom, joined smoothly.
fn turned(loft: &mut Loft, profile: &[(f32, f32)]) {
    // Evenly in length along the profile, so that neighbouring corners do not swing.
    let mut run = vec![0.0];
    for w in profile.windows(2) {
        let way = trig::hypot(w[1].0 - w[0].0, w[1].1 - w[0].1);
        run.push(run[run.len() - 1] + way);
    }
    let place = |t: f32| {
        let i = run[1..run.len() - 1].iter().take_while(|r| **r <= t).count();
        let part = (t - run[i]) / (run[i + 1] - run[i]);
        let (a, b) = (profile[i], profile[i + 1]);
        (a.0 + (b.0 - a.0) * part, a.1 + (b.1 - a.1) * part)
    };
    let length = run[run.len() - 1];
    let rounded = |t: f32| {
        let some = [-0.6, -0.3, 0.0, 0.3, 0.6].map(|d: f32| place((t + d).clamp(0.0, length)));
        let sum = some.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
        (sum.0 / 5.0, sum.1 / 5.0)
    };
    let steps = (length / 0.4) as usize;
    let rows: Vec<Vec<Vec3>> = (0..=steps)
        .map(|i| {
            let (r, y) = rounded(length * i as f32 / steps as f32);
            ring(|a| Vec3::new(r * trig::sin(a), y, AXIS + r * trig::cos(a)))
        })
        .collect();
    loft.sheet("stand", &rows, |_, _| true);
}

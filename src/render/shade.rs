//! How hair and skin answer the lamps of the studio.
//!
//! The lamps stand fixed about the camera, as around a turntable: a key from the upper left, a fill from the right, two
//! rim lamps from behind, and a sky. Hair: Kajiya and Kay 1989 for the diffuse part; the highlights are the three lobes
//! of Marschner et al. 2003, longitudinally a Gaussian of sin(theta_i) + sin(theta_r) and azimuthally the fits of Karis
//! 2016 ("Physically based hair shading in Unreal"), weighted by eye.

use glam::Vec3;

use rayon::prelude::*;

use crate::geometry::Mesh;
use crate::scene::{HairMaterial, MeshMaterial};
use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::fast;
use super::shadow::{Density, Depths, Grid, Lights, openness, transmittance};

/// A lamp far away.
#[derive(Clone, Debug)]
struct Lamp {
    /// Unit vector to it, head space.
    toward: Vec3,
    /// Linear colour times strength.
    colour: Vec3,
    /// Which of the values of [`Lights`] shades it in hair.
    reach: usize,
    /// The fraction that hair lets through to the skin; none for the fill, which is shaded by openness.
    skin: Option<Grid>,
    /// Where the head stands in its own light.
    head: Option<Depths>,
}

/// The lamps of one view.
#[derive(Clone, Debug)]
pub struct Studio<'a> {
    lamps: Vec<Lamp>,
    lights: Lights,
    sky: &'a Sky,
    toward: Vec3,
    up: Vec3,
}

/// Directions to the lamps (right, up, toward the viewer) and their colours; the fill comes second.
const LAMPS: [([f32; 3], [f32; 3]); 4] = [
    ([-0.50, 0.78, 0.62], [1.42, 1.36, 1.28]),
    ([0.85, 0.10, 0.55], [0.26, 0.28, 0.32]),
    ([0.62, 0.55, -0.62], [0.95, 0.98, 1.05]),
    ([-0.85, 0.30, -0.50], [0.50, 0.52, 0.58]),
];
/// Light of the sky.
const SKY: Vec3 = Vec3::new(0.46, 0.48, 0.52);
/// The lamp whose shadows are the sharpest.
const KEY: usize = 0;
/// The lamp that casts no shadow of its own.
const FILL: usize = 1;

/// How much of the sky reaches each place; the same for all views.
#[derive(Clone, Debug)]
pub struct Sky {
    /// In hair, beside strands and skin.
    hair: Grid,
    /// On the skin, under strands alone.
    skin: Grid,
}

impl Sky {
    /// From what stands in its way.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(density: &Density, task: &Task) -> Result<Self, Cancelled> {
        Ok(Self { hair: openness(&density.coarse, task)?, skin: openness(&density.coarse_hair, task)? })
    }
}

impl<'a> Studio<'a> {
    /// Lamps about `camera`; `density` and `meshes` stand in their way.
    pub fn new(camera: &Camera, density: &Density, meshes: &[&Mesh], sky: &'a Sky) -> Self {
        let toward = |i: usize| camera.to_world(Vec3::from(LAMPS[i].0).normalize());
        let lights = Lights::new(&density.whole, &sky.hair, [toward(0), toward(2), toward(3)]);
        let lamps = (0..LAMPS.len())
            .into_par_iter()
            .map(|i| {
                let toward = toward(i);
                let hair = if i == KEY { &density.hair } else { &density.coarse_hair };
                let skin = (i != FILL).then(|| transmittance(hair, toward));
                let head = (i == KEY).then(|| Depths::new(meshes, toward));
                // The fill shares the sky's value.
                Lamp { toward, colour: Vec3::from(LAMPS[i].1), reach: [1, 0, 2, 3][i], skin, head }
            })
            .collect();
        Self { lamps, lights, sky, toward: camera.toward, up: camera.up }
    }

    /// Linear colour of hair at `p` with the unit tangent `t` (root to tip), as the viewer sees it.
    pub fn hair(&self, coat: &Coat, strand: &StrandLook, p: Vec3, t: Vec3, along: f32) -> Vec3 {
        let albedo = (coat.root + (coat.tip - coat.root) * along) * strand.tint;
        let v = self.toward;
        let tv = t.dot(v);
        let across = (v - t * tv).normalize_or_zero();
        let reaches = self.lights.sample(p).to_array();
        let open = reaches[0];
        // Light that went through hair took on its colour; blond scatters more of it on than black.
        let pass = Vec3::ONE - (albedo.map(f32::sqrt) * 0.75).min(Vec3::splat(0.62));
        let deep = |reach: f32| {
            // reach^pass, between reach^1 and reach^(1/4).
            let quarter = reach.max(0.0).sqrt().sqrt();
            Vec3::splat(quarter) + (Vec3::splat(reach) - Vec3::splat(quarter)) * ((pass - 0.25) / 0.75).max(Vec3::ZERO)
        };
        let mut sum = albedo * deep(open) * SKY * (0.75 + 0.25 * across.dot(self.up));
        let glow = albedo.map(f32::sqrt);
        for lamp in &self.lamps {
            let l = lamp.toward;
            let tl = t.dot(l);
            let reach = reaches[lamp.reach];
            let light = lamp.colour;
            let sin_tl = (1.0 - tl * tl).max(0.0).sqrt();
            let facing = 0.5 + 0.5 * across.dot(l);
            sum += albedo * deep(reach) * light * (sin_tl * (0.10 + 0.70 * facing));
            if coat.shine <= 0.0 || reach < 0.004 {
                continue;
            }
            // Azimuth between lamp and viewer about the strand.
            let cos_phi = (l - t * tl).normalize_or_zero().dot(across);
            let half = (0.5 + 0.5 * cos_phi).max(0.0).sqrt();
            let lobe = |shift: f32, width: f32| {
                let x = (tl + tv - shift - strand.shift) / width;
                fast::exp(-0.5 * x * x)
            };
            let primary = lobe(0.09, coat.width) * half * 0.30;
            let secondary = lobe(-0.14, 1.7 * coat.width) * half * half * 0.30;
            let through = lobe(0.0, 2.4 * coat.width) * fast::exp(-3.65 * cos_phi - 3.98) * 0.9;
            let shine = Vec3::splat(primary * strand.glint) + glow * secondary * strand.glint + glow * albedo * through;
            sum += shine * light * (coat.shine * reach);
        }
        shoulder(sum)
    }

    /// Linear colour of a surface at `p` with the unit normal `n` turned to the viewer.
    pub fn surface(&self, material: &Skin, p: Vec3, n: Vec3) -> Vec3 {
        let open = self.sky.skin.sample_sky(p + n * (0.8 * self.sky.skin.cell()));
        // Light that hair and skin throw at each other keeps a face readable between curtains of hair.
        let open = 0.16 + 0.24 * open.max(0.0).sqrt() + 0.60 * open;
        let mut sum = material.albedo * SKY * (open * (0.66 + 0.30 * n.dot(self.up)));
        // Light that bounced inside the skin comes out redder and past the edge of the shadow.
        let wrap = Vec3::new(0.34, 0.20, 0.14);
        for lamp in &self.lamps {
            let nl = n.dot(lamp.toward);
            let hair = match &lamp.skin {
                Some(grid) => grid.sample_toward(p + (n + lamp.toward) * (0.5 * grid.cell()), lamp.toward),
                None => open,
            };
            let hair = 0.14 + 0.86 * hair;
            let lit = nl > -0.34;
            let reach = if !lit { 0.0 } else { hair * lamp.head.as_ref().map_or(1.0, |head| head.sample(p + n * 0.1)) };
            let soft = ((Vec3::splat(nl) + wrap) / (Vec3::ONE + wrap)).max(Vec3::ZERO);
            let reach_rgb = Vec3::new(reach.max(0.0).sqrt() * 0.35 + reach * 0.65, reach, reach);
            sum += material.albedo * lamp.colour * soft * soft.map(f32::sqrt) * reach_rgb * 0.60;
            let h = (lamp.toward + self.toward).normalize_or_zero();
            let nh = n.dot(h).max(0.0);
            let fresnel = 0.03 + 0.5 * fast::exp(-6.0 * n.dot(self.toward).max(0.0));
            let gloss = fast::exp(-(1.0 - nh) * material.sharpness) * fresnel * material.gloss;
            sum += lamp.colour * (gloss * reach * (nl * 4.0).clamp(0.0, 1.0));
        }
        shoulder(sum)
    }
}

/// Keeps values up to 0.6 and bends the rest softly below 1.
fn shoulder(c: Vec3) -> Vec3 {
    c.map(|x| if x <= 0.6 { x } else { 1.0 - 0.4 * fast::exp(-(x - 0.6) / 0.4) })
}

/// A hair material, made ready.
#[derive(Clone, Copy, Debug)]
pub struct Coat {
    root: Vec3,
    tip: Vec3,
    variation: f32,
    shine: f32,
    width: f32,
}

impl Coat {
    /// From the material of a scene.
    pub fn new(material: &HairMaterial) -> Self {
        Self {
            root: material.root_colour.to_linear(),
            tip: material.tip_colour.to_linear(),
            variation: material.variation,
            shine: material.shine * 2.0,
            width: 0.04 + 0.22 * material.roughness,
        }
    }

    /// What sets the strand with this id apart from others.
    pub fn strand(&self, id: u64) -> StrandLook {
        let bits = id.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (id >> 29);
        let bits = bits ^ (bits >> 32);
        let unit = |shift: u32| ((bits >> shift) & 0xffff) as f32 / 65_535.0 * 2.0 - 1.0;
        // Brightness in stops, so that it stays positive; a little warmer or cooler.
        let (bright, warm) = (unit(0) + unit(16), unit(32) * self.variation);
        let tint = fast::exp(bright * self.variation);
        StrandLook {
            tint: Vec3::new(tint * (1.0 + 0.20 * warm), tint, tint * (1.0 - 0.25 * warm)),
            shift: 0.07 * unit(24),
            glint: 1.0 + 0.8 * unit(8),
        }
    }
}

/// What sets one strand apart.
#[derive(Clone, Copy, Debug)]
pub struct StrandLook {
    tint: Vec3,
    shift: f32,
    glint: f32,
}

/// A surface material, made ready.
#[derive(Clone, Copy, Debug)]
pub struct Skin {
    albedo: Vec3,
    sharpness: f32,
    gloss: f32,
}

impl Skin {
    /// From the material of a scene.
    pub fn new(material: &MeshMaterial) -> Self {
        let smooth = 1.0 - material.roughness.clamp(0.0, 1.0);
        Self {
            albedo: material.colour.to_linear(),
            sharpness: 12.0 + 240.0 * smooth * smooth,
            gloss: 0.25 + 2.0 * smooth * smooth,
        }
    }

    /// Its linear colour.
    pub fn albedo(&self) -> Vec3 {
        self.albedo
    }

    /// The same with another linear colour.
    #[must_use]
    pub fn tinted(self, albedo: Vec3) -> Self {
        Self { albedo, ..self }
    }
}

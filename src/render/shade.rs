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
use super::depths::Depths;
use super::fast;
use super::shadow::{Density, Grid, Lights, openness, transmittance};

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

/// A lamp that stands lower than this over a surface (cosine) does not light it.
const UNLIT: f32 = -0.34;

/// How much light reaches a place on a surface, each from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Of the sky.
    open: f32,
    /// Of each lamp, through hair.
    hair: [f32; LAMPS.len()],
    /// Of the lamp that casts the head's shadow, past the head.
    head: f32,
}

impl Reach {
    /// No light at all.
    pub const NONE: Self = Self { open: 0.0, hair: [0.0; LAMPS.len()], head: 0.0 };

    /// The sum with a part of another.
    #[must_use]
    pub fn plus(self, other: &Self, part: f32) -> Self {
        let hair = std::array::from_fn(|i| self.hair[i] + other.hair[i] * part);
        Self { open: self.open + other.open * part, hair, head: self.head + other.head * part }
    }
}

/// How much of the sky reaches each place; the same for all views.
#[derive(Clone, Debug)]
pub struct Sky {
    /// In hair, beside strands and skin: in each cell of the density.
    hair: Vec<f32>,
    /// On the skin, under strands alone.
    skin: Grid,
}

impl Sky {
    /// From what stands in its way.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(density: &Density, task: &Task) -> Result<Self, Cancelled> {
        let hair = density.whole.resampled(&openness(&density.coarse, task)?);
        Ok(Self { hair, skin: openness(&density.coarse_hair, task)? })
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

    /// Colours the first `count` of `lanes`, hair with this coat, as the viewer sees it.
    pub fn hair(&self, coat: &Coat, lanes: &mut Lanes, count: usize) {
        for lane in 0..count {
            let reach = self.lights.sample(Vec3::new(lanes.point[0][lane], lanes.point[1][lane], lanes.point[2][lane]));
            for (k, reach) in reach.to_array().into_iter().enumerate() {
                lanes.reach[k][lane] = reach;
            }
        }
        let lamps = std::array::from_fn(|i| {
            let lamp = &self.lamps[i];
            (lamp.toward.to_array(), lamp.colour.to_array(), lamp.reach)
        });
        answer(&lamps, self.toward.to_array(), self.up.to_array(), coat.shine, coat.width, lanes);
    }

    /// How much light reaches a surface at `p` with the unit normal `n` turned to the viewer.
    pub fn reach(&self, p: Vec3, n: Vec3) -> Reach {
        let open = self.sky.skin.sample_sky(p + n * (0.8 * self.sky.skin.cell()));
        let mut reach = Reach { open, hair: [open; LAMPS.len()], head: 1.0 };
        for (lamp, hair) in self.lamps.iter().zip(&mut reach.hair) {
            if let Some(grid) = &lamp.skin {
                *hair = grid.sample_toward(p + (n + lamp.toward) * (0.5 * grid.cell()), lamp.toward);
            }
            if let (Some(head), true) = (&lamp.head, n.dot(lamp.toward) > UNLIT) {
                reach.head = head.sample(p + n * 0.1);
            }
        }
        reach
    }

    /// Colours all of `panes` as the viewer sees them.
    pub fn surface(&self, panes: &mut Panes) {
        let lamps = std::array::from_fn(|i| {
            let lamp = &self.lamps[i];
            let half = (lamp.toward + self.toward).normalize_or_zero();
            Beam {
                toward: lamp.toward.to_array(),
                half: half.to_array(),
                colour: lamp.colour.to_array(),
                hair: lamp.skin.is_some(),
                head: lamp.head.is_some(),
            }
        });
        shine(&lamps, self.toward.to_array(), self.up.to_array(), panes);
    }
}

/// A lamp as a surface sees it.
struct Beam {
    toward: [f32; 3],
    /// Half way to the viewer.
    half: [f32; 3],
    colour: [f32; 3],
    /// Shaded by hair; otherwise by openness.
    hair: bool,
    /// Shaded by the head.
    head: bool,
}

/// Places on surfaces that are shaded side by side, each number of theirs apart.
#[derive(Clone, Debug)]
pub struct Panes {
    normal: [[f32; Self::COUNT]; 3],
    albedo: [[f32; Self::COUNT]; 3],
    sharpness: [f32; Self::COUNT],
    gloss: [f32; Self::COUNT],
    open: [f32; Self::COUNT],
    hair: [[f32; Self::COUNT]; LAMPS.len()],
    head: [f32; Self::COUNT],
    /// Linear.
    colour: [[f32; Self::COUNT]; 3],
}

impl Default for Panes {
    fn default() -> Self {
        let (zero, zero3) = ([0.0; Self::COUNT], [[0.0; Self::COUNT]; 3]);
        let hair = [zero; LAMPS.len()];
        let (sharpness, gloss, open, head) = (zero, zero, zero, zero);
        Self { normal: zero3, albedo: zero3, sharpness, gloss, open, hair, head, colour: zero3 }
    }
}

impl Panes {
    /// How many there are.
    pub const COUNT: usize = 16;

    /// Puts a place into a lane: its material, its linear colour, its unit normal turned to the viewer, its light.
    pub fn set(&mut self, lane: usize, material: &Skin, albedo: Vec3, normal: Vec3, light: &Reach) {
        for k in 0..3 {
            self.normal[k][lane] = normal[k];
            self.albedo[k][lane] = albedo[k];
        }
        (self.sharpness[lane], self.gloss[lane]) = (material.sharpness, material.gloss);
        (self.open[lane], self.head[lane]) = (light.open, light.head);
        for (of, hair) in self.hair.iter_mut().zip(light.hair) {
            of[lane] = hair;
        }
    }

    /// The linear colour of a lane.
    pub fn colour(&self, lane: usize) -> Vec3 {
        Vec3::new(self.colour[0][lane], self.colour[1][lane], self.colour[2][lane])
    }
}

/// Light that bounced inside the skin comes out redder and past the edge of the shadow.
const WRAP: [f32; 3] = [0.34, 0.20, 0.14];

/// Shades all panes. Every loop over them is without branches, so that it becomes vector instructions.
#[multiversion::multiversion(targets("x86_64+avx2"))]
fn shine(lamps: &[Beam; LAMPS.len()], v: [f32; 3], up: [f32; 3], panes: &mut Panes) {
    const N: usize = Panes::COUNT;
    let Panes { normal: [nx, ny, nz], albedo, sharpness, gloss, open, hair, head, colour } = panes;
    let (mut seen, mut fresnel) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        // Light that hair and skin throw at each other keeps a face readable between curtains of hair.
        seen[i] = 0.16 + 0.24 * open[i].max(0.0).sqrt() + 0.60 * open[i];
        let facing = nx[i] * v[0] + ny[i] * v[1] + nz[i] * v[2];
        fresnel[i] = (0.03 + 0.5 * fast::exp(-6.0 * facing.max(0.0))) * gloss[i];
    }
    for k in 0..3 {
        let sky = SKY.to_array()[k];
        for i in 0..N {
            let above = nx[i] * up[0] + ny[i] * up[1] + nz[i] * up[2];
            colour[k][i] = albedo[k][i] * sky * (seen[i] * (0.66 + 0.30 * above));
        }
    }
    for (lamp, hair) in lamps.iter().zip(hair) {
        let (l, h) = (lamp.toward, lamp.half);
        let (mut facing, mut reach, mut highlight) = ([0.0; N], [0.0; N], [0.0; N]);
        for i in 0..N {
            facing[i] = nx[i] * l[0] + ny[i] * l[1] + nz[i] * l[2];
            let past_hair = 0.14 + 0.86 * if lamp.hair { hair[i] } else { seen[i] };
            let past_head = if lamp.head { head[i] } else { 1.0 };
            reach[i] = if facing[i] > UNLIT { past_hair * past_head } else { 0.0 };
            let near = (nx[i] * h[0] + ny[i] * h[1] + nz[i] * h[2]).max(0.0);
            let lit = (facing[i] * 4.0).clamp(0.0, 1.0);
            highlight[i] = fast::exp(-(1.0 - near) * sharpness[i]) * fresnel[i] * reach[i] * lit;
        }
        for k in 0..3 {
            // Red reaches farther into shadows.
            let deep = if k == 0 { 0.35 } else { 0.0 };
            let (wrap, share) = (WRAP[k], 1.0 / (1.0 + WRAP[k]));
            for i in 0..N {
                let soft = ((facing[i] + wrap) * share).max(0.0);
                let part = reach[i].max(0.0).sqrt() * deep + reach[i] * (1.0 - deep);
                colour[k][i] += lamp.colour[k] * (albedo[k][i] * soft * soft.sqrt() * part * 0.60 + highlight[i]);
            }
        }
    }
    for channel in colour {
        for c in channel {
            *c = bend(*c);
        }
    }
}

/// Pieces of strands that are shaded side by side, each number of theirs apart, so that one instruction serves many.
#[derive(Clone, Debug)]
pub struct Lanes {
    /// Where, cm.
    point: [[f32; Self::COUNT]; 3],
    /// Unit tangent from root to tip.
    tangent: [[f32; Self::COUNT]; 3],
    albedo: [[f32; Self::COUNT]; 3],
    shift: [f32; Self::COUNT],
    glint: [f32; Self::COUNT],
    /// What [`Lights`] says of the place.
    reach: [[f32; Self::COUNT]; 4],
    /// Linear.
    colour: [[f32; Self::COUNT]; 3],
}

impl Default for Lanes {
    fn default() -> Self {
        let (zero, zero3) = ([0.0; Self::COUNT], [[0.0; Self::COUNT]; 3]);
        let reach = [zero; 4];
        Self { point: zero3, tangent: zero3, albedo: zero3, shift: zero, glint: zero, reach, colour: zero3 }
    }
}

impl Lanes {
    /// How many there are.
    pub const COUNT: usize = 16;

    /// Puts a piece of `strand` into a lane: its place, its unit tangent (root to tip), how far along it is.
    pub fn set(&mut self, lane: usize, point: Vec3, tangent: Vec3, coat: &Coat, strand: &StrandLook, along: f32) {
        let albedo = (coat.root + (coat.tip - coat.root) * along) * strand.tint;
        for k in 0..3 {
            self.point[k][lane] = point[k];
            self.tangent[k][lane] = tangent[k];
            self.albedo[k][lane] = albedo[k];
        }
        self.shift[lane] = strand.shift;
        self.glint[lane] = strand.glint;
    }

    /// The linear colour of a lane.
    pub fn colour(&self, lane: usize) -> Vec3 {
        Vec3::new(self.colour[0][lane], self.colour[1][lane], self.colour[2][lane])
    }
}

/// Direction to a lamp, its colour, and which of the reaches is its own.
type Ray = ([f32; 3], [f32; 3], usize);

/// Shades all lanes. Every loop over them is without branches, so that it becomes vector instructions.
#[multiversion::multiversion(targets("x86_64+avx2"))]
fn answer(lamps: &[Ray; LAMPS.len()], v: [f32; 3], up: [f32; 3], shine: f32, width: f32, lanes: &mut Lanes) {
    const N: usize = Lanes::COUNT;
    let Lanes { tangent: [tx, ty, tz], albedo, shift, glint, reach: reaches, colour, .. } = lanes;
    let [primary, secondary, through] = [1.0, 1.7, 2.4].map(|wider| 1.0 / (wider * width));
    let (mut tv, mut across, mut glow, mut mix) = ([0.0; N], [[0.0; N]; 3], [[0.0; N]; 3], [[0.0; N]; 3]);
    for i in 0..N {
        tv[i] = tx[i] * v[0] + ty[i] * v[1] + tz[i] * v[2];
        // The strand's normal that faces the viewer.
        let turn = 1.0 / (1.0 - tv[i] * tv[i]).max(1e-9).sqrt();
        across[0][i] = (v[0] - tx[i] * tv[i]) * turn;
        across[1][i] = (v[1] - ty[i] * tv[i]) * turn;
        across[2][i] = (v[2] - tz[i] * tv[i]) * turn;
    }
    let open = &reaches[0];
    for k in 0..3 {
        let sky = SKY.to_array()[k];
        for i in 0..N {
            // Light that went through hair took on its colour; blond scatters more of it on than black. So what reaches
            // a place is raised to a power between 1 and 1/4, here by the way between the two.
            glow[k][i] = albedo[k][i].sqrt();
            mix[k][i] = ((1.0 - (glow[k][i] * 0.75).min(0.62) - 0.25) * (1.0 / 0.75)).max(0.0);
            let quarter = open[i].max(0.0).sqrt().sqrt();
            let deep = quarter + (open[i] - quarter) * mix[k][i];
            let above = across[0][i] * up[0] + across[1][i] * up[1] + across[2][i] * up[2];
            colour[k][i] = albedo[k][i] * deep * sky * (0.75 + 0.25 * above);
        }
    }
    for (l, light, reach) in lamps {
        let reach = &reaches[*reach];
        let (mut soft, mut plain, mut tinted, mut twice) = ([0.0; N], [0.0; N], [0.0; N], [0.0; N]);
        let mut quarter = [0.0; N];
        for i in 0..N {
            let tl = tx[i] * l[0] + ty[i] * l[1] + tz[i] * l[2];
            let sin_tl = (1.0 - tl * tl).max(0.0).sqrt();
            let facing = across[0][i] * l[0] + across[1][i] * l[1] + across[2][i] * l[2];
            soft[i] = sin_tl * (0.45 + 0.35 * facing);
            quarter[i] = reach[i].max(0.0).sqrt().sqrt();
            // Azimuth between lamp and viewer about the strand.
            let cos_phi = facing / sin_tl.max(1e-4);
            let half = (0.5 + 0.5 * cos_phi).max(0.0).sqrt();
            let off = tl + tv[i] - shift[i];
            let (a, b, c) = ((off - 0.09) * primary, (off + 0.14) * secondary, off * through);
            let bright = 0.30 * shine * reach[i] * glint[i] * half;
            plain[i] = fast::exp(-0.5 * a * a) * bright;
            tinted[i] = fast::exp(-0.5 * b * b) * bright * half;
            twice[i] = fast::exp(-0.5 * c * c - 3.65 * cos_phi - 3.98) * 0.9 * shine * reach[i];
        }
        for k in 0..3 {
            for i in 0..N {
                let deep = quarter[i] + (reach[i] - quarter[i]) * mix[k][i];
                let highlight = plain[i] + glow[k][i] * (tinted[i] + albedo[k][i] * twice[i]);
                colour[k][i] += light[k] * (albedo[k][i] * deep * soft[i] + highlight);
            }
        }
    }
    for channel in colour {
        for c in channel {
            *c = bend(*c);
        }
    }
}

/// Keeps values up to 0.6 and bends the rest softly below 1.
#[inline(always)]
fn bend(x: f32) -> f32 {
    let bent = 1.0 - 0.4 * fast::exp((0.6 - x) * 2.5);
    if x <= 0.6 { x } else { bent }
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
}

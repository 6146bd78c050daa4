//! Materials, views, backgrounds.

use crate::math::Colour;

crate::choices! {
    /// A direction to look from; all views are orthographic.
    pub enum View {
        /// From +Z, at the face.
        Front = "front",
        /// From -Z, at the back of the head.
        Back = "back",
        /// From +X: the head's left side.
        Left = "left",
        /// From -X: the head's right side.
        Right = "right",
        /// From +Y, the face towards the lower border.
        Top = "top",
        /// From the front left and a little above.
        ThreeQuarter = "three-quarter",
        /// From the back left and a little above.
        BackThreeQuarter = "back-three-quarter",
    }
}

crate::choices! {
    /// The colour behind everything.
    pub enum Background {
        /// White paper.
        White = "white",
        /// Near black.
        Dark = "dark",
    }
}

crate::choices! {
    /// How surfaces and light are drawn.
    pub enum Shading {
        /// As in a photograph: lamps, shadows, soft skin.
        Soft = "soft",
        /// As in a cartoon: flat tones, a band of light, ink lines.
        Toon = "toon",
    }
}

/// How the preview is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The colour behind everything.
    pub background: Background,
    /// How surfaces and light are drawn.
    pub shading: Shading,
    /// Draw domains, guides, partings and roots instead of the hair.
    pub debug: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self { background: Background::White, shading: Shading::Soft, debug: false }
    }
}

/// How a surface looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshMaterial {
    /// Base colour.
    pub colour: Colour,
    /// 0 mirror to 1 chalk.
    pub roughness: f32,
}

impl Default for MeshMaterial {
    fn default() -> Self {
        Self { colour: Colour::hex(0xd9_b8_a3), roughness: 0.6 }
    }
}

crate::params! {
    /// How hair looks: colours, width, shine.
    #[derive(PartialEq)]
    pub struct HairMaterial("coif.material.hair") {
        /// Colour at the root.
        root_colour: Colour = Colour::hex(0x2e_1b_12);
        /// Colour at the tip.
        tip_colour: Colour = Colour::hex(0x6b_43_2b);
        /// How far single strands differ in brightness: 0 all alike, 1 from black to white.
        variation: f32 = 0.15, range(0.0, 1.0);
        /// Diameter at the root; real hair has 0.006 to 0.01, a preview with fewer strands wants more.
        width: f32 = 0.02, unit("cm"), range(0.0005, 1.0);
        /// Diameter at the tip as a fraction of `width`.
        taper: f32 = 0.3, range(0.0, 1.0);
        /// Strength of the highlight: 0 dull, 1 glossy.
        shine: f32 = 0.5, range(0.0, 1.0);
        /// Width of the highlight: 0 a thin line, 1 broad and soft.
        roughness: f32 = 0.4, range(0.0, 1.0);
    }
}

impl Default for HairMaterial {
    fn default() -> Self {
        crate::params::read::<Self>(&crate::params::Table::default()).expect("every field has a default")
    }
}

crate::params! {
    /// How stylised hair looks: its colours and its band of light.
    #[derive(PartialEq)]
    pub struct TuftMaterial("coif.material.tuft") {
        /// Colour in the light.
        colour: Colour = Colour::hex(0x6b_43_2b);
        /// Colour towards the tip; `colour` when left out.
        tip_colour: Option<Colour>;
        /// Colour in the shade, of toon shading; a darker `colour` when left out.
        shade: Option<Colour>;
        /// Colour of the band of light, of toon shading; a lighter `colour` when left out.
        light: Option<Colour>;
        /// Colour of the outline, of toon shading; a very dark `colour` when left out.
        ink: Option<Colour>;
        /// Number of flat tones of toon shading: 2 for light and shade, 3 for a darker one in the depth too.
        tones: u32 = 2, range(2.0, 3.0);
        /// Width and strength of the light: 0 none, 1 much.
        shine: f32 = 0.5, range(0.0, 1.0);
        /// 0 mirror to 1 chalk, of soft shading and exported files.
        roughness: f32 = 0.5, range(0.0, 1.0);
    }
}

impl Default for TuftMaterial {
    fn default() -> Self {
        crate::params::read::<Self>(&crate::params::Table::default()).expect("every field has a default")
    }
}

impl TuftMaterial {
    /// The linear colour at a place along a lock: 0 root, 1 tip.
    pub fn along(&self, t: f32) -> glam::Vec3 {
        let root = self.colour.to_linear();
        match self.tip_colour {
            Some(tip) => root.lerp(tip.to_linear(), crate::math::trig::smoothstep(0.25, 0.95, t)),
            None => root,
        }
    }
}

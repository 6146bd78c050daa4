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

/// How the preview is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The colour behind everything.
    pub background: Background,
    /// Draw domains, guides, partings and roots instead of the hair.
    pub debug: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self { background: Background::White, debug: false }
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

//! How hair and skin look in a glTF file.

use glam::Vec3;

use super::document::{
    Anisotropy, Document, Extras, HairExtras, Image, Material, MaterialExtensions, Pbr, Sampler, Texture, TextureInfo,
    Unlit,
};
use crate::export::appearance;
use crate::math::Colour;
use crate::scene::{HairMaterial, Locks, MeshMaterial};

/// Texels of the ramp from root to tip.
const RAMP: usize = 64;
const LINEAR: u32 = 9729;
const CLAMP: u32 = 33071;

/// The material of a surface; its index.
pub fn surface(document: &mut Document, name: &str, look: &MeshMaterial, is_double_sided: bool) -> u32 {
    push(
        document,
        Material {
            name: name.to_owned(),
            pbr_metallic_roughness: Pbr {
                base_color_factor: factor(look.colour),
                base_color_texture: None,
                metallic_factor: 0.0,
                roughness_factor: look.roughness.clamp(0.0, 1.0),
            },
            double_sided: is_double_sided,
            extensions: None,
            extras: None,
        },
    )
}

/// The material of stylised hair, whose vertices have its colours; its index.
pub fn locks(document: &mut Document, name: &str, locks: &Locks) -> u32 {
    push(
        document,
        Material {
            name: name.to_owned(),
            pbr_metallic_roughness: Pbr {
                base_color_factor: [1.0; 4],
                base_color_texture: None,
                metallic_factor: 0.0,
                roughness_factor: locks.look(0).roughness.clamp(0.0, 1.0),
            },
            double_sided: false,
            extensions: None,
            extras: None,
        },
    )
}

/// The material of ribbons, with the picture in `image` (a buffer view) as colour along v; its index.
///
/// The colours from root to tip are a picture and not a vertex colour, because every program keeps a picture; the vertex
/// colour has only what differs from strand to strand.
pub fn ribbons(document: &mut Document, name: &str, look: &HairMaterial, image: u32) -> u32 {
    extension(document, "KHR_materials_anisotropy");
    if document.samplers.is_empty() {
        document.samplers.push(Sampler { mag_filter: LINEAR, min_filter: LINEAR, wrap_s: CLAMP, wrap_t: CLAMP });
    }
    document.images.push(Image { name: format!("{name} ramp"), buffer_view: image, mime_type: "image/png" });
    document.textures.push(Texture { sampler: 0, source: document.images.len() as u32 - 1 });
    let texture = document.textures.len() as u32 - 1;
    push(
        document,
        Material {
            name: name.to_owned(),
            pbr_metallic_roughness: Pbr {
                base_color_factor: [1.0; 4],
                base_color_texture: Some(TextureInfo { index: texture }),
                metallic_factor: 0.0,
                roughness_factor: look.roughness.clamp(0.0, 1.0),
            },
            double_sided: true,
            extensions: Some(MaterialExtensions {
                anisotropy: Some(Anisotropy {
                    anisotropy_strength: look.shine.clamp(0.0, 1.0),
                    // The extension blurs along the direction it is given; hair blurs across the strand, and the
                    // tangents run along it.
                    anisotropy_rotation: std::f32::consts::FRAC_PI_2,
                }),
                unlit: None,
            }),
            extras: Some(extras(look)),
        },
    )
}

/// The material of lines: their vertex colour as it is, for without normals nothing can be lit; its index.
pub fn lines(document: &mut Document, name: &str, look: &HairMaterial) -> u32 {
    extension(document, "KHR_materials_unlit");
    push(
        document,
        Material {
            name: name.to_owned(),
            pbr_metallic_roughness: Pbr {
                base_color_factor: [1.0; 4],
                base_color_texture: None,
                metallic_factor: 0.0,
                roughness_factor: 1.0,
            },
            double_sided: false,
            extensions: Some(MaterialExtensions { anisotropy: None, unlit: Some(Unlit {}) }),
            extras: Some(extras(look)),
        },
    )
}

/// The picture of the ramp, root in the first row: a PNG brighter by the variation, so that vertex colours, which can
/// only darken, give the stated colours on average.
pub fn ramp_png(look: &HairMaterial) -> Vec<u8> {
    let mut pixels = Vec::with_capacity(RAMP * 2 * 3);
    for row in 0..RAMP {
        let linear = appearance::ramp(look, (row as f32 + 0.5) / RAMP as f32) * appearance::brightest(look);
        let colour = Colour::from_linear(linear);
        let texel = [colour.r, colour.g, colour.b].map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
        pixels.extend_from_slice(&texel);
        pixels.extend_from_slice(&texel);
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, RAMP as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
    debug_assert!(written.is_ok(), "a vector takes every byte");
    bytes
}

fn factor(colour: Colour) -> [f32; 4] {
    let c = colour.to_linear().clamp(Vec3::ZERO, Vec3::ONE);
    [c.x, c.y, c.z, 1.0]
}

fn extras(look: &HairMaterial) -> Extras<HairExtras> {
    Extras {
        coif: HairExtras {
            root_colour: look.root_colour.to_string(),
            tip_colour: look.tip_colour.to_string(),
            variation: look.variation,
            width_cm: look.width,
            taper: look.taper,
        },
    }
}

fn extension(document: &mut Document, name: &'static str) {
    if !document.extensions_used.contains(&name) {
        document.extensions_used.push(name);
    }
}

fn push(document: &mut Document, material: Material) -> u32 {
    document.materials.push(material);
    document.materials.len() as u32 - 1
}

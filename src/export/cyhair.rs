//! `.hair`, the format of Cem Yuksel's hair models (<http://www.cemyuksel.com/research/hairmodels/>): strands alone, with
//! thickness and colour per node.
//!
//! A header of 128 bytes, then arrays one after the other, all little-endian: segments per strand (16 bits), nodes,
//! thickness, colours. Coif writes centimetres, Y up, in the space of the head's own file; the thickness is the diameter
//! and the colours are linear. All parts that are hair come one after the other.

use crate::geometry::Strands;
use crate::scene::{HairMaterial, Scene};
use crate::task::Task;

use super::reduce::{Block, reduce};
use super::{ExportError, appearance, check_hair, check_tolerance};

/// Bytes of the header.
const HEADER: usize = 128;
/// Segments per strand and nodes, thickness, colours are there; transparency is not.
const ARRAYS: u32 = 1 | 2 | 4 | 16;
/// Bytes per node: place, thickness, colour.
const NODE: u64 = 12 + 4 + 12;

crate::params! {
    /// How a scene is written as `.hair`.
    #[derive(PartialEq)]
    pub struct CyHairOptions("coif.export.hair") {
        /// No point of a strand is farther than this from what is written of it; 0 keeps every bend.
        tolerance: f32 = 0.0, unit("cm"), range(0.0, 10.0);
        /// A larger file is refused.
        max_bytes: u64 = 4_294_967_295, unit("bytes"), range(0.0, 1e12);
    }
}

impl Default for CyHairOptions {
    fn default() -> Self {
        Self { tolerance: 0.0, max_bytes: 4_294_967_295 }
    }
}

/// The strands of a scene as a `.hair` file; a scene without hair gives a file without strands.
///
/// # Errors
/// [`ExportError`]: not finite, indices out of range, more than 65535 segments in a strand, too large, cancelled.
pub fn cyhair(scene: &Scene, options: &CyHairOptions, task: &Task) -> Result<Vec<u8>, ExportError> {
    check_tolerance(options.tolerance)?;
    if !scene.placement.is_finite() {
        return Err(ExportError::Placement { placement: scene.placement });
    }
    let mut parts: Vec<(&Strands, &HairMaterial, Vec<Block>)> = Vec::new();
    for (part, hair) in scene.hair() {
        check_hair(part, hair)?;
        let blocks = reduce(&hair.strands, &[], options.tolerance, task)?;
        let limit = usize::from(u16::MAX);
        for (strand, nodes) in blocks.iter().flat_map(Block::strands) {
            if nodes.len() - 1 > limit {
                let (part, segments) = (part.name.clone(), nodes.len() - 1);
                return Err(ExportError::TooManySegments { part, strand, segments, limit });
            }
        }
        parts.push((&hair.strands, &hair.material, blocks));
    }
    let strands: u64 = parts.iter().map(|(s, ..)| s.count() as u64).sum();
    let nodes: u64 = parts.iter().flat_map(|(.., blocks)| blocks).map(|b| b.nodes.len() as u64).sum();
    let bytes = HEADER as u64 + 2 * strands + NODE * nodes;
    if bytes > options.max_bytes || strands.max(nodes) > u64::from(u32::MAX) {
        return Err(ExportError::TooLarge { bytes, limit: options.max_bytes });
    }

    let mut file = header(scene, strands as u32, nodes as u32);
    file.reserve_exact((bytes - HEADER as u64) as usize);
    let all = || {
        parts.iter().flat_map(|(strands, look, blocks)| {
            blocks.iter().flat_map(Block::strands).map(move |(i, nodes)| (*strands, *look, i, nodes))
        })
    };
    for (.., nodes) in all() {
        file.extend_from_slice(&((nodes.len() - 1) as u16).to_le_bytes());
    }
    let floats = |file: &mut Vec<u8>, numbers: &[f32]| {
        for x in numbers {
            file.extend_from_slice(&x.to_le_bytes());
        }
    };
    for (strands, _, _, nodes) in all() {
        task.check()?;
        for &n in nodes {
            floats(&mut file, &scene.placement.transform_point3(strands.points[n as usize]).to_array());
        }
    }
    task.progress("writing hair", 0.4);
    let points = |strands: &Strands, nodes: &[u32]| -> Vec<glam::Vec3> {
        nodes.iter().map(|&n| strands.points[n as usize]).collect()
    };
    for (strands, look, _, nodes) in all() {
        task.check()?;
        for v in appearance::shares(points(strands, nodes).into_iter()) {
            floats(&mut file, &[appearance::width(look, v)]);
        }
    }
    task.progress("writing hair", 0.6);
    for (strands, look, i, nodes) in all() {
        task.check()?;
        let brightness = appearance::brightness(look, strands.roots[i].id);
        let (root, tip) = (appearance::ramp(look, 0.0) * brightness, appearance::ramp(look, 1.0) * brightness);
        for v in appearance::shares(points(strands, nodes).into_iter()) {
            floats(&mut file, &root.lerp(tip, v).to_array());
        }
    }
    task.progress("writing hair", 1.0);
    debug_assert_eq!(file.len() as u64, bytes);
    Ok(file)
}

fn header(scene: &Scene, strands: u32, nodes: u32) -> Vec<u8> {
    let mut header = Vec::with_capacity(HEADER);
    header.extend_from_slice(b"HAIR");
    // Defaults, which do not count where there are arrays: segments, thickness, transparency, colour.
    for n in [strands, nodes, ARRAYS, 0] {
        header.extend_from_slice(&n.to_le_bytes());
    }
    for x in [1.0_f32, 0.0, 1.0, 1.0, 1.0] {
        header.extend_from_slice(&x.to_le_bytes());
    }
    let info = format!("coif {}: {}", env!("CARGO_PKG_VERSION"), scene.name);
    // The text ends with a zero, so one byte fewer than there are.
    header.extend(info.bytes().take(HEADER - header.len() - 1));
    header.resize(HEADER, 0);
    header
}

//! Skinned meshes as the file rests.
//!
//! Each vertex goes where the blend of its joints takes it with the nodes as they stand in the file, as every viewer
//! shows it (glTF 2.0, 3.7.3.3). In a file that rests in its bind pose this *is* the bind pose; and a scale or turn
//! that an exporter left on the skeleton's root is followed rightly, which the stored places alone would miss.

use glam::{DMat4, DVec3, Vec3};

use super::gltf::{Buffers, PrimitivePath, matrices};
use super::guard::problem;
use super::{GltfProblem, LoadError};

/// The joints' transforms from the mesh as stored to the scene.
pub(super) fn joints(skin: &gltf::Skin<'_>, globals: &[DMat4], buffers: &Buffers) -> Vec<DMat4> {
    let binds = skin.inverse_bind_matrices().map(|a| matrices(&a, buffers)).unwrap_or_default();
    skin.joints()
        .enumerate()
        .map(|(j, node)| globals[node.index()] * binds.get(j).copied().unwrap_or(DMat4::IDENTITY))
        .collect()
}

/// One blended transform per vertex; `None` where the primitive has no joints or no weights.
pub(super) fn blend(
    primitive: &gltf::Primitive<'_>,
    joints: &[DMat4],
    buffers: &Buffers,
    path: PrimitivePath,
) -> Result<Option<Vec<DMat4>>, LoadError> {
    let reader = primitive.reader(|buffer| buffers.get(&buffer));
    let mut sums: Vec<(f64, DMat4)> = Vec::new();
    for set in 0..4 {
        let (Some(indices), Some(weights)) = (reader.read_joints(set), reader.read_weights(set)) else { break };
        for (v, (indices, weights)) in indices.into_u16().zip(weights.into_f32()).enumerate() {
            if v == sums.len() {
                sums.push((0.0, DMat4::ZERO));
            }
            for (joint, weight) in indices.into_iter().zip(weights).filter(|&(_, w)| w > 0.0 && w.is_finite()) {
                let Some(&transform) = joints.get(usize::from(joint)) else {
                    let (index, count) = (u64::from(joint), joints.len() as u64);
                    let at = format!("{path}.attributes.JOINTS_{set}");
                    return Err(problem(at, GltfProblem::OutOfRange { what: "joint", index, count }));
                };
                let sum = &mut sums[v];
                *sum = (sum.0 + f64::from(weight), sum.1 + transform * f64::from(weight));
            }
        }
    }
    if sums.is_empty() || joints.is_empty() {
        return Ok(None);
    }
    // A vertex without any weight goes with the first joint.
    Ok(Some(sums.into_iter().map(|(w, m)| if w > 0.0 { m * w.recip() } else { joints[0] }).collect()))
}

/// A normal under a transform: by the inverse transpose, up to length.
pub(super) fn normal(transform: &DMat4, normal: Vec3) -> Vec3 {
    let [x, y, z] = [transform.x_axis, transform.y_axis, transform.z_axis].map(glam::DVec4::truncate);
    // The cofactors: the inverse transpose times the determinant, also where there is no inverse.
    let cofactors = glam::DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let turned: DVec3 = cofactors * normal.as_dvec3() * x.dot(y.cross(z)).signum();
    turned.normalize_or_zero().as_vec3()
}

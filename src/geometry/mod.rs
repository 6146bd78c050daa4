//! Geometry values and the queries on them: meshes, strands, curves, frames, trees, solids, sampling.
//!
//! Right-handed, Y up, the face looks to +Z and the head's left is +X; centimetres and radians.

pub mod bounds;
pub mod bvh;
mod cells;
pub mod clear;
pub mod clip;
pub mod curtain;
pub mod curve;
pub mod ease;
pub mod frames;
pub mod measure;
pub mod mesh;
pub mod obox;
pub mod polygon;
pub mod sample;
pub mod slice;
pub mod slide;
pub mod solid;
pub mod strands;

pub use bounds::Bounds;
pub use bvh::{Bvh, Closest, Hit};
pub use cells::Vicinity;
pub use clear::Clear;
pub use clip::Clip;
pub use curtain::Curtain;
pub use ease::Ease;
pub use mesh::{Group, Mesh, MeshError};
pub use obox::OrientedBox;
pub use solid::{Solid, SolidError, SurfacePoint};
pub use strands::{Root, Strands, StrandsError};

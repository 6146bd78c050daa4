//! What the debug view draws over the head.

use glam::{Mat3, Vec3};

use crate::math::Colour;

/// Wire shapes, lines and points, all in head space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Oriented boxes: directional and natural domains, regions.
    pub boxes: Vec<WireBox>,
    /// Spheres: cores of gather domains.
    pub spheres: Vec<WireSphere>,
    /// Arrows: directions of domains.
    pub arrows: Vec<Arrow>,
    /// Polylines: partings.
    pub lines: Vec<Line>,
    /// Points: roots, landmarks.
    pub markers: Vec<Marker>,
}

/// An oriented box.
#[derive(Clone, Debug, PartialEq)]
pub struct WireBox {
    /// Middle.
    pub centre: Vec3,
    /// Columns: unit axes.
    pub axes: Mat3,
    /// Half edge lengths.
    pub half: Vec3,
    /// Line colour.
    pub colour: Colour,
    /// Text drawn beside it.
    pub label: String,
}

/// A sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct WireSphere {
    /// Middle.
    pub centre: Vec3,
    /// Radius.
    pub radius: f32,
    /// Line colour.
    pub colour: Colour,
    /// Text drawn beside it.
    pub label: String,
}

/// An arrow.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrow {
    /// Tail.
    pub from: Vec3,
    /// Head.
    pub to: Vec3,
    /// Line colour.
    pub colour: Colour,
}

/// A polyline.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its points.
    pub points: Vec<Vec3>,
    /// Line colour.
    pub colour: Colour,
}

/// A point.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Where.
    pub position: Vec3,
    /// Fill colour.
    pub colour: Colour,
    /// Text drawn beside it; may be empty.
    pub label: String,
}

impl Overlay {
    /// Appends everything of another overlay.
    pub fn extend(&mut self, other: &Self) {
        self.boxes.extend_from_slice(&other.boxes);
        self.spheres.extend_from_slice(&other.spheres);
        self.arrows.extend_from_slice(&other.arrows);
        self.lines.extend_from_slice(&other.lines);
        self.markers.extend_from_slice(&other.markers);
    }
}

//! What the debug view draws over the head, and the words that every picture shows.

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
    /// Polylines: partings, tapes.
    pub lines: Vec<Line>,
    /// Thin polylines: lattices.
    pub thin: Vec<Line>,
    /// Points: roots, landmarks.
    pub markers: Vec<Marker>,
    /// Words that every picture shows, not only the debug view: what tapes read.
    pub notes: Vec<Note>,
}

/// Words beside something.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// Points of it; the words stand beside the one that is farthest to the right in a picture.
    pub points: Vec<Vec3>,
    /// The words.
    pub text: String,
    /// Their colour.
    pub colour: Colour,
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
    /// Moves all of it.
    pub fn shift(&mut self, by: Vec3) {
        self.boxes.iter_mut().for_each(|b| b.centre += by);
        self.spheres.iter_mut().for_each(|s| s.centre += by);
        for arrow in &mut self.arrows {
            (arrow.from, arrow.to) = (arrow.from + by, arrow.to + by);
        }
        self.lines.iter_mut().chain(&mut self.thin).flat_map(|l| &mut l.points).for_each(|p| *p += by);
        self.markers.iter_mut().for_each(|m| m.position += by);
        self.notes.iter_mut().flat_map(|n| &mut n.points).for_each(|p| *p += by);
    }

    /// Appends everything of another overlay.
    pub fn extend(&mut self, other: &Self) {
        self.boxes.extend_from_slice(&other.boxes);
        self.spheres.extend_from_slice(&other.spheres);
        self.arrows.extend_from_slice(&other.arrows);
        self.lines.extend_from_slice(&other.lines);
        self.thin.extend_from_slice(&other.thin);
        self.markers.extend_from_slice(&other.markers);
        self.notes.extend_from_slice(&other.notes);
    }
}

//! Boxes as a script writes them.

use glam::{Mat3, Vec3};

use crate::geometry::OrientedBox;
use crate::math::trig;
use crate::params::{FieldType, Kind, Object, Params, Reader, Value};

crate::params! {
    /// A box: by its middle and edge lengths, or by two opposite corners.
    pub struct BoxOptions("coif.box") {
        /// Its middle; goes with `size`.
        centre: Option<Vec3>, unit("cm");
        /// Its edge lengths, each more than 0; goes with `centre`.
        size: Option<Vec3>, unit("cm");
        /// One corner; goes with `max`.
        min: Option<Vec3>, unit("cm");
        /// The opposite corner; goes with `min`.
        max: Option<Vec3>, unit("cm");
        /// Turns about its middle, about the x axis, then y, then z.
        rotation: Vec3 = Vec3::ZERO, unit("degrees");
    }
}

impl BoxOptions {
    /// The box, or what is wrong and what to do about it.
    ///
    /// # Errors
    /// The message and the hint.
    pub fn build(&self) -> Result<OrientedBox, (String, String)> {
        let b = match (self.centre, self.size, self.min, self.max) {
            (Some(centre), Some(size), None, None) => OrientedBox::aligned(centre, size),
            (None, None, Some(min), Some(max)) => OrientedBox::between(min, max),
            _ => {
                let hint = "write { centre = {x, y, z}, size = {x, y, z} } or { min = {x, y, z}, max = {x, y, z} }";
                return Err(("a box needs `centre` and `size`, or `min` and `max`".into(), hint.into()));
            }
        };
        if !b.is_valid() {
            let size = self.size.unwrap_or(b.half * 2.0);
            let hint = "every edge must be longer than 0, and finite";
            return Err((format!("a box of size `{size}` has no volume"), hint.into()));
        }
        let [x, y, z] = self.rotation.to_array().map(f32::to_radians);
        Ok(b.rotated(turn(2, z) * turn(1, y) * turn(0, x)))
    }
}

/// The rotation by `angle` radians about axis `k`.
fn turn(k: usize, angle: f32) -> Mat3 {
    let (s, c) = (trig::sin(angle), trig::cos(angle));
    match k {
        0 => Mat3::from_cols(Vec3::X, Vec3::new(0.0, c, s), Vec3::new(0.0, -s, c)),
        1 => Mat3::from_cols(Vec3::new(c, 0.0, -s), Vec3::Y, Vec3::new(s, 0.0, c)),
        _ => Mat3::from_cols(Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0), Vec3::Z),
    }
}

impl Object for OrientedBox {
    const NAME: &'static str = "Box";
}

impl FieldType for OrientedBox {
    fn kind() -> Kind {
        Kind::OneOf(vec![Kind::Object(Self::NAME), Kind::Struct(BoxOptions::NAME)])
    }
    fn read(value: &Value, reader: &mut Reader) -> Option<Self> {
        match value {
            Value::Handle(h) => match h.get::<Self>() {
                Some(b) => Some(*b),
                None => reader.wrong_type("a Box", value),
            },
            Value::Table(table) => match <BoxOptions as Params>::read(table, reader)?.build() {
                Ok(b) => Some(b),
                Err((message, hint)) => reader.problem(message, Some(hint)),
            },
            other => reader.wrong_type("a Box, or { centre = ..., size = ... }", other),
        }
    }
    fn show(&self) -> String {
        format!("{{ centre = {}, size = {} }}", self.centre.show(), (self.half * 2.0).show())
    }
}

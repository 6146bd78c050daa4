//! The natural hairline of a head.

use glam::Vec3;

use super::Head;

/// Control points of the hairline, once around: forehead, left side, nape, right side.
pub(super) fn outline(head: &Head) -> Vec<Vec3> {
    let marks = &head.landmarks;
    let left = side(head, 1.0);
    let mut right = side(head, -1.0);
    right.reverse();
    let mut points = vec![marks.forehead];
    points.extend(left);
    points.push(marks.nape);
    points.extend(right);
    points
}

/// From the forehead to the nape on the left (`sign` 1) or the right (-1). Distances are in heads (chin to vertex).
fn side(head: &Head, sign: f32) -> Vec<Vec3> {
    let marks = &head.landmarks;
    let height = marks.height();
    let (ear, temple, measured) = if sign > 0.0 {
        (marks.left_ear, marks.left_temple, &head.ears()[0])
    } else {
        (marks.right_ear, marks.right_temple, &head.ears()[1])
    };
    // Where no ear stands out there is still one to go around.
    let (top, bottom, front, back) = match measured {
        Some(e) => (e.top, e.bottom, e.front, e.back),
        None => (ear.y + 0.13 * height, ear.y - 0.13 * height, ear.z + 0.04 * height, ear.z - 0.11 * height),
    };
    let middle = (top + bottom) * 0.5;
    let forehead = marks.forehead;
    // Points seen from the front: (x, y); seen from the side: (y, z).
    let from_front = |x: f32, y: f32| {
        let origin = Vec3::new(sign * x, y, 2.0 * height);
        let z = head.solid.bvh().first_hit(origin, Vec3::NEG_Z, 2.0 * height).map(|h| h.position.z);
        Vec3::new(sign * x, y, z.unwrap_or((forehead.z + temple.z) * 0.5))
    };
    let from_side = |y: f32, z: f32| {
        let origin = Vec3::new(sign * 1.2 * height, y, z);
        let x = head.solid.bvh().first_hit(origin, Vec3::X * -sign, 1.2 * height).map(|h| h.position.x);
        Vec3::new(x.unwrap_or(ear.x), y, z)
    };
    let half = temple.x.abs();
    let neck = marks.nape.y;
    vec![
        from_front(0.35 * half, forehead.y + 0.004 * height),
        // The corner between forehead and temple recedes a little.
        from_front(0.70 * half, forehead.y + 0.008 * height),
        from_side((forehead.y + temple.y) * 0.5, temple.z - 0.01 * height),
        temple,
        from_side((temple.y + top) * 0.5, (temple.z + front) * 0.5 + 0.05 * height),
        // Sideburn.
        from_side(top, front + 0.075 * height),
        from_side(middle + 0.03 * height, front + 0.07 * height),
        from_side(middle - 0.01 * height, front + 0.03 * height),
        from_side(middle + 0.05 * height, front + 0.012 * height),
        // Over the ear and down behind it.
        from_side(top + 0.004 * height, front - 0.01 * height),
        from_side(top + 0.018 * height, (front + back) * 0.5),
        from_side(top - 0.02 * height, back - 0.012 * height),
        from_side(middle, back - 0.022 * height),
        from_side((middle + bottom) * 0.5, back - 0.03 * height),
        from_side((bottom + neck) * 0.5, back - 0.045 * height),
        // The neck.
        nape(head, sign, 0.62, 0.012),
        nape(head, sign, 0.30, 0.004),
    ]
}

/// A place on the back of the neck: a fraction of the way from the nape towards the neck's side.
fn nape(head: &Head, sign: f32, fraction: f32, up: f32) -> Vec3 {
    let marks = &head.landmarks;
    let height = marks.height();
    let y = marks.nape.y + up * height;
    let x = sign * fraction * 0.26 * height;
    let origin = Vec3::new(x, y, -2.0 * height);
    let z = head.solid.bvh().first_hit(origin, Vec3::Z, 2.0 * height).map(|h| h.position.z);
    Vec3::new(x, y, z.filter(|z| *z < 0.0).unwrap_or(marks.nape.z))
}

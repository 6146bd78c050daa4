//! What the debug view draws for the values of a script.

use std::sync::Arc;

use glam::Vec3;

use super::region::Area;
use crate::deform::{Cage, Lattice, Pins, PointKind, Warp};
use crate::dynamics::{Field, Force, Zone};
use crate::geometry::slice::Outline;
use crate::geometry::{OrientedBox, Root};
use crate::groom::{Domain, Queue};
use crate::math::Colour;
use crate::render::overlay::stage_colour;
use crate::scene::{Arrow, Line, Marker, Note, Overlay, WireBox, WireSphere};

/// Colour of partings.
const PARTING: Colour = Colour::hex(0xe0_3c_31);
/// Colour of natural domains, which are in no stage of the forces.
const NATURAL: Colour = Colour::hex(0x9a_5b_c2);
/// Colour of roots.
const ROOT: Colour = Colour::hex(0x5a_5f_69);
/// Colour of the grid of a lattice.
const GRID: Colour = Colour::hex(0x8d_93_9c);
/// Colour of tapes.
const TAPE: Colour = Colour::hex(0xb5_7a_00);
/// Colour of forces.
const FORCE: Colour = Colour::hex(0x1f_7a_8c);
/// Colour of what is pinned.
const PIN: Colour = Colour::hex(0x2f_80_3b);
/// Cages with more control points than this are drawn without their numbers.
const MOST_NUMBERS: usize = 60;
/// Length of arrows, cm.
const ARROW: f32 = 4.0;

/// The partings of a region.
pub fn area(area: &Area) -> Overlay {
    let line = |points: &[Vec3]| Line { points: points.to_vec(), colour: PARTING };
    Overlay { lines: area.partings.iter().map(|p| line(p.curtain.line())).collect(), ..Overlay::default() }
}

/// Points where strands grow.
pub fn roots(roots: &[Root]) -> Overlay {
    let marker = |r: &Root| Marker { position: r.position, colour: ROOT, label: String::new() };
    Overlay { markers: roots.iter().map(marker).collect(), ..Overlay::default() }
}

/// The domains of a queue, coloured as the guides that they bend; its first stage has number `before` + 1.
pub fn queue(queue: &Queue, before: usize) -> Overlay {
    let mut out = Overlay::default();
    for (k, stage) in queue.stages().iter().enumerate() {
        let colour = stage_colour(u8::try_from(before + k + 1).unwrap_or(u8::MAX));
        for &index in &stage.domains {
            let domain = &queue.domains()[index];
            let label = label(domain, index);
            match &**domain {
                Domain::Directional(d) => {
                    out.boxes.push(wire(&d.r#box, colour, label));
                    out.arrows.push(Arrow { from: d.r#box.centre, to: d.r#box.centre + d.direction.0 * ARROW, colour });
                }
                Domain::Gather(g) => {
                    out.spheres.push(WireSphere { centre: g.core, radius: g.core_radius, colour, label });
                    if let Some(p) = g.direction {
                        out.arrows.push(Arrow { from: g.core, to: g.core + p.0 * ARROW, colour });
                    }
                }
                Domain::Natural(n) => out.boxes.push(wire(&n.region, colour, label)),
            }
        }
    }
    out
}

/// Natural domains.
pub fn naturals(domains: &[Arc<Domain>]) -> Overlay {
    let boxes = domains.iter().enumerate().filter_map(|(i, d)| Some(wire(d.region()?, NATURAL, label(d, i)))).collect();
    Overlay { boxes, ..Overlay::default() }
}

/// Colour of a control point by what it is for.
fn kind_colour(kind: PointKind) -> Colour {
    Colour::hex(match kind {
        PointKind::Overall => 0x2f_7d_e1,
        PointKind::Feature => 0xe4_57_2e,
        PointKind::Fixed => 0x12_a1_79,
    })
}

/// A lattice as it stands: its grid, and its control points by kind.
pub fn lattice(lattice: &Lattice) -> Overlay {
    let mut out = Overlay::default();
    let last = lattice.divisions();
    for index in 0..lattice.count() {
        let at = lattice.indices(index);
        let position = lattice.place(index);
        for axis in 0..3 {
            let mut next = at;
            next[axis] += 1;
            if next[axis] <= last[axis] {
                let points = vec![position, lattice.place(lattice.index(next))];
                out.thin.push(Line { points, colour: GRID });
            }
        }
        out.markers.push(Marker { position, colour: kind_colour(lattice.kind(index)), label: String::new() });
    }
    held(lattice.held(), &mut out);
    out
}

/// A cage as it stands: its edges, and its control points by kind with their names or numbers.
pub fn cage(cage: &Cage) -> Overlay {
    let mut out = Overlay::default();
    for ring in cage.faces() {
        for (k, &a) in ring.iter().enumerate() {
            let b = ring[(k + 1) % ring.len()];
            // Every edge is in two faces, once in each direction.
            if a < b {
                let points = vec![cage.place(a as usize), cage.place(b as usize)];
                out.thin.push(Line { points, colour: GRID });
            }
        }
    }
    let is_told = cage.count() <= MOST_NUMBERS;
    for index in 0..cage.count() {
        let (position, colour) = (cage.place(index), kind_colour(cage.kind(index)));
        let number = || if is_told { (index + 1).to_string() } else { String::new() };
        let label = cage.name(index).map_or_else(number, ToOwned::to_owned);
        if position != cage.rest(index) {
            out.arrows.push(Arrow { from: cage.rest(index), to: position, colour });
        }
        out.markers.push(Marker { position, colour, label });
    }
    held(cage.held(), &mut out);
    out
}

/// A warp: where its points go and where they came from.
pub fn warp(warp: &Warp) -> Overlay {
    let mut out = Overlay::default();
    for &(from, to) in warp.pairs() {
        let colour = kind_colour(if from == to { PointKind::Fixed } else { PointKind::Feature });
        if from != to {
            out.arrows.push(Arrow { from, to, colour });
        }
        out.markers.push(Marker { position: to, colour, label: String::new() });
    }
    out
}

fn held(places: &[Vec3], out: &mut Overlay) {
    let colour = kind_colour(PointKind::Fixed);
    out.markers.extend(places.iter().map(|&position| Marker { position, colour, label: String::new() }));
}

/// Pins: where they go and where they came from, by kind.
pub fn pins(pins: &Pins) -> Overlay {
    let mut out = Overlay::default();
    for pin in pins.points() {
        let (colour, label) = (kind_colour(pin.kind), pin.name.clone().unwrap_or_default());
        if let Some(to) = pin.to {
            out.arrows.push(Arrow { from: pin.at, to, colour });
        }
        out.markers.push(Marker { position: pin.to.unwrap_or(pin.at), colour, label });
    }
    out
}

/// Forces and what is pinned.
pub fn forces(forces: &[Arc<Force>], pinned: &[Zone]) -> Overlay {
    let mut out = Overlay::default();
    let mut zone = |zone: &Zone, colour: Colour, label: String| match *zone {
        Zone::Box(b) => out.boxes.push(wire(&b, colour, label)),
        Zone::Ball { centre, radius } => out.spheres.push(WireSphere { centre, radius, colour, label }),
    };
    for pin in pinned {
        zone(pin, PIN, "pinned".into());
    }
    for (i, force) in forces.iter().enumerate() {
        if let Some(place) = &force.zone {
            zone(place, FORCE, force.label(i));
        }
    }
    for (i, force) in forces.iter().enumerate() {
        let label = if force.zone.is_some() { String::new() } else { force.label(i) };
        let (centre, radius, along) = match &force.field {
            // The earth is everywhere.
            Field::Gravity(_) | Field::Wind(_) => continue,
            Field::Attractor(o) => (o.centre, o.radius, None),
            Field::Repeller(o) => (o.centre, o.core, None),
            Field::Vortex(o) => (o.centre, o.core, Some(o.axis.0)),
        };
        out.spheres.push(WireSphere { centre, radius: radius.max(0.2), colour: FORCE, label });
        if let Some(axis) = along {
            out.arrows.push(Arrow { from: centre - axis * ARROW, to: centre + axis * ARROW, colour: FORCE });
        }
    }
    out
}

/// A tape around an outline, with what it reads.
pub fn tape(name: &str, outline: &Outline) -> Overlay {
    let height = outline.points.first().map_or(0.0, |p| p.y);
    let hull = outline.hull();
    let points: Vec<Vec3> = hull.iter().chain(hull.first()).map(|p| Vec3::new(p.x, height, p.y)).collect();
    let right = points.iter().copied().fold(Vec3::ZERO, |m, p| if p.x > m.x { p } else { m });
    let label = format!("{name} {:.1} cm", outline.tape());
    Overlay {
        lines: vec![Line { points, colour: TAPE }],
        markers: vec![Marker { position: right, colour: TAPE, label }],
        ..Overlay::default()
    }
}

/// What a tape reads, beside it.
pub fn reading(name: &str, outline: &Outline) -> Note {
    let height = outline.points.first().map_or(0.0, |p| p.y);
    let points = outline.hull().iter().map(|p| Vec3::new(p.x, height, p.y)).collect();
    Note { points, text: format!("{name} {:.1} cm", outline.tape()), colour: TAPE }
}

/// Shrinks boxes that reach far beyond everything that is drawn: their sides would lie outside of every view.
pub fn fit(overlay: &mut Overlay, around: crate::geometry::Bounds) {
    if around.is_empty() {
        return;
    }
    let near = around.grown(2.0);
    for b in &mut overlay.boxes {
        if b.axes != glam::Mat3::IDENTITY {
            continue;
        }
        let (lo, hi) = ((b.centre - b.half).max(near.min), (b.centre + b.half).min(near.max));
        if lo.cmplt(hi).all() {
            (b.centre, b.half) = ((lo + hi) * 0.5, (hi - lo) * 0.5);
        }
    }
    for arrow in &mut overlay.arrows {
        if !near.contains(arrow.from) {
            let moved = arrow.from.clamp(near.min, near.max);
            (arrow.from, arrow.to) = (moved, arrow.to + (moved - arrow.from));
        }
    }
}

fn label(domain: &Domain, index: usize) -> String {
    domain.name().map_or_else(|| format!("{} {}", domain.kind(), index + 1), ToOwned::to_owned)
}

fn wire(b: &OrientedBox, colour: Colour, label: String) -> WireBox {
    WireBox { centre: b.centre, axes: b.axes, half: b.half, colour, label }
}

//! Locks of stylised hair compared: tufts by their ids, caps, buns and rings as one lock each.

use std::collections::BTreeMap;

use glam::Vec3;
use rayon::prelude::*;

use super::{Change, Moved, PartChange, SAME, note};
use crate::math::Colour;
use crate::scene::{Locks, TuftMaterial};

/// Ids of all locks, in their order.
fn ids(locks: &Locks) -> Vec<u64> {
    if locks.tufts.count() == locks.count() {
        locks.tufts.tufts.iter().map(|t| t.id).collect()
    } else {
        (0..locks.count() as u64).collect()
    }
}

fn vertices(locks: &Locks, i: usize) -> &[Vec3] {
    let range = locks.mesh.vertices[i].clone();
    &locks.mesh.mesh.positions[range.start as usize..range.end as usize]
}

/// Locks of either that are not in the other as they are.
pub fn matched(old: Option<&Locks>, new: Option<&Locks>) -> Vec<Moved> {
    let index = |locks: Option<&Locks>| -> BTreeMap<u64, usize> {
        locks.map(|l| ids(l).into_iter().zip(0..).collect()).unwrap_or_default()
    };
    let (of_old, of_new) = (index(old), index(new));
    let kept: Vec<Option<Moved>> = of_old
        .par_iter()
        .map(|(id, &i)| match (of_new.get(id), old, new) {
            (Some(&j), Some(old), Some(new)) => {
                let (mean, most) = distance(vertices(old, i), vertices(new, j));
                (most > SAME).then_some(Moved { before: Some(i), after: Some(j), mean, most })
            }
            _ => Some(Moved { before: Some(i), after: None, mean: 0.0, most: 0.0 }),
        })
        .collect();
    let added = of_new.iter().filter(|(id, _)| !of_old.contains_key(id));
    let added = added.map(|(_, &j)| Moved { before: None, after: Some(j), mean: 0.0, most: 0.0 });
    kept.into_iter().flatten().chain(added).collect()
}

/// Mean and greatest distance between two surfaces' vertices: one by one, or each to the nearest of the other surface
/// when they are not as many.
fn distance(a: &[Vec3], b: &[Vec3]) -> (f32, f32) {
    let nearest =
        |p: &Vec3, of: &[Vec3]| of.iter().map(|q| p.distance_squared(*q)).fold(f32::INFINITY, f32::min).sqrt();
    let each: Vec<f32> = if a.len() == b.len() {
        a.iter().zip(b).map(|(p, q)| p.distance(*q)).collect()
    } else if a.is_empty() || b.is_empty() {
        vec![]
    } else {
        a.iter().map(|p| nearest(p, b)).chain(b.iter().map(|q| nearest(q, a))).collect()
    };
    (each.iter().sum::<f32>() / each.len().max(1) as f32, each.iter().copied().fold(0.0, f32::max))
}

/// Fills in the figures of a part of stylised hair.
pub fn summarise(change: &mut PartChange, old: Option<&Locks>, new: Option<&Locks>, locks: &[Moved]) {
    change.locks_before = old.map_or(0, Locks::count);
    change.locks_after = new.map_or(0, Locks::count);
    let first = |moved: &Moved| {
        let (locks, i) = (old?, moved.before?);
        vertices(locks, i).first().map(Vec3::to_array)
    };
    change.count(locks, first);
    if let (Some(a), Some(b)) = (old, new) {
        note(&mut change.other, "kind", a.kind.text(), b.kind.text());
        note(&mut change.material, "looks", a.palette.len(), b.palette.len());
        let several = a.palette.len() > 1;
        for (i, (p, q)) in a.palette.iter().zip(&b.palette).enumerate() {
            let of = if several { format!(" of look {}", i + 1) } else { String::new() };
            looks(&mut change.material, p, q, &of);
        }
        if a.palette == b.palette && a.count() == b.count() {
            let other = (0..a.count()).filter(|&i| a.look(i) != b.look(i)).count();
            if other > 0 {
                let what = format!("looks of {other} locks");
                change.material.push(Change { what, before: None, after: None });
            }
        }
    }
}

fn looks(changes: &mut Vec<Change>, a: &TuftMaterial, b: &TuftMaterial, of: &str) {
    let colour = |c: Option<Colour>| c.map_or_else(|| "none".to_owned(), |c| c.to_string());
    note(changes, &format!("colour{of}"), a.colour, b.colour);
    let all = [
        ("tip_colour", a.tip_colour, b.tip_colour),
        ("shade", a.shade, b.shade),
        ("light", a.light, b.light),
        ("ink", a.ink, b.ink),
    ];
    for (what, a, b) in all {
        note(changes, &format!("{what}{of}"), colour(a), colour(b));
    }
    note(changes, &format!("shine{of}"), a.shine, b.shine);
    note(changes, &format!("roughness{of}"), a.roughness, b.roughness);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_with_other_vertices_are_compared_by_the_nearest() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)];
        let up: Vec<Vec3> = square.iter().map(|p| *p + Vec3::Z * 2.0).collect();
        assert_eq!(distance(&square, &square), (0.0, 0.0));
        assert_eq!(distance(&square, &up), (2.0, 2.0));
        let (mean, most) = distance(&square, &up[..3]);
        assert!((mean - (12.0 + 5.0_f32.sqrt()) / 7.0).abs() < 1e-6 && (most - 5.0_f32.sqrt()).abs() < 1e-6);
        assert_eq!(distance(&square, &[]), (0.0, 0.0));
    }
}

//! The picture of a comparison: the first style, what changed, the second style.

use std::sync::Arc;

use super::{Changes, DiffOptions, Moved, Moves};
use crate::geometry::Strands;
use crate::math::Colour;
use crate::render::camera::{axes, frame};
use crate::render::{Cell, Picture, RenderError, contact, views};
use crate::scene::{Body, Hair, HairMaterial, Locks, Part, Scene, TuftMaterial, View};
use crate::task::Task;
use crate::tuft::{Tuft, Tufts};

/// Strands that only the first has.
const REMOVED: u32 = 0xd1_2f_3a;
/// Strands that only the second has.
const ADDED: u32 = 0x1f_9d_4d;
/// Strands that moved up to a tenth, up to a half, and up to all of the greatest distance.
const MOVED: [(f32, u32); 3] = [(0.1, 0xf2_c1_4e), (0.5, 0xf0_8a_24), (1.0, 0x8e_2d_c9)];
/// Strands that are as they were.
const SAME: u32 = 0xb8_bb_c0;

/// The three panels, with the same framing.
pub fn panels(
    options: &DiffOptions,
    before: &Scene,
    after: &Scene,
    changes: &Changes,
    moves: &[Moves],
    task: &Task,
) -> Result<Picture, RenderError> {
    let view = options.view.or(before.views.first().copied()).unwrap_or(View::Front);
    let changed = coloured(before, after, changes, moves);
    let mut all = before.clone();
    all.parts.extend(after.parts.iter().cloned());
    let sights = [axes(view)];
    let framing = frame(&all, &sights);
    let mut cells = vec![];
    let names = (before.name.clone(), after.name.clone());
    let captions = if names.0 == names.1 { ("before".into(), "after".into()) } else { names };
    for (scene, label) in [(before, captions.0), (&changed, "changes".into()), (after, captions.1)] {
        let drawn = views(scene, &sights, Some(&framing), &options.sheet, task)?;
        cells.extend(drawn.into_iter().map(|picture| Cell { picture, label: label.clone() }));
    }
    let (mut added, mut removed, mut moved) = (0, 0, 0);
    for part in &changes.parts {
        (added, removed, moved) = (added + part.added, removed + part.removed, moved + part.moved);
    }
    let mut about = format!("green {added} added · red {removed} removed · grey the same");
    if moved > 0 {
        let most = changes.parts.iter().map(|p| p.max_distance).fold(0.0, f32::max);
        let [(few, _), (half, _), _] = MOVED.map(|(fraction, colour)| (fraction * most, colour));
        about += &format!(" · {moved} moved: yellow to {few:.2} cm, orange to {half:.2}, violet to {most:.2}");
    }
    contact("what changed", &about, &cells, 3, before.look.background)
}

/// The second scene's head with all strands of both, coloured by what became of them.
fn coloured(before: &Scene, after: &Scene, changes: &Changes, moves: &[Moves]) -> Scene {
    let mut scene = after.clone();
    scene.look.background = before.look.background;
    scene.parts.retain(|p| matches!(p.body, Body::Mesh(..)));
    let most = changes.parts.iter().map(|p| p.max_distance).fold(0.0, f32::max);
    for of_part in moves {
        let hair = |s: &'_ Scene| {
            s.parts.iter().find(|p| p.name == of_part.part).and_then(|p| match &p.body {
                Body::Hair(hair) => Some(hair.clone()),
                Body::Mesh(..) | Body::Locks(_) => None,
            })
        };
        let locks = |s: &'_ Scene| {
            s.parts.iter().find(|p| p.name == of_part.part).and_then(|p| match &p.body {
                Body::Locks(locks) => Some(locks.clone()),
                Body::Mesh(..) | Body::Hair(_) => None,
            })
        };
        scene.parts.extend(coloured_locks(locks(before), locks(after), &of_part.strands, most));
        let (old, new) = (hair(before), hair(after));
        let look = new.as_ref().or(old.as_ref()).map(|h| h.material.clone()).unwrap_or_default();
        let mut add = |strands: Strands, colour: u32| {
            if strands.count() > 0 {
                scene.parts.push(part(strands, colour, &look));
            }
        };
        let strands = &of_part.strands;
        if let Some(old) = &old {
            let gone = strands.iter().filter(|m| m.after.is_none()).filter_map(|m| m.before);
            add(chosen(&old.strands, gone), REMOVED);
        }
        if let Some(new) = &new {
            let fresh = strands.iter().filter(|m| m.before.is_none()).filter_map(|m| m.after);
            add(chosen(&new.strands, fresh), ADDED);
            let mut least = -1.0;
            for (fraction, colour) in MOVED {
                let within = |m: &&Moved| m.before.is_some() && m.most > least * most && m.most <= fraction * most;
                add(chosen(&new.strands, strands.iter().filter(within).filter_map(|m| m.after)), colour);
                least = fraction;
            }
            let mut is_same = vec![true; new.strands.count()];
            strands.iter().filter_map(|m| m.after).for_each(|i| is_same[i] = false);
            add(chosen(&new.strands, (0..is_same.len()).filter(|&i| is_same[i])), SAME);
        }
    }
    scene
}

/// The locks of both, coloured by what became of them.
fn coloured_locks(old: Option<Locks>, new: Option<Locks>, moves: &[Moved], most: f32) -> Vec<Part> {
    let look = |colour: u32| TuftMaterial { colour: Colour::hex(colour), ..TuftMaterial::default() };
    let palette: Vec<TuftMaterial> =
        [SAME, REMOVED, ADDED].into_iter().chain(MOVED.map(|(_, colour)| colour)).map(look).collect();
    // Per lock its colour in the palette, or none where it is not to be seen.
    let of_new = |i: usize| match moves.iter().find(|m| m.after == Some(i)) {
        None => Some(0),
        Some(Moved { before: None, .. }) => Some(2),
        Some(moved) => Some(3 + MOVED.iter().position(|(f, _)| moved.most <= f * most).unwrap_or(2)),
    };
    let of_old = |i: usize| moves.iter().any(|m| m.before == Some(i) && m.after.is_none()).then_some(1);
    let repaint = |locks: Locks, colour: &dyn Fn(usize) -> Option<usize>| {
        if locks.tufts.count() == 0 {
            return colour(0).map(|c| Locks { palette: vec![palette[c].clone()], ..locks });
        }
        let mut tufts = Tufts::clone(&locks.tufts);
        let colours: Vec<Option<usize>> = (0..tufts.tufts.len()).map(colour).collect();
        let kept =
            tufts.tufts.into_iter().zip(colours).filter_map(|(tuft, c)| Some(Tuft { colour: c? as u32, ..tuft }));
        tufts.tufts = kept.collect();
        (!tufts.tufts.is_empty()).then(|| Locks::tufts(Arc::new(tufts), palette.clone()))
    };
    let both = [old.and_then(|l| repaint(l, &of_old)), new.and_then(|l| repaint(l, &of_new))];
    let part = |locks| Part { name: String::new(), source: String::new(), body: Body::Locks(locks), motion: None };
    both.into_iter().flatten().map(part).collect()
}

/// Some of the strands.
fn chosen(all: &Strands, which: impl Iterator<Item = usize>) -> Strands {
    let mut out = Strands::new();
    for i in which {
        out.push(all.roots[i], 0, all.strand(i).iter().copied());
    }
    out
}

fn part(strands: Strands, colour: u32, look: &HairMaterial) -> Part {
    let strands = Arc::new(strands);
    let colour = Colour::hex(colour);
    let material = HairMaterial { root_colour: colour, tip_colour: colour, variation: 0.05, ..look.clone() };
    let hair = Hair { guides: Arc::clone(&strands), strands, material, overlay: Arc::default() };
    Part { name: String::new(), source: String::new(), body: Body::Hair(hair), motion: None }
}

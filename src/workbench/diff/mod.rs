//! `coif diff`: what changed between two styles, or two versions of one.
//!
//! Strands are matched by their ids, which say where a root lies: moving a domain moves strands, it does not make new
//! ones.

mod locks;
mod picture;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;

use super::output::{Output, Written, write_until};
use super::run::RunError;
use crate::geometry::{Strands, curve};
use crate::render::{SheetOptions, Speed, png};
use crate::scene::{Body, Hair, HairMaterial, Scene, View};
use crate::script::{self, Ending, Files, Options, Outcome, Parameter};
use crate::task::Task;

/// Strands that moved less than this everywhere are the same, cm.
const SAME: f32 = 1e-4;

/// Nodes at which strands with different numbers of nodes are compared.
const NODES: usize = 33;

/// What is wanted of a comparison.
#[derive(Clone, Debug)]
pub struct DiffOptions {
    /// The first style.
    pub before: Options,
    /// The second style.
    pub after: Options,
    /// The view of the picture; the first one's first view when left out.
    pub view: Option<View>,
    /// Size and fineness of each of its three panels.
    pub sheet: SheetOptions,
    /// List every strand that changed.
    pub each: bool,
    /// Folder of the picture; none: no picture.
    pub out: Option<PathBuf>,
}

/// A value that differs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// What it is: `default of length`, `root_colour`.
    pub what: String,
    /// In the first; none when it is new.
    pub before: Option<String>,
    /// In the second; none when it is gone.
    pub after: Option<String>,
}

/// What became of one strand.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StrandChange {
    /// Its id, 16 hexadecimal digits: a script's numbers, and JSON's, do not hold it.
    pub id: String,
    /// `added`, `removed` or `moved`.
    pub what: &'static str,
    /// Its root, cm.
    pub root: [f32; 3],
    /// Mean distance of its nodes, cm.
    pub mean_distance: f32,
    /// Greatest distance of a node, cm.
    pub max_distance: f32,
}

/// What changed in a part.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PartChange {
    /// Name of the part.
    pub part: String,
    /// `added`, `removed`, `changed` or `same`.
    pub state: &'static str,
    /// Strands in the first.
    pub strands_before: usize,
    /// Strands in the second.
    pub strands_after: usize,
    /// Locks of stylised hair in the first.
    pub locks_before: usize,
    /// Locks of stylised hair in the second.
    pub locks_after: usize,
    /// Strands or locks whose id only the second has.
    pub added: usize,
    /// Strands or locks whose id only the first has.
    pub removed: usize,
    /// Strands or locks of both that do not lie where they lay.
    pub moved: usize,
    /// Mean over those that moved of their mean distances, cm.
    pub mean_distance: f32,
    /// The farthest that any node moved, cm.
    pub max_distance: f32,
    /// Root of the strand, or of the lock, that moved farthest, cm.
    pub farthest: Option<[f32; 3]>,
    /// Values of its material that differ.
    pub material: Vec<Change>,
    /// What else differs.
    pub other: Vec<Change>,
    /// Every strand that changed, when they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub strands: Vec<StrandChange>,
}

/// Everything that changed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Changes {
    /// Parameters that are declared otherwise, or have another value.
    pub parameters: Vec<Change>,
    /// Views and background.
    pub scene: Vec<Change>,
    /// Every part of either.
    pub parts: Vec<PartChange>,
}

impl Changes {
    /// True when nothing changed.
    pub fn is_empty(&self) -> bool {
        self.parameters.is_empty() && self.scene.is_empty() && self.parts.iter().all(|p| p.state == "same")
    }
}

/// What came out of a comparison.
#[derive(Debug)]
pub struct DiffReport {
    /// What the two scripts gave; their scenes are taken out.
    pub outcomes: Vec<Outcome>,
    /// The changes and the picture's file; or why there are none.
    pub result: Result<(Changes, Vec<Written>), RunError>,
}

/// Runs two styles and compares them.
pub fn diff(options: &DiffOptions, files: &Arc<dyn Files>, task: &Task) -> DiffReport {
    let mut report = DiffReport { outcomes: vec![], result: Err(RunError::Script) };
    let mut scenes = vec![];
    for script in [&options.before, &options.after] {
        let mut outcome = script::run(script, Arc::clone(files), &task.child());
        let scene = outcome.scene.take();
        let ending = outcome.ending;
        report.outcomes.push(outcome);
        match (ending, scene) {
            (Ending::Done, Some(scene)) => scenes.push(scene.still()),
            (Ending::Cancelled, _) => {
                report.result = Err(RunError::Cancelled);
                return report;
            }
            _ => return report,
        }
    }
    if let ([before, after], [a, b]) = (&scenes[..], &report.outcomes[..]) {
        let parameters = parameters(&a.parameters, &b.parameters);
        report.result = compared(options, parameters, before, after, task);
    }
    report
}

fn compared(
    options: &DiffOptions,
    parameters: Vec<Change>,
    before: &Scene,
    after: &Scene,
    task: &Task,
) -> Result<(Changes, Vec<Written>), RunError> {
    let mut changes = Changes { parameters, scene: vec![], parts: vec![] };
    let views = |s: &Scene| s.views.iter().map(|v| v.text()).collect::<Vec<_>>().join(", ");
    note(&mut changes.scene, "views", views(before), views(after));
    note(&mut changes.scene, "background", before.look.background.text(), after.look.background.text());
    let names: Vec<&str> = {
        let of_before = before.parts.iter().map(|p| p.name.as_str());
        let new = after.parts.iter().map(|p| p.name.as_str()).filter(|n| !before.parts.iter().any(|p| p.name == *n));
        of_before.chain(new).collect()
    };
    let mut moves = vec![];
    for name in names {
        let find = |s: &'_ Scene| s.parts.iter().find(|p| p.name == name).map(|p| p.body.clone());
        let (change, of_part) = part(name, find(before).as_ref(), find(after).as_ref(), options.each);
        changes.parts.push(change);
        moves.extend(of_part);
    }
    if task.is_cancelled() {
        return Err(RunError::Cancelled);
    }
    let Some(out) = &options.out else { return Ok((changes, vec![])) };
    let sheet = picture::panels(options, before, after, &changes, &moves, task)?;
    let (a, b) = (options.before.name(), options.after.name());
    let name = if a == b { format!("{a}.diff.png") } else { format!("{a}_{b}.diff.png") };
    let bytes = png::encode(&sheet, Speed::Balanced)?;
    Ok((changes, write_until(out, &[Output { name, bytes: bytes.into() }], task)?))
}

/// Notes a value that differs.
fn note(changes: &mut Vec<Change>, what: &str, before: impl ToString, after: impl ToString) {
    let (before, after) = (before.to_string(), after.to_string());
    if before != after {
        changes.push(Change { what: what.to_owned(), before: Some(before), after: Some(after) });
    }
}

fn parameters(before: &[Parameter], after: &[Parameter]) -> Vec<Change> {
    let mut changes = vec![];
    for a in before {
        let Some(b) = after.iter().find(|b| b.name == a.name) else {
            changes.push(Change { what: a.name.clone(), before: Some(a.default.to_string()), after: None });
            continue;
        };
        let bound = |n: Option<f64>| n.map_or_else(|| "none".into(), |n| n.to_string());
        let all = [
            ("kind", a.kind.text().to_owned(), b.kind.text().to_owned()),
            ("default", a.default.to_string(), b.default.to_string()),
            ("value", a.value.to_string(), b.value.to_string()),
            ("min", bound(a.min), bound(b.min)),
            ("max", bound(a.max), bound(b.max)),
            ("unit", a.unit.clone().unwrap_or_default(), b.unit.clone().unwrap_or_default()),
            ("choices", a.choices.join(", "), b.choices.join(", ")),
        ];
        // A value that is simply the default has been told already.
        let is_default = a.value.to_string() == all[1].1 && b.value.to_string() == all[1].2;
        for (what, before, after) in all.into_iter().filter(|(what, ..)| !(is_default && *what == "value")) {
            note(&mut changes, &format!("{what} of {}", a.name), before, after);
        }
    }
    for b in after.iter().filter(|b| !before.iter().any(|a| a.name == b.name)) {
        changes.push(Change { what: b.name.clone(), before: None, after: Some(b.default.to_string()) });
    }
    changes
}

/// A strand that is not as it was: indices in the two parts, and the farthest that a node of it moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moved {
    before: Option<usize>,
    after: Option<usize>,
    mean: f32,
    most: f32,
}

/// The strands of one part that changed.
pub(crate) struct Moves {
    part: String,
    strands: Vec<Moved>,
}

fn part(name: &str, before: Option<&Body>, after: Option<&Body>, each: bool) -> (PartChange, Option<Moves>) {
    let mut change = PartChange { part: name.to_owned(), state: "same", ..PartChange::default() };
    let hair = |body: Option<&Body>| if let Some(Body::Hair(hair)) = body { Some(hair.clone()) } else { None };
    let (a, b) = (hair(before), hair(after));
    let mut moves = None;
    if a.is_some() || b.is_some() {
        let none = Strands::new();
        let strands = |h: &Option<Hair>| h.as_ref().map_or_else(|| none.clone(), |h| Strands::clone(&h.strands));
        let (old, new) = (strands(&a), strands(&b));
        let strands = matched(&old, &new);
        summarise(&mut change, &old, &new, &strands);
        if each {
            change.strands = strands.iter().filter_map(|m| listed(m, &old, &new)).collect();
        }
        if let (Some(a), Some(b)) = (&a, &b) {
            change.material = material(&a.material, &b.material);
            note(&mut change.other, "guides", a.guides.count(), b.guides.count());
        }
        moves = Some(Moves { part: name.to_owned(), strands });
    }
    let stylised =
        |body: Option<&'_ Body>| if let Some(Body::Locks(locks)) = body { Some(locks.clone()) } else { None };
    let (a, b) = (stylised(before), stylised(after));
    if a.is_some() || b.is_some() {
        let changed = locks::matched(a.as_ref(), b.as_ref());
        locks::summarise(&mut change, a.as_ref(), b.as_ref(), &changed);
        moves = Some(Moves { part: name.to_owned(), strands: changed });
    }
    if let (Some(Body::Mesh(a, look_a)), Some(Body::Mesh(b, look_b))) = (before, after) {
        note(&mut change.other, "triangles", a.triangles.len(), b.triangles.len());
        note(&mut change.material, "colour", look_a.colour, look_b.colour);
        note(&mut change.material, "roughness", look_a.roughness, look_b.roughness);
        if a.positions.len() == b.positions.len() {
            let most = a.positions.iter().zip(&b.positions).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
            if most > SAME {
                change.max_distance = most;
                change.other.push(Change { what: "shape".into(), before: None, after: None });
            }
        }
    }
    change.state = match (before, after) {
        (None, _) => "added",
        (_, None) => "removed",
        (Some(a), Some(b)) if std::mem::discriminant(a) != std::mem::discriminant(b) => "changed",
        _ if change.added + change.removed + change.moved > 0 => "changed",
        _ if !change.material.is_empty() || !change.other.is_empty() => "changed",
        _ => "same",
    };
    (change, moves)
}

/// Strands of either that are not in the other as they are.
fn matched(old: &Strands, new: &Strands) -> Vec<Moved> {
    let index: BTreeMap<u64, usize> = new.roots.iter().enumerate().map(|(i, r)| (r.id, i)).collect();
    let known: std::collections::BTreeSet<u64> = old.roots.iter().map(|r| r.id).collect();
    let of_old: Vec<Option<Moved>> = (0..old.count())
        .into_par_iter()
        .map(|i| match index.get(&old.roots[i].id) {
            None => Some(Moved { before: Some(i), after: None, mean: 0.0, most: 0.0 }),
            Some(&j) => {
                let (mean, most) = distance(old.strand(i), new.strand(j));
                (most > SAME).then_some(Moved { before: Some(i), after: Some(j), mean, most })
            }
        })
        .collect();
    let added = (0..new.count()).filter(|&j| !known.contains(&new.roots[j].id));
    let added = added.map(|j| Moved { before: None, after: Some(j), mean: 0.0, most: 0.0 });
    of_old.into_iter().flatten().chain(added).collect()
}

/// Mean and greatest distance between the nodes of two strands.
fn distance(a: &[Vec3], b: &[Vec3]) -> (f32, f32) {
    let far = |a: &[Vec3], b: &[Vec3]| {
        let each = || a.iter().zip(b).map(|(p, q)| p.distance(*q));
        (each().sum::<f32>() / a.len().max(1) as f32, each().fold(0.0, f32::max))
    };
    if a.len() == b.len() { far(a, b) } else { far(&curve::resampled(a, NODES), &curve::resampled(b, NODES)) }
}

fn summarise(change: &mut PartChange, old: &Strands, new: &Strands, strands: &[Moved]) {
    change.strands_before = old.count();
    change.strands_after = new.count();
    change.count(strands, |moved| moved.before.map(|i| old.roots[i].position.to_array()));
}

impl PartChange {
    /// Counts and distances of what changed; `root` tells where a strand or a lock of the first grows.
    fn count(&mut self, all: &[Moved], root: impl Fn(&Moved) -> Option<[f32; 3]>) {
        let mut sum = 0.0_f64;
        for moved in all {
            match (moved.before, moved.after) {
                (Some(_), Some(_)) => {
                    self.moved += 1;
                    sum += f64::from(moved.mean);
                    if moved.most > self.max_distance {
                        self.max_distance = moved.most;
                        self.farthest = root(moved);
                    }
                }
                (Some(_), None) => self.removed += 1,
                (None, _) => self.added += 1,
            }
        }
        self.mean_distance = (sum / self.moved.max(1) as f64) as f32;
    }
}

fn listed(moved: &Moved, old: &Strands, new: &Strands) -> Option<StrandChange> {
    let (what, root) = match (moved.before, moved.after) {
        (Some(i), Some(_)) => ("moved", &old.roots[i]),
        (Some(i), None) => ("removed", &old.roots[i]),
        (None, Some(j)) => ("added", &new.roots[j]),
        (None, None) => return None,
    };
    Some(StrandChange {
        id: format!("{:016x}", root.id),
        what,
        root: root.position.to_array(),
        mean_distance: moved.mean,
        max_distance: moved.most,
    })
}

fn material(a: &HairMaterial, b: &HairMaterial) -> Vec<Change> {
    let mut changes = vec![];
    note(&mut changes, "root_colour", a.root_colour, b.root_colour);
    note(&mut changes, "tip_colour", a.tip_colour, b.tip_colour);
    let numbers = [
        ("variation", a.variation, b.variation),
        ("width", a.width, b.width),
        ("taper", a.taper, b.taper),
        ("shine", a.shine, b.shine),
        ("roughness", a.roughness, b.roughness),
    ];
    for (what, a, b) in numbers {
        note(&mut changes, what, a, b);
    }
    changes
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::geometry::Root;

    fn strands(lines: &[(u64, Vec<Vec3>)]) -> Strands {
        let mut s = Strands::new();
        for (id, line) in lines {
            let root = Root { id: *id, position: line[0], normal: Vec3::Y, uv: Vec2::ZERO, triangle: 0 };
            s.push(root, 0, line.iter().copied());
        }
        s
    }

    #[test]
    fn strands_are_matched_by_id_and_not_by_place_in_the_list() {
        let line = |x: f32| vec![Vec3::new(x, 0.0, 0.0), Vec3::new(x, 1.0, 0.0), Vec3::new(x, 2.0, 0.0)];
        let old = strands(&[(1, line(1.0)), (2, line(2.0)), (3, line(3.0))]);
        let new = strands(&[(4, line(4.0)), (3, line(3.0)), (2, line(2.5))]);
        let changed = matched(&old, &new);
        let mut change = PartChange::default();
        summarise(&mut change, &old, &new, &changed);
        assert_eq!((change.added, change.removed, change.moved), (1, 1, 1));
        assert_eq!((change.mean_distance, change.max_distance, change.farthest), (0.5, 0.5, Some([2.0, 0.0, 0.0])));
        assert!(matched(&old, &old).is_empty());
        // There and back give the same figures.
        let mut back = PartChange::default();
        summarise(&mut back, &new, &old, &matched(&new, &old));
        assert_eq!((back.added, back.removed, back.moved, back.max_distance), (1, 1, 1, 0.5));
    }

    #[test]
    fn the_number_of_nodes_alone_is_no_change() {
        let coarse = vec![Vec3::ZERO, Vec3::Y * 4.0];
        let fine: Vec<Vec3> = (0..=8).map(|i| Vec3::Y * (i as f32 * 0.5)).collect();
        assert!(matched(&strands(&[(1, coarse)]), &strands(&[(1, fine)])).is_empty());
    }
}

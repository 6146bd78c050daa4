//! Growing guides (algorithm 2).

use std::sync::Arc;

use glam::Vec3;

use super::domain::Domain;
use super::error::{GroomError, check_value};
use super::guides::Guides;
use super::layout;
use super::queue::{Entered, Queue, Walk};
use crate::geometry::clear::{Clear, Outcome, Scratch};
use crate::geometry::{OrientedBox, Solid, Strands, curve::Resampler, slide::Body};
use crate::math::rng::Key;
use crate::params::Function;
use crate::task::{Task, Warned, Warning};

crate::params! {
    /// Grows guides through queues of domains. The global queue acts on every guide; of the local queues the first one
    /// whose `where` is true for a guide's root acts on that guide too, at the same time and with equal rank.
    pub struct GrowOptions("Guides:grow") {
        /// The queue for all guides.
        global: Option<Arc<Queue>>;
        /// Queues for some of the guides.
        locals: Vec<LocalOptions> = vec![];
        /// Least distance of hair from the skin.
        margin: f32 = 0.05, unit("cm"), range(0.005, 10.0);
    }
}

crate::params! {
    /// A local queue and the guides that it acts on.
    pub struct LocalOptions("local queue") {
        /// Takes a guide's root (a vector), returns true if the queue acts on that guide.
        r#where: Function, takes("(root: vector): boolean");
        /// The queue.
        queue: Arc<Queue>;
    }
}

/// What [`grow`] grows, and through what.
#[derive(Clone, Copy, Debug)]
pub struct Grow<'a> {
    /// The guides.
    pub guides: &'a Guides,
    /// The queue for all guides.
    pub global: Option<&'a Queue>,
    /// Queues for some of the guides.
    pub locals: &'a [Arc<Queue>],
    /// Per guide: index of its local queue in `locals`, if it has one. Empty: no guide has.
    pub local_of: &'a [Option<u16>],
    /// The body to keep out of, if there is one.
    pub solid: Option<&'a Solid>,
    /// Least distance of nodes from the body, cm.
    pub margin: f32,
}

/// Grows every guide. Strand `i` of the result is guide `i`, unless one was stuck at its root, of which a warning tells.
///
/// The stage of a node ([`Strands::stage`]) numbers the stage that bent it last: the global queue's stages are 1, 2, ...,
/// G; the stages of every local queue G + 1, G + 2, ... (so that mirrored local queues look alike); where both act, the
/// local one counts.
///
/// # Errors
/// No roots, numbers out of range, more strands or nodes than any machine should hold, or the task was cancelled.
pub fn grow(input: &Grow, task: &Task) -> Result<Warned<Strands>, GroomError> {
    let guides = input.guides;
    let options = &guides.options;
    options.check(&guides.roots)?;
    check_value("the margin", input.margin, 0.005, f32::MAX)?;
    let n = guides.roots.len();
    if !input.local_of.is_empty() && input.local_of.len() != n {
        return Err(GroomError::Count { what: "local queue numbers", count: input.local_of.len(), expected: n });
    }

    let most = options.most_steps() + 1;
    let mut strands = Strands {
        points: vec![Vec3::ZERO; n * most],
        stage: vec![0; n * most],
        offsets: (0..=n).map(|i| (i * most) as u32).collect(),
        roots: guides.roots.clone(),
        guide: (0..n as u32).collect(),
        source: vec![0; n],
        sources: vec![Arc::clone(&guides.source)],
    };
    let entered_global = Entered::new(input.global.map_or(0, |q| q.domains().len()));
    let entered_local: Vec<Entered> = input.locals.iter().map(|q| Entered::new(q.domains().len())).collect();
    let counts: Vec<std::sync::atomic::AtomicU32> = (0..n).map(|_| 0.into()).collect();

    layout::write_all(&mut strands, task, "growing", Worker::default, |worker, i, points, stages| {
        let local = input.local_of.get(i).copied().flatten().map(usize::from).filter(|&l| l < input.locals.len());
        let global = (input.global, Some(&entered_global));
        let local = local.map_or((None, None), |l| (Some(&*input.locals[l]), Some(&entered_local[l])));
        let count = worker.strand(input, i, global, local, points, stages);
        counts[i].store(count as u32, std::sync::atomic::Ordering::Relaxed);
    })?;

    let counts: Vec<usize> = counts.iter().map(|c| c.load(std::sync::atomic::Ordering::Relaxed) as usize).collect();
    layout::compact(&mut strands, &counts);
    strands.guide = (0..strands.count() as u32).collect();
    task.progress("growing", 1.0);

    let mut warnings = Vec::new();
    let stuck = n - strands.count();
    if stuck > 0 {
        warnings.push(stuck_warning(stuck, n, "guides"));
    }
    if strands.count() > 0 {
        let queues = input.global.into_iter().map(|q| (q, &entered_global, "the global queue".to_owned()));
        let locals = input.locals.iter().zip(&entered_local).enumerate();
        let locals = locals.map(|(i, (q, e))| (&**q, e, format!("local queue {}", i + 1)));
        for (queue, entered, whose) in queues.chain(locals) {
            warnings.extend(entered.never().map(|d| never_entered(&queue.domains()[d], d, &whose, &strands)));
        }
    }
    Ok(Warned { value: strands, warnings })
}

/// For strands that had to be left out.
pub fn stuck_warning(stuck: usize, of: usize, what: &str) -> Warning {
    Warning::new(format!("`{stuck}` of {of} {what} were left out: there is no way out of the head from their roots"))
        .hint("their roots lie in a fold of the head, or inside another part of it; leave that part out of the region")
}

/// For a domain that no strand ever entered.
pub fn never_entered(domain: &Domain, index: usize, whose: &str, strands: &Strands) -> Warning {
    let message = format!("no strand ever entered {} of {whose}", domain.label(index));
    let Some(region) = domain.region() else {
        return Warning::new(message)
            .hint("no strand got to its stage: the stage before lets go only of strands that leave its boxes");
    };
    let (nearest, at) = nearest_node(region, strands);
    let at = at.round();
    Warning::new(message).hint(if nearest > 0.0 {
        format!("strands come as near as {nearest:.1} cm to its box, at about {{ {}, {}, {} }}", at.x, at.y, at.z)
    } else {
        "strands pass through its box, but only before or after its stage is visible: compare the priorities".to_owned()
    })
}

fn nearest_node(region: &OrientedBox, strands: &Strands) -> (f32, Vec3) {
    let outside = |p: &Vec3| (region.to_local(*p).abs() - region.half).max(Vec3::ZERO).length();
    strands
        .points
        .iter()
        .map(|p| (outside(p), *p))
        .fold((f32::INFINITY, Vec3::ZERO), |a, b| if b.0 < a.0 { b } else { a })
}

/// One thread's memory.
#[derive(Default)]
struct Worker {
    points: Vec<Vec3>,
    stages: Vec<u8>,
    resampler: Resampler,
    scratch: Scratch,
}

type Course<'a> = (Option<&'a Queue>, Option<&'a Entered>);

impl Worker {
    /// Grows strand `i` into `out`, and says how many nodes it has.
    fn strand(
        &mut self,
        input: &Grow,
        i: usize,
        global: Course,
        local: Course,
        out: &mut [Vec3],
        out_stages: &mut [u8],
    ) -> usize {
        self.axis(input, i, global, local);
        let n = self.points.len();
        let (out, out_stages) = (&mut out[..n], &mut out_stages[..n]);
        let (points, stages) = (&self.points, &self.stages);
        if n > 2 {
            self.resampler.uniform(points, out, |j, at| out_stages[j] = stages[(at.ceil() as usize).min(n - 1)]);
        } else {
            out.copy_from_slice(points);
            out_stages.copy_from_slice(stages);
        }
        if let Some(solid) = input.solid {
            let clear = Clear { body: Body { solid, margin: input.margin } };
            if clear.strand(out, &mut self.scratch) == Outcome::Stuck {
                return 0;
            }
        }
        n
    }

    /// The nodes as they grow, and the stage that bent each.
    fn axis(&mut self, input: &Grow, i: usize, global: Course, local: Course) {
        let options = &input.guides.options;
        let root = &input.guides.roots[i];
        let key = Key::new(options.seed, "force").with(root.id);
        let body = input.solid.map(|solid| Body { solid, margin: input.margin });
        let global_stages = global.0.map_or(0, |q| q.stages().len());

        let length = options.length_of(root);
        let limit = options.steps_to(length);
        let (mut v, mut t) = (root.position, options.first_direction(root));
        let mut global = Walk::new(global.0).noting(global.1);
        let mut local = Walk::new(local.0).noting(local.1);
        // Without any queue there is no domain to end the strand: it grows straight to its length.
        let is_bare = global.is_finished() && local.is_finished();
        let (mut grown, mut stage, mut free) = (0.0, 0, 0.0);
        self.points.clear();
        self.stages.clear();
        self.points.push(v);
        self.stages.push(0);

        for step in 0..limit {
            let rest = length - grown;
            if rest < 1e-3 * options.step || (global.is_finished() && local.is_finished() && !is_bare) {
                break;
            }
            let noise = key.with(step as u64);
            let (a, in_global) = global.judge(v, &mut t, noise.with(0));
            let (b, in_local) = local.judge(v, &mut t, noise.with(1));
            let force = (a + b).normalize_or_zero();
            if force != Vec3::ZERO {
                t = (t * options.stiffness + force).try_normalize().unwrap_or(t);
            }
            if in_local {
                stage = global_stages + local.head().unwrap_or(0) + 1;
            } else if in_global {
                stage = global.head().unwrap_or(0) + 1;
            }

            let h = options.step.min(rest);
            let (next, tangent) = match &body {
                Some(body) => {
                    let lift = if step == 0 { root.normal * body.margin.min(0.5 * h) } else { Vec3::ZERO };
                    let margin = body.margin.min(0.45 * h * (step + 1) as f32);
                    body.step(v, v + lift, t, h, margin, &mut free)
                }
                None => (v + t * h, t),
            };
            grown += next.distance(v);
            (v, t) = (next, tangent);
            self.points.push(v);
            self.stages.push(stage.min(255) as u8);
        }
        if self.points.len() < 2 {
            // Every queue is empty from the first: a stub, so that the strand is one.
            self.points.push(v + t * options.step.min(length));
            self.stages.push(0);
        }
    }
}

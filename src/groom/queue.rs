//! Queues of stages, and the way of one strand through them (algorithm 1).

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;

use super::domain::Domain;
use super::error::{GroomError, check_point, check_value};
use super::noise::gaussian3;
use crate::math::rng::Key;
use crate::params::Object;

crate::params! {
    /// A queue of domains. Those of equal priority form a stage; only the first stage is visible, and the next one becomes
    /// so when a strand was let go by every domain of it.
    pub struct QueueOptions("coif.queue") {
        /// Its domains, in any order.
        domains: Vec<Arc<Domain>>, positional();
    }
}

/// The domains of one queue that have equal priority.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The priority they share.
    pub priority: i32,
    /// Their places in [`Queue::domains`].
    pub domains: Vec<usize>,
}

/// Directional and gather domains in stages.
#[derive(Clone, Debug)]
pub struct Queue {
    domains: Vec<Arc<Domain>>,
    stages: Vec<Stage>,
}

impl Object for Queue {
    const NAME: &'static str = "Queue";
}

/// Sorts into stages: higher priority first, as written within a stage.
pub fn stages(priorities: impl Iterator<Item = i32>) -> Vec<Stage> {
    let mut stages: Vec<Stage> = Vec::new();
    for (i, priority) in priorities.enumerate() {
        match stages.iter_mut().find(|s| s.priority == priority) {
            Some(stage) => stage.domains.push(i),
            None => stages.push(Stage { priority, domains: vec![i] }),
        }
    }
    stages.sort_by_key(|s| std::cmp::Reverse(s.priority));
    stages
}

impl Queue {
    /// Forms the stages.
    ///
    /// # Errors
    /// A natural domain, a box without volume, a number out of its range.
    pub fn new(domains: Vec<Arc<Domain>>) -> Result<Self, GroomError> {
        for (i, domain) in domains.iter().enumerate() {
            let name = || domain.label(i);
            let (strength, noise) = match &**domain {
                Domain::Natural(_) => {
                    return Err(GroomError::WrongKind { domain: name(), queue: "forces" });
                }
                Domain::Directional(d) => {
                    if !d.r#box.is_valid() {
                        return Err(GroomError::EmptyBox { domain: name(), size: d.r#box.half * 2.0 });
                    }
                    check_unit(&name(), d.direction.0)?;
                    (d.strength, d.noise)
                }
                Domain::Gather(g) => {
                    check_point(format!("the core of {}", name()), g.core)?;
                    check_value(format!("the core radius of {}", name()), g.core_radius, 0.0, f32::MAX)?;
                    check_value(format!("the scatter of {}", name()), g.scatter, f32::MIN, f32::MAX)?;
                    if let Some(p) = g.direction {
                        check_unit(&name(), p.0)?;
                    }
                    (g.strength, g.noise)
                }
            };
            check_value(format!("the strength of {}", name()), strength, 0.0, f32::MAX)?;
            check_value(format!("the noise of {}", name()), noise, 0.0, f32::MAX)?;
        }
        let stages = stages(domains.iter().map(|d| d.priority()));
        Ok(Self { domains, stages })
    }

    /// The domains, as written.
    pub fn domains(&self) -> &[Arc<Domain>] {
        &self.domains
    }

    /// The stages, first one first.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }
}

fn check_unit(name: &str, v: Vec3) -> Result<(), GroomError> {
    check_value(format!("the length of the direction of {name}"), v.length(), 0.999, 1.001)
}

/// Which domains of a queue any strand has entered; shared by all strands.
#[derive(Debug, Default)]
pub struct Entered(Vec<AtomicBool>);

impl Entered {
    /// None entered yet.
    pub fn new(domains: usize) -> Self {
        Self((0..domains).map(|_| AtomicBool::new(false)).collect())
    }

    /// Notes that a strand entered `domain`.
    pub fn note(&self, domain: usize) {
        if let Some(flag) = self.0.get(domain) {
            // Setting only what is not yet set keeps the threads out of each other's cache lines.
            if !flag.load(Ordering::Relaxed) {
                flag.store(true, Ordering::Relaxed);
            }
        }
    }

    /// Domains that no strand entered.
    pub fn never(&self) -> impl Iterator<Item = usize> {
        self.0.iter().enumerate().filter(|(_, f)| !f.load(Ordering::Relaxed)).map(|(i, _)| i)
    }
}

/// What a domain of the head stage is to one strand.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Visible, not yet active.
    Waiting,
    /// Active; its start point S.
    Active(Vec3),
    /// Removed from the head stage.
    Dismissed,
}

/// One strand's way through one queue.
#[derive(Clone, Debug)]
pub struct Walk<'a> {
    queue: Option<&'a Queue>,
    entered: Option<&'a Entered>,
    /// The head stage is `stages[next - 1]`; before the first step there is none.
    next: usize,
    /// Of the domains of the head stage.
    states: Vec<State>,
    left: usize,
}

impl<'a> Walk<'a> {
    /// At the start of `queue`; without one it is finished from the first.
    pub fn new(queue: Option<&'a Queue>) -> Self {
        Self { queue, entered: None, next: 0, states: Vec::new(), left: 0 }
    }

    /// The same walk, noting every domain that becomes active.
    #[must_use]
    pub fn noting(mut self, entered: Option<&'a Entered>) -> Self {
        self.entered = entered;
        self
    }

    /// Back to the start, of another queue, keeping the memory.
    pub fn restart(&mut self, queue: Option<&'a Queue>, entered: Option<&'a Entered>) {
        (self.queue, self.entered, self.next, self.left) = (queue, entered, 0, 0);
        self.states.clear();
    }

    /// True when the head stage is empty and no stage is left.
    pub fn is_finished(&self) -> bool {
        self.left == 0 && self.next >= self.queue.map_or(0, |q| q.stages.len())
    }

    /// Index of the head stage; `None` before the first step.
    pub fn head(&self) -> Option<usize> {
        self.next.checked_sub(1)
    }

    /// One round of algorithm 1: the sum of E a over the active domains at the growth end `v` (the inner sum of (2)), and
    /// whether any domain acted. A gather domain that lets go corrects `tangent` by (4). `noise` is the key of this
    /// strand's node.
    pub fn judge(&mut self, v: Vec3, tangent: &mut Vec3, noise: Key) -> (Vec3, bool) {
        let Some(queue) = self.queue else { return (Vec3::ZERO, false) };
        if self.left == 0 {
            let Some(stage) = queue.stages.get(self.next) else { return (Vec3::ZERO, false) };
            self.next += 1;
            self.states.clear();
            self.states.resize(stage.domains.len(), State::Waiting);
            self.left = stage.domains.len();
        }
        let stage = &queue.stages[self.next - 1];
        let (mut sum, mut acted) = (Vec3::ZERO, false);
        for (&index, state) in stage.domains.iter().zip(&mut self.states) {
            let (before, direction, strength, deviation) = match (&*queue.domains[index], *state) {
                (_, State::Dismissed) | (Domain::Natural(_), _) => continue,
                (Domain::Directional(d), before) => {
                    let inside = d.r#box.contains(v);
                    (before, inside.then_some(d.direction.0), d.strength, d.noise)
                }
                (Domain::Gather(g), before) => {
                    // It is active from the moment it is visible; that is where its sphere has its centre.
                    let start = if let State::Active(start) = before { start } else { v };
                    let to_core = g.core - v;
                    let holds = v.distance(start) <= start.distance(g.core) && to_core.length() > g.core_radius;
                    let before = State::Active(start);
                    if before != *state
                        && let Some(entered) = self.entered
                    {
                        entered.note(index);
                    }
                    if !holds && let Some(p) = g.direction {
                        *tangent = (p.0 + *tangent * g.scatter).try_normalize().unwrap_or(*tangent);
                    }
                    // At the very core (a radius of 0 reached exactly) there is no direction; it does not hold there.
                    (before, holds.then(|| to_core.normalize_or_zero()), g.strength, g.noise)
                }
            };
            match (direction, before) {
                (Some(mut a), before) => {
                    if before == State::Waiting
                        && let Some(entered) = self.entered
                    {
                        entered.note(index);
                    }
                    *state = if before == State::Waiting { State::Active(v) } else { before };
                    if deviation > 0.0 {
                        a = (a + gaussian3(noise.with(index as u64)) * deviation).try_normalize().unwrap_or(a);
                    }
                    sum += a * strength;
                    acted = true;
                }
                (None, State::Active(_)) => {
                    *state = State::Dismissed;
                    self.left -= 1;
                }
                (None, State::Waiting | State::Dismissed) => {}
            }
        }
        (sum, acted)
    }
}

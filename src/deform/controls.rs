//! Control points: where they stand, what each is for, and what holds them back. The same for lattices and cages.

use glam::Vec3;

use super::kernel::Limit;
use super::{DeformError, Pins, PointKind};

/// The control points of a lattice or of a cage.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Controls {
    /// Where they were at first.
    pub rest: Vec<Vec3>,
    /// How far each has moved from there, cm.
    pub moves: Vec<Vec3>,
    pub kinds: Vec<PointKind>,
    /// Points on the object that stay, and the exponent of their affinity.
    pub held: Vec<Vec3>,
    pub power: f32,
}

impl Controls {
    pub fn new(rest: Vec<Vec3>) -> Self {
        let count = rest.len();
        let (moves, kinds) = (vec![Vec3::ZERO; count], vec![PointKind::Overall; count]);
        Self { rest, moves, kinds, held: vec![], power: 2.0 }
    }

    pub fn place(&self, index: usize) -> Vec3 {
        self.rest[index] + self.moves[index]
    }

    pub fn is_still(&self) -> bool {
        self.moves.iter().all(|&m| m == Vec3::ZERO)
    }

    fn is_free(&self, index: u32) -> bool {
        self.kinds[index as usize] != PointKind::Fixed
    }

    pub fn mark(&mut self, points: &[u32], kind: PointKind) {
        for &i in points {
            self.kinds[i as usize] = kind;
        }
    }

    /// The middle of those of the points that are not fixed, as they stand.
    pub fn middle(&self, points: &[u32]) -> Vec3 {
        let free: Vec<u32> = points.iter().copied().filter(|&i| self.is_free(i)).collect();
        free.iter().map(|&i| self.place(i as usize)).sum::<Vec3>() / free.len().max(1) as f32
    }

    /// Puts points where `place` says, but for fixed ones; `called` names them in errors.
    pub fn put(
        &mut self,
        points: &[u32],
        called: impl Fn(usize) -> String,
        mut place: impl FnMut(u32, Vec3) -> Vec3,
    ) -> Result<(), DeformError> {
        if !points.is_empty() && !points.iter().any(|&i| self.is_free(i)) {
            return Err(DeformError::AllFixed { count: points.len() });
        }
        for &i in points {
            if !self.is_free(i) {
                continue;
            }
            let now = self.place(i as usize);
            let value = place(i, now);
            if !value.is_finite() {
                return Err(DeformError::NotFinite { what: format!("the place of {}", called(i as usize)), value });
            }
            if value != now {
                self.moves[i as usize] = value - self.rest[i as usize];
            }
        }
        Ok(())
    }

    /// Holds points of the object, with this exponent.
    pub fn hold(&mut self, points: &[Vec3], power: f32) -> Result<(), DeformError> {
        super::check_power(power)?;
        if let Some(&value) = points.iter().find(|p| !p.is_finite()) {
            return Err(DeformError::NotFinite { what: "a held point".into(), value });
        }
        self.held.extend_from_slice(points);
        self.power = power;
        Ok(())
    }

    /// Overall points follow the feature points that have moved, pulled back by the fixed ones.
    pub fn follow(&mut self, power: f32, called: impl Fn(usize) -> String) -> Result<(), DeformError> {
        let of = |kind: PointKind| -> Vec<usize> { (0..self.kinds.len()).filter(|&i| self.kinds[i] == kind).collect() };
        let moved = of(PointKind::Feature).into_iter().filter(|&i| self.moves[i] != Vec3::ZERO);
        let feature: Vec<(Vec3, Vec3)> = moved.map(|i| (self.rest[i], self.place(i))).collect();
        let fixed: Vec<Vec3> = of(PointKind::Fixed).into_iter().map(|i| self.place(i)).collect();
        let overall: Vec<u32> = of(PointKind::Overall).into_iter().map(|i| i as u32).collect();
        if feature.is_empty() || fixed.is_empty() || overall.is_empty() {
            return Ok(());
        }
        let pins = Pins::new(&fixed, &feature, power)?;
        self.put(&overall, called, |_, p| pins.at(p))
    }

    /// What holds a motion back, if anything does.
    pub fn limit(&self) -> Option<Limit> {
        let moved = self.rest.iter().zip(&self.moves).filter(|(_, m)| **m != Vec3::ZERO).map(|(p, _)| *p).collect();
        (!self.held.is_empty()).then(|| Limit { moved, held: self.held.clone(), power: self.power })
    }
}

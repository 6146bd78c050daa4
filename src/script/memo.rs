//! What was computed before: kept across runs, found again by its content key.
//!
//! A key is a [`Digest`] of the operation's name and version, its parameters as data, the content of its inputs and of
//! files, and what the script's own functions answered. Time, paths, threads and line numbers are in no key, so a
//! changed comment recomputes nothing, and a value may be shared by every run and every cell of a sheet. What a value
//! says about where it was made is revised when it is found.

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::Vec3;

use crate::deform::Fitted;
use crate::garment::Garment;
use crate::geometry::{Clip, Mesh, Root, Strands};
use crate::groom::Moving;
use crate::head::Head;
use crate::math::Digest;
use crate::task::Warning;

/// What a memo can keep.
pub trait Kept: Any + Send + Sync {
    /// Memory that it takes, roughly.
    fn bytes(&self) -> usize;
}

impl Kept for Strands {
    fn bytes(&self) -> usize {
        Self::bytes(self)
    }
}

impl Kept for Moving {
    fn bytes(&self) -> usize {
        self.rest.bytes() + self.frames.frames.iter().map(|f| f.bytes()).sum::<usize>()
    }
}

impl Kept for Head {
    fn bytes(&self) -> usize {
        Self::bytes(self)
    }
}

impl Kept for Garment {
    fn bytes(&self) -> usize {
        self.mesh.bytes()
    }
}

impl Kept for Fitted {
    fn bytes(&self) -> usize {
        self.mesh.bytes() + self.lattices.len() * 2048
    }
}

impl Kept for Mesh {
    fn bytes(&self) -> usize {
        (self.positions.len() + self.normals.len()) * 12 + self.uvs.len() * 8 + self.triangles.len() * 12
    }
}

impl Kept for Vec<Root> {
    fn bytes(&self) -> usize {
        size_of_val(&**self)
    }
}

impl Kept for Clip<Vec<Vec3>> {
    fn bytes(&self) -> usize {
        self.frames.iter().map(|f| size_of_val(&f[..])).sum()
    }
}

impl Kept for Vec<u8> {
    fn bytes(&self) -> usize {
        self.len()
    }
}

impl Kept for Vec<String> {
    fn bytes(&self) -> usize {
        self.iter().map(|s| s.len() + size_of::<String>()).sum()
    }
}

/// Where a value came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// From the memo.
    Hit,
    /// It was computed.
    Computed,
}

impl Origin {
    /// `hit` or `computed`.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Hit => "hit",
            Self::Computed => "computed",
        }
    }
}

/// Kept values, bounded in memory; the one that was not used for longest goes first.
pub struct Memo {
    limit: usize,
    shelf: Mutex<Shelf>,
}

#[derive(Default)]
struct Shelf {
    items: BTreeMap<u128, Item>,
    /// Keys by when they were last used.
    order: BTreeMap<u64, u128>,
    bytes: usize,
    clock: u64,
}

struct Item {
    value: Arc<dyn Any + Send + Sync>,
    /// Key of the value's own content, where it was asked for.
    content: Option<u128>,
    warnings: Vec<Warning>,
    bytes: usize,
    used: u64,
}

/// What an entry itself takes.
const ENTRY: usize = 256;

impl Default for Memo {
    /// Half a gigabyte: some twenty versions of a style of 40,000 strands.
    fn default() -> Self {
        Self::new(512 << 20)
    }
}

impl fmt::Debug for Memo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Memo({} of {} bytes)", self.bytes(), self.limit)
    }
}

impl Memo {
    /// A memo of at most `limit` bytes; with 0 it keeps nothing.
    pub fn new(limit: usize) -> Self {
        Self { limit, shelf: Mutex::default() }
    }

    /// Bytes in it.
    pub fn bytes(&self) -> usize {
        self.shelf().bytes
    }

    /// Values in it.
    pub fn len(&self) -> usize {
        self.shelf().items.len()
    }

    /// True when there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// True when there is a value with this key.
    pub fn has(&self, key: u128) -> bool {
        self.shelf().items.contains_key(&key)
    }

    /// The value with this key and the warnings of its computation.
    pub fn get<T: Kept>(&self, key: u128) -> Option<(Arc<T>, Vec<Warning>)> {
        self.revised(key, |_: &mut Arc<T>| {})
    }

    /// The same, after `revise` has seen to it that the value fits its new place. It may change nothing that the key or
    /// the value's own content depends on. While nobody else holds the value, `Arc::make_mut` copies nothing.
    pub fn revised<T: Kept>(&self, key: u128, revise: impl FnOnce(&mut Arc<T>)) -> Option<(Arc<T>, Vec<Warning>)> {
        let mut shelf = self.shelf();
        let Shelf { items, order, clock, .. } = &mut *shelf;
        let item = items.get_mut(&key)?;
        // Taken out, so that this is the only holder besides those outside.
        let kept = std::mem::replace(&mut item.value, Arc::new(()));
        let mut value = match kept.downcast::<T>() {
            Ok(value) => value,
            Err(other) => {
                item.value = other;
                return None;
            }
        };
        revise(&mut value);
        item.value = Arc::clone(&value) as Arc<dyn Any + Send + Sync>;
        *clock += 1;
        order.remove(&item.used);
        item.used = *clock;
        order.insert(item.used, key);
        Some((value, item.warnings.clone()))
    }

    /// Keeps a value, unless it alone is more than the memo may hold.
    pub fn put<T: Kept>(&self, key: u128, value: &Arc<T>, warnings: &[Warning]) {
        let bytes = value.bytes() + ENTRY;
        let mut shelf = self.shelf();
        shelf.remove(key);
        if bytes > self.limit {
            return;
        }
        while shelf.bytes + bytes > self.limit {
            let Some((_, &oldest)) = shelf.order.first_key_value() else { break };
            shelf.remove(oldest);
        }
        shelf.clock += 1;
        let used = shelf.clock;
        shelf.order.insert(used, key);
        shelf.bytes += bytes;
        let value = Arc::clone(value) as Arc<dyn Any + Send + Sync>;
        shelf.items.insert(key, Item { value, content: None, warnings: warnings.to_vec(), bytes, used });
    }

    /// The content key of strands; of those in the memo it is computed once.
    pub fn content(&self, strands: &Arc<Strands>) -> u128 {
        let place = Arc::as_ptr(strands).cast::<()>();
        let is_it = |item: &Item| Arc::as_ptr(&item.value).cast::<()>() == place;
        let known = self.shelf().items.values().find(|i| is_it(i)).and_then(|i| i.content);
        known.unwrap_or_else(|| {
            let mut digest = Digest::new("strands");
            strands.digest(&mut digest);
            let key = digest.finish();
            if let Some(item) = self.shelf().items.values_mut().find(|i| is_it(i)) {
                item.content = Some(key);
            }
            key
        })
    }

    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        // A panic of another thread has left at worst an entry out.
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shelf {
    fn remove(&mut self, key: u128) {
        if let Some(item) = self.items.remove(&key) {
            self.order.remove(&item.used);
            self.bytes -= item.bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(bytes: usize) -> Arc<Vec<u8>> {
        Arc::new(vec![7; bytes])
    }

    #[test]
    fn the_least_recently_used_goes_and_the_bound_holds() {
        let memo = Memo::new(10 * (1000 + ENTRY));
        for key in 0..10 {
            memo.put(key, &value(1000), &[]);
        }
        assert_eq!((memo.len(), memo.bytes()), (10, memo.limit));
        assert!(memo.get::<Vec<u8>>(0).is_some());
        memo.put(10, &value(1500), &[]);
        assert!(memo.bytes() <= memo.limit);
        let left: Vec<u128> = (0..11).filter(|&k| memo.get::<Vec<u8>>(k).is_some()).collect();
        assert_eq!(left, [0, 3, 4, 5, 6, 7, 8, 9, 10]);
        // Too large for all of it: nothing is thrown out for what cannot be kept.
        memo.put(11, &value(memo.limit), &[]);
        assert_eq!((memo.len(), memo.get::<Vec<u8>>(11)), (9, None));
        memo.put(3, &value(10), &[]);
        assert_eq!(memo.bytes(), 7 * (1000 + ENTRY) + 1500 + ENTRY + 10 + ENTRY);
        let none = Memo::new(0);
        none.put(1, &value(1), &[]);
        assert!(none.is_empty());
    }

    #[test]
    fn a_value_of_another_type_is_not_found_and_not_lost() {
        let memo = Memo::default();
        memo.put(1, &value(5), &[Warning::new("odd")]);
        assert!(memo.get::<Vec<String>>(1).is_none());
        let (found, warnings) = memo.get::<Vec<u8>>(1).unwrap();
        assert_eq!((&*found, warnings), (&vec![7; 5], vec![Warning::new("odd")]));
    }

    #[test]
    fn revising_copies_only_what_others_hold() {
        let memo = Memo::default();
        memo.put(1, &value(5), &[]);
        let revise = |v: &mut Arc<Vec<u8>>| Arc::make_mut(v)[0] += 1;
        let first = memo.revised(1, revise).unwrap().0;
        let place = Arc::as_ptr(&first);
        let second = memo.revised(1, revise).unwrap().0;
        assert_eq!((first[0], second[0]), (8, 9));
        assert_ne!(place, Arc::as_ptr(&second));
        let place = Arc::as_ptr(&second);
        drop(second);
        assert_eq!(Arc::as_ptr(&memo.revised(1, revise).unwrap().0), place);
    }
}

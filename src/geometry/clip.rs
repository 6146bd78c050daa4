//! Clips: a value over time.

use std::sync::Arc;

/// Frames of a value at equal distances in time; what moves keeps its topology from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip<T> {
    /// Frames in a second, above 0.
    pub rate: f32,
    /// True when the first frame follows the last.
    pub looped: bool,
    /// The frames, at least one; frame `i` shows the time `i / rate`.
    pub frames: Vec<Arc<T>>,
}

impl<T> Clip<T> {
    /// A clip that does not loop.
    pub fn new(rate: f32, frames: Vec<Arc<T>>) -> Self {
        Self { rate, looped: false, frames }
    }

    /// How many frames there are.
    pub fn count(&self) -> usize {
        self.frames.len()
    }

    /// How long it lasts, seconds: a loop shows its last frame as long as the others.
    pub fn duration(&self) -> f32 {
        let steps = if self.looped { self.frames.len() } else { self.frames.len().saturating_sub(1) };
        steps as f32 / self.rate
    }

    /// The value at a frame: past its end a loop begins anew, any other clip stands still. `None` when it is empty.
    pub fn at(&self, frame: usize) -> Option<&Arc<T>> {
        let last = self.frames.len().checked_sub(1)?;
        self.frames.get(if self.looped { frame % self.frames.len() } else { frame.min(last) })
    }

    /// The clip of what `make` gives for every frame; it is told the frame's number.
    ///
    /// # Errors
    /// The first error of `make`.
    pub fn try_map<U, E>(&self, mut make: impl FnMut(usize, &Arc<T>) -> Result<Arc<U>, E>) -> Result<Clip<U>, E> {
        let frames = self.frames.iter().enumerate().map(|(i, f)| make(i, f)).collect::<Result<_, E>>()?;
        Ok(Clip { rate: self.rate, looped: self.looped, frames })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clip(looped: bool) -> Clip<u32> {
        Clip { rate: 10.0, looped, frames: (0..5).map(Arc::new).collect() }
    }

    #[test]
    fn a_loop_begins_anew_and_another_clip_stands_still() {
        assert_eq!(clip(true).at(7).map(|f| **f), Some(2));
        assert_eq!(clip(false).at(7).map(|f| **f), Some(4));
        assert_eq!(Clip::<u32>::new(10.0, vec![]).at(0), None);
        assert!((clip(true).duration() - 0.5).abs() < 1e-6 && (clip(false).duration() - 0.4).abs() < 1e-6);
    }

    #[test]
    fn an_error_of_one_frame_is_the_error_of_the_clip() {
        assert_eq!(clip(false).try_map(|i, f| if i == 3 { Err(i) } else { Ok(Arc::clone(f)) }), Err(3));
        assert_eq!(clip(true).try_map(|_, f| Ok::<_, ()>(Arc::clone(f))), Ok(clip(true)));
    }
}

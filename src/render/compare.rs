//! How far two pictures differ.

use super::sheet::Picture;

/// Where two pictures are not the same.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Pixels that differ by more than the tolerance, or that only one of the two has.
    pub pixels: usize,
    /// The greatest difference of one channel, 0 to 255.
    pub most: u8,
    /// Expected, mask and actual side by side; in the mask what differs is red over a faint actual picture.
    pub panels: Picture,
}

/// Compares two pictures; `None` when every channel of every pixel is within `tolerance`.
pub fn compare(expected: &Picture, actual: &Picture, tolerance: u8) -> Option<Difference> {
    let (width, height) = (expected.width.max(actual.width) as usize, expected.height.max(actual.height) as usize);
    let at = |p: &Picture, x: usize, y: usize| {
        let is_inside = x < p.width as usize && y < p.height as usize;
        let i = (y * p.width as usize + x) * 3;
        if is_inside { p.pixels.get(i..i + 3).map(|c| [c[0], c[1], c[2]]) } else { None }
    };
    let (mut pixels, mut most) = (0, 0);
    let mut panels = Vec::with_capacity(width * height * 9);
    for y in 0..height {
        let mut mask = Vec::with_capacity(width * 3);
        for x in 0..width {
            let (far, is_missing) = match (at(expected, x, y), at(actual, x, y)) {
                (Some(a), Some(b)) => ((0..3).map(|c| a[c].abs_diff(b[c])).fold(0, u8::max), false),
                (None, None) => (0, false),
                (Some(_), None) | (None, Some(_)) => (255, true),
            };
            most = most.max(far);
            if far > tolerance || is_missing {
                pixels += 1;
                mask.extend([230, 20, 40]);
            } else {
                let [r, g, b] = at(actual, x, y).unwrap_or([128; 3]).map(u32::from);
                let grey = ((299 * r + 587 * g + 114 * b) / 1000) as u8;
                mask.extend([192 + grey / 4; 3]);
            }
        }
        let row = |p: &Picture| (0..width).flat_map(|x| at(p, x, y).unwrap_or([128; 3])).collect::<Vec<u8>>();
        panels.extend(row(expected));
        panels.extend(mask);
        panels.extend(row(actual));
    }
    let panels = Picture { width: 3 * width as u32, height: height as u32, pixels: panels };
    (pixels > 0).then_some(Difference { pixels, most, panels })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, colour: u8) -> Picture {
        Picture { width, height, pixels: vec![colour; (width * height * 3) as usize] }
    }

    #[test]
    fn the_tolerance_is_per_channel_and_inclusive() {
        let a = picture(4, 3, 100);
        assert_eq!(compare(&a, &a, 0), None);
        let mut b = a.clone();
        b.pixels[7] = 103;
        assert_eq!(compare(&a, &b, 3), None);
        let d = compare(&a, &b, 2).unwrap();
        assert_eq!((d.pixels, d.most, d.panels.width, d.panels.height), (1, 3, 12, 3));
        // Pixel 2 of the first row is red in the middle panel, and nowhere else.
        let red: Vec<usize> = (0..36).filter(|i| d.panels.pixels[3 * i..3 * i + 3] == [230, 20, 40]).collect();
        assert_eq!(red, [4 + 2]);
        assert_eq!(compare(&b, &a, 2).unwrap().pixels, 1);
    }

    #[test]
    fn other_sizes_differ() {
        let d = compare(&picture(4, 3, 9), &picture(3, 5, 9), 255).unwrap();
        // 3 of the fourth column and 6 of the two last rows.
        assert_eq!((d.pixels, d.most, d.panels.width, d.panels.height), (9, 255, 12, 5));
    }
}

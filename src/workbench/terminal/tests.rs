use super::*;
use crate::render::{Picture, Speed, png as coder};

fn picture(width: u32, height: u32, colour: impl Fn(u32, u32) -> [u8; 3]) -> (Pixels, Vec<u8>) {
    let rgb: Vec<[u8; 3]> =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| colour(x, y)).collect();
    let picture = Picture { width, height, pixels: rgb.as_flattened().to_vec() };
    (Pixels { width, height, rgb }, coder::encode(&picture, Speed::Fast).unwrap())
}

fn detect(variables: &[(&str, &str)]) -> Protocol {
    Protocol::detect(|name| variables.iter().find(|v| v.0 == name).map(|v| v.1.to_owned()))
}

#[test]
fn terminals_are_told_by_their_environment() {
    assert_eq!(detect(&[]), Protocol::Half);
    assert_eq!(detect(&[("TERM", "xterm-256color")]), Protocol::Half);
    assert_eq!(detect(&[("TERM", "xterm-kitty")]), Protocol::Kitty);
    assert_eq!(detect(&[("TERM", "xterm-256color"), ("KITTY_WINDOW_ID", "1")]), Protocol::Kitty);
    assert_eq!(detect(&[("TERM_PROGRAM", "WezTerm")]), Protocol::Iterm);
    assert_eq!(detect(&[("TERM_PROGRAM", "iTerm.app")]), Protocol::Iterm);
    assert_eq!(detect(&[("TERM", "foot")]), Protocol::Sixel);
    assert_eq!(detect(&[("TERM", "tmux-256color"), ("KITTY_WINDOW_ID", "1")]), Protocol::Half);
    let konsole = ("KONSOLE_VERSION", "221203");
    assert_eq!(detect(&[("TERM", "xterm-256color"), konsole]), Protocol::Iterm);
    assert_eq!(detect(&[("TERM", "xterm-256color"), ("KONSOLE_VERSION", "211203")]), Protocol::Half);
    assert_eq!(detect(&[("TERM", "xterm"), konsole, ("XTERM_VERSION", "XTerm(379)")]), Protocol::Half);
    assert_eq!(detect(&[("TERM", "foot"), konsole]), Protocol::Sixel);
    for name in Protocol::TEXTS {
        assert!(Protocol::parse(name).is_some());
    }
}

#[test]
fn a_picture_fits_and_keeps_its_shape() {
    let (wide, _) = picture(400, 100, |_, _| [0; 3]);
    let window = Window { cell: Some((10, 20)), ..Window::default() };
    assert_eq!(fit(&wide, Protocol::Kitty, &window, 0), (40, 5), "not enlarged");
    assert_eq!(fit(&wide, Protocol::Half, &window, 0), (80, 10));
    let (tall, _) = picture(300, 3000, |_, _| [0; 3]);
    let (columns, rows) = fit(&tall, Protocol::Kitty, &window, 5);
    assert_eq!((columns, rows), (4, 18));
    let (large, _) = picture(1920, 900, |_, _| [0; 3]);
    let window = Window { columns: 150, rows: 60, most: Some(XTERM_MOST), ..window };
    assert_eq!(fit(&large, Protocol::Kitty, &window, 0), (150, 36));
    assert_eq!(fit(&large, Protocol::Sixel, &window, 0), (100, 24), "no more than xterm draws");
    // A window that is all taken still shows something.
    assert_eq!(fit(&tall, Protocol::Half, &window, 500).1, 4);
}

#[test]
fn shrinking_keeps_the_mean() {
    let (pixels, _) = picture(64, 48, |x, y| [(x * 4) as u8, (y * 5) as u8, 200]);
    let small = shrink(&pixels, (16, 12));
    let mean = |p: &Pixels, c: usize| p.rgb.iter().map(|v| f64::from(v[c])).sum::<f64>() / p.rgb.len() as f64;
    for c in 0..3 {
        assert!((mean(&pixels, c) - mean(&small, c)).abs() < 0.6);
    }
    assert_eq!(shrink(&pixels, (64, 48)).rgb, pixels.rgb);
}

#[test]
fn base64_is_that_of_the_rfc() {
    for (plain, coded) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
        assert_eq!(inline::base64(plain.as_bytes()), coded);
    }
}

#[test]
fn kitty_gets_the_png_in_chunks() {
    let (_, png) = picture(120, 90, |x, y| [(x * 31 % 251) as u8, (y * 17 % 241) as u8, (x * y % 239) as u8]);
    let text = String::from_utf8(draw(&png, Protocol::Kitty, &Window::default(), 0).unwrap()).unwrap();
    let commands: Vec<&str> = text.split("\x1b\\").filter(|c| c.contains(';')).collect();
    assert!(commands.len() > 1, "the picture is large enough for several chunks");
    let payload: String = commands.iter().map(|c| c.split_once(';').unwrap().1).collect();
    assert_eq!(payload, inline::base64(&png));
    for (i, command) in commands.iter().enumerate() {
        assert!(command.split_once(';').unwrap().1.len() <= 4096);
        assert!(command.contains(if i + 1 < commands.len() { "m=1" } else { "m=0" }));
    }
}

/// Draws sixels as a terminal does.
fn draw_sixels(text: &str) -> std::collections::BTreeMap<(usize, usize), [usize; 3]> {
    let body = text.strip_prefix("\x1bP0;1;0q").unwrap().strip_suffix("\x1b\\\r\n").unwrap();
    let bytes = body.as_bytes();
    let (mut palette, mut drawn) = (std::collections::BTreeMap::new(), std::collections::BTreeMap::new());
    let (mut x, mut band, mut colour, mut i) = (0, 0, 0, 0);
    let numbers = |i: &mut usize| {
        let from = *i;
        while *i < bytes.len() && (bytes[*i].is_ascii_digit() || bytes[*i] == b';') {
            *i += 1;
        }
        body[from..*i].split(';').filter(|n| !n.is_empty()).map(|n| n.parse().unwrap()).collect::<Vec<usize>>()
    };
    let mut put = |x: &mut usize, band: usize, colour: [usize; 3], byte: u8, times: usize| {
        for _ in 0..times {
            for bit in 0..6 {
                if (byte - 63) >> bit & 1 == 1 {
                    assert!(drawn.insert((*x, band * 6 + bit), colour).is_none(), "drawn twice");
                }
            }
            *x += 1;
        }
    };
    while i < bytes.len() {
        i += 1;
        match bytes[i - 1] {
            b'"' => drop(numbers(&mut i)),
            b'#' => {
                let n = numbers(&mut i);
                colour = n[0];
                if n.len() == 5 {
                    palette.insert(colour, [n[2], n[3], n[4]]);
                }
            }
            b'!' => {
                let times = numbers(&mut i)[0];
                put(&mut x, band, palette[&colour], bytes[i], times);
                i += 1;
            }
            b'$' => x = 0,
            b'-' => (x, band) = (0, band + 1),
            byte => put(&mut x, band, palette[&colour], byte, 1),
        }
    }
    drawn
}

#[test]
fn sixels_draw_every_pixel_in_its_colour() {
    let (pixels, _) = picture(23, 20, |x, y| [(x * 11) as u8, (y * 12) as u8, if x > y { 255 } else { 0 }]);
    let drawn = draw_sixels(&String::from_utf8(sixel::encode(&pixels)).unwrap());
    assert_eq!(drawn.len(), 23 * 20);
    for (&(x, y), colour) in &drawn {
        let wanted = pixels.rgb[y * 23 + x];
        for c in 0..3 {
            let off = (colour[c] as f32 * 2.55 - f32::from(wanted[c])).abs();
            assert!(off <= 52.0, "{x} {y}: {colour:?} for {wanted:?}");
        }
    }
    // Plain colours of the palette stay plain, whatever the dithering.
    for value in [0, 51, 102, 153, 204, 255] {
        let (plain, _) = picture(8, 8, |_, _| [value; 3]);
        let drawn = draw_sixels(&String::from_utf8(sixel::encode(&plain)).unwrap());
        assert!(drawn.values().all(|c| *c == [usize::from(value) * 100 / 255; 3]), "{value}");
    }
}

#[test]
fn half_blocks_draw_two_rows_per_line() {
    let (_, png) = picture(4, 3, |x, y| [x as u8, y as u8, 7]);
    let text = String::from_utf8(draw(&png, Protocol::Half, &Window::default(), 0).unwrap()).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 2);
    assert!(lines.iter().all(|l| l.matches('▀').count() == 4 && l.ends_with("\x1b[0m")));
    assert!(lines[0].starts_with("\x1b[38;2;0;0;7;48;2;0;1;7m▀"));
    assert!(lines[1].contains(";49m"), "nothing below the last row");
}

#[test]
fn what_is_no_picture_is_refused() {
    for protocol in [Protocol::Kitty, Protocol::Iterm, Protocol::Sixel, Protocol::Half] {
        assert!(draw(b"no picture", protocol, &Window::default(), 0).is_err());
    }
}

//! Protocols that take a PNG as it is.

use std::fmt::Write;

/// Most bytes of base64 in one command of the kitty protocol.
const CHUNK: usize = 4096;

/// Number of our picture among those of the window; drawing it again replaces it.
const PICTURE: u32 = 0xC01F;

/// The kitty graphics protocol: `a=T` transmit and show, `f=100` PNG, `q=2` no answers, `c`, `r` cells to fill.
pub fn kitty(png: &[u8], columns: u32, rows: u32) -> Vec<u8> {
    let coded = base64(png);
    let mut out = format!("\x1b_Ga=d,d=I,i={PICTURE},q=2\x1b\\");
    let chunks = coded.as_bytes().chunks(CHUNK);
    let last = chunks.len().saturating_sub(1);
    for (i, chunk) in chunks.enumerate() {
        let more = u8::from(i < last);
        let _ = match i {
            0 => write!(out, "\x1b_Ga=T,f=100,i={PICTURE},q=2,c={columns},r={rows},m={more};"),
            _ => write!(out, "\x1b_Gm={more},q=2;"),
        };
        // Base64 is ASCII.
        out.extend(chunk.iter().map(|&b| char::from(b)));
        out.push_str("\x1b\\");
    }
    out.push_str("\r\n");
    out.into_bytes()
}

/// Inline images of iTerm2: OSC 1337, the size in cells.
pub fn iterm(png: &[u8], columns: u32, rows: u32) -> Vec<u8> {
    let size = png.len();
    let coded = base64(png);
    format!("\x1b]1337;File=inline=1;size={size};width={columns};height={rows};preserveAspectRatio=1:{coded}\x07\r\n")
        .into_bytes()
}

/// RFC 4648, section 4, with padding.
pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|i| u32::from(chunk.get(i).copied().unwrap_or(0)));
        let word = a << 16 | b << 8 | c;
        for i in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * i) & 63) as usize];
            out.push(if i <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    out
}

//! Lua's words, as far as finding places in a script needs them.

use std::ops::Range;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A name or a keyword.
    Name,
    /// A string, quotes included.
    Text,
    /// A number.
    Number,
    /// One character of anything else.
    Mark,
    /// A comment or white space.
    Blank,
}

/// One word of a script.
#[derive(Clone, Copy, Debug)]
pub struct Token<'a> {
    /// What it is.
    pub kind: Kind,
    /// As written.
    pub text: &'a str,
    /// First byte.
    pub start: usize,
    /// Line on which it begins, from 1.
    pub line: usize,
}

impl Token<'_> {
    /// Its bytes.
    pub fn range(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }
}

/// All tokens of a text, in order and without gaps; text that is not Lua becomes marks.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut out = vec![];
    let (mut start, mut line) = (0, 1);
    while start < text.len() {
        let (kind, length) = next(&text[start..]);
        let word = &text[start..start + length];
        out.push(Token { kind, text: word, start, line });
        line += word.matches('\n').count();
        start += length;
    }
    out
}

/// Kind and length in bytes of the first token of a text that is not empty.
fn next(text: &str) -> (Kind, usize) {
    let bytes = text.as_bytes();
    let run = |from: usize, is_part: fn(u8) -> bool| from + bytes[from..].iter().take_while(|&&b| is_part(b)).count();
    match bytes[0] {
        b'-' if text.starts_with("--") => {
            let length = long_bracket(&text[2..]).map_or_else(|| text.find('\n').unwrap_or(text.len()), |n| n + 2);
            (Kind::Blank, length)
        }
        b'[' => match long_bracket(text) {
            Some(length) => (Kind::Text, length),
            None => (Kind::Mark, 1),
        },
        quote @ (b'"' | b'\'' | b'`') => (Kind::Text, string(bytes, quote)),
        b if b.is_ascii_whitespace() => (Kind::Blank, run(0, |b| b.is_ascii_whitespace())),
        b if b.is_ascii_alphabetic() || b == b'_' => (Kind::Name, run(0, |b| b.is_ascii_alphanumeric() || b == b'_')),
        b if b.is_ascii_digit() => (Kind::Number, run(0, |b| b.is_ascii_alphanumeric() || b == b'.' || b == b'_')),
        b'.' if bytes.get(1).is_some_and(u8::is_ascii_digit) => {
            (Kind::Number, run(1, |b| b.is_ascii_alphanumeric() || b == b'_'))
        }
        _ => (Kind::Mark, text.chars().next().map_or(1, char::len_utf8)),
    }
}

/// Length of `[[ ... ]]` or `[==[ ... ]==]` at the start of a text.
fn long_bracket(text: &str) -> Option<usize> {
    let rest = text.strip_prefix('[')?;
    let level = rest.bytes().take_while(|&b| b == b'=').count();
    if rest.as_bytes().get(level) != Some(&b'[') {
        return None;
    }
    let close = format!("]{}]", "=".repeat(level));
    Some(text.find(&close).map_or(text.len(), |i| i + close.len()))
}

/// Length of a quoted string; it ends at the line's end when it is never closed.
fn string(bytes: &[u8], quote: u8) -> usize {
    let mut i = 1;
    while i < bytes.len() {
        match bytes[i] {
            b'\\' => i += 1,
            b'\n' if quote != b'`' => return i,
            b if b == quote => return i + 1,
            _ => {}
        }
        i += 1;
    }
    bytes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost() {
        for text in ["", "a.b:c{1,'x\\'y'}", "--[==[ a ]] ]==] x", "[[", "\"open\nnext", "é = 1 -- ü", "\\", "x = \"\\"]
        {
            assert_eq!(tokens(text).iter().map(|t| t.text).collect::<String>(), text);
        }
    }

    #[test]
    fn lines_are_counted() {
        let all = tokens("a\n--[[\n\n]] b\n'c'");
        let lines: Vec<_> = all.iter().filter(|t| t.kind != Kind::Blank).map(|t| (t.text, t.line)).collect();
        assert_eq!(lines, [("a", 1), ("b", 4), ("'c'", 5)]);
    }
}

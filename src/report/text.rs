//! Text for a terminal, from names, files and devices that may hold anything.

use std::borrow::Cow;

/// The text with its control characters, and those that turn the direction of writing about, as JSON writes them:
/// `\u001b`. Line breaks stay, and so do styles (bold, dim, colours) where `has_styles`.
pub fn escaped(text: &str, has_styles: bool) -> Cow<'_, str> {
    if is_plain(text) || !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let style = if has_styles { style(rest) } else { None };
        let length = style.map_or(first.len_utf8(), str::len);
        match style {
            Some(style) => shown.push_str(style),
            None if is_hidden(first) => shown.push_str(&format!("\\u{:04x}", u32::from(first))),
            None => shown.push(first),
        }
        rest = &rest[length..];
    }
    Cow::Owned(shown)
}

/// [`escaped`] on one line.
pub fn one_line(text: &str) -> String {
    escaped(text, false).replace('\n', "\\u000a")
}

/// Printable ASCII and line breaks alone. Blocks are looked at as a whole: an output may have a hundred million characters.
fn is_plain(text: &str) -> bool {
    let is_plain = |byte: &u8| matches!(byte, b'\n' | b' '..=b'~');
    text.as_bytes().chunks(64).all(|block| block.iter().fold(true, |all, byte| all & is_plain(byte)))
}

fn is_hidden(character: char) -> bool {
    match character {
        '\n' => false,
        '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        other => other.is_control(),
    }
}

/// The sequence that `text` begins with, if it sets bold, dim, underlined, or a colour of text, or resets them.
fn style(text: &str) -> Option<&str> {
    let parameters = text.strip_prefix("\x1b[")?;
    let end = parameters.find(|c: char| !c.is_ascii_digit() && c != ';')?;
    let is_style = |part: &str| {
        matches!(part, "" | "0" | "1" | "2" | "4" | "22" | "24" | "39") || matches!(part.parse(), Ok(30..=37 | 90..=97))
    };
    let is_known = parameters[end..].starts_with('m') && parameters[..end].split(';').all(is_style);
    is_known.then(|| &text[..2 + end + 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_hides_or_retitles_is_shown() {
        for (text, shown) in [
            ("plain ± 1 µm\n", "plain ± 1 µm\n"),
            ("\x1b]0;owned\x07", "\\u001b]0;owned\\u0007"),
            ("\x1b[2J\r\x08\x7f\u{9b}31m", "\\u001b[2J\\u000d\\u0008\\u007f\\u009b31m"),
            ("a\u{202e}gnp.exe", "a\\u202egnp.exe"),
            ("\x1b[1mbold\x1b[0m", "\\u001b[1mbold\\u001b[0m"),
        ] {
            assert_eq!(escaped(text, false), shown);
        }
        assert_eq!(one_line("a\nerror: b"), "a\\u000aerror: b");
    }

    #[test]
    fn styles_pass_and_nothing_else_does() {
        for text in ["\x1b[1mbold\x1b[0m", "\x1b[1;31mred\x1b[m", "\x1b[33m\x1b[2m"] {
            assert_eq!(escaped(text, true), text);
        }
        for text in ["\x1b[8m", "\x1b[31", "\x1b[1;5m", "\x1b[31;1H", "\x1b[", "\x1b"] {
            assert!(!escaped(text, true).contains('\x1b'), "{text:?}");
        }
    }
}

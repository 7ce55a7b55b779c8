//! The words of a geometry script, as gmsh's own scanner sees them.

/// Longest string that gmsh reads (bytes); what follows in a longer one it takes for commands.
pub(super) const LONGEST_STRING: usize = 1023;

/// A word of a script.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Token<'s> {
    /// A name or a keyword.
    Word(&'s str),
    /// A string, without its quotes.
    Text(&'s [u8]),
    /// Any other byte that is no white space.
    Mark(u8),
}

/// The words of a script, each with its line (from 1); comments are left out.
#[derive(Clone)]
pub(super) struct Tokens<'s> {
    script: &'s [u8],
    at: usize,
    line: usize,
}

impl<'s> Tokens<'s> {
    pub(super) fn of(script: &'s [u8]) -> Self {
        Self {
            script,
            at: 0,
            line: 1,
        }
    }

    fn advance(&mut self, length: usize) -> &'s [u8] {
        let piece = &self.script[self.at..self.at + length];
        self.line += memchr::memchr_iter(b'\n', piece).count();
        self.at += length;
        piece
    }
}

impl<'s> Iterator for Tokens<'s> {
    type Item = (usize, Token<'s>);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let rest = &self.script[self.at..];
            let first = *rest.first()?;
            let line = self.line;
            if first.is_ascii_whitespace() || comment_length(rest).is_some() {
                self.advance(comment_length(rest).unwrap_or(1));
            } else if matches!(first, b'"' | b'\'') {
                let string = self.advance(string_length(rest));
                let inside = string
                    .strip_suffix(&[first])
                    .filter(|text| !text.is_empty());
                return Some((line, Token::Text(&inside.unwrap_or(string)[1..])));
            } else if is_of_word(first) && !first.is_ascii_digit() {
                let length = rest.iter().take_while(|&&byte| is_of_word(byte)).count();
                let word = std::str::from_utf8(self.advance(length)).unwrap_or_default();
                return Some((line, Token::Word(word)));
            } else {
                self.advance(1);
                return Some((line, Token::Mark(first)));
            }
        }
    }
}

fn is_of_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// Length of the comment that `rest` begins with. For gmsh it also ends where a byte is zero.
pub(super) fn comment_length(rest: &[u8]) -> Option<usize> {
    if rest.starts_with(b"//") {
        return Some(memchr::memchr2(b'\n', 0, rest).unwrap_or(rest.len()));
    }
    let inside = rest.strip_prefix(b"/*")?;
    let closed = memchr::memmem::find(inside, b"*/").map(|at| at + 4);
    let broken = memchr::memchr(0, inside).map(|at| at + 3);
    let end = [closed, broken].into_iter().flatten().min();
    Some(end.unwrap_or(rest.len()))
}

/// Length of the string that `rest` begins with, quotes included. A backslash means nothing.
pub(super) fn string_length(rest: &[u8]) -> usize {
    let end = memchr::memchr2(rest[0], 0, &rest[1..]).map(|at| at + 2);
    end.unwrap_or(rest.len()).min(LONGEST_STRING + 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(script: &str) -> Vec<(usize, &str)> {
        let word = |(line, token)| match token {
            Token::Word(word) => Some((line, word)),
            _ => None,
        };
        Tokens::of(script.as_bytes()).filter_map(word).collect()
    }

    #[test]
    fn comments_and_strings_hold_no_words() {
        let script = "a /* b\nc */ d // e 'f\n\"g ' h\" i 'j \" k' l_1 1m\n/* n";
        let expected = [(1, "a"), (2, "d"), (3, "i"), (3, "l_1"), (3, "m")];
        assert_eq!(words(script), expected);
    }

    #[test]
    fn strings_keep_their_bytes() {
        let tokens: Vec<_> = Tokens::of(b"x = \"a\\\";'' \"")
            .map(|(_, token)| token)
            .collect();
        let expected = [
            Token::Word("x"),
            Token::Mark(b'='),
            Token::Text(b"a\\"),
            Token::Mark(b';'),
            Token::Text(b""),
            Token::Text(b""),
        ];
        assert_eq!(tokens, expected);
    }

    #[test]
    fn what_gmsh_reads_behind_a_broken_string_or_comment_is_read() {
        for broken in [
            "\"a\0b;".to_owned(),
            "// a\0b;".to_owned(),
            "/* a\0b;".to_owned(),
            format!("'{}b;", "/".repeat(LONGEST_STRING + 1)),
        ] {
            assert_eq!(words(&broken), [(1, "b")], "{broken:?}");
        }
    }
}

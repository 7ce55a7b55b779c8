//! Refuses expressions that mathematics reads otherwise than the parser, which binds signs and
//! functions without parentheses closer than powers, and powers from the left.

/// A part of an expression.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Token<'a> {
    Name(&'a str),
    Number,
    Open,
    Close,
    Operator(char),
}

/// Looks for signs and names of functions before powers, and for powers of powers.
///
/// # Errors
/// What is ambiguous, and how to write it.
pub(crate) fn check(text: &str, functions: &[String]) -> Result<(), [String; 2]> {
    let tokens = tokens(text);
    for (index, token) in tokens.iter().enumerate() {
        let Token::Operator(sign) = *token else {
            if let Token::Name(name) = *token
                && functions.iter().any(|function| function == name)
                && tokens.get(index + 1) != Some(&Token::Open)
            {
                let problem = format!("the function {name} has no parentheses");
                return Err([problem, format!("write {name}(...)")]);
            }
            continue;
        };
        let is_sign = (sign == '-' || sign == '+') && is_start(&tokens[..index]);
        if is_sign && is_power(&tokens, operand_end(&tokens, index + 1)) {
            let problem = format!("a sign before a power is ambiguous: {sign}a^b");
            return Err([problem, format!("write {sign}(a^b) or ({sign}a)^b")]);
        }
        if sign == '^' && is_power(&tokens, operand_end(&tokens, index + 1)) {
            let problem = "a power of a power is ambiguous: a^b^c".to_owned();
            return Err([problem, "write a^(b^c) or (a^b)^c".to_owned()]);
        }
    }
    Ok(())
}

/// Whether what follows `before` begins an operand.
fn is_start(before: &[Token<'_>]) -> bool {
    matches!(before.last(), None | Some(Token::Open | Token::Operator(_)))
}

fn is_power(tokens: &[Token<'_>], at: usize) -> bool {
    tokens.get(at) == Some(&Token::Operator('^'))
}

/// Behind the operand that begins here, with its signs and its function.
fn operand_end(tokens: &[Token<'_>], mut at: usize) -> usize {
    while matches!(tokens.get(at), Some(Token::Operator('-' | '+'))) {
        at += 1;
    }
    if matches!(tokens.get(at), Some(Token::Name(_) | Token::Number)) {
        at += 1;
    }
    if tokens.get(at) != Some(&Token::Open) {
        return at;
    }
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate().skip(at) {
        match token {
            Token::Open => depth += 1,
            Token::Close => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return index + 1;
        }
    }
    tokens.len()
}

fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = match first {
            'a'..='z' | 'A'..='Z' | '_' => word(rest, |c| c.is_alphanumeric() || c == '_'),
            '0'..='9' | '.' => number(rest),
            other => other.len_utf8(),
        };
        let (own, after) = rest.split_at(length);
        tokens.push(match first {
            'a'..='z' | 'A'..='Z' | '_' => Token::Name(own),
            '0'..='9' | '.' => Token::Number,
            '(' => Token::Open,
            ')' => Token::Close,
            other => Token::Operator(other),
        });
        rest = after.trim_start();
    }
    tokens
}

fn word(text: &str, belongs: impl Fn(char) -> bool) -> usize {
    text.find(|c| !belongs(c)).unwrap_or(text.len())
}

/// Length of a number with its exponent.
fn number(text: &str) -> usize {
    let digits = word(text, |c| c.is_ascii_digit() || c == '.');
    let Some(exponent) = text[digits..].strip_prefix(['e', 'E']) else {
        return digits;
    };
    let unsigned = exponent.strip_prefix(['-', '+']).unwrap_or(exponent);
    match word(unsigned, |c| c.is_ascii_digit()) {
        0 => digits,
        more => text.len() - unsigned.len() + more,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_before_powers_are_refused_and_others_are_not() {
        let functions = ["sin".to_owned()];
        for text in [
            "-x^2",
            "3*-x^2",
            "-sin(x)^2",
            "-(x+1)^2",
            "2^-x^2",
            "x^2^3",
            "min(1, -x^2)",
            "sin x^2",
            "--x^2",
        ] {
            assert!(check(text, &functions).is_err(), "{text}");
        }
        for text in [
            "2-x^2",
            "-(x^2)",
            "(-x)^2",
            "1e-3^2",
            "2^-1",
            "x^2-y^2",
            "-x*y^2",
            "(x^2)^3",
            "min(-1, x^2)",
            "x^sin(2)",
            "sin(x)^2",
            ")x",
            "((-",
        ] {
            assert_eq!(check(text, &functions), Ok(()), "{text}");
        }
    }
}

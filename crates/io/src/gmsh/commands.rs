//! Commands of a script that do more than describe a body: they run programs, or open files.

use super::script::{Token, Tokens};

/// What a command does to the machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Effect {
    /// It runs a program.
    Runs,
    /// It writes a file, or sends something away.
    Writes,
    /// It opens the file of this name.
    Opens(String),
    /// It asks the machine for something: a variable, the time, whether a file is there.
    Asks,
    /// It opens a file, or is a command, whose name is only known when it runs.
    Computed,
}

/// A command with an effect.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Command<'s> {
    pub(super) line: usize,
    pub(super) word: &'s str,
    pub(super) effect: Effect,
}

/// All commands of a script that have an effect, also those that it may never reach.
pub(super) fn commands(script: &[u8]) -> Vec<Command<'_>> {
    let mut found = Vec::new();
    let mut tokens = Tokens::of(script);
    let mut before = None;
    while let Some((line, token)) = tokens.next() {
        if let Token::Word(word) = token
            && let Some(effect) = effect(word, before, Ahead(tokens.clone()))
        {
            found.push(Command { line, word, effect });
        }
        before = Some(token);
    }
    found
}

fn effect(word: &str, before: Option<Token>, mut ahead: Ahead) -> Option<Effect> {
    let is_member = before == Some(Token::Mark(b'.'));
    match word {
        "SystemCall" | "NonBlockingSystemCall" | "OnelabRun" | "ExternalProcess" => {
            Some(Effect::Runs)
        }
        "GetEnv" | "FileExists" | "Today" | "Cpu" | "Memory" | "TotalMemory" => Some(Effect::Asks),
        "System" => ahead.is_argument().then_some(Effect::Runs),
        "Solver" => ahead.names_a_program().then_some(Effect::Runs),
        "CreateDir" => Some(Effect::Writes),
        "Save" | "Print" | "SendToServer" => {
            (!is_member && ahead.is_argument()).then_some(Effect::Writes)
        }
        "Printf" => ahead.is_redirected().then_some(Effect::Writes),
        "Include" | "Merge" | "MergeWithBoundingBox" => {
            ahead.is_argument().then(|| ahead.name(b";"))
        }
        "ListFromFile" | "ShapeFromFile" => (ahead.next_is(b"([")).then(|| ahead.name(b")]")),
        "FileName" if is_member => ahead.next_is(b"=").then(|| ahead.name(b";")),
        "StringToName" | "S2N" => ahead.next_is(b"([").then_some(Effect::Computed),
        _ => None,
    }
}

/// What stands behind a word.
struct Ahead<'s>(Tokens<'s>);

impl<'s> Ahead<'s> {
    fn next(&mut self) -> Option<Token<'s>> {
        self.0.next().map(|(_, token)| token)
    }

    fn next_is(&mut self, marks: &[u8]) -> bool {
        matches!(self.next(), Some(Token::Mark(mark)) if marks.contains(&mark))
    }

    /// Whether a text stands there, or what makes one.
    fn is_argument(&self) -> bool {
        let next = self.0.clone().next();
        matches!(next, Some((_, Token::Text(_) | Token::Word(_))))
    }

    /// `.Executable0 = "PROGRAM"` and the like.
    fn names_a_program(&mut self) -> bool {
        let options = ["Executable", "RemoteLogin", "Extension"];
        let is_one = |word: &str| options.iter().any(|option| word.starts_with(option));
        self.next_is(b".") && matches!(self.next(), Some(Token::Word(word)) if is_one(word))
    }

    /// `(...) > FILE` or `(...) >> FILE`.
    fn is_redirected(&mut self) -> bool {
        let mut depth = 0_usize;
        while let Some(token) = self.next() {
            match token {
                Token::Mark(b'(' | b'[') => depth += 1,
                Token::Mark(b')' | b']') => depth = depth.saturating_sub(1),
                Token::Mark(b';') => return false,
                _ => {}
            }
            if depth == 0 {
                return self.next_is(b">");
            }
        }
        false
    }

    /// A name, written out and ended by one of the marks.
    fn name(&mut self, ends: &[u8]) -> Effect {
        let name = match self.next() {
            Some(Token::Text(name)) => std::str::from_utf8(name).ok(),
            _ => None,
        };
        match name {
            Some(name) if self.next_is(ends) => Effect::Opens(name.to_owned()),
            _ => Effect::Computed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effects(script: &str) -> Vec<Effect> {
        let found = commands(script.as_bytes()).into_iter();
        found.map(|command| command.effect).collect()
    }

    #[test]
    fn programs_and_files_are_found() {
        let opens = |name: &str| Effect::Opens(name.to_owned());
        for (script, effect) in [
            ("SystemCall \"a\";", Effect::Runs),
            ("If(0)\nSystemCall Str(\"a\");\nEndIf", Effect::Runs),
            ("System /* */ 'a';", Effect::Runs),
            ("NonBlockingSystemCall \"a\";", Effect::Runs),
            ("OnelabRun(\"a\", \"b\");", Effect::Runs),
            ("Field[1] = ExternalProcess;", Effect::Runs),
            ("Solver.Executable0 = \"a\";", Effect::Runs),
            ("Printf(\"%g (\", f(1)) > \"a\";", Effect::Writes),
            ("Printf(\"x\") >> a;", Effect::Writes),
            ("Save \"a.msh\";", Effect::Writes),
            ("Save View[0] \"a\";", Effect::Writes),
            ("Print Str(\"a\");", Effect::Writes),
            ("CreateDir \"a\";", Effect::Writes),
            ("Merge \"a.step\";", opens("a.step")),
            ("Include 'a';", opens("a")),
            ("x() = ListFromFile(\"a\");", opens("a")),
            ("Field[2].FileName = \"a\";", opens("a")),
            ("Merge StrCat(\"a\", \"b\");", Effect::Computed),
            ("Include name;", Effect::Computed),
            ("v() = ShapeFromFile(name);", Effect::Computed),
            ("StringToName[\"SystemCall\"] \"a\";", Effect::Computed),
        ] {
            assert_eq!(effects(script), [effect], "{script}");
        }
    }

    #[test]
    fn what_only_looks_like_it_is_left_alone() {
        for script in [
            "// SystemCall \"a\";\n/* Save \"b\"; */ x = \"Merge 'c';\";",
            "Printf(\"x > %g\", a > 1);",
            "Print.Background = 1; Mesh.SaveAll = 1; System = 2; Save = 3;",
            "Solver.AutoMesh = 0; Geometry.SystemCalls = 1;",
            "If(x > 1) Printf(\"a\"); EndIf y = 2 > 1;",
            "Merge",
            "Printf(",
        ] {
            assert_eq!(effects(script), [], "{script}");
        }
    }

    #[test]
    fn lines_count_from_one() {
        let found = commands(b"a;\n// b\n\"c\nd\"; SystemCall \"e\";");
        assert_eq!((found[0].line, found[0].word), (4, "SystemCall"));
    }
}

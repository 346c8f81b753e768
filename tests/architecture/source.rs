//! The names that a source file uses, from its text.

/// A path of names.
pub(crate) type Names = Vec<String>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Token<'a> {
    Name(&'a str),
    PathSeparator,
    Sign(char),
}

/// The code without comments, literals and white space.
fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_in_name = |c: char| c.is_alphanumeric() || c == '_';
        let length = if first.is_whitespace() {
            first.len_utf8()
        } else if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            length_of_comment(rest)
        } else if is_raw_string(rest) {
            let fences = rest[1..].chars().take_while(|&c| c == '#').count();
            let end = format!("\"{}", "#".repeat(fences));
            let body = 2 + fences;
            body + rest[body..].find(&end).expect("raw strings end") + end.len()
        } else if first == '"' {
            length_of_literal(rest, '"')
        } else if first == '\'' {
            let mut next = rest[1..].chars();
            match (next.next(), next.next()) {
                (Some('\\'), _) | (Some(_), Some('\'')) => length_of_literal(rest, '\''),
                // A lifetime.
                _ => 1,
            }
        } else if rest.starts_with("::") {
            tokens.push(Token::PathSeparator);
            2
        } else if is_in_name(first) {
            let length = rest.find(|c| !is_in_name(c)).unwrap_or(rest.len());
            tokens.push(Token::Name(&rest[..length]));
            length
        } else {
            tokens.push(Token::Sign(first));
            first.len_utf8()
        };
        rest = &rest[length..];
    }
    tokens
}

fn is_raw_string(text: &str) -> bool {
    let fenced = text.strip_prefix('r');
    fenced.is_some_and(|text| text.trim_start_matches('#').starts_with('"'))
}

/// The length of a comment; comments nest.
fn length_of_comment(text: &str) -> usize {
    let mut depth = 0;
    for at in 0..text.len() - 1 {
        match &text.as_bytes()[at..at + 2] {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + 2;
        }
    }
    text.len()
}

fn length_of_literal(text: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            _ if c == quote => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// The code without the items that exist only in tests.
fn without_tests<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    use Token::{Name, Sign};
    const TEST: [Token<'_>; 7] = [
        Sign('#'),
        Sign('['),
        Name("cfg"),
        Sign('('),
        Name("test"),
        Sign(')'),
        Sign(']'),
    ];
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if !tokens[at..].starts_with(&TEST) {
            kept.push(tokens[at]);
            at += 1;
            continue;
        }
        // The item ends with a semicolon, or with the block that it opens.
        let mut depth = 0;
        while at < tokens.len() {
            match tokens[at] {
                Sign('{') => depth += 1,
                Sign('}') => depth -= 1,
                _ => {}
            }
            at += 1;
            if depth == 0 && matches!(tokens[at - 1], Sign(';' | '}')) {
                break;
            }
        }
    }
    kept
}

/// All names in the code, without tests, comments and literals.
pub(crate) fn names(text: &str) -> Vec<&str> {
    let all = tokens(text);
    let code = without_tests(&all).into_iter();
    code.filter_map(|token| match token {
        Token::Name(name) => Some(name),
        _ => None,
    })
    .collect()
}

/// A file of `src/`, with the names that it uses.
#[derive(Debug, Default)]
pub(crate) struct Module {
    pub(crate) file: String,
    pub(crate) children: Names,
    /// The paths that its `use` declarations name, and the names that they get here.
    pub(crate) imports: Vec<(Names, String)>,
    /// Paths outside `use` declarations.
    pub(crate) paths: Vec<Names>,
}

impl Module {
    pub(crate) fn of(file: String, text: &str) -> Module {
        let all = tokens(text);
        let code = without_tests(&all);
        let mut module = Module {
            file,
            ..Module::default()
        };
        let mut at = 0;
        while at < code.len() {
            at += match code[at..] {
                [Token::Name("mod"), Token::Name(child), Token::Sign(';'), ..] => {
                    module.children.push(child.to_owned());
                    3
                }
                [Token::Name("use"), ref tree @ ..] => 1 + module.add_imports(&Names::new(), tree),
                [Token::Name(first), Token::PathSeparator, ..] => {
                    let mut path = vec![first.to_owned()];
                    let mut end = at + 1;
                    while let [Token::PathSeparator, Token::Name(next), ..] = code[end..] {
                        path.push(next.to_owned());
                        end += 2;
                    }
                    module.paths.push(path);
                    end - at
                }
                _ => 1,
            };
        }
        module
    }

    /// Adds the names in a tree of imports below a path, and returns its length.
    fn add_imports(&mut self, above: &Names, tree: &[Token<'_>]) -> usize {
        let mut path = above.clone();
        let mut at = 0;
        loop {
            match tree[at..] {
                [Token::PathSeparator, ..] => at += 1,
                [Token::Sign('{'), ..] => {
                    at += 1;
                    while tree[at] != Token::Sign('}') {
                        at += self.add_imports(&path, &tree[at..]);
                        at += usize::from(tree[at] == Token::Sign(','));
                    }
                    return at + 1;
                }
                [Token::Sign('*'), ..] => {
                    self.imports.push((path, "*".to_owned()));
                    return at + 1;
                }
                [Token::Name("as"), Token::Name(name), ..] => {
                    self.imports.push((path, name.to_owned()));
                    return at + 2;
                }
                [Token::Name("self"), ..] if !above.is_empty() => at += 1,
                [Token::Name(name), ..] => {
                    path.push(name.to_owned());
                    at += 1;
                }
                _ => {
                    // Without a path it is a list of captures: `impl Trait + use<'_>`.
                    if let Some(name) = path.last().cloned() {
                        self.imports.push((path, name));
                    }
                    return at;
                }
            }
        }
    }
}

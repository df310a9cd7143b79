//! Includes, resolved before either compiler sees the text, and the way back from a line of that text to its file.

use std::fs;
use std::path::{Component, Path, PathBuf};

use super::error::{DirectiveProblem, Error};

/// A shader with its includes pasted in.
#[derive(Debug)]
pub struct Source {
    /// Text for the compilers. It is ASCII: any other character, legal in comments only, became `?`.
    pub text: String,
    files: Vec<PathBuf>,
    /// For each line of `text`: index into `files`, line in that file from 1.
    origins: Vec<(usize, usize)>,
}

impl Source {
    /// Reads the shader `name` (a path below `root`) and everything it includes.
    ///
    /// # Errors
    /// A file that cannot be read, a first line other than `#version 450`, and an include that is
    /// misspelt, missing, cyclic or conditional.
    pub fn read(root: &Path, name: &str) -> Result<Source, Error> {
        let path = root.join(name);
        let text = read_text(&path)?;
        if text.lines().next().map(str::trim_end) != Some("#version 450") {
            return Err(Error::Version { path });
        }
        let mut source = Source { text: String::new(), files: vec![path], origins: Vec::new() };
        source.append(root, &text, &mut vec![0])?;
        Ok(source)
    }

    /// The file and the line in it, from 1, behind line `line`, from 1, of the text.
    pub fn origin(&self, line: usize) -> Option<(&Path, usize)> {
        let &(file, line) = self.origins.get(line.checked_sub(1)?)?;
        Some((&self.files[file], line))
    }

    /// The shader's own file.
    pub fn path(&self) -> &Path {
        &self.files[0]
    }

    /// Appends the text of the file on top of `stack` (indices into `files`, includer first).
    fn append(&mut self, root: &Path, text: &str, stack: &mut Vec<usize>) -> Result<(), Error> {
        let file = stack[stack.len() - 1];
        let mut in_comment = false;
        let mut condition_depth = 0_usize;
        for (index, line) in text.lines().enumerate() {
            let line_number = index + 1;
            let problem = |problem| Error::Directive { path: self.files[file].clone(), line: line_number, problem };
            let directive = (!in_comment).then(|| split_directive(line)).flatten();
            in_comment = ends_in_comment(line, in_comment);
            match directive {
                Some(("include", rest)) => {
                    if condition_depth > 0 {
                        return Err(problem(DirectiveProblem::IncludeConditional));
                    }
                    let name = quoted(rest).ok_or_else(|| problem(DirectiveProblem::IncludeSyntax))?;
                    let path = resolve(root, name)
                        .ok_or_else(|| problem(DirectiveProblem::IncludeMissing(name.to_owned())))?;
                    match self.files.iter().position(|known| *known == path) {
                        Some(known) if stack.contains(&known) => {
                            let chain = self.describe_cycle(root, stack, known);
                            return Err(problem(DirectiveProblem::IncludeCycle(chain)));
                        }
                        Some(_) => self.push_line("", file, line_number),
                        None => {
                            let included = read_text(&path)?;
                            self.files.push(path);
                            stack.push(self.files.len() - 1);
                            self.append(root, &included, stack)?;
                            stack.pop();
                        }
                    }
                    continue;
                }
                Some(("line", _)) => return Err(problem(DirectiveProblem::Line)),
                Some(("if" | "ifdef" | "ifndef", _)) => condition_depth += 1,
                Some(("endif", _)) => condition_depth = condition_depth.saturating_sub(1),
                _ => {}
            }
            self.push_line(line, file, line_number);
        }
        Ok(())
    }

    fn push_line(&mut self, line: &str, file: usize, line_number: usize) {
        // glslang reports tokens byte by byte; ASCII keeps its log valid UTF-8.
        self.text.extend(line.chars().map(|c| match c {
            '\t' | ' '..='~' => c,
            c if c.is_ascii() => ' ',
            _ => '?',
        }));
        self.text.push('\n');
        self.origins.push((file, line_number));
    }

    fn describe_cycle(&self, root: &Path, stack: &[usize], start: usize) -> String {
        let cycle = stack.iter().skip_while(|&&file| file != start);
        let names = cycle.chain([&start]).map(|&file| {
            let path = &self.files[file];
            path.strip_prefix(root).unwrap_or(path).display().to_string()
        });
        names.collect::<Vec<_>>().join(" -> ")
    }
}

fn read_text(path: &Path) -> Result<String, Error> {
    fs::read_to_string(path).map_err(|source| Error::Read { path: path.to_owned(), source })
}

/// The existing file below `root` that an include names.
fn resolve(root: &Path, name: &str) -> Option<PathBuf> {
    let below_root = |part| matches!(part, Component::Normal(_));
    let path = root.join(name);
    (Path::new(name).components().all(below_root) && path.is_file()).then_some(path)
}

/// Splits `  # word rest` into word and rest.
fn split_directive(line: &str) -> Option<(&str, &str)> {
    let body = line.trim_start().strip_prefix('#')?.trim_start();
    let end = body.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(body.len());
    Some(body.split_at(end))
}

/// The text between quotes, when nothing but a comment follows.
fn quoted(rest: &str) -> Option<&str> {
    let (name, after) = rest.trim_start().strip_prefix('"')?.split_once('"')?;
    let after = after.trim();
    let complete = !name.is_empty() && (after.is_empty() || after.starts_with("//"));
    complete.then_some(name)
}

/// Whether a `/* */` comment is open at the end of a line.
fn ends_in_comment(line: &str, mut in_comment: bool) -> bool {
    let mut rest = line;
    loop {
        if in_comment {
            let Some((_, after)) = rest.split_once("*/") else {
                return true;
            };
            rest = after;
            in_comment = false;
        } else {
            let Some(open) = rest.find("/*") else {
                return false;
            };
            if rest.find("//").is_some_and(|comment| comment < open) {
                return false;
            }
            rest = &rest[open + 2..];
            in_comment = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    fn problem(files: &[(&str, &str)]) -> (String, usize, DirectiveProblem) {
        let folder = folder(files);
        match Source::read(folder.path(), "a.frag") {
            Err(Error::Directive { path, line, problem }) => {
                let name = path.strip_prefix(folder.path()).unwrap();
                (name.to_str().unwrap().to_owned(), line, problem)
            }
            other => panic!("expected a directive error, got {other:?}"),
        }
    }

    #[test]
    fn nested_includes_are_pasted_once_and_lines_map_back() {
        let folder = folder(&[
            (
                "a.frag",
                "#version 450\n#include \"common/outer.glsl\" // why\nint a;\n#include \"common/inner.glsl\"\nint b;\n",
            ),
            ("common/outer.glsl", "int outer1;\n  #  include \"common/inner.glsl\"\nint outer3;\n"),
            ("common/inner.glsl", "int inner1;\r\nint inner2;"),
        ]);
        let source = Source::read(folder.path(), "a.frag").unwrap();
        assert_eq!(source.text, "#version 450\nint outer1;\nint inner1;\nint inner2;\nint outer3;\nint a;\n\nint b;\n");
        let origin = |line| {
            let (path, line) = source.origin(line).unwrap();
            (path.file_name().unwrap().to_str().unwrap().to_owned(), line)
        };
        assert_eq!(origin(1), ("a.frag".to_owned(), 1));
        assert_eq!(origin(4), ("inner.glsl".to_owned(), 2));
        assert_eq!(origin(5), ("outer.glsl".to_owned(), 3));
        assert_eq!(origin(7), ("a.frag".to_owned(), 4));
        assert_eq!(origin(8), ("a.frag".to_owned(), 5));
        assert_eq!(source.origin(9), None);
        assert_eq!(source.origin(0), None);
    }

    #[test]
    fn a_cycle_names_its_chain_and_line() {
        let (file, line, problem) = problem(&[
            ("a.frag", "#version 450\n#include \"b.glsl\"\n"),
            ("b.glsl", "\n#include \"c.glsl\"\n"),
            ("c.glsl", "\n\n#include \"b.glsl\"\n"),
        ]);
        assert_eq!((file.as_str(), line), ("c.glsl", 3));
        assert_eq!(problem, DirectiveProblem::IncludeCycle("b.glsl -> c.glsl -> b.glsl".to_owned()));
    }

    #[test]
    fn broken_includes_name_file_and_line() {
        let shader = |second_line: &str| {
            let text = format!("#version 450\n{second_line}\n#endif\n");
            problem(&[("a.frag", &text), ("b.glsl", "")])
        };
        let cases = [
            ("#include \"none.glsl\"", DirectiveProblem::IncludeMissing("none.glsl".to_owned())),
            ("#include \"../b.glsl\"", DirectiveProblem::IncludeMissing("../b.glsl".to_owned())),
            ("#include \"/etc/hostname\"", DirectiveProblem::IncludeMissing("/etc/hostname".to_owned())),
            ("#include <b.glsl>", DirectiveProblem::IncludeSyntax),
            ("#include \"b.glsl\" x", DirectiveProblem::IncludeSyntax),
            ("#line 7", DirectiveProblem::Line),
        ];
        for (line, expected) in cases {
            assert_eq!(shader(line), ("a.frag".to_owned(), 2, expected), "{line}");
        }
        assert_eq!(
            shader("#if 1\n#include \"b.glsl\""),
            ("a.frag".to_owned(), 3, DirectiveProblem::IncludeConditional)
        );
    }

    #[test]
    fn includes_in_comments_are_left_alone() {
        let folder =
            folder(&[("a.frag", "#version 450\n// /* #include \"x\"\n/* a */ /* b\n#include \"x\"\n*/ int a; // é\n")]);
        let source = Source::read(folder.path(), "a.frag").unwrap();
        assert!(source.text.contains("\n#include \"x\"\n"));
        assert!(source.text.ends_with("int a; // ?\n"));
    }

    #[test]
    fn the_version_line_comes_first() {
        let folder = folder(&[("a.frag", "// comment\n#version 450\n")]);
        let error = Source::read(folder.path(), "a.frag").unwrap_err();
        assert!(matches!(error, Error::Version { .. }));
    }
}

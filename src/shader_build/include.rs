//! Includes, resolved before either compiler sees the text, and the way back from a line of that text to its file.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

use super::error::{DirectiveProblem, Error};
use super::variants::{self, Definition};

/// A shader with its includes pasted in.
#[derive(Debug)]
pub struct Source {
    /// Text for the compilers. It is ASCII: any other character, legal in comments only, became `?`.
    pub text: String,
    /// Definitions of its variant, in the order of the pragma.
    definitions: Vec<Definition>,
    files: Vec<PathBuf>,
    /// For each line of `text`: index into `files`, line in that file from 1.
    origins: Vec<(u32, u32)>,
}

impl Source {
    /// Reads the shaders that `file` (a path below `root`) makes, one for each of its variants, with everything they
    /// include; with each its name. All are in memory at once.
    ///
    /// # Errors
    /// A file that cannot be read, a first line other than `#version 450`, an include that is misspelt, missing, cyclic
    /// or conditional, variants that are misspelt or misplaced, and a text that is too long.
    pub fn read_variants(root: &Path, file: &str) -> Result<Vec<(String, Source)>, Error> {
        let files = Files::of(root);
        let (variants, _) = Source::list_variants(&files, file)?;
        let read = |definitions: Vec<Definition>| {
            let name = variants::shader_name(file, &definitions);
            Ok((name, Source::read(&files, file, definitions)?))
        };
        variants.into_iter().map(read).collect()
    }

    /// The variants that `file` (a path below the folder of `files`) makes, by their definitions, and the bytes that it has.
    ///
    /// # Errors
    /// A file that cannot be read, and variants that are misspelt.
    pub(super) fn list_variants(files: &Files<'_>, file: &str) -> Result<(Vec<Vec<Definition>>, usize), Error> {
        let path = files.root.join(file);
        let text = files.text(&path)?;
        let pragma = lines(&text).find_map(|(line, _, directive)| match directive {
            Some(("pragma", rest)) => Some((line, variant_list(rest)?)),
            _ => None,
        });
        let variants = match pragma {
            None => vec![Vec::new()],
            Some((line, list)) => {
                variants::parse(list).map_err(|problem| Error::Directive { path: path.clone(), line, problem })?
            }
        };
        Ok((variants, text.len()))
    }

    /// Reads one variant of a file of [`Source::list_variants`], with everything that it includes.
    ///
    /// # Errors
    /// A file that cannot be read, a first line other than `#version 450`, an include that is misspelt, missing, cyclic
    /// or conditional, variants that are misplaced, and a text that is too long.
    pub(super) fn read(files: &Files<'_>, file: &str, definitions: Vec<Definition>) -> Result<Source, Error> {
        let path = files.root.join(file);
        let text = files.text(&path)?;
        if text.lines().next().map(str::trim_end) != Some("#version 450") {
            return Err(Error::Version { path });
        }
        let mut source = Source { text: String::new(), definitions, files: vec![path], origins: Vec::new() };
        source.append(files, &text, &mut vec![0])?;
        Ok(source)
    }

    /// The file and the line in it, from 1, behind line `line`, from 1, of the text.
    pub fn origin(&self, line: usize) -> Option<(&Path, usize)> {
        let &(file, line) = self.origins.get(line.checked_sub(1)?)?;
        Some((&self.files[file as usize], line as usize))
    }

    /// The shader's own file.
    pub fn path(&self) -> &Path {
        &self.files[0]
    }

    /// Appends the text of the file on top of `stack` (indices into `files`, includer first).
    fn append(&mut self, files: &Files<'_>, text: &str, stack: &mut Vec<usize>) -> Result<(), Error> {
        let file = stack[stack.len() - 1];
        let mut condition_depth = 0_usize;
        let mut has_variants = false;
        for (line_number, line, directive) in lines(text) {
            let problem = |problem| Error::Directive { path: self.files[file].clone(), line: line_number, problem };
            match directive {
                Some(("include", rest)) => {
                    if condition_depth > 0 {
                        return Err(problem(DirectiveProblem::IncludeConditional));
                    }
                    let name = quoted(rest).ok_or_else(|| problem(DirectiveProblem::IncludeSyntax))?;
                    let name = variants::substitute(name, &self.definitions);
                    let path =
                        files.find(&name).ok_or_else(|| problem(DirectiveProblem::IncludeMissing(name.clone())))?;
                    match self.files.iter().position(|known| *known == path) {
                        Some(known) if stack.contains(&known) => {
                            let chain = self.describe_cycle(files.root, stack, known);
                            return Err(problem(DirectiveProblem::IncludeCycle(chain)));
                        }
                        Some(_) => self.push_line("", file, line_number)?,
                        None => {
                            if stack.len() == MOST_NESTED {
                                return Err(problem(DirectiveProblem::IncludeDepth));
                            }
                            if self.files.len() == MOST_FILES {
                                return Err(problem(DirectiveProblem::IncludeCount));
                            }
                            let included = files.text(&path)?;
                            self.files.push(path);
                            stack.push(self.files.len() - 1);
                            self.append(files, &included, stack)?;
                            stack.pop();
                        }
                    }
                    continue;
                }
                Some(("pragma", rest)) if variant_list(rest).is_some() => {
                    if stack.len() > 1 || condition_depth > 0 || has_variants {
                        return Err(problem(DirectiveProblem::VariantsPlace));
                    }
                    has_variants = true;
                    let defines: Vec<String> = self.definitions.iter().map(variants::define).collect();
                    defines.iter().try_for_each(|define| self.push_line(define, file, line_number))?;
                    continue;
                }
                Some(("line", _)) => return Err(problem(DirectiveProblem::Line)),
                Some(("if" | "ifdef" | "ifndef", _)) => condition_depth += 1,
                Some(("endif", _)) => condition_depth = condition_depth.saturating_sub(1),
                _ => {}
            }
            self.push_line(line, file, line_number)?;
        }
        Ok(())
    }

    fn push_line(&mut self, line: &str, file: usize, line_number: usize) -> Result<(), Error> {
        if self.text.len() + line.len() >= MOST_TEXT {
            let problem = DirectiveProblem::TextLength;
            return Err(Error::Directive { path: self.files[file].clone(), line: line_number, problem });
        }
        // glslang reports tokens byte by byte; ASCII keeps its log valid UTF-8.
        self.text.extend(line.chars().map(|c| match c {
            '\t' | ' '..='~' => c,
            c if c.is_ascii() => ' ',
            _ => '?',
        }));
        self.text.push('\n');
        // Both are at most the bytes that were read, of which there are few.
        self.origins.push((file as u32, line_number as u32));
        Ok(())
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

/// Files that include each other.
const MOST_NESTED: usize = 64;
/// Of one file; the largest of our own has 16 KB.
const MOST_BYTES: u64 = 256 << 10;
/// Of a shader with its includes; the largest of our own has 53 KB.
const MOST_TEXT: usize = 512 << 10;
/// That a shader includes; our own include 25. Each is looked for among those before it.
const MOST_FILES: usize = 512;

/// The files of a shader folder, each read once: hundreds of shaders include the same ones.
pub(super) struct Files<'a> {
    root: &'a Path,
    texts: RefCell<HashMap<PathBuf, Rc<str>>>,
}

impl<'a> Files<'a> {
    /// None of them is read yet.
    pub(super) fn of(root: &'a Path) -> Self {
        Files { root, texts: RefCell::default() }
    }

    fn text(&self, path: &Path) -> Result<Rc<str>, Error> {
        if let Some(text) = self.texts.borrow().get(path) {
            return Ok(text.clone());
        }
        let text: Rc<str> = read_text(self.root, path)?.into();
        self.texts.borrow_mut().insert(path.to_owned(), text.clone());
        Ok(text)
    }

    /// The existing file below the root that an include names.
    fn find(&self, name: &str) -> Option<PathBuf> {
        let below_root = |part| matches!(part, Component::Normal(_));
        let path = self.root.join(name);
        let is_there = || self.texts.borrow().contains_key(&path) || path.is_file();
        (Path::new(name).components().all(below_root) && is_there()).then_some(path)
    }
}

/// The text of a regular file below `root`, symbolic links followed: a compiler's message shows what it read.
fn read_text(root: &Path, path: &Path) -> Result<String, Error> {
    let read = || {
        let refused = |reason: &str| Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        if !fs::canonicalize(path)?.starts_with(fs::canonicalize(root)?) {
            return refused("it is a link out of the shader folder");
        }
        let metadata = fs::metadata(path)?;
        if !metadata.is_file() {
            return refused("it is not a regular file");
        }
        if metadata.len() > MOST_BYTES {
            return refused("it has more than 262144 bytes, too many for a shader");
        }
        let mut text = String::new();
        // It may grow meanwhile.
        fs::File::open(path)?.take(MOST_BYTES).read_to_string(&mut text)?;
        Ok(text)
    };
    read().map_err(|source| Error::Read { path: path.to_owned(), source })
}

/// The lines of a text with their numbers, from 1, and those outside comments that are directives split as one.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str, Option<(&str, &str)>)> {
    let mut in_comment = false;
    (1..).zip(text.lines()).map(move |(number, line)| {
        let directive = (!in_comment).then(|| split_directive(line)).flatten();
        in_comment = ends_in_comment(line, in_comment);
        (number, line, directive)
    })
}

/// The combinations in the rest of a `#pragma`; none of one that lists no variants.
fn variant_list(rest: &str) -> Option<&str> {
    let list = rest.trim_start().strip_prefix("variants")?;
    (list.is_empty() || list.starts_with(char::is_whitespace)).then_some(list)
}

/// Splits `  # directive rest` into directive and rest.
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

/// True when a `/* */` comment is open at the end of a line.
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

    fn read(folder: &tempfile::TempDir) -> Source {
        Source::read_variants(folder.path(), "a.frag").unwrap().remove(0).1
    }

    fn problem(files: &[(&str, &str)]) -> (String, usize, DirectiveProblem) {
        let folder = folder(files);
        match Source::read_variants(folder.path(), "a.frag") {
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
        let source = read(&folder);
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
            ("#include \"{BASE}.glsl\"", DirectiveProblem::IncludeMissing("{BASE}.glsl".to_owned())),
            ("#pragma variants", DirectiveProblem::VariantsSyntax),
            ("#pragma variants BASE", DirectiveProblem::VariantsSyntax),
            ("#pragma variants base=plane", DirectiveProblem::VariantsSyntax),
            ("#pragma variants BASE=Plane", DirectiveProblem::VariantsSyntax),
            ("#pragma variants BASE=plane,,curved", DirectiveProblem::VariantsSyntax),
            ("#pragma variants BASE=plane,plane", DirectiveProblem::VariantsSyntax),
            ("#pragma variants BASE=plane BASE=curved", DirectiveProblem::VariantsSyntax),
        ];
        for (line, expected) in cases {
            assert_eq!(shader(line), ("a.frag".to_owned(), 2, expected), "{line}");
        }
        assert_eq!(
            shader("#if 1\n#include \"b.glsl\""),
            ("a.frag".to_owned(), 3, DirectiveProblem::IncludeConditional)
        );
        let misplaced = |file: &str, line| (file.to_owned(), line, DirectiveProblem::VariantsPlace);
        assert_eq!(shader("#pragma variants A=b\n#pragma variants C=d"), misplaced("a.frag", 3));
        assert_eq!(shader("#if 1\n#pragma variants A=b"), misplaced("a.frag", 3));
        let included = [("a.frag", "#version 450\n#include \"b.glsl\"\n"), ("b.glsl", "\n#pragma variants A=b\n")];
        assert_eq!(problem(&included), misplaced("b.glsl", 2));
    }

    #[test]
    fn includes_in_comments_are_left_alone() {
        let folder =
            folder(&[("a.frag", "#version 450\n// /* #include \"x\"\n/* a */ /* b\n#include \"x\"\n*/ int a; // é\n")]);
        let source = read(&folder);
        assert!(source.text.contains("\n#include \"x\"\n"));
        assert!(source.text.ends_with("int a; // ?\n"));
    }

    #[test]
    fn the_version_line_comes_first() {
        let folder = folder(&[("a.frag", "// comment\n#version 450\n")]);
        let error = Source::read_variants(folder.path(), "a.frag").unwrap_err();
        assert!(matches!(error, Error::Version { .. }));
    }

    #[test]
    fn chains_of_includes_have_an_end() {
        let names: Vec<String> = (0..100).map(|i| format!("{i}.glsl")).collect();
        let texts: Vec<String> = (1..=100).map(|i| format!("#include \"{i}.glsl\"\n")).collect();
        let mut files: Vec<(&str, &str)> = vec![("a.frag", "#version 450\n#include \"0.glsl\"\n")];
        files.extend(names.iter().map(String::as_str).zip(texts.iter().map(String::as_str)));
        assert_eq!(problem(&files), ("62.glsl".to_owned(), 1, DirectiveProblem::IncludeDepth));
    }

    #[cfg(unix)]
    #[test]
    fn links_out_of_the_folder_are_not_read() {
        use std::os::unix::fs::symlink;
        let outside = tempfile::NamedTempFile::new().unwrap();
        fs::write(outside.path(), "#version 450\nroot:x:0:0\n").unwrap();
        let folder = folder(&[("a.frag", "#version 450\n#include \"b.glsl\"\n"), ("real.glsl", "int a;\n")]);
        let read = || Source::read_variants(folder.path(), "a.frag");
        symlink("real.glsl", folder.path().join("b.glsl")).unwrap();
        assert!(read().is_ok());
        for target in [outside.path(), Path::new("/dev/zero")] {
            fs::remove_file(folder.path().join("b.glsl")).unwrap();
            symlink(target, folder.path().join("b.glsl")).unwrap();
            assert!(read().is_err(), "{target:?}");
        }
        symlink(outside.path(), folder.path().join("c.frag")).unwrap();
        let error = Source::read_variants(folder.path(), "c.frag").unwrap_err().to_string();
        assert!(error.contains("c.frag: it is a link out of the shader folder"), "{error}");
    }
}

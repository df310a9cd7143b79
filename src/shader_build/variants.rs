//! Variants: one shader file compiled once for each combination of build-time definitions.

use super::error::DirectiveProblem;

/// A name that the line `#pragma variants` gives a value, and that value.
pub(super) type Definition = (String, String);

/// Each is compiled.
const MOST_COMBINATIONS: usize = 256;
/// Names of a list, each of which is compared with those before it.
const MOST_NAMES: usize = 16;
/// Letters of a name or value, which an include may repeat.
const MOST_LETTERS: usize = 64;

/// The combinations of `BASE=plane,curved LOD=pixel,exact`, the last name changing fastest.
pub(super) fn parse(line: &str) -> Result<Vec<Vec<Definition>>, DirectiveProblem> {
    let mut combinations: Vec<Vec<Definition>> = vec![Vec::new()];
    for token in line.split_whitespace().take_while(|token| !token.starts_with("//")) {
        let (name, values) = token.split_once('=').ok_or(DirectiveProblem::VariantsSyntax)?;
        let values: Vec<&str> = values.split(',').collect();
        if combinations.len() * values.len() > MOST_COMBINATIONS || combinations[0].len() == MOST_NAMES {
            return Err(DirectiveProblem::VariantsSyntax);
        }
        let is_new = combinations[0].iter().all(|(known, _)| known != name);
        let is_distinct = values.iter().enumerate().all(|(i, value)| !values[..i].contains(value));
        if !is_new || !is_distinct || !is_name(name) || !values.iter().all(|value| is_value(value)) {
            return Err(DirectiveProblem::VariantsSyntax);
        }
        let extend = |combination: &Vec<Definition>| {
            let with = |value: &&str| [&combination[..], &[(name.to_owned(), (*value).to_owned())]].concat();
            values.iter().map(with).collect::<Vec<_>>()
        };
        combinations = combinations.iter().flat_map(extend).collect();
    }
    if combinations[0].is_empty() { Err(DirectiveProblem::VariantsSyntax) } else { Ok(combinations) }
}

fn is_name(name: &str) -> bool {
    let is_short = name.len() <= MOST_LETTERS;
    is_short
        && name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_uppercase() || c == '_')
}

fn is_value(value: &str) -> bool {
    (1..=MOST_LETTERS).contains(&value.len()) && value.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
}

/// The name of the shader that `file` makes with these definitions: `a/b.comp` makes `a/b-plane-exact.comp`.
pub(super) fn shader_name(file: &str, definitions: &[Definition]) -> String {
    let (stem, ending) = file.rsplit_once('.').unwrap_or((file, ""));
    let values: String = definitions.iter().map(|(_, value)| format!("-{value}")).collect();
    format!("{stem}{values}.{ending}")
}

/// The line that tells the shader of a definition: `#define BASE_PLANE 1`.
pub(super) fn define((name, value): &Definition) -> String {
    format!("#define {name}_{} 1", value.to_ascii_uppercase())
}

/// An include's path with the values of the names in braces: `base-{BASE}.glsl` is `base-plane.glsl`.
pub(super) fn substitute(path: &str, definitions: &[Definition]) -> String {
    definitions.iter().fold(path.to_owned(), |path, (name, value)| path.replace(&format!("{{{name}}}"), value))
}

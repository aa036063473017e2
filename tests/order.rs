//! The folders of `src` have one order, said in the front page of the documentation: each uses only those before it.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Begins the list in `src/lib.rs`.
const HEADING: &str = "//! # Order of the folders";

/// A folder, one that it uses, and in which file it does.
type Use = (String, String, String);

/// Folders and files of `src` from the bottom up, as `src/lib.rs` says.
fn order(front_page: &str) -> Vec<String> {
    let lines = front_page.lines().skip_while(|line| *line != HEADING).skip_while(|line| *line != "//! ```text");
    let list = lines.skip(1).take_while(|line| *line != "//! ```");
    list.flat_map(|line| line.trim_start_matches("//!").split_whitespace()).map(str::to_owned).collect()
}

/// Rust files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Names after `root` (`crate::`) in Rust text, lists in braces included; comments do not count.
fn used(text: &str, root: &str) -> BTreeSet<String> {
    let code: String =
        text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n");
    let mut names = BTreeSet::new();
    for (at, found) in code.match_indices(root) {
        let rest = &code[at + found.len()..];
        let Some(list) = rest.strip_prefix('{') else {
            names.extend(first_name(rest));
            continue;
        };
        let (mut depth, mut begins) = (1, true);
        for (k, letter) in list.char_indices() {
            match letter {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => begins = true,
                _ if begins && !letter.is_whitespace() => {
                    names.extend(first_name(&list[k..]));
                    begins = false;
                }
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
    }
    names
}

fn first_name(text: &str) -> Option<String> {
    let name: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    (!name.is_empty()).then_some(name)
}

/// All uses of one folder by another.
fn uses(sources: &[(String, String)]) -> Vec<Use> {
    let top = |file: &str| file.split('/').next().unwrap_or_default().trim_end_matches(".rs").to_owned();
    let folders: BTreeSet<String> = sources.iter().map(|(file, _)| top(file)).collect();
    let mut found = Vec::new();
    for (file, text) in sources {
        let by = top(file);
        if by == "lib" || by == "main" {
            continue;
        }
        let mut names = used(text, "crate::");
        // From a folder's own page that leads to the same place.
        if file.matches('/').count() == usize::from(file.ends_with("/mod.rs")) {
            names.extend(used(text, "super::"));
        }
        for name in names.into_iter().filter(|name| folders.contains(name) && *name != by) {
            found.push((by.clone(), name, file.clone()));
        }
    }
    found
}

/// What breaks the order.
fn faults(order: &[String], uses: &[Use]) -> Vec<String> {
    let place: BTreeMap<&str, usize> = order.iter().map(String::as_str).zip(0..).collect();
    let mut faults = Vec::new();
    for (by, name, file) in uses {
        match (place.get(by.as_str()), place.get(name.as_str())) {
            (Some(by_at), Some(name_at)) if name_at < by_at => {}
            (Some(_), Some(_)) => faults.push(format!("{file}: `{by}` uses `{name}`, which comes after it")),
            _ => faults.push(format!("{file}: `{by}` or `{name}` has no place in the order")),
        }
    }
    faults
}

fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let name = |path: &Path| path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
    files(&root).iter().map(|path| (name(path), std::fs::read_to_string(path).unwrap())).collect()
}

fn declared() -> Vec<String> {
    let order = order(include_str!("../src/lib.rs"));
    assert!(order.len() > 20, "the list was not found: {order:?}");
    order
}

#[test]
fn each_folder_uses_only_those_before_it() {
    let sources = sources();
    let uses = uses(&sources);
    assert!(uses.len() > 100, "the uses were not found");
    let faults = faults(&declared(), &uses);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_words_of_the_schedule_know_no_stage() {
    let (_, text) = sources().into_iter().find(|(file, _)| file == "schedule.rs").unwrap();
    let known: Vec<String> = used(&text, "crate::").into_iter().filter(|name| declared().contains(name)).collect();
    assert_eq!(known, ["diagnostics"]);
}

#[test]
fn sabotage_a_use_of_what_comes_later_is_seen() {
    let mut sources = sources();
    let text = "use crate::{\n    Error, Result,\n    app::{self, load},\n    boundary::Boundary,\n};\n// crate::panel is not used\n";
    sources.push(("voxel/sabotage.rs".into(), text.into()));
    sources.push(("edge/mod.rs".into(), "use super::film::Film;".into()));
    let expected = [
        "voxel/sabotage.rs: `voxel` uses `app`, which comes after it",
        "edge/mod.rs: `edge` uses `film`, which comes after it",
    ];
    assert_eq!(faults(&declared(), &uses(&sources)), expected);
}

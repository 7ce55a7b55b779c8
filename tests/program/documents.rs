//! Examples in the documents: every block of TOML is one that the program takes, every geometry one
//! that gmsh meshes.

use std::fs;
use std::path::{Path, PathBuf};

use kluft_io::{Dimension, GmshOptions, Meshing, mesh_geometry};
use kluft_scene::Scene;

use crate::harness::{kluft, root, scratch};

/// Pages below a folder.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => found.extend(pages(&path)),
            false => {
                found.extend(Some(path).filter(|path| path.extension() == Some("md".as_ref())))
            }
        }
    }
    found.sort();
    found
}

/// Blocks of a language with the line they begin at.
fn blocks(text: &str, language: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut inside = false;
    for (number, line) in (1..).zip(text.lines()) {
        let fence = line.trim_start();
        if inside && fence.starts_with("```") {
            inside = false;
        } else if fence.strip_prefix("```") == Some(language) {
            inside = true;
            found.push((number, String::new()));
        } else if let Some((_, block)) = found.last_mut().filter(|_| inside) {
            block.push_str(line);
            block.push('\n');
        }
    }
    found
}

/// What is wrong with an excerpt of a scene, as a line each. What an excerpt leaves out is not.
fn wrong_in_scene(text: &str, folder: &Path) -> Vec<String> {
    let defects = Scene::parse(text, "block", folder)
        .err()
        .unwrap_or_default();
    let told = defects.iter().map(|defect| defect.to_string());
    told.filter(|said| {
        ["unknown", "TOML", "not a", "must"]
            .iter()
            .any(|word| said.contains(word))
    })
    .collect()
}

/// The same of a description of a network, by the command that reads it.
fn wrong_in_network(text: &str) -> Vec<String> {
    let folder = scratch();
    let file = folder.path().join("network.toml");
    fs::write(&file, text).expect("written");
    let out = folder.path().join("out");
    let run = kluft(&[
        "network".as_ref(),
        file.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ]);
    let said = run
        .err
        .lines()
        .filter(|line| line.contains("unknown") || line.contains("TOML"));
    said.map(str::to_owned).collect()
}

#[test]
fn every_block_of_toml_is_taken() {
    let folder = scratch();
    let mut pages = pages(&root().join("docs"));
    pages.push(root().join("README.md"));
    let mut count = 0;
    let mut wrong = Vec::new();
    for page in pages {
        let text = fs::read_to_string(&page).expect("a page");
        for (line, block) in blocks(&text, "toml") {
            count += 1;
            let of_network = ["[domain]", "[fracture_set", "[[fracture]]"];
            let found = match of_network.iter().any(|head| block.contains(head)) {
                true => wrong_in_network(&block),
                false => wrong_in_scene(&block, folder.path()),
            };
            wrong.extend(
                found
                    .iter()
                    .map(|one| format!("{}:{line}: {one}", page.display())),
            );
        }
    }
    assert!(count > 20, "{count} blocks");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Whole geometries of a page: one begins with its factory, and what follows is added to it.
fn geometries(text: &str) -> Vec<(usize, String)> {
    let mut whole: Vec<(usize, String)> = Vec::new();
    for (line, block) in blocks(text, "geo") {
        match whole.last() {
            Some((_, before)) if !block.contains("SetFactory") => {
                let both = format!("{before}{block}");
                whole.push((line, both));
            }
            _ => whole.push((line, block)),
        }
    }
    whole
}

#[test]
fn every_geometry_is_meshed() {
    let folder = scratch();
    let geometry = folder.path().join("block.geo");
    let mut count = 0;
    for page in pages(&root().join("docs")) {
        let text = fs::read_to_string(&page).expect("a page");
        for (line, block) in geometries(&text) {
            count += 1;
            fs::write(&geometry, block).expect("written");
            let meshed = mesh_geometry(&Meshing {
                geometry: &geometry,
                parameters: &[],
                order: 1,
                dimension: Dimension::Volumes,
                sizes: None,
                output: &folder.path().join("block.msh"),
                gmsh: &GmshOptions::default(),
            });
            assert!(meshed.is_ok(), "{}:{line}: {meshed:?}", page.display());
        }
    }
    assert!(count > 3, "{count} geometries");
}

#[test]
fn a_key_that_nobody_knows_is_found() {
    let folder = scratch();
    let wrong = wrong_in_scene("[rock.a]\nyung_modulus = 1\n", folder.path());
    assert_eq!(wrong.len(), 1, "{wrong:?}");
    assert!(!wrong_in_network("[domain]\nlow = [0, 0, 0]\nhgih = [1, 1, 1]\n").is_empty());
    assert!(!wrong_in_scene("[rock.a\n", folder.path()).is_empty());
}

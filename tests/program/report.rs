//! `report.html`: the page of a run, whole, small, and harmless.

use std::fs;
use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::Event;

use crate::harness::{Workshop, kluft, scratch, summary};

fn page(out: &Path) -> String {
    fs::read_to_string(out.join("report.html")).expect("a page")
}

/// The texts of the SVG documents of a page, all of which must be well-formed.
fn drawings(page: &str) -> Vec<String> {
    let parts = page.split("<svg ").skip(1);
    let whole = parts.map(|part| {
        let end = part.find("</svg>").expect("the end of a drawing");
        format!("<svg {}</svg>", &part[..end])
    });
    whole.map(|svg| texts(&svg)).collect()
}

fn texts(svg: &str) -> String {
    let mut reader = Reader::from_str(svg);
    let mut all = String::new();
    loop {
        match reader.read_event().expect("well-formed XML") {
            Event::Text(text) => all += &text.xml10_content(),
            Event::Eof => return all,
            _ => all.push(' '),
        }
    }
}

#[test]
fn a_run_leaves_a_page_with_what_it_was_made_of_and_what_came_out() {
    let workshop = Workshop::new("pressed-joint", &[]);
    let out = workshop.solve("out", &["--threads", "1"]);
    let (page, said) = (page(&out), summary(&out));
    for heading in [
        "Fractures after the last load step",
        "Numbers of the fractures",
        "Load steps",
        "Accuracy",
        "Decisions",
        "Made with",
        "Scene",
    ] {
        assert!(page.contains(heading), "{heading}");
    }
    let made = &said["provenance"];
    assert_eq!(made["gmsh"], gmsh_version(), "what gmsh says itself");
    let inputs = made["inputs"].as_array().expect("files");
    let sums = inputs
        .iter()
        .map(|input| input["xxh3_128"].as_str().expect("a sum"));
    let shown = [made["command"].as_str(), made["began"].as_str()];
    for text in sums.chain(shown.map(|text| text.expect("a text"))) {
        assert!(page.contains(text), "{text}");
    }
    let names: Vec<&str> = inputs
        .iter()
        .map(|input| input["file"].as_str().expect("a name"))
        .map(|name| name.rsplit('/').next().expect("a name"))
        .collect();
    assert_eq!(names.first(), Some(&"scene.toml"));
    assert_eq!(names.last(), Some(&"mesh.msh"));
    assert!(page.contains("--threads 1"), "the command");
    assert!(drawings(&page).len() >= 3);
    assert!(page.len() < 3_000_000);
}

fn gmsh_version() -> String {
    let said = std::process::Command::new("gmsh").arg("--version").output();
    let said = said.expect("gmsh").stderr;
    String::from_utf8(said).expect("text").trim().to_owned()
}

#[test]
fn load_steps_have_curves_and_iterations_a_chart() {
    let short = (
        "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
        "times = [10, 20, 30]",
    );
    let workshop = Workshop::new("filling-joint", &[short]);
    let out = workshop.solve("out", &[]);
    let drawn = drawings(&page(&out)).join("\n");
    for title in ["Mean aperture", "Mean normal traction", "Inflow", "Newton"] {
        assert!(drawn.contains(title), "{title}: {drawn}");
    }
}

#[test]
fn rigid_rock_has_a_page_of_its_flow() {
    let workshop = Workshop::new("flow-star", &[]);
    let page = page(&workshop.solve("out", &[]));
    for text in ["Fluid pressure", "Flow in the fractures", "inflow (m³/s)"] {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn no_report_leaves_none_and_an_older_one_goes() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let out = workshop.solve("out", &[]);
    assert!(out.join("report.html").exists());
    workshop.solve("out", &["--no-report"]);
    assert!(!out.join("report.html").exists(), "it told of another run");
}

#[test]
fn a_page_that_no_run_has_written_stays() {
    let workshop = Workshop::new("inclined-joint", &[]);
    fs::create_dir(workshop.path("out")).expect("a folder");
    fs::write(workshop.path("out/report.html"), "mine").expect("written");
    let run = workshop.run("out", &[]);
    assert_eq!(run.code, Some(2));
    assert!(
        run.err.contains("report.html") && run.err.contains("--out"),
        "{}",
        run.err
    );
    assert_eq!(page(&workshop.path("out")), "mine");
    assert_eq!(workshop.run("out", &["--no-report"]).code, Some(0));
    assert_eq!(page(&workshop.path("out")), "mine");
}

#[test]
fn names_of_a_scene_are_text_on_its_page() {
    let folder = scratch();
    let scene = include_str!("bad_input/base.toml");
    let scene = scene.replace("title = ", "title = \"<script>alert(1)</script>\" # ");
    fs::write(folder.path().join("scene.toml"), scene).expect("written");
    fs::write(
        folder.path().join("base.msh"),
        include_str!("bad_input/base.msh"),
    )
    .expect("written");
    let scene = folder.path().join("scene.toml");
    assert_eq!(kluft(&["run".as_ref(), scene.as_os_str()]).code, Some(0));
    let out = folder.path().join("out");
    let page = page(&out);
    assert!(!page.contains("<script"), "a name of the scene is markup");
    assert!(page.contains("&lt;script&gt;"));
}

//! Random networks of fractures through the whole program: made, meshed by gmsh, solved.

use std::ffi::OsStr;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Duration;

use super::asked::Asked;
use super::program::{End, left_behind, run as run_program};
use super::random_stream::{RandomStream, rounded};
use super::solve::kind_of;
use super::tally::{Verdict, finding};
use crate::report::{Effort, Finding, Study};

/// The suite.
pub const STUDY: Study = Study {
    name: "networks",
    title: "Random networks",
    subject: "one to three sets of fractures in contact with friction of 30 degrees, half of them \
              with dilation; `kluft network`, gmsh, `kluft run`",
    run: |effort| run(&Asked::of(effort)),
};

const TEXT: &str = "Each case draws one to three sets of 1 to 8 fractures (discs and rectangles, \
    sizes 1 to 7 m, any orientation and scatter) in a box of 10 by 9 by 8 m under 10 MPa from above \
    and random pressures from the sides. All fractures are in contact with friction of 30 degrees, \
    and in every second case they dilate. *Stalls* are load steps that end because iterations run \
    out or a solver gives up; a step that ends because nothing holds a block any more names it.";

/// Runs the suite.
pub fn run(asked: &Asked) -> Finding {
    let limit = Duration::from_secs(match asked.effort {
        Effort::Quick => 120,
        Effort::Full => 600,
    });
    let verdicts = asked.each(4, 1000, |number| {
        let text = description(&mut RandomStream::new(asked.seed, number), number % 2 == 1);
        let mut verdict = solved(&asked.program, &text, limit);
        if let Some(miss) = &mut verdict.miss {
            let name = format!("network-{}-{number}.toml", asked.seed);
            *miss = format!("{}: {miss}", asked.keep(&name, text.as_bytes()));
        }
        verdict
    });
    finding(TEXT, &verdicts)
}

fn description(random: &mut RandomStream, dilates: bool) -> String {
    let mut text = format!(
        "seed = {}\n[domain]\nlow = [0, 0, 0]\nhigh = [10, 9, 8]\n[mesh]\nh = 3\nh_fracture = \
         {}\n[boundary.top]\ntraction = [0, 0, -10e6]\n[boundary.right]\npressure = \
         {:e}\n[boundary.back]\npressure = {:e}\n[boundary.left]\ndisplacement = {{ x = 0.0 \
         }}\n[boundary.front]\ndisplacement = {{ y = 0.0 }}\n[boundary.bottom]\ndisplacement = {{ \
         z = 0.0 }}\n",
        random.below(1_000_000),
        rounded(random.between(1.2, 2.0)),
        rounded(random.between(1e6, 15e6)),
        rounded(random.between(1e6, 15e6)),
    );
    for set in 0..1 + random.below(3) {
        let shape = random.pick(&[
            "shape = \"disc\"\nsides = 7",
            "shape = \"disc\"\nsides = 4",
            "shape = \"rectangle\"\naspect = 1.7",
        ]);
        let largest = rounded(random.between(2.0, 7.0));
        let _ = write!(
            text,
            "[fracture_set.s{set}]\naperture = 1e-3\nclosure = \"contact\"\nfriction_angle = \
             30\n{shape}\ncount = {}\norientation = {{ dip = {}, dip_direction = {}, kappa = {} \
             }}\nsize = {{ law = \"power\", exponent = 1.5, min = 1, max = {largest} }}\n",
            1 + random.below(8),
            random.below(91),
            random.below(360),
            random.pick(&[0, 5, 20, 100]),
        );
        if dilates {
            let _ = writeln!(text, "dilation_angle = {}", random.pick(&[3, 5, 10, 30]));
        }
    }
    text
}

fn solved(program: &Path, text: &str, limit: Duration) -> Verdict {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (input, made) = (
        folder.path().join("network.toml"),
        folder.path().join("made"),
    );
    fs::write(&input, text).expect("a writable folder");
    let start = |arguments: &[&OsStr]| run_program(program, arguments, limit);
    let end = start(&[
        OsStr::new("network"),
        input.as_os_str(),
        OsStr::new("-o"),
        made.as_os_str(),
    ]);
    if end.code != Some(0) || end.is_out_of_time {
        return judged(&end, "kluft network");
    }
    let scene = made.join("scene.toml");
    let end = start(&[OsStr::new("run"), scene.as_os_str()]);
    if let Some(left) = left_behind(folder.path()).first() {
        return Verdict::missed("a process left behind", left.clone());
    }
    judged(&end, "kluft run")
}

fn judged(end: &End, who: &str) -> Verdict {
    if let Some(fault) = end.fault() {
        let outcome = format!("{who}: {fault}");
        return Verdict::missed(outcome.clone(), format!("{outcome}: {}", end.first_line()));
    }
    match end.code {
        Some(0) => Verdict::held("solved"),
        Some(1) => {
            let kind = kind_of(&end.said);
            let stalls = ["tests", "gave up"]
                .iter()
                .any(|words| kind.contains(words));
            if stalls {
                let said = end.said.split_whitespace().collect::<Vec<_>>().join(" ");
                return Verdict::missed(format!("stalled: {kind}"), said);
            }
            Verdict::held(format!("not converged: {kind}"))
        }
        _ => Verdict::held(format!("refused by {who}: {}", reason(&end.said))),
    }
}

/// The beginning of the first problem of a refusal, without names and numbers.
fn reason(said: &str) -> String {
    let mut lines = said
        .lines()
        .skip_while(|line| line.contains("in the input"));
    let line = lines.find(|line| !line.trim().is_empty()).unwrap_or("");
    let words = line.split_whitespace();
    let plain = words.filter(|word| word.chars().all(|c| c.is_alphabetic() || c == ','));
    plain.take(10).collect::<Vec<_>>().join(" ")
}

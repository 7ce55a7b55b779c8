//! Load steps of a project of OpenGeoSys.

use super::said::Said;
use super::tree::Element;

/// More load steps than these are not meant as such: OpenGeoSys takes as many to follow a path,
/// Kluft divides its own.
const MOST: usize = 400;

/// Ends of the load steps, where they are fixed.
pub fn times(root: &Element, said: &mut Said) {
    let processes = root.get("time_loop").and_then(|own| own.get("processes"));
    let stepping = processes
        .and_then(|list| list.get("process"))
        .and_then(|process| process.get("time_stepping"));
    let Some(stepping) = stepping else {
        return;
    };
    let number = |of: &Element, tag: &str| of.word(tag).and_then(|text| text.parse::<f64>().ok());
    let kind = stepping.word("type").unwrap_or_default();
    let begin = number(stepping, "t_initial").unwrap_or(0.0);
    let end = number(stepping, "t_end").unwrap_or(f64::INFINITY);
    if kind != "FixedTimeStepping" || begin != 0.0 {
        said.notes.push(format!(
            "no counterpart: time steps of type {kind} from {begin}"
        ));
        stepping.leave();
        return;
    }
    let mut ends = Vec::new();
    let mut now = begin;
    let pairs = stepping.get("timesteps").into_iter();
    for pair in pairs.flat_map(|list| list.all("pair")) {
        let repeat = number(pair, "repeat").unwrap_or(0.0) as usize;
        let step = number(pair, "delta_t").unwrap_or(0.0);
        let first = now;
        for count in 1..=repeat.min(1_000_000) {
            if now >= end * (1.0 - 1e-12) || step <= 0.0 {
                break;
            }
            now = (first + count as f64 * step).min(end);
            ends.push(now);
        }
    }
    let wanted = ends.len();
    if wanted > MOST {
        let every = wanted.div_ceil(MOST);
        let kept = (1..=wanted).filter(|step| step % every == 0 || *step == wanted);
        ends = kept.map(|step| ends[step - 1]).collect();
        said.notes.push(format!(
            "every {every} of {wanted} time steps is one load step: Kluft divides where it must"
        ));
    }
    if wanted > 0 {
        said.scene += &format!("\n[load]\ntimes = {ends:?}\n");
    }
}

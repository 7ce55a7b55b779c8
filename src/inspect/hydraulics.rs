//! What connects hydraulically, in words.

use kluft_run::Hydraulics;

/// How many pressures and networks there are.
pub fn head(found: &Hydraulics) -> String {
    let networks = match found.networks.len() {
        1 => "1 network".to_owned(),
        count => format!("{count} networks that do not hang together"),
    };
    let backward = match found.backward_edges {
        0 => String::new(),
        count => format!(", {count} edges between obtuse facets that drive fluid backwards"),
    };
    let pressures = found.unknowns;
    format!("flow       {pressures} unknown pressures, {networks}{backward}")
}

/// Each network: its fractures, its size, and what drives the fluid in it.
pub fn networks(found: &Hydraulics) -> Vec<String> {
    let told = found.networks.iter().map(|network| {
        let driven = match network.sources.is_empty() {
            true => "nothing".to_owned(),
            false => network.sources.join(", "),
        };
        let fractures = network.fractures.join(", ");
        format!(
            "  {fractures} ({} nodes), driven by {driven}",
            network.nodes
        )
    });
    told.collect()
}

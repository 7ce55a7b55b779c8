//! The documents that a user writes.

use crate::network;
use crate::scene;
use crate::table::KeySection;

/// A document that a user writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Document {
    /// A scene, `[study]` included.
    Scene,
    /// A description of a network.
    Network,
    /// The table `[study]` of a scene.
    Study,
    /// A list of fractures: a key is a column.
    List,
}

impl Document {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Scene, Self::Network, Self::Study, Self::List];

    /// Its name in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Network => "network",
            Self::Study => "study",
            Self::List => "list",
        }
    }

    /// How messages call the whole.
    pub fn title(self) -> &'static str {
        match self {
            Self::Scene => "the scene",
            Self::Network => "the description",
            Self::Study => "[study]",
            Self::List => "the list",
        }
    }

    /// Its outermost table.
    pub fn root(self) -> &'static KeySection {
        match self {
            Self::Scene => &scene::ROOT,
            Self::Network => &network::ROOT,
            Self::Study => &scene::STUDY,
            Self::List => &network::LIST,
        }
    }

    /// All its sections, each once, outer ones before those in them.
    pub fn sections(self) -> Vec<&'static KeySection> {
        let mut found = Vec::new();
        gather(self.root(), &mut found);
        found
    }
}

fn gather(section: &'static KeySection, found: &mut Vec<&'static KeySection>) {
    if found.iter().any(|known| std::ptr::eq(*known, section)) {
        return;
    }
    found.push(section);
    for inner in section.keys.iter().filter_map(|key| key.kind.section()) {
        if !inner.keys.is_empty() {
            gather(inner, found);
        }
    }
}

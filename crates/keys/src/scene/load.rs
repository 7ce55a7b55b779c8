//! Load steps.

use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, number, quantity};

/// Load steps.
pub static LOAD: KeySection = KeySection {
    pattern: "[load]",
    says: "Load steps: one of `steps`, `times` and `phase`",
    keys: &[
        Key {
            name: "steps",
            kind: Kind::Numbers(quantity(Dimension::One, Range::Finite)),
            need: Need::Unless("there are `times` or phases"),
            example: "[0.5, 1.0]",
            says: "One load step for each factor on everything; `[1.0]` without `[load]`",
        },
        Key {
            name: "times",
            kind: Kind::Numbers(quantity(Dimension::Time, Range::Positive)),
            need: Need::Without("none"),
            example: "[1.0, 2.0]",
            says: "Ends of the load steps, ascending; for histories",
        },
        Key {
            name: "phase",
            kind: Kind::Listed(&PHASE),
            need: Need::Without("none"),
            example: "[[load.phase]]",
            says: "Load steps with a name; for histories",
        },
    ],
    also: None,
};

/// Load steps with a name.
pub static PHASE: KeySection = KeySection {
    pattern: "[[load.phase]]",
    says: "Load steps with a name",
    keys: &[
        Key {
            name: "name",
            kind: Kind::Text,
            need: Need::Required,
            example: "\"excavation\"",
            says: "What the report and `summary.json` call it",
        },
        Key {
            name: "until",
            kind: number(Dimension::Time, Range::Positive),
            need: Need::Required,
            example: "1.0",
            says: "End of the phase; the first begins at 0",
        },
        Key {
            name: "steps",
            kind: Kind::Whole(Range::Within(1.0, 1e5)),
            need: Need::Default("1"),
            example: "4",
            says: "Number of equal load steps in the phase",
        },
        Key {
            name: "remove",
            kind: Kind::Texts,
            need: Need::Without("nothing"),
            example: "[\"heading\"]",
            says: "Physical volumes that are not there from its beginning on, with the fractures in them; and fractures whose walls are one from then on, as far apart as they are",
        },
        Key {
            name: "add",
            kind: Kind::Texts,
            need: Need::Without("nothing"),
            example: "[\"lining\"]",
            says: "Physical volumes and fractures that are there from its beginning on, free of stress; one that none has removed before is not there until then",
        },
        Key {
            name: "added_as",
            kind: Kind::Text,
            need: Need::Without("the rock of the volume"),
            example: "\"concrete\"",
            says: "Rock of what it adds, a section `[rock.NAME]`",
        },
        Key {
            name: "release",
            kind: number(Dimension::One, Range::Within(0.0, 1.0)),
            need: Need::Default("1"),
            example: "0.4",
            says: "Share, of the forces that hold the walls of what was removed or cut at its beginning, that it lets go step by step",
        },
    ],
    also: None,
};

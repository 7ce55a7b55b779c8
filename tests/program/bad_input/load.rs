//! Wrong load steps and histories.

use super::{Case, SOUND, judge_all};

#[test]
fn defects_of_load_steps_and_histories_are_named() {
    judge_all(CASES);
}

/// `[load]` in front of everything else; line 4 is its first line.
macro_rules! load {
    ($text:literal) => {
        ("[mesh]", concat!("[load]\n", $text, "\n[mesh]"))
    };
}

/// Steps with times, for histories to refer to.
const TIMES: (&str, &str) = load!("times = [1.0, 2.0]\n");

/// `text` at the end of the section of the top face.
macro_rules! top {
    ($text:literal) => {
        (
            "traction = [0, 0, -1e5]\n",
            concat!("traction = [0, 0, -1e5]\n", $text, "\n"),
        )
    };
}

pub(super) const CASES: &[Case] = &[
    Case {
        name: "no load steps",
        scene: &[load!("steps = []\n")],
        says: &[
            "scene.toml:4: there are no load steps",
            "write steps = [1.0]",
        ],
        ..SOUND
    },
    Case {
        name: "nothing under load",
        scene: &[load!("")],
        says: &[
            "scene.toml:3: `steps` is missing in [load]",
            "add `steps = ",
        ],
        ..SOUND
    },
    Case {
        name: "steps and times",
        scene: &[load!("steps = [1.0]\ntimes = [1.0]\n")],
        says: &[
            "scene.toml:5: both `steps` and `times` are given in [load]",
            "keep one",
        ],
        ..SOUND
    },
    Case {
        name: "times and phases",
        scene: &[load!(
            "times = [1.0]\n[[load.phase]]\nname = \"a\"\nuntil = 1.0\n"
        )],
        says: &[
            "scene.toml:5: both `times` and `phase` are given",
            "keep one",
        ],
        ..SOUND
    },
    Case {
        name: "no times",
        scene: &[load!("times = []\n")],
        says: &[
            "scene.toml:4: there are no load steps",
            "write times = [1.0]",
        ],
        ..SOUND
    },
    Case {
        name: "times that do not ascend",
        scene: &[load!("times = [1.0, 2.0, 2.0]\n")],
        says: &["scene.toml:4: the times go from 2 to 2", "let them ascend"],
        ..SOUND
    },
    Case {
        name: "times that are not after the start",
        scene: &[load!("times = [0.0, 1.0]\n")],
        says: &["scene.toml:4: `times` = 0 in [load]", "greater than 0"],
        ..SOUND
    },
    Case {
        name: "no phases",
        scene: &[load!("phase = []\n")],
        says: &[
            "scene.toml:4: there are no load steps",
            "add [[load.phase]]",
        ],
        ..SOUND
    },
    Case {
        name: "a phase in single brackets",
        scene: &[load!("[load.phase]\nname = \"a\"\nuntil = 1.0\n")],
        defects: 2,
        says: &[
            "scene.toml:4: `phase` in [load] is of type table",
            "write [[load.phase]] in double brackets",
        ],
        ..SOUND
    },
    Case {
        name: "a phase without a name and an end",
        scene: &[load!("[[load.phase]]\n")],
        defects: 2,
        says: &[
            "scene.toml:4: `name` is missing in [[load.phase]] number 1",
            "`until` is missing",
            "add `until = 1.0`",
        ],
        ..SOUND
    },
    Case {
        name: "phases that do not ascend",
        scene: &[load!(
            "[[load.phase]]\nname = \"a\"\nuntil = 2.0\n[[load.phase]]\nname = \"b\"\nuntil = 1.0\n"
        )],
        says: &[
            "scene.toml:9: [[load.phase]] number 2 ends at 1, where the one before it ends at 2",
            "ascend",
        ],
        ..SOUND
    },
    Case {
        name: "phases of one name",
        scene: &[load!(
            "[[load.phase]]\nname = \"a\"\nuntil = 1.0\n[[load.phase]]\nname = \"a\"\nuntil = 2.0\n"
        )],
        says: &[
            "scene.toml:8: two phases are called \"a\"",
            "a name of its own",
        ],
        ..SOUND
    },
    Case {
        name: "a phase of half a step",
        scene: &[load!(
            "[[load.phase]]\nname = \"a\"\nuntil = 1.0\nsteps = 1.5\n"
        )],
        says: &[
            "scene.toml:7: `steps` = 1.5 in [[load.phase]]",
            "a whole number",
        ],
        ..SOUND
    },
    Case {
        name: "a phase without steps",
        scene: &[load!(
            "[[load.phase]]\nname = \"a\"\nuntil = 1.0\nsteps = 0\n"
        )],
        says: &[
            "scene.toml:7: `steps` = 0 in [[load.phase]]",
            "must be from 1 to 100000",
        ],
        ..SOUND
    },
    Case {
        name: "an unknown key of a phase",
        scene: &[load!("[[load.phase]]\nname = \"a\"\nuntill = 1.0\n")],
        says: &[
            "scene.toml:6: unknown key `untill`",
            "did you mean `until`?",
        ],
        ..SOUND
    },
    Case {
        name: "a history without times",
        scene: &[
            load!("steps = [1.0, 0.5]\n"),
            top!("history = [[0, 0], [1, 1]]"),
        ],
        says: &[
            "scene.toml:20: [boundary.top] has a history, but the load steps have no times",
            "give times = [1.0, 2.0] or [[load.phase]] under [load], without steps",
        ],
        ..SOUND
    },
    Case {
        name: "a history without load steps",
        scene: &[top!("history = [[0, 0], [1, 1]]")],
        says: &["scene.toml:17: [boundary.top] has a history, but", "[load]"],
        ..SOUND
    },
    Case {
        name: "an empty history",
        scene: &[TIMES, top!("history = []")],
        says: &[
            "scene.toml:20: the history of [boundary.top] is empty",
            "write [time, factor]",
        ],
        ..SOUND
    },
    Case {
        name: "a history that goes back",
        scene: &[TIMES, top!("history = [[0, 0], [2, 1], [2, 0]]")],
        says: &[
            "scene.toml:20: the history of [boundary.top] goes from time 2 to time 2",
            "let the times ascend; for a jump, let two times lie close together",
        ],
        ..SOUND
    },
    Case {
        name: "a history of single numbers",
        scene: &[TIMES, top!("history = [0, 1]")],
        says: &[
            "scene.toml:20: `history` in [boundary.top] is no list of times with factors",
            "e.g. [[0, 0], [1, 1]]",
        ],
        ..SOUND
    },
    Case {
        name: "a history of a support",
        scene: &[
            TIMES,
            ("z = 0.0 }\n", "z = 0.0 }\nhistory = [[0, 0], [1, 1]]\n"),
        ],
        says: &[
            "scene.toml:23: the history of [boundary.bottom] has nothing to scale",
            "add a traction, a pressure, a displacement other than 0 or a fluid_pressure",
        ],
        ..SOUND
    },
    Case {
        name: "a history of a fracture without fluid",
        scene: &[
            TIMES,
            (
                "shear_stiffness = 1e10\n",
                "shear_stiffness = 1e10\nhistory = [[0, 0], [1, 1]]\n",
            ),
        ],
        says: &[
            "scene.toml:17: the history of [fracture.joint] has nothing to scale",
            "add a fluid_pressure to [fracture.joint]",
        ],
        ..SOUND
    },
    Case {
        name: "a history of a point that stays",
        scene: &[
            TIMES,
            (
                "z = 0.0 }\n",
                "z = 0.0 }\n[[fixed_point]]\nat = [0, 0, 0]\ndisplacement = { x = 0.0 }\nhistory = [[0, 0]]\n",
            ),
        ],
        says: &[
            "scene.toml:26: the history of [[fixed_point]] number 1 has nothing to scale",
            "a displacement other than 0",
        ],
        ..SOUND
    },
    Case {
        name: "a history of a rock",
        scene: &[
            TIMES,
            (
                "poisson_ratio = 0.25\n",
                "poisson_ratio = 0.25\nhistory = [[0, 0]]\n",
            ),
        ],
        says: &[
            "scene.toml:12: unknown key `history` in [rock.rock]",
            "known keys",
        ],
        ..SOUND
    },
    Case {
        name: "two histories of one displacement",
        scene: &[
            TIMES,
            top!(
                "displacement = { x = 1e-5 }\nhistory = [[0, 0], [2, 1]]\n[[fixed_point]]\nat = [0, 0, 1]\ndisplacement = { x = 1e-5 }"
            ),
        ],
        says: &[
            "`top` and `[[fixed_point]] number 1` prescribe different displacements",
            "give both the same value and history",
        ],
        ..SOUND
    },
];

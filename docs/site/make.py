"""Lays out the pages of the site: those of docs/, the gallery of geometries/, the Python package.

    python make.py REPOSITORY FOLDER [KLUFT]

With the program each scene of the gallery is run, and its page shows the fractures; one that is large
is meshed and inspected.
"""

import html
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

LARGEST = 400_000
"""Bytes of a geometry whose scene is run."""
PATIENCE = 600
"""Seconds that a scene may take."""
STYLE = """
.grid { --ink: #444; --soft: #777; } .grid svg { background: #fff; }
.cards { grid-template-columns: repeat(auto-fill, minmax(min(100%, 15rem), 1fr)); }
.cards a { display: block; margin: 0.7rem 0; }
"""
"""What pictures on the site have beside the style of the pages of runs."""
PAGE_STYLE = "crates/report/src/page.css"
FORGE = "https://github.com/kluft/kluft/blob/main/"

INDEX = """# Kluft

How fractured rock deforms in three dimensions: joints close, slide and open, water flows in them.

{content}

```{{toctree}}
:hidden:
:caption: Tutorials
:glob:
tutorial/*
```
```{{toctree}}
:hidden:
:caption: How-to guides
:glob:
how-to/*
```
```{{toctree}}
:hidden:
:caption: Gallery
gallery/index
```
```{{toctree}}
:hidden:
:caption: Theory
:glob:
theory/*
```
```{{toctree}}
:hidden:
:caption: Reference
:glob:
reference/*
python
```
```{{toctree}}
:hidden:
:caption: Evidence
:glob:
verification/README
verification/*
verification/book/*
performance/README
performance/*
design/README
design/*
changelog
```
"""

PYTHON = """# The package for Python

```{eval-rst}
.. automodule:: kluft
   :members: Scene, Mesh, Survey, Run, PreparedRun, Step, FractureResult, Grid, Study, Setting, Network,
             InputError, NotConverged, Stopped, Defect, study, network, read
   :undoc-members:
```

## Sections of a scene

```{eval-rst}
.. automodule:: kluft.keys
   :members:
```
"""


def comment_of(scene: str) -> str:
    """What the head of a scene says of it and of its oracle."""
    lines = []
    for line in scene.splitlines():
        if line.startswith("[") and lines:
            break
        if line.startswith("#") and not line.startswith("#:"):
            lines.append(line[1:].strip())
    return "\n".join(lines)


def pictures_of(folder: Path, kluft: str | None) -> list[str]:
    """The pictures of the page that a run of a scene leaves, as HTML; none if it is not run.

    Raises:
        SystemExit: if the scene is not solved, or, if it is large, not meshed and sound.
    """
    if kluft is None:
        return []
    sizes = [file.stat().st_size for file in folder.glob("*.geo")]
    is_small = not sizes or max(sizes) <= LARGEST
    command = "run" if is_small else "inspect"
    with tempfile.TemporaryDirectory() as out:
        words = [kluft, command, str(folder / "scene.toml"), "--out", out]
        done = subprocess.run(words, timeout=PATIENCE, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SystemExit(f"{folder.name}: {done.stderr}")
        page = (Path(out) / "report.html").read_text("utf-8") if is_small else ""
    return re.findall(r'<figure class="picture">.*?</figure>', page, re.S)


def style_of(repository: Path) -> str:
    """The style of pictures: that of the pages of runs, and the site's own."""
    lines = (repository / PAGE_STYLE).read_text("utf-8").splitlines()
    rules = [line for line in lines if line.startswith((".grid", ".bar", ".picture", ".axes"))]
    return " ".join([*rules, *STYLE.split("\n")])


def raw(style: str, text: str) -> str:
    """A block of HTML with its style."""
    return f"```{{raw}} html\n<style>{style}</style>{text}\n```\n"


def card(name: str, title: str, picture: str) -> str:
    """The link to a scene in the gallery, with its picture."""
    drawn = re.search(r"<svg.*?</svg>", picture, re.S)
    return f"<a class=\"picture\" href=\"{name}.html\">{drawn.group(0) if drawn else ''}{html.escape(title)}</a>"


def gallery(repository: Path, out: Path, kluft: str | None) -> None:
    """A page for each scene, and one that shows them all."""
    out.mkdir()
    names, cards, style = [], [], style_of(repository)
    for folder in sorted((repository / "geometries").iterdir()):
        file = folder / "scene.toml"
        if not file.is_file():
            continue
        scene = file.read_text("utf-8")
        stated = re.search(r'^title = "(.*)"', scene, re.M)
        title = stated.group(1) if stated else folder.name
        shown = "\n".join(scene.splitlines()[:120])
        pictures = pictures_of(folder, kluft)
        grid = raw(style, f"<div class=\"grid\">{''.join(pictures[:2])}</div>") if pictures else ""
        text = f"# {title}\n\n`geometries/{folder.name}`\n\n{grid}\n"
        text += f"## What it is, and its oracle\n\n```text\n{comment_of(scene)}\n```\n\n## Scene\n\n```toml\n{shown}\n```\n"
        (out / f"{folder.name}.md").write_text(text, "utf-8")
        names.append(folder.name)
        cards.append(card(folder.name, title, pictures[0] if pictures else ""))
    listed = "\n".join(names)
    shown = raw(style, f"<div class=\"grid cards\">{''.join(cards)}</div>") if kluft else ""
    tree = f"```{{toctree}}\n:maxdepth: 1\n{':hidden:' if kluft else ''}\n\n{listed}\n```\n"
    index = f"# Gallery\n\nScenes that run, each with its oracle.\n\n{shown}\n{tree}"
    (out / "index.md").write_text(index, "utf-8")


def relink(text: str, page: Path, repository: Path) -> str:
    """Links to files that are no pages lead to the repository."""

    def link(match: re.Match[str]) -> str:
        target = match.group(1)
        path, _, anchor = target.partition("#")
        if not path or re.match(r"[a-z]+:", target):
            return match.group(0)
        meant = (page.parent / path).resolve()
        docs = repository / "docs"
        if meant == repository / "geometries" / "README.md":
            return f"]({'../' * len(page.relative_to(docs).parent.parts)}gallery/index.md)"
        is_page = meant.is_relative_to(docs) and meant.suffix in (".md", ".ipynb", ".svg", ".png")
        if is_page and not meant.is_relative_to(docs / "schema"):
            return match.group(0)
        if not meant.exists():
            raise SystemExit(f"{page}: there is no {target}")
        return f"]({FORGE}{meant.relative_to(repository)}{'#' + anchor if anchor else ''})"

    return re.sub(r"\]\(([^)\s]+)\)", link, text)


def main() -> None:
    """Lays out all pages."""
    repository, out = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    kluft = sys.argv[3] if len(sys.argv) > 3 else None
    docs = repository / "docs"
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(docs, out, ignore=shutil.ignore_patterns("site", "schema", "*.csv", "*.json"))
    for page in docs.rglob("*.md"):
        copy = out / page.relative_to(docs)
        if copy.exists():
            copy.write_text(relink(page.read_text("utf-8"), page, repository), "utf-8")
    readme = (out / "README.md").read_text("utf-8").partition("\n")[2]
    (out / "index.md").write_text(INDEX.format(content=readme), "utf-8")
    (out / "README.md").unlink()
    (out / "python.md").write_text(PYTHON, "utf-8")
    changes = (repository / "CHANGELOG.md").read_text("utf-8")
    (out / "changelog.md").write_text(relink(changes, repository / "CHANGELOG.md", repository), "utf-8")
    gallery(repository, out / "gallery", kluft)
    shutil.copy(docs / "site" / "conf.py", out / "conf.py")


main()

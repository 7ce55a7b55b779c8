"""Scenes made of keywords, read and written."""

import inspect
import pathlib
import re

import numpy as np
import pytest
from conftest import scene_of

import kluft

ROOT = pathlib.Path(__file__).parents[3]
GEOMETRIES = ROOT / "geometries"


def test_keywords_become_the_text_of_a_scene(scene):
    text = scene.to_toml()
    again = kluft.Scene.parse(text)
    assert again.tables == scene._plain()
    assert 'young_modulus = "50 GPa"' in text and "[fracture.joint]" in text


def test_arrays_and_paths_may_stand_in_a_scene():
    scene = kluft.Scene(
        mesh=kluft.MeshSource(file=pathlib.Path("a.msh")),
        load=kluft.Load(steps=np.linspace(0.5, 1.0, 2)),
        rock={"default": kluft.Rock(young_modulus=np.float64(5e10), poisson_ratio=0.2)},
    )
    assert scene._plain()["load"] == {"steps": [0.5, 1.0]}
    assert scene.check() == []


def test_shipped_scenes_are_read_and_are_written_again():
    for file in sorted(GEOMETRIES.glob("*/scene.toml")):
        scene = kluft.Scene.read(file)
        tables = {key: value for key, value in scene.tables.items()}
        again = kluft.Scene.parse(kluft.Scene(**_known(tables)).to_toml(), folder=file.parent)
        assert again.tables == _known(tables), file


def _known(tables):
    return {key: value for key, value in tables.items() if key != "study"}


def test_defects_of_a_file_have_its_lines(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text("[mesh]\nfile = 'a.msh'\n[rock.default]\nyoung_moduls = 1e9\n")
    with pytest.raises(kluft.InputError) as caught:
        kluft.Scene.read(file)
    places = [defect.place for defect in caught.value.defects]
    assert any(place.startswith(f"{file}:4") for place in places), places
    with pytest.raises(kluft.InputError):
        kluft.Scene.read(tmp_path / "nowhere.toml")


def test_values_are_replaced_key_by_key(scene):
    changed = scene.replace(fracture={"joint": {"closure": "linear"}}, load={"steps": [0.5]})
    tables = changed.tables
    assert tables["fracture"]["joint"]["closure"] == "linear"
    assert tables["fracture"]["joint"]["normal_stiffness"] == 1e11
    assert tables["load"] == {"steps": [0.5]}
    assert scene._plain()["fracture"]["joint"]["closure"] == "logarithmic"


def test_doubts_are_returned():
    rock = {"rock": kluft.Rock(young_modulus=60, poisson_ratio=0.25)}
    warnings = scene_of(rock=rock).check()
    assert len(warnings) == 1 and "young_modulus" in warnings[0]


def test_the_site_documents_all_that_the_package_offers():
    """The names that `docs/site/make.py` hands to Sphinx; a module without names has all of its."""
    text = (ROOT / "docs" / "site" / "make.py").read_text("utf-8")
    pages = re.findall(r"automodule:: (\S+)\n   :members:((?:[^:`]|\n)*)", text)
    modules = {"kluft": kluft, "kluft.keys": kluft.keys}
    documented = set()
    for module, members in pages:
        names = re.findall(r"\w+", members) or modules[module].__all__
        documented |= {getattr(modules[module], name) for name in names}
    offered = {getattr(kluft, name) for name in kluft.__all__}
    assert offered == documented and all(inspect.getdoc(one) for one in offered)

"""What is seen, and from where; every command's way in."""

import json
import os
import subprocess

import numpy as np
import pytest
from studio_window import BIN, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

pytestmark = needs_window

VIEW = np.s_[60:540, 200:590]


def listed(display, folder, settings=None):
    state = folder / "state/coif"
    state.mkdir(parents=True, exist_ok=True)
    if settings:
        (state / "studio.json").write_text(json.dumps(settings))
    environment = dict(os.environ, DISPLAY=display, XDG_STATE_HOME=str(folder / "state"))
    done = subprocess.run([BIN / "coif-studio", "--list-commands"], env=environment, capture_output=True, text=True,
                          check=True)
    return json.loads(done.stdout)


@pytest.mark.parametrize("habit", ["Blender", "Maya"])
def test_every_command_is_in_a_menu_in_the_palette_and_on_a_key(display, tmp_path, habit):
    entries = listed(display, tmp_path, {"mayaMouse": habit == "Maya"})
    names = [e["name"] for e in entries]
    assert len(names) == len(set(names)) and {c["name"] for c in coif.editor_commands()} <= set(names)
    assert all(e["menu"] and e["help"] and e["label"] for e in entries), "menus and palette show this list"
    keys = [key for e in entries for key in e["key"].split()]
    assert len(keys) == len(set(keys)), sorted(k for k in keys if keys.count(k) > 1)
    without = {e["name"] for e in entries if not e["key"]}
    assert without <= KEYLESS, f"without a key: {sorted(without - KEYLESS)}"


KEYLESS = {
    "select", "displace", "brush",  # lists that the mouse fills in
    "set_strands", "set_look", "set_light", "set_dynamics",  # panels
    "mesh_hidden", "mesh_wire", "mesh_shaded", "mesh_xray",  # Z goes through them
    "maya_habits", "light_theme",  # settings
    "kind_layer", "kind_group",  # Maya has other uses for 5 and 6
}


def test_keys_look_from_every_side(studio):
    pictures = {}
    for key in ["KP_1", "KP_3", "KP_7", "ctrl+KP_1", "ctrl+KP_3"]:
        studio.key(key)
        pictures[key] = studio.shot(f"view-{key.replace('+', '-')}")[VIEW]
    keys = list(pictures)
    for i, a in enumerate(keys):
        for b in keys[i + 1 :]:
            assert np.abs(pictures[a] - pictures[b]).mean() > 2, f"{a} and {b} show the same"


def test_parallel_and_steps_and_frame_all(studio):
    studio.key("KP_1")
    near = studio.shot("view-perspective")[VIEW]
    studio.key("KP_5")
    far = studio.shot("view-parallel")[VIEW]
    assert np.abs(near - far).mean() > 0.5
    studio.key("KP_5", "KP_6", "KP_6")
    studio.wheel(5)
    close = studio.shot("view-close")[VIEW]
    studio.key("Home")
    assert np.abs(studio.shot("view-all")[VIEW] - close).mean() > 2
    assert studio.lines() == [], "looking changes no document"

"""What is seen, and from where; every command's way in."""

import json
import os
import subprocess
import time

import numpy as np
import pytest
from studio_window import BAR, BIN, RIGHT, SIZE, VIEW, needs_window, operator_kinds

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

pytestmark = needs_window


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
    without = {e["name"] for e in entries if not e["key"]} - {f"add_{kind}" for kind in operator_kinds()}
    assert without <= KEYLESS, f"without a key: {sorted(without - KEYLESS)}"


KEYLESS = {
    # the panel Style
    "add_operator", "set_operator", "set_ramp", "remove_operator", "move_operator", "rename_operator", "set_mask",
    "paint_mask", "fit_points",
    "select", "displace", "brush",  # lists that the mouse fills in
    "set_strands", "set_look", "set_light", "set_dynamics",  # panels
    "mesh_hidden", "mesh_wire", "mesh_shaded", "mesh_xray",  # Z goes through them
    "head_shaded", "head_wire", "head_xray",  # Alt+Z
    "color_layer", "color_bundle", "color_group",  # Shift+Z
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


def test_the_mesh_and_the_head_are_shown_in_every_style(studio):
    studio.key("KP_1")
    pictures = [studio.shot("style-wire")[VIEW]]
    for name, key in [("shaded", "z"), ("shaded-bundles", "shift+z"), ("xray", "z"), ("hidden", "z"),
                      ("head-wire", "alt+z"), ("head-xray", "alt+z"), ("no-strands", "alt+1"), ("beside", "ctrl+b")]:
        studio.key(key)
        time.sleep(0.5)
        pictures.append(studio.shot(f"style-{name}")[VIEW])
    for before, after in zip(pictures, pictures[1:], strict=False):
        assert np.abs(before - after).max() > 30, "each style looks another"


def test_light_and_colour_are_seen_at_once_and_stay_in_the_document(studio):
    studio.key("F8")  # light from hair to hair
    time.sleep(1.5)
    dark = studio.shot("light-before")[VIEW]
    width = SIZE[0]
    studio.panel("Hair colour")
    line = studio.does(lambda: studio.click(width - RIGHT + 50, 205), "set_look")
    assert "color=" in line
    time.sleep(1.5)
    assert np.abs(studio.shot("light-colour")[VIEW] - dark).max() > 25
    studio.panel("Hair colour")
    studio.panel("Light")
    line = studio.does(lambda: studio.drag((width - RIGHT + 60, 184), (width - RIGHT + 130, 154)), "set_light")
    assert "azimuth=" in line
    time.sleep(1.5)
    studio.shot("light-moved")
    studio.saved()
    look = json.loads((studio.folder / "bob.coif").read_text())["look"]
    assert look["light"]["azimuth"] != -42


def test_a_turntable_turns_and_is_written(studio):
    before = studio.shot("turntable-before")[VIEW]
    studio.key("t")
    time.sleep(1)
    studio.key("t")
    assert np.abs(studio.shot("turntable-after")[VIEW] - before).mean() > 2
    studio.path(studio.folder / "turn.png", "ctrl+F12")
    first, third = studio.folder / "turn-0001.png", studio.folder / "turn-0003.png"
    studio.wait(third.exists, "three pictures")
    studio.key("Escape")
    from PIL import Image

    a, b = (np.asarray(Image.open(p).convert("RGB"), float) for p in (first, third))
    assert a.shape == b.shape and np.abs(a - b).mean() > 1, "from another side"


def test_the_axes_in_the_corner_are_clicked(studio):
    studio.key("KP_1")
    front = studio.settled("axes-front")[VIEW]
    at = (SIZE[0] - RIGHT - 46 + 30, BAR + 48)  # the ball of +x, seen from the front
    studio.click(*at)
    side = studio.settled("axes-right")[VIEW]
    assert np.abs(front - side).mean() > 2
    studio.key("KP_1", "KP_3")
    same = lambda: np.abs(studio.shot("axes-key")[VIEW] - side).mean() < 6  # noqa: E731
    studio.wait(same, "the same side as by the key")
    assert studio.lines() == []

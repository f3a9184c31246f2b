"""The style's panel: operators of every kind the library has, sliders, ramps, masks."""

import ast
import shutil
import time

import numpy as np
import pytest
from studio_window import RIGHT, SIZE, VIEW, Studio, needs_window, operator_kinds

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
pytestmark = needs_window

GROUP = 415  # the choice of a group
X = SIZE[0] - RIGHT  # left edge of the panels
# Pixels from the top, with one operator of a kind with three numbers, a seed and a ramp: frizz.
ADD, CHOICE, FIRST, AMOUNT, HEIGHT, BUTTONS = 85, 18, 109, 164, 188, 452
RAMP_TOP, RAMP_BOTTOM = 307, 389  # 1 and 0 of the ramp


def arguments(line):
    return {k.arg: ast.literal_eval(k.value) for k in ast.parse(line, mode="eval").body.keywords}


def styles(studio):
    studio.saved()
    return coif.Scene.load(studio.folder / "bob.coif").styles


def on_ramp(x, y):
    return X + 16 + 255 * x, RAMP_BOTTOM + y * (RAMP_TOP - RAMP_BOTTOM)


@pytest.fixture
def frizz(studio):
    studio.panel("Style")
    studio.palette("add_frizz", 'add_operator(kind="frizz")')
    return studio


def test_every_kind_of_the_registry_is_added_and_taken_back(studio):
    kinds = operator_kinds()
    assert len(kinds) >= 10
    for kind in kinds:
        studio.palette(f"add_{kind}", f'add_operator(kind="{kind}")')
    assert [op["kind"] for op in styles(studio)] == kinds
    for _ in kinds:
        studio.did("undo", "ctrl+z")
    assert styles(studio) == []


def test_the_panels_list_is_the_registry(studio):
    studio.panel("Style")
    kinds = operator_kinds()
    for number in (0, len(kinds) - 1):
        studio.click(X + 100, ADD)
        time.sleep(0.3)
        studio.shot("style-kinds")
        line = studio.does(lambda n=number: studio.click(X + 60, ADD + 24 + CHOICE * n), "add_operator")
        assert arguments(line)["kind"] == kinds[number]
        studio.did("undo", "ctrl+z")


def test_a_slider_is_seen_while_it_is_dragged_and_is_one_step(frizz):
    before = frizz.settled("style-frizz")[VIEW]
    lines = len(frizz.lines())
    frizz.point(X + 15, HEIGHT)
    frizz.press()
    for x in (40, 80, 120, 150):
        frizz.point(X + x, HEIGHT)
    frizz.wait(lambda: np.abs(frizz.shot("style-dragged")[VIEW] - before).mean() > 1, "the strands to follow")
    assert len(frizz.lines()) == lines, "nothing is done yet"
    line = frizz.does(frizz.release, "set_operator")
    assert len(frizz.lines()) == lines + 1, "one step"
    given = arguments(line)
    assert given["operator"] == "Frizz" and given["parameter"] == "height" and given["value"] > 1
    assert styles(frizz)[0]["parameters"]["height"] == given["value"]
    line = frizz.does(lambda: frizz.drag((X + 150, AMOUNT), (X + 80, AMOUNT)), "set_operator")
    assert arguments(line)["parameter"] == "amount" and 0.2 < arguments(line)["value"] < 0.8


def test_a_ramp_is_drawn_from_root_to_tip(frizz):
    points = lambda line: np.reshape(arguments(line)["points"], (-1, 2))  # noqa: E731
    old = np.array(styles(frizz)[0]["ramp"])
    line = frizz.does(lambda: frizz.click(*on_ramp(0.65, 0.4)), "set_ramp")
    added = points(line)
    assert len(added) == len(old) + 1
    new = added[np.argmin(np.abs(added[:, 0] - 0.65))]
    assert np.allclose(new, (0.65, 0.4), atol=0.05), "where the mouse was"
    line = frizz.does(lambda: frizz.drag(on_ramp(*new), on_ramp(0.8, 0.75)), "set_ramp")
    moved = points(line)[np.argmin(np.abs(points(line)[:, 0] - 0.8))]
    assert len(points(line)) == len(added) and np.allclose(moved, (0.8, 0.75), atol=0.05)
    frizz.settled("style-ramp")
    with frizz.held("ctrl"):
        line = frizz.does(lambda: frizz.click(*on_ramp(*moved)), "set_ramp")
    assert len(points(line)) == len(old)
    for _ in range(3):
        frizz.did("undo", "ctrl+z")
    assert np.allclose(styles(frizz)[0]["ramp"], old)


def test_a_mask_is_painted_on_the_scalp(frizz):
    third = 92  # pixels from button to button
    line = frizz.does(lambda: frizz.click(X + 50 + 2 * third, BUTTONS), "set_mask")
    assert arguments(line)["values"] == [0]
    frizz.key("KP_1", "Home")
    frizz.click(X + 50, BUTTONS)  # Paint
    c = frizz.middle()
    nowhere = frizz.settled("mask-nowhere")[VIEW]
    line = frizz.does(lambda: frizz.drag(c + (-45, -140), c + (0, -150), c + (45, -140)), "paint_mask")
    given = arguments(line)
    assert given["operator"] == "Frizz" and given.get("value", 1) == 1
    painted = frizz.settled("mask-painted")[VIEW]
    redder = (painted[..., 0] - painted[..., 2]) - (nowhere[..., 0] - nowhere[..., 2])
    assert redder.max() > 60, "blue has become orange"
    mask = styles(frizz)[0]["mask"]
    assert 0 < sum(v > 0.2 for v in mask.values()) < len(mask)
    with frizz.held("ctrl"):
        line = frizz.does(lambda: frizz.drag(c + (-45, -140), c + (0, -150), c + (45, -140)), "paint_mask")
    assert arguments(line)["value"] == 0, "Ctrl paints the other way"
    frizz.does(lambda: frizz.click(X + 50 + third, BUTTONS), "set_mask")
    assert not styles(frizz)[0]["mask"], "everywhere"


def test_operators_are_ordered_switched_and_taken_away(frizz):
    frizz.palette("add_curl", 'add_operator(kind="curl")')
    up, down, away = SIZE[0] - 79, SIZE[0] - 56, SIZE[0] - 32
    row = 26  # from operator to operator
    line = frizz.does(lambda: frizz.click(up, FIRST + row), "move_operator")
    assert arguments(line) == {"operator": "Curl", "to": 0}
    line = frizz.does(lambda: frizz.click(down, FIRST), "move_operator")
    assert arguments(line) == {"operator": "Curl", "to": 1}
    line = frizz.does(lambda: frizz.click(X + 20, FIRST), "set_operator")
    assert arguments(line) == {"operator": "Frizz", "parameter": "enabled", "value": 0}
    line = frizz.does(lambda: frizz.click(away, FIRST + row), "remove_operator")
    assert arguments(line) == {"operator": "Curl"}
    left = styles(frizz)
    assert [(op["kind"], op["enabled"]) for op in left] == [("frizz", False)]


def test_keys_order_switch_name_and_take_away(frizz):
    before = frizz.lines()
    frizz.palette("add_curl", 'add_operator(kind="curl")')
    assert arguments(frizz.did("move_operator", "ctrl+shift+Up")) == {"operator": "Curl", "to": 0}
    frizz.does_nothing(lambda: frizz.key("ctrl+shift+Up"))  # it is the first already
    frizz.key("ctrl+Down")  # now Frizz
    assert arguments(frizz.did("set_operator", "ctrl+shift+t")) == {
        "operator": "Frizz", "parameter": "enabled", "value": 0}
    frizz.key("F2", "ctrl+a")
    frizz.type("Halo")
    assert arguments(frizz.did("rename_operator", "Return")) == {"operator": "Frizz", "name": "Halo"}
    assert arguments(frizz.did("set_operator", "ctrl+shift+t"))["operator"] == "Halo"
    frizz.key("ctrl+Up")
    assert arguments(frizz.did("remove_operator", "ctrl+shift+x")) == {"operator": "Curl"}
    assert [(op["name"], op["enabled"]) for op in styles(frizz)] == [("Halo", True)]
    assert len(frizz.lines()) == len(before) + 6, "one step each"


@pytest.fixture
def grouped(display, bob, tmp_path):
    """The bob with its left half in a group, and frizz on all of it."""
    editor = coif.Editor.open(bob)
    mesh = editor.mesh
    left = [b.id for b in mesh.bundles if mesh.positions[b.vertices[0], 0].mean() > 0.5]
    editor.select(faces=np.ravel([(id_, 1) for id_ in left]))
    editor.set_group(name="left")
    editor.add_operator(kind="frizz")
    editor.set_operator(operator="Frizz", parameter="height", value=2)
    editor.select_none()
    shutil.copy(bob.parent / "head.obj", tmp_path / "head.obj")
    editor.save(tmp_path / "bob.coif")
    made = Studio(display, tmp_path, "bob.coif").opened("bob.coif")
    made.key("KP_1", "Home", "z", "z", "z")  # from the front, without the mesh
    made.panel("Style")
    yield made
    made.end()


def test_an_operator_is_kept_to_a_group(grouped):
    everywhere = grouped.settled("group-all")[VIEW]
    grouped.click(X + 60, GROUP)
    time.sleep(0.3)
    grouped.shot("group-choice")
    line = grouped.does(lambda: grouped.click(X + 60, GROUP + 15 + 2 * CHOICE), "set_operator")
    assert arguments(line) == {"operator": "Frizz", "parameter": "group", "text": "left"}
    assert styles(grouped)[0]["group"] == "left"
    kept = grouped.settled("group-left")[VIEW]
    change = np.abs(kept - everywhere).mean(axis=(0, 2))
    middle = len(change) // 2  # the head's left is at the right of a picture from the front
    assert change[: middle - 30].mean() > 3 * change[middle + 30 :].mean(), "only the other side lost its frizz"
    grouped.click(X + 60, GROUP)
    time.sleep(0.3)
    line = grouped.does(lambda: grouped.click(X + 60, GROUP + 15), "set_operator")
    assert arguments(line)["text"] == "" and styles(grouped)[0]["group"] == ""


def test_a_mask_is_painted_on_both_sides_at_once(frizz):
    frizz.does(lambda: frizz.click(X + 50 + 2 * 92, BUTTONS), "set_mask")
    frizz.did("symmetry", "ctrl+m")
    frizz.key("KP_1", "Home", "ctrl+shift+k")
    c = frizz.middle()
    frizz.does(lambda: frizz.drag(c + (30, -145), c + (60, -125)), "paint_mask")
    mesh = frizz.saved()
    mask = {int(v): value for v, value in coif.Scene.load(frizz.folder / "bob.coif").styles[0]["mask"].items()}
    at = dict(zip(mesh.vertex_ids.tolist(), mesh.positions, strict=True))
    roots = np.array([at[v] for v in mask])
    painted = [v for v, value in mask.items() if value > 0.2]
    assert painted
    for v in painted:  # each has a partner across x = 0 that was painted as much
        partner = list(mask)[np.argmin(np.linalg.norm(roots - at[v] * (-1, 1, 1), axis=1))]
        assert mask[partner] == pytest.approx(mask[v], abs=1e-9)
    assert any(at[v][0] > 1 for v in painted) and any(at[v][0] < -1 for v in painted)
    frizz.settled("mask-both-sides")

"""Keys and mouse faster than the frames: nothing is lost, and nothing goes to what is yet to open or has closed."""

import pytest
from studio_window import Studio, bob, display, needs_window  # noqa: F401

pytestmark = needs_window


@pytest.fixture(scope="module")
def studio(display, bob, tmp_path_factory):
    opened = Studio(display, tmp_path_factory.mktemp("slow"), bob).opened("bob")
    yield opened
    opened.end()


def commands(lines):
    return [line.split(".", 1)[-1] for line in lines]


def said(studio, before, count):
    """The commands since, once there are so many; none follows."""
    studio.wait(lambda: len(studio.lines()) >= before + count, f"{count} commands")
    studio.rest()
    return commands(studio.lines()[before:])


def test_different_keys_of_one_frame_count_each_in_their_order(studio):
    before = len(studio.lines())
    with studio.frozen():
        # Some milliseconds apart: GLFW takes presses of one key at one time for one.
        studio.tool("key", "--delay", "25", "3", "a", "shift+r", "shift+r", "ctrl+z", "ctrl+z", "alt+a", "2", "a")
    done = said(studio, before, 7)
    names = [line.split("(")[0] for line in done]
    assert names == ["select_all", "smooth", "smooth", "undo", "undo", "select_none", "select_all"], done
    assert "face" in done[0] and "edge" in done[-1]


def test_text_goes_to_the_field_that_the_key_before_it_opens(studio):
    before = len(studio.lines())
    with studio.frozen():
        studio.key("F3")  # the palette
        studio.type("select none")
        studio.key("Return")
        studio.key("ctrl+shift+i")  # by id
        studio.type("b 1 2")
        studio.key("Return")
        studio.key("a")
    done = said(studio, before, 3)
    assert [line.split("(")[0] for line in done] == ["select_none", "select", "select_all"], done


def test_a_drag_and_a_moving_tool_are_followed(studio):
    studio.key("1")
    studio.did("select_none", "alt+a")
    before = len(studio.lines())
    x, y = studio.middle()
    with studio.frozen():
        studio.drag((x - 170, y - 200), (x + 170, y + 200))  # a box
        studio.point(x, y)
        studio.key("g")  # moves with the mouse …
        studio.point(x + 40, y)
        studio.click(x + 40, y)  # … until it is clicked
    done = said(studio, before, 2)
    assert done[0].startswith("select") and done[-1].startswith("translate"), done
    offset = [float(number) for number in done[-1].split("(", 2)[2].split(")")[0].split(",")]
    assert max(map(abs, offset)) > 0.1, done

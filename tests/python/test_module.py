"""The module as a whole: documentation, stubs, errors, interruption."""

import ast
import copy
import enum
import inspect
import pathlib
import pickle

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

PACKAGE = pathlib.Path(coif.__file__).parent


def public_members():
    """(dotted name, object) of every public name of the module and of its classes."""
    for name in coif.__all__:
        thing = getattr(coif, name)
        yield name, thing
        if inspect.isclass(thing) and not issubclass(thing, (enum.Enum, BaseException)):
            for member, value in vars(thing).items():
                if not member.startswith("_") and not inspect.isclass(value):
                    yield f"{name}.{member}", value


def test_every_public_name_has_a_docstring():
    bare = [name for name, thing in public_members() if not (getattr(thing, "__doc__", None) or "").strip()]
    assert bare == []


def test_functions_document_more_than_their_signature():
    # nanobind puts the signature first; a docstring of one line is a signature alone.
    for name, thing in public_members():
        if callable(thing) and not inspect.isclass(thing):
            assert len(thing.__doc__.strip().splitlines()) >= 2, name


def test_every_parameter_has_a_name():
    for name, thing in public_members():
        if callable(thing) and not inspect.isclass(thing):
            assert "arg0" not in thing.__doc__ and "arg:" not in thing.__doc__, name


def test_no_signature_shows_a_cpp_type():
    for name, thing in public_members():
        if callable(thing):
            assert "::" not in (thing.__doc__ or ""), name


def test_everything_has_a_repr(tuft):
    report = coif.place(tuft)
    strands = coif.grow(tuft, count=10)
    head = coif.Scalp(coif.example_head(16))
    made = tuft.extrude_faces(tuft.bundle_ids)
    for thing in (tuft, report, report.error, strands, strands.report, head, head.mesh, head.surface, head.region(),
                  head.report(), head.surface.nearest((0, 0, 0)), made, tuft.bundles[0], coif.Scene(tuft)):
        assert repr(thing).startswith("<coif."), thing
    assert str(head.report())


def test_stubs_name_everything_public_and_parse():
    tree = ast.parse((PACKAGE / "_coif.pyi").read_text())
    defined = {"studio"}  # of _studio.py, which is Python itself
    for node in tree.body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            defined.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            defined.add(node.target.id)
        elif isinstance(node, (ast.ImportFrom, ast.Import)):
            defined.update((alias.asname or alias.name) for alias in node.names)
    assert set(coif.__all__) - defined == set()
    assert (PACKAGE / "py.typed").exists()


def test_stubs_know_shapes_and_types():
    text = (PACKAGE / "_coif.pyi").read_text()
    tree = ast.parse(text)
    strand_set = next(n for n in tree.body if isinstance(n, ast.ClassDef) and n.name == "StrandSet")
    points = next(n for n in strand_set.body if isinstance(n, ast.FunctionDef) and n.name == "points")
    assert "float32" in ast.unparse(points.returns) and "(None, 3)" in ast.unparse(points.returns)
    grow = next(n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == "grow")
    assert ast.unparse(grow.returns) == "StrandSet"


def test_error_carries_the_sentence_and_its_parts(tmp_path):
    path = tmp_path / "broken.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    with pytest.raises(coif.Error) as caught:
        coif.PolygonMesh.load(path)
    error = caught.value
    assert error.code in (coif.ErrorCode.MALFORMED, coif.ErrorCode.INVALID_ARGUMENT)
    assert error.file == str(path)
    assert "4" in error.place  # the line of the bad face
    assert str(error) == f"{error.file}: {error.place}: {error.message}"
    assert error.message and error.file not in error.message


def test_missing_file_is_also_what_python_calls_it(tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        coif.PolygonMesh.load(tmp_path / "no such file.obj")
    assert isinstance(caught.value, coif.Error)
    assert caught.value.code is coif.ErrorCode.NOT_FOUND
    assert "no such file.obj" in str(caught.value)


def test_argument_errors_are_value_errors(tuft):
    with pytest.raises(ValueError) as caught:
        coif.grow(tuft, count=10, points=1)
    assert isinstance(caught.value, coif.ArgumentError) and caught.value.code is coif.ErrorCode.INVALID_ARGUMENT


def test_errors_survive_pickling():
    with pytest.raises(coif.Error) as caught:
        coif.PolygonMesh([(0, 0, 0)], [(0, 1, 2)])
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is type(caught.value) and str(again) == str(caught.value) and again.code is caught.value.code


@pytest.mark.parametrize("positions", [[(0, 0)], 3.0, [[[0, 0, 0]]], [("a", "b", "c")]])
def test_wrong_shapes_are_value_or_type_errors(positions):
    with pytest.raises((ValueError, TypeError)) as caught:
        coif.PolygonMesh(positions, [(0, 1, 2)])
    assert "positions" in str(caught.value)


def test_fractions_are_no_indices():
    with pytest.raises(TypeError, match="faces"):
        coif.PolygonMesh(np.zeros((3, 3)), [(0.0, 1.0, 2.5)])


def test_negative_index_is_refused():
    with pytest.raises(ValueError, match="-1"):
        coif.PolygonMesh(np.zeros((3, 3)), [(0, 1, -1)])


def test_progress_is_called_and_may_stop_the_computation(tuft):
    seen = []
    coif.grow(tuft, count=20000, points=32, progress=lambda what, fraction: seen.append((what, fraction)))
    assert seen, "a long computation reports progress"
    assert all(isinstance(what, str) and 0 <= fraction <= 1 for what, fraction in seen)

    def stop(what, fraction):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        coif.grow(tuft, count=20000, points=32, progress=stop)


def test_copies_are_independent(tuft):
    other = copy.deepcopy(tuft)
    assert other == tuft
    other.positions = other.positions + 1
    assert other != tuft
    assert np.array_equal(tuft.positions + 1, other.positions)

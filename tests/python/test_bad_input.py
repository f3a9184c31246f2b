"""Bad input at the command: one sentence that says what is wrong and where, a status, and nothing written."""

import json
import shutil
import subprocess

import pytest

from test_cli import COIF, head, run  # noqa: F401 (head: a fixture)


@pytest.fixture(scope="module")
def folder(head, tmp_path_factory):  # noqa: F811
    """A scene, its strands in every format, and everything that can be wrong with a file."""
    folder = tmp_path_factory.mktemp("bad")
    shutil.copy(head, folder / "head.obj")
    run("new", "--scalp", "head.obj", "--meters-per-unit", 0.01, "--style", "pixie", "-o", "s.coif", cwd=folder)
    names = [f"s.{kind}" for kind in ("usda", "usdc", "glb", "gltf", "hair")]
    run("build", "s.coif", *[word for name in names for word in ("-o", name)], "--strands", 50, "--points", 4,
        cwd=folder)
    for name in names:
        (folder / f"cut_{name}").write_bytes((folder / name).read_bytes()[:-200])
        (folder / f"empty_{name}").write_bytes(b"")
        (folder / f"zeros_{name}").write_bytes(bytes(4096))
    text = (folder / "s.coif").read_text()
    (folder / "cut.coif").write_text(text[: len(text) // 3])
    (folder / "empty.coif").write_text("")
    (folder / "huge_number.coif").write_text(text.replace('"metersPerUnit": 0.01', '"metersPerUnit": 1e999'))
    (folder / "list.coif").write_text("[1, 2]")
    scene = json.loads(text)
    for name, part, key, value in (("unit", None, "metersPerUnit", -1), ("version", None, "version", 0),
                                   ("points", "strands", "points", 10**9), ("cell", "dynamics", "cell", 0),
                                   ("head", "head", "path", "gone.obj"), ("dir", "head", "path", "a.obj")):
        spoilt = json.loads(json.dumps(scene))
        (spoilt if part is None else spoilt[part])[key] = value
        (folder / f"{name}.coif").write_text(json.dumps(spoilt))
    for name in ("a.coif", "a.hair", "a.obj", "a.png", "a.coifcache"):
        (folder / name).mkdir()
    (folder / "far.txt").write_text("0 0 0 0 0 0 1\n1e300 0 0 0 0 0 1\n")
    (folder / "six.txt").write_text("0 0 0 0 0 0 1\n0 0 0 0 0 1\n")
    return folder


def new(*more, out="out.coif"):
    return ["new", "--scalp", "head.obj", "--style", "bob", "-o", out, *more]


def move(*more, out="out.coifcache"):
    return ["simulate", "s.coif", "-o", out, "--frames", "1000000", *more]  # never ends if it ever begins


BUILD = ["build", "s.coif", "-o", "out.usdc"]
SHOW = ["render", "s.coif", "-o", "out.png"]
FAULTS = [  # status, what the sentence says, the command
    *[(1, f"{fault}_s.{kind}: ", ["convert", f"{fault}_s.{kind}", "out.hair"])
      for fault in ("cut", "empty", "zeros") for kind in ("usda", "usdc", "glb", "gltf", "hair")],
    (1, "a.hair: cannot read: Is a directory", ["convert", "a.hair", "out.usdc"]),
    (1, "head.obj: the file holds a mesh", ["convert", "head.obj", "out.usdc"]),
    (1, "/dev/zero: cannot read: not a regular file", ["convert", "/dev/zero", "out.usdc"]),
    (1, "s.hair: the file holds strands", ["new", "--scalp", "s.hair", "--style", "bob", "-o", "out.coif"]),
    *[(1, f"{name}.coif: {place}", ["build", f"{name}.coif", "-o", "out.usdc"]) for name, place in (
        ("cut", "byte "), ("empty", "the file is empty"), ("list", "this is no Coif scene"), ("a", "cannot read"),
        ("huge_number", "the JSON holds a number that is too large"),
        ("unit", "metersPerUnit: a number from 1e-12 to 1e+12 is wanted"), ("version", "version: a whole number"),
        ("points", "strands.points: a whole number from 2 to 65536"),
        ("cell", "dynamics.cell: a number from 1e-06 to 1000 is wanted"))],
    (1, "gone.obj: the head", ["build", "head.coif", "-o", "out.usdc"]),
    (1, "a.obj: cannot read: Is a directory", ["build", "dir.coif", "-o", "out.usdc"]),
    (1, "head.obj: this is no Coif scene", ["build", "head.obj", "-o", "out.usdc"]),
    (1, "s.glb: this is no Coif scene", ["render", "s.glb", "-o", "out.png"]),
    # What cannot be written is said before the work, and before another file of the same call is written.
    (1, "nowhere/x.usdc: cannot write in folder", BUILD + ["-o", "nowhere/x.usdc"]),
    (1, "x.xyz: strands are written as", BUILD + ["-o", "x.xyz"]),
    (1, "nowhere/x.json: cannot write in folder", BUILD + ["--report", "nowhere/x.json"]),
    (1, "nowhere/x.coifcache: cannot write in folder", move(out="nowhere/x.coifcache")),
    (1, "a.coifcache: cannot write: Is a directory", move(out="a.coifcache")),
    (1, "x.hair: hair in motion is written as", move(out="x.hair")),
    (1, "nowhere/x.usdc: cannot write in folder", move(out="nowhere/x.usdc")),
    (1, "s.coif: the folder cannot be made", ["bench", "place", "-o", "s.coif"]),
    (1, "nowhere/x.coif: cannot write in folder", new(out="nowhere/x.coif")),
    (1, "nowhere/x.coif: cannot write in folder", ["drape", "s.coif", "-o", "nowhere/x.coif", "--seconds", "3600"]),
    (2, "'bild' is neither a command nor an option", ["bild", "s.coif"]),
    # Numbers.
    *[(2, f"--tolerance: a number above 0, 1e+30 at most, is wanted, not '{v}'", BUILD + ["--tolerance", v])
      for v in ("nan", "inf", "-1", "0", "1e300", "1 2")],
    *[(2, f"--width: a number above 0, 1e+30 at most, is wanted, not '{v}'", BUILD + ["--width", v])
      for v in ("nan", "1e300")],
    (2, "--seed: a whole number from 0 is wanted, not '-1'", BUILD + ["--seed", "-1"]),
    (2, "--strands: ", BUILD + ["--strands", "-1"]),
    (1, "4294967296 strands ", BUILD + ["--strands", "4294967296"]),  # of memory or of 2^31
    (1, "do not fit into memory", BUILD + ["--strands", "2000000000", "--points", "65536"]),
    *[(2, f"--meters-per-unit: a number from 1e-12 to 1e+12 is wanted, not '{v}'", new("--meters-per-unit", v))
      for v in ("nan", "inf", "0", "1e300")],
    (2, "--weld: a number from 0", new("--weld", "nan")),
    (2, "--cage: 'exact' or a number of quads", new("--cage", "3")),
    (2, "'' is not the number of a shell", new("--region", "shell:")),
    (2, "--fps: a number from 0.001 to 100000 is wanted, not 'nan'", move("--fps", "nan")),
    (2, "--set: NAME=VALUE is wanted, not 'x'", move("--set", "x")),
    (2, "--set: cell: a number from 1e-06 to 1000 is wanted here, not '0'", move("--set", "cell=0")),
    (2, "--set: gravity: a number is wanted, not 'nan'", move("--set", "gravity=nan")),
    (2, "--wisps: wisps: a whole number from 0 to 10000", move("--wisps", "999999999")),
    (1, "six.txt: line 2: seven numbers", move("--head-motion", "six.txt")),
    (1, "frame 1: the head is not finite or further than 1e12 units away", move("--head-motion", "far.txt")),
    (2, "--color: a number from 0 to 1 is wanted, not 'nan'", SHOW + ["--color", "nan", "0", "0"]),
    (2, "--target-error: a number from 0 to 10 is wanted, not 'nan'", SHOW + ["--target-error", "nan"]),
    (2, "--size: WIDTHxHEIGHT", SHOW + ["--size", "0x0"]),
    (2, "--camera: AZIMUTH,ELEVATION", SHOW + ["--camera", "0,95"]),
    (2, "--output: scenes are .coif files, not 'x.hair'", ["style", "s.coif", "--add", "curl", "-o", "x.hair"]),
    (2, "value must be finite", ["style", "s.coif", "--add", "curl", "--set", "curl.radius=nan", "-o", "out.coif"]),
    (2, "radius wants a number from 0 to 1000", ["style", "s.coif", "--add", "curl", "--set", "curl.radius=-1", "-o",
                                                 "out.coif"]),
]


@pytest.mark.parametrize("status, says, command", FAULTS, ids=[" ".join(command[:6]) for _, _, command in FAULTS])
def test_is_one_sentence(folder, status, says, command):
    before = sorted(folder.rglob("*"))
    done = subprocess.run([COIF, *command], capture_output=True, text=True, timeout=300, cwd=folder)
    if "without the preview" in done.stderr:
        pytest.skip("built without preview")
    assert done.returncode == status, done.stderr
    assert done.stderr.startswith("coif: ") and len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert says in done.stderr and len(done.stderr) < 600
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize("arguments", [["--nope"], ["a.coif", "b.coif"], ["head.obj", "--style", "beehive"], ["--size", "0x0"]])
def test_the_editor_refuses_in_one_sentence_too(arguments):
    studio = COIF.with_name("coif-studio")
    if not studio.exists():
        pytest.skip("built without the editor")
    done = subprocess.run([studio, *arguments], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert done.stderr.startswith("coif-studio: ") and len(done.stderr.strip().splitlines()) == 1, done.stderr

"""What the writer makes, seen by the Khronos glTF validator."""
import json
import os
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("COIF_BIN_DIR", ROOT / "build/release/bin"))


@pytest.fixture(scope="module")
def verdicts(tmp_path_factory):
    program = BIN / "test_io"
    if not program.exists():
        pytest.skip(f"{program} is not built")
    if shutil.which("node") is None:
        pytest.skip("node is not installed")
    out = tmp_path_factory.mktemp("gltf")
    subprocess.run([program, "--gtest_filter=GltfFiles.*"], check=True, env={**os.environ, "COIF_TEST_OUT": str(out)},
                   stdout=subprocess.DEVNULL)
    files = sorted(str(path) for path in out.iterdir())
    assert files, "the test program left no files"
    run = subprocess.run(["node", ROOT / "tools/gltf_validate.mjs", *files], cwd=ROOT, capture_output=True, text=True)
    if run.returncode == 77:
        pytest.skip(run.stderr.strip())
    assert run.returncode == 0, run.stderr
    found = [json.loads(line) for line in run.stdout.splitlines()]
    assert len(found) == len(files)
    return {pathlib.Path(entry["file"]).name: entry for entry in found}


def test_no_errors_and_no_warnings(verdicts):
    for name, entry in verdicts.items():
        issues = entry["issues"]
        assert issues["numErrors"] == 0 and issues["numWarnings"] == 0, (name, issues["messages"][:5])


def test_only_the_expected_remarks(verdicts):
    """The strand table is known to Coif alone, and no texture uses the UVs yet."""
    expected = {"UNUSED_OBJECT"}
    for name, entry in verdicts.items():
        codes = {message["code"] for message in entry["issues"]["messages"]}
        assert codes <= expected, (name, codes - expected)


def test_lines_and_meshes_are_there(verdicts):
    full = verdicts["full.glb"]["info"]
    assert full["drawCallCount"] == 5  # two groups, the cards, the hair mesh, the head
    assert full["maxAttributes"] == 6
    assert verdicts["plain.glb"]["info"]["drawCallCount"] == 1

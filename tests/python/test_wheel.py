"""`pip install .`: the wheel holds the module, its stubs and the command. Builds everything: slow."""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import zipfile

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    for needed in ("scikit_build_core", "nanobind"):
        if importlib.util.find_spec(needed) is None:
            pytest.skip(f"{needed} is not installed: the wheel cannot be built without a network")
    folder = tmp_path_factory.mktemp("wheel")
    # CMake's own choice of compilers, so that ccache knows what the build tree has compiled already.
    compilers = {"CC": shutil.which("cc"), "CXX": shutil.which("c++")}
    # The compiler by the name that the build used: a cache tells c++ from g++.
    environment = {"CC": "cc", "CXX": "c++"} | dict(os.environ) | {"COIF_LAUNCHER": shutil.which("ccache") or ""} | {k: v for k, v in compilers.items() if v}
    environment.pop("PYTHONPATH", None)
    made = subprocess.run(
        [sys.executable, "-m", "pip", "wheel", str(ROOT), "--no-build-isolation", "--no-deps", "--no-index", "-w", folder],
        env=environment, capture_output=True, text=True)
    assert made.returncode == 0, made.stdout[-4000:] + made.stderr[-4000:]
    return next(folder.glob("coif-*.whl"))


def test_the_wheel_holds_the_module_and_the_command_and_no_more(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    package = {n.split("/")[1] for n in names if n.startswith("coif/")}
    assert {"__init__.py", "__main__.py", "_errors.py", "_coif.pyi", "py.typed"} < package
    assert any(n.startswith("_coif.") and n.endswith(".so") for n in package)
    assert any(n.endswith(".data/scripts/coif") for n in names)
    assert not [n for n in names if n.endswith((".a", ".h", ".cmake")) or "test" in n]


def test_the_installed_command_and_module_run(wheel, tmp_path):
    environment = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True)
    python = environment / "bin" / "python"
    target = subprocess.run([python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"], check=True,
                            capture_output=True, text=True).stdout.strip()
    # The venv takes numpy from here, so that nothing has to be downloaded.
    numpy_home = pathlib.Path(importlib.util.find_spec("numpy").origin).parents[1]
    (pathlib.Path(target) / "numpy_from_here.pth").write_text(f"{numpy_home}\n")
    subprocess.run([sys.executable, "-m", "pip", "--python", python, "install", "--no-deps", "--no-index", wheel], check=True,
                   capture_output=True)
    clean = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    version = subprocess.run([environment / "bin" / "coif", "--version"], check=True, capture_output=True, text=True,
                             env=clean).stdout
    told = subprocess.run([python, "-c", "import coif; print(coif.__version__); print(coif.__file__)"], check=True,
                          capture_output=True, text=True, env=clean, cwd=tmp_path).stdout.split()
    assert told[0] in version and str(environment) in told[1]
    again = subprocess.run([python, "-m", "coif", "--version"], check=True, capture_output=True, text=True, env=clean)
    assert again.stdout == version

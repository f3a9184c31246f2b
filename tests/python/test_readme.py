"""What README.md and docs/ print is what runs: Python samples as they stand, commands with the files they name."""

import pathlib
import re
import shlex
import subprocess

import pytest

from test_cli import COIF, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.S | re.M)


def command_lines(page):
    lines = "".join(blocks(page, "sh") + blocks(page, "")).splitlines()
    return [line for line in lines if line.startswith("coif ")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where a reader stands: a head and the scenes that pages go on with."""
    folder = tmp_path_factory.mktemp("reader")
    run("example-head", "-o", "head.obj", cwd=folder)
    for style in ("bob", "long"):
        run("new", "--scalp", "head.obj", "--meters-per-unit", 0.01, "--style", style, "-o", f"{style}.coif", cwd=folder)
    return folder


def test_sample_runs(tmp_path, monkeypatch, capsys):
    sample = blocks(ROOT / "README.md", "python")[0]
    monkeypatch.chdir(tmp_path)
    exec(compile(sample, "README.md", "exec"), {})
    assert capsys.readouterr().out == "(320000, 3) float32\n"
    assert (tmp_path / "crop.usdc").read_bytes().startswith(b"PXR-USDC")


@pytest.mark.parametrize("page", [page for page in PAGES if command_lines(page)], ids=lambda page: page.name)
def test_printed_commands_run(page, folder):
    for line in command_lines(page):
        words = shlex.split(line, comments=True)
        if "--frames" in words:  # as printed but for the length: a motion is as right on its second frame
            words[words.index("--frames") + 1] = "2"
        done = subprocess.run([COIF, *words[1:]], cwd=folder, capture_output=True, text=True, timeout=600)
        if done.returncode == 2 and "without the preview" in done.stderr:
            continue
        assert done.returncode == 0, (line, done.stderr)
        for output in [b for a, b in zip(words, words[1:]) if a == "-o"]:
            assert (folder / output).stat().st_size > 0, line


@pytest.mark.parametrize("name", ["python.md", "scene.md"])
def test_python_pages_run(name, folder, monkeypatch):
    coif = pytest.importorskip("coif")
    monkeypatch.chdir(folder)
    for sample in blocks(ROOT / "docs" / name, "python"):
        exec(compile(sample, name, "exec"), {"coif": coif})


def test_named_options_are_there():
    """Every option that a page names beside its command, and every one of the page on the command."""
    spans = [span for page in PAGES for span in re.findall(r"`(coif [a-z-]+ [^`]*)`", page.read_text().replace("\n", " "))]
    known = {command: run(command, "--help").stdout for command in {span.split()[1] for span in spans}}
    assert len(spans) > 15
    for span in spans:
        for option in re.findall(r"--[a-z-]+", span):
            assert option in known[span.split()[1]], span
    everything = "".join(known.values()) + run("--help").stdout
    for option in re.findall(r"`[^`\n]*?(--[a-z][a-z-]+)", (ROOT / "docs/cli.md").read_text()):
        assert option in everything, option


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", page.read_text()):
        assert target.startswith("http") or (page.parent / target).exists(), target

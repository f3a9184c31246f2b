"""The README's Python sample runs as it stands."""

import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_sample_runs(tmp_path, monkeypatch, capsys):
    sample = re.search(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S).group(1)
    monkeypatch.chdir(tmp_path)
    exec(compile(sample, "README.md", "exec"), {})
    assert capsys.readouterr().out == "(320000, 3) float32\n"
    assert (tmp_path / "crop.usdc").read_bytes().startswith(b"PXR-USDC")

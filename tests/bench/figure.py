"""A figure of one panel by the program's own renderer, in its palette, its symbols and its ticks."""
import json
import pathlib
import subprocess

BUILD = pathlib.Path(__file__).resolve().parents[2] / "build/release"


def draw(path, title, x, y, series, build=BUILD):
    """Writes an SVG.

    x, y: {"label", "log", "range", "names"}; series: a list of {"label", "x", "y", "line", "style"} of symbols, or of
    lines. Target `figure` of the build draws it.
    """
    figure = {"title": title, "x": x, "y": y, "series": series}
    drawn = subprocess.run([build / "tests/bench/figure"], input=json.dumps(figure), text=True, check=True, capture_output=True)
    pathlib.Path(path).write_text(drawn.stdout)

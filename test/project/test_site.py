"""The pages of the site: all in its navigation, their code runs, their messages exist."""

from __future__ import annotations

import contextlib
import io
import json
import re
import sys
import textwrap
from pathlib import Path

import pytest
from doc_text import ROOT
from source_messages import VALUE, source_messages

sys.path.insert(0, str(ROOT / "docs" / "site"))
from class_fields import described
from docstrings import converted
from navigation import NAVIGATION

DOCS = ROOT / "docs"
CHECKED = sorted(
    [
        DOCS / f"{name}.md"
        for name in ("index", "first_steps", "robots", "troubleshooting", "tuning")
    ]
    + [path for folder in ("tutorials", "concepts") for path in (DOCS / folder).glob("*.md")]
)
NOTEBOOKS = sorted((DOCS / "tutorials").glob("*.ipynb"))
# Commands that other tests run: of the setup, of the examples, of the model packages.
RUN_ELSEWHERE = re.compile(
    r"make (setup|test|docs)|python examples/\w+\.py|pip install (icub-models|xacro)"
    r"|pip install \./src/ghc_controller"
)
_FENCE = re.compile(
    r"(?:^<!-- (needs|from): ([^>]+) -->\n)?^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE
)
_NUMBER = re.compile(r"-?\d+\.\d+")


class _Fence:
    """A block of code, what stands above it, and what it is to print."""

    def __init__(self, found: re.Match[str], after: str) -> None:
        self.mark, self.value, self.language, self.text = found.groups()
        output = re.match(r"\s*```text\n(.*?)^```$", after, re.DOTALL | re.MULTILINE)
        self.output = output[1] if output and self.language == "python" else None


def fences(page: Path) -> list[_Fence]:
    """Blocks of a page in their order."""
    text = page.read_text(encoding="utf-8")
    return [_Fence(found, text[found.end() :]) for found in _FENCE.finditer(text)]


def _same(printed: str, shown: str) -> None:
    """Words are equal, numbers within 2e-3 or 2 %, for another machine's rounding."""
    assert _NUMBER.sub("#", printed) == _NUMBER.sub("#", shown)
    numbers = [float(number) for number in _NUMBER.findall(shown)]
    found = [float(number) for number in _NUMBER.findall(printed)]
    assert found == pytest.approx(numbers, abs=2e-3, rel=0.02)


def test_the_navigation_has_every_page_once() -> None:
    listed = [page for pages in NAVIGATION.values() for page in pages]
    assert len(listed) == len(set(listed))
    found = {
        path.relative_to(DOCS).with_suffix("").as_posix()
        for suffix in ("md", "ipynb")
        for path in DOCS.rglob(f"*.{suffix}")
    }
    assert found == {"index", *listed}


@pytest.mark.parametrize("page", CHECKED, ids=lambda path: path.stem)
def test_python_of_a_page_prints_what_is_shown(page: Path) -> None:
    names: dict[str, object] = {"__name__": "page"}
    for fence in fences(page):
        if fence.language != "python" or fence.mark == "from":
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(fence.text, page.name, "exec"), names)  # one program per page
        if fence.output is not None or printed.getvalue():
            _same(printed.getvalue(), fence.output or "")


@pytest.mark.parametrize("page", CHECKED, ids=lambda path: path.stem)
def test_excerpts_stand_in_the_file_that_they_name(page: Path) -> None:
    for fence in fences(page):
        if fence.mark == "from":
            source = (ROOT / fence.value).read_text(encoding="utf-8")
            deeper = [textwrap.indent(fence.text, " " * n) for n in (0, 4, 8)]
            assert any(text in source for text in deeper), fence.text


@pytest.mark.parametrize("page", CHECKED, ids=lambda path: path.stem)
def test_commands_are_run_by_a_test_or_marked(page: Path) -> None:
    for fence in fences(page):
        if fence.language in ("", "text", "python"):
            continue
        assert fence.language == "bash", f"{page.name}: nothing checks {fence.language}"
        if fence.mark == "needs":
            assert fence.value in ("ROS", "hardware")
            continue
        for line in fence.text.splitlines():
            assert RUN_ELSEWHERE.fullmatch(line.partition("  #")[0].strip()), line


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_are_stored_without_outputs(path: Path) -> None:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert code and notebook["nbformat"] == 4
    for cell in code:
        assert cell["outputs"] == [] and cell["execution_count"] is None
        compile("".join(cell["source"]), path.name, "exec")


def test_every_public_name_is_in_the_reference() -> None:
    import ghc_controller
    import ghc_mpc_constraints
    import ghc_sim_bridge

    for page, module in (
        ("controller", ghc_controller),
        ("bridge", ghc_sim_bridge),
        ("previews", ghc_mpc_constraints),
    ):
        text = (DOCS / "api" / f"{page}.md").read_text(encoding="utf-8")
        # What comes from deeper modules is listed below their names.
        parts = re.split(r"^\.\. currentmodule:: ([\w.]+)$", text, flags=re.MULTILINE)
        listed = [
            name
            for current, part in zip(parts[1::2], parts[2::2], strict=True)
            if current == module.__name__
            for name in re.findall(r"^\.\. auto\w+:: (\w+)$", part, re.MULTILINE)
        ]
        assert sorted(listed) == sorted(set(module.__all__) - {"__version__"})


def test_docstrings_become_text_that_sphinx_reads() -> None:
    plain = [
        "Least |x|² of `a|b`,",
        "    x = J^+ b",
        "done.",
        "",
        "Args:",
        "    q, v: of all",
        "    joints.",
    ]
    assert converted(plain) == [
        "Least \\|x\\|² of `a|b`,",
        *("", "::", "", "    x = J^+ b", "", "done.", ""),
        *("Args:", "    q, v: of all", "        joints."),
    ]
    assert converted(["```yaml", "a: |b", "```"]) == [
        "",
        ".. code-block:: yaml",
        "",
        "   a: |b",
        "",
    ]


def test_fields_of_classes_are_described_by_what_stands_beside_them() -> None:
    import ghc_controller as ghc

    state = described(ghc.RobotState)
    assert "    time: [s]" in state and "    q: (nq,) [rad]" in state
    assert any(
        line.startswith("    wrenches: ") and "of the environment" in line for line in state
    )
    assert "    control_dt: [s] control period; default `0.001`" in described(ghc.Settings)
    assert described(ghc.Controller) == []


def test_every_message_of_the_troubleshooting_page_stands_in_the_source() -> None:
    text = (DOCS / "troubleshooting.md").read_text(encoding="utf-8")
    messages = re.findall(r"^\| `([^`]+)` \|", text, re.MULTILINE)
    assert len(messages) > 50
    sources = [re.sub(r"\s+", " ", message) for message in source_messages()]
    for message in messages:
        # What comes after a last value may be left out.
        words = message.removesuffix(VALUE).rstrip(" ")
        assert any(words in source for source in sources), message

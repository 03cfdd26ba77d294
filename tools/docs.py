"""Build the site: `make docs`. Sphinx reads docs/ and writes build/site; a warning is an error.

Sphinx has an environment of its own (.venv/docs, installed from its lock when it is first needed).
It sees the packages of .venv behind its own ones: nothing of it gets into what the stack runs on.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from tools.workspace.environment import step_environment, uv_settings
from tools.workspace.errors import SetupError
from tools.workspace.layout import Layout, Way
from tools.workspace.run import Runner
from tools.workspace.stamps import Stamp, key_of


def make_environment(layout: Layout, run: Runner) -> None:
    """Make .venv/docs unless it is there for the present lock; SetupError when that fails."""
    lock = layout.docs_lock(sys.version_info[:2])
    stamp = Stamp(layout.docs_venv / ".ghc_docs")
    key = key_of([lock], sys.version_info[:2], layout.root)
    python = layout.docs_venv / "bin" / "python"
    if stamp.is_done(key) and python.exists():
        return
    name = lock.relative_to(layout.root)
    print(f"set-up: installing {name} (for the site)", file=sys.stderr, flush=True)
    environment = step_environment(layout, Way.WHEELS, os.environ)
    venv = [sys.executable, "-m", "venv", "--clear", "--without-pip", str(layout.docs_venv)]
    run(venv, environment, "the environment of the site could not be made")
    pip_config = run.output([sys.executable, "-m", "pip", "config", "list"], environment)
    run(
        [str(layout.venv / "bin" / "uv"), "pip", "install", "--python", str(python)]
        + ["--require-hashes", "-r", str(lock)],
        {**environment, **uv_settings(pip_config, environment)},
        "the packages of the site could not be installed",
    )
    (packages,) = layout.docs_venv.glob("lib/python3*/site-packages")
    behind = [str(path) for path in layout.venv.glob("lib/python3*/site-packages")]
    code = "".join(f"import site; site.addsitedir({path!r})\n" for path in behind)
    (packages / "behind.pth").write_text(code, encoding="utf-8")
    _write_kernel(layout)
    stamp.done(key)


def _write_kernel(layout: Layout) -> None:
    """The kernel of notebooks as ipykernel installs it, without its warning about plain TCP."""
    python = str(layout.docs_venv / "bin" / "python")
    command = [python, "-m", "ipykernel_launcher", "--log-level=ERROR", "-f", "{connection_file}"]
    folder = layout.docs_venv / "share" / "jupyter" / "kernels" / "python3"
    folder.mkdir(parents=True, exist_ok=True)
    kernel = {"argv": command, "display_name": "Python 3", "language": "python"}
    (folder / "kernel.json").write_text(json.dumps(kernel), encoding="utf-8")


def build(layout: Layout, run: Runner) -> None:
    """Write the site anew; SetupError with the number of Sphinx when it has a warning."""
    sources = [str(package) for package in layout.python_packages()]
    inherited = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    environment = {
        **{name: value for name, value in os.environ.items() if name != "MPLBACKEND"},
        "VIRTUAL_ENV": str(layout.docs_venv),
        "PATH": os.pathsep.join([str(layout.docs_venv / "bin"), os.environ.get("PATH", "")]),
        "PYTHONPATH": os.pathsep.join(filter(None, [*sources, *inherited])),
    }
    run(
        [str(layout.docs_venv / "bin" / "python"), "-m", "sphinx", "--fail-on-warning"]
        + ["--quiet", "--fresh-env", "--conf-dir", "docs/site"]
        + ["--doctree-dir", str(layout.build / "docs"), "docs", str(layout.site)],
        environment,
        "the site was not built",
    )


def main() -> int:
    """Build the site and print where it is; 0 when it had no warning."""
    layout = Layout(Path(__file__).resolve().parents[1])
    run = Runner(layout.root)
    try:
        make_environment(layout, run)
        build(layout, run)
    except SetupError as error:
        print(f"docs: {error}", file=sys.stderr)
        return 1
    print(f"site: {(layout.site / 'index.html').as_uri()}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

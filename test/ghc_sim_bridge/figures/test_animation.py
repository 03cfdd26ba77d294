"""`picture`: an animation of a run made up here, or one clear line where it cannot be drawn."""

from __future__ import annotations

import ctypes.util
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageChops, ImageSequence

from ghc_sim_bridge.figures.animation import ARM_SIZE
from ghc_sim_bridge.programs.picture import main
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

DT = 1e-2  # [s] of the log
SCENARIO = "insertion_removal"  # 28 s
ARGUMENTS = ["--scenario", SCENARIO, "--speed", "70", "--period", "0.1"]  # a picture every 7 s


def make_run(results: Path) -> None:
    """The log of a run in which every joint turns slowly."""
    plan = make_plan(load_scenario(SCENARIO), RunOptions(), results)
    time = np.arange(round(plan.duration / DT)) * DT
    q = 0.1 + 0.03 * time[:, None] * np.ones(7)
    plan.folder.mkdir(parents=True)
    np.savez(
        plan.folder / "log.npz",
        time=time,
        q=q,
        **{name: np.zeros_like(q) for name in ("v", "acceleration", "torque", "commanded")},
        source=np.zeros(len(time), np.uint8),
        epoch=np.zeros(len(time), np.uint32),
        cycle_time=np.full(len(time), 1e-3),
        joint_names=np.array([f"joint_{k}" for k in range(1, 8)]),
        control_dt=DT,
    )


def test_a_run_becomes_a_moving_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_run(tmp_path)
    file = tmp_path / "new" / "run.gif"
    code = main([*ARGUMENTS, "--results", str(tmp_path), "--to", str(file)])
    printed = capsys.readouterr()
    if code == 2:  # a machine without OpenGL
        assert "libegl1" in printed.err and printed.err.count("\n") == 1
        return
    assert code == 0 and printed.out.startswith(f"{file}: 4 pictures")
    shown = []
    with Image.open(file) as image:
        assert image.info["loop"] == 0
        for picture in ImageSequence.Iterator(image):
            assert picture.info["duration"] == 100
            shown.append(picture.convert("RGB"))
    assert len(shown) == 4
    for earlier, later in pairwise(shown):
        assert ImageChops.difference(earlier, later).getbbox() is not None


def test_the_robot_alone_is_a_smaller_picture(tmp_path: Path) -> None:
    make_run(tmp_path)
    file = tmp_path / "robot.gif"
    code = main([*ARGUMENTS, "--robot-only", "--results", str(tmp_path), "--to", str(file)])
    if code == 2:  # a machine without OpenGL
        return
    with Image.open(file) as image:
        assert image.size == ARM_SIZE
        assert len(list(ImageSequence.Iterator(image))) == 4


def test_without_opengl_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    make_run(tmp_path)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(ctypes.util, "find_library", lambda _: None)
    assert main([*ARGUMENTS, "--results", str(tmp_path), "--to", str(tmp_path / "a.gif")]) == 2
    printed = capsys.readouterr()
    assert printed.err.startswith("picture: no off-screen OpenGL") and printed.out == ""


def test_a_run_that_is_not_there_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*ARGUMENTS, "--results", str(tmp_path), "--to", str(tmp_path / "a.gif")]) == 2
    error = capsys.readouterr().err
    assert error.startswith("picture: full-rate log") and error.count("\n") == 1
    with pytest.raises(SystemExit) as refused:
        main([*ARGUMENTS, "--to", "a.gif", "--speed", "0"])
    assert refused.value.code == 2

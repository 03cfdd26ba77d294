"""What the set-up says when something is missing, and what it hands to the commands it runs."""

from __future__ import annotations

from dataclasses import replace

import pytest
from setup_doubles import GOOD, FakeMachine

from tools.workspace import __main__ as program
from tools.workspace import checks
from tools.workspace.environment import step_environment, uv_settings
from tools.workspace.errors import SetupError
from tools.workspace.layout import Layout, Way
from tools.workspace.machine import Interpreter
from tools.workspace.step import Context


@pytest.mark.parametrize(
    ("machine", "words"),
    [
        (FakeMachine([]), ["Python 3.11 or 3.12", "found: none", "apt install python3"]),
        (FakeMachine([replace(GOOD, path="python3", version=(3, 13, 0))]), ["Python 3.13.0"]),
        (FakeMachine([replace(GOOD, venv=False)]), ["apt install python3.12-venv"]),
        (FakeMachine([replace(GOOD, headers=False)]), ["apt install python3.12-dev"]),
        (FakeMachine(compiler=None), ["no C++ compiler", "apt install g++"]),
        (FakeMachine(free=1.2e9), ["2.5 GB", "1.2 GB are free"]),
    ],
)
def test_what_is_missing_is_said_with_the_way_to_get_it(
    context: Context, machine: FakeMachine, words: list[str]
) -> None:
    with pytest.raises(SetupError) as caught:
        program.set_up(replace(context, machine=machine))
    message = str(caught.value)
    assert [word for word in words if word not in message] == []
    assert "\n" not in message


def test_a_python_that_lacks_nothing_is_preferred() -> None:
    bare = replace(GOOD, venv=False)
    full = Interpreter("python3.11", (3, 11, 2))
    assert checks.choose_interpreter(FakeMachine([bare, full]), Way.WHEELS, None) == full
    with pytest.raises(SetupError, match=r"python3\.12-venv"):
        checks.choose_interpreter(FakeMachine([bare, full]), Way.WHEELS, "python3.12")


@pytest.mark.parametrize(
    ("machine", "words"),
    [
        (FakeMachine(architecture="Linux aarch64"), ["Linux aarch64", "docker"]),
        (FakeMachine(distribution="humble"), ["humble", "jazzy"]),
    ],
)
def test_a_machine_that_wheels_do_not_fit_is_told_so(
    machine: FakeMachine, words: list[str]
) -> None:
    with pytest.raises(SetupError) as caught:
        checks.choose_way(machine)
    assert [word for word in words if word not in str(caught.value)] == []


def test_another_environments_libraries_do_not_leak(layout: Layout) -> None:
    caller = {
        "PATH": "/usr/bin",
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
        "LD_LIBRARY_PATH": "/elsewhere/.venv/lib",
        "PYTHONPATH": "/elsewhere",
        "PYTHONDONTWRITEBYTECODE": "1",
        "HTTPS_PROXY": "kept",
    }
    assert step_environment(layout, Way.WHEELS, caller) == {
        "PATH": f"{layout.venv}/bin:/usr/bin",
        "VIRTUAL_ENV": str(layout.venv),
        "AMENT_PREFIX_PATH": str(layout.venv),
        "CMAKE_PREFIX_PATH": str(layout.venv),
        "HTTPS_PROXY": "kept",
    }
    sourced = step_environment(layout, Way.SYSTEM, caller)
    assert sourced["LD_LIBRARY_PATH"] == caller["LD_LIBRARY_PATH"]
    assert sourced["PYTHONPATH"] == caller["PYTHONPATH"]


def test_the_index_of_pip_is_the_index_of_uv() -> None:
    config = "global.index-url='https://mirror.example/simple'\n:env:.cert='/ca.pem'\nno line\n"
    settings = uv_settings(config, {"UV_DEFAULT_INDEX": "own"})
    assert settings["SSL_CERT_FILE"] == "/ca.pem"
    assert "UV_DEFAULT_INDEX" not in settings
    assert uv_settings(config, {})["UV_DEFAULT_INDEX"] == "https://mirror.example/simple"

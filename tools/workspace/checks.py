"""What the set-up needs, and the one line that says what is missing and how to get it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tools.workspace.errors import SetupError
from tools.workspace.layout import Way
from tools.workspace.machine import Interpreter, Machine

SUPPORTED = ((3, 12), (3, 11))
ROOM = 2.5e9  # [bytes] of .venv, build/ and install/ together; measured, rounded up
_VERSIONS = "Python 3.11 or 3.12"


def choose_way(machine: Machine) -> Way:
    """Wheels, unless a ROS 2 Jazzy is sourced."""
    distribution = machine.ros_distribution()
    if distribution == "jazzy":
        return Way.SYSTEM
    if distribution:
        raise SetupError(
            f"ROS 2 '{distribution}' is sourced in this shell, but the stack is made for 'jazzy': "
            "source that one, or start from a shell that has none (then Jazzy comes as wheels)"
        )
    if machine.architecture() != "Linux x86_64":
        raise SetupError(
            f"there are no ROS 2 wheels for {machine.architecture()}, only for Linux x86_64: "
            "use docker/ (see docker/README.md) or source a ROS 2 Jazzy installation first"
        )
    return Way.WHEELS


def choose_interpreter(machine: Machine, way: Way, asked: str | None) -> Interpreter:
    """The Python that the virtual environment is made from: the first that has all it takes."""
    if asked:
        commands: tuple[str, ...] = (asked,)
    elif way is Way.SYSTEM:
        commands = ("/usr/bin/python3", "python3")  # the one that the installation's rclpy is for
    else:
        commands = ("python3.12", "python3.11", "python3", "/usr/bin/python3")
    found = [machine.interpreter(command) for command in commands]
    interpreters = [interpreter for interpreter in found if interpreter]
    problems = []
    for interpreter in interpreters:
        problem = problem_of(interpreter)
        if problem is None:
            return interpreter
        if interpreter.version[:2] in SUPPORTED:
            problems.append(problem)
    if problems:
        raise SetupError(problems[0])
    tried = dict.fromkeys(interpreter.name for interpreter in interpreters)
    raise SetupError(
        f"{_VERSIONS} is needed; found: {', '.join(tried) or 'none'}. On Debian 12 or Ubuntu "
        "24.04: `sudo apt install python3 python3-venv python3-dev`; or name one: `make setup "
        "PYTHON=path/of/python`"
    )


def problem_of(interpreter: Interpreter) -> str | None:
    """What keeps an interpreter from being used; None when nothing does."""
    short = f"python{interpreter.version[0]}.{interpreter.version[1]}"
    if interpreter.version[:2] not in SUPPORTED or interpreter.implementation != "CPython":
        return f"{interpreter.name} is not CPython 3.11 or 3.12"
    if not interpreter.venv:
        return (
            f"{interpreter.name} cannot make a virtual environment (no venv or ensurepip): "
            f"`sudo apt install {short}-venv`"
        )
    if not interpreter.headers:
        return (
            f"{interpreter.name} has no C headers, which the messages are built against: "
            f"`sudo apt install {short}-dev`"
        )
    return None


def check_compiler(machine: Machine) -> None:
    """A C++ compiler, for the messages."""
    if machine.compiler() is None:
        raise SetupError(
            "no C++ compiler (looked for $CXX, c++, g++, clang++), which the messages are built "
            "with: `sudo apt install g++`"
        )


def check_room(machine: Machine, folder: Path) -> None:
    """Room for the packages and what is built."""
    free = machine.free_bytes(folder)
    if free < ROOM:
        raise SetupError(
            f"no room: the packages need about {ROOM / 1e9:.1f} GB, and {free / 1e9:.1f} GB are "
            f"free in {folder}"
        )


def check_sources(files: Iterable[Path]) -> None:
    """Files of the repository that the set-up reads."""
    for path in files:
        if not path.is_file():
            raise SetupError(f"{path} is missing: the clone is not complete")

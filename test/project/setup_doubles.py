"""Stand-ins of the set-up's tests: a machine with chosen properties, commands that do nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from tools.workspace.layout import Layout
from tools.workspace.machine import Interpreter, Machine
from tools.workspace.run import Runner

GOOD = Interpreter("python3.12", (3, 12, 3))


class FakeMachine(Machine):
    """A machine with chosen properties."""

    def __init__(
        self,
        interpreters: Sequence[Interpreter] = (GOOD,),
        compiler: str | None = "g++",
        free: float = 100e9,
        architecture: str = "Linux x86_64",
        distribution: str = "",
    ) -> None:
        self.interpreters = {interpreter.path: interpreter for interpreter in interpreters}
        self._compiler = compiler
        self._free = free
        self._architecture = architecture
        self._distribution = distribution

    def interpreter(self, command: str) -> Interpreter | None:
        return self.interpreters.get(command)

    def compiler(self) -> str | None:
        return self._compiler

    def free_bytes(self, folder: Path) -> int:
        return int(self._free)

    def architecture(self) -> str:
        return self._architecture

    def ros_distribution(self) -> str:
        return self._distribution


class FakeRunner(Runner):
    """Notes the commands; makes the files that the real ones would make."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.commands: list[str] = []
        self.failing = ""  # a command that holds this word is interrupted

    def __call__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        complaint: str,
        log: Path | None = None,
    ) -> None:
        text = " ".join(command)
        self.commands.append(text)
        if self.failing and self.failing in text:
            raise KeyboardInterrupt
        if " -m venv" in text:
            touch(self.layout.python, mode=0o755)
            touch(self.layout.venv / "pyvenv.cfg", "version = 3.12.3\n")
            touch(self.layout.venv / "bin" / "colcon", mode=0o755)
        elif " -m pip install" in text:
            touch(self.layout.venv / "bin" / "uv", mode=0o755)
        elif "colcon build" in text and "ghc_msgs" in command:
            share = self.layout.install / "ghc_msgs" / "share"
            touch(share / "ament_index" / "resource_index" / "packages" / "ghc_msgs")
            touch(share / "ghc_msgs" / "package.sh")
        elif "colcon build" in text:
            touch(self.layout.install / "setup.bash")
            touch(self.layout.install / "pure" / "lib" / "pure" / "node")
            (self.layout.build / "pure").mkdir(parents=True, exist_ok=True)

    def succeeds(self, command: Sequence[str], environment: Mapping[str, str]) -> bool:
        return True

    def output(self, command: Sequence[str], environment: Mapping[str, str]) -> str:
        return ""

    def kinds(self) -> list[str]:
        """What ran since the last question, in short and in the order of the steps."""
        words = {
            " -m venv": "venv",
            "pip install --require-hashes": "packages",
            "ghc_msgs": "messages",
            "build_core.py": "core",
            "pure": "python",
        }
        result = [kind for word, kind in words.items() for text in self.commands if word in text]
        self.commands.clear()
        return result


def touch(path: Path, text: str = "", mode: int = 0o644) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    path.chmod(mode)

"""One registry: names of code and of entry points, and what happens to those that fail."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.constraints import Constraint, TorqueLimit
from ghc_controller.contacts.contact import Contact
from ghc_controller.contacts.registry import CONTACTS, make_contact
from ghc_controller.errors import ConfigurationError, InvalidValue, PluginError, UnknownName
from ghc_controller.registry import Registry
from ghc_controller.schema.plugged_files import plugged_file
from ghc_controller.schema.reader import Fields
from ghc_controller.settings import CONSTRAINTS, make_constraints
from ghc_controller.tasks import TASKS, make_task

GROUP = "ghc_test.shapes"


class Shape:
    """What the registry of these tests holds."""


class Square(Shape):
    """Registered in code."""


def registry() -> Registry[type[Shape]]:
    shapes: Registry[type[Shape]] = Registry("shape", GROUP, base=Shape)
    shapes.register("square")(Square)
    return shapes


def bring(folder: Path, package: str, entries: dict[str, str], group: str = GROUP) -> None:
    """A package of that name with entry points, as pip leaves one."""
    info = folder / f"{package}-2.1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 2.1\n")
    lines = [f"[{group}]", *(f"{name} = {value}" for name, value in entries.items())]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder on the path of imports, with a module of two classes, one of them a shape."""
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "brought_shapes.py").write_text(
        "from test_registry import Shape\nclass Circle(Shape): ...\nclass Stone: ...\n"
    )
    monkeypatch.delitem(sys.modules, "brought_shapes", raising=False)
    return tmp_path


def test_names_of_code_and_of_packages(folder: Path) -> None:
    bring(folder, "round", {"circle": "brought_shapes:Circle"})
    shapes = registry()
    assert list(shapes) == ["circle", "square"]
    assert len(shapes) == 2
    assert "circle" in shapes
    assert shapes.built_in == ("square",)
    assert "brought_shapes" not in sys.modules  # names do not import
    assert shapes["circle"].__name__ == "Circle"
    assert shapes["square"] is Square
    with pytest.raises(UnknownName, match=r"^unknown shape 'line'; known: circle, square$"):
        shapes["line"]


def test_names_of_code_read_no_entry_points(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shapes = registry()
    with monkeypatch.context() as patch:
        patch.setattr("importlib.metadata.entry_points", lambda **_: pytest.fail("they were read"))
        assert "square" in shapes
        assert shapes["square"] is Square


def test_a_package_that_fails_is_named_and_leaves_the_others(folder: Path) -> None:
    bring(folder, "broken", {"line": "no_such_module:Line", "stone": "brought_shapes:Stone"})
    bring(folder, "round", {"circle": "brought_shapes:Circle"})
    shapes = registry()
    for name, value, why in (
        ("line", "no_such_module:Line", "cannot be loaded: ModuleNotFoundError: No module named"),
        ("stone", "brought_shapes:Stone", ": .*Stone.* given, a subclass of Shape expected"),
    ):
        where = rf"^shape '{name}' of package broken 2.1 \(entry point {GROUP}: {name} = {value}\)"
        with pytest.raises(PluginError, match=f"{where}.*{why}"):
            shapes[name]
    assert set(shapes.usable()) == {"circle", "square"}


def test_two_packages_with_one_name_are_refused_with_both(folder: Path) -> None:
    bring(folder, "round", {"circle": "brought_shapes:Circle"})
    bring(folder, "rounder", {"circle": "brought_shapes:Circle"})
    with pytest.raises(PluginError, match=r"'circle' is brought twice: by .*round.* by .*rounder"):
        registry()["circle"]


def test_a_name_of_code_stays_that_of_code(folder: Path) -> None:
    bring(folder, "round", {"square": "brought_shapes:Circle"})
    shapes = registry()
    with pytest.warns(UserWarning, match=r"'square' of package round 2.1 .* taken by .*Square"):
        assert list(shapes) == ["square"]
    assert shapes["square"] is Square


def test_code_cannot_take_a_name_twice() -> None:
    shapes = registry()
    shapes.register("square")(Square)  # the same once more, as a cell of a notebook does
    with pytest.raises(InvalidValue, match=r"'square' is registered twice: by .*Square and by"):

        @shapes.register("square")
        class Other(Shape):
            """Another one."""

    with pytest.raises(InvalidValue, match="a subclass of Shape expected"):
        shapes.register("three")(3)


def test_files_of_robots_scenes_and_scenarios(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text("name: arm\n")
    package = ModuleType("arm")
    package.__path__ = [str(tmp_path / "absent"), str(tmp_path)]
    for given in (file, str(tmp_path), package, lambda: tmp_path):
        assert plugged_file(given, "robot.yaml") == file
    with pytest.raises(PluginError, match=r"'.*scene.yaml' does not exist"):
        plugged_file(package, "scene.yaml")
    with pytest.raises(PluginError, match="<module 'arm'> given: a package, a path"):
        plugged_file(ModuleType("arm"), "robot.yaml")

    def failing() -> Path:
        raise OSError("no space")

    with pytest.raises(PluginError, match=r"failing failed: OSError: no space"):
        plugged_file(failing, "robot.yaml")


def test_robots_of_packages(folder: Path) -> None:
    """In a process of its own: registries of this one have read their entry points."""
    bring(folder, "arms", {"lost_arm": "brought_shapes"}, "ghc_controller.robots")
    code = (
        "import ghc_controller as ghc\n"
        "assert 'lost_arm' in ghc.list_robots()\n"
        "try: ghc.load_robot('lost_arm')\n"
        "except ghc.GhcError as error: print(error)\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env={"PYTHONPATH": ":".join([str(folder), str(Path(__file__).parent), *sys.path])},
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.startswith("robot 'lost_arm': <module 'brought_shapes'")


def test_a_kind_that_fails_is_told_with_its_field(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bring(folder, "broken", {"spiral": "no_such_module:Spiral"}, TASKS.group)
    monkeypatch.setattr(TASKS, "_plugins", None)
    model = ghc.load_robot("kuka_lwr").model
    with pytest.raises(ConfigurationError, match=r"^robot.yaml: kind: task kind 'spiral' of pack"):
        make_task(Fields({"name": "a", "kind": "spiral"}, "robot.yaml"), model)
    with pytest.raises(ConfigurationError, match=r"'helix' given; known: .*posture, .*spiral"):
        make_task(Fields({"name": "a", "kind": "helix"}, "robot.yaml"), model)


def test_contact_kinds_are_chosen_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CONTACTS, "_registered", dict(CONTACTS._registered))

    @CONTACTS.register("smooth")
    class Smooth(Contact):
        """Whose force is along the normal, whatever the friction."""

        @property
        def force_axes(self) -> np.ndarray:
            return self.axes[2:]

    model = ghc.load_robot("kuka_lwr").model
    entry = {"name": "tip", "frame": "tool", "points": [[0, 0, 0]], "normal": [0, 0, 1]}
    assert type(make_contact(Fields(entry, "robot.yaml"), model)) is Contact
    smooth = make_contact(Fields(entry | {"kind": "smooth"}, "robot.yaml"), model)
    assert type(smooth) is Smooth
    assert smooth.motion_rows == 1
    known = "point, rigid, rolling, sliding, smooth, surface"
    with pytest.raises(ConfigurationError, match=f"'rough' given; known: {known}"):
        make_contact(Fields(entry | {"kind": "rough"}, "robot.yaml"), model)


def test_a_further_constraint_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is merged with those that every robot has, and only where the settings name it."""
    monkeypatch.setattr(CONSTRAINTS, "_registered", dict(CONSTRAINTS._registered))

    @ghc.register_constraint("half_torque")
    def half_torque(robot: ghc.Robot, settings: ghc.Settings) -> Constraint:
        return TorqueLimit(0.5 * robot.model.limits.torque, robot.model.na, name="half_torque")

    robot = ghc.load_robot("kuka_lwr")
    names = [c.name for c in make_constraints(robot, ghc.Settings()).constraints]
    further = make_constraints(robot, ghc.Settings(constraints=("half_torque",))).constraints
    assert "half_torque" not in names
    assert [c.name for c in further] == [*names, "half_torque"]
    with pytest.raises(UnknownName, match=r"unknown constraint 'wall'; known: .*, half_torque, "):
        make_constraints(robot, ghc.Settings(constraints=("wall",)))


def test_importing_the_package_reads_no_entry_points() -> None:
    """It imports none of its modules, let alone those of others."""
    code = (
        "import sys, ghc_controller\n"
        "print([name for name in sys.modules if name.startswith('ghc_controller.')])\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stdout == "[]\n", run.stderr

"""Public names, fields, parameters and executables of earlier versions -> what they are now.

Used by the face of the package (`__getattr__`), by the reader of files and by that of parameters.
Who renames one of these adds a row; `python docs/migration_tables.py` writes docs/migration.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Kind(Enum):
    """What a name is of."""

    NAME = "public name"  # of ghc_controller
    METHOD = "method"  # of a class that other packages derive from or call
    FIELD = "field or parameter"  # of a file, a node, Settings
    SCENE = "field of a scene"
    EXECUTABLE = "executable"  # package and executable


@dataclass(frozen=True, slots=True)
class Renamed:
    """One name that was changed."""

    kind: Kind
    old: str
    new: str

    @property
    def hint(self) -> str:
        """Message for users of the old name."""
        return f"it is '{self.new}' now"


RENAMED: tuple[Renamed, ...] = (
    Renamed(Kind.NAME, "ControllerSettings", "Settings"),
    Renamed(Kind.NAME, "RobotConfig", "Robot"),
    Renamed(Kind.METHOD, "Task.write_rows", "Task.measure"),
    Renamed(Kind.METHOD, "Task.fill", "Task.measure"),
    Renamed(Kind.METHOD, "Task.rows", "Task.measured"),
    Renamed(Kind.METHOD, "Task.empty_rows", "TaskRows.zeros"),
    Renamed(Kind.METHOD, "Task.reset", "TaskStack.reset"),
    Renamed(Kind.METHOD, "Controller.warm_up", "Controller.start"),
    Renamed(Kind.FIELD, "solver", "qp_solver"),
    Renamed(Kind.SCENE, "contacts.frame", "contacts.frame of robot.yaml"),
    Renamed(Kind.SCENE, "contacts.points", "contacts.points of robot.yaml"),
    Renamed(Kind.EXECUTABLE, "ghc_mpc_constraints studies", "ghc_sim_bridge studies"),
)
_BY_OLD_NAME = {(row.kind, row.old): row for row in RENAMED}


def hint(kind: Kind, name: str) -> str:
    """What to say of a name that does not exist; empty if it never did."""
    row = _BY_OLD_NAME.get((kind, name))
    return "" if row is None else row.hint

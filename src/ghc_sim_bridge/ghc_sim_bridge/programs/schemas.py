"""Writes JSON schemas of robot.yaml, scene and scenario files, for editors.

    python -m ghc_sim_bridge.programs.schemas [FOLDER]

They are generated from the declarations of the readers, including task kinds of other installed
packages. A file refers to its schema in its first line:

    # yaml-language-server: $schema=path/to/robot.schema.json
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ghc_controller.robot.fields import RobotFields
from ghc_controller.schema.json_schema import JsonSchema, SchemaWriter
from ghc_controller.settings import Settings
from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.node_sections import CHECKED
from ghc_sim_bridge.scene.values import SceneFields

FOLDER = "schemas"
NODES: Mapping[str, type] = {
    **CHECKED,
    "settings": Settings,
}


def schemas() -> dict[str, JsonSchema]:
    """File name -> schema."""
    return {
        "robot.schema.json": SchemaWriter(NODES).document(RobotFields, "robot.yaml"),
        "scene.schema.json": SchemaWriter(NODES).document(SceneFields, "A scene"),
        "scenario.schema.json": SchemaWriter(NODES).document(
            Scenario, "A scenario", _with_variants
        ),
    }


def _with_variants(scenario: JsonSchema) -> JsonSchema:
    """A variant changes or removes (null) fields of the file: none of its fields is required."""
    fields: dict[str, Any] = scenario["properties"]
    variant = {
        "type": "object",
        "properties": {
            name: {
                "description": field["description"],
                "anyOf": [{"$ref": f"#/properties/{name}"}, {"type": "null"}],
            }
            for name, field in fields.items()
        },
        "additionalProperties": False,
    }
    variants = {
        "description": "name: changes of fields above, null = without; the first is the default",
        "type": "object",
        "additionalProperties": {"$ref": "#/definitions/variant"},
    }
    del fields["phases"]["minItems"]  # may be empty if all variants have their own
    changed = {name: value for name, value in scenario.items() if name != "required"}
    changed["properties"] = fields | {"variants": variants}
    changed["anyOf"] = [{"required": scenario["required"]}, {"required": ["variants"]}]
    return changed | {"definitions": {"variant": variant}}


def write(folder: Path) -> tuple[Path, ...]:
    """Write all schemas into a folder, created if needed; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, schema in schemas().items():
        path = folder / name
        text = json.dumps(schema, indent=1, ensure_ascii=False, allow_nan=False)
        path.write_text(text + "\n", encoding="utf-8")
        paths.append(path)
    return tuple(paths)


def main(args: Sequence[str] | None = None) -> int:
    """Write the schemas and print where they are."""
    parser = argparse.ArgumentParser(description="JSON schemas of YAML files, for editors")
    parser.add_argument("folder", nargs="?", default=FOLDER, type=Path)
    for path in write(parser.parse_args(args).folder):
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())

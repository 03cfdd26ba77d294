"""JSON Schema of declared dataclasses, for editors: names, types, ranges, units and texts.

What only a model or another field can tell, such as the frames of a URDF or the rows of a task,
is left to the reader.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, is_dataclass
from enum import Enum
from typing import Any, get_args, get_origin

from ghc_controller.schema.declared import Entry, flat
from ghc_controller.schema.domains import Domain
from ghc_controller.schema.record import kinds_of

DIALECT = "http://json-schema.org/draft-07/schema#"
_PLAIN = {bool: "boolean", float: "number", int: "integer", str: "string"}

JsonSchema = dict[str, Any]


class SchemaWriter:
    """Writes schemas; every dataclass becomes one definition.

    Args:
        nodes: node -> dataclass of its parameters, for files that set them.
    """

    def __init__(self, nodes: Mapping[str, type] | None = None) -> None:
        self._nodes = nodes or {}
        self._definitions: dict[str, JsonSchema] = {}
        self._records: dict[str, type] = {}

    def document(
        self,
        kind: type,
        title: str,
        change: Callable[[JsonSchema], JsonSchema] = lambda schema: schema,
    ) -> JsonSchema:
        """The schema of a file that holds one record; `change` has the last word on it."""
        schema = change(self.fields(kind))
        definitions = self._definitions | schema.pop("definitions", {})
        written = {"definitions": dict(sorted(definitions.items()))}
        return {"$schema": DIALECT, "title": title} | schema | written

    def record(self, kind: type) -> JsonSchema:
        """Reference to the definition of a dataclass, which is written at the first use."""
        name = kind.__name__
        if name not in self._definitions:
            self._records[name] = kind
            self._definitions[name] = self.fields(kind)
        assert self._records[name] is kind, f"two dataclasses are called {name}"
        return {"$ref": f"#/definitions/{name}"}

    def fields(self, kind: type) -> JsonSchema:
        """An object with the declared fields of a dataclass and no other."""
        found = tuple(flat(kind))
        required = [entry.name for entry in found if entry.required]
        summary = (kind.__doc__ or "").strip().split("\n")[0]
        schema: JsonSchema = {"type": "object", "description": summary}
        schema["properties"] = {entry.name: self._field(entry) for entry in found}
        schema["additionalProperties"] = False
        return schema | ({"required": required} if required else {})

    def mapping(self, values: JsonSchema) -> JsonSchema:
        """An object of free names."""
        return {"type": "object", "additionalProperties": values}

    def rows_of(self, domain: Domain) -> JsonSchema:
        """A matrix, as a list of rows."""
        row = {"type": "array", "items": {"type": "number"} | domain.schema()}
        return {"type": "array", "items": row}

    def by_name(self, names: Iterable[str], values: JsonSchema) -> JsonSchema:
        """An object with some of these names."""
        properties = dict.fromkeys(names, values)
        return {"type": "object", "properties": properties, "additionalProperties": False}

    def node_parameters(self, nodes: Iterable[str]) -> JsonSchema:
        """An object: node -> some of its parameters."""
        found = {name: self.parameters_of(name) for name in nodes}
        return {"type": "object", "properties": found, "additionalProperties": False}

    def one_of_kinds(self, key: str, kinds: Mapping[str, type], common: type) -> JsonSchema:
        """A record whose field `key` says which fields it has.

        A kind that declares no more than the `common` fields may have any others.
        """
        choices = []
        for kind, fields in kinds.items():
            schema = self.fields(fields)
            if fields is common:
                del schema["additionalProperties"]
            schema["properties"] = {key: {"const": kind}} | schema["properties"]
            schema["required"] = [key, *schema.get("required", ())]
            choices.append({"if": {"properties": {key: {"const": kind}}}, "then": schema})
        enumeration = {"type": "string", "enum": list(kinds)}
        return {
            "type": "object",
            "properties": {key: enumeration},
            "required": [key],
            "allOf": choices,
        }

    def parameters_of(self, node: str) -> JsonSchema:
        """Parameters of a node, none of them required: a run sets the others."""
        if node not in self._nodes:
            return {"type": "object"}
        name = f"parameters_of_{node}"
        if name not in self._definitions:
            schema = self.fields(self._nodes[node])
            schema.pop("required", None)
            self._definitions[name] = schema
        return {"$ref": f"#/definitions/{name}"}

    def _field(self, entry: Entry) -> JsonSchema:
        declaration = entry.declaration
        schema = dict(self._value(entry))
        if "$ref" in schema:  # draft 7 looks at nothing beside a reference
            schema = {"allOf": [schema]}
        schema = {"description": entry.meaning} | schema
        default = _as_json(entry.default)
        said = default not in (MISSING, None, "", [], {}) and declaration.schema is None
        if said and not (declaration.domain and declaration.domain.problem(entry.default)):
            schema["default"] = default
        return schema

    def _value(self, entry: Entry) -> JsonSchema:
        declaration = entry.declaration
        if declaration.schema is not None:
            return declaration.schema(self)
        kinds = kinds_of(entry.kind)
        if declaration.later is not None:
            item = self.record(declaration.later)
            return {"type": "array", "items": item} if get_origin(kinds[0]) is tuple else item
        if declaration.per_row:
            number = {"type": "number"} | _domain(entry)
            return {"anyOf": [number, {"type": "array", "items": number, "minItems": 1}]}
        if len(kinds) > 1:
            return {"anyOf": [self._kind(kind, entry) for kind in kinds]}
        return self._kind(kinds[0], entry)

    def _kind(self, kind: Any, entry: Entry) -> JsonSchema:
        if kind in _PLAIN:
            needed = {"minLength": 1} if kind is str and entry.required else {}
            return {"type": _PLAIN[kind], **needed, **_domain(entry)}
        if isinstance(kind, type) and issubclass(kind, Enum):
            return {"enum": [item.value for item in kind]}
        if is_dataclass(kind):
            return self.record(kind)  # type: ignore[arg-type]
        if get_origin(kind) is tuple:
            return self._list(get_args(kind), entry)
        values = get_args(kind)[1] if get_args(kind) else Any
        if values is float:
            return self.mapping({"type": "number"})
        return self.mapping(self.record(values)) if is_dataclass(values) else {"type": "object"}

    def _list(self, kinds: tuple[Any, ...], entry: Entry) -> JsonSchema:
        item, declaration = kinds[0], entry.declaration
        size = declaration.size or (None if kinds[-1] is Ellipsis else len(kinds))
        schema: JsonSchema = {"type": "array"}
        if item is str:
            schema |= {"items": {"type": "string"}, "uniqueItems": True} | _domain(entry)
        elif item is float:
            schema["items"] = {"type": "number"} | _domain(entry)
        elif get_origin(item) is tuple:
            schema["items"] = _numbers(len(get_args(item)))
        else:
            schema["items"] = self.record(item)
        if size is not None:
            return schema | {"minItems": size, "maxItems": size}
        return schema if declaration.empty else schema | {"minItems": 1}


def _domain(entry: Entry) -> JsonSchema:
    domain = entry.declaration.domain
    return {} if domain is None else domain.schema()


def _numbers(size: int) -> JsonSchema:
    return {"type": "array", "items": {"type": "number"}, "minItems": size, "maxItems": size}


def _as_json(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, tuple):
        return [_as_json(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None  # JSON has no infinity
    return None if is_dataclass(value) else value

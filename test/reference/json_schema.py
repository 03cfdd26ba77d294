"""The part of JSON Schema (draft 7) that the schemas of this project use, checked plainly."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

_TYPES: dict[str, tuple[type, ...]] = {
    "null": (type(None),),
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "boolean": (bool,),
    "number": (int, float),
    "integer": (int,),
}
_TEXTS = {"$schema", "title", "description", "default", "definitions"}
_LIMITS = {"minItems", "maxItems", "uniqueItems", "minLength", "minimum", "maximum"}
_PARTS = {"$ref", "properties", "required", "additionalProperties", "items", "allOf", "anyOf"}
_CHOICES = {"type", "enum", "const", "if", "then", "exclusiveMinimum"}
KEYWORDS = _TEXTS | _LIMITS | _PARTS | _CHOICES


def problems(value: Any, schema: dict[str, Any], root: dict[str, Any], at: str = "") -> list[str]:
    """What is wrong with a value, each with its place; empty if it is valid."""
    unknown = set(schema) - KEYWORDS
    assert not unknown, f"{at}: keywords that this check does not know: {unknown}"
    if "$ref" in schema:
        return problems(value, _target(schema["$ref"], root), root, at)
    found = list(_own(value, schema, at))
    for part in schema.get("allOf", ()):
        found += problems(value, part, root, at)
    forms = [problems(value, part, root, at) for part in schema.get("anyOf", ())]
    if forms and all(forms):
        found += [f"{at}: none of the forms fits", *(text for form in forms for text in form)]
    if "if" in schema and not problems(value, schema["if"], root, at):
        found += problems(value, schema["then"], root, at)
    if isinstance(value, dict):
        found += _fields(value, schema, root, at)
    if isinstance(value, list):
        for k, item in enumerate(value):
            found += problems(item, schema.get("items", {}), root, f"{at}[{k}]")
    return found


def _target(reference: str, root: dict[str, Any]) -> dict[str, Any]:
    target = root
    for part in reference.removeprefix("#/").split("/"):
        target = target[part]
    return target


def _fields(
    value: dict[str, Any], schema: dict[str, Any], root: dict[str, Any], at: str
) -> Iterator[str]:
    properties = schema.get("properties", {})
    for name in schema.get("required", ()):
        if name not in value:
            yield f"{at}.{name}: missing"
    for name, item in value.items():
        rest = schema.get("additionalProperties", True)
        if name in properties:
            yield from problems(item, properties[name], root, f"{at}.{name}")
        elif rest is False:
            yield f"{at}.{name}: unknown"
        elif rest is not True:
            yield from problems(item, rest, root, f"{at}.{name}")


def _own(value: Any, schema: dict[str, Any], at: str) -> Iterator[str]:
    if "type" in schema:
        is_bool = isinstance(value, bool) and schema["type"] != "boolean"
        if is_bool or not isinstance(value, _TYPES[schema["type"]]):
            yield f"{at}: {schema['type']} expected"
            return
    if value not in schema.get("enum", [value]) or value != schema.get("const", value):
        yield f"{at}: another value expected"
    if isinstance(value, (str, list)):
        if len(value) < max(schema.get("minItems", 0), schema.get("minLength", 0)):
            yield f"{at}: too short"
        if len(value) > schema.get("maxItems", len(value)):
            yield f"{at}: too long"
        if schema.get("uniqueItems") and len(set(map(str, value))) < len(value):
            yield f"{at}: twice the same"
    if isinstance(value, (int, float)):
        low, high = schema.get("minimum", value), schema.get("maximum", value)
        if not low <= value <= high or value <= schema.get("exclusiveMinimum", value - 1):
            yield f"{at}: out of range"

"""The container's files: what can be checked without an engine."""

from __future__ import annotations

import os
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
DOCKER = ROOT / "docker"


def test_compose_offers_the_named_uses() -> None:
    compose = yaml.safe_load((DOCKER / "compose.yaml").read_text(encoding="utf-8"))
    services = compose["services"]
    assert {"demo", "test", "shell"} == set(services)
    assert services["demo"]["command"] == ["make", "demo"]
    assert services["test"]["command"] == ["make", "test"]
    for service in services.values():
        context = DOCKER / service["build"]["context"]
        assert (context / service["build"]["dockerfile"]).is_file()


def test_the_dockerfile_names_files_that_exist() -> None:
    lines = (DOCKER / "Dockerfile").read_text(encoding="utf-8").splitlines()
    copied = [line.split()[-2] for line in lines if line.startswith("COPY")]
    assert copied == ["requirements", "tools", "."]
    assert all((ROOT / name).exists() for name in copied)
    entrypoint = DOCKER / "entrypoint.sh"
    assert f'ENTRYPOINT ["docker/{entrypoint.name}"]' in lines
    assert os.access(entrypoint, os.X_OK)


def test_the_image_does_not_copy_what_was_built_here() -> None:
    ignored = (ROOT / ".dockerignore").read_text(encoding="utf-8").split()
    assert {".git", ".venv", "build", "install", "log", "results"} <= set(ignored)

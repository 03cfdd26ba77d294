"""One way to plug in: things found by name, registered in code or brought by other packages.

Code of this repository registers under a decorator. Another package lists what it brings in its
pyproject.toml, and nothing is imported before its name is looked up:

    [project.entry-points."ghc_controller.tasks"]
    relative_position = "my_package.tasks:RelativePosition"
"""

from __future__ import annotations

import pkgutil
import warnings
from collections.abc import Callable, Collection, Iterator
from importlib import import_module, metadata, resources
from inspect import getmodule
from pathlib import Path
from typing import Generic, TypeVar

from ghc_controller.errors import InvalidValue, PluginError, UnknownName

T = TypeVar("T")
V = TypeVar("V")


class Registry(Collection[str], Generic[T]):
    """The names of one kind of thing, and the things by name.

    Names are those registered in code and those of the entry points of `group`. Entry points are
    read when a name is not registered in code or when all names are listed, and imported one by
    one when they are looked up: a package that cannot be imported affects its own names only.
    """

    def __init__(
        self,
        kind: str,
        group: str,
        *,
        modules: str = "",
        base: type | None = None,
        instance_of: type | None = None,
    ) -> None:
        """An empty registry.

        Args:
            kind: what messages call one thing, e.g. "task kind".
            group: entry-point group, e.g. "ghc_controller.tasks".
            modules: package whose modules register what they define when they are imported;
                they are imported at the first look-up.
            base: class that everything in it is a subclass of; None: any.
            instance_of: class that everything in it is an instance of; None: any.
        """
        self.kind = kind
        self.group = group
        self._modules = modules
        self._base = base
        self._instance_of = instance_of
        self._registered: dict[str, T] = {}
        self._plugins: dict[str, list[metadata.EntryPoint]] | None = None

    def register(self, name: str) -> Callable[[V], V]:
        """Decorator: makes what follows available under a name.

        Raises:
            InvalidValue: something else has the name, or it is no subclass of what is expected.
        """

        def register(value: V) -> V:
            problem = self._problem(value)
            if problem:
                raise InvalidValue(f"{self.kind} '{name}': {problem}")
            taken = self._registered.get(name)
            if taken is not None and not _same(taken, value):
                raise InvalidValue(
                    f"{self.kind} '{name}' is registered twice: by {source_of(taken)} and by "
                    f"{source_of(value)}"
                )
            self._registered[name] = value  # type: ignore[assignment]
            return value

        return register

    def register_files(self, package: str, pattern: str) -> None:
        """Register the files of a package that match, such as "scene/data/*.yaml".

        A file's name is that of the thing; where the last folder of the pattern is a star, the
        folder's is.
        """
        by_folder = "/*/" in pattern
        for file in sorted(Path(str(resources.files(package))).glob(pattern)):
            self.register(file.parent.name if by_folder else file.stem)(file)

    @property
    def built_in(self) -> tuple[str, ...]:
        """Names registered in code, in the order of their registration; reads no entry points."""
        self._import_modules()
        return tuple(self._registered)

    def __getitem__(self, name: str) -> T:
        """The thing of that name.

        Raises:
            UnknownName: there is none; lists all that exist.
            PluginError: it cannot be imported, is not of the expected kind, or two packages bring
                it; names package and entry point.
        """
        self._import_modules()
        if name in self._registered:
            return self._registered[name]
        found = self._found().get(name, [])
        if not found:
            raise UnknownName(self.kind, name, self)
        if len(found) > 1:
            sources = " and by ".join(sorted(map(_origin, found)))
            raise PluginError(f"{self.kind} '{name}' is brought twice: by {sources}")
        return self._load(found[0])

    def __contains__(self, name: object) -> bool:
        self._import_modules()
        return name in self._registered or name in self._found()

    def __iter__(self) -> Iterator[str]:
        """All names, sorted."""
        self._import_modules()
        return iter(sorted({*self._registered, *self._found()}))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def usable(self) -> dict[str, T]:
        """Everything that can be loaded, by name; plug-ins that cannot are left out."""
        things: dict[str, T] = {}
        for name in self:
            try:
                things[name] = self[name]
            except PluginError:
                continue
        return things

    def _import_modules(self) -> None:
        if self._modules:
            package, self._modules = import_module(self._modules), ""
            for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
                import_module(module.name)

    def _found(self) -> dict[str, list[metadata.EntryPoint]]:
        """Name -> its entry points, read once; those whose name is built in are left out."""
        if self._plugins is None:
            self._plugins = {}
            for entry in metadata.entry_points(group=self.group):
                if entry.name in self._registered:
                    warnings.warn(
                        f"{self.kind} '{entry.name}' of {_origin(entry)} is not used: the name is "
                        f"taken by {source_of(self._registered[entry.name])}",
                        stacklevel=3,
                    )
                else:
                    self._plugins.setdefault(entry.name, []).append(entry)
        return self._plugins

    def _load(self, entry: metadata.EntryPoint) -> T:
        try:
            value = entry.load()
        except Exception as error:  # whatever a foreign module raises while it is imported
            raise PluginError(
                f"{self.kind} '{entry.name}' of {_origin(entry)} cannot be loaded: "
                f"{type(error).__name__}: {error}"
            ) from error
        problem = self._problem(value)
        if problem:
            raise PluginError(f"{self.kind} '{entry.name}' of {_origin(entry)}: {problem}")
        return value

    def _problem(self, value: object) -> str:
        """What is wrong with a value, "" if nothing is."""
        base, of = self._base, self._instance_of
        if base and not (isinstance(value, type) and issubclass(value, base)):
            return f"{value!r} given, a subclass of {base.__name__} expected"
        if of and not isinstance(value, of):
            return f"{value!r} given, a {of.__name__} expected"
        return ""


def _same(one: object, other: object) -> bool:
    """Whether two are equal, or one definition that ran twice, as in a notebook's cell."""
    defined = hasattr(one, "__qualname__") and hasattr(other, "__qualname__")
    return one == other or (defined and source_of(one) == source_of(other))


def source_of(value: object) -> str:
    """Where something that is registered comes from."""
    if isinstance(value, str | Path):
        return str(value)
    module = getmodule(value)
    name = getattr(value, "__qualname__", type(value).__qualname__)
    return f"{module.__name__}.{name}" if module else name


def _origin(entry: metadata.EntryPoint) -> str:
    """Package and entry point, for messages."""
    package = f"package {entry.dist.name} {entry.dist.version}" if entry.dist else "a package"
    return f"{package} (entry point {entry.group}: {entry.name} = {entry.value})"

"""Where models are: this package's in a wheel or a clone, a user's in the package around them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from drake_viapoint.errors import ModelFileError

if TYPE_CHECKING:
    from pydrake.multibody.parsing import PackageMap

PACKAGE = "drake_viapoint"
"""Name of the models' package, as in ``package://drake_viapoint/serve.dmd.yaml``."""

FOLDERS_ABOVE = 3
"""A package of a user's own is looked for in a file's folder and so many above it."""


def models_path() -> Path:
    """Return the folder that holds ``package.xml``, the models and the scenes.

    Raises:
        ModelFileError: The installation lacks its models.
    """
    package = Path(__file__).resolve().parent
    for folder in (package / "models", package.parent / "models"):
        if (folder / "package.xml").is_file():
            return folder
    raise ModelFileError(f"package://{PACKAGE}/package.xml", f"no models beside {package}")


def resolve(uri: str) -> Path:
    """Return the file that a ``package://drake_viapoint/...`` address names.

    Args:
        uri: The address, as model directives write it.

    Raises:
        ModelFileError: The address is of another form, leaves the package, or names no file.
    """
    prefix = f"package://{PACKAGE}/"
    if not uri.startswith(prefix):
        raise ModelFileError(uri, f"a model's address starts with {prefix}")
    folder = models_path()
    path = (folder / uri.removeprefix(prefix)).resolve()
    if not path.is_relative_to(folder):
        raise ModelFileError(uri, f"leaves {folder}")
    if not path.is_file():
        raise ModelFileError(uri, f"no such file in {folder}")
    return path


def package_beside(file: Path) -> tuple[str, Path] | None:
    """The ROS package that a file of a user's own lies in.

    The nearest ``package.xml`` counts, in the file's folder or one of the few above; nothing is
    looked for below.

    Args:
        file: The file.

    Returns:
        Name and folder of the package; None if there is none, or it is this package.

    Raises:
        ModelFileError: A ``package.xml`` that names no package, or takes this package's name.
    """
    folder = file.parent.resolve()
    near = [folder, *folder.parents][: FOLDERS_ABOVE + 1]
    found = next((path for path in near if (path / "package.xml").is_file()), None)
    if found is None or found == models_path():
        return None
    name = _name_in(found / "package.xml")
    if name == PACKAGE:
        reason = f"a package of your own cannot be called {PACKAGE}, as this one is"
        raise ModelFileError(str(found / "package.xml"), reason)
    return name, found


def package_map(beside: Path | None = None) -> PackageMap:
    """Return Drake's package map with this package's models in it.

    Args:
        beside: A file of a user's own, such as model directives: the package it lies in is known,
            too.

    Raises:
        ModelFileError: The file's package has no name, or one that is taken.
    """
    from pydrake.multibody.parsing import PackageMap

    packages = PackageMap()
    packages.Add(PACKAGE, str(models_path()))
    own = package_beside(beside) if beside else None
    if own:
        name, folder = own
        if packages.Contains(name):
            manifest = str(folder / "package.xml")
            raise ModelFileError(manifest, f"the name {name} is taken by Drake's own package")
        packages.Add(name, str(folder))
    return packages


def _name_in(manifest: Path) -> str:
    """Name of the package; read here, as Drake stops the process where it is empty."""
    try:
        root = ElementTree.parse(manifest).getroot()
    except (OSError, ElementTree.ParseError, ValueError, LookupError) as error:
        raise ModelFileError(str(manifest), f"cannot be read: {error}") from error
    name = (root.findtext("name") or "").strip() if root.tag == "package" else ""
    if not name:
        raise ModelFileError(str(manifest), "names no package: no <name> in a <package>")
    return name

"""Where the models are: in a wheel inside the package, in a clone beside it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from drake_viapoint.errors import ModelFileError

if TYPE_CHECKING:
    from pydrake.multibody.parsing import PackageMap

PACKAGE = "drake_viapoint"
"""Name of the models' package, as in ``package://drake_viapoint/serve.dmd.yaml``."""


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


def package_map() -> PackageMap:
    """Return Drake's package map with this package's models in it."""
    from pydrake.multibody.parsing import PackageMap

    packages = PackageMap()
    packages.Add(PACKAGE, str(models_path()))
    return packages

"""Model directives: what a user's file names, put into a plant."""

from __future__ import annotations

from pathlib import Path

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_viapoint.errors import ModelFileError
from drake_viapoint.packages import package_map


def add_directives(plant: MultibodyPlant, path: Path, address: str | None = None) -> None:
    """Add what a directives file names to a plant.

    The file may name ``package://drake_viapoint/...``, and the package that it lies in itself (see
    ``packages.package_beside``).

    Args:
        plant: Where it goes; not yet finalised.
        path: The file.
        address: What errors call it; the path if None.

    Raises:
        ModelFileError: The file or a model it names cannot be read.
    """
    parser = Parser(plant)
    packages = parser.package_map()
    packages.AddMap(package_map(path))
    try:
        parser.AddModels(str(path))
    except RuntimeError as error:
        reason = " ".join(str(error).split()).removeprefix("error: ")
        if "unknown package" in reason:
            reason += f"; known are {', '.join(packages.GetPackageNames())}"
        elif "when parsing a string" in reason:  # Drake's words for what has no scheme
            reason = (
                f"{reason.partition(' is invalid')[0]} is no address: it has the form "
                "package://NAME/FILE or file:///FILE"
            )
        raise ModelFileError(address or str(path), reason) from error

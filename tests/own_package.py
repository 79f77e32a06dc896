"""A ROS package of a user's own: the shipped models under another name, directives in a folder."""

from pathlib import Path

from drake_viapoint.packages import models_path

NAME = "my_robot"


def own_package(folder: Path) -> Path:
    """The folder of the directives, ``config``, of a package that knows nothing of the shipped."""
    package, shipped = folder / NAME, models_path()
    for path in shipped.rglob("*"):
        if path.suffix in {".obj", ".urdf", ".yaml", ".xml"}:
            inside = path.relative_to(shipped)
            if path.name.endswith(".dmd.yaml"):
                inside = "config" / inside
            (package / inside).parent.mkdir(parents=True, exist_ok=True)
            (package / inside).write_text(renamed(path.read_text()))
    return package / "config"


def renamed(text: str) -> str:
    """With addresses in the user's package."""
    lines = []
    for line in text.splitlines():
        config = "config/" if ".dmd.yaml" in line else ""
        line = line.replace("package://drake_viapoint/", f"package://{NAME}/{config}")
        lines.append(line.replace("<name>drake_viapoint<", f"<name>{NAME}<"))
    return "\n".join(lines)

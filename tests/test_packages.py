"""The wheel and the sdist carry the models, and the installed package finds them from anywhere."""

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
MODELS = ROOT / "models"

if not MODELS.is_dir():
    pytest.skip("distributions are built in a clone", allow_module_level=True)
pytest.importorskip("hatchling")

FILES = sorted(
    path.relative_to(MODELS).as_posix()
    for path in MODELS.rglob("*")
    if path.is_file() and path.suffix not in {".py", ".pyc"}
)


def build(target: str, folder: Path) -> Path:
    command = [sys.executable, "-m", "hatchling", "build", "--target", target]
    subprocess.run(
        [*command, "--directory", str(folder)], check=True, cwd=ROOT, capture_output=True
    )
    (built,) = folder.iterdir()
    return built


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("wheel", tmp_path_factory.mktemp("wheel"))


def test_wheel_carries_the_package_and_its_models(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        (metadata,) = (name for name in names if name.endswith("/METADATA"))
        text = archive.read(metadata).decode()
    assert {f"drake_viapoint/models/{file}" for file in FILES} <= names
    own = [p for p in (ROOT / "drake_viapoint").rglob("*") if p.suffix in {".py", ".jinja"}]
    assert {path.relative_to(ROOT).as_posix() for path in own} <= names
    assert "drake_viapoint/reproduction/report.html.jinja" in names
    assert {name.split("/")[0] for name in names} == {
        "drake_viapoint",
        metadata.split("/")[0],
    }
    assert "License-Expression: BSD-3-Clause" in text
    assert "Requires-Python: >=3.11" in text


def test_sdist_carries_the_models(tmp_path: Path) -> None:
    with tarfile.open(build("sdist", tmp_path)) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {f"models/{file}" for file in FILES} <= names
    assert {"pyproject.toml", "LICENSE", "README.md"} <= names


def test_unpacked_wheel_finds_its_models_from_any_folder(wheel: Path, tmp_path: Path) -> None:
    site, elsewhere = tmp_path / "site", tmp_path / "elsewhere"
    elsewhere.mkdir()
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    program = (
        "import sys\n"
        "from drake_viapoint.packages import models_path, resolve\n"
        "assert not any(name.startswith('pydrake') for name in sys.modules)\n"
        "print(models_path())\n"
        "print(resolve('package://drake_viapoint/serve.dmd.yaml'))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        check=True,
        cwd=elsewhere,
        env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
    )
    models = (site / "drake_viapoint" / "models").resolve()
    assert done.stdout.split() == [str(models), str(models / "serve.dmd.yaml")]

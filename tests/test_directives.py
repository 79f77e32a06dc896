"""Directives of a user's own: which package is known, and what an error names."""

from pathlib import Path

import numpy as np
import pytest
from own_package import own_package

from drake_viapoint.errors import ModelFileError
from drake_viapoint.packages import FOLDERS_ABOVE, models_path, package_beside, package_map, resolve
from drake_viapoint.robot.arm import load_plant

BALL = resolve("package://drake_viapoint/ball/ball.urdf").read_text()


def package(folder: Path, name: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(f"<package format='2'><name>{name}</name></package>")
    (folder / "ball.urdf").write_text(BALL)
    return folder


def directives(folder: Path, address: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "own.dmd.yaml"
    file.write_text(f"directives:\n- add_model: {{name: ball, file: '{address}'}}\n")
    return file


def fault(file: Path) -> str:
    with pytest.raises(ModelFileError) as caught:
        load_plant(file)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("above", range(FOLDERS_ABOVE + 3))
def test_the_package_around_the_file_is_known_a_few_folders_up(tmp_path: Path, above: int) -> None:
    own = package(tmp_path / "a" / "b" / "c" / "own", "own")
    file = directives(own.joinpath(*"uvwxyz"[:above]), "package://own/ball.urdf")
    if above <= FOLDERS_ABOVE:
        assert package_beside(file) == ("own", own)
        assert load_plant(file).HasBodyNamed("ball")
    else:
        assert package_beside(file) is None
        assert "'own'" in fault(file)


def test_the_nearest_package_counts(tmp_path: Path) -> None:
    package(tmp_path, "outer")
    inner = package(tmp_path / "inner", "inner")
    assert package_beside(inner / "config" / "own.dmd.yaml") == ("inner", inner)
    assert package_beside(tmp_path / "other" / "own.dmd.yaml") == ("outer", tmp_path)


def test_nothing_is_looked_for_below(tmp_path: Path) -> None:
    package(tmp_path / "below", "own")
    assert package_beside(tmp_path / "own.dmd.yaml") is None
    assert "unknown package 'own'" in fault(directives(tmp_path, "package://own/ball.urdf"))


def test_a_path_from_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = package(tmp_path / "own", "own")
    directives(own / "config", "package://own/ball.urdf")
    monkeypatch.chdir(own / "config")
    assert load_plant(Path("own.dmd.yaml")).HasBodyNamed("ball")
    monkeypatch.chdir(own)
    assert load_plant(Path("config/../config/own.dmd.yaml")).HasBodyNamed("ball")


def test_the_shipped_directives_lie_in_no_package_of_a_users_own() -> None:
    assert package_beside(models_path() / "serve.dmd.yaml") is None
    assert package_beside(models_path() / "scenarios" / "serve.yaml") is None
    shipped = set(package_map().GetPackageNames())
    assert set(package_map(models_path() / "serve.dmd.yaml").GetPackageNames()) == shipped


@pytest.mark.parametrize("name", ["drake_viapoint", "drake", "drake_models"])
def test_names_that_are_taken(tmp_path: Path, name: str) -> None:
    """Whose models an address means would depend on who reads it."""
    own = package(tmp_path / "own", name)
    message = fault(directives(own, f"package://{name}/ball.urdf"))
    assert message.startswith(f"{own / 'package.xml'}: ")
    assert name in message.removeprefix(f"{own}")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "<package>",
        "<package/>",
        "<package><name/></package>",
        "<package><name> </name></package>",
        "<robot><name>own</name></robot>",
        "<?xml version='1.0' encoding='of one kind'?><package><name>own</name></package>",
    ],
)
def test_a_manifest_without_a_name(tmp_path: Path, text: str) -> None:
    """Some of them would stop the process if Drake read them."""
    file = directives(tmp_path, "package://drake_viapoint/ball/ball.urdf")
    (tmp_path / "package.xml").write_text(text)
    assert fault(file).startswith(f"{tmp_path / 'package.xml'}: ")


@pytest.mark.parametrize(
    ("address", "reason"),
    [
        ("package://own/none.urdf", "does not exist"),
        ("package://other/ball.urdf", "unknown package 'other'; known are "),
        ("file:///no/ball.urdf", "does not exist"),
        ("ball.urdf", "is no address: it has the form package://NAME/FILE or file:///FILE"),
        ("file:ball.urdf", "is no address"),
        ("file://ball.urdf", "is no address"),
        ("https://own/ball.urdf", "unsupported"),
    ],
)
def test_errors_name_the_address(tmp_path: Path, address: str, reason: str) -> None:
    file = directives(package(tmp_path, "own"), address)
    message = fault(file)
    assert message.startswith(f"{file}: ")
    assert address in message
    assert reason in message


@pytest.mark.parametrize(
    ("item", "fault_at"),
    [
        ("add_modle: {name: a}", "unknown key add_modle; there are add_model, "),
        ("add_model: {nam: a}", "unknown key nam; there are file, name, "),
        ("add_model: {name: [a]}", "name must be a scalar, got a sequence"),
        ("add_weld: {parent: a, child: b, X_PC: {translation: [0]}}", "has 1-size entry"),
        ("add_frame: {name: a, X_PF: {rotation: !Roll {deg: [0]}}}", "has unsupported type tag"),
    ],
)
def test_a_typing_error_is_told_by_line_and_key(tmp_path: Path, item: str, fault_at: str) -> None:
    """Drake's reader says where it was, too, in types of C++."""
    file = tmp_path / "own.dmd.yaml"
    file.write_text(f"directives:\n- {item}\n")
    message = fault(file)
    assert message.startswith(f"{file}: line 2: {fault_at}")
    assert "while" not in message
    assert str(file) not in message.removeprefix(f"{file}: ")


@pytest.mark.parametrize(
    ("item", "said"),
    [
        ("{add_model: {file: package://own/ball.urdf}}", "add_model needs a name"),
        ("{add_model: {name: a}}", "add_model needs a file"),
        ("{add_weld: {parent: world}}", "add_weld needs a child"),
        ("{add_frame: {name: a, X_PF: {}}}", "add_frame needs an X_PF.base_frame"),
        ("{add_directives: {}}", "add_directives needs a file"),
        (
            "{add_model: {name: a, file: package://own/ball.urdf}, add_weld: {parent: world}}",
            "must be one, got add_model, add_weld",
        ),
        ("{}", "must be one, got nothing"),
    ],
)
@pytest.mark.parametrize("within", [False, True])
def test_what_would_stop_the_process_is_refused(
    tmp_path: Path, item: str, said: str, within: bool
) -> None:
    """Drake aborts on them, and takes with it whoever reads the file."""
    own = package(tmp_path, "own")
    file, outer = own / "inner.dmd.yaml", own / "outer.dmd.yaml"
    file.write_text(f"directives:\n- {item}\n")
    outer.write_text("directives:\n- add_directives: {file: package://own/inner.dmd.yaml}\n")
    message = fault(outer if within else file)
    assert f"{file}: item 1 of directives" in message
    assert message.endswith(said)


def test_directives_that_add_themselves_are_refused(tmp_path: Path) -> None:
    own = package(tmp_path, "own")
    for name, other in (("a", "b"), ("b", "a"), ("c", "c")):
        address = f"package://own/{other}.dmd.yaml"
        (own / f"{name}.dmd.yaml").write_text(
            f"directives:\n- add_directives: {{file: {address}}}\n"
        )
    for name in "abc":
        assert fault(own / f"{name}.dmd.yaml").endswith("is added by what it adds itself")


def test_the_outermost_key_and_files_within_are_told(tmp_path: Path) -> None:
    own = package(tmp_path, "own")
    inner, outer = own / "inner.dmd.yaml", own / "outer.dmd.yaml"
    inner.write_text("directive: []\n")
    assert fault(inner) == f"{inner}: line 1: unknown key directive; there are directives"
    outer.write_text("directives:\n- add_directives: {file: package://own/inner.dmd.yaml}\n")
    assert fault(outer).startswith(f"{outer}: {inner}, line 1: unknown key directive")
    inner.write_text("directives: 3\n")
    assert fault(inner) == f"{inner}: line 1: directives must be a sequence, got a scalar"


def test_the_known_packages_are_listed(tmp_path: Path) -> None:
    message = fault(directives(package(tmp_path, "own"), "package://owm/ball.urdf"))
    known = message.partition("known are ")[2].split(", ")
    assert {"own", "drake_viapoint"} <= set(known)


def test_directives_within_directives_know_the_package(tmp_path: Path) -> None:
    own = package(tmp_path, "own")
    directives(own / "inner", "package://own/ball.urdf")
    outer = own / "outer.dmd.yaml"
    address = "package://own/inner/own.dmd.yaml"
    outer.write_text(f"directives:\n- add_directives: {{file: {address}}}\n")
    assert load_plant(outer).HasBodyNamed("ball")


@pytest.mark.parametrize(
    "arm",
    [
        "arm_with_racket",
        "arm_with_axle",
        "six_joint_arm_with_racket",
        "six_joint_arm_with_pointer",
    ],
)
def test_an_arm_in_a_package_of_its_own_is_the_same_arm(tmp_path: Path, arm: str) -> None:
    shipped = load_plant(resolve(f"package://drake_viapoint/{arm}.dmd.yaml"))
    own = load_plant(own_package(tmp_path) / f"{arm}.dmd.yaml")
    masses = []
    for plant in (shipped, own):
        context = plant.CreateDefaultContext()
        masses.append(plant.CalcMassMatrix(context))
    np.testing.assert_array_equal(*masses)

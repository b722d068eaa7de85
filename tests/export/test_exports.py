"""Exports are read back by other programs' readers, and hold the numbers that the result holds."""

from __future__ import annotations

import csv
import json
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade.export import FORMATS, export
from torsade.export.frames import chosen
from torsade.protocols import PROTOCOLS
from torsade.view.colours import linear_rgb, strain_colour
from torsade.view.skin import skin_meshes
from torsade.view.strands import Strand, strands_at

SHAPED = [name for name in PROTOCOLS if PROTOCOLS[name].pictured]


@pytest.fixture(scope="module")
def opened(stored: Callable[[str], Path]) -> Callable[[str], ts.Result]:
    return lambda protocol: ts.open_result(stored(protocol))


@pytest.mark.parametrize("protocol", SHAPED)
def test_a_vtk_series_is_read_by_vtk(
    protocol: str, opened: Callable[[str], ts.Result], tmp_path: Path
) -> None:
    pyvista = pytest.importorskip("pyvista")
    result = opened(protocol)
    files = result.export("vtk", tmp_path / "run.pvd")
    assert files[0] == tmp_path / "run.pvd"
    assert sorted(tmp_path.rglob("*.vtp")) == sorted(files[1:])
    reader, data = pyvista.PVDReader(str(files[0])), result.dataset
    np.testing.assert_array_equal(reader.time_values, data["time"])
    for frame in {0, result.frames // 2, result.frames - 1}:
        reader.set_active_time_point(frame)
        mesh, *skin = reader.read()
        assert len(skin) == ("skin_position" in data)
        strands = strands_at(data, frame)
        assert mesh.n_cells == mesh.n_lines == len(strands)
        np.testing.assert_array_equal(mesh.points, np.concatenate([s.x for s in strands]))
        np.testing.assert_array_equal(mesh.cell_data["strand"], np.arange(len(strands)))
        assert mesh.field_data["TimeValue"][0] == data["time"][frame]
        for name in data.data_vars:
            if data[name].dims[:2] == ("time", "node") and name != "position":
                values = data[name].values[frame]
                expected = np.concatenate([values[s.rows] for s in strands])
                np.testing.assert_array_equal(mesh.point_data[str(name)], expected)
        np.testing.assert_array_equal(mesh.point_data["radius"], data.attrs["radius"])


def test_a_broken_rod_is_exported_in_its_pieces(opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    """Rows beyond the last piece hold nan and are left out; pieces grow in number and keep the length."""
    pyvista = pytest.importorskip("pyvista")
    result = opened("snap-twist")
    reader = pyvista.PVDReader(str(result.export("vtk", tmp_path / "run.pvd")[0]))
    counts = []
    for frame in range(result.frames):
        reader.set_active_time_point(frame)
        (mesh,) = reader.read()
        assert np.isfinite(mesh.points).all()
        counts.append(mesh.n_lines)
        lengths = [np.linalg.norm(np.diff(cell.points, axis=0), axis=1).sum() for cell in mesh.cell]
        assert sum(lengths) == pytest.approx(0.24, rel=1e-5)
    assert counts[0] == 2
    assert counts[-1] == result.dataset.attrs["fragments"]
    lines = table(result.export("csv", tmp_path / "run.csv")[-1])
    assert len({line["strand"] for line in lines}) == counts[-1]
    assert all(line["position_x_m"] for line in lines)
    _, content, _ = glb(result.export("gltf", tmp_path / "run.glb", -1)[0])
    assert len(content["meshes"]) == counts[-1]


def test_skin_moves_in_a_vtk_series(opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    """Round around the recorded axes, one radius away; faces look out, each side by its number."""
    pyvista = pytest.importorskip("pyvista")
    result = opened("suture")
    files = result.export("vtk", tmp_path / "run.pvd")
    assert len(files) == 1 + 2 * result.frames
    reader, axes = pyvista.PVDReader(str(files[0])), result.dataset["skin_position"].values
    radius = json.loads(result.dataset.attrs["model"])["skin_radius"]
    assert np.ptp(axes, axis=0).max() > 1e-3 * radius
    for frame in (0, result.frames - 1):
        reader.set_active_time_point(frame)
        _, skin = reader.read()
        for side, axis in enumerate(axes[frame]):
            body = skin.extract_cells(skin.cell_data["side"] == side).extract_surface(algorithm=None)
            away = np.linalg.norm(body.points[:, :2] - axis[:2], axis=1)
            assert away.max() == pytest.approx(radius, rel=1e-4)
            assert body.points[:, :2].mean(axis=0) == pytest.approx(axis[:2], abs=1e-3 * radius)
            height = np.ptp(body.points[:, 2])
            assert body.volume == pytest.approx(np.pi * radius**2 * height, rel=0.03)
            assert np.linalg.norm(body.point_data["Normals"], axis=1) == pytest.approx(1.0, rel=1e-5)


def test_skin_of_a_glb_lets_see_through(opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    """Section 3.9.4 of the specification: an alpha below 1 is heeded where the mode is BLEND."""
    _, content, binary = glb(opened("suture").export("gltf", tmp_path / "run.glb", 2)[0])
    fiber, skin = content["materials"]
    assert "alphaMode" not in fiber
    assert skin["alphaMode"] == "BLEND"
    assert 0.2 < skin["pbrMetallicRoughness"]["baseColorFactor"][3] < 0.8
    for mesh, axis in zip(
        content["meshes"][1:], opened("suture").dataset["skin_position"][2].values, strict=True
    ):
        (primitive,) = mesh["primitives"]
        assert primitive["material"] == 1
        x = accessor(content, binary, primitive["attributes"]["POSITION"]).astype(float)
        assert x.mean(axis=0) == pytest.approx(axis, abs=1e-3 * np.ptp(x))
        faces = accessor(content, binary, primitive["indices"]).reshape(-1, 3)
        a, b, c = (x[faces[:, k]] for k in range(3))
        assert np.sum(a * np.cross(b, c)) > 0  # faces look out
    _, content, _ = glb(opened("tighten").export("gltf", tmp_path / "knot.glb")[0])
    assert [material["name"] for material in content["materials"]] == ["fiber"]


def test_a_closed_strand_returns_to_its_first_point(tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    result = ring()
    reader = pyvista.PVDReader(str(result.export("vtk", tmp_path / "ring.pvd")[0]))
    (mesh,) = reader.read()
    assert mesh.lines.tolist() == [13, *range(12), 0]
    _, content, binary = glb(result.export("gltf", tmp_path / "ring.glb")[0])
    faces = accessor(content, binary, content["meshes"][0]["primitives"][0]["indices"]).reshape(-1, 3)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()  # no seam, no end


def table(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text().splitlines()))


ENDINGS = {
    "1": "",
    "s": "_s",
    "m": "_m",
    "m/s": "_m_per_s",
    "1/m": "_per_m",
    "N": "_N",
    "J": "_J",
    "rad": "_rad",
    "rad/s": "_rad_per_s",
}
"""Of columns, by the unit."""


def ring() -> ts.Result:
    import xarray

    phi = 2 * np.pi * np.arange(12) / 12
    x = np.stack([np.cos(phi), np.sin(phi), 0 * phi], axis=1)
    data = xarray.Dataset(
        {
            "position": (("time", "node", "space"), x[None]),
            "node_start": ("fiber_bound", [0, 12]),
            "closed": ("fiber", [True]),
        },
        coords={"time": [0.0]},
        attrs={"protocol": "ring", "radius": 0.1},
    )
    return ts.Result(data)


def glb(path: Path) -> tuple[dict, dict, bytes]:
    """Header, JSON and numbers of a file, as section 4.4 of the specification lays them out."""
    raw = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", raw, 0)
    assert (magic, version, length, length % 4) == (b"glTF", 2, len(raw), 0)
    size, kind = struct.unpack_from("<I4s", raw, 12)
    assert (kind, size % 4) == (b"JSON", 0)
    content = json.loads(raw[20 : 20 + size])
    more, kind = struct.unpack_from("<I4s", raw, 20 + size)
    assert (kind, more % 4) == (b"BIN\0", 0)
    binary = raw[28 + size :]
    assert len(binary) == more == content["buffers"][0]["byteLength"]
    return content["asset"], content, binary


def accessor(content: dict, binary: bytes, number: int) -> np.ndarray:
    about = content["accessors"][number]
    view = content["bufferViews"][about["bufferView"]]
    dtype = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[about["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[about["type"]]
    assert view["byteOffset"] % 4 == 0
    assert view["byteLength"] == about["count"] * width * np.dtype(dtype).itemsize
    found = np.frombuffer(binary, dtype, about["count"] * width, view["byteOffset"])
    return found.reshape(-1, width)


@pytest.mark.parametrize("protocol", SHAPED)
def test_a_glb_is_sound(protocol: str, opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    """What section 3.7 of the specification asks of meshes; every vertex lies on the tube, faces look out."""
    result = opened(protocol)
    path = result.export("gltf", tmp_path / "run.glb")[0]
    asset, content, binary = glb(path)
    assert asset["version"] == "2.0"
    assert asset["extras"]["time_s"] == float(result.dataset["time"][result.last_held])
    strands = strands_at(result.dataset, result.last_held)
    radius = result.dataset.attrs["radius"]
    assert content["scenes"][0]["nodes"] == list(range(len(content["meshes"])))
    names = [mesh["name"] for mesh in content["meshes"]]
    skin = ["skin 0", "skin 1"] if "skin_position" in result.dataset else []
    assert names == [node["name"] for node in content["nodes"]]
    assert names == [f"strand {k}" for k in range(len(strands))] + skin
    for strand, mesh in zip(strands, content["meshes"], strict=False):
        (primitive,) = mesh["primitives"]
        named = primitive["attributes"]
        x, normal, colour = (
            accessor(content, binary, named[name]) for name in ("POSITION", "NORMAL", "COLOR_0")
        )
        bounds = content["accessors"][named["POSITION"]]
        assert (x.min(axis=0).tolist(), x.max(axis=0).tolist()) == (bounds["min"], bounds["max"])
        np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-5)
        assert len(x) == len(normal) == len(colour)
        assert (colour[:, 3] == 65535).all()
        faces = accessor(content, binary, primitive["indices"]).reshape(-1, 3)
        assert faces.max() == len(x) - 1
        a, b, c = (x[faces[:, k]].astype(float) for k in range(3))
        length = np.linalg.norm(np.diff(strand.x, axis=0), axis=1).sum()
        volume = np.sum(a * np.cross(b, c)) / 6
        assert volume == pytest.approx(np.pi * radius**2 * length, rel=0.05)


def test_colours_of_a_glb_are_those_of_strain_in_linear_light(
    opened: Callable[[str], ts.Result], tmp_path: Path
) -> None:
    result = opened("prison-escape")
    _, content, binary = glb(result.export("gltf", tmp_path / "run.glb", 5)[0])
    named = content["meshes"][0]["primitives"][0]["attributes"]
    colour = accessor(content, binary, named["COLOR_0"])[:, :3] / 65535
    strand: Strand = strands_at(result.dataset, 5)[0]
    strain = strand.of(result.dataset["log_strain"].values[5])
    x = accessor(content, binary, named["POSITION"])
    middle = 70  # a node: the vertices of the ring at it lie one radius away
    near = np.abs(np.linalg.norm(x - strand.x[middle], axis=1) / 2e-4 - 1) < 1e-3
    assert near.any()
    np.testing.assert_allclose(
        colour[near], np.tile(linear_rgb(strain_colour(strain[middle])), (near.sum(), 1)), atol=2e-2
    )


@pytest.mark.parametrize("protocol", SHAPED)
def test_a_glb_is_read_by_vtk(protocol: str, opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    result = opened(protocol)
    mesh = pyvista.read(result.export("gltf", tmp_path / "run.glb")[0])
    x = np.concatenate([s.x for s in strands_at(result.dataset, result.last_held)])
    x = np.concatenate([x, *(m.vertices for m in skin_meshes(result.dataset, result.last_held))])
    low, high = np.array(mesh.bounds).reshape(3, 2).T
    reach = 1.01 * result.dataset.attrs["radius"]
    assert (np.abs(low - x.min(axis=0)) <= reach).all()
    assert (np.abs(high - x.max(axis=0)) <= reach).all()


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_tables_hold_the_histories(protocol: str, opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    result = opened(protocol)
    data = result.dataset
    files = result.export("csv", tmp_path / "run.csv", "::2")
    rows = table(files[0])
    assert [int(row["frame"]) for row in rows] == list(range(0, result.frames, 2))
    assert [float(row["time_s"]) for row in rows] == data["time"].values[::2].tolist()
    for row in rows:
        for name in data.data_vars:
            if data[name].dims == ("time",):
                column = f"{name}{ENDINGS[data[name].units]}"
                value = float(data[name][int(row["frame"])])
                assert (row[column] == "") if not np.isfinite(value) else (float(row[column]) == value)
    assert (tmp_path / "run-samples.csv").exists() == ("sample" in data.dims)
    assert (tmp_path / "run-nodes.csv").exists() == ("position" in data)


def test_columns_end_in_their_units(opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    files = opened("prison-escape").export("csv", tmp_path / "run.csv", -1)
    assert [p.name for p in files] == ["run.csv", "run-samples.csv", "run-nodes.csv"]
    heads = [set(table(p)[0]) for p in files]
    assert {"separation_m", "pull_speed_m_per_s", "compression_N", "twist_0_rad", "twist_1_rad"} <= heads[0]
    assert heads[1] == {"sample_time_s", "sample_separation_m"}
    assert {"strand", "node", "position_x_m", "velocity_z_m_per_s", "log_strain"} <= heads[2]


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_arrays_are_all_there_and_nothing_is_pickled(
    protocol: str, opened: Callable[[str], ts.Result], tmp_path: Path
) -> None:
    data = opened(protocol).dataset
    (path,) = opened(protocol).export("npz", tmp_path / "run.npz")
    with np.load(path, allow_pickle=False) as found:
        assert set(found.files) == {"about", *map(str, data.variables)}
        for name, values in data.variables.items():
            np.testing.assert_array_equal(found[str(name)], values)
            assert found[str(name)].dtype == values.dtype
        about = json.loads(str(found["about"]))
    assert about["attributes"]["versions"] == data.attrs["versions"]
    assert about["variables"]["time"] == {"dims": ["time"], "units": "s", "long_name": "time"}


def test_arrays_of_some_frames(opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    data = opened("tighten").dataset
    (path,) = opened("tighten").export("npz", tmp_path / "run.npz", slice(1, 7, 3))
    with np.load(path) as found:
        np.testing.assert_array_equal(found["position"], data["position"][[1, 4]])
        np.testing.assert_array_equal(found["node_start"], data["node_start"])


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        (None, [0, 1, 2, 3, 4]),
        ("all", [0, 1, 2, 3, 4]),
        ("3", [3]),
        ("-1", [4]),
        (-5, [0]),
        ("1:3", [1, 2]),
        ("::2", [0, 2, 4]),
        ("-2:", [3, 4]),
        ("::-2", [4, 2, 0]),
        (slice(1, None, 3), [1, 4]),
        ("0:100", [0, 1, 2, 3, 4]),
    ],
)
def test_frames_that_are_meant(wanted: object, found: list[int]) -> None:
    assert list(chosen(wanted, 5, slice(None))) == found  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("to", "name", "frames", "says"),
    [
        ("stl", "a.stl", None, "there is no export to 'stl'; choose vtk, gltf, csv or npz"),
        ("vtk", "a.vtk", None, "give a name that ends in .pvd"),
        ("gltf", "a.gltf", None, "give a name that ends in .glb"),
        ("npz", "none/a.npz", None, "no such folder"),
        ("csv", "a.csv", "5", "frame 5 was asked for; the result has 1, numbered from 0"),
        ("csv", "a.csv", "first", "frames are 'first'; give a number such as 10 or -1, a range"),
        ("csv", "a.csv", "1:2:3:4", "frames are '1:2:3:4'; give a number"),
        ("csv", "a.csv", "0:5:0", "steps of 0; give a step of 1 or more"),
        ("csv", "a.csv", "7:9", "none of the 1 frames, numbered from 0, is among those asked for"),
        ("csv", "a.csv", "9" * 30, "frames are '99.*'; give a number"),
    ],
)
def test_what_cannot_be_exported_is_refused(
    to: str, name: str, frames: str | None, says: str, tmp_path: Path
) -> None:
    with pytest.raises(ts.TorsadeError, match=says):
        ring().export(to, tmp_path / name, frames)
    assert list(tmp_path.iterdir()) == []


def test_one_frame_goes_into_a_glb(opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    with pytest.raises(
        ts.TorsadeError, match="glTF takes one frame, and 9 were asked for; give one, such as -1"
    ):
        opened("tighten").export("gltf", tmp_path / "a.glb", "all")


def test_a_result_without_shape_has_tables_only(opened: Callable[[str], ts.Result], tmp_path: Path) -> None:
    for to in ("vtk", "gltf"):
        with pytest.raises(ts.TorsadeError, match="has no shape to be drawn: it lacks position"):
            opened("pendulum").export(to, tmp_path / f"a{FORMATS[to]}")
    assert list(tmp_path.iterdir()) == []
    assert len(opened("pendulum").export("csv", tmp_path / "a.csv")) == 2


@pytest.mark.parametrize("to", FORMATS)
def test_files_are_replaced_only_when_asked(to: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{FORMATS[to]}"
    ring().export(to, path)
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    with pytest.raises(ts.TorsadeError, match="exists already; give another name, or --overwrite"):
        ring().export(to, path)
    ring().export(to, path, overwrite=True)
    assert {p for p in tmp_path.rglob("*") if p.is_file()} == set(before)


def test_what_lies_beside_is_not_replaced_either(tmp_path: Path) -> None:
    (tmp_path / "a-nodes.csv").write_text("years of work")
    with pytest.raises(ts.TorsadeError, match=r"a-nodes.csv' exists already"):
        ring().export("csv", tmp_path / "a.csv")
    (tmp_path / "a-frames").mkdir()
    (tmp_path / "a-frames" / "thesis.tex").write_text("years of work")
    with pytest.raises(ts.TorsadeError, match="holds other things than frames; give another name"):
        ring().export("vtk", tmp_path / "a.pvd", overwrite=True)
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["a-frames", "a-nodes.csv", "thesis.tex"]


@pytest.mark.parametrize("to", FORMATS)
def test_an_interrupted_or_failed_export_leaves_nothing(
    to: str, opened: Callable[[str], ts.Result], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    def stop(share: float, note: str) -> None:
        raise KeyboardInterrupt

    path = tmp_path / f"a{FORMATS[to]}"
    if to in ("vtk", "npz"):
        with pytest.raises(KeyboardInterrupt):
            export(opened("tighten"), to, path, progress=stop)
        assert list(tmp_path.iterdir()) == []
    monkeypatch.setattr(Path, "write_bytes", full)
    monkeypatch.setattr("zipfile.ZipFile.open", full)
    with pytest.raises(ts.TorsadeError, match=r"cannot write .* \(no space left on device\)"):
        export(opened("tighten"), to, path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("bounds", "says"),
    [
        ([0, 5], None),
        ([0, 40], "not rows"),
        ([-1, 12], "not rows"),
        ([0, 6, 3, 12], "not rows"),
        ([0, 1, 12], "not rows"),
    ],
)
def test_strands_that_are_none_are_not_drawn(bounds: list[int], says: str | None) -> None:
    data = ring().dataset.drop_vars(["node_start", "closed"])
    data["node_start"] = ("fiber_bound", bounds)
    data["closed"] = ("fiber", [False] * (len(bounds) - 1))
    if says is None:
        assert len(strands_at(data, 0)) == 1
        return
    with pytest.raises(ts.TorsadeError, match=says):
        strands_at(data, 0)

"""Valid inputs, made by the package itself, and words that mean something in them."""

from __future__ import annotations

import io
import json
import re
import shutil
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from torsade.centerline import Centerline
from torsade.cli.codes import codes_of
from torsade.files.centerlines import FORMATS
from torsade.knots.finding import find
from torsade.protocols import PROTOCOLS
from torsade.topology.codes import to_braid, to_unsigned_gauss
from torsade.units import _PLAIN, _PREFIXED, DIMENSIONS

__all__ = ["FIELDS", "files", "result_folder", "samples", "words"]


def samples(target: str) -> list[bytes]:
    """Inputs of a target: a line that says what reads it, and then the body."""
    return {
        "curves": _curves,
        "arrays": _arrays,
        "tables": _tables,
        "codes": _codes,
        "names": _names,
        "specs": _specs,
        "results": _results,
        "shell": _shell,
    }[target]()


def words(target: str) -> list[bytes]:
    """Words of all its inputs, and of all specifications where there are any."""
    found = {word for data in samples(target) for word in re.findall(rb"[^\W\d]{1,40}", data[:5000])}
    if target in ("specs", "shell"):
        for spec in PROTOCOLS.values():
            found |= {name.encode() for name in spec.model_fields}
            found |= {b"--" + name.encode().replace(b"_", b"-") for name in spec.model_fields}
    return sorted(found)


def _centerlines() -> list[Centerline]:
    t = np.linspace(0, 2 * np.pi, 40)[:-1]
    x, y = np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t)
    knot = 1e-3 * np.column_stack([x, y, -np.sin(3 * t)])
    line = np.outer(np.arange(8.0) * 2e-4, [1.0, 0, 0])
    return [Centerline((line, line + 6e-4)), Centerline((knot,), (True,))]


def _curves() -> list[bytes]:
    suffixes = (".csv", ".xyz", ".obj", ".vect")
    found = [s[1:].encode() + b"\n" + FORMATS[s].written(c) for s in suffixes for c in _centerlines()]
    found.append(b"xyz\n0 0 0\n1e-4 0 0\n2e-4 0 0\n\n0 1 0\n1 1 0\n")
    return [*found, b"obj\nv 0 0 0\nv 1 0 0\nv 1 1 0\nl -3 -2 -1 -3\n"]


def _arrays() -> list[bytes]:
    x = np.arange(12.0).reshape(4, 3)
    npy = io.BytesIO()
    np.save(npy, np.stack([x, x + 1]))
    head = "{'descr': '<f8', 'fortran_order': False, 'shape': (4, 3), }"
    closed = "{'descr': '|b1', 'fortran_order': False, 'shape': (1,), }"
    members = [
        [["strand0.npy", head, 96, True], ["strand1.npy", head, 96, False]],
        [["x.npy", head, 96, True], ["closed.npy", closed, 1, True]],
        [["x.npy", head.replace("4", "400000"), 9_600_000, True]],
    ]
    written = FORMATS[".npz"].written(_centerlines()[0])
    return [
        b"npz\n" + written,
        b"npy\n" + npy.getvalue(),
        *(b"members\n" + json.dumps(m).encode() for m in members),
    ]


def _tables() -> list[bytes]:
    swing = [f"{t:.3f},{40 * np.exp(-t) * np.cos(20 * t):.4f},240,a" for t in np.linspace(0, 2, 60)]
    return [
        b"trials\nlengths_mm,twist_deg,end_distance_mm,speed_mm_per_s\n120 60 58,0,180,3\n90+139,9,200,3\n",
        b"trials\npieces;limit_curvature_per_m;end_distance_error_mm;length (mm);twist [deg]\n3;9.5;1;50;0\n"
        + b"".join(b"%d;%d;1;%d;%d\n" % (2 + k % 4, 8 + k, 20 + k, 15 * k) for k in range(24)),
        b"buckling\nmass_g,length_mm\n31,100\n14,150\n",
        b"weights\nmass_g\tlength_mm\tnote\n0.55\t240\tdry\n0.28\t120\t\n",
        b"pendulum\ntime_s,angle_deg,length_mm,sample\n" + "\n".join(swing).encode(),
    ]


def _codes() -> list[bytes]:
    found = ["[(3,2)(21,2)]", "[3;21;2-]", "[8*2:.20]", "[.2.20]", "[-6*2.(3;2).20]", "C[12 3]"]
    found.append("DT: [(4,6),(2,8)]")
    for name in ("3_1", "4_1", "m5_2", "8_19", "L5a1", "reef", "overhand", "borromean", "10_165"):
        diagram = find(name).diagram
        found += [code for code in codes_of(diagram).values() if code is not None]
        if not diagram.ends:
            braid = to_braid(diagram)
            found += [f"braid: {braid}", f"BR[4,{{{braid}}}]", f"Gauss: {to_unsigned_gauss(diagram)}"]
    return [b"code\n" + code.encode() for code in found]


def _names() -> list[bytes]:
    known = ("reef", "m3_1#4_1", "L5a1", "T(3,4)", "overhand-9", "open 5_2", "5,-3", "mirror granny", "0_1")
    found = [f"{kind}\n{name}" for name in known for kind in ("name", "bend", "strand", "search")]
    found += [f"{name}\n{d.example}" for name, d in DIMENSIONS.items()]
    found += [f"length\n1 {unit}" for unit in (*_PREFIXED, *_PLAIN)] + ["force\n1.5e3 g/(cm s²)^1*m^2·cm**-1"]
    return [text.encode() for text in [*found, *(f"name\n{code.decode()[5:]}" for code in _codes())]]


FIELDS = {
    "prison-escape": {"knot": "reef", "force": "15 N", "lead": "5 mm", "pulled": "A1B1", "direction": "-y"},
    "tighten": {"knot": "overhand", "duration": "10 s", "until_still": "1 um/s", "radius": "0.2 mm"},
    "reidemeister": {"move": "R1", "length": "40 mm", "ends": "swivel", "frames": 20, "exclusion_edges": 3},
    "bend-twist": {"end_distance": "19 cm", "twist": "270 deg", "nodes": 51, "E_b": "3.8 GPa", "nu": 0.3},
    "snap-twist": {"twist": "270 deg", "edges": 20, "seed": 3, "disorder": 0.05, "min_fragment": "30 mm"},
    "snap-quench": {"speed": "100 mm/s", "length": "24 cm", "rho": "1.5 g/cm^3", "approach": "10 ms"},
    "pendulum": {"turn": "45 deg", "mass": "20 g", "material": "nylon", "step": "1 us", "radius": 0.0007},
    "battery": {"knot": "4_1", "twist": 1.0, "nodes": 60, "cut_at": 0.25, "charging": "0.3 s", "seed": 2},
    "suture": {"throws": "5,-3", "angle": "30 deg", "skin_stiffness": "20 N/m", "friction": 0.3, "gap": 1e-3},
}


def _specs() -> list[bytes]:
    lines = {k: "".join(f"{n} = {json.dumps(v)}\n" for n, v in f.items()) for k, f in FIELDS.items()}
    found = [f'toml\nprotocol = "{name}"\n{text}' for name, text in lines.items()]
    found += [f"{name}\n{json.dumps(fields)}" for name, fields in FIELDS.items()]
    more = {"centerline": "a.csv", "length_unit": "mm", "smooth": "0.1 mm", "tolerance": 1e-3}
    more |= {"area": "product", "solver_tolerance": "1e-5"}
    return [text.encode() for text in [*found, f"tighten\n{json.dumps(more)}"]]


@cache
def result_folder() -> Path:
    """A small result, which this process may spoil."""
    sound = Path(tempfile.gettempdir()) / "torsade-fuzz" / "a.zarr"
    if not sound.exists():
        sound.parent.mkdir(exist_ok=True)
        spec = PROTOCOLS["prison-escape"](knot="reef", duration="0.1 ms", frames=2, spacing="0.2 mm")  # type: ignore[call-arg]
        spec.run(out=sound)
    return Path(shutil.copytree(sound, Path(tempfile.mkdtemp(prefix="fuzz")) / "a.zarr"))


def _results() -> list[bytes]:
    files = sorted(p for p in result_folder().rglob("*") if p.is_file() and p.stat().st_size < 50_000)
    return [str(p.relative_to(result_folder())).encode() + b"\n" + p.read_bytes() for p in files]


@cache
def files() -> dict[str, bytes]:
    """Files that command lines may name."""
    line, knot = _centerlines()
    trials, _, masses, *_ = (data.partition(b"\n")[2] for data in _tables())
    return {
        "a.csv": FORMATS[".csv"].written(knot),
        "a.xyz": FORMATS[".xyz"].written(line),
        "a.toml": b'protocol = "tighten"\ncenterline = "a.csv"\n',
        "trials.csv": trials,
        "masses.csv": masses,
    }


def _shell() -> list[bytes]:
    found = [
        ["run", name, *(f"--{field.replace('_', '-')}={value}" for field, value in fields.items())]
        for name, fields in FIELDS.items()
    ]
    found += [
        ["run", "--spec", "a.toml", "--json"],
        ["run", "prison-escape", "--knot", "reef", "--force", "15 N", "--json"],
        [
            "run",
            "tighten",
            "--centerline",
            "a.csv",
            "--out",
            "a.zarr",
            "--picture",
            "a.png",
            "--plot",
            "b.pdf",
        ],
        *(
            ["topology", name, "--json"]
            for name in ("5,-3", "m3_1#3_1", "X[1,5,2,4] X[3,1,4,6] X[5,3,6,2]", "a.csv")
        ),
        ["topology", "reef", "--pulled", "A1B0", "--drawings", "3"],
        ["topology", "a.xyz", "--direction", "fewest", "--length-unit", "mm"],
        ["convert", "a.xyz", "b.csv", "--smooth", "0.1 mm", "--spacing", "0.1 mm", "--every", "2"],
        ["knots", "list", "fish", "--kind", "bend"],
        ["knots", "show", "zeppelin", "--json"],
        ["knots", "build", "8_19", "--radius", "1 mm", "--length", "20 cm", "--out", "a.vtk"],
        ["tight", "4_1", "--ropelength", "50", "--nodes", "100", "--tries", "3", "--out", "a.csv"],
        ["trials", "trials.csv", "--slow", "20 mm/s", "--criterion", "von_mises", "--sectors", "5"],
        ["material", "--radius", "0.7 mm", "--radius-error", "25 um", "--weights", "masses.csv"],
        ["figure", "4-5", "--out", "figures", "--preset", "standard", "--workers", "2", "--quick", "--json"],
        ["movie", "a.zarr", "--out", "a.mp4", "--seconds", "3", "--size", "64x48", "--frames", "0:3"],
        ["info", "a.zarr", "--json"],
        ["export", "a.zarr", "--to", "csv", "--out", "a"],
        ["demo", "--out", "demo"],
        ["--version"],
        ["run", "tighten", "--help"],
    ]
    return [b"torsade\n" + "\n".join(arguments).encode() for arguments in found]

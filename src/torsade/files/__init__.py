"""Files of centerlines: one function to read them, one to write them, and the format is in the name.

| suffix | what it is |
| --- | --- |
| .csv | columns strand, x, y, z |
| .xyz | count, comment, element x y z; or bare x y z |
| .obj | vertices and polylines |
| .vect | Geomview's polylines |
| .npz, .npy | arrays of numpy |
| .vtk | legacy VTK polydata, written only |
"""

from torsade.files.centerlines import (
    SUFFIXES,
    read_centerline,
    read_csv,
    write_centerline,
    write_csv,
)

__all__ = ["SUFFIXES", "read_centerline", "read_csv", "write_centerline", "write_csv"]

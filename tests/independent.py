"""Counts pairs of triangles that intersect, by MeshLib, which shares no code with this project.

usage: independent.py MESH...    prints one number a line, in the order given
exit:  3 if MeshLib is not installed
"""

import sys

try:
    from meshlib import mrmeshpy
except ImportError as error:
    print(f"no meshlib: {error}", file=sys.stderr)
    sys.exit(3)


def main() -> None:
    for path in sys.argv[1:]:
        mesh = mrmeshpy.loadMesh(path)
        faces = mesh.topology.numValidFaces()
        if faces == 0:
            sys.exit(f"{path}: MeshLib finds no triangles in it")
        print(len(mrmeshpy.findSelfCollidingTriangles(mesh)))


main()

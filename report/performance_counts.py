"""Arithmetic and traffic of the kernels, counted in the source: what the roofline needs besides the measured rates.

Additions, multiplications, divisions and square roots count one each. Bytes are what must move between memory and core at least once; what stays in a
cache between two uses counts once.

collide (a node): macroscopic moments 47, equilibrium and relaxation of rest and nine pairs 154; Guo force 29 more. 19 populations read and written; with a
    force field 4 numbers read and cleared, 4 velocities written.
spread (a marker), w-point kernel: weights 60, row 4w, w^2 rows of one weight and 4w multiply-adds. Position and force (48 bytes), key and order (12); each
    force node read and written once, shared by the markers of the box.
interpolate (a marker): the same multiply-adds, 6w for the last sum. Position and velocity (48 bytes); each velocity node read once.
membrane (a vertex): two triangles with 94 for strain, 17 for global tension and 30 for the sums of area and volume; three edges with 158 (43 of them for
    the angle). Position and force, 48 bytes.
"""


def collide(real, force):
    """(flops, bytes) a node; real: bytes of a number."""
    return 201 + (29 if force else 0), real * (38 + (12 if force else 0))


def spread(points, real, nodes_per_marker):
    return 60 + 4 * points + points**2 * (1 + 8 * points), 48 + 12 + nodes_per_marker * 8 * real


def interpolate(points, real, nodes_per_marker):
    return 60 + 6 * points + points**2 * (1 + 8 * points), 48 + nodes_per_marker * 4 * real


def membrane(bending, global_terms):
    return 2 * (94 + (47 if global_terms else 0)) + (3 * 158 if bending else 0), 48

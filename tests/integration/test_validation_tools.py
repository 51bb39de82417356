"""The tools of tests/validation: extrapolation, angles, pass or fail, and that a simulation runs once.

PROGRAM SOURCE-FOLDER. Exit 77: the Python modules are missing.
"""

import pathlib
import sys
import tempfile

try:
    import h5py  # noqa: F401
    import numpy as np
except ImportError as error:
    print(f"skipped: {error} (needs numpy, h5py)")
    sys.exit(77)

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "tests/validation"))

from analysis import order, rotation_vector, section, to_zero, unwrapped  # noqa: E402
from rows import Row  # noqa: E402
from simulations import Simulations, scene  # noqa: E402


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")


radii = np.array([5.0, 7.0, 10.0])
check(abs(order(radii, 2 + 3 * radii**-1.5) - 1.5) < 1e-3, "order of f = 2 + 3 r^-1.5")
check(np.isnan(order(radii, [1.0, 2.0, 1.5])), "no order without monotone convergence")
limit, change = to_zero(1 / radii, 2 + 3 / radii + 4 / radii**2)
check(abs(limit - 2) < 1e-9 and change > 0.01, "limit of a quadratic in 1/r")

angle, long, breadth = 0.4, 3.0, 1.0  # an ellipse in the shear plane, second moments of its area: semi-axes squared over 4
c, s = np.cos(angle), np.sin(angle)
a, b = long**2, breadth**2
d, tilt = section([a * c * c + b * s * s, 1.0, a * s * s + b * c * c, 0.0, (a - b) * c * s, 0.0])
check(abs(d - 0.5) < 1e-12 and abs(tilt - angle) < 1e-12, "D and inclination of an ellipse")
turning = np.linspace(0, 9, 50)
check(np.allclose(unwrapped((turning + np.pi / 2) % np.pi - np.pi / 2), turning), "an angle known up to pi becomes continuous")
cloud = np.random.default_rng(1).normal(size=(20, 3))
turn = np.array([[np.cos(0.3), 0, np.sin(0.3)], [0, 1, 0], [-np.sin(0.3), 0, np.cos(0.3)]])
check(np.allclose(rotation_vector(cloud, cloud @ turn.T + 5), [0, 0.3, 0]), "rotation of a cloud about y")

check(Row("", "", 1.02, 1.0, "", 0.03).passed and not Row("", "", 1.04, 1.0, "", 0.03).passed, "relative tolerance")
check(Row("", "", 0.9, 1.0, "", test="below").passed and not Row("", "", 1.1, 1.0, "", test="below").passed, "bound")
check(not Row("", "", float("nan"), 1.0, "", 0.03).passed, "NaN fails")

tiny = scene(
    box={"size": [4, 4, 4]},
    flow={"capillary_number": 0.1},
    cells=[{"shape": "sphere", "count": 1, "position": [2.0, 2.0, 2.0]}],
    accuracy={"radius": 4},
    run={"strain": 0.05},
    output={"series_every": 0.01, "snapshot_every": 0.05},
)
with tempfile.TemporaryDirectory() as folder:
    said = []
    for _ in range(2):  # the second time everything is there
        results = Simulations(program, source, folder, 1, said.append).all({"one": tiny, "again": tiny})
    check(len(said) == 1, f"one simulation for equal scenes, not {len(said)}")
    check(results["one"].series("strain")[-1] > 0.04 and results["one"].cells("gyration").shape[1:] == (1, 6), "results can be read")
    check(results["one"].vertices()[1].shape[1:] == (results["one"].cell_type["vertices"], 3), "vertices can be read")
    try:
        Simulations(program, source, folder, 1, said.append).all({"bad": "[box]\nsize = 3\n"})
        check(False, "a refused scene is an error")
    except RuntimeError as error:
        check("exit code 2" in str(error), "the exit code is told")
print("ok")

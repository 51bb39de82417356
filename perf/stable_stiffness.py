#!/usr/bin/env python3
"""The stiffest capsule that is stable at several relaxation times, for BGK and TRT and each delta kernel: what physics/stability_limits.cpp says of large relaxation times.

usage: perf/stable_stiffness.py PROGRAM        PROGRAM is bin/corpuscle; prints kappa_S/eta_0, bisected to 20 %; about three minutes

One neo-Hookean capsule (r = 5, no bending) in the middle of a channel of 6 x 6 x 6 r, sheared for 3000 steps at a rate of 0.0015 a step; unstable means that a guard stopped the run.
"""

import sys
import tempfile

from run_scene import run_scene

SCENE = """
[box]
size = [6, 6, 6]
[flow]
capillary_number_G = {ca}
reynolds_number_max = 1
[contact]
enabled = false
[accuracy]
radius = 5
delta_kernel = {kernel}
collision = "{collision}"
relaxation_time = {tau}
precision = "single"
mach_max = 0.3
shear_rate = 0.0015
allow_unstable = true
[run]
steps = 3000
[output]
series_every = 0.1
snapshot_every = 0
[[cells]]
shape = "sphere"
count = 1
position = [3, 3, 3]
membrane = {{ law = "neo_hookean", bending = 0.0 }}
"""


def stable(program, folder, stiffness, **settings):
    result = run_scene(program, folder, SCENE.format(ca=3 * 0.0015 * 5 / stiffness, **settings))
    if result.returncode not in (0, 3):
        sys.exit(result.stderr.strip())
    return result.returncode == 0


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    times = (1, 2, 3, 5)
    print("| collision | points | " + " | ".join(f"tau = {tau}" for tau in times) + " |\n|---|---|" + "---|" * len(times))
    with tempfile.TemporaryDirectory() as folder:
        for collision in ("bgk", "trt"):
            for kernel in (2, 3, 4):
                limits = []
                for tau in times:
                    low, high = 0.1, 60.0
                    while high / low > 1.2:
                        middle = (low * high) ** 0.5
                        if stable(sys.argv[1], folder, middle, kernel=kernel, collision=collision, tau=tau):
                            low = middle
                        else:
                            high = middle
                    limits.append(f"{low:.2f}")
                print(f"| {collision.upper()} | {kernel} | " + " | ".join(limits) + " |", flush=True)


if __name__ == "__main__":
    main()

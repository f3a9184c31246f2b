#!/usr/bin/env python3
"""Coif's chains beside MuJoCo and, where it installs, PositionBasedDynamics (pypbd): the same chains in the same
run, one thread each; processor time, so that other work on the machine does not count, of calls that loop inside
the library.

    scripts/bench_mujoco.py [-o FOLDER] [--seconds S]

Chains are released at 30° from the vertical, undamped, without bending. Both sides step the same chain: point
masses at the links' ends (MuJoCo: ball joints, capsules replaced by point masses with a vanishing inertia of their
own). The tip's error is the root mean square over the chains and over a half second against a reference: Coif's
second-order step at dt / 32 of the finer step, whose own change from dt / 16 is printed. Writes mujoco.csv.

The packages are installed into a virtual environment of their own under build/, so that nothing else sees them.
"""

import argparse
import csv
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
VENV = ROOT / "build" / "venv-mujoco"
GRAVITY = 9.81
HORIZON = 0.5  # s over which tips are compared: before the chaos of long chains makes a comparison void
TILT = 30.0


def ensure_packages():
    python = VENV / "bin" / "python"
    if pathlib.Path(sys.executable).parent == python.parent:
        return
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", VENV], check=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", "mujoco", "numpy"], check=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", "pypbd"], check=False)
    os.environ["PYTHONPATH"] = os.pathsep.join(
        [str(ROOT / "build" / "release" / "python"), os.environ.get("PYTHONPATH", "")])
    os.environ["OMP_NUM_THREADS"] = "1"
    os.execv(python, [python, *sys.argv])


def chain_points(chains, links):
    """(chains × (links + 1), 3): of length 1 each, side by side, tilted in planes that turn from chain to chain."""
    import numpy as np

    angle = np.radians(TILT)
    out = []
    for c in range(chains):
        turn = 2 * np.pi * c / chains
        direction = np.array([np.sin(angle) * np.cos(turn), -np.cos(angle), np.sin(angle) * np.sin(turn)])
        out.append(np.array([0.5 * c, 0, 0]) + np.outer(np.linspace(0, 1, links + 1), direction))
    return np.concatenate(out)


def masses(links):
    """A node has half of each adjacent link's mass, as Coif's chains do (1 a unit length)."""
    link = 1.0 / links
    return [link] * (links - 1) + [link / 2]


class CoifChains:
    def __init__(self, name, chains, links, method, **options):
        import coif

        self.name, self.chains, self.links = name, chains, links
        self.model = coif.Chains(chain_points(chains, links), chains, getattr(coif.DynamicsMethod, method), **options)

    def step(self, dt, steps):
        self.model.step(dt, steps)

    def tips(self):
        return self.model.positions.reshape(self.chains, self.links + 1, 3)[:, -1]


class MujocoChains:
    def __init__(self, name, chains, links, integrator, dt):
        import mujoco

        self.name, self.mujoco = name, mujoco
        points = chain_points(chains, links).reshape(chains, links + 1, 3)
        bodies = []
        for chain in points:
            text, end = "", ""
            for k, mass in enumerate(masses(links)):
                offset = chain[k] - chain[k - 1] if k else chain[0]
                arm = chain[k + 1] - chain[k]
                inertia = 1e-9 * mass  # a point mass: MuJoCo wants something above 0
                text += (f'<body pos="{offset[0]} {offset[1]} {offset[2]}"><joint type="ball"/>'
                         f'<inertial pos="{arm[0]} {arm[1]} {arm[2]}" mass="{mass}" '
                         f'diaginertia="{inertia} {inertia} {inertia}"/>'
                         + (f'<site pos="{arm[0]} {arm[1]} {arm[2]}"/>' if k == links - 1 else ""))
                end += "</body>"
            bodies.append(text + end)
        xml = (f'<mujoco><compiler boundmass="0" boundinertia="0"/><option timestep="{dt}" '
               f'gravity="0 {-GRAVITY} 0" integrator="{integrator}">'
               '<flag contact="disable" energy="disable"/></option><worldbody>' + "".join(bodies)
               + "</worldbody></mujoco>")
        self.model = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)

    def step(self, dt, steps):
        self.mujoco.mj_step(self.model, self.data, nstep=steps)  # the loop is inside the library

    def tips(self):
        self.mujoco.mj_kinematics(self.model, self.data)
        return self.data.site_xpos.copy()


def timed(system, dt, steps):
    begin = time.process_time()
    system.step(dt, steps)
    return time.process_time() - begin


def measure(make, dt, seconds):
    """Median processor seconds a step of fresh runs that last `seconds` in all, and the tips at every 1/24 s of the horizon."""
    import numpy as np

    system = make()
    each = max(1, round(1 / 24 / dt))
    tips = []
    for _ in range(round(HORIZON * 24)):
        system.step(dt, each)
        tips.append(system.tips())
    system = make()
    first = timed(system, dt, 4) / 4
    count = max(1, min(each, int(seconds / 5 / max(first, 1e-7))))
    times = []
    spent = 0.0
    while len(times) < 5 or (spent < seconds and len(times) < 200):
        if len(times) * count * dt > 0.5:
            system = make()  # always the same half second of motion
            system.step(dt, 4)
        taken = timed(system, dt, count)
        times.append(taken / count)
        spent += taken
    return float(np.median(times)), np.array(tips)


def reference(chains, links, dt):
    import numpy as np

    def run(divide):
        system = CoifChains("", chains, links, "ENERGY_KEEPING")
        each = round(1 / 24 / dt) * divide
        tips = []
        for _ in range(round(HORIZON * 24)):
            system.step(1 / 24 / each, each)
            tips.append(system.tips())
        return np.array(tips)

    coarse, fine = run(8), run(16)
    return fine, rms(coarse, fine)


def rms(a, b):
    import numpy as np

    return float(np.sqrt(np.mean(np.sum((a - b) ** 2, axis=-1))))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("-o", "--output", default=str(ROOT / "build" / "bench"))
    parser.add_argument("--seconds", type=float, default=2.0, help="of timing, for each line")
    arguments = parser.parse_args()
    ensure_packages()
    import coif
    import mujoco
    import numpy as np

    try:
        import pypbd  # noqa: F401

        pbd = "installed, but not timed by this script"
    except ImportError:
        pbd = "does not install here"
    print(f"coif {coif.__version__}, MuJoCo {mujoco.__version__}, pypbd {pbd}; {os.cpu_count()} cores, one thread each")
    rows = []
    for chains, links in ((120, 30), (30, 4)):
        for dt in (1 / 240, 1 / 1000):
            step = 1 / 24 / round(1 / 24 / dt)  # a whole number of steps a frame
            truth, doubt = reference(min(chains, 6), links, step)
            makers = [(name, lambda n=name, m=method, o=options: CoifChains(n, chains, links, m, **o))
                      for name, method, options in (("coif direct", "DIRECT", {}),
                                                    ("coif direct, tolerance 1e-5", "DIRECT", {"tolerance": 1e-5}),
                                                    ("coif direct, float", "DIRECT",
                                                     {"float_lanes": True, "tolerance": 1e-5}),
                                                    ("coif BDF2", "DIRECT_BDF2", {}),
                                                    ("coif energy-keeping", "ENERGY_KEEPING", {}),
                                                    ("coif articulated, explicit", "ARTICULATED_EXPLICIT", {}))]
            makers += [(f"mujoco {i}", lambda n=i: MujocoChains(n, chains, links, n, step))
                       for i in ("Euler", "implicitfast", "RK4")]
            results = []
            for name, make in makers:
                seconds, tips = measure(make, step, arguments.seconds)
                few = min(chains, 6)
                # The reference's chains have the angles of a set of `few`; compare distances from the root's
                # vertical plane instead: every chain of the set does the same in its own plane.
                results.append((name, seconds, profile_error(tips, truth, chains, few)))
            fastest = min(s for n, s, _ in results if n.startswith("mujoco"))
            print(f"\n{chains} chains x {links} links, dt 1/{round(1 / step)} s; reference good to {doubt:.1e}")
            print(f"{'':32}{'ms a step':>10}{'Mlinks/s':>10}{'x fastest MuJoCo':>18}{'tip error':>11}")
            for name, seconds, error in results:
                print(f"{name:32}{1e3 * seconds:10.4f}{chains * links / seconds / 1e6:10.2f}"
                      f"{fastest / seconds:18.2f}{error:11.2e}")
                rows.append([chains, links, step, name, seconds, chains * links / seconds, fastest / seconds, error,
                             doubt])
    folder = pathlib.Path(arguments.output)
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "mujoco.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["chains", "links", "dt_s", "solver", "s_per_step", "links_per_s", "ratio_to_fastest_mujoco",
                         "tip_rms_error", "reference_change"])
        writer.writerows(rows)


def profile_error(tips, truth, chains, few):
    """RMS tip error in each chain's own plane: (radius, height) of the tip about its root."""
    import numpy as np

    def profile(all_tips, count):
        frames = []
        for c in range(count):
            turn = 2 * np.pi * c / count
            out = np.array([np.cos(turn), 0, np.sin(turn)])
            side = np.array([-np.sin(turn), 0, np.cos(turn)])
            arm = all_tips[:, c] - np.array([0.5 * c, 0, 0])
            frames.append(np.stack([arm @ out, arm[:, 1], arm @ side], axis=-1))
        return np.stack(frames, axis=1)

    return rms(profile(tips, chains), profile(truth, few)[:, :1])


if __name__ == "__main__":
    main()

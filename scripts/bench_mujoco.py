#!/usr/bin/env python3
"""Coif's chains beside MuJoCo and PositionBasedDynamics' direct rods (PyPI: mujoco, pypbd): the same chains in the
same run, one thread each; processor time of calls that loop inside the library where it has one.

    scripts/bench_mujoco.py [-o FOLDER] [--seconds S]

Chains are released at 30° from the vertical, undamped, without bending. All step the same chain: point masses at the
links' ends (MuJoCo: ball joints and point masses with a vanishing inertia of their own; rods: rigid segments with
their mass at the far end, joined at it). The tip's error is the root mean square over the chains and over a half
second against a reference: Coif's second-order step at a sixteenth, whose own change from an eighth is printed.
Writes mujoco.csv; fails when a bar is missed. Takes about two minutes.

Needs the Python module of the release build; mujoco, pypbd and numpy are installed into a virtual environment of
their own under build/ (about 60 MB), so that nothing else sees them.
"""

import argparse
import csv
import importlib.metadata
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
        subprocess.run([python, "-m", "pip", "install", "--quiet", "mujoco", "pypbd", "numpy"], check=True)
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


class PbdRods:
    """Deul et al.'s direct solver for stiff rods, one iteration a step as PositionBasedDynamics' own demo has it."""

    def __init__(self, name, chains, links, dt):
        import numpy as np
        import pypbd

        self.name, self.chains, self.links = name, chains, links
        if not pypbd.Simulation.hasCurrent() or pypbd.Simulation.getCurrent().getTimeStep() is None:
            pypbd.Simulation.getCurrent().initDefault()
        simulation = pypbd.Simulation.getCurrent()
        self.model = pypbd.SimulationModel()
        simulation.setModel(self.model)
        corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
        faces = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                          [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]], dtype=np.uint32)
        vertices, mesh = pypbd.VertexData(), pypbd.IndexedFaceMesh()
        for corner in corners:
            vertices.addVertex(corner)
        mesh.initMesh(len(corners), 3 * len(faces), len(faces))
        for face in faces:
            mesh.addFace(face)
        mesh.buildNeighbors()
        points = chain_points(chains, links).reshape(chains, links + 1, 3)
        for c, chain in enumerate(points):
            for k, mass in enumerate([0.0, *masses(links)]):
                body = self.model.addRigidBody(1.0, vertices, mesh, translation=chain[k], scale=np.full(3, 0.01))
                body.setMass(mass)  # 0: fixed
                body.setInertiaTensor(np.full(3, 1e-3 * mass / links**2 if mass > 0 else 1.0))
            first = c * (links + 1)
            made = self.model.addDirectPositionBasedSolverForStiffRodsConstraint(
                [(first + k, first + k + 1) for k in range(links)], list(chain[:links]), [1e-3] * links,
                [1 / links] * links, [1e-3] * links, [1e-3] * links)  # radii, lengths; moduli: next to none
            if not made:
                raise RuntimeError("pypbd refused a rod")
        self.stepper = simulation.getTimeStep()
        self.stepper.setValueUInt(pypbd.TimeStepController.NUM_SUB_STEPS, 1)
        self.stepper.setValueUInt(pypbd.TimeStepController.MAX_ITERATIONS, 1)
        pypbd.TimeManager.getCurrent().setTimeStepSize(dt)

    def step(self, dt, steps):
        for _ in range(steps):
            self.stepper.step(self.model)

    def tips(self):
        import numpy as np

        bodies = self.model.getRigidBodies()
        last = [bodies[(c + 1) * (self.links + 1) - 1] for c in range(self.chains)]
        return np.array([body.getPosition().ravel() for body in last])


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

    print(f"coif {coif.__version__}, MuJoCo {mujoco.__version__}, pypbd {importlib.metadata.version('pypbd')}; "
          f"{os.cpu_count()} cores, one thread each")
    rows, missed = [], []
    for chains, links in ((120, 30), (30, 4)):
        for dt in (1 / 240, 1 / 1000):
            step = 1 / 24 / round(1 / 24 / dt)  # a whole number of steps a frame: 1/240 and 1/1008
            few = min(chains, 6)
            truth, doubt = reference(few, links, step)
            makers = [(name, lambda n=name, m=method, o=options: CoifChains(n, chains, links, m, **o))
                      for name, method, options in (("coif direct", "DIRECT", {}),
                                                    ("coif direct, float", "DIRECT",
                                                     {"float_lanes": True, "tolerance": 1e-5}),
                                                    ("coif BDF2", "DIRECT_BDF2", {}),
                                                    ("coif energy-keeping", "ENERGY_KEEPING", {}),
                                                    ("coif energy-keeping, float", "ENERGY_KEEPING",
                                                     {"float_lanes": True, "tolerance": 1e-5}),
                                                    ("coif articulated, explicit", "ARTICULATED_EXPLICIT", {}))]
            makers += [(f"mujoco {i}", lambda n=i: MujocoChains(n, chains, links, n, step))
                       for i in ("Euler", "implicitfast", "RK4")]
            makers.append(("pypbd direct rods", lambda: PbdRods("rods", chains, links, step)))
            results = {}
            for name, make in makers:
                seconds, tips = measure(make, step, arguments.seconds)
                # The reference has fewer chains: compare (radius, height) in each chain's own plane, where all do
                # the same.
                results[name] = (seconds, profile_error(tips, truth, chains, few))
            fastest = min((n for n in results if n.startswith("mujoco")), key=lambda n: results[n][0])
            rods = results["pypbd direct rods"][0]
            print(f"\n{chains} chains x {links} links, dt 1/{round(1 / step)} s; reference good to {doubt:.1e}; "
                  f"fastest of MuJoCo: {fastest}")
            print(f"{'':32}{'ms a step':>10}{'Mlinks/s':>10}{'x MuJoCo':>10}{'x rods':>9}{'tip error':>11}")
            for name, (seconds, error) in results.items():
                ratio = results[fastest][0] / seconds
                print(f"{name:32}{1e3 * seconds:10.4f}{chains * links / seconds / 1e6:10.2f}{ratio:10.2f}"
                      f"{rods / seconds:9.1f}{error:11.2e}")
                rows.append([chains, links, step, name, seconds, chains * links / seconds, ratio, rods / seconds, error,
                             doubt])
            bar = 20 if links == 30 else 5
            for name in ("coif direct", "coif energy-keeping"):
                seconds, error = results[name]
                what = f"{chains} x {links}, 1/{round(1 / step)}: {name} "
                if results[fastest][0] < bar * seconds:
                    missed.append(what + f"{results[fastest][0] / seconds:.1f} times MuJoCo, not {bar}")
                if error > results[fastest][1]:
                    missed.append(what + f"tip error {error:.1e}, MuJoCo {results[fastest][1]:.1e}")
                if links == 30 and rods < 8 * seconds:
                    missed.append(what + f"{rods / seconds:.1f} times the rods, not 8")
    folder = pathlib.Path(arguments.output)
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "mujoco.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["chains", "links", "dt_s", "solver", "s_per_step", "links_per_s", "ratio_to_mujoco", "ratio_to_rods",
                         "tip_rms_error", "reference_change"])
        writer.writerows(rows)
    print("\n" + ("MISSED: " + "; ".join(missed) if missed else "every bar is kept"))
    sys.exit(1 if missed else 0)


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

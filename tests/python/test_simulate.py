"""Hair in motion: settings, frames as arrays, caches, draping, chains."""

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")


@pytest.fixture
def scene(tuft):
    scene = coif.Scene(tuft, name="tuft")
    scene.strands.count = 60
    scene.strands.points = 5
    scene.dynamics.droop = 2.0
    return scene


def rotation_about_y(angle):
    pose = np.eye(4)
    pose[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    return pose


def test_frames_are_arrays_and_roots_stay(scene, tuft):
    motion = scene.simulate(6, use_head=False)
    assert motion.positions.shape == (6, len(tuft.positions), 3) and motion.positions.dtype == np.float32
    assert len(motion) == 6 and motion.fps == 24 and np.array_equal(motion.head_poses, np.tile(np.eye(4), (6, 1, 1)))
    placed = scene.placed_mesh()
    assert np.array_equal(motion.positions[0], placed.positions.astype(np.float32))
    root = placed.positions[:, 1] == 0
    assert np.array_equal(motion.positions[5][root], placed.positions[root].astype(np.float32))


def test_a_head_that_turns_takes_its_roots_along(scene):
    poses = np.stack([rotation_about_y(0.1 * f) for f in range(4)])
    motion = scene.simulate(4, head_poses=poses, use_head=False)
    placed = scene.placed_mesh().positions
    root = placed[:, 1] == 0
    expected = placed[root] @ poses[3, :3, :3].T
    # Frames are 32-bit floats of numbers below 10.
    assert np.abs(motion.positions[3][root] - expected).max() < 2e-6
    strands = scene.strands_at(motion, 3, use_head=False)
    assert len(strands.points) == 60 * 5


def test_a_cache_goes_on_with_the_same_bytes(scene, tmp_path):
    scene.simulate(6, cache=tmp_path / "whole.coifcache", use_head=False)
    first = coif.Scene(scene.hair_mesh)
    first.dynamics = scene.dynamics
    first.simulate(2, cache=tmp_path / "part.coifcache", use_head=False)
    second = coif.Scene(scene.hair_mesh)
    second.dynamics = scene.dynamics
    second.simulate(6, cache=tmp_path / "part.coifcache", use_head=False)
    whole = (tmp_path / "whole.coifcache").read_bytes()
    assert whole == (tmp_path / "part.coifcache").read_bytes()
    assert len(coif.Motion.load(tmp_path / "whole.coifcache")) == 6
    (tmp_path / "cut.coifcache").write_bytes(whole[:-3])
    with pytest.raises(coif.Error, match="cut off"):
        coif.Motion.load(tmp_path / "cut.coifcache")


def test_stepwise_is_the_same_as_the_scene(scene):
    motion = scene.simulate(4, use_head=False)
    simulation = coif.Simulation(scene.placed_mesh(), scene.dynamics, use_head=False)
    for _ in range(3):
        positions = simulation.advance()
    assert simulation.frame == 3 and np.array_equal(positions.astype(np.float32), motion.positions[3])
    state = simulation.state()
    ahead = simulation.advance()
    simulation.restore(state)
    assert simulation.frame == 3 and np.array_equal(simulation.advance(), ahead)
    with pytest.raises(coif.Error):
        simulation.restore(state[:-1])


def test_draping_can_be_undone(tuft):
    before = tuft.positions.copy()
    settings = coif.DynamicsSettings()
    settings.droop = 0.0
    settings.wind_velocity = (1, 2, 3)
    moved = before.copy()
    moved[:, 0] += 0.1 * before[:, 1]  # leaning, so that it falls
    tuft.positions = moved
    report = coif.drape(tuft, settings)
    assert report.greatest_move > 0.5 and not np.array_equal(tuft.positions, moved)
    tuft.undo()
    assert np.array_equal(tuft.positions, moved)
    tuft.positions = before
    assert np.array_equal(tuft.positions, before)


def test_bad_settings_are_refused_with_a_sentence(scene):
    scene.dynamics.friction = float("nan")
    with pytest.raises(coif.Error, match="friction"):
        scene.simulate(2, use_head=False)


def test_a_chain_swings_with_the_period_of_a_pendulum():
    # One link released at 0.1 rad: T = 4 sqrt(L/g) K = 2 pi sqrt(L/g) (1 + theta²/16 + …) = 2.00733 s.
    chains = coif.Chains([(0, 0, 0), (np.sin(0.1), -np.cos(0.1), 0)], 1, coif.DynamicsMethod.ENERGY_KEEPING)
    heights = []
    step = 1e-3
    for _ in range(1300):
        chains.step(step)
        heights.append(chains.positions[1, 0])
    # It is at the far side, slowest, after half a period; the step's error is of the order (omega h)² / 24.
    assert abs(np.argmin(heights) * step - 2.00733 / 2) < 5e-3


def test_wisps_carry_the_strands(scene):
    scene.dynamics.wisps = 5
    scene.dynamics.guide_points = 6
    poses = np.stack([np.eye(4)] + [rotation_about_y(0.2)] * 9)
    motion = scene.simulate(10, head_poses=poses, use_head=False)
    assert motion.positions.shape[2] == 3 and motion.positions.shape[1] % 6 == 0
    assert 0 < motion.positions.shape[1] <= 5 * 3 * 6
    rest = scene.evaluate(use_head=False)
    first = scene.strands_at(motion, 0, use_head=False)
    # Frame 0 is the modelled style; guides are 32-bit floats of numbers below 10.
    assert np.abs(first.points - rest.points).max() < 5e-6
    last = scene.strands_at(motion, 9, use_head=False)
    roots = np.asarray(rest.offsets[:-1], int)
    expected = rest.points[roots] @ poses[9, :3, :3].T
    assert np.abs(last.points[roots] - expected).max() < 5e-6
    assert np.abs(last.points - rest.points @ poses[9, :3, :3].T).max() > 1e-3  # the rest lags behind
    scene.dynamics.wisps = 0
    with pytest.raises(coif.Error, match="no such frame"):
        scene.strands_at(motion, 0, use_head=False)


def test_what_was_left_out_has_a_switch(scene):
    scene.dynamics.droop = 0
    scene.simulate(3, use_head=False)
    report = next(r for r in scene.reports if r.name == "simulate")
    left = {part.switch: part for part in report.left_out}
    assert left["skipBending"].share == 1
    scene.dynamics.skip_bending = False
    scene.dynamics.single_precision = True
    scene.simulate(3, use_head=False)
    left = {part.switch: part for r in scene.reports for part in r.left_out}
    assert "skipBending" not in left and left["precision"].share == 1


def test_a_deforming_scalp_moves_its_roots(scene):
    placed = scene.placed_mesh()
    positions = placed.positions
    root = positions[:, 1] == 0
    wider = [positions[root] * (1 + 0.02 * f) for f in range(6)]
    motion = scene.simulate(6, root_positions=np.stack(wider), use_head=False)
    # Each root is where it was asked to be; frames are 32-bit floats of numbers below 10.
    assert np.abs(motion.positions[5][root] - wider[5]).max() < 2e-6
    with pytest.raises(coif.Error, match="root vertices"):
        scene.simulate(6, root_positions=np.zeros((6, 3, 3)), use_head=False)


def test_motion_is_written_as_time_samples(scene, tmp_path):
    report = scene.export_motion(tmp_path / "m.usda", 3, fps=30, use_head=False)
    text = (tmp_path / "m.usda").read_text()
    assert report.bytes == len(text.encode()) and "timeCodesPerSecond = 30" in text
    assert "point3f[] points.timeSamples" in text
    with pytest.raises(coif.Error, match="are written as"):
        scene.export_motion(tmp_path / "m.obj", 3, use_head=False)

"""Hair on a head that a UsdSkel skeleton moves: the binding goes along, judged by OpenUSD and NumPy."""

import os
import pathlib
import subprocess
import sys

import pytest

np = pytest.importorskip("numpy")
pytest.importorskip("pxr", reason="usd-core is not installed")
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
COIF = pathlib.Path(os.environ.get("COIF_BIN_DIR", ROOT / "build/release/bin")) / "coif"
if not COIF.exists():
    pytest.skip(f"{COIF} is not built", allow_module_level=True)

JOINTS = ["Neck", "Neck/Head"]
SHIFT = Gf.Vec3d(1.5, -2, 0.5)  # the mesh prim's own place: geomBindTransform has to be carried along with it
STRANDS, POINTS = 3000, 8


def run(*arguments):
    return subprocess.run([COIF, *map(str, arguments)], check=True, timeout=600, capture_output=True, text=True)


def obj_mesh(path):
    points, counts, corners = [], [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            face = [int(w.split("/")[0]) - 1 for w in words[1:]]
            counts.append(len(face))
            corners += face
    return np.array(points), counts, corners


def head_weight(points, lo, hi):
    """Of the head's joint: linear in the height, so linear interpolation of any kind gives it back exactly."""
    return (points[:, 1] - lo) / (hi - lo)


def write_head(path, points, counts, corners, weights):
    """A neck and a head joint; the mesh lies SHIFT away from where its skeleton binds it."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    root = UsdSkel.Root.Define(stage, "/Rig")
    stage.SetDefaultPrim(root.GetPrim())
    skeleton = UsdSkel.Skeleton.Define(stage, "/Rig/Skeleton")
    skeleton.CreateJointsAttr(JOINTS)
    bind = [Gf.Matrix4d(1), Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 10, 0))]
    skeleton.CreateBindTransformsAttr(Vt.Matrix4dArray(bind))
    skeleton.CreateRestTransformsAttr(Vt.Matrix4dArray(bind))
    mesh = UsdGeom.Mesh.Define(stage, "/Rig/Face")
    mesh.AddTranslateOp().Set(SHIFT)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy((points - np.array(SHIFT)).astype("f4")))
    mesh.CreateFaceVertexCountsAttr(counts)
    mesh.CreateFaceVertexIndicesAttr(corners)
    mesh.CreateSubdivisionSchemeAttr("none")
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateGeomBindTransformAttr(Gf.Matrix4d().SetTranslate(SHIFT))
    if weights is None:
        binding.SetRigidJointInfluence(1)
    else:
        indices = np.tile(np.array([0, 1], "i4"), len(points))
        binding.CreateJointIndicesPrimvar(False, 2).Set(Vt.IntArray.FromNumpy(indices))
        both = np.stack([1 - weights, weights], axis=1).astype("f4")
        binding.CreateJointWeightsPrimvar(False, 2).Set(Vt.FloatArray.FromNumpy(both.ravel()))
    stage.Save()


@pytest.fixture(scope="module")
def jobs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("skin")
    run("example-head", "-o", folder / "head.obj")
    points, counts, corners = obj_mesh(folder / "head.obj")
    lo, hi = points[:, 1].min(), points[:, 1].max()
    for name, weights in (("soft", head_weight(points, lo, hi)), ("rigid", None)):
        write_head(folder / f"{name}.usda", points, counts, corners, weights)
    # One model serves both: .coif names the head, so the binding is read from whichever file it names.
    run("new", "--scalp", folder / "soft.usda", "--style", "mohawk", "-o", folder / "soft.coif")
    text = (folder / "soft.coif").read_text()
    (folder / "rigid.coif").write_text(text.replace("soft.usda", "rigid.usda"))
    for name in ("soft", "rigid"):
        for form in (".usda", ".usdc"):
            run("build", folder / f"{name}.coif", "--strands", STRANDS, "--points", POINTS, "-o", folder / f"{name}-hair{form}")
    return dict(folder=folder, lo=lo, hi=hi)


def hair(jobs, name, form):
    """The hair's layer over the head's: the skeleton is the head's own."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.subLayerPaths.append(str(jobs["folder"] / f"{name}-hair{form}"))
    layer.subLayerPaths.append(str(jobs["folder"] / f"{name}.usda"))
    return Usd.Stage.Open(layer)


def curves_of(stage):
    return next(UsdGeom.BasisCurves(p) for p in stage.Traverse() if p.IsA(UsdGeom.BasisCurves))


def head_weights_at(prim, count):
    """Weight of joint 1 (Neck/Head) at each of `count` points, as UsdSkel flattens them."""
    binding = UsdSkel.BindingAPI(prim)
    indices, weights = binding.GetJointIndicesPrimvar(), binding.GetJointWeightsPrimvar()
    n = indices.GetElementSize()
    assert n == weights.GetElementSize() and indices.GetInterpolation() == weights.GetInterpolation() == "vertex"
    i, w = (np.array(x.ComputeFlattened()).reshape(count, n) for x in (indices, weights))
    assert np.abs(w.sum(axis=1) - 1).max() < 1e-6  # two roundings to float
    assert (np.diff(w, axis=1) <= 0).all()
    return (w * (i == 1)).sum(axis=1)


@pytest.mark.parametrize("form", [".usda", ".usdc"])
def test_root_weights_are_the_heads(jobs, form):
    stage = hair(jobs, "soft", form)
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Hair/HairMesh"))
    positions = np.array(mesh.GetPointsAttr().Get()).astype(float)
    got = head_weights_at(mesh.GetPrim(), len(positions))
    # Faces of layer 0: their vertices are the roots, and lie on the head.
    layers = np.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("coif:layer").Get())
    bundles = np.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("coif:bundle").Get())
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
    faces = np.split(np.array(mesh.GetFaceVertexIndicesAttr().Get()), np.cumsum(counts)[:-1])
    root_faces = {bundles[f]: faces[f] for f in range(len(faces)) if layers[f] == 0 and bundles[f] >= 0}
    roots = np.unique(np.concatenate(list(root_faces.values())))
    expected = head_weight(positions, jobs["lo"], jobs["hi"])
    # Float positions and weights over a head 31 units tall.
    assert np.abs(got[roots] - expected[roots]).max() < 1e-6

    curves = curves_of(stage)
    n = np.array(curves.GetCurveVertexCountsAttr().Get())
    starts = np.cumsum(n) - n
    prim = curves.GetPrim()
    per_point = head_weights_at(prim, n.sum())
    assert (per_point == np.repeat(per_point[starts], n)).all()
    sizes = np.array(prim.GetAttribute("coif:rootWeightCounts").Get())
    lambdas = np.split(np.array(prim.GetAttribute("coif:rootWeights").Get()).astype(float), np.cumsum(sizes)[:-1])
    on_face = np.array(UsdGeom.PrimvarsAPI(prim).GetPrimvar("coif:rootFace").Get())
    wanted = np.array([lam @ expected[root_faces[f]] for lam, f in zip(lambdas, on_face)])
    assert len(wanted) == STRANDS and np.ptp(wanted) > 0.1
    assert np.abs(per_point[starts] - wanted).max() < 2e-6  # and float mean value coordinates


def skinned_points(stage, pose):
    """Points of the curves, at rest and moved by UsdSkel's own queries, in the world."""
    animation = UsdSkel.Animation.Define(stage, "/Rig/Pose")
    animation.CreateJointsAttr(JOINTS)
    animation.SetTransforms(Vt.Matrix4dArray(pose))
    skeleton = UsdSkel.Skeleton.Get(stage, "/Rig/Skeleton")
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([animation.GetPath()])
    curves = curves_of(stage)
    cache = UsdSkel.Cache()
    assert cache.Populate(UsdSkel.Root.Get(stage, "/Hair"), Usd.TraverseInstanceProxies())
    query = cache.GetSkinningQuery(curves.GetPrim())
    assert query and query.HasJointInfluences()
    transforms = cache.GetSkelQuery(skeleton).ComputeSkinningTransforms(Usd.TimeCode.Default())
    rest = curves.GetPointsAttr().Get()
    moved = Vt.Vec3fArray(rest)
    if query.IsRigidlyDeformed():
        matrix = query.ComputeSkinnedTransform(transforms, Usd.TimeCode.Default())
        moved = Vt.Vec3fArray([Gf.Vec3f(matrix.Transform(Gf.Vec3d(p))) for p in rest])
    else:
        assert query.ComputeSkinnedPoints(transforms, moved, Usd.TimeCode.Default())
    return np.array(rest).astype(float), np.array(moved).astype(float), query


def nod(degrees):
    return [Gf.Matrix4d(1), Gf.Matrix4d(Gf.Rotation(Gf.Vec3d(1, 0, 0), degrees), Gf.Vec3d(0, 10, 0))]


@pytest.mark.parametrize("form", [".usda", ".usdc"])
def test_a_pose_moves_rigid_hair_as_one(jobs, form):
    stage = hair(jobs, "rigid", form)
    rest, moved, query = skinned_points(stage, nod(40))
    assert query.IsRigidlyDeformed()
    for path in ("/Hair/HairMesh", "/Hair/Head"):
        primvar = UsdSkel.BindingAPI(stage.GetPrimAtPath(path)).GetJointIndicesPrimvar()
        assert primvar.GetInterpolation() == "constant" and list(primvar.Get()) == [1]
    # The head turns about the joint at (0, 10, 0), wherever its mesh prim stands.
    angle = np.radians(40)
    turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    pivot = np.array([0, 10, 0])
    assert np.abs(moved - ((rest - pivot) @ turn.T + pivot)).max() < 1e-4  # floats of a 31-unit head


def test_a_pose_moves_soft_hair_by_its_weights(jobs):
    stage = hair(jobs, "soft", ".usdc")
    rest, moved, query = skinned_points(stage, nod(40))
    assert not query.IsRigidlyDeformed()
    curves = curves_of(stage)
    weight = head_weights_at(curves.GetPrim(), len(rest))[:, None]
    angle = np.radians(40)
    turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    pivot = np.array([0, 10, 0])
    wanted = (1 - weight) * rest + weight * ((rest - pivot) @ turn.T + pivot)
    assert np.abs(moved - wanted).max() < 1e-4


@pytest.mark.parametrize("name", ["soft", "rigid"])
def test_baking_accepts_the_hair(jobs, name):
    stage = hair(jobs, name, ".usdc")
    rest, moved, _ = skinned_points(stage, nod(25))
    assert UsdSkel.BakeSkinning(UsdSkel.Root.Get(stage, "/Hair"), Gf.Interval(0, 0))
    curves = curves_of(stage)
    baked = np.array(curves.GetPointsAttr().Get(0)).astype(float)
    matrix = UsdGeom.Xformable(curves).ComputeLocalToWorldTransform(0)
    world = np.c_[baked, np.ones(len(baked))] @ np.array(matrix)
    assert np.abs(world[:, :3] - moved).max() < 1e-3
    assert np.abs(moved - rest).max() > 1


@pytest.mark.parametrize("form", [".usda", ".usdc"])
def test_openusd_opens_it_silently(jobs, form):
    script = ("import sys\nfrom pxr import Usd, UsdValidation, Sdf\nlayer = Sdf.Layer.CreateAnonymous('.usda')\n"
              "layer.subLayerPaths[:] = sys.argv[1:]\nstage = Usd.Stage.Open(layer)\n"
              "validators = [v for v in UsdValidation.ValidationRegistry().GetOrLoadAllValidators()\n"
              "              if v.GetMetadata().name.startswith('usdSkel')]\nassert validators\n"
              "for e in UsdValidation.ValidationContext(validators).Validate(stage): print(e.GetName(), e.GetMessage())\n")
    done = subprocess.run([sys.executable, "-c", script, jobs["folder"] / f"soft-hair{form}", jobs["folder"] / "soft.usda"],
                          capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_a_head_without_a_binding_gives_plain_hair(jobs):
    folder = jobs["folder"]
    (folder / "plain.coif").write_text((folder / "soft.coif").read_text().replace("soft.usda", "head.obj"))
    run("build", folder / "plain.coif", "--strands", 100, "-o", folder / "plain.usda")
    text = (folder / "plain.usda").read_text()
    assert "skel:" not in text and "SkelRoot" not in text


def test_a_binding_that_does_not_fit_is_left_out_and_said(jobs):
    folder = jobs["folder"]
    broken = (folder / "rigid.usda").read_text().replace("skel:jointIndices = [1]", "skel:jointIndices = [7]")
    assert "[7]" in broken
    (folder / "broken.usda").write_text(broken)
    (folder / "broken.coif").write_text((folder / "soft.coif").read_text().replace("soft.usda", "broken.usda"))
    done = run("build", folder / "broken.coif", "--strands", 100, "-o", folder / "broken-hair.usda", "--explain")
    assert "out of range" in done.stdout + done.stderr
    assert "skel:" not in (folder / "broken-hair.usda").read_text()

#include "coif/scene/editor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "coif/base/random.h"
#include "coif/hairmesh/invariants.h"
#include "coif/io/mesh_io.h"
#include "scene/sample_scene.h"

namespace coif {
namespace {

/// n × n unit quads in the plane z = 0, `layers` extruded straight up.
Scene gridScene(std::uint32_t n, int layers) {
  std::vector<Vec3> positions;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) positions.emplace_back(x, y, 0);
  }
  std::vector<std::uint32_t> offsets{0}, corners;
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t v = (n + 1) * y + x;
      corners.insert(corners.end(), {v, v + 1, v + n + 2, v + n + 1});
      offsets.push_back(std::uint32_t(corners.size()));
    }
  }
  Scene scene;
  scene.hairMesh = HairMesh::fromRoot(positions, offsets, corners).value();
  Editor editor(scene);
  for (int k = 0; k < layers; ++k) {
    EXPECT_TRUE(editor.run("select_layer", {{"layer", double(k)}, {"kind", std::string("face")}}).ok());
    EXPECT_TRUE(editor.run("extrude", {{"direction", Vec3(0, 0, 1)}}).ok());
  }
  return editor.scene();
}

CommandArguments ids(const char* name, std::vector<double> values) {
  return {{name, std::move(values)}};
}

TEST(Editor, OneCommandIsOneStep) {
  Editor editor(gridScene(3, 2));
  const auto before = editor.canonicalState();
  ASSERT_TRUE(editor.run("select", ids("faces", {4, 2})).ok());
  ASSERT_TRUE(editor.run("extrude", {{"distance", 0.5}}).ok());
  EXPECT_EQ(editor.undoCount(), 2u);
  EXPECT_EQ(editor.mesh().bundles()[4].height(), 3u);
  // The new face is what is selected, as modellers do, so that it can be moved at once.
  EXPECT_EQ(editor.state().selection.faces, (std::vector<FaceRef>{{BundleId(4), 3}}));
  const auto after = editor.canonicalState();
  ASSERT_TRUE(editor.run("undo").ok());
  ASSERT_TRUE(editor.run("undo").ok());
  EXPECT_EQ(editor.canonicalState(), before);
  EXPECT_FALSE(editor.modified());
  ASSERT_TRUE(editor.run("redo").ok());
  ASSERT_TRUE(editor.run("redo").ok());
  EXPECT_EQ(editor.canonicalState(), after);
  EXPECT_FALSE(editor.run("redo").ok());
}

TEST(Editor, RefusedCommandChangesNothing) {
  Editor editor(gridScene(3, 2));
  const auto before = editor.canonicalState();
  const std::uint64_t revision = editor.revision();
  EXPECT_EQ(editor.run("no_such").error().code, ErrorCode::NotFound);
  EXPECT_FALSE(editor.run("extrude").ok()) << "nothing is selected";
  EXPECT_FALSE(editor.run("extrude", {{"length", 1.0}}).ok()) << "an unknown argument";
  EXPECT_FALSE(editor.run("smooth", {{"strength", 2.0}}).ok()) << "out of range";
  EXPECT_FALSE(editor.run("smooth", {{"steps", 1.5}}).ok()) << "no whole number";
  EXPECT_FALSE(editor.run("smooth", {{"steps", true}}).ok()) << "of the wrong kind";
  EXPECT_FALSE(editor.run("select_all", {{"kind", std::string("hair")}}).ok());
  EXPECT_FALSE(editor
                   .run("displace",
                        {{"vertices", std::vector<double>{1e9}}, {"offsets", std::vector<double>{0, 0, 1}}})
                   .ok());
  EXPECT_FALSE(editor.run("push_out").ok()) << "no head";
  EXPECT_EQ(editor.canonicalState(), before);
  EXPECT_EQ(editor.undoCount(), 0u);
  EXPECT_EQ(editor.revision(), revision);
}

TEST(Editor, ANewStepForgetsWhatWasUndone) {
  Editor editor(gridScene(2, 1));
  ASSERT_TRUE(editor.run("select_all").ok());
  ASSERT_TRUE(editor.run("translate", {{"by", Vec3(0, 0, 1)}}).ok());
  ASSERT_TRUE(editor.run("undo").ok());
  ASSERT_TRUE(editor.run("select_none").ok());
  EXPECT_EQ(editor.redoCount(), 0u);
  EXPECT_EQ(editor.stepLabels(), (std::vector<std::string>{"All", "None"}));
}

TEST(Editor, MovesFollowSoftSelectionAndSpareFrozenVertices) {
  Editor editor(gridScene(4, 1));
  const HairMesh before = editor.mesh();
  const auto at = [](const HairMesh& mesh, double x, double y) {
    for (const HairVertex& v : mesh.vertices()) {
      if (v.layer == 1 && std::abs(v.position.x() - x) < 1e-9 && std::abs(v.position.y() - y) < 1e-9)
        return std::uint32_t(&v - mesh.vertices().data());
    }
    return kNone;
  };
  const std::uint32_t centre = at(before, 2, 2), near = at(before, 3, 2), frozen = at(before, 1, 2);
  const auto idOf = [&](std::uint32_t v) { return double(std::uint32_t(before.vertices()[v].id)); };
  ASSERT_TRUE(editor.run("select", ids("vertices", {idOf(frozen)})).ok());
  ASSERT_TRUE(editor.run("freeze").ok());
  ASSERT_TRUE(editor.run("select", ids("vertices", {idOf(centre)})).ok());
  ASSERT_TRUE(editor.run("translate", {{"by", Vec3(0, 0, 1)}, {"radius", 2.0}}).ok());
  EXPECT_DOUBLE_EQ(editor.mesh().position(centre).z(), 2);
  // Half way to the radius the falloff 3s² − 2s³ is one half.
  EXPECT_DOUBLE_EQ(editor.mesh().position(near).z(), 1.5);
  EXPECT_EQ(editor.mesh().position(frozen), before.position(frozen));
}

TEST(Editor, InternalVerticesArePlacedAndPinnedWhenMoved) {
  Editor editor(gridScene(3, 3));
  const HairMesh before = editor.mesh();
  const auto external = externalVertices(before);
  const auto internal = std::uint32_t(std::ranges::find(external, 0) - external.begin());
  ASSERT_LT(internal, external.size());
  // The outer vertices of its layer go up: it follows without being asked.
  std::vector<double> outer;
  for (std::uint32_t v = 0; v < external.size(); ++v) {
    const HairVertex& vertex = before.vertices()[v];
    if (external[v] && vertex.layer == before.vertices()[internal].layer)
      outer.push_back(std::uint32_t(vertex.id));
  }
  ASSERT_TRUE(editor.run("select", ids("vertices", outer)).ok());
  ASSERT_TRUE(editor.run("translate", {{"by", Vec3(0, 0, 0.3)}}).ok());
  EXPECT_GT(editor.mesh().position(internal).z(), before.position(internal).z() + 1e-3);
  ASSERT_TRUE(
      editor.run("select", ids("vertices", {double(std::uint32_t(before.vertices()[internal].id))})).ok());
  const Vec3 was = editor.mesh().position(internal);
  ASSERT_TRUE(editor.run("translate", {{"by", Vec3(0.1, 0, 0)}}).ok());
  EXPECT_EQ(editor.mesh().position(internal), Vec3(was + Vec3(0.1, 0, 0)));
  EXPECT_TRUE(editor.mesh().vertices()[internal].pinned);
}

TEST(Editor, SymmetryActsOnBothSides) {
  Editor editor(gridScene(4, 2));
  ASSERT_TRUE(editor.run("symmetry").ok());
  EXPECT_TRUE(editor.state().mirrorNormal.isApprox(Vec3::UnitX()));
  ASSERT_TRUE(editor.run("select", ids("faces", {0, 2})).ok());
  ASSERT_TRUE(editor.run("extrude", {{"distance", 1.0}}).ok());
  EXPECT_EQ(editor.mesh().bundles()[0].height(), 3u);
  EXPECT_EQ(editor.mesh().bundles()[3].height(), 3u);
  EXPECT_EQ(editor.mesh().bundles()[1].height(), 2u);
  ASSERT_TRUE(editor.run("select", ids("faces", {0, 3})).ok());
  ASSERT_TRUE(editor.run("translate", {{"by", Vec3(-1, 0, 0)}}).ok());
  const auto mirror = findMirror(editor.mesh(), editor.state().mirrorPoint, Vec3::UnitX(), 1e-6).value();
  EXPECT_TRUE(mirror.complete());
  for (std::uint32_t v = 0; v < editor.mesh().vertices().size(); ++v) {
    const Vec3 image = mirror.image(editor.mesh().position(v));
    EXPECT_LT((image - editor.mesh().position(mirror.vertexPartner[v])).norm(), 1e-12);
  }
}

TEST(Editor, SymmetricOperationsActOnBothSides) {
  Editor editor(gridScene(4, 2));
  ASSERT_TRUE(editor.run("symmetry").ok());
  const auto vertex = [&](double x, double y, std::uint32_t layer) {
    for (const HairVertex& v : editor.mesh().vertices()) {
      if (v.layer == layer && v.position.isApprox(Vec3(x, y, layer), 1e-9))
        return double(std::uint32_t(v.id));
    }
    return -1.0;
  };
  const auto complete = [&] {
    return findMirror(editor.mesh(), editor.state().mirrorPoint, Vec3::UnitX(), 1e-6).value().complete();
  };
  ASSERT_TRUE(editor.run("select", ids("vertices", {vertex(1, 2, 2)})).ok());
  ASSERT_TRUE(editor.run("separate_vertices").ok());
  EXPECT_TRUE(complete());
  EXPECT_EQ(editor.state().selection.vertices.size(), 9u)
      << "three a side, and one each where its edges end: at the middle and at both borders";
  ASSERT_TRUE(editor.run("undo").ok());
  ASSERT_TRUE(editor.run("select", ids("vertices", {vertex(0, 0, 0), vertex(1, 1, 0)})).ok());
  ASSERT_TRUE(editor.run("divide_face").ok());
  EXPECT_TRUE(complete());
  EXPECT_EQ(editor.mesh().bundles().size(), 18u);
  ASSERT_TRUE(editor.run("undo").ok());
  const std::size_t before = editor.mesh().vertices().size();
  ASSERT_TRUE(editor.run("select", ids("edges", {1, 1, 1})).ok());
  ASSERT_TRUE(editor.run("separate_edges").ok());
  ASSERT_TRUE(editor.run("select", ids("edges", {1, 2, 1, 2, 2, 3})).ok());
  ASSERT_TRUE(editor.run("weld_edges").ok()) << "on the plane: its own partner, joined once";
  EXPECT_EQ(editor.mesh().vertices().size(), before);
  ASSERT_TRUE(editor.run("select", ids("faces", {0, 2})).ok());
  ASSERT_TRUE(editor.run("extrude", {{"layers", 3.0}, {"bend", 0.5}}).ok());
  EXPECT_TRUE(complete());
}

TEST(Editor, ACurveIsFollowedOnBothSides) {
  Editor editor(gridScene(4, 2));
  ASSERT_TRUE(editor.run("symmetry", {{"on", true}, {"point", Vec3(2, 0, 0)}}).ok());
  const std::vector<double> curve{0.5, 0, 2, 0, 0, 3, -1, 1, 3.5};
  const CommandArguments along{{"layers", 3.0}, {"curve", curve}};
  for (const auto& faces : {std::vector<double>{0, 2}, std::vector<double>{0, 2, 3, 2},
                            std::vector<double>{1, 2}, std::vector<double>{5, 2, 6, 2}}) {
    ASSERT_TRUE(editor.run("select", ids("faces", faces)).ok());
    ASSERT_TRUE(editor.run("extrude", along).ok());
    const Mirror mirror = findMirror(editor.mesh(), Vec3(2, 0, 0), Vec3::UnitX(), 1e-6).value();
    EXPECT_TRUE(mirror.complete());
    for (std::uint32_t v = 0; v < editor.mesh().vertices().size(); ++v) {
      const Vec3 partner = editor.mesh().position(mirror.vertexPartner[v]);
      // Coordinates below ten, a few roundings each.
      EXPECT_LT((mirror.image(editor.mesh().position(v)) - partner).norm(), 1e-13);
    }
    // The side that was drawn on goes where the line leads: x ends 1.5 lower than it began.
    const Bundle& bundle = editor.mesh().bundles()[0];
    if (bundle.height() == 5 && editor.mesh().bundles()[1].height() == 2) {
      Vec3 root = Vec3::Zero(), tip = Vec3::Zero();
      for (std::uint32_t c = 0; c < 4; ++c) {
        root += 0.25 * editor.mesh().position(bundle.face(2)[c]);
        tip += 0.25 * editor.mesh().position(bundle.face(5)[c]);
      }
      EXPECT_NEAR(tip.x() - root.x(), -1.5, 1e-12);
      EXPECT_NEAR(tip.z() - root.z(), 1.5, 1e-12);
    }
    ASSERT_TRUE(editor.run("undo").ok());
  }
}

TEST(Editor, ABrushStrokeIsOneStepAndPlaysBack) {
  Editor editor(gridScene(4, 3));
  const auto before = editor.canonicalState();
  const CommandArguments stroke{{"kind", std::string("comb")},
                                {"path", std::vector<double>{0, 2, 3, 2, 2, 3, 4, 2, 3}},
                                {"radius", 1.5}};
  ASSERT_TRUE(editor.run("brush", stroke).ok());
  EXPECT_EQ(editor.undoCount(), 1u);
  EXPECT_EQ(editor.pythonLog(),
            "editor.brush(kind=\"comb\", path=[0, 2, 3, 2, 2, 3, 4, 2, 3], radius=1.5)\n");
  ASSERT_TRUE(editor.run("undo").ok());
  EXPECT_EQ(editor.canonicalState(), before);
  // Only the selection, and nothing frozen.
  ASSERT_TRUE(editor.run("select_layer", {{"layer", 3.0}}).ok());
  ASSERT_TRUE(editor.run("freeze").ok());
  CommandArguments selected = stroke;
  selected["selected"] = true;
  ASSERT_TRUE(editor.run("brush", selected).ok());
  EXPECT_EQ(editor.undoCount(), 2u) << "all that is selected is frozen: nothing moved";
}

TEST(Editor, AStrokeSeenPointByPointIsTheStrokeThatIsDone) {
  // What a tool asks for while it is dragged, kept from one attempt to the next, against an editor that is
  // asked once.
  PolygonMesh floor;
  floor.positions = {{-9, -9, 1.5}, {9, -9, 1.5}, {9, 9, 1.5}, {-9, 9, 1.5}};
  floor.addFace(std::vector<std::uint32_t>{0, 1, 2, 3});
  const Surface head(floor);
  Editor dragged(gridScene(4, 3));
  dragged.setHead(&head);
  ASSERT_TRUE(dragged.run("select_layer", {{"layer", 2.0}}).ok());
  for (const char* kind : {"comb", "push", "twist", "comb"}) {  // the second stroke of a kind begins anew
    Editor once(dragged.scene());
    once.setHead(&head);
    ASSERT_TRUE(once.run("select_layer", {{"layer", 2.0}}).ok());
    CommandArguments stroke{{"kind", std::string(kind)}, {"radius", 1.5}, {"strength", 0.9}};
    std::vector<double> path;
    for (int i = 0; i < 12; ++i) {
      for (double x : {0.3 * i, 2 + 0.1 * i, 3 - 0.1 * i}) path.push_back(x);
      stroke["path"] = path;
      const auto seen = dragged.attempt("brush", stroke);
      ASSERT_TRUE(seen.ok());
      if (i == 5 || i == 11) {
        EXPECT_TRUE(*seen == once.attempt("brush", stroke).value()) << kind;
      }
    }
    ASSERT_TRUE(once.run("brush", stroke).ok());
    ASSERT_TRUE(dragged.run("brush", stroke).ok());
    EXPECT_TRUE(dragged.mesh() == once.mesh()) << kind;
  }
}

TEST(Editor, SnapsToTheGridTheScalpAndTheNextVertex) {
  Editor editor(gridScene(2, 1));
  const double id = double(std::uint32_t(editor.mesh().vertices().back().id));
  ASSERT_TRUE(editor.run("select", ids("vertices", {id})).ok());
  ASSERT_TRUE(editor.run("translate", {{"by", Vec3(0.13, -0.07, 0.26)}}).ok());
  EXPECT_FALSE(editor.run("snap", {{"to", std::string("scalp")}}).ok()) << "no head";
  ASSERT_TRUE(editor.run("snap", {{"step", 0.25}}).ok());
  EXPECT_TRUE(editor.mesh().vertices().back().position.isApprox(Vec3(2.25, 2, 1.25), 1e-12));
  ASSERT_TRUE(editor.run("snap", {{"to", std::string("vertex")}}).ok());
  EXPECT_EQ(editor.mesh().vertices().back().position, Vec3(2, 1, 1)) << "the nearest that is not selected";
  PolygonMesh floor;
  floor.positions = {{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}};
  floor.addFace(std::vector<std::uint32_t>{0, 1, 2, 3});
  const Surface head(floor);
  editor.setHead(&head);
  ASSERT_TRUE(editor.run("snap", {{"to", std::string("scalp")}}).ok());
  EXPECT_TRUE(editor.mesh().vertices().back().position.isApprox(Vec3(2, 1, -1), 1e-12));
}

TEST(Editor, WhatIsHiddenIsSelectedByItsIdAlone) {
  Editor editor(gridScene(3, 1));
  ASSERT_TRUE(editor.run("select", ids("faces", {0, 1})).ok());
  ASSERT_TRUE(editor.run("hide").ok());
  ASSERT_TRUE(editor.run("select_all", {{"kind", std::string("face")}}).ok());
  EXPECT_EQ(editor.state().selection.faces.size(), 16u);
  ASSERT_TRUE(editor.run("select_all").ok());
  EXPECT_EQ(editor.state().selection.vertices.size(), 30u)
      << "the grid's corner is the hidden bundle's alone";
  ASSERT_TRUE(editor.run("select_invert").ok());
  EXPECT_TRUE(editor.state().selection.empty());
  ASSERT_TRUE(editor.run("select", ids("faces", {0, 1})).ok());
  EXPECT_EQ(editor.state().selection.faces.size(), 1u);
}

TEST(Editor, LightsAreTheDocuments) {
  Editor editor(gridScene(2, 1));
  ASSERT_TRUE(
      editor.run("set_light", {{"azimuth", 90.0}, {"elevation", 0.0}, {"key", 2.0}, {"sky", 0.0}}).ok());
  const Lights standard, lights = lightsOf(editor.scene().look.light, UpAxis::Y);
  EXPECT_TRUE(lights.key.direction.isApprox(Vec3::UnitX())) << "from the right";
  EXPECT_TRUE(lights.key.color.isApprox(2 * standard.key.color));
  EXPECT_TRUE(lights.skyColor.isZero(0));
  EXPECT_EQ(lights.rim.color, standard.rim.color);
  // About a head whose up is z, the front is −y.
  ASSERT_TRUE(editor.run("set_light", {{"azimuth", 0.0}, {"elevation", 0.0}, {"follow_camera", false}}).ok());
  EXPECT_TRUE(lightsOf(editor.scene().look.light, UpAxis::Z).key.direction.isApprox(-Vec3::UnitY()));
  ASSERT_TRUE(editor.run("undo").ok());
  ASSERT_TRUE(editor.run("undo").ok());
  EXPECT_EQ(editor.scene().look.light, LightSettings{});
  EXPECT_FALSE(editor.run("set_light", {{"fill", -1.0}}).ok());
}

TEST(Selection, WholeBundlesLayersAndGroups) {
  HairMesh mesh = gridScene(3, 2).hairMesh;
  mesh.setGroup(0, mesh.addGroup("fringe")), mesh.setGroup(8, 1);
  const Selection one{{}, {}, {{BundleId(0), 2}}};
  EXPECT_EQ(widened(mesh, one, SelectKind::Face), one);
  EXPECT_EQ(widened(mesh, one, SelectKind::Bundle).faces.size(), 3u);
  EXPECT_EQ(widened(mesh, one, SelectKind::Layer).faces.size(), 9u);
  EXPECT_EQ(widened(mesh, one, SelectKind::Group).faces.size(), 6u);
}

TEST(Selection, LoopsAndRingsOfAGrid) {
  const HairMesh mesh = gridScene(4, 1).hairMesh;
  // Bundle 5 is the quad at (1, 1); side 0 is its lower edge from (1, 1) to (2, 1).
  const EdgeRef edge{BundleId(5), 1, 0};
  const auto loop = edgeLoop(mesh, edge);
  EXPECT_EQ(loop.size(), 4u) << "the row of edges at y = 1 on layer 1";
  const auto ring = edgeRing(mesh, edge);
  EXPECT_EQ(ring.size(), 5u) << "the five edges from x = 1 to 2";
  for (const EdgeRef& e : loop) EXPECT_EQ(e.layer, 1u);
  const Selection one{{}, {edge}, {}};
  EXPECT_EQ(grown(mesh, {{}, {}, {{BundleId(5), 1}}}).faces.size(), 9u);
  EXPECT_EQ(shrunk(mesh, grown(mesh, {{}, {}, {{BundleId(5), 1}}})).faces.size(), 4u)
      << "a block of 3 × 3 in the grid's corner keeps the 2 × 2 with no unselected neighbour";
  EXPECT_EQ(linked(mesh, one).edges.size(), 40u) << "2 · 4 · 5 edges on the layer";
  EXPECT_EQ(columns(mesh, {{}, {}, {{BundleId(5), 1}}}).faces.size(), 2u);
}

TEST(Selection, InvertTwiceIsTheSame) {
  const HairMesh mesh = gridScene(3, 2).hairMesh;
  Selection some = allOf(mesh, SelectKind::Edge, 1);
  EXPECT_EQ(inverted(mesh, inverted(mesh, some, SelectKind::Edge), SelectKind::Edge), some);
}

TEST(Commands, HaveUniqueNamesKeysAndHelp) {
  std::set<std::string> names, keys;
  for (const CommandInfo& info : commandInfos()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(info.menu.empty()) << info.name << " is in no menu";
    EXPECT_FALSE(info.help.empty()) << info.name;
    EXPECT_TRUE(info.key.empty() || keys.insert(info.key).second) << info.name << " shares " << info.key;
    for (const CommandArgument& argument : info.arguments) EXPECT_FALSE(argument.help.empty()) << info.name;
  }
  EXPECT_GE(names.size(), 40u);
}

TEST(Commands, WithoutAKeyHaveAnotherWayIn) {
  // Lists that the mouse fills in, and settings that a panel shows.
  const std::set<std::string> keyless{"select",       "displace",  "brush",         "set_strands",
                                      "set_look",     "set_light", "set_dynamics",  "add_operator",
                                      "set_operator", "set_ramp",  "move_operator", "rename_operator",
                                      "paint_mask"};
  for (const CommandInfo& info : commandInfos()) {
    EXPECT_EQ(info.key.empty(), keyless.contains(info.name)) << info.name;
  }
}

TEST(Commands, PythonLinesReadBackAsTheSameNumbers) {
  EXPECT_EQ(pythonLine("extrude", {{"distance", 0.1}}), "editor.extrude(distance=0.1)");
  EXPECT_EQ(pythonLine("translate", {{"by", Vec3(1, 0.5, -2)}, {"radius", 1.0 / 3}}),
            "editor.translate(by=(1, 0.5, -2), radius=0.3333333333333333)");
  EXPECT_EQ(pythonLine("set_group", {{"name", std::string("a\"b\\\n")}}),
            "editor.set_group(name=\"a\\\"b\\\\\\x0a\")");
  EXPECT_EQ(pythonLine("symmetry", {{"on", false}}), "editor.symmetry(on=False)");
}

/// A random argument within its range; lists of ids are drawn from the mesh.
CommandArguments randomArguments(const CommandInfo& info, const Editor& editor, const CounterRandom& random) {
  const HairMesh& mesh = editor.mesh();
  const StyleStack& styles = editor.state().styles;
  CommandArguments out;
  std::uint64_t draw = 0;
  for (const CommandArgument& argument : info.arguments) {
    const double u = random.uniform(draw++);
    if (argument.kind == ArgumentKind::Number && argument.name != "about_pivot") {
      const double least = std::max(argument.least, -0.3), most = std::min(argument.most, 0.3);
      out[argument.name] = least + u * (std::max(most, least) - least);
    } else if (argument.name == "operator" && !styles.empty()) {
      out[argument.name] = styles[random.below(draw++, std::uint32_t(styles.size()))].name;
    } else if (argument.name == "points" && argument.kind == ArgumentKind::Numbers) {
      out[argument.name] = std::vector<double>{0, u, 0.5 + 0.5 * u, 1 - u};
    } else if (argument.name == "vertices" && info.name == "set_mask" && u < 0.8) {
      out[argument.name] = std::vector<double>{double(std::uint32_t(mesh.vertices()[0].id))};
      out["values"] = std::vector<double>{random.uniform(draw++)};
    } else if (argument.name == "parameter") {
      const char* names[] = {"amount", "enabled", "seed", "count", "radius"};
      out[argument.name] = std::string(names[random.below(draw++, 5)]);
    } else if (argument.name == "name" && info.menu == "Style") {
      out[argument.name] = std::string(1, char('a' + random.below(draw++, 26)));
    } else if (argument.kind == ArgumentKind::Choice) {
      out[argument.name] = argument.choices[random.below(draw++, std::uint32_t(argument.choices.size()))];
    } else if (argument.kind == ArgumentKind::Vector && argument.name != "normal" &&
               argument.name != "color") {
      const double v = random.uniform(draw++), w = random.uniform(draw++);
      out[argument.name] = Vec3(u - 0.5, v - 0.5, w + 0.1);
    } else if (argument.kind == ArgumentKind::Integer && argument.name == "layer") {
      out[argument.name] = double(random.below(draw++, 4));
    } else if (argument.name == "layers") {
      out[argument.name] = double(1 + random.below(draw++, 2));
    } else if (argument.name == "path" || (argument.name == "curve" && u < 0.2)) {
      std::vector<double> line;
      for (int i = 0; i < 9; ++i) line.push_back(3 * random.uniform(draw++));
      out[argument.name] = line;
    } else if (argument.kind == ArgumentKind::Numbers && info.name == "select") {
      const Bundle& bundle = mesh.bundles()[random.below(draw++, std::uint32_t(mesh.bundles().size()))];
      const double id = double(std::uint32_t(bundle.id)), layer = u < 0.6 ? bundle.height() : 0;
      const std::uint32_t corner = random.below(draw++, bundle.corners);
      if (argument.name == "faces" && u < 0.7) out[argument.name] = std::vector<double>{id, layer};
      if (argument.name == "edges" && u < 0.3)
        out[argument.name] = std::vector<double>{id, layer, double(corner)};
      if (argument.name == "vertices" && u < 0.3) {
        const auto vertex = mesh.vertices()[bundle.face(std::uint32_t(layer))[corner]].id;
        out[argument.name] = std::vector<double>{double(std::uint32_t(vertex))};
      }
    }
  }
  return out;
}

class RandomCommands : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomCommands, KeepEveryInvariantAndUndoToTheFirstByte) {
  Editor editor(GetParam() % 2 ? gridScene(3, 2) : test::sampleScene());
  const auto infos = commandInfos();
  const auto start = editor.canonicalState();
  std::size_t done = 0, refused = 0;
  std::set<std::string> succeeded;
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const CounterRandom random(GetParam(), k);
    // Half of the draws choose something, so that the rest has something to act on.
    const CommandInfo& info = random.uniform(90) < 0.5 ? *findCommand("select")
                                                       : infos[random.below(91, std::uint32_t(infos.size()))];
    if (editor.mesh().bundles().size() > 120 && (info.name == "subdivide" || info.name == "divide_edges"))
      continue;
    if (editor.mesh().bundles().size() < 4 && info.name == "delete") continue;
    const auto before = editor.canonicalState();
    const Status status = editor.run(info.name, randomArguments(info, editor, random.child(k)));
    if (!status.ok()) {
      ++refused;
      EXPECT_FALSE(status.error().message.empty());
      ASSERT_EQ(editor.canonicalState(), before) << info.name << " was refused and changed something";
    } else {
      ++done;
      succeeded.insert(info.name);
    }
    const auto faults = checkInvariants(editor.mesh());
    ASSERT_TRUE(faults.empty()) << info.name << ": " << faults.front().message;
    ASSERT_EQ(keepValid(editor.mesh(), editor.state().selection), editor.state().selection) << info.name;
  }
  EXPECT_GT(done, 400u);
  EXPECT_GE(succeeded.size(), 25u);
  // Undo and redo are among the commands drawn, so the end is not step 1000.
  const auto end = editor.canonicalState();
  while (editor.redoCount() > 0) ASSERT_TRUE(editor.run("redo").ok());
  const auto last = editor.canonicalState();
  while (editor.undoCount() > 0) ASSERT_TRUE(editor.run("undo").ok());
  EXPECT_EQ(editor.canonicalState(), start);
  while (editor.redoCount() > 0) ASSERT_TRUE(editor.run("redo").ok());
  EXPECT_EQ(editor.canonicalState(), last);
  RecordProperty("done", int(done));
  RecordProperty("refused", int(refused));
  std::printf("%zu done, %zu refused, %zu commands seen to succeed\n", done, refused, succeeded.size());
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomCommands, testing::Values(1, 2, 3));

}  // namespace
}  // namespace coif

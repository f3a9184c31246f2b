// Styles in the document, the stage graph and the editor.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "coif/scene/editor.h"
#include "coif/scene/evaluate.h"
#include "coif/style/style_kinds.h"
#include "scene/sample_scene.h"

namespace coif {
namespace {

using nlohmann::json;

StyleOperator made(const char* kind) {
  return makeStyleOperator(kind).value();
}

/// Every kind, each told something, with ramps, masks and groups.
Scene styledScene() {
  Scene scene = test::sampleScene();
  scene.strands.count = 300;
  for (const StyleKind& kind : styleKinds()) {
    StyleOperator op = made(kind.name.c_str());
    for (const StyleParameter& p : kind.parameters)
      op.parameters[p.name] = p.kind == ParameterKind::Number ? p.usual : p.most;
    if (op.parameters.contains("count")) op.parameters["count"] = 20;
    op.amount = 0.5, op.seed = 77;
    op.ramp = {{{0, 0}, {0.5, 0.25}, {1, 1}}, RampShape::Linear};
    op.mask = {{scene.hairMesh.vertices()[1].id, 0.125}};
    op.group = "fringe";
    scene.styles.push_back(op);
  }
  return scene;
}

Evaluation withoutHead(std::set<std::string> force = {}) {
  EvaluateOptions options;
  options.useHead = false;
  options.force = std::move(force);
  return Evaluation(options);
}

const StageReport& lastReport(const Evaluation& evaluation, const std::string& stage) {
  for (auto report = evaluation.reports().rbegin(); report != evaluation.reports().rend(); ++report) {
    if (report->name == stage) return *report;
  }
  throw std::runtime_error("no report of " + stage);
}

TEST(StyleFile, RoundTripIsExact) {
  const Scene scene = styledScene();
  const auto again = parseScene(sceneText(scene), "styled.coif");
  ASSERT_TRUE(again.ok()) << again.error().text();
  EXPECT_EQ(again->styles, scene.styles);
  EXPECT_EQ(sceneText(*again), sceneText(scene));
}

TEST(StyleFile, OlderVersionsHaveNoStyle) {
  for (const char* name : {"version_1.coif", "version_2.coif"}) {
    const auto scene = loadScene(std::filesystem::path(COIF_SOURCE_DIR) / "tests/scene/files" / name);
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_TRUE(scene->styles.empty());
    EXPECT_EQ(scene->hairMesh.bundles().size(), 4u);
  }
}

TEST(StyleFile, VersionThreeStillOpens) {
  const auto scene = loadScene(std::filesystem::path(COIF_SOURCE_DIR) / "tests/scene/files/version_3.coif");
  ASSERT_TRUE(scene.ok()) << scene.error().text();
  ASSERT_EQ(scene->styles.size(), 2u);
  EXPECT_EQ(scene->styles[0].kind, "clump");
  EXPECT_EQ(parameterOf(scene->styles[1], "radius"), 0.8);
  EXPECT_EQ(parameterOf(scene->styles[1], "hand"), 1);
}

TEST(StyleFile, RefusesWhatIsNoStyleWithItsPath) {
  const std::string good = sceneText(styledScene());
  const auto refused = [&](const std::function<void(json&)>& spoil, const std::string& place) {
    json document = json::parse(good);
    spoil(document["styles"]);
    const auto scene = parseScene(document.dump(), "spoilt.coif");
    ASSERT_FALSE(scene.ok()) << place;
    EXPECT_EQ(scene.error().code, ErrorCode::Malformed);
    EXPECT_EQ(scene.error().place, place) << scene.error().text();
  };
  refused([](json& s) { s = 3; }, "styles");
  refused([](json& s) { s[1] = "curl"; }, "styles");
  refused([](json& s) { s[1].erase("kind"); }, "styles[1].kind");
  refused([](json& s) { s[1]["kind"] = "perm"; }, "styles[1].kind");
  refused([](json& s) { s[1]["name"] = s[0]["name"]; }, "styles[1].name");
  refused([](json& s) { s[1]["amount"] = 2; }, "styles[1].amount");
  refused([](json& s) { s[0]["parameters"]["radius"] = -1; }, "styles[0].parameters.radius");
  refused([](json& s) { s[0]["parameters"]["hand"] = "up"; }, "styles[0].parameters.hand");
  refused([](json& s) { s[0]["parameters"]["bounce"] = 1; }, "styles[0].parameters.bounce");
  refused([](json& s) { s[2]["ramp"]["shape"] = "round"; }, "styles[2].ramp.shape");
  refused([](json& s) { s[2]["ramp"]["points"] = "f64:"; }, "styles[2].ramp");
  refused([](json& s) { s[3]["mask"]["values"] = "f64:"; }, "styles[3].mask.values");
}

TEST(StyleStage, RunsIsReusedAndIsLeftOut) {
  Scene scene = test::sampleScene();
  scene.strands.count = 200;
  Evaluation evaluation = withoutHead();
  const StrandSet plain = **evaluation.strands(scene);
  EXPECT_EQ(lastReport(evaluation, "style").state, StageState::Skipped);
  EXPECT_EQ(evaluation.stylePlan(), nullptr);

  scene.styles = {made("clump"), made("wave")};
  const StrandSet styled = **evaluation.strands(scene);
  EXPECT_EQ(lastReport(evaluation, "strands").state, StageState::Reused);
  EXPECT_EQ(lastReport(evaluation, "style").state, StageState::Ran);
  EXPECT_NE(styled.points, plain.points);
  EXPECT_EQ((*evaluation.grownStrands(scene))->points, plain.points);
  ASSERT_NE(evaluation.stylePlan(), nullptr);

  EXPECT_EQ((*evaluation.strands(scene))->points, styled.points);
  EXPECT_EQ(lastReport(evaluation, "style").state, StageState::Reused);

  for (StyleOperator& op : scene.styles) op.amount = 0;
  EXPECT_EQ((*evaluation.strands(scene))->points, plain.points);
  EXPECT_EQ(lastReport(evaluation, "style").state, StageState::Skipped);
  EXPECT_EQ(lastReport(evaluation, "style").notes[1], "Wave: left out, its amount is 0");

  Evaluation forced = withoutHead({"style"});
  ASSERT_TRUE(forced.strands(scene).ok());
  EXPECT_EQ(lastReport(forced, "style").state, StageState::Ran);

  scene.styles[0].parameters["count"] = 0;
  const auto refused = evaluation.strands(scene);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().place, "styles[0].parameters.count");
}

TEST(StyleStage, HairInMotionKeepsItsStyle) {
  Scene scene = test::sampleScene();
  scene.strands.count = 200;
  scene.upAxis = UpAxis::Z;
  scene.styles = {made("curl")};
  scene.dynamics.collide = false;
  Evaluation evaluation = withoutHead();
  const StrandSet still = **evaluation.strands(scene);
  SimulateOptions what;
  what.frames = 3;
  what.motion.poses = {RigidPose{},
                       {Mat3::Identity(), Vec3(0.5, 0, 0)},
                       {Eigen::AngleAxisd(0.5, Vec3::UnitZ()).toRotationMatrix(), Vec3(0.5, 0, 0)}};
  const DynamicsCache motion = **evaluation.simulate(scene, what);
  const StrandSet first = evaluation.strandsAt(scene, motion, 0).value();
  // The cache keeps positions in floats; curls turn by 2π/3.5 times what an arc of 3 loses by that.
  for (std::size_t p = 0; p < still.points.size(); ++p)
    ASSERT_LT((first.points[p] - still.points[p]).norm(), 1e-4f);
  const StrandSet last = evaluation.strandsAt(scene, motion, 2).value();
  scene.styles.clear();
  const StrandSet bare = evaluation.strandsAt(scene, motion, 2).value();
  double offset = 0, offsetStill = 0;
  const StrandSet plain = **evaluation.strands(scene);
  for (std::size_t p = 0; p < bare.points.size(); ++p) {
    offset += double((last.points[p] - bare.points[p]).norm());
    offsetStill += double((still.points[p] - plain.points[p]).norm());
  }
  EXPECT_NEAR(offset / offsetStill, 1, 1e-3) << "curls keep their size while the head moves";
  // Adaptive points have no fixed number, so motion makes its own plan.
  scene.styles = {made("curl")};
  scene.strands.tolerance = 0.01;
  ASSERT_TRUE(evaluation.strands(scene).ok());
  EXPECT_EQ(evaluation.strandsAt(scene, motion, 2).value().points, last.points);
}

using Numbers = std::vector<double>;

TEST(StyleCommands, MakeAStackThatPlaysBack) {
  Editor editor(test::sampleScene());
  const auto start = editor.canonicalState();
  const auto run = [&](const char* command, const CommandArguments& arguments) {
    const Status status = editor.run(command, arguments);
    EXPECT_TRUE(status.ok()) << command << ": " << (status.ok() ? "" : status.error().text());
  };
  const auto name = [](const char* text) { return CommandValue(std::string(text)); };
  run("add_operator", {{"kind", name("curl")}});
  run("add_operator", {{"kind", name("curl")}});
  run("add_operator", {{"kind", name("clump")}, {"at", 0.0}, {"name", name("Locks")}});
  run("set_operator", {{"operator", name("Curl")}, {"parameter", name("radius")}, {"value", 0.25}});
  run("set_operator", {{"operator", name("Curl")}, {"parameter", name("hand")}, {"text", name("left")}});
  run("set_operator", {{"operator", name("Curl")}, {"parameter", name("group")}, {"text", name("fringe")}});
  run("set_operator", {{"operator", name("Curl 2")}, {"parameter", name("enabled")}, {"value", 0.0}});
  run("set_operator", {{"operator", name("Locks")}, {"parameter", name("amount")}, {"value", 0.5}});
  run("set_ramp",
      {{"operator", name("Locks")}, {"points", Numbers{0, 0, 1, 0.5}}, {"shape", name("linear")}});
  run("rename_operator", {{"operator", name("Curl 2")}, {"name", name("Coils")}});
  run("move_operator", {{"operator", name("Coils")}, {"to", 0.0}});
  const double root = double(std::uint32_t(editor.mesh().vertices()[0].id));
  run("set_mask", {{"operator", name("Locks")}, {"vertices", Numbers{root}}, {"values", Numbers{0.5}}});
  const StyleStack& stack = editor.scene().styles;
  ASSERT_EQ(stack.size(), 3u);
  EXPECT_EQ(stack[0].name, "Coils");
  EXPECT_FALSE(stack[0].enabled);
  EXPECT_NE(stack[0].seed, stack[2].seed) << "the second of a kind is another throw";
  EXPECT_EQ(stack[1].name, "Locks");
  EXPECT_EQ(stack[1].amount, 0.5);
  EXPECT_EQ(stack[1].ramp, (Ramp{{{0, 0}, {1, 0.5}}, RampShape::Linear}));
  EXPECT_EQ(maskOf(stack[1].mask, editor.mesh())[0], 0.5);
  EXPECT_EQ(parameterOf(stack[2], "radius"), 0.25);
  EXPECT_EQ(parameterOf(stack[2], "hand"), 1);
  EXPECT_EQ(stack[2].group, "fringe");
  EXPECT_NE(
      editor.pythonLog().find("editor.set_operator(operator=\"Curl\", parameter=\"radius\", value=0.25)\n"),
      std::string::npos);
  run("remove_operator", {{"operator", name("Locks")}});
  EXPECT_EQ(editor.undoCount(), 13u);
  while (editor.undoCount() > 0) ASSERT_TRUE(editor.run("undo").ok());
  EXPECT_EQ(editor.canonicalState(), start);
}

TEST(StyleCommands, RefuseWithASentence) {
  Editor editor(test::sampleScene());
  const auto name = [](const char* text) { return CommandValue(std::string(text)); };
  ASSERT_TRUE(editor.run("add_operator", {{"kind", name("curl")}}).ok());
  ASSERT_TRUE(editor.run("add_operator", {{"kind", name("clump")}}).ok());
  const auto before = editor.canonicalState();
  const auto refused = [&](const char* command, CommandArguments arguments, const char* part) {
    const Status status = editor.run(command, arguments);
    ASSERT_FALSE(status.ok()) << command;
    EXPECT_NE(status.error().message.find(part), std::string::npos) << status.error().message;
  };
  refused("add_operator", {{"kind", name("perm")}}, "curl");
  refused("remove_operator", {{"operator", name("Wave")}}, "there are 'Curl', 'Clump'");
  refused("rename_operator", {{"operator", name("Curl")}, {"name", name("Clump")}}, "another operator");
  refused("set_operator", {{"operator", name("Curl")}, {"parameter", name("bounce")}}, "it has radius");
  refused("set_operator", {{"operator", name("Curl")}, {"parameter", name("radius")}, {"value", -1.0}},
          "from 0");
  refused("set_operator", {{"operator", name("Curl")}, {"parameter", name("amount")}, {"value", 2.0}},
          "0 to 1");
  refused("set_operator", {{"operator", name("Curl")}, {"parameter", name("group")}, {"text", name("x")}},
          "group");
  refused("set_ramp", {{"operator", name("Curl")}, {"points", Numbers{0.5, 1, 0.2, 1}}}, "ascend");
  refused("set_mask", {{"operator", name("Curl")}, {"vertices", Numbers{1e9}}, {"values", Numbers{1}}},
          "root layer");
  refused("paint_mask", {{"operator", name("Curl")}}, "point");
  EXPECT_EQ(editor.canonicalState(), before);
}

TEST(StyleCommands, PaintingChangesRootsUnderTheBrush) {
  Editor editor(test::sampleScene());  // roots at (0 … 2, 0 … 2, 0)
  const auto name = [](const char* text) { return CommandValue(std::string(text)); };
  ASSERT_TRUE(editor.run("add_operator", {{"kind", name("frizz")}}).ok());
  const CommandArguments stroke{
      {"operator", name("Frizz")}, {"path", Numbers{0, 0, 0, 2, 0, 0}}, {"radius", 1.5}, {"value", 0.0},
      {"strength", 0.5},           {"falloff", name("linear")}};
  ASSERT_TRUE(editor.run("paint_mask", stroke).ok());
  const auto masks = [&] { return maskOf(editor.state().styles[0].mask, editor.mesh()); };
  for (std::uint32_t v = 0; v < 9; ++v) {
    const double y = editor.mesh().position(v).y(), left = std::max(0.0, 1 - y / 1.5);
    EXPECT_NEAR(masks()[v], 1 - 0.5 * left, 1e-12) << v;
  }
}

TEST(StyleCommands, AnOperatorWithWavesGetsItsPoints) {
  Editor editor(test::sampleScene());
  const auto name = [](const char* text) { return CommandValue(std::string(text)); };
  ASSERT_TRUE(editor.run("set_strands", {{"points", 8.0}}).ok());
  ASSERT_TRUE(editor.run("add_operator", {{"kind", name("curl")}}).ok());
  const std::uint32_t wanted = pointsWanted(editor.scene().styles, editor.mesh(), 0.01);
  EXPECT_GT(wanted, 8u);
  EXPECT_EQ(editor.scene().strands.points, wanted);
  ASSERT_TRUE(editor.run("undo").ok());
  EXPECT_EQ(editor.scene().strands.points, 8u);
  ASSERT_TRUE(editor.run("add_operator", {{"kind", name("curl")}, {"fit_points", false}}).ok());
  EXPECT_EQ(editor.scene().strands.points, 8u);
  ASSERT_TRUE(editor.run("fit_points").ok());
  EXPECT_EQ(editor.scene().strands.points, wanted);
}

}  // namespace
}  // namespace coif

// coif render: pictures of a scene.
#include "command.h"

#ifdef COIF_WITH_PREVIEW
#include <filesystem>

#include "coif/io/can_write.h"
#include "coif/io/safe_file.h"
#include "coif/light/path_tracer.h"
#include "coif/preview/session.h"
#include "coif/scene/evaluate.h"
#include "coif/scene/seen_from_head.h"
#include "render_frames.h"
#include "render_options.h"
#include "scene_options.h"
#include "values.h"

namespace coif::cli {

namespace {

struct Arguments {
  RenderArguments render;
  FrameArguments frames;
  DynamicsArguments dynamics;
  StrandArguments strands;
  EvaluateArguments evaluate;
};

/// Frames the hair and the face below it, not a whole body. Hair fills no corner of its box, so the box is
/// drawn in.
Box framed(const StrandSet* strands, const HairMesh& mesh, UpAxis upAxis) {
  std::vector<Vec3> points;
  for (const HairVertex& vertex : mesh.vertices()) {
    if (vertex.layer == 0) points.push_back(vertex.position);
  }
  const Box scalp = bounds(points);
  Vec3 chin = scalp.lo;
  const int up = upAxis == UpAxis::Y ? 1 : 2;
  chin[up] -= 0.6 * (scalp.hi[up] - scalp.lo[up]);
  points.push_back(chin);
  if (strands) {
    for (const Vec3f& point : strands->points) points.push_back(point.cast<double>());
  }
  for (const HairVertex& vertex : mesh.vertices()) points.push_back(vertex.position);
  Box box = bounds(points);
  const Vec3 inset = 0.04 * (box.hi - box.lo);
  box.lo += inset, box.hi -= inset;
  return box;
}

/// What is in the picture, evaluated once for all of its views.
struct Subject {
  const StrandSet* strands = nullptr;
  const HairMesh* mesh = nullptr;
  const PolygonMesh* head = nullptr;
  std::optional<Ground> ground;
  bool styled = false;
};

Result<Subject> subjectOf(const Scene& scene, const RenderArguments& arguments, Evaluation& evaluation,
                          const Context& context) {
  Subject subject;
  if (!arguments.noStrands) {
    COIF_ASSIGN(subject.strands, evaluation.strands(scene, context));
    subject.styled = evaluation.stylePlan() != nullptr;
  }
  COIF_ASSIGN(subject.mesh, evaluation.placedMesh(scene, context));
  COIF_ASSIGN(const Surface* head, evaluation.head(scene, context));
  if (head) subject.head = &head->mesh();
  if (head && !arguments.noGround && !arguments.transparent)
    subject.ground = groundUnder(*subject.head, scene.upAxis);
  if (subject.ground && subject.strands) {  // hair longer than the bust ends above the ground, not in it
    const int up = scene.upAxis == UpAxis::Y ? 1 : 2;
    double& height = subject.ground->point[up];
    for (const Vec3f& point : subject.strands->points) height = std::min(height, double(point[up]));
  }
  return subject;
}

Status write(const std::string& path, const Image& image, const FloatImage& linear) {
  const bool exr = extensionOf(path) == ".exr";
  COIF_ASSIGN(const auto bytes, exr ? encodeExr(linear) : encodePng(image));
  COIF_ASSIGN(auto file, SafeFile::create(path));
  file.write(bytes);
  return file.commit();
}

using Json = nlohmann::ordered_json;

/// One view after the other, on a session that keeps what did not change.
class PreviewRenderer {
 public:
  static Result<PreviewRenderer> create(const Subject& subject, const Scene& scene,
                                        const RenderArguments& arguments, const Context& context) {
    COIF_ASSIGN(Preview preview, Preview::create());
    PreviewRenderer made(std::move(preview));
    // Points that grow() made on this mesh are made again on the GPU; anything else comes as it is.
    made.grown_ = subject.strands && scene.strands.tolerance <= 0 && !subject.styled;
    if (made.grown_) {
      COIF_TRY(made.session_.setHair(*subject.mesh, *subject.strands, scene.strands.knots,
                                     scene.strands.points, context));
    } else if (subject.strands) {
      COIF_TRY(made.session_.setStrands(*subject.strands, context));
    }
    if (subject.head) COIF_TRY(made.session_.setHead(*subject.head));
    COIF_TRY(made.session_.setGround(subject.ground));
    made.hairMesh_ = arguments.hairMesh;
    if (arguments.hairMesh) made.session_.setOverlay(*subject.mesh);
    made.session_.setLights(arguments.lights(scene));
    made.options_ = arguments.previewOptions(scene);
    return made;
  }

  /// The hair mesh on a frame, in the head's frame, ground and lights as they are there; strands follow on
  /// the GPU.
  Status move(const HairMesh& mesh, const std::optional<Ground>& ground, const Lights& lights,
              const Context& context) {
    session_.setLights(lights);
    COIF_TRY(session_.setGround(ground));
    std::vector<Vec3> positions;
    for (const HairVertex& vertex : mesh.vertices()) positions.push_back(vertex.position);
    if (hairMesh_) session_.setOverlay(mesh);
    return grown_ ? session_.moveHair(positions, context) : Status();
  }

  /// Everything anew, where it is in the scene: a frame of hair that follows no mesh by itself.
  Status show(const Subject& seen, const Context& context) {
    if (seen.strands) COIF_TRY(session_.setStrands(*seen.strands, context));
    return seen.head ? session_.setHead(*seen.head) : Status();
  }

  Result<Json> render(const Camera& camera, const std::string& path, const Context& context,
                      Session& session) {
    session_.setCamera(camera);
    COIF_ASSIGN(const Picture picture, session_.render(options_, context));
    COIF_TRY(write(path, picture.image, toLinear(picture.image)));
    session.say("wrote " + path + " with " + preview_.renderer());
    for (const std::string& note : picture.notes) session.say("  " + note);
    stages.insert(stages.end(), picture.stages.begin(), picture.stages.end());
    return Json{{"picture", path},
                {"renderer", preview_.renderer()},
                {"seconds", picture.seconds},
                {"strandsDrawn", picture.strandsDrawn},
                {"segmentsDrawn", picture.segmentsDrawn},
                {"widthScale", picture.widthScale},
                {"notes", picture.notes}};
  }

  std::vector<StageReport> stages;

 private:
  explicit PreviewRenderer(Preview preview) : preview_(std::move(preview)), session_(preview_) {}
  Preview preview_;
  PreviewSession session_;
  PreviewOptions options_;
  bool grown_ = false, hairMesh_ = false;
};

/// What the path tracer did, and which lights it never asks for: lights are drawn by their brightness.
void explainTracing(const Lights& lights, const PathTracePicture& picture, std::vector<StageReport>& stages) {
  StageReport traced{"path tracing", StageState::Ran, "every picture is traced anew", picture.seconds};
  traced.notes = picture.notes;
  stages.push_back(std::move(traced));
  const auto left = [&](const char* name, const Vec3f& color) {
    if (color.isZero(0))
      stages.push_back({name, StageState::Skipped, "it has no colour: no ray is sent to it (--light, look)"});
  };
  left("key light", lights.key.color);
  left("fill light", lights.fill.color);
  left("rim light", lights.rim.color);
}

Result<Json> tracePicture(const Subject& subject, const Scene& scene, const RenderArguments& arguments,
                          const Camera& camera, const std::string& path, const Context& context,
                          Session& session, std::vector<StageReport>& stages) {
  PathTraceScene traced;
  traced.strands = subject.strands;
  traced.head = subject.head;
  traced.ground = subject.ground;
  traced.camera = camera;
  traced.lights = arguments.lights(scene);
  traced.fibre = arguments.fibre(scene);
  PathTraceOptions options;
  options.width = arguments.width(), options.height = arguments.height();
  options.samplesPerPixel = arguments.samplesPerPixel;
  options.targetError = arguments.targetError;
  options.seed = scene.strands.seed;
  COIF_ASSIGN(const PathTracePicture picture, pathTrace(traced, options, context));
  explainTracing(traced.lights, picture, stages);
  const PreviewOptions look = arguments.previewOptions(scene);
  const FloatImage seen = arguments.transparent
                              ? picture.image
                              : overBackdrop(picture.image, look.backgroundTop, look.backgroundBottom);
  COIF_TRY(write(path, toSrgb(seen), seen));
  char error[96];
  std::snprintf(error, sizeof error, ": %d samples a pixel, relative error of a pixel %.3g",
                picture.samplesPerPixel, picture.relativeError);
  session.say("wrote " + path + error);
  for (const std::string& note : picture.notes) session.say("  " + note);
  const auto list = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
  return Json{{"picture", path},
              {"renderer", "path tracer"},
              {"seconds", picture.seconds},
              {"samplesPerPixel", picture.samplesPerPixel},
              {"rays", picture.rays},
              {"mean", list(picture.mean)},
              {"confidence95", list(picture.confidence95)},
              {"relativeError", picture.relativeError},
              {"notes", picture.notes}};
}

Status render(const Arguments& all, Session& session) {
  const RenderArguments& arguments = all.render;
  COIF_ASSIGN(Scene scene, loadScene(arguments.scene));
  COIF_TRY(canWrite(arguments.output));
  COIF_TRY(all.evaluate.canTell());
  all.strands.apply(scene);
  COIF_TRY(all.dynamics.apply(scene));
  if (all.frames.asked())
    scene.strands.tolerance = 0;  // strands that move have the same points on every frame
  Evaluation evaluation(all.evaluate.options());
  const Context context = session.context();
  COIF_ASSIGN(Subject subject, subjectOf(scene, arguments, evaluation, context));
  const Box box = framed(subject.strands, *subject.mesh, scene.upAxis);
  const CameraAngles from = cameraAngles(arguments, scene);
  const auto cameraAt = [&](double turnDeg) {
    return frameBox(box, scene.upAxis, from.azimuthDeg + turnDeg, from.elevationDeg,
                    double(arguments.width()) / arguments.height());
  };
  if (subject.ground && (cameraAt(0).eye - subject.ground->point).dot(subject.ground->normal) <= 0) {
    subject.ground.reset();  // it would hide all else
    session.say("  the ground is left out: the camera is below it");
  }
  std::optional<PreviewRenderer> preview;
  if (!arguments.pathTraced()) {
    COIF_ASSIGN(PreviewRenderer made, PreviewRenderer::create(subject, scene, arguments, context));
    preview.emplace(std::move(made));
  }
  std::vector<StageReport> tracing;
  const auto picture = [&](const Subject& seen, const Camera& camera, const std::string& path) {
    return preview ? preview->render(camera, path, context, session)
                   : tracePicture(seen, scene, arguments, camera, path, context, session, tracing);
  };
  // The GPU's hair moves in the head's frame, where its roots stand still; styled hair, hair in wisps and the
  // path tracer's in the scene's.
  const auto frame = [&](const DynamicsCache& motion, std::size_t f,
                         const std::string& path) -> Result<Json> {
    const RigidPose& pose = motion.poses[f];
    if (preview && !subject.styled && scene.dynamics.wisps == 0) {
      COIF_ASSIGN(const HairMesh moved, evaluation.meshAt(scene, motion, f, context));
      std::optional<Ground> ground;
      if (subject.ground) ground = groundFromHead(*subject.ground, pose);
      COIF_TRY(preview->move(moved, ground, lightsFromHead(arguments.lights(scene), pose), context));
      return picture(subject, cameraFromHead(cameraAt(0), pose), path);
    }
    Subject seen = subject;
    StrandSet strands;
    std::optional<PolygonMesh> head;
    if (subject.strands) {
      COIF_ASSIGN(strands, evaluation.strandsAt(scene, motion, f, context));
      seen.strands = &strands;
    }
    if (subject.head) seen.head = &head.emplace(headInWorld(*subject.head, pose));
    if (preview) COIF_TRY(preview->show(seen, context));
    return picture(seen, cameraAt(0), path);
  };
  Json results = Json::array();
  std::vector<StageReport> stages;
  if (all.frames.asked()) {
    COIF_ASSIGN(const DynamicsCache motion, all.frames.load(scene, evaluation, context));
    stages = evaluation.reports();
    for (std::size_t f = all.frames.first(); f < all.frames.end(motion); ++f) {
      const std::string path = numberedPath(arguments.output, int(f + 1));
      COIF_ASSIGN(Json result, frame(motion, f, path));
      results.push_back(std::move(result));
    }
  } else {
    const int pictures = std::max(arguments.turntable, 1);
    for (int k = 0; k < pictures; ++k) {
      const std::string path =
          arguments.turntable > 1 ? numberedPath(arguments.output, k + 1) : arguments.output;
      COIF_ASSIGN(Json result, picture(subject, cameraAt(360.0 * k / pictures), path));
      results.push_back(std::move(result));
    }
    stages = evaluation.reports();
  }
  if (preview) stages.insert(stages.end(), preview->stages.begin(), preview->stages.end());
  stages.insert(stages.end(), tracing.begin(), tracing.end());
  COIF_TRY(all.evaluate.tell(stages, session));
  const bool several = arguments.turntable > 0 || all.frames.asked();
  session.finish(several ? Json{{"pictures", results}} : results.front());
  return {};
}

}  // namespace

void addRender(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("render", "Make pictures of a scene");
  command->footer(
      "Example:\n  coif render bob.coif -o bob.png --size 1024x1024 --camera 30,8 --hair brown\n"
      "  coif render bob.coif -o truth.exr --shading path-traced --spp 256\n"
      "  coif render bob.coif -o turn.png --turntable 36\n"
      "  coif render long.coif -o sway.png --motion long.coifcache --frames 1-48\n");
  arguments->frames.addTo(*command, arguments->render.addTo(*command));
  arguments->dynamics.addTo(*command);
  arguments->strands.addTo(*command);
  arguments->evaluate.addTo(*command);
  command->callback([arguments, &session] {
    if (const Status status = render(*arguments, session); !status.ok()) session.fail(status.error());
  });
}

}  // namespace coif::cli

#else

namespace coif::cli {

void addRender(CLI::App& app, Session& session) {
  CLI::App* command = app.add_subcommand("render", "Make a picture of a scene (left out of this build)");
  command->allow_extras();
  command->callback(
      [&session] { session.usage("this Coif was built without the preview room, so it cannot render"); });
}

}  // namespace coif::cli

#endif

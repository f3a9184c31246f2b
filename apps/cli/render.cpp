// coif render: pictures of a scene.
#include "command.h"

#ifdef COIF_WITH_PREVIEW
#include <filesystem>

#include "coif/io/safe_file.h"
#include "coif/light/path_tracer.h"
#include "coif/preview/session.h"
#include "coif/scene/evaluate.h"
#include "render_options.h"
#include "scene_options.h"

namespace coif::cli {

namespace {

struct Arguments {
  RenderArguments render;
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
};

Result<Subject> subjectOf(const Scene& scene, const RenderArguments& arguments, Evaluation& evaluation,
                          const Context& context) {
  Subject subject;
  if (!arguments.noStrands) {
    COIF_ASSIGN(subject.strands, evaluation.strands(scene, context));
  }
  COIF_ASSIGN(subject.mesh, evaluation.placedMesh(scene, context));
  COIF_ASSIGN(const Surface* head, evaluation.head(scene, context));
  if (head) subject.head = &head->mesh();
  return subject;
}

Status write(const std::string& path, const Image& image, const FloatImage& linear) {
  const bool exr = std::filesystem::path(path).extension() == ".exr";
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
    if (subject.strands && scene.strands.tolerance <= 0) {
      COIF_TRY(made.session_.setHair(*subject.mesh, *subject.strands, scene.strands.knots,
                                     scene.strands.points, context));
    } else if (subject.strands) {
      COIF_TRY(made.session_.setStrands(*subject.strands, context));
    }
    if (subject.head) COIF_TRY(made.session_.setHead(*subject.head));
    if (arguments.hairMesh) made.session_.setOverlay(*subject.mesh);
    made.session_.setLights(arguments.lights());
    made.options_ = arguments.previewOptions(scene);
    return made;
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
};

Result<Json> tracePicture(const Subject& subject, const Scene& scene, const RenderArguments& arguments,
                          const Camera& camera, const std::string& path, const Context& context,
                          Session& session) {
  PathTraceScene traced;
  traced.strands = subject.strands;
  traced.head = subject.head;
  traced.camera = camera;
  traced.lights = arguments.lights();
  traced.fibre = arguments.fibre(scene);
  PathTraceOptions options;
  options.width = arguments.width(), options.height = arguments.height();
  options.samplesPerPixel = arguments.samplesPerPixel;
  options.targetError = arguments.targetError;
  options.seed = scene.strands.seed;
  COIF_ASSIGN(const PathTracePicture picture, pathTrace(traced, options, context));
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
  all.strands.apply(scene);
  Evaluation evaluation(all.evaluate.options());
  const Context context = session.context();
  COIF_ASSIGN(const Subject subject, subjectOf(scene, arguments, evaluation, context));
  std::optional<PreviewRenderer> preview;
  if (!arguments.pathTraced()) {
    COIF_ASSIGN(PreviewRenderer made, PreviewRenderer::create(subject, scene, arguments, context));
    preview.emplace(std::move(made));
  }
  const Box box = framed(subject.strands, *subject.mesh, scene.upAxis);
  const CameraAngles from = cameraAngles(arguments, scene);
  const int pictures = std::max(arguments.turntable, 1);
  Json results = Json::array();
  for (int k = 0; k < pictures; ++k) {
    const Camera camera = frameBox(box, scene.upAxis, from.azimuthDeg + 360.0 * k / pictures,
                                   from.elevationDeg, double(arguments.width()) / arguments.height());
    const std::string path = numberedPath(arguments.output, k + 1, arguments.turntable);
    COIF_ASSIGN(Json result, preview
                                 ? preview->render(camera, path, context, session)
                                 : tracePicture(subject, scene, arguments, camera, path, context, session));
    results.push_back(std::move(result));
  }
  std::vector<StageReport> stages = evaluation.reports();
  if (preview) stages.insert(stages.end(), preview->stages.begin(), preview->stages.end());
  COIF_TRY(all.evaluate.tell(stages, session));
  session.finish(arguments.turntable > 0 ? Json{{"pictures", results}} : results.front());
  return {};
}

}  // namespace

void addRender(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("render", "Make pictures of a scene");
  command->footer(
      "Example:\n  coif render bob.coif -o bob.png --size 1024x1024 --camera 30,8 --hair brown\n"
      "  coif render bob.coif -o truth.exr --shading path-traced --spp 256\n"
      "  coif render bob.coif -o turn.png --turntable 36\n");
  arguments->render.addTo(*command);
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

// The light room: cameras, lights, float pictures, the path tracer.
#include "bind_light.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "coif/light/hair_color.h"
#include "coif/light/path_tracer.h"

namespace coif::python {

using namespace nb::literals;

const PolygonMesh& meshOf(const Head& head) {
  const auto* scalp = std::get_if<ScalpModel>(&head);
  return scalp ? scalp->surface->mesh() : std::get<PolygonMesh>(head);
}

const PolygonMesh* meshOf(const std::optional<Head>& head) {
  return head ? &meshOf(*head) : nullptr;
}

Box contentBox(const StrandSet* strands, const PolygonMesh* head, const HairMesh* hairMesh) {
  Box box;
  bool any = false;
  const auto extend = [&](const Vec3& p) {
    if (!p.allFinite()) return;
    box.lo = any ? Vec3(box.lo.cwiseMin(p)) : p;
    box.hi = any ? Vec3(box.hi.cwiseMax(p)) : p;
    any = true;
  };
  if (strands) {
    for (const Vec3f& p : strands->points) extend(p.cast<double>());
  }
  if (head) {
    for (const Vec3& p : head->positions) extend(p);
  }
  if (hairMesh) {
    for (const HairVertex& v : hairMesh->vertices()) extend(v.position);
  }
  return box;
}

namespace {

void bindCamera(nb::module_& m) {
  nb::class_<Camera>(m, "Camera", "A pinhole camera in scene units.")
      .def(
          "__init__",
          [](Camera* self, const ArrayLike& eye, const ArrayLike& target, const ArrayLike& up, double fov) {
            new (self) Camera{toVec3(eye, "eye"), toVec3(target, "target"), toVec3(up, "up"), fov};
          },
          "eye"_a, "target"_a, "up"_a = nb::make_tuple(0, 1, 0), "fov"_a = 30.0,
          "From `eye` towards `target` (3 floats each); fov: vertical angle of view in degrees.")
      .def_static(
          "frame",
          [](const ArrayLike& lo, const ArrayLike& hi, double azimuth, double elevation, double aspect,
             UpAxis upAxis) {
            return frameBox({toVec3(lo, "lo"), toVec3(hi, "hi")}, upAxis, azimuth, elevation, aspect);
          },
          "lo"_a, "hi"_a, "azimuth"_a = 30.0, "elevation"_a = 8.0, "aspect"_a = 1.0, "up_axis"_a = UpAxis::Y,
          "A camera that sees the whole box lo … hi. azimuth (degrees): 0 looks at the front, positive moves "
          "to +x.")
      .def_prop_ro(
          "eye", [](const Camera& c) { return own(c.eye); }, nb::rv_policy::reference, "Where it stands.")
      .def_prop_ro(
          "target", [](const Camera& c) { return own(c.target); }, nb::rv_policy::reference,
          "Where it looks.")
      .def_ro("fov", &Camera::fovDeg, "Vertical angle of view in degrees.");
}

// ---- lights
// --------------------------------------------------------------------------------------------------

nb::tuple lightTuple(const Light& light) {
  return nb::make_tuple(own(light.direction), own(light.color.cast<double>()));
}
Light toLight(const ArrayLike& direction, const ArrayLike& color) {
  return {toVec3(direction, "direction"), toVec3(color, "color").cast<float>()};
}

void bindLights(nb::module_& m) {
  nb::class_<Lights> lights(
      m, "Lights",
      "Key, fill and rim, the light of the surroundings, and what is added. Colours are linear RGB.\n\n"
      "A distant light's colour is radiance times solid angle: a white diffuse surface facing it reflects "
      "color / pi.\nWith follow_camera, directions are (right, up, towards the eye).");
  lights.def(nb::init<>(), "Three-point light under a sky.")
      .def_static(
          "dark",
          [] {
            Lights dark;
            for (Light* light : {&dark.key, &dark.fill, &dark.rim}) light->color = Vec3f::Zero();
            dark.skyColor = dark.groundColor = Vec3f::Zero();
            dark.followCamera = false;
            return dark;
          },
          "No light, in the scene's frame: add what is wanted.")
      .def_rw("follow_camera", &Lights::followCamera, "Whether directions turn with the camera.")
      .def(
          "add_distant",
          [](Lights& l, const ArrayLike& direction, const ArrayLike& color) {
            l.more.push_back(toLight(direction, color));
          },
          "direction"_a, "color"_a = nb::make_tuple(1, 1, 1),
          "A further light from far away; `direction` points to it.")
      .def(
          "add_point",
          [](Lights& l, const ArrayLike& position, const ArrayLike& color) {
            l.points.push_back({toVec3(position, "position"), toVec3(color, "color").cast<float>()});
          },
          "position"_a, "color"_a = nb::make_tuple(1, 1, 1),
          "A light at a place of the scene: a white diffuse surface facing it at distance d reflects "
          "color / (pi d**2).")
      .def(
          "set_surroundings",
          [](Lights& l, const ArrayLike& picture) {
            l.surroundings = std::make_shared<const FloatImage>(toPicture(picture, "picture"));
          },
          "picture"_a,
          "Radiance around the scene instead of sky and ground: height×width×3 or ×4, linear, latitude and "
          "longitude, the\ntop row up, the middle column behind the camera (or the scene's front).");
  const auto distant = [&](const char* name, Light Lights::*light) {
    lights.def_prop_rw(
        name, [light](const Lights& l) { return lightTuple(l.*light); },
        [light](Lights& l, std::pair<ArrayLike, ArrayLike> value) {
          l.*light = toLight(value.first, value.second);
        },
        "(direction to the light, colour).");
  };
  distant("key", &Lights::key);
  distant("fill", &Lights::fill);
  distant("rim", &Lights::rim);
  const auto color = [&](const char* name, Vec3f Lights::*at, const char* doc) {
    lights.def_prop_rw(
        name, [at](const Lights& l) { return own((l.*at).cast<double>()); },
        [at](Lights& l, const ArrayLike& value) { l.*at = toVec3(value, "color").cast<float>(); },
        nb::for_getter(nb::rv_policy::reference), doc);
  };
  color("sky", &Lights::skyColor, "Radiance from above the horizon.");
  color("ground", &Lights::groundColor, "Radiance from below it.");
}

// ---- path tracing
// --------------------------------------------------------------------------------------------

// An array inside the picture, which it keeps alive.
FloatRgba viewOf(nb::handle self, FloatImage& image) {
  return FloatRgba(image.rgba.data(), {std::size_t(image.height), std::size_t(image.width), 4}, self);
}

void bindPicture(nb::module_& m) {
  nb::class_<PathTracePicture>(m, "PathTracedPicture", "What path_trace() returns.")
      .def_prop_ro(
          "image", [](nb::object self) { return viewOf(self, nb::cast<PathTracePicture&>(self).image); },
          nb::rv_policy::reference,
          "height×width×4 float32, rows from the top: linear RGB radiance, and alpha, with which RGB is "
          "multiplied.")
      .def_prop_ro(
          "standard_error",
          [](nb::object self) { return viewOf(self, nb::cast<PathTracePicture&>(self).standardError); },
          nb::rv_policy::reference, "height×width×4 float32: the standard error of each value of `image`.")
      .def_prop_ro(
          "mean", [](const PathTracePicture& p) { return own(p.mean); }, nb::rv_policy::reference,
          "Mean of the picture's linear RGB.")
      .def_prop_ro(
          "confidence95", [](const PathTracePicture& p) { return own(p.confidence95); },
          nb::rv_policy::reference, "The mean lies within ± this with a probability of 95 %.")
      .def_ro("samples", &PathTracePicture::samplesPerPixel, "Samples taken for each pixel.")
      .def_ro("relative_error", &PathTracePicture::relativeError,
              "Root mean square of the pixels' standard error of luminance, over the mean luminance.")
      .def_ro("rays", &PathTracePicture::rays, "Rays followed.")
      .def_ro("shadow_rays", &PathTracePicture::shadowRays, "Rays to lights.")
      .def_ro("truncated_paths", &PathTracePicture::truncatedPaths, "Paths that max_bounces ended.")
      .def_ro("strands_dropped", &PathTracePicture::strandsDropped,
              "Strands left out: values that are not finite, or no length.")
      .def_ro("seconds", &PathTracePicture::seconds, "Wall-clock time.")
      .def_ro("notes", &PathTracePicture::notes, "What to know of the picture, a sentence each.");
}

struct TracedHair {
  std::optional<ArrayLike> color, absorption;
  double roughness, azimuthalRoughness, index, tiltDeg;
  FibreModel model;
};

FibreParameters fibreOf(const TracedHair& hair) {
  FibreParameters fibre;
  fibre.model = hair.model;
  fibre.index = hair.index;
  fibre.longitudinalRoughness = hair.roughness;
  fibre.azimuthalRoughness = hair.azimuthalRoughness;
  fibre.tiltRad = hair.tiltDeg * 3.14159265358979323846 / 180;
  if (hair.color && hair.absorption) {
    throw nb::value_error("path_trace: hair_color and absorption say the same thing: give one");
  }
  if (hair.absorption) fibre.absorption = toVec3(*hair.absorption, "absorption");
  if (hair.color)
    fibre.absorption = absorptionFromAlbedo(toVec3(*hair.color, "hair_color"), hair.azimuthalRoughness);
  return fibre;
}

PathTracePicture tracePicture(const Strands* strands, const std::optional<Head>& head,
                              std::tuple<int, int> size, double azimuth, double elevation,
                              std::optional<Camera> camera, const std::optional<Lights>& lights, int samples,
                              double targetError, std::optional<ArrayLike> hairColor,
                              std::optional<ArrayLike> absorption, double roughness,
                              double azimuthalRoughness, double index, double tilt, FibreModel model,
                              bool strandColors, const ArrayLike& headColor,
                              std::optional<double> groundHeight, int maxBounces, std::uint64_t seed,
                              bool showSurroundings, int threads, nb::object progress) {
  PathTraceScene scene;
  if (strands) scene.strands = &strands->set;
  scene.head = meshOf(head);
  if (!scene.strands && !scene.head)
    throw nb::value_error("path_trace: nothing to show: give strands or head");
  const UpAxis up = scene.strands ? scene.strands->upAxis : scene.head->upAxis;
  PathTraceOptions options;
  std::tie(options.width, options.height) = size;
  scene.camera = camera ? *camera
                        : frameBox(contentBox(scene.strands, scene.head, nullptr), up, azimuth, elevation,
                                   double(options.width) / double(std::max(options.height, 1)));
  if (lights) scene.lights = *lights;
  scene.fibre = fibreOf({hairColor, absorption, roughness, azimuthalRoughness, index, tilt, model});
  scene.useStrandColors = strandColors;
  scene.headColor = toVec3(headColor, "head_color").cast<float>();
  if (groundHeight) {
    const Vec3 normal = up == UpAxis::Y ? Vec3::UnitY() : Vec3::UnitZ();
    scene.ground = Ground{*groundHeight * normal, normal};
  }
  options.samplesPerPixel = samples;
  options.targetError = targetError;
  options.maxBounces = maxBounces;
  options.seed = seed;
  options.showSurroundings = showSurroundings;
  return Run(threads,
             std::move(progress))([&](const Context& context) { return pathTrace(scene, options, context); });
}

void bindPathTracer(nb::module_& m) {
  bindPicture(m);
  nb::enum_<FibreModel>(m, "FibreModel", "How one hair scatters light.")
      .value("KAJIYA_KAY", FibreModel::KajiyaKay, "Kajiya and Kay 1989")
      .value("MARSCHNER", FibreModel::Marschner, "Marschner et al. 2003")
      .value("CHIANG", FibreModel::Chiang, "Chiang et al. 2016, energy conserving");
  const PathTraceScene scene;
  const PathTraceOptions options;
  const FibreParameters fibre;
  m.def(
      "path_trace", &tracePicture, "strands"_a.none() = nb::none(), "head"_a.none() = nb::none(),
      nb::kw_only(), "size"_a = nb::make_tuple(512, 512), "azimuth"_a = 30.0, "elevation"_a = 8.0,
      "camera"_a.none() = nb::none(), "lights"_a.none() = nb::none(), "samples"_a = options.samplesPerPixel,
      "target_error"_a = 0.0, "hair_color"_a.none() = nb::none(), "absorption"_a.none() = nb::none(),
      "roughness"_a = fibre.longitudinalRoughness, "azimuthal_roughness"_a = fibre.azimuthalRoughness,
      "index"_a = fibre.index, "tilt"_a = 2.0, "model"_a = fibre.model, "strand_colors"_a = false,
      "head_color"_a = nb::make_tuple(scene.headColor.x(), scene.headColor.y(), scene.headColor.z()),
      "ground"_a.none() = nb::none(), "max_bounces"_a = options.maxBounces, "seed"_a = options.seed,
      "show_surroundings"_a = false, "threads"_a = 0, "progress"_a.none() = nb::none(),
      "The true picture of strands and a head (Scalp or PolygonMesh): every way of the light between the "
      "hairs, "
      "at random.\n\n"
      "Returns a PathTracedPicture: `image` is height×width×4 float32 linear light, with its "
      "`standard_error`; "
      "`size` is\n"
      "(width, height). Without a camera everything given is framed from azimuth and elevation in degrees.\n"
      "samples: for each pixel, 2 to 2**20, the most if target_error > 0: then it stops when relative_error "
      "is at\nor below that. hair_color: linear RGB of dense hair; or absorption: per fibre radius, linear "
      "RGB; "
      "strand_colors:\nthe strands' own. roughness and azimuthal_roughness in [0, 1], tilt of the scales in "
      "degrees. ground: height of a\ndiffuse floor. lights: a Lights. Same bytes for any `threads` (0: "
      "all).\n"
      "Raises ValueError for values outside their range, Error where Coif was built without Embree. Source: "
      "Chiang et al.\n2016 for the fibre; Veach 1997.");
}

}  // namespace

void bindLight(nb::module_& m) {
  bindCamera(m);
  bindLights(m);
  bindPathTracer(m);
  bindPictures(m);
}

}  // namespace coif::python

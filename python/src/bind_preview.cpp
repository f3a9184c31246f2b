// The preview room: pictures as NumPy arrays.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bind_light.h"
#include "coif/preview/names.h"
#include "coif/preview/session.h"

namespace coif::python {

using namespace nb::literals;

namespace {

/// How a picture is made, by the words of `coif render`.
struct Method {
  std::string shading, visibility, transparency;
  int layers = 7;

  void apply(PreviewOptions& options) const {
    take(setShading(options, shading));
    take(setVisibility(options, visibility));
    take(setTransparency(options, transparency));
    options.visibility.layers = layers;
  }
};

struct View {
  const Strands* strands = nullptr;
  const std::optional<Head>* head = nullptr;
  const HairMeshModel* hairMesh = nullptr;
  std::optional<Camera> camera;
  bool ground = false;
  double azimuth = 30, elevation = 8;
};

ByteRgba renderWith(Preview& preview, const View& view, const PreviewOptions& options) {
  PreviewScene scene;
  if (view.strands) scene.strands = &view.strands->set;
  scene.head = meshOf(*view.head);
  std::optional<HairMesh> mesh;
  if (view.hairMesh) scene.hairMesh = &mesh.emplace(view.hairMesh->mesh());
  if (!scene.strands && !scene.head && !scene.hairMesh) {
    throw nb::value_error("render: nothing to show: give strands, head or hair_mesh");
  }
  const UpAxis up = scene.strands ? scene.strands->upAxis
                    : scene.head  ? scene.head->upAxis
                                  : view.hairMesh->upAxis;
  if (view.ground && scene.head) scene.ground = groundUnder(*scene.head, up);
  scene.camera = view.camera
                     ? *view.camera
                     : frameBox(contentBox(scene.strands, scene.head, scene.hairMesh), up, view.azimuth,
                                view.elevation, double(options.width) / double(std::max(options.height, 1)));
  Picture picture =
      Run(0, nb::none())([&](const Context& context) { return preview.render(scene, options, context); });
  return arrayOf(std::move(picture.image));
}

ByteRgba render(const Strands* strands, const std::optional<Head>& head, const HairMeshModel* hairMesh,
                std::tuple<int, int> size, double azimuth, double elevation, std::optional<Camera> camera,
                const ArrayLike& hairColor, std::optional<ArrayLike> background, bool transparent,
                bool shadows, bool lod, int subframes, std::string shading, std::string visibility,
                int layers, std::string transparency, bool ground, Preview* preview) {
  PreviewOptions options;
  std::tie(options.width, options.height) = size;
  options.hairColor = toVec3(hairColor, "hair_color").cast<float>();
  if (background) {
    options.backgroundTop = options.backgroundBottom = toVec3(*background, "background").cast<float>();
  }
  options.transparentBackground = transparent;
  options.shadows = shadows;
  options.lod = lod;
  options.subframes = subframes;
  Method{shading, visibility, transparency, layers}.apply(options);
  const View view{strands, &head, hairMesh, camera, ground, azimuth, elevation};
  if (preview) return renderWith(*preview, view, options);
  Preview own = take(Preview::create());
  return renderWith(own, view, options);
}

nb::dict uploadedOf(const PreviewUpload& bytes) {
  nb::dict out;
  out["strands"] = bytes.strands;
  out["hair_mesh"] = bytes.hairMesh;
  out["head"] = bytes.head;
  out["plan"] = bytes.plan;
  out["frame"] = bytes.frame;
  return out;
}

/// A session with what the last picture said of itself.
struct Session {
  PreviewSession session;
  PreviewUpload uploaded;
  std::vector<StageReport> stages;
};

ByteRgba renderSession(Session& self, std::tuple<int, int> size, const ArrayLike& hairColor, bool transparent,
                       bool shadows, bool lod, double strandFraction, int subframes, std::string shading,
                       std::string visibility, int layers, std::string transparency) {
  PreviewOptions options;
  std::tie(options.width, options.height) = size;
  options.hairColor = toVec3(hairColor, "hair_color").cast<float>();
  options.transparentBackground = transparent;
  options.shadows = shadows;
  options.lod = lod;
  options.strandFraction = strandFraction;
  options.subframes = subframes;
  Method{shading, visibility, transparency, layers}.apply(options);
  Picture picture =
      Run(0, nb::none())([&](const Context& context) { return self.session.render(options, context); });
  self.uploaded = picture.uploaded;
  self.stages = std::move(picture.stages);
  return arrayOf(std::move(picture.image));
}

void bindSession(nb::module_& m) {
  const PreviewOptions defaults;
  nb::class_<Session>(
      m, "PreviewSession",
      "A picture again and again: keeps on the GPU what did not change. Moving the hair mesh uploads "
      "the mesh alone.")
      .def(
          "__init__",
          [](Session* self, const Preview& preview) {
            new (self) Session{PreviewSession(preview), {}, {}};
          },
          "preview"_a, "Shares the Preview's OpenGL context; use both from one thread at a time.")
      .def(
          "set_hair",
          [](Session& self, const HairMeshModel& mesh, const Strands& strands, Knots knots,
             std::uint32_t points) { take(self.session.setHair(mesh.mesh(), strands.set, knots, points)); },
          "hair_mesh"_a, "strands"_a, "knots"_a = Knots::Uniform, "points"_a = 0,
          "Hair that coif.grow() made on this mesh with these knots; its points are made on the GPU from now "
          "on, at "
          "most `points` a strand (0: as many as it has). Raises ValueError for strands that do not say "
          "where they "
          "grow.")
      .def(
          "set_strands",
          [](Session& self, const Strands& strands) { take(self.session.setStrands(strands.set)); },
          "strands"_a, "Strands as they are.")
      .def(
          "move_hair",
          [](Session& self, const ArrayLike& positions) {
            const auto points = toPoints(positions, "positions");
            take(self.session.moveHair(points));
          },
          "positions"_a,
          "New positions (V×3) for the vertices of set_hair's mesh, in the order of its vertex_ids.")
      .def(
          "set_head", [](Session& self, const Head& head) { take(self.session.setHead(meshOf(head))); },
          "head"_a, "A Scalp or PolygonMesh.")
      .def(
          "set_camera", [](Session& self, const Camera& camera) { self.session.setCamera(camera); },
          "camera"_a, "Uploads no strand data.")
      .def("render", &renderSession, nb::kw_only(), "size"_a = nb::make_tuple(1024, 1024),
           "hair_color"_a =
               nb::make_tuple(defaults.hairColor.x(), defaults.hairColor.y(), defaults.hairColor.z()),
           "transparent"_a = false, "shadows"_a = true, "lod"_a = true, "strand_fraction"_a = 0.0,
           "subframes"_a = defaults.subframes, "shading"_a = "studio", "visibility"_a = "deep-opacity",
           "layers"_a = defaults.visibility.layers, "transparency"_a = "auto",
           "The picture: height×width×4 uint8, sRGB with straight alpha, rows from the top. strand_fraction: "
           "part of "
           "the strands to draw, 0: by their width on the screen. shading, visibility, layers, transparency: "
           "as in coif.render.")
      .def_prop_ro(
          "uploaded", [](const Session& self) { return uploadedOf(self.uploaded); },
          "Bytes that the last picture sent to the GPU, by kind.")
      .def_prop_ro(
          "stages",
          [](const Session& self) {
            std::vector<std::tuple<std::string, std::string, std::string>> out;
            for (const StageReport& stage : self.stages)
              out.emplace_back(stage.name, name(stage.state), stage.reason);
            return out;
          },
          "What the last picture did: (stage, ran, reused or skipped, why).");
}

}  // namespace

void bindPreview(nb::module_& m) {
  const PreviewOptions defaults;
  nb::class_<Preview>(
      m, "Preview",
      "An OpenGL context without a window, for several pictures. Use it from one thread at a time.")
      .def(
          "__init__", [](Preview* self) { new (self) Preview(take(Preview::create())); },
          "Raises Error where there is neither a GPU nor Mesa's software renderer.")
      .def_prop_ro("renderer", &Preview::renderer, "The driver's name for itself.")
      .def_prop_ro("software", &Preview::software, "Whether the CPU draws.");
  bindSession(m);
  m.def(
      "render", &render, "strands"_a.none() = nb::none(), "head"_a.none() = nb::none(),
      "hair_mesh"_a.none() = nb::none(), nb::kw_only(), "size"_a = nb::make_tuple(1024, 1024),
      "azimuth"_a = 30.0, "elevation"_a = 8.0, "camera"_a.none() = nb::none(),
      "hair_color"_a = nb::make_tuple(defaults.hairColor.x(), defaults.hairColor.y(), defaults.hairColor.z()),
      "background"_a.none() = nb::none(), "transparent"_a = false, "shadows"_a = true, "lod"_a = true,
      "subframes"_a = defaults.subframes, "shading"_a = "studio", "visibility"_a = "deep-opacity",
      "layers"_a = defaults.visibility.layers, "transparency"_a = "auto", "ground"_a = false,
      "preview"_a.none() = nb::none(),
      "A picture of strands, a head (Scalp or PolygonMesh) and a hair mesh (drawn over it): height×width×4 "
      "uint8.\n\n"
      "sRGB with straight alpha, rows from the top; `size` is (width, height). Without a camera everything "
      "given is\n"
      "framed from `azimuth` and `elevation` in degrees (0, 0 looks at the face). hair_color: linear RGB "
      "where the\n"
      "strands have none; background: one linear RGB instead of the gradient. lod: fewer, wider strands "
      "where no one could tell. subframes: 1 to 64, four "
      "samples each.\n"
      "shading: studio, kajiya-kay, marschner, energy-conserving or dual-scattering. visibility, how hair "
      "shadows itself from\n"
      "the key light: none, opacity, density-clustering, light-map, deep-opacity (of `layers`, 0: the fewest "
      "whose bound is\n"
      "met), occupancy or exact. transparency: auto, opaque, stochastic, alpha-to-coverage, "
      "weighted-average,\n"
      "occupancy-ordered, depth-layers, half-angle-slices or exact-lists. ground: a disc under the head. "
      "Raises ValueError\n"
      "for another word.\n"
      "preview: a Preview to use again. Needs no window and no GPU. Raises Error where OpenGL 4.5 is "
      "missing.");
}

}  // namespace coif::python

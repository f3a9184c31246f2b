// The preview room: pictures as NumPy arrays.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bind_hairmesh.h"
#include "bind_scalp.h"
#include "bind_strands.h"
#include "coif/io/safe_file.h"
#include "coif/preview/session.h"

namespace coif::python {

using namespace nb::literals;

namespace {

using Rgba = nb::ndarray<nb::numpy, std::uint8_t, nb::shape<-1, -1, 4>, nb::c_contig>;
using Head = std::variant<ScalpModel, PolygonMesh>;

Rgba arrayOf(Image image) {
  auto* kept = new Image(std::move(image));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<Image*>(p); });
  return Rgba(kept->rgba.data(), {std::size_t(kept->height), std::size_t(kept->width), 4}, owner);
}

void extend(Box& box, bool& any, const Vec3& p) {
  if (!p.allFinite()) return;
  box.lo = any ? Vec3(box.lo.cwiseMin(p)) : p;
  box.hi = any ? Vec3(box.hi.cwiseMax(p)) : p;
  any = true;
}

/// What a picture without a camera of its own shows: everything given.
Box contentBox(const PreviewScene& scene) {
  Box box;
  bool any = false;
  if (scene.strands) {
    for (const Vec3f& p : scene.strands->points) extend(box, any, p.cast<double>());
  }
  if (scene.head) {
    for (const Vec3& p : scene.head->positions) extend(box, any, p);
  }
  if (scene.hairMesh) {
    for (const HairVertex& v : scene.hairMesh->vertices()) extend(box, any, v.position);
  }
  return box;
}

struct View {
  const Strands* strands = nullptr;
  const std::optional<Head>* head = nullptr;
  const HairMeshModel* hairMesh = nullptr;
  std::optional<Camera> camera;
  double azimuth = 30, elevation = 8;
};

Rgba renderWith(Preview& preview, const View& view, const PreviewOptions& options) {
  PreviewScene scene;
  if (view.strands) scene.strands = &view.strands->set;
  if (*view.head) {
    const auto* scalp = std::get_if<ScalpModel>(&**view.head);
    scene.head = scalp ? &scalp->surface->mesh() : &std::get<PolygonMesh>(**view.head);
  }
  std::optional<HairMesh> mesh;
  if (view.hairMesh) scene.hairMesh = &mesh.emplace(view.hairMesh->mesh());
  if (!scene.strands && !scene.head && !scene.hairMesh) {
    throw nb::value_error("render: nothing to show: give strands, head or hair_mesh");
  }
  const UpAxis up = scene.strands ? scene.strands->upAxis
                    : scene.head  ? scene.head->upAxis
                                  : view.hairMesh->upAxis;
  scene.camera = view.camera ? *view.camera
                             : frameBox(contentBox(scene), up, view.azimuth, view.elevation,
                                        double(options.width) / double(std::max(options.height, 1)));
  Picture picture =
      Run(0, nb::none())([&](const Context& context) { return preview.render(scene, options, context); });
  return arrayOf(std::move(picture.image));
}

Rgba render(const Strands* strands, const std::optional<Head>& head, const HairMeshModel* hairMesh,
            std::tuple<int, int> size, double azimuth, double elevation, std::optional<Camera> camera,
            const ArrayLike& hairColor, std::optional<ArrayLike> background, bool transparent, bool shadows,
            bool lod, int subframes, Preview* preview) {
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
  const View view{strands, &head, hairMesh, camera, azimuth, elevation};
  if (preview) return renderWith(*preview, view, options);
  Preview own = take(Preview::create());
  return renderWith(own, view, options);
}

PolygonMesh const& meshOf(const Head& head) {
  const auto* scalp = std::get_if<ScalpModel>(&head);
  return scalp ? scalp->surface->mesh() : std::get<PolygonMesh>(head);
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

Rgba renderSession(Session& self, std::tuple<int, int> size, const ArrayLike& hairColor, bool transparent,
                   bool shadows, bool lod, double strandFraction, int subframes) {
  PreviewOptions options;
  std::tie(options.width, options.height) = size;
  options.hairColor = toVec3(hairColor, "hair_color").cast<float>();
  options.transparentBackground = transparent;
  options.shadows = shadows;
  options.lod = lod;
  options.strandFraction = strandFraction;
  options.subframes = subframes;
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
           "subframes"_a = defaults.subframes,
           "The picture: height×width×4 uint8, sRGB with straight alpha, rows from the top. strand_fraction: "
           "part of "
           "the strands to draw, 0: by their width on the screen.")
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

void savePng(const std::filesystem::path& path, const ArrayLike& rgba) {
  const auto pixels = toArray<std::uint64_t>(rgba, "rgba", {-1, -1, 4});
  Image image{int(pixels.shape(1)), int(pixels.shape(0)), {}};
  image.rgba.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.data()[i] > 255) throw nb::value_error("rgba: expected values from 0 to 255");
    image.rgba[i] = std::uint8_t(pixels.data()[i]);
  }
  const auto bytes = take(encodePng(image));
  SafeFile file = take(SafeFile::create(path));
  file.write(bytes);
  take(file.commit());
}

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

}  // namespace

void bindPreview(nb::module_& m) {
  bindCamera(m);
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
      "subframes"_a = defaults.subframes, "preview"_a.none() = nb::none(),
      "A picture of strands, a head (Scalp or PolygonMesh) and a hair mesh (drawn over it): height×width×4 "
      "uint8.\n\n"
      "sRGB with straight alpha, rows from the top; `size` is (width, height). Without a camera everything "
      "given is\n"
      "framed from `azimuth` and `elevation` in degrees (0, 0 looks at the face). hair_color: linear RGB "
      "where the\n"
      "strands have none; background: one linear RGB instead of the gradient. lod: fewer, wider strands "
      "where no one could tell. subframes: 1 to 64, four "
      "samples each.\n"
      "preview: a Preview to use again. Needs no window and no GPU. Raises Error where OpenGL 4.5 is "
      "missing.");
  m.def("save_png", &savePng, "path"_a, "rgba"_a,
        "Writes a picture (height×width×4, 0 to 255) as a PNG file; the old file stays whole until the new "
        "one is.\n\n"
        "Raises ValueError for another shape, Error for a file that cannot be written.");
}

}  // namespace coif::python

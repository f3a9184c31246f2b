// Pictures as NumPy arrays: files, what the eye sees, how far two are apart.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <fstream>

#include "bind_light.h"
#include "coif/io/safe_file.h"
#include "coif/light/image_metrics.h"

namespace coif::python {

using namespace nb::literals;

ByteRgba arrayOf(Image image) {
  auto* kept = new Image(std::move(image));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<Image*>(p); });
  return ByteRgba(kept->rgba.data(), {std::size_t(kept->height), std::size_t(kept->width), 4}, owner);
}

FloatRgba arrayOf(FloatImage image) {
  auto* kept = new FloatImage(std::move(image));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<FloatImage*>(p); });
  return FloatRgba(kept->rgba.data(), {std::size_t(kept->height), std::size_t(kept->width), 4}, owner);
}

FloatImage toPicture(const ArrayLike& value, const char* argument) {
  const nb::object array = nb::module_::import_("numpy").attr("asarray")(value.object);
  const auto sides = nb::cast<nb::tuple>(array.attr("shape"));
  const bool opaque = sides.size() == 3 && nb::cast<int>(sides[2]) == 3;
  const auto pixels = toArray<float>(ArrayLike{array}, argument, {-1, -1, opaque ? 3 : 4});
  const std::size_t width = pixels.shape(1), height = pixels.shape(0), channels = opaque ? 3 : 4;
  if (width > std::size_t(kLargestPictureSide) || height > std::size_t(kLargestPictureSide)) {
    throw nb::value_error((std::string(argument) + ": the picture is too large").c_str());
  }
  FloatImage image{int(width), int(height)};
  for (std::size_t p = 0; p < width * height; ++p) {
    image.rgba[4 * p + 3] = 1;
    std::copy_n(pixels.data() + channels * p, channels, image.rgba.data() + 4 * p);
  }
  return image;
}

namespace {

using FloatMap = nb::ndarray<nb::numpy, float, nb::ndim<2>, nb::c_contig>;

void writeFile(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  SafeFile file = take(SafeFile::create(path));
  file.write(bytes);
  take(file.commit());
}

void savePng(const std::filesystem::path& path, const ArrayLike& rgba) {
  const auto pixels = toArray<std::uint64_t>(rgba, "rgba", {-1, -1, 4});
  Image image{int(pixels.shape(1)), int(pixels.shape(0)), {}};
  image.rgba.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.data()[i] > 255) throw nb::value_error("rgba: expected values from 0 to 255");
    image.rgba[i] = std::uint8_t(pixels.data()[i]);
  }
  writeFile(path, take(encodePng(image)));
}

FloatRgba loadExr(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ErrorException(makeError(ErrorCode::NotFound, "cannot be opened", {}, path.string()));
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  Result<FloatImage> image = decodeExr(std::as_bytes(std::span(bytes)));
  if (!image.ok()) throw ErrorException(inFile(image.error(), path.string()));
  return arrayOf(*std::move(image));
}

}  // namespace

void bindPictures(nb::module_& m) {
  m.def("save_png", &savePng, "path"_a, "rgba"_a,
        "Writes a picture (height×width×4, 0 to 255) as a PNG file; the old file stays whole until the new "
        "one is.\n\n"
        "Raises ValueError for another shape, Error for a file that cannot be written.");
  m.def(
      "save_exr",
      [](const std::filesystem::path& path, const ArrayLike& image, bool half) {
        writeFile(path, take(encodeExr(toPicture(image, "image"),
                                       half ? ExrPrecision::Half : ExrPrecision::Float)));
      },
      "path"_a, "image"_a, "half"_a = true,
      "Writes a linear picture (height×width×3 or ×4, premultiplied alpha) as OpenEXR, ZIP, 16 or 32 "
      "bits.\n\n"
      "Raises ValueError for another shape, Error for a file that cannot be written.");
  m.def("load_exr", &loadExr, "path"_a,
        "Reads an OpenEXR picture: height×width×4 float32, linear, premultiplied alpha.\n\n"
        "Raises Error for a file that is not one.");
  m.def(
      "to_srgb", [](const ArrayLike& image) { return arrayOf(toSrgb(toPicture(image, "image"))); }, "image"_a,
      "A linear picture as 8-bit sRGB with straight alpha: exposure 1, clipped, for save_png().");
  m.def(
      "flip",
      [](const ArrayLike& image, const ArrayLike& reference, double pixelsPerDegree, int threads) {
        const FloatImage a = toPicture(image, "image"), b = toPicture(reference, "reference");
        Flip result = Run(threads, nb::none())(
            [&](const Context& context) { return flip(a, b, pixelsPerDegree, context); });
        auto* kept = new std::vector<float>(std::move(result.map));
        nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<float>*>(p); });
        return std::pair(result.mean,
                         FloatMap(kept->data(), {std::size_t(a.height), std::size_t(a.width)}, owner));
      },
      "image"_a, "reference"_a, "pixels_per_degree"_a = 67.0, "threads"_a = 0,
      "How different the eye finds two linear pictures (height×width×3 or ×4; alpha is ignored): the mean "
      "FLIP "
      "error in\n[0, 1] and its height×width map. Source: Andersson et al. 2020, low dynamic range.\n\n"
      "Raises ValueError for sizes that differ or values that are not finite.");
  m.def(
      "relative_mse",
      [](const ArrayLike& image, const ArrayLike& reference, double epsilon) {
        return take(relativeMse(toPicture(image, "image"), toPicture(reference, "reference"), epsilon));
      },
      "image"_a, "reference"_a, "epsilon"_a = 0.01,
      "Mean over pixels and RGB of (image - reference)**2 / (reference**2 + epsilon), linear.");
}

}  // namespace coif::python

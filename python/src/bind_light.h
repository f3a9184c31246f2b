// What pictures of either kind share: heads, what to frame.
#pragma once

#include <optional>
#include <variant>

#include "bind_hairmesh.h"
#include "bind_scalp.h"
#include "bind_strands.h"
#include "coif/light/camera.h"
#include "coif/light/image.h"

namespace coif::python {

using ByteRgba = nb::ndarray<nb::numpy, std::uint8_t, nb::shape<-1, -1, 4>, nb::c_contig>;
using FloatRgba = nb::ndarray<nb::numpy, float, nb::shape<-1, -1, 4>, nb::c_contig>;
ByteRgba arrayOf(Image image);  ///< height×width×4
FloatRgba arrayOf(FloatImage image);
/// height×width×3 or ×4, linear; alpha 1 where there is none.
FloatImage toPicture(const ArrayLike& value, const char* argument);

void bindPictures(nb::module_& m);

using Head = std::variant<ScalpModel, PolygonMesh>;

const PolygonMesh& meshOf(const Head& head);
/// The mesh inside, or null.
const PolygonMesh* meshOf(const std::optional<Head>& head);

/// What a picture without a camera of its own shows: everything given (null: not).
Box contentBox(const StrandSet* strands, const PolygonMesh* head, const HairMesh* hairMesh);

}  // namespace coif::python

// One reader and writer a format; files.cpp picks between them. Private to the room.
#pragma once

#include "coif/io/mesh_io.h"
#include "coif/io/safe_file.h"
#include "coif/io/skin_io.h"
#include "coif/io/strand_io.h"

namespace coif::io {

using Bytes = std::span<const std::byte>;

/// Diameter of a usual human hair in metres: what a writer states where the strands have no widths and the
/// format must state some.
inline constexpr double kUsualHairWidth = 70e-6;

// Meshes in. `path` serves messages and side files (.bin buffers).
Result<PolygonMesh> readObj(Bytes bytes, const std::filesystem::path& path);
Result<PolygonMesh> readPly(Bytes bytes, const std::filesystem::path& path);
Result<PolygonMesh> readOff(Bytes bytes, const std::filesystem::path& path);
Result<PolygonMesh> readStl(Bytes bytes, const std::filesystem::path& path);
Result<PolygonMesh> readGltfMesh(Bytes bytes, const std::filesystem::path& path);
Result<PolygonMesh> readUsdMesh(Bytes bytes, const std::filesystem::path& path);

/// The UsdSkel binding of the mesh that readUsdMesh reads; none when nothing binds it.
Result<std::optional<SkinBinding>> readUsdSkin(Bytes bytes, const std::filesystem::path& path);

// Strands in.
Result<StrandSet> readHair(Bytes bytes, const std::filesystem::path& path);
Result<StrandSet> readGltfStrands(Bytes bytes, const std::filesystem::path& path);
Result<StrandSet> readUsdStrands(Bytes bytes, const std::filesystem::path& path);

// Strands out; the caller has validated `what.strands`.
Result<WriteReport> writeHair(const StrandExport& what, const std::filesystem::path& path,
                              const Context& context);
Result<WriteReport> writeGltf(const StrandExport& what, const std::filesystem::path& path,
                              const Context& context);
/// Unsupported without COIF_WITH_ALEMBIC.
Result<WriteReport> writeAlembic(const StrandExport& what, const std::filesystem::path& path,
                                 const Context& context);
Result<WriteReport> writeUsd(const StrandExport& what, const std::filesystem::path& path,
                             const Context& context);

}  // namespace coif::io

// Whether a file can be written, asked before the work that fills it. Both leave nothing behind.
#pragma once

#include <filesystem>

#include "coif/base/result.h"

namespace coif {

/// Whether a SafeFile can be made for `path`. Errors: those of SafeFile::create.
Status canWrite(const std::filesystem::path& path);

/// What saveStrands would refuse for the name alone: Unsupported extension, Unreadable (cannot write there).
Status canSaveStrands(const std::filesystem::path& path);

}  // namespace coif

// Strands out as USD; the extension chooses text or crate.
#include <algorithm>
#include <cctype>

#include "formats.h"
#include "usd_layer.h"

namespace coif::io {

Result<WriteReport> writeUsd(const StrandExport& what, const std::filesystem::path& path,
                             const Context& context) {
  WriteReport report;
  auto layer = usd::describeExport(what, report.notes);
  if (!layer) return inFile(layer.error(), path.string());
  COIF_ASSIGN(SafeFile file, SafeFile::create(path));
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  const Status written =
      extension == ".usda" ? usd::writeText(*layer, file, context) : usd::writeCrate(*layer, file, context);
  if (!written) return inFile(written.error(), path.string());
  report.bytes = file.position();
  COIF_TRY(file.commit());
  return report;
}

}  // namespace coif::io

// What an export looks like as a USD layer; the writers print it, whatever it says.
#pragma once

#include "coif/io/safe_file.h"
#include "coif/io/strand_io.h"
#include "scan.h"
#include "usd_value.h"

namespace coif::io::usd {

/// The layer of an export: /Hair (Xform, the default prim) holding one BasisCurves prim a group, HairMesh,
/// Head and Looks. Large arrays are views of `what`, which must outlive the layer. Appends to `notes` what is
/// written in another way than it is held. Errors: InvalidArgument (frames of another size or out of order),
/// TooLarge, Degenerate (a mesh position that a float cannot hold). Cost: one pass over the points for the
/// extents.
Result<Layer> describeExport(const StrandExport& what, std::vector<std::string>& notes);

// Parts of it.
Result<Prim> describeHairMesh(const HairMesh& mesh);
Result<Prim> describeHead(const PolygonMesh& mesh);
Prim describeLooks(const std::string& rootPath);
/// Letters, digits and underscores, not beginning with a digit, and none of `taken`; adds itself to `taken`.
std::string primName(std::string_view wanted, std::vector<std::string>& taken);
/// The same text without what a USD string cannot hold: NUL, other control characters, broken UTF-8.
std::string cleanText(std::string_view text);

// Small makers that the parts share.
Attribute makeAttribute(std::string name, std::string typeName, std::optional<Value> value);
Attribute makeUniform(std::string name, std::string typeName, Value value);
Attribute makePrimvar(std::string name, std::string typeName, std::string interpolation, Value value);

/// The layer as text (.usda). Floats are printed with the fewest digits that read back as the same bits.
Status writeText(const Layer& layer, SafeFile& file, const Context& context);
/// The layer as a crate 0.8.0 (.usdc). Arrays of 16 integers and more are compressed, floats lie as they are.
Status writeCrate(const Layer& layer, SafeFile& file, const Context& context);

/// Either form, told apart by its first bytes. Large arrays may be views of `bytes`; all else is paid for
/// from `budget`. Errors: Malformed, Unsupported (.usdz, an unknown crate version), TooLarge; the place is a
/// line, a byte or a section.
Result<Layer> readLayer(std::span<const std::byte> bytes, MemoryBudget& budget);
Result<Layer> parseText(std::string_view text, MemoryBudget& budget);
Result<Layer> readCrate(std::span<const std::byte> bytes, MemoryBudget& budget);

}  // namespace coif::io::usd

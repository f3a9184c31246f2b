// Where strands grow on the hair mesh, in terms that move with it.
#pragma once

#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/strands/strand_set.h"
#include "style/styled_strand.h"

namespace coif::style {

struct Embedding {
  std::vector<std::uint32_t> bundles;  ///< S indices
  std::vector<StrandPlace> places;     ///< S
  std::vector<float> rootTurns;        ///< S, StylePlan::rootTurns()
};

/// Bundle indices of the strands. Errors: InvalidArgument for strands that are not of this mesh.
Result<std::vector<std::uint32_t>> bundlesOf(const HairMesh& mesh, const StrandSet& strands);

/// Errors: InvalidArgument for strands without ids, root faces or weights, or of another mesh.
Result<Embedding> embed(const HairMesh& mesh, const StrandSet& strands, double cm, const Context& context);

/// Σ λ_i values[corner i] of a strand's root face.
double atRoot(const HairMesh& mesh, const StrandSet& strands, std::uint32_t bundle, std::size_t strand,
              std::span<const double> values);

}  // namespace coif::style

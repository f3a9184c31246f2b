// The papers' own experiments on single lines of sight, repeated with the library's shadow maps.
#pragma once

#include "bench/bench.h"
#include "coif/strands/strand_set.h"

namespace coif {

/// Mertens et al. 2004, figure 5: depths from mixtures of gaussians, K clusters against 2K uniform bins;
/// Sintorn & Assarsson 2009, figure 5: a stray hair before a clump; Yuksel & Keyser 2008, figure 8: layer
/// sizes on clustered strands. Adds plots and figures.
void addPaperExperiments(const BenchOptions& options, BenchReport& report);

/// The light-oriented density map: 128³ cells and 100 000 segments against reading and writing both once, and
/// two threads against one.
void addLightMapFigures(const StrandSet& hair, const BenchOptions& options, BenchReport& report);

}  // namespace coif

// The extension module coif._coif: one binding unit a room, in the order of the rooms.
#include "bind.h"
#include "bind_simulate.h"
#include "bind_style.h"

NB_MODULE(_coif, m) {
  using namespace coif::python;
  m.doc() = "Hair modelling with hair meshes: the C++ library's bindings. Import `coif`.";
  bindBase(m);
  bindScalp(m);
  bindHairMesh(m);
  bindPlace(m);
  bindStrands(m);
  bindStyle(m);
  bindLight(m);
  bindSimulate(m);
  bindScene(m);
  bindEditor(m);
#ifdef COIF_WITH_PREVIEW
  bindPreview(m);
#endif
}

#pragma once

#include <optional>

#include "coif/preview/session.h"
#include "preview/device.h"
#include "preview/eye_pass.h"

namespace coif {

using namespace preview;

/// What a session shows, what of it is on the GPU, and for what that was made.
struct PreviewSession::Impl {
  std::shared_ptr<Device> device;

  // What to show. A null GPU object below means: not uploaded yet.
  Camera camera;
  Lights lights;
  std::shared_ptr<const PolygonMesh> head;
  std::optional<Ground> ground;
  std::optional<HairMesh> overlay;
  std::optional<PreparedHair> hair;
  bool hairMoved = false;                             ///< the mesh on the GPU is older than the model's
  std::optional<std::vector<Eigen::Vector4f>> style;  ///< what has to go to the GPU

  std::unique_ptr<HeadBuffers> headBuffers;
  std::unique_ptr<OverlayPass> overlayPass;
  std::unique_ptr<HairBuffers> hairBuffers;
  std::unique_ptr<StrandBuffers> eyeStrands, shadowStrands;
  bool eyeOld = false, shadowOld = false;  ///< made before the mesh moved
  std::unique_ptr<Fog> fog;                ///< of hair and head as they are
  std::unique_ptr<Openness> openness;      ///< of the fog, about the last picture's sky
  std::unique_ptr<ShadowPass> shadows;
  FrameData shadowFrame;  ///< of the picture that `shadows` was made for
  bool shadowsHaveHair = false;
  bool shadowsOnSurfaces = false;  ///< head or ground were there to take them
  VisibilityOptions shadowOptions;
  DetailOptions shadowDetail;  ///< of the strands in the maps
  std::unique_ptr<FibreTables> fibre;
  Vec3f hairPasses = Vec3f::Zero();  ///< to surfaces: FrameData
  std::unique_ptr<EyePass> eye;
  std::unique_ptr<SlicedHair> sliced;       ///< HalfAngleSlices, of this picture
  double eyeLayerSize = 0;                  ///< of DepthLayers
  std::unique_ptr<StrandBuffers> eyeLines;  ///< OccupancyOrdered's map of the camera
  bool eyeLinesOld = false;
  std::unique_ptr<HairMap> cameraMap;
  std::unique_ptr<FrameTargets> targets;
  int targetWidth = 0, targetHeight = 0;

  ~Impl();
  Result<Picture> render(const PreviewOptions& options, const Context& context);

 private:
  friend class PreviewSession;
  Box box() const;      ///< of head, hair and overlay
  Box seenBox() const;  ///< with the ground
  void upload(Picture& picture);
  /// Brings strands to a plan with as little work as may be.
  void follow(std::unique_ptr<StrandBuffers>& strands, bool& old, DetailPlan plan, const char* name,
              const PreviewOptions& options, Topology topology, Picture& picture);
  void makeEyeStrands(const PreviewOptions& options, const View& view, Picture& picture,
                      const Context& context);
  void makeShadowStrands(const PreviewOptions& options, const FrameData& frame, Picture& picture,
                         const Context& context);
  Status makeShadows(const PreviewOptions& options, FrameData& frame, Buffer& frameBuffer, Picture& picture,
                     const Context& context);
  Status countMapWork(const PreviewOptions& options, Picture& picture);
  Status draw(const PreviewOptions& options, const View& view, FrameData& frame, Buffer& frameBuffer,
              Picture& picture, const Context& context);
  Status drawSubframe(const PreviewOptions& options, const View& view, bool first);
  void shade(const PreviewOptions& options, Picture& picture);
  /// Binds the program that lights strands, with what it reads.
  ShadeParts useShading(const PreviewOptions& options, bool sliced, StageReport& stage);
  Status makeSlices(const PreviewOptions& options, const View& view, const FrameData& frame,
                    Picture& picture);
  Status drawSlices(const PreviewOptions& options, const EyeScene& scene, bool first);
  Status makeEye(const PreviewOptions& options, const View& view, Picture& picture);
  PreviewTransparency chooseTransparency(const PreviewOptions& options, const View& view,
                                         Picture& picture) const;
  double leastCoverage(const View& view) const;
  const Fog& theFog();  ///< made when it is first asked for
  void dropHair();
  void dropStrands();  ///< what was made from hair on the GPU
  /// Runs `action` with the context current; nothing happens where it cannot be.
  template <class Action>
  void withContext(Action action) {
    if (device == nullptr || !device->gl->makeCurrent().ok()) return;
    const CurrentContext current(*device->gl);
    action();
  }
};

}  // namespace coif

// Pictures do not depend on when the driver does what it is told: each is made a second time with everything
// before a command finished when that comes.
#include <epoxy/gl.h>

#include <utility>

#include "coif/preview/names.h"
#include "preview_fixture.h"

namespace coif {
namespace {

using testing::sceneOf, testing::tuft;

/// While it lives, every OpenGL command that reads or writes memory waits for all before it.
class EverythingInOrder {
 public:
  EverythingInOrder() {
    dispatchCompute = std::exchange(epoxy_glDispatchCompute, [](GLuint x, GLuint y, GLuint z) {
      glFinish();
      dispatchCompute(x, y, z);
    });
    drawArrays = std::exchange(epoxy_glDrawArrays, [](GLenum mode, GLint first, GLsizei count) {
      glFinish();
      drawArrays(mode, first, count);
    });
    drawElements = std::exchange(epoxy_glDrawElements,
                                 [](GLenum mode, GLsizei count, GLenum type, const void* indices) {
                                   glFinish();
                                   drawElements(mode, count, type, indices);
                                 });
    clearBuffer = std::exchange(epoxy_glClearNamedBufferData, [](GLuint buffer, GLenum inside, GLenum format,
                                                                 GLenum type, const void* value) {
      glFinish();
      clearBuffer(buffer, inside, format, type, value);
    });
    writeBuffer = std::exchange(epoxy_glNamedBufferSubData,
                                [](GLuint buffer, GLintptr at, GLsizeiptr size, const void* data) {
                                  glFinish();
                                  writeBuffer(buffer, at, size, data);
                                });
    clearFloats = std::exchange(
        epoxy_glClearNamedFramebufferfv, [](GLuint target, GLenum what, GLint which, const GLfloat* value) {
          glFinish();
          clearFloats(target, what, which, value);
        });
    clearIntegers = std::exchange(
        epoxy_glClearNamedFramebufferuiv, [](GLuint target, GLenum what, GLint which, const GLuint* value) {
          glFinish();
          clearIntegers(target, what, which, value);
        });
  }
  ~EverythingInOrder() {
    epoxy_glDispatchCompute = dispatchCompute;
    epoxy_glDrawArrays = drawArrays;
    epoxy_glDrawElements = drawElements;
    epoxy_glClearNamedBufferData = clearBuffer;
    epoxy_glNamedBufferSubData = writeBuffer;
    epoxy_glClearNamedFramebufferfv = clearFloats;
    epoxy_glClearNamedFramebufferuiv = clearIntegers;
  }
  EverythingInOrder(const EverythingInOrder&) = delete;
  EverythingInOrder& operator=(const EverythingInOrder&) = delete;

 private:
  static inline decltype(epoxy_glDispatchCompute) dispatchCompute;
  static inline decltype(epoxy_glDrawArrays) drawArrays;
  static inline decltype(epoxy_glDrawElements) drawElements;
  static inline decltype(epoxy_glClearNamedBufferData) clearBuffer;
  static inline decltype(epoxy_glNamedBufferSubData) writeBuffer;
  static inline decltype(epoxy_glClearNamedFramebufferfv) clearFloats;
  static inline decltype(epoxy_glClearNamedFramebufferuiv) clearIntegers;
};

class Order : public testing::PreviewTest {
 protected:
  static void expectTheSame(PreviewSession& session, PreviewOptions options, const std::string& what) {
    options.keep = false;
    const Image image = render(session, options).image;
    const EverythingInOrder inOrder;
    EXPECT_TRUE(render(session, options).image.rgba == image.rgba) << what;
  }
};

TEST_F(Order, OfEveryTransparencyAndShadowIsKept) {
  const StrandSet strands = tuft(2000, 0.004f);
  PolygonMesh head;
  head.positions = {{-0.4, 0.1, 0}, {0.4, 0.1, 0}, {0, 0.6, 0}};
  head.faceOffsets = {0, 3};
  head.corners = {0, 1, 2};
  PreviewScene scene = sceneOf(strands);
  scene.head = &head;
  scene.ground = Ground{Vec3(0, -0.1, 0), Vec3::UnitY(), 0.7, Vec3f::Constant(0.1f)};
  PreviewSession session = sessionFor(scene);
  PreviewOptions options = small(128, 2);
  options.leaveOut = false;
  options.visibility.slices = 100;
  for (const char* word : transparencyNames()) {
    ASSERT_TRUE(setTransparency(options, word).ok());
    expectTheSame(session, options, word);
  }
  options.transparency = PreviewTransparency::Auto;
  for (const char* word : visibilityNames()) {
    ASSERT_TRUE(setVisibility(options, word).ok());
    expectTheSame(session, options, word);
  }
}

// A driver's storage block may hold some 800 rows of this width: the picture is made in parts, in the same
// memory.
TEST_F(Order, OfTheRowsOfATallPictureIsKept) {
  const StrandSet strands = tuft(3000, 0.0004f);
  PreviewOptions options = small(1024, 2);
  options.transparency = PreviewTransparency::DepthLayers;
  PreviewSession session = sessionFor(sceneOf(strands));
  expectTheSame(session, options, "depth layers");
}

}  // namespace
}  // namespace coif

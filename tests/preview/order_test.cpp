// Pictures do not depend on when the driver does what it is told: each is made a second time with everything
// before a command finished when that comes, and every command that has to wait for shaders is seen to.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <type_traits>
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
    drawElements =
        std::exchange(epoxy_glDrawElements, [](GLenum mode, GLsizei count, GLenum type, const void* indices) {
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
    clearFloats = std::exchange(epoxy_glClearNamedFramebufferfv,
                                [](GLuint target, GLenum what, GLint which, const GLfloat* value) {
                                  glFinish();
                                  clearFloats(target, what, which, value);
                                });
    clearIntegers = std::exchange(epoxy_glClearNamedFramebufferuiv,
                                  [](GLuint target, GLenum what, GLint which, const GLuint* value) {
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

/// While it lives, counts the commands that use memory which shaders may still be writing, as no barrier of
/// their kind came since the last of these ran. `withheld`: bits that barriers are robbed of.
class OrderWitness {
 public:
  explicit OrderWitness(GLbitfield withheld = 0) {
    now = this;
    withheld_ = withheld;
    hook(epoxy_glDispatchCompute, dispatchCompute, "glDispatchCompute", [](GLuint x, GLuint y, GLuint z) {
      now->need(
          GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT,
          "dispatch");
      dispatchCompute(x, y, z);
      now->fenced_ = now->fencedFromCompute_ = 0;
    });
    hook(epoxy_glDrawArrays, drawArrays, "glDrawArrays", [](GLenum mode, GLint first, GLsizei count) {
      now->needForDrawing();
      drawArrays(mode, first, count);
      now->fenced_ = 0;
    });
    hook(epoxy_glDrawElements, drawElements, "glDrawElements",
         [](GLenum mode, GLsizei count, GLenum type, const void* indices) {
           now->needForDrawing();
           drawElements(mode, count, type, indices);
           now->fenced_ = 0;
         });
    hook(epoxy_glMemoryBarrier, barrier, "glMemoryBarrier", [](GLbitfield bits) {
      bits &= ~now->withheld_;
      now->fenced_ |= bits, now->fencedFromCompute_ |= bits;
      if (bits != 0) barrier(bits);
    });
    hook(epoxy_glBindBufferBase, bindBase, "glBindBufferBase",
         [](GLenum target, GLuint index, GLuint buffer) {
           if (target == GL_SHADER_STORAGE_BUFFER) now->seenByShaders_.insert(buffer);
           bindBase(target, index, buffer);
         });
    hook(epoxy_glBindBufferRange, bindRange, "glBindBufferRange",
         [](GLenum target, GLuint index, GLuint buffer, GLintptr at, GLsizeiptr size) {
           if (target == GL_SHADER_STORAGE_BUFFER) now->seenByShaders_.insert(buffer);
           bindRange(target, index, buffer, at, size);
         });
    hook(epoxy_glDeleteBuffers, deleteBuffers, "glDeleteBuffers", [](GLsizei count, const GLuint* names) {
      for (GLsizei k = 0; k < count; ++k) now->seenByShaders_.erase(names[k]);
      deleteBuffers(count, names);
    });
    hook(epoxy_glClearNamedBufferData, clearBuffer, "glClearNamedBufferData",
         [](GLuint buffer, GLenum inside, GLenum format, GLenum type, const void* value) {
           now->needForBuffer(buffer, "fill");
           clearBuffer(buffer, inside, format, type, value);
         });
    hook(epoxy_glNamedBufferSubData, writeBuffer, "glNamedBufferSubData",
         [](GLuint buffer, GLintptr at, GLsizeiptr size, const void* data) {
           now->needForBuffer(buffer, "write");
           writeBuffer(buffer, at, size, data);
         });
    hook(epoxy_glGetNamedBufferSubData, readBuffer, "glGetNamedBufferSubData",
         [](GLuint buffer, GLintptr at, GLsizeiptr size, void* data) {
           now->needForBuffer(buffer, "read");
           readBuffer(buffer, at, size, data);
         });
  }
  ~OrderWitness() {
    epoxy_glDispatchCompute = dispatchCompute;
    epoxy_glDrawArrays = drawArrays;
    epoxy_glDrawElements = drawElements;
    epoxy_glMemoryBarrier = barrier;
    epoxy_glBindBufferBase = bindBase;
    epoxy_glBindBufferRange = bindRange;
    epoxy_glDeleteBuffers = deleteBuffers;
    epoxy_glClearNamedBufferData = clearBuffer;
    epoxy_glNamedBufferSubData = writeBuffer;
    epoxy_glGetNamedBufferSubData = readBuffer;
  }
  OrderWitness(const OrderWitness&) = delete;
  OrderWitness& operator=(const OrderWitness&) = delete;

  int forgotten(const std::string& command) const {
    const auto found = forgotten_.find(command);
    return found == forgotten_.end() ? 0 : found->second;
  }
  std::string said() const {
    std::string text;
    for (const auto& [command, count] : forgotten_) text += command + ": " + std::to_string(count) + "; ";
    return text;
  }

 private:
  // Epoxy's own pointers find their command when they are first called, and would not come back to here.
  template <class Command>
  static void hook(Command& pointer, Command& real, const char* name, std::type_identity_t<Command> ours) {
    real = reinterpret_cast<Command>(eglGetProcAddress(name));
    pointer = ours;
  }
  void need(GLbitfield bits, const char* command) { forgotten_[command] += (fenced_ & bits) != bits ? 1 : 0; }
  void needForBuffer(GLuint buffer, const char* command) {
    if (seenByShaders_.contains(buffer)) need(GL_BUFFER_UPDATE_BARRIER_BIT, command);
  }
  // What is drawn from compute's results; the pipeline orders its own.
  void needForDrawing() { forgotten_["draw"] += fencedFromCompute_ == 0 ? 1 : 0; }

  GLbitfield fenced_ = ~0u, fencedFromCompute_ = ~0u, withheld_ = 0;
  std::set<GLuint> seenByShaders_;
  std::map<std::string, int> forgotten_;

  static inline OrderWitness* now = nullptr;
  static inline decltype(epoxy_glDispatchCompute) dispatchCompute;
  static inline decltype(epoxy_glDrawArrays) drawArrays;
  static inline decltype(epoxy_glDrawElements) drawElements;
  static inline decltype(epoxy_glMemoryBarrier) barrier;
  static inline decltype(epoxy_glBindBufferBase) bindBase;
  static inline decltype(epoxy_glBindBufferRange) bindRange;
  static inline decltype(epoxy_glDeleteBuffers) deleteBuffers;
  static inline decltype(epoxy_glClearNamedBufferData) clearBuffer;
  static inline decltype(epoxy_glNamedBufferSubData) writeBuffer;
  static inline decltype(epoxy_glGetNamedBufferSubData) readBuffer;
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

/// A small scene of everything, by every way of transparency and of shadows in turn.
template <class Look>
void forEveryMethod(const Look& look) {
  PreviewOptions options;
  options.leaveOut = false;
  options.visibility.slices = 100;
  for (const char* word : transparencyNames()) {
    ASSERT_TRUE(setTransparency(options, word).ok());
    look(options, word);
  }
  options.transparency = PreviewTransparency::Auto;
  for (const char* word : visibilityNames()) {
    ASSERT_TRUE(setVisibility(options, word).ok());
    look(options, word);
  }
}

class OrderOfAll : public Order {
 protected:
  OrderOfAll() {
    head_.positions = {{-0.4, 0.1, 0}, {0.4, 0.1, 0}, {0, 0.6, 0}};
    head_.faceOffsets = {0, 3};
    head_.corners = {0, 1, 2};
    scene_.head = &head_;
    scene_.ground = Ground{Vec3(0, -0.1, 0), Vec3::UnitY(), 0.7, Vec3f::Constant(0.1f)};
  }
  const StrandSet strands_ = tuft(2000, 0.004f);
  PolygonMesh head_;
  PreviewScene scene_ = sceneOf(strands_);
};

TEST_F(OrderOfAll, OfEveryTransparencyAndShadowIsKept) {
  PreviewSession session = sessionFor(scene_);
  forEveryMethod([&](PreviewOptions options, const char* word) {
    options.width = options.height = 128, options.subframes = 2, options.transparentBackground = true;
    expectTheSame(session, options, word);
  });
}

TEST_F(OrderOfAll, NoCommandForgetsToWaitForShaders) {
  PreviewSession session = sessionFor(scene_);
  const auto at64 = [](PreviewOptions options) {
    options.width = options.height = 64, options.subframes = 2, options.keep = false;
    return options;
  };
  forEveryMethod([&](const PreviewOptions& options, const char* word) {
    const OrderWitness witness;
    render(session, at64(options));
    for (const char* command : {"dispatch", "draw", "fill", "write", "read"})
      EXPECT_EQ(witness.forgotten(command), 0) << word << ": " << witness.said();
  });
  // The check can fail: each kind of barrier is missed where it is withheld.
  const auto missed = [&](GLbitfield withheld, const char* transparency) {
    PreviewOptions options = at64({});
    EXPECT_TRUE(setTransparency(options, transparency).ok());
    const OrderWitness witness(withheld);
    render(session, options);
    return std::pair(witness.forgotten("dispatch") + witness.forgotten("draw"),
                     witness.forgotten("fill") + witness.forgotten("read") + witness.forgotten("write"));
  };
  for (const GLbitfield withheld :
       {GL_SHADER_STORAGE_BARRIER_BIT, GL_SHADER_IMAGE_ACCESS_BARRIER_BIT, GL_TEXTURE_FETCH_BARRIER_BIT})
    EXPECT_GT(missed(withheld, "depth-layers").first, 0) << withheld;
  EXPECT_GT(missed(GL_BUFFER_UPDATE_BARRIER_BIT, "depth-layers").second, 0);
  EXPECT_GT(missed(GL_BUFFER_UPDATE_BARRIER_BIT, "half-angle-slices").second, 0);
  EXPECT_GT(missed(GL_ALL_BARRIER_BITS, "stochastic").first, 0);
}

// So that a new pass cannot forget: what has to wait is called in compute.cpp alone, which waits.
TEST(OrderInTheSources, ComputeAloneRunsFillsWritesAndReads) {
  int files = 0, calls = 0;
  for (const auto& entry : std::filesystem::directory_iterator(COIF_SOURCE_DIR "/src/preview")) {
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    ++files;
    for (const char* command :
         {"glDispatchCompute", "glClearNamedBufferData", "glClearNamedBufferSubData", "glNamedBufferSubData",
          "glGetNamedBufferSubData", "glCopyNamedBufferSubData", "glMapNamedBuffer"}) {
      const bool found = text.str().find(command) != std::string::npos;
      if (entry.path().filename() == "compute.cpp") {
        calls += found ? 1 : 0;
      } else {
        EXPECT_FALSE(found) << entry.path().filename() << " calls " << command << " itself";
      }
    }
  }
  EXPECT_GT(files, 40);
  EXPECT_EQ(calls, 4);
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

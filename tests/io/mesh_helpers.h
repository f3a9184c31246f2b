// Files made of text for the tests of the readers.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "coif/io/mesh_io.h"
#include "coif/io/strand_io.h"
#include "io/temp_folder.h"

namespace coif::test {

inline void putFile(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string getFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The bytes of values as the machine holds them (little-endian here).
template <class T>
std::string raw(std::initializer_list<T> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(T)};
}

inline Result<PolygonMesh> meshFrom(const std::string& bytes, const std::string& name) {
  TempFolder folder;
  putFile(folder / name, bytes);
  return loadPolygonMesh(folder / name);
}

inline Result<StrandSet> strandsFrom(const std::string& bytes, const std::string& name) {
  TempFolder folder;
  putFile(folder / name, bytes);
  return loadStrands(folder / name);
}

/// The error of a load that must fail, naming the file.
template <class T>
Error errorOf(const Result<T>& result) {
  if (result.ok()) {
    ADD_FAILURE() << "an error was due";
    return {};
  }
  EXPECT_FALSE(result.error().file.empty()) << result.error().text();
  EXPECT_FALSE(result.error().message.empty());
  return result.error();
}

inline std::vector<std::uint32_t> faceSizes(const PolygonMesh& mesh) {
  std::vector<std::uint32_t> sizes;
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) sizes.push_back(std::uint32_t(mesh.face(f).size()));
  return sizes;
}

inline bool hasNote(const std::vector<std::string>& notes, const std::string& part) {
  for (const std::string& note : notes) {
    if (note.find(part) != std::string::npos) return true;
  }
  return false;
}

inline std::filesystem::path sharedData(const std::string& name) {
  return std::filesystem::path(COIF_SHARED_DATA) / name;
}

}  // namespace coif::test

/// Real data may be absent where the program is built by others.
#define COIF_NEEDS(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there"

#include "coif/io/safe_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>
#include <fstream>

#include "io/temp_folder.h"

namespace coif {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

void put(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string get(const fs::path& path) {
  auto bytes = readFile(path);
  if (!bytes.ok()) return bytes.error().text();
  return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

Status save(const fs::path& path, const std::string& text) {
  COIF_ASSIGN(SafeFile file, SafeFile::create(path));
  file.write(text);
  return file.commit();
}

unsigned modeOf(const fs::path& path) {
  struct stat info {};
  EXPECT_EQ(::stat(path.c_str(), &info), 0);
  return info.st_mode & 07777;
}

TEST(SafeFile, ReplacesTheOldFileAndLeavesNothingBeside) {
  TempFolder folder;
  put(folder / "a", "old");
  ASSERT_TRUE(save(folder / "a", "new").ok());
  EXPECT_EQ(get(folder / "a"), "new");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(SafeFile, WithoutCommitTheOldFileStays) {
  TempFolder folder;
  put(folder / "a", "old");
  {
    auto file = SafeFile::create(folder / "a");
    ASSERT_TRUE(file.ok());
    file->write(std::string(3 << 20, 'x'));
    EXPECT_EQ(get(folder / "a"), "old");
  }
  EXPECT_EQ(get(folder / "a"), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(SafeFile, SmallAndLargeWritesKeepTheirOrder) {
  TempFolder folder;
  std::string expected;
  auto file = SafeFile::create(folder / "a");
  ASSERT_TRUE(file.ok());
  for (std::size_t i = 0; i < 200; ++i) {  // sizes below, at and above the 1 MiB buffer
    const std::size_t size = i % 20 == 0 ? (std::size_t{1} << 20) - 1 + i / 20 % 3 : i * 37;
    const std::string piece(size, char('a' + i % 26));
    file->write(piece);
    expected += piece;
    ASSERT_EQ(file->position(), expected.size());
  }
  ASSERT_TRUE(file->commit().ok());
  EXPECT_TRUE(get(folder / "a") == expected);
}

TEST(SafeFile, SeekPatchesAnEarlierHeader) {
  TempFolder folder;
  auto file = SafeFile::create(folder / "a");
  ASSERT_TRUE(file.ok());
  file->write("....body");
  file->seek(0);
  file->write("HEAD");
  EXPECT_EQ(file->position(), 4u);
  file->seek(8);
  file->write("!");
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(get(folder / "a"), "HEADbody!");
}

TEST(SafeFile, WritesThroughALinkToItsTarget) {
  TempFolder folder;
  fs::create_directory(folder / "there");
  put(folder / "there/a", "old");
  fs::create_symlink("there/a", folder / "link");
  fs::create_symlink("there/absent", folder / "dangling");
  fs::create_symlink("loop", folder / "loop");
  ASSERT_TRUE(save(folder / "link", "new").ok());
  ASSERT_TRUE(save(folder / "dangling", "made").ok());
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_TRUE(fs::is_symlink(folder / "dangling"));
  EXPECT_EQ(get(folder / "there/a"), "new");
  EXPECT_EQ(get(folder / "there/absent"), "made");
  EXPECT_FALSE(save(folder / "loop", "x").ok());
}

TEST(SafeFile, KeepsTheModeOfTheOldFile) {
  TempFolder folder;
  put(folder / "a", "old");
  for (unsigned mode : {0600u, 0644u, 0755u}) {
    ASSERT_EQ(::chmod((folder / "a").c_str(), mode), 0);
    ASSERT_TRUE(save(folder / "a", "new").ok());
    EXPECT_EQ(modeOf(folder / "a"), mode);
  }
  const mode_t umaskWas = ::umask(027);
  ASSERT_TRUE(save(folder / "b", "new").ok());
  ::umask(umaskWas);
  EXPECT_EQ(modeOf(folder / "b"), 0640u);
}

TEST(SafeFile, RefusesWhatItMustNotReplace) {
  TempFolder folder;
  fs::create_directory(folder / "dir");
  EXPECT_EQ(save(folder / "dir", "x").error().code, ErrorCode::Unreadable);
  EXPECT_EQ(save("/dev/null", "x").error().code, ErrorCode::Unreadable);
  EXPECT_EQ(save(folder / "no/such/folder", "x").error().code, ErrorCode::NotFound);
  const Status twice = [&]() -> Status {
    COIF_ASSIGN(SafeFile file, SafeFile::create(folder / "a"));
    COIF_TRY(file.commit());
    return file.commit();
  }();
  EXPECT_EQ(twice.error().code, ErrorCode::InvalidArgument);
}

/// Runs `body` in a process of its own and hands back its exit status.
template <class Body>
int inChild(Body body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST(SafeFile, ReadOnlyFolderAndFileAreClearErrors) {
  TempFolder folder;
  put(folder / "locked", "old");
  ASSERT_EQ(::chmod((folder / "locked").c_str(), 0444), 0);
  fs::create_directory(folder / "dir");
  ASSERT_EQ(::chmod((folder / "dir").c_str(), 0555), 0);
  ASSERT_EQ(::chmod(folder.path().c_str(), 0777), 0);
  const int result = inChild([&] {
    // The system lets root write anywhere: be somebody else.
    if (::geteuid() == 0 && ::setuid(65534) != 0) return 10;
    for (const fs::path& path : {folder / "dir/a", folder / "locked"}) {
      const Status status = save(path, "x");
      if (status.ok() || status.error().code != ErrorCode::Unreadable) return 11;
      if (status.error().message.find("Permission denied") == std::string::npos) return 12;
    }
    return 0;
  });
  EXPECT_EQ(result, 0);
  EXPECT_EQ(get(folder / "locked"), "old");
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(SafeFile, FullDiskKeepsTheOldFileAndSaysWhy) {
  TempFolder folder;
  put(folder / "a", "old");
  const int result = inChild([&] {
    std::signal(SIGXFSZ, SIG_IGN);  // so that write() fails with EFBIG, as a full disk does with ENOSPC
    const rlimit limit{100000, 100000};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 10;
    auto file = SafeFile::create(folder / "a");
    if (!file.ok()) return 11;
    for (int i = 0; i < 40; ++i) file->write(std::string(100000, 'x'));
    file->seek(0);
    file->write("later writes must not hide the first error");
    const Status status = file->commit();
    if (status.ok()) return 12;
    if (status.error().code != ErrorCode::Unreadable) return 13;
    if (status.error().message.find("File too large") == std::string::npos) return 14;
    return status.error().file == (folder / "a").string() ? 0 : 15;
  });
  EXPECT_EQ(result, 0);
  EXPECT_EQ(get(folder / "a"), "old");
  EXPECT_EQ(folder.entries(), 1u) << "the temporary file stayed";
}

TEST(SafeFile, CrashInTheMiddleKeepsTheOldFile) {
  TempFolder folder;
  put(folder / "a", "old");
  const int result = inChild([&] {
    auto file = SafeFile::create(folder / "a");
    if (!file.ok()) return 11;
    file->write(std::string(5 << 20, 'x'));
    ::_exit(42);  // no destructor runs, as after a crash
    return 0;
  });
  EXPECT_EQ(result, 42);
  EXPECT_EQ(get(folder / "a"), "old");
  ASSERT_TRUE(save(folder / "a", "new").ok()) << "the crashed writer's leftover is in the way";
  EXPECT_EQ(get(folder / "a"), "new");
}

TEST(ReadFile, NamesWhatIsWrong) {
  TempFolder folder;
  put(folder / "a", "12345");
  EXPECT_EQ(readFile(folder / "a")->size(), 5u);
  EXPECT_EQ(readFile(folder / "a", 5)->size(), 5u);
  EXPECT_EQ(readFile(folder / "a", 4).error().code, ErrorCode::TooLarge);
  EXPECT_EQ(readFile(folder / "b").error().code, ErrorCode::NotFound);
  EXPECT_EQ(readFile(folder.path()).error().code, ErrorCode::Unreadable);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(readFile(folder / "pipe").error().code, ErrorCode::Unreadable) << "must not wait for a writer";
  put(folder / "empty", "");
  EXPECT_TRUE(readFile(folder / "empty")->empty());
}

}  // namespace
}  // namespace coif

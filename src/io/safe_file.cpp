#include "coif/io/safe_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>

#include "coif/io/can_write.h"

namespace coif {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr int kMaxSymlinks = 40;  // as Linux itself allows in one path

Error systemError(const std::string& what, const fs::path& path, int code) {
  const ErrorCode kind = code == ENOENT ? ErrorCode::NotFound : ErrorCode::Unreadable;
  return makeError(kind, what + ": " + std::generic_category().message(code), {}, path.string());
}

/// A descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int value = -1) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  int get() const { return value_; }
  void reset(int value) {
    close();
    value_ = value;
  }
  int close() {
    const int result = value_ >= 0 ? ::close(value_) : 0;
    value_ = -1;
    return result;
  }

 private:
  int value_;
};

/// Where a write to `path` ends up: the target of a link, which need not exist yet.
Result<fs::path> throughLinks(fs::path path) {
  for (int i = 0; i < kMaxSymlinks; ++i) {
    std::error_code code;
    const fs::path next = fs::is_symlink(path, code) ? fs::read_symlink(path, code) : fs::path();
    if (next.empty()) return path;
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return systemError("cannot write", path, ELOOP);
}

fs::path folderOf(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

}  // namespace

Result<std::vector<std::byte>> readFile(const fs::path& path, std::uint64_t maxBytes) {
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) return systemError("cannot open", path, errno);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return systemError("cannot read", path, errno);
  if (S_ISDIR(info.st_mode)) return systemError("cannot read", path, EISDIR);
  if (!S_ISREG(info.st_mode)) {
    return makeError(ErrorCode::Unreadable, "cannot read: not a regular file", {}, path.string());
  }
  const auto size = std::uint64_t(info.st_size);
  const auto tooLarge = [&] {
    return makeError(
        ErrorCode::TooLarge,
        "the file has " + std::to_string(size) + " bytes, more than the limit of " + std::to_string(maxBytes),
        {}, path.string());
  };
  if (size > maxBytes) return tooLarge();
  std::vector<std::byte> bytes;
  try {
    bytes.resize(size);
  } catch (const std::bad_alloc&) {
    return tooLarge();
  }
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(file.get(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return systemError("cannot read", path, errno);
    if (got == 0) break;  // the file shrank meanwhile
    done += std::size_t(got);
  }
  bytes.resize(done);
  return bytes;
}

struct SafeFile::Impl {
  fs::path path;       // as the caller named it
  fs::path target;     // after following links
  fs::path temporary;  // empty once renamed or removed
  Descriptor file;
  std::vector<std::byte> buffer;
  std::uint64_t position = 0;
  Status status;
  bool committed = false;

  ~Impl() { removeTemporary(); }

  void removeTemporary() {
    if (!temporary.empty()) ::unlink(temporary.c_str());
    temporary.clear();
  }
  void fail(const std::string& what, int code) {
    if (status.ok())
      status = makeError(ErrorCode::Unreadable, what + ": " + std::generic_category().message(code), {},
                         path.string());
  }
  void writeNow(std::span<const std::byte> bytes) {
    while (status.ok() && !bytes.empty()) {
      const ssize_t done = ::write(file.get(), bytes.data(), bytes.size());
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) {
        fail("cannot write", errno);
      } else {
        bytes = bytes.subspan(std::size_t(done));
      }
    }
  }
  void flush() {
    writeNow(buffer);
    buffer.clear();
  }
  Status open();
  Status keepMode(const struct stat& old);
  Status finish();
};

/// The new file takes the old one's permissions, and its owner where the system lets us.
Status SafeFile::Impl::keepMode(const struct stat& old) {
  if (::fchown(file.get(), old.st_uid, old.st_gid) != 0 && errno != EPERM) {
    return systemError("cannot keep the owner", path, errno);
  }
  if (::fchmod(file.get(), old.st_mode & 07777) != 0) return systemError("cannot keep the mode", path, errno);
  return {};
}

Status SafeFile::Impl::open() {
  COIF_ASSIGN(target, throughLinks(path));
  struct stat old {};
  const bool exists = ::stat(target.c_str(), &old) == 0;
  if (exists && S_ISDIR(old.st_mode)) return systemError("cannot write", path, EISDIR);
  if (exists && !S_ISREG(old.st_mode)) {
    return makeError(ErrorCode::Unreadable, "cannot write: not a regular file", {}, path.string());
  }
  // A rename would replace a write-protected file without asking.
  if (exists && ::access(target.c_str(), W_OK) != 0) return systemError("cannot write", path, errno);
  if (target.filename().empty() || target.filename() == "..") {
    return makeError(ErrorCode::InvalidArgument, "cannot write: no file name", {}, path.string());
  }

  // O_EXCL: the name is ours alone; the mode passes through the umask, as for any new file.
  static std::atomic<unsigned> counter{0};
  constexpr int kTries = 100;
  for (int i = 0; i < kTries && file.get() < 0; ++i) {
    temporary = folderOf(target) /
                (".coif-" + std::to_string(::getpid()) + "-" + std::to_string(counter.fetch_add(1)) + ".tmp");
    file.reset(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.get() < 0 && errno != EEXIST) break;
  }
  if (file.get() < 0) {
    const int code = errno;
    temporary.clear();
    return systemError("cannot write in folder '" + folderOf(target).string() + "'", path, code);
  }
  if (exists) COIF_TRY(keepMode(old));
  buffer.reserve(kBufferBytes);
  return {};
}

Status SafeFile::Impl::finish() {
  if (committed) return makeError(ErrorCode::InvalidArgument, "committed twice", {}, path.string());
  committed = true;
  flush();
  if (status.ok() && ::fsync(file.get()) != 0) fail("cannot flush to disk", errno);
  if (file.close() != 0) fail("cannot close", errno);  // network file systems report a full disk here
  if (status.ok() && ::rename(temporary.c_str(), target.c_str()) != 0)
    fail("cannot replace the old file", errno);
  if (!status.ok()) {
    removeTemporary();
    return status;
  }
  temporary.clear();
  // The new name itself must survive a power cut; some file systems have nothing to flush for a folder.
  const Descriptor folder(::open(folderOf(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() >= 0 && ::fsync(folder.get()) != 0 && errno != EINVAL && errno != ENOTSUP) {
    fail("written, but the folder cannot be flushed to disk", errno);
  }
  return status;
}

SafeFile::SafeFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SafeFile::SafeFile(SafeFile&&) noexcept = default;
SafeFile& SafeFile::operator=(SafeFile&&) noexcept = default;
SafeFile::~SafeFile() = default;

Result<SafeFile> SafeFile::create(const fs::path& path) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  COIF_TRY(impl->open());
  return SafeFile(std::move(impl));
}

void SafeFile::write(std::span<const std::byte> bytes) {
  impl_->position += bytes.size();
  if (impl_->buffer.size() + bytes.size() > kBufferBytes) impl_->flush();
  if (bytes.size() >= kBufferBytes) {
    impl_->writeNow(bytes);
  } else {
    impl_->buffer.insert(impl_->buffer.end(), bytes.begin(), bytes.end());
  }
}

std::uint64_t SafeFile::position() const {
  return impl_->position;
}

void SafeFile::seek(std::uint64_t position) {
  impl_->flush();
  impl_->position = position;
  if (::lseek(impl_->file.get(), off_t(position), SEEK_SET) < 0) impl_->fail("cannot seek", errno);
}

const fs::path& SafeFile::path() const {
  return impl_->path;
}

Status SafeFile::commit() {
  return impl_->finish();
}

Status canWrite(const fs::path& path) {
  COIF_ASSIGN([[maybe_unused]] const SafeFile probe, SafeFile::create(path));
  return {};
}

}  // namespace coif

// A library to be preloaded (LD_PRELOAD): the n-th time that the program opens, writes, flushes, closes, renames, links
// or makes something below a folder, that fails, or the process dies there. tests/reliability/fault_injection uses it.
//
//   BURIN_FAULT_BELOW=FOLDER    which paths count (their real names)
//   BURIN_FAULT_AT=N            which of the calls (1, 2, ...); 0: none
//   BURIN_FAULT_HOW=enospc|eio|eacces|edquot|die|short
//                               what happens there; "short" writes half of what it should, and then fails as a full
//                               disk
//   BURIN_FAULT_STAYS=1         and all later ones, as on a full disk
//   BURIN_FAULT_LOG=FILE        appends one line for each call that counts: its number, what it is, its path
//
// Only calls that change something count: to read is tests/read's affair. Paths are looked at where a call names one,
// and descriptors by what was opened. Calls that the C library makes within itself (fopen to open) are not seen, so
// that its doors are listed one by one.
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

constexpr int kMostFiles = 65536;
std::atomic<bool> is_ours[kMostFiles];
std::atomic<int> counted{0};

const char* setting(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// The folder's part of a path resolved, the last part as it is: what a rename or an open with O_CREAT acts on.
std::string resolved(int folder, const char* path) {
  std::string name(path);
  if (!name.empty() && name.front() != '/' && folder != AT_FDCWD) {
    char link[64], base[PATH_MAX];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
    const ssize_t n = readlink(link, base, sizeof base);
    if (n > 0) name = std::string(base, static_cast<std::size_t>(n)) + "/" + name;
  }
  const std::size_t slash = name.rfind('/');
  const std::string parent = slash == std::string::npos ? "." : slash == 0 ? "/" : name.substr(0, slash);
  char full[PATH_MAX];
  if (realpath(parent.c_str(), full) == nullptr) return name;
  return std::string(full) + "/" + (slash == std::string::npos ? name : name.substr(slash + 1));
}

bool is_below(int folder, const char* path) {
  const std::string below = setting("BURIN_FAULT_BELOW");
  if (below.empty() || path == nullptr) return false;
  const int before = errno;
  const std::string name = resolved(folder, path);
  errno = before;
  return name.size() > below.size() && name.compare(0, below.size(), below) == 0 && name[below.size()] == '/';
}

// Whether this call is to fail; errno is set then. What it was goes into the log.
bool fails(const char* what, const char* path, bool* is_short = nullptr) {
  const int number = ++counted;
  const int at = std::atoi(setting("BURIN_FAULT_AT"));
  const bool here = at > 0 && (number == at || (number > at && *setting("BURIN_FAULT_STAYS") == '1'));
  const std::string how = setting("BURIN_FAULT_HOW");
  if (const char* log = std::getenv("BURIN_FAULT_LOG")) {
    static const auto open_real = real<int(const char*, int, ...)>("open");
    static const auto write_real = real<ssize_t(int, const void*, std::size_t)>("write");
    static const auto close_real = real<int(int)>("close");
    const std::string line = std::to_string(number) + " " + what + " " + path + (here ? " " + how : "") + "\n";
    const int file = open_real(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file >= 0) {
      static_cast<void>(!write_real(file, line.data(), line.size()));
      close_real(file);
    }
  }
  if (!here) return false;
  if (how == "die") ::kill(::getpid(), SIGKILL);
  if (how == "short" && is_short != nullptr && number == at) {
    *is_short = true;
    return false;
  }
  errno = how == "eio" ? EIO : how == "eacces" ? EACCES : how == "edquot" ? EDQUOT : ENOSPC;
  return true;
}

void note(int file, bool ours) {
  if (file >= 0 && file < kMostFiles) is_ours[file] = ours;
}

bool ours(int file) { return file >= 0 && file < kMostFiles && is_ours[file]; }

bool writes(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & (O_CREAT | O_TRUNC)) != 0; }

template <typename Open>
int opened(const char* path, int folder, int flags, const Open& open_it) {
  const bool mine = writes(flags) && is_below(folder, path);
  if (mine && fails("open", path)) return -1;
  const int file = open_it();
  note(file, mine);
  return file;
}

FILE* opened_stream(const char* name, const char* path, const char* mode) {
  const bool mine = std::strpbrk(mode, "wa+") != nullptr && is_below(AT_FDCWD, path);
  if (mine && fails("open", path)) return nullptr;
  FILE* file = real<FILE*(const char*, const char*)>(name)(path, mode);
  if (file != nullptr) note(fileno(file), mine);
  return file;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return opened(path, AT_FDCWD, flags, [&] { return real<int(const char*, int, ...)>("open")(path, flags, mode); });
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return opened(path, AT_FDCWD, flags, [&] { return real<int(const char*, int, ...)>("open64")(path, flags, mode); });
}
int openat(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return opened(path, folder, flags,
                [&] { return real<int(int, const char*, int, ...)>("openat")(folder, path, flags, mode); });
}
int openat64(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return opened(path, folder, flags,
                [&] { return real<int(int, const char*, int, ...)>("openat64")(folder, path, flags, mode); });
}
int creat(const char* path, mode_t mode) {
  return opened(path, AT_FDCWD, O_WRONLY | O_CREAT,
                [&] { return real<int(const char*, mode_t)>("creat")(path, mode); });
}
FILE* fopen(const char* path, const char* mode) { return opened_stream("fopen", path, mode); }
FILE* fopen64(const char* path, const char* mode) { return opened_stream("fopen64", path, mode); }

ssize_t write(int file, const void* bytes, size_t count) {
  const auto write_it = real<ssize_t(int, const void*, size_t)>("write");
  bool is_short = false;
  if (ours(file) && fails("write", "", &is_short)) return -1;
  return write_it(file, bytes, is_short ? count / 2 : count);
}
ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  if (ours(file) && fails("pwrite", "")) return -1;
  return real<ssize_t(int, const void*, size_t, off_t)>("pwrite")(file, bytes, count, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t at) {
  if (ours(file) && fails("pwrite", "")) return -1;
  return real<ssize_t(int, const void*, size_t, off64_t)>("pwrite64")(file, bytes, count, at);
}
ssize_t writev(int file, const struct iovec* parts, int count) {
  if (ours(file) && fails("writev", "")) return -1;
  return real<ssize_t(int, const struct iovec*, int)>("writev")(file, parts, count);
}
ssize_t sendfile(int to, int from, off_t* at, size_t count) {
  if (ours(to) && fails("sendfile", "")) return -1;
  return real<ssize_t(int, int, off_t*, size_t)>("sendfile")(to, from, at, count);
}
ssize_t copy_file_range(int from, off64_t* from_at, int to, off64_t* to_at, size_t count, unsigned flags) {
  if (ours(to) && fails("copy_file_range", "")) return -1;
  return real<ssize_t(int, off64_t*, int, off64_t*, size_t, unsigned)>("copy_file_range")(from, from_at, to, to_at,
                                                                                          count, flags);
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  if (file != stdout && file != stderr && ours(fileno(file)) && fails("fwrite", "")) return 0;
  return real<size_t(const void*, size_t, size_t, FILE*)>("fwrite")(bytes, size, count, file);
}
int fflush(FILE* file) {
  if (file != nullptr && file != stdout && file != stderr && ours(fileno(file)) && fails("fflush", "")) return EOF;
  return real<int(FILE*)>("fflush")(file);
}
int fclose(FILE* file) {
  const int number = fileno(file);
  const bool mine = ours(number), bad = mine && fails("fclose", "");
  const int error = errno;
  note(number, false);
  const int done = real<int(FILE*)>("fclose")(file);
  if (bad) errno = error;
  return bad ? EOF : done;
}
int fsync(int file) {
  if (ours(file) && fails("fsync", "")) return -1;
  return real<int(int)>("fsync")(file);
}
int fdatasync(int file) {
  if (ours(file) && fails("fdatasync", "")) return -1;
  return real<int(int)>("fdatasync")(file);
}
int close(int file) {
  const bool bad = ours(file) && fails("close", "");
  const int error = errno;
  note(file, false);
  const int done = real<int(int)>("close")(file);
  if (bad) errno = error;
  return bad ? -1 : done;
}
int ftruncate(int file, off_t size) {
  if (ours(file) && fails("ftruncate", "")) return -1;
  return real<int(int, off_t)>("ftruncate")(file, size);
}
int fchmod(int file, mode_t mode) {
  if (ours(file) && fails("fchmod", "")) return -1;
  return real<int(int, mode_t)>("fchmod")(file, mode);
}
int rename(const char* from, const char* to) {
  if (is_below(AT_FDCWD, to) && fails("rename", to)) return -1;
  return real<int(const char*, const char*)>("rename")(from, to);
}
int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  if (is_below(to_folder, to) && fails("renameat", to)) return -1;
  return real<int(int, const char*, int, const char*)>("renameat")(from_folder, from, to_folder, to);
}
int link(const char* from, const char* to) {
  if (is_below(AT_FDCWD, to) && fails("link", to)) return -1;
  return real<int(const char*, const char*)>("link")(from, to);
}
int unlink(const char* path) {
  if (is_below(AT_FDCWD, path) && fails("unlink", path)) return -1;
  return real<int(const char*)>("unlink")(path);
}
int remove(const char* path) {
  if (is_below(AT_FDCWD, path) && fails("remove", path)) return -1;
  return real<int(const char*)>("remove")(path);
}
int mkdir(const char* path, mode_t mode) {
  if (is_below(AT_FDCWD, path) && fails("mkdir", path)) return -1;
  return real<int(const char*, mode_t)>("mkdir")(path, mode);
}
int mkdirat(int folder, const char* path, mode_t mode) {
  if (is_below(folder, path) && fails("mkdir", path)) return -1;
  return real<int(int, const char*, mode_t)>("mkdirat")(folder, path, mode);
}
int flock(int file, int operation) {
  // EWOULDBLOCK is what a held lock says; this one is a disk that knows none.
  if (ours(file) && fails("flock", "")) return -1;
  return real<int(int, int)>("flock")(file, operation);
}

}  // extern "C"

#include "tools/output_mode.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/named_paths.h"
#include "tools/standard_streams.h"
#include "tools/stop_signal.h"

namespace burin {
namespace {

// The real standard output and error, for a thread that ends the process.
std::atomic<int> real_descriptors[] = {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO};

void write_whole(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(descriptor, text.data(), text.size());
    if (n <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

// Redirects a file descriptor to an unnamed file until its restoration.
class Caught {
 public:
  Caught(std::FILE* stream, int descriptor)
      : stream_(stream), descriptor_(descriptor), file_(std::tmpfile(), &std::fclose) {
    std::fflush(stream_);
    before_ = fcntl(descriptor_, F_DUPFD_CLOEXEC, 3);
    real_descriptors[descriptor_] = before_;
    if (!file_ || before_ < 0 || dup2(fileno(file_.get()), descriptor_) < 0)
      fail("--json, --quiet", "what the command says cannot be caught", "make room in the folder for temporary files");
  }
  ~Caught() { give_back(); }
  Caught(const Caught&) = delete;
  Caught& operator=(const Caught&) = delete;

  /// Restores the descriptor and returns the captured text.
  std::string text() {
    give_back();
    std::rewind(file_.get());
    std::string out;
    char part[4096];
    for (std::size_t n; (n = std::fread(part, 1, sizeof part, file_.get())) > 0;) out.append(part, n);
    return out;
  }

 private:
  void give_back() {
    if (before_ < 0) return;
    std::fflush(stream_);
    dup2(before_, descriptor_);
    real_descriptors[descriptor_] = descriptor_;
    close(before_);
    before_ = -1;
  }

  std::FILE* stream_;
  int descriptor_, before_ = -1;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end > at) lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

std::string json_result;

Json as_json(const std::vector<std::string>& arguments, int exit_code, const std::string& out, const std::string& err,
             const std::vector<std::filesystem::path>& files) {
  Json json;
  json["burin"] = BURIN_VERSION;
  if (const std::size_t at = place_of_command(arguments); at < arguments.size()) json["command"] = arguments[at];
  json["exit_code"] = exit_code;
  json["said"] = lines_of(out);
  for (const char* list : {"notes", "warnings", "errors", "files"}) json[list] = Json::array();
  for (const std::string& line : lines_of(err)) {
    constexpr std::string_view kNote = "note: ", kWarning = "warning: ", kError = "error: ", kBurin = "burin: ";
    if (line.starts_with(kNote))
      json["notes"].push_back(line.substr(kNote.size()));
    else if (line.starts_with(kWarning))
      json["warnings"].push_back(line.substr(kWarning.size()));
    else if (line.starts_with(kError))
      json["errors"].push_back(line.substr(kError.size()));
    else
      json["errors"].push_back(line.starts_with(kBurin) ? line.substr(kBurin.size()) : line);
  }
  for (const std::filesystem::path& file : files) json["files"].push_back(file.string());
  constexpr std::string_view kNext = "next: burin ";
  if (const std::size_t at = out.rfind(kNext); at != std::string::npos) {
    const std::size_t from = at + kNext.size() - std::string_view("burin ").size();
    json["next"] = out.substr(from, out.find('\n', from) - from);
  }
  return json;
}

}  // namespace

std::size_t words_of_program_option(const std::string& word) {
  for (const char* flag : {"--json", "--quiet", "--version"})
    if (word == flag) return 1;
  for (const std::string name : {"--threads", "--simd"})
    if (word == name || word.starts_with(name + "=")) return word == name ? 2 : 1;
  return 0;
}

std::size_t place_of_command(const std::vector<std::string>& arguments) {
  std::size_t at = 0;
  while (at < arguments.size() && arguments[at].starts_with("--"))
    at += std::max<std::size_t>(1, words_of_program_option(arguments[at]));
  return at;
}

OutputMode take_output_mode(std::vector<std::string>& arguments) {
  OutputMode mode = OutputMode::words;
  for (std::size_t i = 0; i < arguments.size() && arguments[i].starts_with("--");) {
    if (arguments[i] == "--json" || arguments[i] == "--quiet") {
      mode = arguments[i] == "--json" ? OutputMode::json : OutputMode::quiet;
      arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      i += std::max<std::size_t>(1, words_of_program_option(arguments[i]));
    }
  }
  return mode;
}

void say_at_the_end(OutputMode mode, const std::vector<std::string>& arguments, const std::string& sentence,
                    int exit_code) {
  const int err = real_descriptors[STDERR_FILENO];
  if (mode == OutputMode::json) {
    const Json json = as_json(arguments, exit_code, "", sentence + "\n", {});
    write_whole(real_descriptors[STDOUT_FILENO], json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    return;
  }
  if (isatty(err) == 1) write_whole(err, "\r\x1b[K");  // clears a progress bar
  write_whole(err, "burin: " + sentence + "\n");
}

void set_json_result(std::string json) { json_result = std::move(json); }

void say_meanwhile(const std::string& sentence) {
  const int err = real_descriptors[STDERR_FILENO];
  write_whole(err, (isatty(err) == 1 ? "\r\x1b[K" : "") + ("note: " + sentence + "\n"));
}

int run_in_mode(OutputMode mode, const std::vector<std::string>& arguments, const std::function<int()>& work) {
  if (mode == OutputMode::words) return work();
  std::string out, err;
  int exit_code = 0;
  {
    Caught caught_out(stdout, STDOUT_FILENO), caught_err(stderr, STDERR_FILENO);
    exit_code = work();
    out = caught_out.text();
    err = caught_err.text();
  }
  take_last_word();
  if (mode == OutputMode::quiet)
    tell(err);
  else if (exit_code == 0 && !json_result.empty())
    fmt::print("{}\n", json_result);
  else
    fmt::print(
        "{}\n",
        as_json(arguments, exit_code, out, err, written_files()).dump(1, ' ', false, Json::error_handler_t::replace));
  return exit_code;
}

}  // namespace burin

// tools/studio/studio.h - the folder that `burin studio` has open: its state for the page, and the page's actions.
//
// The studio decides nothing. Work is a command of this program in a process of its own (work.h). Edits go into the
// project's files, and only if the program's own readers accept the result. All functions are thread-safe, and throw
// Error for a bad request.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

#include "burin/base/files/json_file.h"
#include "tools/studio/work.h"

namespace burin {

/// Largest upload of a picture or photo.
inline constexpr std::uintmax_t kMostPicture_bytes = 300'000'000;

/// A file that a page may load: its bytes and its media type.
struct StudioFile {
  std::string bytes, type;
  bool is_page = false;  ///< HTML: it gets a sandbox, because a project may come from a stranger
};

/// Receives the body of an upload piece by piece: calls its argument per piece, which returns false to end it.
using UploadBody = std::function<bool(const std::function<bool(const char*, std::size_t)>&)>;

class Studio {
 public:
  /// `folder`: a project, or the folder of a project to be made.
  explicit Studio(std::filesystem::path folder);

  /// Waits until the state differs from revision `seen`, at most `longest`, and returns it. `looks`: photos are to be
  /// judged meanwhile.
  Json wait_for_state(std::uint64_t seen, bool looks, std::chrono::milliseconds longest);

  /// The part of the state that a phone gets: wanted shots, the latest judgments and the geometry of the setup.
  Json wait_for_shots(std::uint64_t seen, std::chrono::milliseconds longest);

  /// Begins one of the fixed actions: { "action": "new" | "loop" | "print" | ... } with its checked values.
  void begin(const Json& wish);
  void stop();

  /// Changes design.json or bench.json: { "what": "view" | "place" | "undo", ... }.
  void edit(const Json& change);

  /// Stores a picture for the board, or a photo of it, under a name made from `name`. Returns { file, ... }.
  Json add_picture(const std::string& name, const UploadBody& body);
  Json add_photo(const std::string& name, const std::string& lamp, const UploadBody& body);
  /// Stores a painted mask of a view's picture and enters it in design.json.
  void set_mask(const std::string& view, const UploadBody& body);
  void remove_picture(const std::string& file);

  /// A file below the folder. Throws Error for a path that leads out, and for a kind that pages do not need.
  StudioFile file(const std::string& path) const;
  /// A picture as the program reads it, small, and a view's target as it lies on the board (PNG).
  StudioFile thumbnail(const std::string& path);
  StudioFile target(const std::string& view, bool mask);

  void set_phone_address(const std::string& address);
  std::string phone_address() const;

  /// Ends waiting requests; asks the running commands to end if `with_work`.
  void end(bool with_work);

  /// Ends the judge of photos when no page looks at it any more. Call it now and then.
  void tidy();

 private:
  bool is_made() const;
  std::filesystem::path workshop() const;
  std::filesystem::path staging() const;  // the workshop before the project exists
  void look();                            // mutex_ held
  void refresh_status(std::unique_lock<std::mutex>& lock);
  Json state();
  Json project_json() const;
  Json pictures() const;
  std::string fingerprint() const;
  void change_file(const std::string& name, const std::function<void(Json&)>& change);
  void undo();
  void keep_former(const std::string& name, const std::string& text);
  std::filesystem::path store(const UploadBody& body, std::uintmax_t most_bytes) const;

  std::filesystem::path folder_;
  mutable std::mutex mutex_, pictures_mutex_;  // the second: one picture is decoded at a time
  std::condition_variable changed_;
  std::uint64_t revision_ = 1;
  std::string seen_files_, at_work_, phone_address_;
  Json known_, status_;  // known_: project_json() of seen_files_
  bool status_is_old_ = true, status_is_made_ = false, status_runs_ = false, ending_ = false;
  StudioWork work_{"work"}, judge_{"judge"};
  std::chrono::steady_clock::time_point looked_{}, wanted_judge_{}, status_at_{};
  std::string judged_files_;  // the photos when the judge ended by itself
};

}  // namespace burin

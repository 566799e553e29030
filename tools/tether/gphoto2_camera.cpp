#include <fmt/format.h>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "tools/tether/tethered_camera.h"

#ifdef BURIN_GPHOTO2
#include <gphoto2/gphoto2.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "burin/base/files/json_file.h"
#include "burin/base/files/table.h"
#include "burin/capture/exif.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Stores the messages of libgphoto2. The latest one has more detail than a call's error code.
void keep_text(GPContext*, const char* text, void* into) { *static_cast<std::string*>(into) = text; }

[[noreturn]] void fail_camera(int code, const std::string& text, const std::string& doing) {
  const std::string says = fmt::format("{} ({})", doing, text.empty() ? gp_result_as_string(code) : text);
  switch (code) {
    case GP_ERROR_IO_USB_CLAIM:
    case GP_ERROR_IO_LOCK:
    case GP_ERROR_CAMERA_BUSY:
      fail("the camera", says + ": another program holds it",
           "desktops mount cameras by themselves: gio mount -s gphoto2 lets go of it; close photo programs, and try "
           "again");
    case GP_ERROR_MODEL_NOT_FOUND:
    case GP_ERROR_UNKNOWN_PORT:
      fail("the camera", says + ": there is none",
           "plug it in, switch it on, and set its USB connection to PTP or \"PC remote\" (not to mass storage)");
    case GP_ERROR_IO:
    case GP_ERROR_IO_READ:
    case GP_ERROR_IO_WRITE:
    case GP_ERROR_IO_USB_FIND:
    case GP_ERROR_TIMEOUT:
      fail("the camera", says + ": it does not answer",
           "check cable and battery, switch its automatic power-off off, and begin again: photos so far are kept");
    case GP_ERROR_NO_SPACE:
      fail("the camera", says + ": its card is full", "make room on the card");
    default:
      fail("the camera", says, "switch it off and on, and try again");
  }
}

struct FreeWidget {
  void operator()(CameraWidget* widget) const { gp_widget_free(widget); }
};
using Widget = std::unique_ptr<CameraWidget, FreeWidget>;

// Longest wait of one call for an event.
constexpr int kQuiet_ms = 300;
// Waiting times since the latest file: for an unknown number of files, and for a missing file.
constexpr std::chrono::milliseconds kUnknownFiles(3000), kMissingFile(15000);

// One release of the shutter and its files.
struct Release {
  std::vector<CameraFilePath> on_card;
  std::vector<fs::path> files;  // copies on disk
  std::optional<Exif> exif;     // of the first one with an exposure
};

std::string stem_of(const CameraFilePath& path) { return fs::path(path.name).stem().string(); }
std::string ending_of(const CameraFilePath& path) { return lower_case(fs::path(path.name).extension().string()); }

bool has_ending(const Release& release, const CameraFilePath& path) {
  return std::any_of(release.on_card.begin(), release.on_card.end(),
                     [&](const CameraFilePath& other) { return ending_of(other) == ending_of(path); });
}

std::size_t kinds_of(const Release& release) {
  std::set<std::string> endings;
  for (const CameraFilePath& path : release.on_card) endings.insert(ending_of(path));
  return endings.size();
}

bool is_of_one_exposure(const Exif& a, const Exif& b) {
  constexpr double kStops = 0.1, kSeconds = 1.5;
  return std::abs(std::log2(*a.exposure_s / *b.exposure_s)) < kStops &&
         (!a.time_s || !b.time_s || std::abs(*a.time_s - *b.time_s) < kSeconds);
}

}  // namespace

struct TetheredCamera::State {
  std::string text;  // of libgphoto2
  GPContext* context = nullptr;
  Camera* camera = nullptr;
  bool connected = false;
  std::string model;
  std::vector<double> shutters_s;
  std::vector<std::pair<double, std::string>> dial;         // times, and the camera's texts for them
  std::vector<std::pair<std::string, std::string>> former;  // changed settings: name, original value
  std::vector<Release> releases;
  std::size_t kinds_of_one = 0;  // number of file types per release (raw, JPEG); 0: unknown

  State() {
    context = gp_context_new();
    gp_context_set_error_func(context, keep_text, &text);
  }
  ~State() {
    if (connected) gp_camera_exit(camera, context);
    if (camera != nullptr) gp_camera_unref(camera);
    gp_context_unref(context);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void must(int code, const std::string& doing) const {
    if (code < GP_OK) fail_camera(code, text, doing);
  }

  // Returns a setting of the camera; nothing if it has none of that name.
  Widget setting(const std::string& name) const {
    CameraWidget* widget = nullptr;
    const int code = gp_camera_get_single_config(camera, name.c_str(), &widget, context);
    if (code == GP_ERROR_IO || code == GP_ERROR_IO_READ || code == GP_ERROR_TIMEOUT || code == GP_ERROR_CAMERA_BUSY)
      must(code, "its settings cannot be read");
    return Widget(code < GP_OK ? nullptr : widget);
  }

  static std::string value_of(CameraWidget* widget) {
    const char* value = nullptr;
    return gp_widget_get_value(widget, static_cast<void*>(&value)) < GP_OK || value == nullptr ? "" : value;
  }

  static bool is_choice(CameraWidget* widget) {
    CameraWidgetType type{};
    int readonly = 1;
    return gp_widget_get_type(widget, &type) >= GP_OK && (type == GP_WIDGET_RADIO || type == GP_WIDGET_MENU) &&
           gp_widget_get_readonly(widget, &readonly) >= GP_OK && readonly == 0;
  }

  static std::vector<std::string> choices_of(CameraWidget* widget) {
    std::vector<std::string> out;
    for (int i = 0; i < gp_widget_count_choices(widget); ++i) {
      const char* choice = nullptr;
      if (gp_widget_get_choice(widget, i, &choice) >= GP_OK && choice != nullptr) out.emplace_back(choice);
    }
    return out;
  }

  // Sets a value and stores the original one at the first change.
  int set(const std::string& name, const std::string& value) {
    const Widget widget = setting(name);
    if (!widget) return GP_ERROR_NOT_SUPPORTED;
    const std::string before = value_of(widget.get());
    if (before == value) return GP_OK;
    int code = gp_widget_set_value(widget.get(), value.c_str());
    if (code >= GP_OK) code = gp_camera_set_single_config(camera, name.c_str(), widget.get(), context);
    if (code >= GP_OK && std::none_of(former.begin(), former.end(), [&](const auto& f) { return f.first == name; }))
      former.emplace_back(name, before);
    return code;
  }

  void connect(const std::string& port);
  void read_dial();
  void fix_iso();
  void keep_on_card();
  void read_formats();
  fs::path download(const CameraFilePath& path, const fs::path& folder) const;
  std::size_t release_of(const CameraFilePath& path, const std::optional<Exif>& exif) const;
  void take_in(const CameraFilePath& path, const fs::path& folder, std::vector<LateFile>& late);
  CameraEventType take_in_next(const fs::path& folder, std::vector<LateFile>& late);
};

void TetheredCamera::State::connect(const std::string& port) {
  CameraList* made = nullptr;
  must(gp_list_new(&made), "libgphoto2 has no memory");
  const std::unique_ptr<CameraList, int (*)(CameraList*)> list(made, gp_list_free);
  must(gp_camera_autodetect(list.get(), context), "looking for cameras failed");
  std::vector<std::pair<std::string, std::string>> found;  // model, port
  for (int i = 0; i < gp_list_count(list.get()); ++i) {
    const char *name = nullptr, *where = nullptr;
    if (gp_list_get_name(list.get(), i, &name) >= GP_OK && gp_list_get_value(list.get(), i, &where) >= GP_OK)
      found.emplace_back(name, where);
  }
  if (found.empty())
    fail("the camera", "none was found",
         "plug it in, switch it on, and set its USB connection to PTP or \"PC remote\" (not to mass storage)");
  std::string names;
  std::erase_if(found, [&](const auto& camera_there) {
    names += (names.empty() ? "" : "; ") + camera_there.second + " is a " + camera_there.first;
    return !port.empty() && camera_there.second != port;
  });
  if (found.size() != 1)
    fail(port.empty() ? "the camera" : "--port " + port,
         found.empty() ? "there is no camera at that port (" + names + ")" : "there are several (" + names + ")",
         "name the port of the one with --port");
  model = found.front().first;

  must(gp_camera_new(&camera), "libgphoto2 has no memory");
  GPPortInfoList* ports = nullptr;
  must(gp_port_info_list_new(&ports), "libgphoto2 has no memory");
  const std::unique_ptr<GPPortInfoList, int (*)(GPPortInfoList*)> ports_owner(ports, gp_port_info_list_free);
  must(gp_port_info_list_load(ports), "the ports cannot be listed");
  const int at = gp_port_info_list_lookup_path(ports, found.front().second.c_str());
  must(at, "its port " + found.front().second + " is unknown");
  GPPortInfo info{};
  must(gp_port_info_list_get_info(ports, at, &info), "its port " + found.front().second + " is unknown");
  must(gp_camera_set_port_info(camera, info), "its port " + found.front().second + " cannot be used");

  CameraAbilitiesList* models = nullptr;
  must(gp_abilities_list_new(&models), "libgphoto2 has no memory");
  const std::unique_ptr<CameraAbilitiesList, int (*)(CameraAbilitiesList*)> models_owner(models,
                                                                                         gp_abilities_list_free);
  must(gp_abilities_list_load(models, context), "libgphoto2's drivers cannot be listed");
  const int which = gp_abilities_list_lookup_model(models, model.c_str());
  must(which, "libgphoto2 has no driver for a " + model);
  CameraAbilities abilities{};
  must(gp_abilities_list_get_abilities(models, which, &abilities), "libgphoto2 has no driver for a " + model);
  if ((abilities.operations & GP_OPERATION_CAPTURE_IMAGE) == 0)
    fail("the camera", "a " + model + " cannot be released over the cable",
         "take photos by hand, and let `burin watch` judge them as they are copied");
  must(gp_camera_set_abilities(camera, abilities), "its driver cannot be used");
  must(gp_camera_init(camera, context), "the " + model + " cannot be opened");
  connected = true;
}

void TetheredCamera::State::read_dial() {
  const Widget widget = setting("shutterspeed");
  if (widget && is_choice(widget.get()))
    for (const std::string& choice : choices_of(widget.get()))
      if (const double s = seconds_of_dial(choice); s > 0) dial.emplace_back(s, choice);
  std::sort(dial.begin(), dial.end());
  if (dial.size() < 2)
    fail("the camera", "the " + model + " does not let its exposure time be set",
         "turn its dial to M (manual), and begin again");
  for (const auto& [s, choice] : dial) shutters_s.push_back(s);
}

// Automatic ISO would compensate for the exposure time.
void TetheredCamera::State::fix_iso() {
  const Widget widget = setting("iso");
  if (!widget || !is_choice(widget.get()) || !lower_case(value_of(widget.get())).starts_with("auto")) return;
  constexpr double kIso = 100;
  std::string best;
  double distance = INFINITY;
  for (const std::string& choice : choices_of(widget.get())) {
    const double iso = number_in(choice).value_or(0);
    if (!(iso > 0) || std::abs(std::log(iso / kIso)) >= distance) continue;
    distance = std::abs(std::log(iso / kIso));
    best = choice;
  }
  if (!best.empty()) must(set("iso", best), "its automatic ISO cannot be switched off");
}

void TetheredCamera::State::keep_on_card() {
  const Widget widget = setting("capturetarget");
  if (!widget || !is_choice(widget.get())) return;
  for (const std::string& choice : choices_of(widget.get()))
    if (lower_case(choice).find("card") != std::string::npos) {
      set("capturetarget", choice);  // without a card the camera refuses, and keeps photos in its memory
      return;
    }
}

// "RAW + Large Fine JPEG", "NEF+Basic": two files per photo. Without such a setting, the photos show their number.
void TetheredCamera::State::read_formats() {
  for (const char* name : {"imageformat", "imagequality"}) {
    const Widget widget = setting(name);
    if (!widget || !is_choice(widget.get())) continue;
    const std::size_t files = value_of(widget.get()).find('+') == std::string::npos ? 1 : 2;
    kinds_of_one = std::max(kinds_of_one, files);
  }
}

fs::path TetheredCamera::State::download(const CameraFilePath& path, const fs::path& folder) const {
  CameraFile* made = nullptr;
  must(gp_file_new(&made), "libgphoto2 has no memory");
  const std::unique_ptr<CameraFile, int (*)(CameraFile*)> file(made, gp_file_unref);
  must(gp_camera_file_get(camera, path.folder, path.name, GP_FILE_TYPE_NORMAL, file.get(), context),
       fmt::format("{} cannot be copied from it", path.name));
  const char* data = nullptr;
  unsigned long size = 0;
  must(gp_file_get_data_and_size(file.get(), &data, &size), fmt::format("{} cannot be copied from it", path.name));
  const fs::path name = fs::path(path.name).filename();
  fs::path to = folder / name;
  std::error_code ignored;
  for (int i = 2; fs::exists(to, ignored); ++i)
    to = folder / fmt::format("{}-{}{}", name.stem().string(), i, name.extension().string());
  write_file({data, size}, to);
  return to;
}

TetheredCamera::TetheredCamera(const std::string& port) : state_(new State) {
  state_->connect(port);
  try {
    state_->read_dial();
    state_->fix_iso();
    state_->keep_on_card();
    state_->read_formats();
  } catch (...) {
    for (auto it = state_->former.rbegin(); it != state_->former.rend(); ++it) state_->set(it->first, it->second);
    throw;
  }
}

TetheredCamera::~TetheredCamera() {
  try {
    put_back();
  } catch (const Error&) {  // no answer: put_back() reports this to callers that need it
  }
}

const std::string& TetheredCamera::model() const { return state_->model; }

const std::vector<double>& TetheredCamera::shutters_s() const { return state_->shutters_s; }

double TetheredCamera::shutter_s() const {
  const Widget widget = state_->setting("shutterspeed");
  return widget ? seconds_of_dial(State::value_of(widget.get())) : 0;
}

double TetheredCamera::set_shutter(double exposure_s) {
  const auto nearest = std::min_element(state_->dial.begin(), state_->dial.end(), [&](const auto& a, const auto& b) {
    return std::abs(std::log(a.first / exposure_s)) < std::abs(std::log(b.first / exposure_s));
  });
  state_->must(state_->set("shutterspeed", nearest->second), "its exposure time cannot be set to " + nearest->second);
  return nearest->first;
}

// Finds the release of a file. It is an earlier one if it has the same name, or else the same EXIF, and no file of this
// type yet. Otherwise it is the latest one.
std::size_t TetheredCamera::State::release_of(const CameraFilePath& path, const std::optional<Exif>& exif) const {
  const std::size_t last = releases.size() - 1;
  const Release& now = releases[last];
  for (std::size_t i = releases.size(); i-- > 0;) {
    const Release& release = releases[i];
    if (release.on_card.empty() || has_ending(release, path)) continue;  // cameras without a card reuse a name
    if (stem_of(release.on_card.front()) == stem_of(path)) return i;
  }
  if (!exif || (now.exif && is_of_one_exposure(*now.exif, *exif))) return last;
  for (std::size_t i = last; i-- > 0;)
    if (releases[i].exif && !has_ending(releases[i], path) && is_of_one_exposure(*releases[i].exif, *exif)) return i;
  return last;
}

void TetheredCamera::State::take_in(const CameraFilePath& path, const fs::path& folder, std::vector<LateFile>& late) {
  const fs::path file = download(path, folder);
  std::optional<Exif> exif;
  try {
    exif = read_exif(file);
    if (!exif->exposure_s) exif.reset();
  } catch (const Error&) {  // the next reader of the file reports the error
  }
  const std::size_t index = release_of(path, exif);
  Release& release = releases[index];
  if (index + 1 < releases.size()) late.push_back({file, release.files});
  release.on_card.push_back(path);
  release.files.push_back(file);
  if (!release.exif) release.exif = exif;
  if (index + 1 < releases.size()) kinds_of_one = std::max(kinds_of_one, kinds_of(release));
}

CameraEventType TetheredCamera::State::take_in_next(const fs::path& folder, std::vector<LateFile>& late) {
  CameraEventType event{};
  void* data = nullptr;
  must(gp_camera_wait_for_event(camera, kQuiet_ms, &event, &data, context), "it reports no photo");
  const std::unique_ptr<void, void (*)(void*)> owner(data, std::free);
  if (event != GP_EVENT_FILE_ADDED || data == nullptr || releases.empty()) return event;
  const auto& path = *static_cast<const CameraFilePath*>(data);
  // Events also report known files, and a second card's copies. Without a card all photos have the same name.
  const auto has_name = [&](const Release& release) {
    return std::any_of(release.on_card.begin(), release.on_card.end(),
                       [&](const CameraFilePath& other) { return std::string_view(path.name) == other.name; });
  };
  const bool of_last = !releases.back().on_card.empty() && stem_of(releases.back().on_card.front()) == stem_of(path);
  const bool known = of_last ? has_name(releases.back()) : std::any_of(releases.begin(), releases.end(), has_name);
  if (!known && is_photo_name(path.name)) take_in(path, folder, late);
  return event;
}

TakenPhoto TetheredCamera::take(const fs::path& folder, const std::function<bool()>& stopped) {
  using Clock = std::chrono::steady_clock;
  State& s = *state_;
  s.text.clear();
  TakenPhoto out;
  if (!s.releases.empty()) out.late = late_files(folder);
  CameraFilePath path{};
  s.must(gp_camera_capture(s.camera, GP_CAPTURE_IMAGE, &path, s.context), "it took no photo");
  s.releases.emplace_back();
  const auto released = Clock::now();
  auto last_file = released;
  s.take_in(path, folder, out.late);
  const auto all_there = [&] {
    const std::size_t kinds = kinds_of(s.releases.back());  // none if the file belongs to an earlier photo
    if (kinds == 0 || kinds < s.kinds_of_one) return Clock::now() - released > kMissingFile;
    return s.kinds_of_one > 0 || Clock::now() - last_file > kUnknownFiles;
  };
  const auto is_stopped = [&] { return stopped && stopped(); };
  while (!is_stopped()) {
    const CameraEventType event = s.take_in_next(folder, out.late);
    if (event == GP_EVENT_FILE_ADDED) last_file = Clock::now();
    // Some cameras never stop sending events.
    const bool quiet = event == GP_EVENT_TIMEOUT || Clock::now() - last_file > std::chrono::milliseconds(kQuiet_ms);
    if (quiet && all_there()) break;
  }
  out.files = s.releases.back().files;
  if (!is_stopped()) {
    if (out.files.empty())
      fail("the camera", "it was released, and handed no file of that photo over",
           "look whether its card is full or locked, and begin again: photos so far are kept");
    s.kinds_of_one = kinds_of(s.releases.back());
  }
  return out;
}

std::vector<LateFile> TetheredCamera::late_files(const fs::path& folder) {
  State& s = *state_;
  std::vector<LateFile> late;
  if (s.releases.empty()) return late;
  const std::size_t before = s.releases.back().files.size();
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(kQuiet_ms);
  while (s.take_in_next(folder, late) != GP_EVENT_TIMEOUT && std::chrono::steady_clock::now() < until) {
  }
  // A file that arrives after the wait is late for the latest photo too.
  const std::vector<fs::path>& files = s.releases.back().files;
  for (std::size_t i = before; i < files.size(); ++i)
    late.push_back({files[i], {files.begin(), files.begin() + static_cast<std::ptrdiff_t>(before)}});
  s.kinds_of_one = std::max(s.kinds_of_one, kinds_of(s.releases.back()));
  return late;
}

void TetheredCamera::put_back() {
  std::string left;
  while (!state_->former.empty()) {
    const auto [name, value] = state_->former.back();
    state_->former.pop_back();
    const std::size_t others = state_->former.size();
    if (state_->set(name, value) < GP_OK) left += fmt::format("{}{} (was {})", left.empty() ? "" : ", ", name, value);
    state_->former.resize(others);  // set() would store this change as well
  }
  if (!left.empty()) fail("the camera", "could not be set back: " + left, "set that by hand on the camera");
}

}  // namespace burin

#else

namespace burin {

struct TetheredCamera::State {
  std::string model;
  std::vector<double> shutters_s;
};

TetheredCamera::TetheredCamera(const std::string&) {
  fail(
      "--tether", "this Burin was built without libgphoto2",
      "install it and build again: sudo apt-get install libgphoto2-dev && tools/build; or take photos by hand, and let "
      "`burin watch` judge them as they are copied");
}
TetheredCamera::~TetheredCamera() = default;
const std::string& TetheredCamera::model() const { return state_->model; }
const std::vector<double>& TetheredCamera::shutters_s() const { return state_->shutters_s; }
double TetheredCamera::shutter_s() const { return 0; }
double TetheredCamera::set_shutter(double exposure_s) { return exposure_s; }
TakenPhoto TetheredCamera::take(const std::filesystem::path&, const std::function<bool()>&) { return {}; }
std::vector<LateFile> TetheredCamera::late_files(const std::filesystem::path&) { return {}; }
void TetheredCamera::put_back() {}

}  // namespace burin

#endif

#include <fmt/core.h>

#include "burin/render/error.h"
#include "burin/render/files/file_names.h"
#include "tools/tether/tethered_camera.h"

#ifdef BURIN_GPHOTO2
#include <gphoto2/gphoto2.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include "burin/capture/exif.h"
#include "burin/render/files/json_file.h"
#include "burin/render/files/table.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// The texts that libgphoto2 gives while it works: the last one says more than the code that a call returns.
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

}  // namespace

struct TetheredCamera::State {
  std::string text;  // of libgphoto2
  GPContext* context = nullptr;
  Camera* camera = nullptr;
  bool connected = false;
  std::string model;
  std::vector<double> shutters_s;
  std::vector<std::pair<double, std::string>> dial;         // the times, and as the camera writes them
  std::vector<std::pair<std::string, std::string>> former;  // settings that were changed: name, value before

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

  // A setting of the camera; nothing where it has none of that name.
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

  // Sets one, and keeps what it was before the first time.
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
  fs::path download(const CameraFilePath& path, const fs::path& folder) const;
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

// An exposure time says nothing where the camera makes up for it.
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
      set("capturetarget", choice);  // without a card the camera says no, and keeps photos in its memory
      return;
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
  } catch (...) {
    for (auto it = state_->former.rbegin(); it != state_->former.rend(); ++it) state_->set(it->first, it->second);
    throw;
  }
}

TetheredCamera::~TetheredCamera() {
  try {
    put_back();
  } catch (const Error&) {  // it does not answer: whoever wanted to know called put_back()
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

std::vector<fs::path> TetheredCamera::take(const fs::path& folder) {
  State& s = *state_;
  s.text.clear();
  CameraFilePath path{};
  s.must(gp_camera_capture(s.camera, GP_CAPTURE_IMAGE, &path, s.context), "it took no photo");
  std::vector<fs::path> files{s.download(path, folder)};
  // A raw file's JPEG, or the other way round, is told by an event.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (std::chrono::steady_clock::now() < end) {
    constexpr int kWait_ms = 300;
    CameraEventType event{};
    void* data = nullptr;
    s.must(gp_camera_wait_for_event(s.camera, kWait_ms, &event, &data, s.context), "it says nothing of its photo");
    const std::unique_ptr<void, void (*)(void*)> owner(data, std::free);
    if (event == GP_EVENT_FILE_ADDED && data != nullptr) {
      const auto& more = *static_cast<const CameraFilePath*>(data);
      const bool known = std::string(more.name) == path.name && std::string(more.folder) == path.folder;
      if (!known && is_photo_name(more.name)) files.push_back(s.download(more, folder));
    }
    if (event == GP_EVENT_TIMEOUT || event == GP_EVENT_CAPTURE_COMPLETE) break;
  }
  return files;
}

void TetheredCamera::put_back() {
  std::string left;
  while (!state_->former.empty()) {
    const auto [name, value] = state_->former.back();
    state_->former.pop_back();
    const std::size_t others = state_->former.size();
    if (state_->set(name, value) < GP_OK) left += fmt::format("{}{} (was {})", left.empty() ? "" : ", ", name, value);
    state_->former.resize(others);  // set() would keep this change as well
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
std::vector<std::filesystem::path> TetheredCamera::take(const std::filesystem::path&) { return {}; }
void TetheredCamera::put_back() {}

}  // namespace burin

#endif

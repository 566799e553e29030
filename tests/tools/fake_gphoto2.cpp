#include "tests/tools/fake_gphoto2.h"

#include <fmt/format.h>
#include <gphoto2/gphoto2.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <thread>

#include "tests/drawn_dng.h"
#include "tests/temporary_folder.h"
#include "tools/tether/tethered_camera.h"

namespace burin {

FakeCamera& fake_camera() {
  static FakeCamera camera;
  return camera;
}

namespace {

// What lies on its card under that name.
std::string file_on_card(const std::string& name) {
  FakeCamera& fake = fake_camera();
  const FakeCamera::OnCard& on_card = fake.card.at(name);
  Image exposed = fake.scene;
  const auto photo = static_cast<std::size_t>(on_card.photo);
  const double light = photo <= fake.light.size() ? fake.light[photo - 1] : 1;
  for (float& v : exposed.data) v = static_cast<float>(v * on_card.exposure_s * 60 * light);
  DrawnPhoto like = fake.like;
  like.exposure_s = on_card.exposure_s;
  like.taken_at = fmt::format("2024:05:01 12:{:02}:{:02}", on_card.photo / 60, on_card.photo % 60);
  if (name.ends_with(".DNG")) {
    Dng dng;
    dng.width = exposed.width;
    dng.height = exposed.height;
    dng.exposure_s[0] = static_cast<std::uint32_t>(std::lround(1e6 * on_card.exposure_s));
    dng.exposure_s[1] = 1'000'000;
    dng.f_number = static_cast<std::uint32_t>(like.f_number);
    dng.iso = static_cast<std::uint32_t>(like.iso);
    dng.make = "Altair";
    dng.model = like.model;
    for (const float v : exposed.data)
      dng.pixels.push_back(static_cast<std::uint16_t>(
          dng.black + std::lround(std::min(1.0F, v) * static_cast<float>(dng.white - dng.black))));
    return dng_file(dng);
  }
  const auto file = std::filesystem::temp_directory_path() / fmt::format("burin-fake-camera-{}.jpg", ::getpid());
  write_drawn(exposed, like, file);
  const std::string bytes = file_text(file);
  std::filesystem::remove(file);
  return bytes;
}

}  // namespace
}  // namespace burin

using burin::fake_camera;

struct _CameraList {
  std::vector<std::pair<std::string, std::string>> entries;
};
struct _CameraWidget {
  std::string name;
  burin::FakeSetting setting;
};
struct _CameraFile {
  std::string bytes;
};
struct _GPContext {
  GPContextErrorFunc error = nullptr;
  void* data = nullptr;
};
struct _CameraAbilitiesList {};
struct _GPPortInfoList {};

extern "C" {

GPContext* gp_context_new(void) { return new GPContext; }
void gp_context_unref(GPContext* context) { delete context; }
void gp_context_set_error_func(GPContext* context, GPContextErrorFunc func, void* data) {
  context->error = func;
  context->data = data;
}
const char* gp_result_as_string(int code) { return code == GP_ERROR_IO ? "I/O problem" : "Unspecified error"; }

int gp_list_new(CameraList** list) {
  *list = new CameraList;
  return GP_OK;
}
int gp_list_free(CameraList* list) {
  delete list;
  return GP_OK;
}
int gp_list_count(CameraList* list) { return static_cast<int>(list->entries.size()); }
int gp_list_get_name(CameraList* list, int i, const char** name) {
  *name = list->entries[static_cast<std::size_t>(i)].first.c_str();
  return GP_OK;
}
int gp_list_get_value(CameraList* list, int i, const char** value) {
  *value = list->entries[static_cast<std::size_t>(i)].second.c_str();
  return GP_OK;
}
int gp_camera_autodetect(CameraList* list, GPContext*) {
  list->entries = fake_camera().cameras;
  return gp_list_count(list);
}

int gp_port_info_list_new(GPPortInfoList** list) {
  *list = new GPPortInfoList;
  return GP_OK;
}
int gp_port_info_list_free(GPPortInfoList* list) {
  delete list;
  return GP_OK;
}
int gp_port_info_list_load(GPPortInfoList*) { return GP_OK; }
int gp_port_info_list_lookup_path(GPPortInfoList*, const char* path) {
  fake_camera().calls.push_back(std::string("port ") + path);
  return 0;
}
int gp_port_info_list_get_info(GPPortInfoList*, int, GPPortInfo* info) {
  *info = nullptr;
  return GP_OK;
}
int gp_camera_set_port_info(Camera*, GPPortInfo) { return GP_OK; }
int gp_abilities_list_new(CameraAbilitiesList** list) {
  *list = new CameraAbilitiesList;
  return GP_OK;
}
int gp_abilities_list_free(CameraAbilitiesList* list) {
  delete list;
  return GP_OK;
}
int gp_abilities_list_load(CameraAbilitiesList*, GPContext*) { return GP_OK; }
int gp_abilities_list_lookup_model(CameraAbilitiesList*, const char*) { return 0; }
int gp_abilities_list_get_abilities(CameraAbilitiesList*, int, CameraAbilities* abilities) {
  *abilities = CameraAbilities{};
  abilities->operations = static_cast<CameraOperation>(GP_OPERATION_CAPTURE_IMAGE | GP_OPERATION_CONFIG);
  return GP_OK;
}
int gp_camera_set_abilities(Camera*, CameraAbilities) { return GP_OK; }

int gp_camera_new(Camera** camera) {
  *camera = new Camera{};
  return GP_OK;
}
int gp_camera_unref(Camera* camera) {
  delete camera;
  return GP_OK;
}
int gp_camera_init(Camera*, GPContext*) {
  fake_camera().calls.emplace_back("init");
  return fake_camera().init_code;
}
int gp_camera_exit(Camera*, GPContext*) {
  fake_camera().calls.emplace_back("exit");
  return GP_OK;
}

int gp_camera_get_single_config(Camera*, const char* name, CameraWidget** widget, GPContext*) {
  const auto setting = fake_camera().settings.find(name);
  if (setting == fake_camera().settings.end()) return GP_ERROR_BAD_PARAMETERS;
  *widget = new CameraWidget{name, setting->second};
  return GP_OK;
}
int gp_camera_set_single_config(Camera*, const char* name, CameraWidget* widget, GPContext*) {
  if (fake_camera().photos_left < 0) return GP_ERROR_IO;  // pulled out
  fake_camera().settings[name].value = widget->setting.value;
  fake_camera().calls.push_back(std::string("set ") + name + " " + widget->setting.value);
  return GP_OK;
}
int gp_widget_free(CameraWidget* widget) {
  delete widget;
  return GP_OK;
}
int gp_widget_get_value(CameraWidget* widget, void* value) {
  *static_cast<const char**>(value) = widget->setting.value.c_str();
  return GP_OK;
}
int gp_widget_set_value(CameraWidget* widget, const void* value) {
  const std::string wanted = static_cast<const char*>(value);
  for (const std::string& choice : widget->setting.choices)
    if (choice == wanted) {
      widget->setting.value = wanted;
      return GP_OK;
    }
  return GP_ERROR_BAD_PARAMETERS;
}
int gp_widget_get_type(CameraWidget*, CameraWidgetType* type) {
  *type = GP_WIDGET_RADIO;
  return GP_OK;
}
int gp_widget_get_readonly(CameraWidget* widget, int* readonly) {
  *readonly = widget->setting.readonly ? 1 : 0;
  return GP_OK;
}
int gp_widget_count_choices(CameraWidget* widget) { return static_cast<int>(widget->setting.choices.size()); }
int gp_widget_get_choice(CameraWidget* widget, int i, const char** choice) {
  *choice = widget->setting.choices[static_cast<std::size_t>(i)].c_str();
  return GP_OK;
}

int gp_camera_capture(Camera*, CameraCaptureType, CameraFilePath* path, GPContext* context) {
  burin::FakeCamera& fake = fake_camera();
  if (fake.photos_left-- <= 0) {
    if (context->error != nullptr) context->error(context, "Could not write to the USB port", context->data);
    return GP_ERROR_IO;
  }
  ++fake.taken;
  const std::string shutter = fake.settings["shutterspeed"].value;
  fake.calls.push_back("capture " + shutter);
  const auto now = std::chrono::steady_clock::now();
  const std::string name = fmt::format("IMG_{:04}.JPG", fake.taken);
  const auto other = fake.takes.find(shutter);
  const double exposure_s = burin::seconds_of_dial(other == fake.takes.end() ? shutter : other->second);
  fake.card[name] = {exposure_s, fake.taken, now, true};
  if (!fake.second_ending.empty())
    fake.card[fmt::format("{}{:04}{}", fake.second_prefix, fake.taken, fake.second_ending)] = {
        exposure_s, fake.taken, now + std::chrono::milliseconds(fake.second_after_ms), false};
  std::strcpy(path->folder, "/store_00010001/DCIM/100ALTR");
  std::strcpy(path->name, name.c_str());
  return GP_OK;
}
int gp_camera_wait_for_event(Camera*, int timeout_ms, CameraEventType* event, void** data, GPContext*) {
  burin::FakeCamera& fake = fake_camera();
  *event = GP_EVENT_TIMEOUT;
  *data = nullptr;
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  for (auto& [name, file] : fake.card) {
    if (file.told || file.photo + fake.second_after_photos > fake.taken) continue;
    if (file.told_at > until) {
      std::this_thread::sleep_until(until);
      return GP_OK;
    }
    std::this_thread::sleep_until(file.told_at);
    file.told = true;
    auto* path = static_cast<CameraFilePath*>(std::calloc(1, sizeof(CameraFilePath)));  // freed by who is told
    std::strcpy(path->folder, "/store_00010001/DCIM/100ALTR");
    std::strcpy(path->name, name.c_str());
    *event = GP_EVENT_FILE_ADDED;
    *data = path;
    return GP_OK;
  }
  return GP_OK;
}
int gp_file_new(CameraFile** file) {
  *file = new CameraFile;
  return GP_OK;
}
int gp_file_unref(CameraFile* file) {
  delete file;
  return GP_OK;
}
int gp_camera_file_get(Camera*, const char*, const char* name, CameraFileType, CameraFile* file, GPContext*) {
  fake_camera().calls.push_back(std::string("get ") + name);
  file->bytes = burin::file_on_card(name);
  return GP_OK;
}
int gp_file_get_data_and_size(CameraFile* file, const char** data, unsigned long* size) {
  *data = file->bytes.data();
  *size = file->bytes.size();
  return GP_OK;
}

}  // extern "C"

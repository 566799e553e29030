// tests/tools/fake_gphoto2.h - a camera that is not there: the functions of libgphoto2 that Burin calls, defined by the
// test program, so that no other can be reached. It keeps its settings as cameras do, exposes a drawn scene by its
// shutter time, and writes down what was asked of it.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "tests/drawn_photo.h"

namespace burin {

struct FakeSetting {
  std::string value;
  std::vector<std::string> choices;
  bool readonly = false;
};

struct FakeCamera {
  std::vector<std::pair<std::string, std::string>> cameras{{"Altair M12", "usb:001,004"}};  // model, port
  std::map<std::string, FakeSetting> settings;
  DrawnPhoto like;            ///< what it sees; `paper` as 1/60 s has it
  Image scene;                ///< drawn(like)
  std::vector<double> light;  ///< on it, photo by photo; then 1
  int init_code = 0;
  int photos_left = 1000;                    ///< then the cable is pulled
  std::string second_prefix, second_ending;  ///< a second file that each photo makes: {"IMG_", ".DNG"}; none
  int second_after_ms = 0;                   ///< when it is told of, after the release
  int second_after_photos = 0;               ///< and after how many further releases
  std::map<std::string, std::string> takes;  ///< the time that it takes for one that it is set to, where it is another
  std::vector<std::string> calls;            ///< "set shutterspeed 1/60", "capture 1/60", "get IMG_0001.JPG", "exit"
  int taken = 0;

  struct OnCard {
    double exposure_s = 0;
    int photo = 0;  ///< its number
    std::chrono::steady_clock::time_point told_at;
    bool told = false;
  };
  std::map<std::string, OnCard> card;  ///< by name
};

/// The one that the functions work on.
FakeCamera& fake_camera();

}  // namespace burin

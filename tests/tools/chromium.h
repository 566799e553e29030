// tests/tools/chromium.h - a real browser without a window, for pages that Burin writes: opens them, presses keys,
// drags, asks their scripts, takes pictures. WebGL2 runs in software. Chromium's own protocol over two pipes
// (https://chromedevtools.github.io/devtools-protocol): no port, no further package.
//
//   if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
//   Chromium browser(folder);
//   browser.open(folder / "page.html", 1280, 800);
//   browser.press("ArrowLeft");
//   EXPECT_EQ(browser.evaluate("document.title"), "...");   // may be a promise
//   EXPECT_THAT(browser.complaints(), IsEmpty());           // errors on the console, policies violated, exceptions
//   browser.screenshot("page.png");
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace burin {

class Chromium {
 public:
  using Json = nlohmann::json;
  static constexpr const char* kMissing = "needs Chromium: tools/install-packages chromium";

  static bool is_installed() { return std::system("command -v chromium >/dev/null 2>&1") == 0; }

  /// Starts one; its profile lies in `folder`. Throws std::runtime_error where it does not answer.
  explicit Chromium(const TemporaryFolder& folder) {
    start(folder.path() / "chromium-profile");
    const Json target = command("Target.createTarget", {{"url", "about:blank"}});
    session_ = command("Target.attachToTarget", {{"targetId", target["targetId"]}, {"flatten", true}})["sessionId"];
    for (const char* domain : {"Page", "Runtime", "Log", "Network"}) command(std::string(domain) + ".enable");
  }
  ~Chromium() {
    ::kill(-process_, SIGKILL);  // its own group: helpers included
    ::waitpid(process_, nullptr, 0);
    ::close(to_);
    ::close(from_);
  }
  Chromium(const Chromium&) = delete;
  Chromium& operator=(const Chromium&) = delete;

  /// Shows a file in a window of that size, `fragment` (without #) appended to its address, and waits until it is
  /// loaded. A phone has a touch screen. `dark`: what the page is told of the person's wishes.
  void open(const std::filesystem::path& file, int width, int height, const std::string& fragment = "",
            bool phone = false, bool dark = false) {
    std::string address = "file://";
    for (const char c : std::filesystem::absolute(file).string())
      address += c == ' ' ? "%20" : c == '#' ? "%23" : c == '%' ? "%25" : std::string(1, c);
    open_address(address + (fragment.empty() ? "" : "#" + fragment), width, height, phone, dark);
  }

  /// The same for a page of a server on this machine.
  void open_address(const std::string& address, int width, int height, bool phone = false, bool dark = false) {
    requests_.clear();
    resize(width, height, phone);
    command("Emulation.setTouchEmulationEnabled", {{"enabled", phone}});
    command("Emulation.setEmulatedMedia",
            {{"features", {{{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}}}}});
    navigate("about:blank");  // a new fragment alone would load nothing
    complaints_.clear();
    navigate(address);
  }

  void resize(int width, int height, bool phone = false) {
    command("Emulation.setDeviceMetricsOverride",
            {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", phone}});
  }

  /// Chooses files in an input of the page, as its dialog does.
  void choose_files(const std::string& selector, const std::vector<std::string>& files) {
    const Json root = command("DOM.getDocument")["root"]["nodeId"];
    const Json input = command("DOM.querySelector", {{"nodeId", root}, {"selector", selector}})["nodeId"];
    command("DOM.setFileInputFiles", {{"nodeId", input}, {"files", files}});
  }

  /// The value of an expression in the page, a promise's when it is kept. Throws std::runtime_error for an exception.
  Json evaluate(const std::string& expression) {
    const Json answer =
        command("Runtime.evaluate",
                {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}, {"userGesture", true}});
    if (answer.contains("exceptionDetails"))
      throw std::runtime_error(expression + ": " + answer["exceptionDetails"].dump());
    return answer["result"].contains("value") ? answer["result"]["value"] : Json();
  }

  /// Presses a key by its DOM name: "ArrowLeft", "Tab", "Enter", " ", "f".
  void press(const std::string& key, int modifiers = 0) {
    Json event{{"key", key}, {"modifiers", modifiers}};
    static const std::map<std::string, int> codes{{"ArrowLeft", 37}, {"ArrowUp", 38}, {"ArrowRight", 39},
                                                  {"ArrowDown", 40}, {"Tab", 9},      {"Enter", 13},
                                                  {"Escape", 27},    {"Home", 36},    {"End", 35}};
    const auto code = codes.find(key);
    event["windowsVirtualKeyCode"] = code != codes.end() ? code->second : std::toupper(key.front());
    if (key.size() == 1) event["text"] = key;
    if (key == "Enter") event["text"] = "\r";
    event["type"] = "keyDown";
    command("Input.dispatchKeyEvent", event);
    event.erase("text");
    event["type"] = "keyUp";
    command("Input.dispatchKeyEvent", event);
  }

  /// Presses at one place of the window, moves to the other and lets go: by mouse, or by finger. Pixels.
  void drag(double x0, double y0, double x1, double y1, bool touch = false) {
    constexpr int kSteps = 8;
    for (int i = 0; i <= kSteps + 1; ++i) {
      const double part = std::min(i, kSteps) / static_cast<double>(kSteps);
      const double x = x0 + part * (x1 - x0), y = y0 + part * (y1 - y0);
      const bool first = i == 0, last = i == kSteps + 1;
      if (touch) {
        Json points = Json::array();
        if (!last) points.push_back({{"x", x}, {"y", y}});
        command("Input.dispatchTouchEvent", {{"type", first  ? "touchStart"
                                                      : last ? "touchEnd"
                                                             : "touchMove"},
                                             {"touchPoints", points}});
      } else {
        command("Input.dispatchMouseEvent", {{"type", first  ? "mousePressed"
                                                      : last ? "mouseReleased"
                                                             : "mouseMoved"},
                                             {"x", x},
                                             {"y", y},
                                             {"button", "left"},
                                             {"buttons", last ? 0 : 1},
                                             {"clickCount", 1}});
      }
    }
  }

  /// What the window shows, as a PNG; the whole page, however long, with `whole_page`.
  void screenshot(const std::filesystem::path& png, bool whole_page = false) {
    const Json answer = command("Page.captureScreenshot", {{"format", "png"}, {"captureBeyondViewport", whole_page}});
    std::ofstream(png, std::ios::binary) << from_base64(answer["data"].get<std::string>());
  }

  /// What the page's scripts and its policy complained about since it was opened.
  std::vector<std::string> complaints() {
    evaluate("0");  // what was on its way has arrived
    return complaints_;
  }

  /// The addresses that it asked for since it was opened, its own and data: ones left out.
  std::vector<std::string> requests() {
    evaluate("0");
    return requests_;
  }

  /// Any command of the protocol, sent to the page; its result. Throws std::runtime_error for an error or no answer.
  Json command(const std::string& method, const Json& parameters = Json::object()) {
    const int id = ++last_id_;
    Json message{{"id", id}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t n = ::write(to_, text.data() + done, text.size() - done);
      if (n <= 0) throw std::runtime_error("chromium does not listen");
      done += static_cast<std::size_t>(n);
    }
    while (true) {
      const Json answer = receive();
      if (answer.value("id", 0) != id) {
        keep(answer);
      } else if (answer.contains("error")) {
        throw std::runtime_error(method + ": " + answer["error"].dump());
      } else {
        return answer["result"];
      }
    }
  }

  /// A base64 text's bytes (canvas.toDataURL, screenshots); what precedes a comma is left out.
  static std::string from_base64(const std::string& text) {
    std::string bytes;
    unsigned int bits = 0;
    int count = 0;
    const std::size_t comma = text.find(',');
    for (std::size_t i = comma == std::string::npos ? 0 : comma + 1; i < text.size(); ++i) {
      static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
      const std::size_t digit = kDigits.find(text[i]);
      if (digit == std::string::npos) continue;
      bits = bits << 6 | static_cast<unsigned int>(digit);
      count += 6;
      if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
    }
    return bytes;
  }

 private:
  static constexpr int kPatience_s = 120;  // software rendering on a busy machine

  void start(const std::filesystem::path& profile) {
    std::array<int, 2> to{}, from{};
    if (::pipe2(to.data(), O_CLOEXEC) != 0 || ::pipe2(from.data(), O_CLOEXEC) != 0)
      throw std::runtime_error("no pipe to chromium");
    const std::string profile_option = "--user-data-dir=" + profile.string();
    ::signal(SIGPIPE, SIG_IGN);
    process_ = ::fork();
    if (process_ == 0) {
      ::setpgid(0, 0);
      // The protocol's places are 3 and 4; copies first, since a pipe may lie there already.
      const int in = ::fcntl(to[0], F_DUPFD, 10), out = ::fcntl(from[1], F_DUPFD, 10);
      ::dup2(in, 3);
      ::dup2(out, 4);
      const int nothing = ::open("/dev/null", O_RDWR);
      for (const int fd : {0, 1, 2}) ::dup2(nothing, fd);
      ::execlp("chromium", "chromium", "--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--use-gl=angle",
               "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--hide-scrollbars",
               "--no-first-run", "--disable-dev-shm-usage", "--disable-background-networking", profile_option.c_str(),
               static_cast<char*>(nullptr));
      ::_exit(127);
    }
    ::setpgid(process_, process_);
    ::close(to[0]);
    ::close(from[1]);
    to_ = to[1];
    from_ = from[0];
  }

  Json receive() {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(kPatience_s);
    std::size_t end = 0;
    while ((end = buffer_.find('\0')) == std::string::npos) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
      pollfd ready{from_, POLLIN, 0};
      const int polled = ::poll(&ready, 1, static_cast<int>(std::max<long long>(0, left.count())));
      if (polled < 0 && errno == EINTR) continue;
      std::array<char, 65536> bytes;
      const ssize_t n = polled > 0 ? ::read(from_, bytes.data(), bytes.size()) : 0;
      if (n <= 0) throw std::runtime_error("chromium does not answer");
      buffer_.append(bytes.data(), static_cast<std::size_t>(n));
    }
    const Json message = Json::parse(buffer_.substr(0, end));
    buffer_.erase(0, end + 1);
    return message;
  }

  void navigate(const std::string& url) {
    const int before = loads_;
    const Json answer = command("Page.navigate", {{"url", url}});
    if (answer.contains("errorText")) throw std::runtime_error(url + ": " + answer["errorText"].dump());
    while (loads_ == before) keep(receive());
  }

  void keep(const Json& event) {
    const std::string method = event.value("method", "");
    if (method == "Page.loadEventFired") {
      ++loads_;
    } else if (method == "Runtime.exceptionThrown") {
      complaints_.push_back(event["params"]["exceptionDetails"].dump());
    } else if (method == "Runtime.consoleAPICalled") {
      const std::string type = event["params"]["type"];
      if (type == "error" || type == "warning" || type == "assert")
        complaints_.push_back(event["params"]["args"].dump());
    } else if (method == "Log.entryAdded") {
      const Json& entry = event["params"]["entry"];
      // A driver's word on its own speed, when a picture is read back, says nothing of the page.
      const bool of_speed =
          std::string(entry["text"]).find("GL Driver Message (OpenGL, Performance") != std::string::npos;
      if (!of_speed && (entry["level"] == "error" || entry["level"] == "warning")) complaints_.push_back(entry["text"]);
    } else if (method == "Network.requestWillBeSent") {
      const std::string url = event["params"]["request"]["url"];
      const std::string own = event["params"].value("documentURL", "");
      if (url.rfind("data:", 0) != 0 && url != own && url.rfind("about:", 0) != 0) requests_.push_back(url);
    }
  }

  pid_t process_ = -1;
  int to_ = -1, from_ = -1, last_id_ = 0, loads_ = 0;
  std::string session_, buffer_;
  std::vector<std::string> complaints_, requests_;
};

}  // namespace burin

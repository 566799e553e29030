// tests/tools/studio_under_test.h - `burin studio` as a process of its own, and requests to it byte by byte, so that
// wrong ones can be sent too.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/places.h"

namespace burin {

struct StudioReply {
  int status = 0;  ///< 0: the connection ended without an answer
  std::string head, body;

  nlohmann::json json() const { return nlohmann::json::parse(body, nullptr, false); }
};

/// One address of a studio, with its cookie.
struct StudioDoor {
  std::string address, ip, host, cookie;
  int port = 0;

  explicit StudioDoor(std::string printed = "") : address(std::move(printed)) {
    if (address.empty()) return;
    const std::size_t ip_at = std::string("http://").size(), colon = address.find(':', ip_at),
                      slash = address.find('/', colon);
    ip = address.substr(ip_at, colon - ip_at);
    port = std::stoi(address.substr(colon + 1, slash - colon - 1));
    host = address.substr(ip_at, slash - ip_at);
  }

  /// Takes the cookie for the address's token.
  void enter() {
    const StudioReply reply =
        raw("GET " + address.substr(address.find("/?")) + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
    const std::size_t at = reply.head.find("Set-Cookie: ");
    if (reply.status != 303 || at == std::string::npos) throw std::runtime_error("not let in: " + reply.head);
    cookie = reply.head.substr(at + 12, reply.head.find(';', at) - at - 12);
  }

  StudioReply get(const std::string& path, const std::string& more = "") const {
    return raw("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\nCookie: " + cookie + "\r\n" + more + "\r\n");
  }
  StudioReply post(const std::string& path, const std::string& body, const std::string& more = "") const {
    return raw("POST " + path + " HTTP/1.1\r\nHost: " + host + "\r\nOrigin: http://" + host + "\r\nCookie: " + cookie +
               "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n" + more + "\r\n" + body);
  }

  int connect() const {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    ::inet_pton(AF_INET, ip.c_str(), &to.sin_addr);
    if (::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
      ::close(fd);
      throw std::runtime_error("the studio does not listen");
    }
    return fd;
  }

  /// Sends these bytes and reads to the end of the answer; leaves after `patience_ms` without a byte.
  StudioReply raw(const std::string& bytes, int patience_ms = 30000) const {
    const int fd = connect();
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t n = ::send(fd, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (n <= 0) break;
      sent += static_cast<std::size_t>(n);
    }
    std::string text;
    std::array<char, 65536> buffer;
    pollfd ready{fd, POLLIN, 0};
    while (::poll(&ready, 1, patience_ms) > 0) {
      const ssize_t n = ::recv(fd, buffer.data(), buffer.size(), 0);
      if (n <= 0) break;
      text.append(buffer.data(), static_cast<std::size_t>(n));
    }
    ::close(fd);
    StudioReply reply;
    const std::size_t end = text.find("\r\n\r\n");
    reply.head = text.substr(0, end);
    if (end != std::string::npos) reply.body = text.substr(end + 4);
    if (reply.head.starts_with("HTTP/1.1 ")) reply.status = std::stoi(reply.head.substr(9, 3));
    return reply;
  }
};

class StudioUnderTest : public StudioDoor {
 public:
  /// Starts `burin --json studio FOLDER --no-browser ...` and reads the addresses that it prints.
  explicit StudioUnderTest(const std::filesystem::path& folder, const std::vector<std::string>& more = {}) {
    int out[2];
    if (::pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
    std::vector<std::string> words{places::program(), "--json", "studio", folder.string(), "--no-browser"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(out[1], 1);
      const int nothing = ::open("/dev/null", O_RDWR);
      ::dup2(nothing, 0);
      ::dup2(nothing, 2);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    ::close(out[1]);
    out_ = out[0];
    static_cast<StudioDoor&>(*this) = StudioDoor(next_address());
  }
  ~StudioUnderTest() {
    if (process_ > 0) end(SIGKILL);
    ::close(out_);
  }
  StudioUnderTest(const StudioUnderTest&) = delete;
  StudioUnderTest& operator=(const StudioUnderTest&) = delete;

  std::string next_address() {
    const auto line = nlohmann::json::parse(read_line());
    return line.at("address").get<std::string>();
  }

  /// Waits until the running command has ended, and returns the last state.
  nlohmann::json wait_for_work(int seconds) const {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
    for (;;) {
      const nlohmann::json state = get("/api/state?seen=0").json();
      if (state.contains("work") && !state["work"].is_null() && !state["work"]["running"].get<bool>()) return state;
      if (std::chrono::steady_clock::now() > until) throw std::runtime_error("still at work: " + state.dump());
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
  }

  int threads() const {
    int count = 0;
    for ([[maybe_unused]] const auto& task :
         std::filesystem::directory_iterator("/proc/" + std::to_string(process_) + "/task"))
      ++count;
    return count;
  }

  /// Processor time so far, s.
  double processor_s() const {
    std::ifstream file("/proc/" + std::to_string(process_) + "/stat");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    std::istringstream fields(text.substr(text.rfind(')') + 2));
    std::string skipped;
    for (int i = 0; i < 11; ++i) fields >> skipped;
    double user = 0, system = 0;
    fields >> user >> system;
    return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  }

  bool is_running() const { return ::waitpid(process_, nullptr, WNOHANG) == 0; }

  /// Sends a signal and waits for the end. Returns the seconds it took.
  double end(int signal) {
    const auto began = std::chrono::steady_clock::now();
    ::kill(process_, signal);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  }

 private:
  std::string read_line() {
    std::string line;
    char c = 0;
    pollfd ready{out_, POLLIN, 0};
    constexpr int kPatience_ms = 30000;
    while (::poll(&ready, 1, kPatience_ms) > 0 && ::read(out_, &c, 1) == 1 && c != '\n') line += c;
    return line;
  }

  pid_t process_ = -1;
  int out_ = -1;
};

}  // namespace burin

// burin studio - serves one page on this machine: from pictures to a measured board in a browser. The work is in
// tools/studio: studio.h has the state and the actions, server.h the HTTP.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Error.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include "burin/base/error.h"
#include "tools/commands.h"
#include "tools/project.h"
#include "tools/stop_signal.h"
#include "tools/studio/server.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

struct StudioArguments {
  fs::path folder;
  int port = 0;
  bool no_browser = false;
  std::string lan;
};

constexpr const char *kNewFolder = "my-board", *kAnyLan = "auto";

fs::path opened_folder(const StudioArguments& o) {
  if (!o.folder.empty()) return o.folder;
  const auto here = project_of(".");
  return here ? here->project.folder : fs::path(kNewFolder);
}

std::string lan_address(const StudioArguments& o) {
  if (o.lan != kAnyLan) return o.lan;
  const std::string found = local_network_address();
  if (found.empty()) fail("--lan", "this machine is in no local network", "connect it, or leave --lan out");
  return found;
}

// Opens the address in the person's browser, if there is a screen.
void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  std::string program = "xdg-open", argument = address;
  char* const argv[] = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int fd : {0, 1, 2}) posix_spawn_file_actions_addopen(&actions, fd, "/dev/null", O_RDWR, 0);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  pid_t process = 0;
  const int error = ::posix_spawnp(&process, "xdg-open", &actions, nullptr, argv, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == 0) ::waitpid(process, nullptr, WNOHANG);  // its end is not our business
}

void say_address(const std::string& address) {
  print_event("address", {{"address", address}}, "Open in a browser: " + address + "\n");
}

void run(const StudioArguments& o) {
  const StopOnSignal stop(1500ms);
  Studio studio(opened_folder(o));
  {
    StudioServer server(studio, o.port, lan_address(o));
    std::string address = server.address();
    say_address(address);
    if (const std::string phone = server.phone_address(); !phone.empty())
      print_event("phone", {{"address", phone}},
                  "For phones in this network, unencrypted: " + phone + " (the page shows it as a QR code)\n");
    if (is_for_people()) print_event("words", Json::object(), "Ctrl-C ends the studio; running work is kept.\n");
    if (!o.no_browser) open_browser(address);
    constexpr auto kBetween = 200ms;
    for (int i = 1; !StopOnSignal::asked(); ++i) {
      std::this_thread::sleep_for(kBetween);
      constexpr int kTidyEvery = 50;
      if (i % kTidyEvery == 0) studio.tidy();
      // A used address admits nobody else; the next one does.
      if (server.address() == address) continue;
      address = server.address();
      print_event("address", {{"address", address}}, "A browser is in. For another one: " + address + "\n");
    }
    studio.end(true);
  }
}

}  // namespace

void add_studio_command(CLI::App& burin) {
  auto o = std::make_shared<StudioArguments>();
  CLI::App* command =
      burin.add_subcommand("studio", "Serve a page on this machine for the whole way, from pictures to photos");
  command->add_option("FOLDER", o->folder,
                      "Open this project, or make a new one here [default: the working directory's project, else "
                      "my-board]");
  command->add_option("--port", o->port, "Listen on this port of 127.0.0.1 [default: a free one]")
      ->check(CLI::Range(1, 65535));
  command->add_flag("--no-browser", o->no_browser, "Print the address only, without opening a browser");
  CLI::Option* lan = command->add_option(
      "--lan", o->lan, "Also serve phones, at this address of this machine [default: the local network's]");
  lan->expected(0, 1)->type_name("ADDRESS");
  command->footer(
      example("burin studio my-board\n"
              "  burin studio my-board --lan"));
  command->callback([o, lan] {
    if (lan->count() > 0 && (o->lan.empty() || o->lan == "true")) o->lan = kAnyLan;  // CLI11's words for no value
    run(*o);
  });
}

}  // namespace burin

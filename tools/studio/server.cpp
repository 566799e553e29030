#include "tools/studio/server.h"

// The one file that includes cpp-httplib, so that its definitions are compiled once.
#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <thread>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/printable.h"
#include "burin/base/input_error.h"
#include "embedded/studio.h"
#include "tools/studio/studio_names.h"

namespace burin {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLongestPath = 1024, kLongestJson = 100'000, kThreads = 32;
constexpr int kMostWaiting = 16, kUploadPatience_s = 20;
constexpr auto kLongestWait = 10s;

enum class Role { desk, phone };

// Who may come in at one address.
struct Door {
  Role role = Role::desk;
  std::string host, cookie_name;
  int port = 0;
  std::string session = random_token();
  std::string token = random_token();  // guarded by `mutex`
  mutable std::mutex mutex;
  httplib::Server server;
  std::thread thread;

  std::string origin() const { return fmt::format("http://{}:{}", host, port); }
  std::string address() const {
    const std::lock_guard lock(mutex);
    return origin() + "/?token=" + token;
  }
};

constexpr const char* kOwnPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; frame-src "
    "'self'; "
    "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
// A page of the project may be a stranger's: it has no origin, so it can neither ask this server nor read its cookie.
constexpr const char* kPagePolicy =
    "sandbox allow-scripts; default-src 'none'; img-src data:; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'";

struct Asset {
  const char *path, *file, *type;
  bool for_phones;
};
constexpr Asset kAssets[] = {{"/studio.css", "studio.css", "text/css; charset=utf-8", true},
                             {"/words.js", "words.js", "text/javascript; charset=utf-8", true},
                             {"/page.js", "page.js", "text/javascript; charset=utf-8", true},
                             {"/setup.js", "setup.js", "text/javascript; charset=utf-8", true},
                             {"/phone.js", "phone.js", "text/javascript; charset=utf-8", true},
                             {"/icon.svg", "burin.svg", "image/svg+xml", true},
                             {"/studio.js", "studio.js", "text/javascript; charset=utf-8", false},
                             {"/pictures.js", "pictures.js", "text/javascript; charset=utf-8", false},
                             {"/place.js", "place.js", "text/javascript; charset=utf-8", false},
                             {"/design.js", "design.js", "text/javascript; charset=utf-8", false},
                             {"/carve.js", "carve.js", "text/javascript; charset=utf-8", false},
                             {"/look.js", "look.js", "text/javascript; charset=utf-8", true}};

void answer(httplib::Response& response, int status, std::string body, const std::string& type,
            const char* policy = kOwnPolicy) {
  response.status = status;
  response.set_header("Content-Security-Policy", policy);
  response.set_content(std::move(body), type.c_str());
}

void answer(httplib::Response& response, const Json& json, int status = 200) {
  answer(response, status, json.dump(-1, ' ', false, Json::error_handler_t::replace), "application/json");
}

void refuse(httplib::Response& response, int status, const std::string& what) {
  answer(response, status, "burin studio: " + what + "\n", "text/plain; charset=utf-8");
}

std::string cookie_of(const httplib::Request& request, const std::string& name) {
  std::string all = request.get_header_value("Cookie"), part;
  for (std::size_t at = 0; at <= all.size();) {
    const std::size_t end = std::min(all.find(';', at), all.size());
    part = all.substr(at, end - at);
    part.erase(0, part.find_first_not_of(' ') == std::string::npos ? part.size() : part.find_first_not_of(' '));
    if (part.starts_with(name + "=")) return part.substr(name.size() + 1);
    at = end + 1;
  }
  return {};
}

// Exactly one value: a second one may be read by another program as the first.
bool is_only_header(const httplib::Request& request, const char* name, const std::string& value) {
  return request.get_header_value_count(name) == 1 && request.get_header_value(name) == value;
}

// The page of this program with its policy, as for all of Burin's pages.
std::string page(const char* file) {
  std::string text(embedded::studio(file));
  const std::string place = "{{policy}}";
  text.replace(
      text.find(place), place.size(),
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'self'; style-src "
      "'self'; img-src 'self' blob:; connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action "
      "'none'\">");
  return text;
}

Json error_json(const std::exception& error) {
  const auto* input = dynamic_cast<const InputError*>(&error);
  if (input == nullptr) return {{"error", {{"message", printable(error.what())}}}};
  return {{"error",
           {{"message", printable(input->what())},
            {"where", printable(input->where)},
            {"what", printable(input->problem)},
            {"remedy", printable(input->remedy)}}}};
}

// Calls a handler; an Error becomes 400 with its parts, so that the page can show problem and remedy.
template <class Handler>
void answer_errors(httplib::Response& response, const Handler& handler) {
  try {
    handler();
  } catch (const Error& error) {
    answer(response, error_json(error), 400);
  } catch (const std::bad_alloc&) {
    answer(response, Json{{"error", {{"message", "memory ran out; close other programs"}}}}, 507);
  } catch (const std::exception& error) {
    answer(response, error_json(error), 400);
  }
}

std::uint64_t number_in_query(const httplib::Request& request, const char* name) {
  const std::string text = request.get_param_value(name);
  std::uint64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::string small_body(const httplib::ContentReader& reader) {
  std::string body;
  const bool whole = reader([&](const char* data, std::size_t size) {
    body.append(data, std::min(size, kLongestJson + 1 - std::min(body.size(), kLongestJson)));
    return body.size() <= kLongestJson;
  });
  if (!whole) fail("the request", "is too long, or was cut off", "reload the page");
  return body;
}

Json json_body(const httplib::ContentReader& reader) {
  constexpr int kDeepest = 12;
  const Json json = Json::parse(
      small_body(reader), [](int depth, Json::parse_event_t, Json&) { return depth <= kDeepest; }, false);
  if (!json.is_object()) fail("the request", "is no JSON object", "reload the page");
  return json;
}

UploadBody upload_of(const httplib::ContentReader& reader) {
  return [&reader](const std::function<bool(const char*, std::size_t)>& take) {
    return reader([&](const char* data, std::size_t size) { return take(data, size); });
  };
}

}  // namespace

struct StudioServer::Doors {
  explicit Doors(Studio& opened) : studio(opened) {}

  // Returns true if the request is answered: refused, or the token's redirection.
  bool judge(Door& door, const httplib::Request& request, httplib::Response& response) {
    const bool post = request.method == "POST";
    if (request.method != "GET" && !post) return refuse(response, 405, "only GET and POST are answered"), true;
    if (request.path.size() > kLongestPath) return refuse(response, 414, "the address is too long"), true;
    // A name that was made to lead here (DNS rebinding) is another host.
    const std::string host = fmt::format("{}:{}", door.host, door.port);
    const bool here =
        is_only_header(request, "Host", host) ||
        (door.role == Role::desk && is_only_header(request, "Host", fmt::format("localhost:{}", door.port)));
    if (!here) return refuse(response, 421, "this is not the host that answers here"), true;
    const std::string from = request.get_header_value("Sec-Fetch-Site");
    if (!from.empty() && from != "same-origin" && from != "none")
      return refuse(response, 403, "another page may not ask here"), true;
    if (post && !is_only_header(request, "Origin", "http://" + request.get_header_value("Host")))
      return refuse(response, 403, "another page may not ask here"), true;
    if (request.has_header("Content-Encoding")) return refuse(response, 415, "send it as it is, not packed"), true;
    const bool has_cookie = same_secret(cookie_of(request, door.cookie_name), door.session);
    if (!post && request.path == "/" && request.has_param("token"))
      return admit(door, has_cookie, request, response), true;
    if (has_cookie) return false;
    refuse(response, 403, "open the address that the terminal shows; it admits one browser");
    return true;
  }

  void admit(Door& door, bool has_cookie, const httplib::Request& request, httplib::Response& response) {
    {
      const std::lock_guard lock(door.mutex);
      if (!has_cookie && !same_secret(request.get_param_value("token"), door.token))
        return refuse(response, 403, "this address was used already; the terminal shows a new one");
      if (!has_cookie && door.role == Role::desk) door.token = random_token();
    }
    response.set_header("Set-Cookie", door.cookie_name + "=" + door.session + "; Path=/; HttpOnly; SameSite=Strict");
    response.set_header("Location", "/");
    answer(response, 303, "", "text/plain; charset=utf-8");
  }

  void get(Door& door, const httplib::Request& request, httplib::Response& response) {
    const bool desk = door.role == Role::desk;
    const std::string& path = request.path;
    if (path == "/")
      return answer(response, 200, page(desk ? "studio.html" : "phone.html"), "text/html; charset=utf-8");
    for (const Asset& asset : kAssets)
      if (path == asset.path && (desk || asset.for_phones))
        return answer(response, 200, std::string(embedded::studio(asset.file)), asset.type);
    if (path == "/api/state" && desk) {
      const Waiting waits(*this);
      return answer(response, studio.wait_for_state(number_in_query(request, "seen"), request.has_param("looks"),
                                                    waits.longest()));
    }
    if (path == "/api/shots") {
      const Waiting waits(*this);
      return answer(response, studio.wait_for_shots(number_in_query(request, "seen"), waits.longest()));
    }
    if (!desk) return refuse(response, 404, "there is no such page");
    const auto send = [&](const StudioFile& file) {
      answer(response, 200, file.bytes, file.type, file.is_page ? kPagePolicy : kOwnPolicy);
    };
    if (path.starts_with("/file/")) {
      const std::string name = path.substr(std::string_view("/file/").size());
      send(studio.file(name));
      if (request.has_param("save")) response.set_header("Content-Disposition", "attachment");
      return;
    }
    if (path == "/thumb") return send(studio.thumbnail(request.get_param_value("file")));
    if (path == "/target") return send(studio.target(request.get_param_value("view"), request.has_param("mask")));
    if (path == "/qr.svg" && phone.has_value()) return answer(response, 200, qr_svg(phone->address()), "image/svg+xml");
    refuse(response, 404, "there is no such page");
  }

  void post(Door& door, const httplib::Request& request, httplib::Response& response,
            const httplib::ContentReader& reader) {
    const bool desk = door.role == Role::desk;
    const std::string& path = request.path;
    const Json done{{"done", true}};
    if (path == "/api/photo")
      return answer(response, studio.add_photo(request.get_param_value("name"), request.get_param_value("lamp"),
                                               upload_of(reader)));
    if (desk && path == "/api/picture")
      return answer(response, studio.add_picture(request.get_param_value("name"), upload_of(reader)));
    if (desk && path == "/api/mask")
      studio.set_mask(request.get_param_value("view"), upload_of(reader));
    else if (desk && path == "/api/do")
      studio.begin(json_body(reader));
    else if (desk && path == "/api/edit")
      studio.edit(json_body(reader));
    else if (desk && path == "/api/stop")
      studio.stop();
    else if (desk && path == "/api/remove")
      studio.remove_picture(request.get_param_value("file"));
    else
      return refuse(response, 404, "there is no such action");
    answer(response, done);
  }

  void open(Door& door, const std::string& host, int port, Role role) {
    door.host = host;
    door.role = role;
    httplib::Server& server = door.server;
    server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server.set_keep_alive_max_count(1);  // a connection that waits would keep a thread
    server.set_read_timeout(kUploadPatience_s);
    server.set_write_timeout(kUploadPatience_s);
    // Not SO_REUSEPORT, which would share the port with another program.
    server.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                                {"Referrer-Policy", "no-referrer"},
                                {"Cross-Origin-Opener-Policy", "same-origin"},
                                {"Cross-Origin-Resource-Policy", "same-origin"},
                                {"Cache-Control", "no-store"}});
    server.set_pre_routing_handler([this, &door](const httplib::Request& request, httplib::Response& response) {
      if (!judge(door, request, response)) {
        if (request.method != "GET") return httplib::Server::HandlerResponse::Unhandled;
        answer_errors(response, [&] { get(door, request, response); });
      }
      return httplib::Server::HandlerResponse::Handled;
    });
    server.Post(".*", [this, &door](const httplib::Request& request, httplib::Response& response,
                                    const httplib::ContentReader& reader) {
      answer_errors(response, [&] { post(door, request, response, reader); });
    });
    const bool bound = port == 0 ? (door.port = server.bind_to_any_port(host)) > 0 : server.bind_to_port(host, port);
    if (port != 0) door.port = port;
    if (!bound)
      fail(fmt::format("{}:{}", host, port),
           "cannot be listened on: another program may have this port, or the machine "
           "has no such address",
           "give another --port, or none for a free one");
    door.cookie_name = fmt::format("burin-{}", door.port);
    door.thread = std::thread([&server] { server.listen_after_bind(); });
    while (!server.is_running()) std::this_thread::sleep_for(1ms);
  }

  // A waiting request keeps a thread, so only some may wait.
  struct Waiting {
    explicit Waiting(Doors& of) : doors(of), place(++of.waiting) {}
    ~Waiting() { --doors.waiting; }
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;
    std::chrono::milliseconds longest() const { return place <= kMostWaiting ? kLongestWait : 0s; }
    Doors& doors;
    int place;
  };

  Studio& studio;
  Door desk;
  std::optional<Door> phone;
  std::atomic<int> waiting = 0;
};

StudioServer::StudioServer(Studio& studio, int port, const std::string& lan) : doors_(std::make_unique<Doors>(studio)) {
  doors_->open(doors_->desk, "127.0.0.1", port, Role::desk);
  if (lan.empty()) return;
  doors_->open(doors_->phone.emplace(), lan, 0, Role::phone);
  studio.set_phone_address(doors_->phone->address());
}

StudioServer::~StudioServer() {
  for (Door* door : {&doors_->desk, doors_->phone ? &*doors_->phone : nullptr}) {
    if (door == nullptr || !door->thread.joinable()) continue;
    door->server.stop();
    door->thread.join();
  }
}

std::string StudioServer::address() const { return doors_->desk.address(); }
std::string StudioServer::phone_address() const { return doors_->phone ? doors_->phone->address() : std::string(); }

}  // namespace burin
